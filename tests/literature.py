"""Published numbers that several tests meet."""

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

# One-sine overturning, p = 2.14 rad/s, gamma 0.25, e = 0.9, nonlinear: amplitude over g gamma
ONE_SINE = {
    2: (1.25090, 2.37418, 2.40806),
    3: (1.43539, 3.60487, 3.74275),
    4: (1.84430, 5.07937, 5.43676),
    5: (3.03234, 6.74302, 7.49300),
    6: (4.91994, 8.50817, 9.91798),
    8: (15.90490,),
}
