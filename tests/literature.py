"""Published numbers that several tests meet."""

from analytic import Block, PulseMotion, Scene

# Impact times [s] of problem A: released at rest from 0.9 gamma, Housner's restitution; a high-precision solution.
A_IMPACTS = (
    1.15178330918313354,
    2.30267614352356326,
    3.19766787312214604,
    3.94143279745026066,
    4.57814095444687863,
    5.1324813494596925,
    5.62035297828485788,
    6.05292315538590213,
    6.43851120325872555,
    6.78358291790019776,
)

A_REST = {1e-4: (82, 10.0465490762726), 1e-6: (129, 10.0496394097305), 1e-8: (177, 10.0496728814269)}  # below p x key
A_TILT = 0.01588089793859602683756374  # rad, at 7 s
B_TILT = 0.01186179747282469895957273  # rad, problem B at 6 s

# One-sine overturning, p = 2.14 rad/s, gamma 0.25, e = 0.9, nonlinear: amplitude over g gamma
ONE_SINE = {
    2: (1.25090, 2.37418, 2.40806),
    3: (1.43539, 3.60487, 3.74275),
    4: (1.84430, 5.07937, 5.43676),
    5: (3.03234, 6.74302, 7.49300),
    6: (4.91994, 8.50817, 9.91798),
    8: (15.90490,),
}
# The same of a slender block
ONE_SINE_SLENDER = {
    2: (1.22518, 2.31440, 2.34990),
    3: (1.40357, 3.48466, 3.63115),
    4: (1.79544, 4.85011, 5.23896),
    5: (3.01860, 6.31807, 7.16813),
    6: (5.16416, 7.66988, 9.41697),
    8: (14.87135,),
}


def under_a_pulse(amplitude, frequency, slenderness=0.25, shape="one-sine", duration=30.0):
    """The scene of these tables: amplitude over g gamma, frequency over p."""
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=slenderness, restitution=0.9)
    pulse = PulseMotion(shape, amplitude * 9.81 * slenderness, frequency * 2.14)
    return Scene(block=block, motion=pulse, duration=duration)
