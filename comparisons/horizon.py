"""How long a trajectory means anything: the sensitivity horizon of a scene.

Rocking under a long record is chaotic: a restitution changed in the fourth digit soon gives another motion, in the
exact model too. Point-wise agreement of two solvers can be asked for only until then.
"""

from dataclasses import dataclass

import numpy as np

from analytic import simulate
from analytic.rocking import restitution

# Relative changes of the twins: of the size of a good engine's error in restitution (1e-4).
PERTURBATION = 1e-4
# Twins further apart than this share of the slenderness no longer show the same motion.
SPREAD = 0.01
# Sampling of the twins: periods 2 pi/omega_r contain this many samples, so that no part of a swing is overlooked.
SAMPLES_PER_PERIOD = 400


@dataclass(frozen=True, eq=False)
class Horizon:
    """The sensitivity horizon [s], the run's end where the twins never part; and the spread it comes from.

    time [s] and spread, arrays of shape (n,): the largest |tilt of a twin - tilt of the scene| / slenderness up to
    each time. Twins are told apart by name in `twins`: the time [s] at which each parted, or None.
    """

    horizon: float
    time: np.ndarray
    spread: np.ndarray
    twins: dict


def twin_scenes(scene, perturbation=PERTURBATION):
    """Scenes next to `scene`, by name: restitution, and motion amplitude and start, changed by +-perturbation."""
    twins = {}
    e = max(restitution(scene), 0.0) if scene.block.restitution is None else scene.block.restitution
    start = scene.start
    for sign, word in ((1, "up"), (-1, "down")):
        factor = 1 + sign * perturbation
        if 0 < e * factor <= 1:
            twins[f"restitution {word}"] = scene.with_(block={"restitution": e * factor})
        if scene.motion is not None:
            twins[f"motion {word}"] = scene.with_(motion=scene.motion.scaled(factor))
        changed = {name: getattr(start, name) * factor for name in type(start).model_fields}
        if changed != start.model_dump():
            twins[f"start {word}"] = scene.with_(start=changed)
    return twins


def sensitivity_horizon(scene, *, perturbation=PERTURBATION, spread=SPREAD):
    """Time until which the motion of a scene can be compared point by point.

    Parameters
    ----------
    scene : Scene
    perturbation : float
        Relative change of restitution, motion amplitude and start, above 0 and below 1.
    spread : float
        Share of the slenderness by which a twin's tilt must differ to count as parted.

    Returns
    -------
    Horizon

    Raises
    ------
    ValueError
        perturbation or spread are out of range.
    """
    if not 0 < perturbation < 1 or not spread > 0:
        raise ValueError(f"perturbation = {perturbation!r} must lie in (0, 1), spread = {spread!r} above 0")
    period = 2 * np.pi / scene.rocking_frequency
    step = min(period / SAMPLES_PER_PERIOD, scene.duration / 2)
    base = simulate(scene, output_step=step).history
    largest = np.zeros(len(base.time))
    parted = {}
    for name, twin in twin_scenes(scene, perturbation).items():
        other = simulate(twin, output_step=step).history
        # Where one has overturned and stopped, it keeps its last tilt.
        tilt = np.interp(base.time, other.time, other.tilt)
        apart = np.abs(tilt - base.tilt) / scene.block.slenderness
        beyond = np.flatnonzero(apart > spread)
        parted[name] = float(base.time[beyond[0]]) if len(beyond) else None
        largest = np.maximum(largest, apart)
    times = [time for time in parted.values() if time is not None]
    return Horizon(min(times, default=float(base.time[-1])), base.time, np.maximum.accumulate(largest), parted)
