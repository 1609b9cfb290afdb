"""Settings of compliant-corners: what they were measured with, and how they follow a scene's size, start and base."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from analytic.rocking import restitution

from ..vibration import base_decay, base_frequency, given_back

if TYPE_CHECKING:
    from analytic import Scene

# The block the defaults were measured with: the Caryatid, mass [kg], radius [m], gravity [m/s2]; and the least start,
# tilt over slenderness. Smaller blocks and starts get the equivalent.
MEASURED = 3172.05, 1.0884, 9.81
MEASURED_START = 0.3

# More slender blocks than this land more slowly, by as much: their corners are stiffer, as for smaller starts. Without,
# at .04 every late impact took .003 too much of e, and 7 of 93 were lost.
SLENDER = 0.1

# A base below LIGHT block masses that vibrates, or is stopped by its damper, more than MOST_RATIO times as fast as a
# corner gives way is on its way back before an impact is over. m_b/m 1e-5, ratio 1.7: its displacement is off by 26 %,
# and by -48 % at .5; .006, ratio .13: 27 %; 1e-5 with a damper, ratio 11: e is off by .023.
LIGHT, MOST_RATIO = 0.05, 0.1

# A damper that stops the base about as fast as a corner gives way takes part in the impact: what the base would give
# back to the block's rate, `given_back`, cannot be told from what the impact left it; the less that is, the longer the
# corner is on its way. Over e times the base's decay over the corner's frequency: .31: e is off by .0018, .37: .016,
# .74: .031 to .066, 2.1: .059, 5: .17. Such corners are stiffer, for a product of TAKEN, by at most STIFFER (4e4: runs
# fail), and stick sooner, by at most SOONER of `slip` (e .27: off by .012 at any stiffness without it), and are thrown
# back no faster for giving way easily (J_O 1.02 m R^2: .013). What is left above MOST_TAKEN is said. Of an e below
# LEAST_E not even that much is told.
TAKEN, MOST_TAKEN, STIFFER, SOONER, LEAST_E = 0.1, 0.25, 4000.0, 0.1, 0.02

# On a base that gives way the other corner is pressed down, see `slip`, the more the less an impact leaves the block.
# Above NEED of it, on bases of LIGHT to KICKED block masses, corners stick sooner, too, by e^2 (at least SOONER).
# Without, e is off by .03 (m_b/m .1, e .28 and .38, need 3.3 and 1.2) and .014 (.5, .46, 5.9); with it by at most .005.
# Below NEED it changes nothing: .0005 either way for J_O = 4/3 m R^2.
NEED = 0.6

# An undamped base that vibrates fast keeps what every impact gives it, and errs by the phase in which the next one
# finds it: m_b/m .1, ratio .028: its displacement is off by 9 %, at .01 by .8 %; .4, .042: 5 %. For bases of up to
# KICKED block masses corners are stiffer too, for a ratio of VIBRATES, by at most STIFFEST.
VIBRATES, STIFFEST, KICKED = 0.01, 25.0, 1.0

# How late an impact on such a corner comes, over its sqrt(m/k), and the relative error of the time between two; that of
# the frequency of a base that vibrates on its bearings grows as the square of the ratio above, as what sticks yields:
# at .044 (951 omega_r, m_b/m .44) nothing was left of the phase after 500 periods.
LATE, DRIFT = 2.0, 1e-4

# Most by which `slip` grows for slender blocks.
EASE = 10.0


@dataclass(frozen=True)
class CompliantCorners:
    """Settings of compliant-corners. `stiffness` is the accuracy knob: the error of restitution goes as its inverse.

    stiffness [N/m] per corner, rebound and slip [m/s] are those of a block of the Caryatid's weight and size released
    at .3 of its slenderness or more; other blocks and smaller starts get the equivalent (penetration over radius and
    tilt, speeds over those of the impact stay the same). Likewise tolerance and both steps.
    """

    # Measured in free rocking from 8 starts, 0.3 to 0.8 gamma, gamma 0.1 to 0.45, rigid ground and m_b = 212 kg, every
    # impact at least a tenth as fast as the run's fastest; worst rms error of restitution and CPU s per simulated s:
    # 1e11: 1.3e-4, .02-.05; 1.5e11: 6e-5, .02-.055; 2e11: 3e-5, .02-.055; 3e11: 7e-6, .03-.065. Slow impacts err
    # more, as the inverse square of their rate. Here and below the times are of explicit steps alone; the implicit ones
    # of `phases` take 2.6 to 4.5 times less in free rocking, 6.6 under 25 s of motion (side by side, at 2e11).
    stiffness: float = 2e11
    # Hunt-Crossley damping of 1000 s/m: the corner is thrown back at 1 mm/s at most.
    rebound: float = 1e-3
    # No slip in any impact; the model's friction demand is far below it. A scene's own coefficient comes first.
    friction: float = 5.0
    # Tangential over normal stiffness, less on a light base. 1: .03-.09 CPU s; 0.3: .02-.05, error up to 4e-5;
    # 0.1: .02-.045, up to 1e-4.
    sticking: float = 0.3
    # Tangential, over the critical one of block and base sliding on the contact. 0.3 throws the stocky block about
    # after its impacts, 1 costs up to twice the steps.
    damping: float = 0.5
    # Sliding speed [m/s] at which the viscous part of friction, which grows with the normal force, would equal it.
    # A corner must stick as fast as it lands: if the normal impulse comes first it presses the other corner down, which
    # then takes part in the impact, for sin^2 gamma > J_O/(m R^2) - 1 (gamma .6: e off by 3e-2 without this part). For
    # less it is larger as there is less need, by up to EASE: it costs steps.
    slip: float = 0.1
    # Local error per step [m, rad, m/s, rad/s]. Stability of the stiff contact, not this, sets the step:
    # 1e-6 costs as much within 10 %.
    tolerance: float = 1e-7
    # [s]; of explicit steps, reached by none in contact.
    longest_step: float = 5e-3
    # [s]; of implicit steps, while the block pivots or stands.
    pivoting_step: float = 2e-3


def start_share(scene: Scene) -> float:
    """Amplitude of the free rocking that a scene starts with, over `MEASURED_START` slendernesses; at most 1."""
    start, gamma = scene.start, scene.block.slenderness
    if scene.motion is not None or (start.tilt == 0 and start.tilt_rate == 0):
        return 1.0
    tilt, rate = abs(start.tilt) / gamma, start.tilt_rate / (scene.rocking_frequency * gamma)
    energy = 1 - (1 - tilt) ** 2 + rate * rate  # of a slender block; 1 takes it to the unstable point
    if tilt >= 1 or energy >= 1:
        return 1.0
    return min(1.0, (1 - math.sqrt(1 - energy)) / MEASURED_START)


def scaled(scene: Scene, settings: CompliantCorners, share: float, harder: float = 1.0) -> CompliantCorners:
    """The settings for a scene's size, and for swings of `share` of `MEASURED_START` slendernesses.

    harder: corners that many times as stiff, all else as for swings that are smaller by it.
    """
    block = scene.block
    mass, radius, gravity = MEASURED
    speed, time = (
        math.sqrt(value)
        for value in (
            scene.gravity * block.radius / (gravity * radius),
            block.radius / scene.gravity / (radius / gravity),
        )
    )
    weight = block.mass * scene.gravity / block.radius / (mass * gravity / radius)
    need = block.mass * block.half_width**2 / block.centre_inertia  # above 1: see `slip`
    # a corner of a block with a small moment of inertia gives way easily: the same damping would cost many more steps
    easy = (1 + need) / (1 + 3 * math.sin(block.slenderness) ** 2)
    stiffness = settings.stiffness * weight / share * max(1.0, SLENDER / block.slenderness) ** 2
    stopped = sooner = 1.0
    if scene.base is not None and scene.base.mass >= LIGHT * block.mass:
        slow = math.sqrt(block.mass / stiffness)
        stopped = max(1.0, min((_taken(scene, slow) / TAKEN) ** 2, STIFFER))
        vibrating = base_frequency(scene) * slow / VIBRATES if scene.base.mass <= KICKED * block.mass else 0.0
        stiffness *= max(stopped, min(vibrating**2, STIFFEST))
        if need > NEED and scene.base.mass <= KICKED * block.mass:
            sooner = restitution(scene) ** 2
    share /= harder
    return replace(
        settings,
        stiffness=stiffness * harder,
        rebound=settings.rebound * speed * math.sqrt(share * max(1.0, easy / stopped)),
        slip=settings.slip
        * speed
        * math.sqrt(share / max(1.0, need))
        * min(max(1.0, math.sqrt(0.5 / need)), EASE)
        * max(min(stopped**-0.5, sooner), SOONER),
        tolerance=settings.tolerance * min(speed, 1 / speed, 1.0) * share,
        longest_step=settings.longest_step * min(time, 1.0) * math.sqrt(share),
        pivoting_step=settings.pivoting_step * time * math.sqrt(share),
    )


def _taken(scene: Scene, slow: float) -> float:
    """What a damper takes part in an impact, see `TAKEN`; slow: time in which a corner gives way by 1 rad [s]."""
    return base_decay(scene) * slow * given_back(scene) / max(restitution(scene), LEAST_E)


def drift(scene: Scene, settings: CompliantCorners) -> float:
    """Relative error of the time between two impacts, or of the base's frequency, whichever is larger."""
    if scene.base is None or scene.base.mass < LIGHT * scene.block.mass:
        return DRIFT
    ratio = base_frequency(scene) * math.sqrt(scene.block.mass / settings.stiffness)
    return DRIFT * max(1.0, ratio / VIBRATES) ** 2


def unresolved(scene: Scene, settings: CompliantCorners) -> Iterator[str]:
    """Sentences on a base that is gone again while the impact that kicks it still lasts."""
    if scene.bearings is None:
        return
    slow = math.sqrt(scene.block.mass / settings.stiffness)
    if scene.base.mass < LIGHT * scene.block.mass:
        for name, rate in (
            ("frequency on its bearings", base_frequency(scene)),
            ("decay by its dampers", base_decay(scene)),
        ):
            if rate * slow > MOST_RATIO:
                yield (
                    f"the base's {name} over the frequency of a corner on it = {rate * slow:.4g} is above "
                    f"{MOST_RATIO:g}, the limit verified for bases below {LIGHT:g} block masses: what an impact moves "
                    "it by is not resolved"
                )
    elif (taken := _taken(scene, slow)) > MOST_TAKEN:
        yield (
            "the base's decay by its dampers over the frequency of a corner on it, times what it gives back to the "
            f"block over what the impact leaves it, = {taken:.4g} is above {MOST_TAKEN:g}, the limit verified: what an "
            "impact moves it by is not resolved"
        )
