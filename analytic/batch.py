"""Many runs on all cores, of which only the outcomes are kept: `simulate_many` and `overturning_map`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from .kernel import layout
from .kernel import march as kernel
from .kernel.compiled import compiling
from .kernel.decision import CAP_PERIODS, longest_duration, shortest_duration
from .kernel.layout import Parameters, Shaking
from .kernel.march import OWN, ROW, SIZE, row_of
from .laws import Constants
from .motion import PulseMotion, SampledMotion
from .scene import Block, Scene
from .sliding import run as sliding
from .solver import REST_RATE, STEPS, TOLERANCE, ground, most_steps, options, parameters

if TYPE_CHECKING:
    import numpy.typing as npt

    from .kernel.layout import Contact, Ground, Options
    from .motion import Motion

# Chunks per worker, so that a slow chunk does not leave the other cores idle.
CHUNKS_PER_WORKER = 8


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Outcomes of many runs, arrays of one common shape.

    overturns, fell_off, lifted, slid : bool. failed : bool: the model failed, exceeded its budget, or does not
    determine how the block slides. decided : bool: False where the duration ended before the outcome was certain.
    peak_tilt [rad]; peak_slip [m], 0 without a friction; peak_base_displacement [m], up to the last passage of
    |tilt| = slenderness where the block overturns. impacts : int, until the outcome was certain.
    friction_demand [-], min_normal_ratio [-]: as in `Response`, if they were asked for, else NaN.
    """

    overturns: np.ndarray
    lifted: np.ndarray
    failed: np.ndarray
    peak_tilt: np.ndarray
    peak_base_displacement: np.ndarray
    impacts: np.ndarray
    decided: np.ndarray
    friction_demand: np.ndarray
    min_normal_ratio: np.ndarray
    slid: np.ndarray
    peak_slip: np.ndarray
    fell_off: np.ndarray

    @property
    def names(self) -> np.ndarray:
        """Return the outcomes as `Response.outcome` names them, array of str."""
        rest = np.where(self.lifted, "rocks", np.where(self.slid, "slides", "stands"))
        upright = np.where(self.fell_off, "falls off", rest)
        return np.where(self.failed, "failed", np.where(self.overturns, "overturns", upright))

    @classmethod
    def of(cls, totals: np.ndarray, shape: tuple[int, ...], contact: bool = False) -> Self:
        """Return the outcomes of runs with these totals, shape (n, TOTALS). contact : whether it was recorded."""

        def column(slot):
            return totals[:, slot].reshape(shape)

        status = column(layout.STATUS)
        return cls(
            column(layout.WILL_OVERTURN) > 0,
            column(layout.LIFTED) > 0,
            (status == layout.STUCK) | (status == layout.NOT_FINITE) | (status == layout.SPENT),
            column(layout.PEAK_TILT),
            column(layout.PEAK_X),
            column(layout.IMPACTS).astype(int),
            column(layout.CERTAIN) > 0,
            column(layout.FRICTION) if contact else np.full(shape, np.nan),
            column(layout.NORMAL) if contact else np.full(shape, np.nan),
            column(layout.PATH) > 0,
            column(layout.PEAK_SLIP),
            column(layout.MODE) == layout.OFF,
        )


def run_rows(
    rows: np.ndarray,
    pulses: np.ndarray,
    shaking: Ground,
    chosen: Options,
    workers: int | None = None,
    contacts: Sequence[Contact | None] = (),
) -> np.ndarray:
    """Return the totals, shape (n, TOTALS), of n runs that share the kind and samples of one ground motion.

    rows : (n,), of dtype `ROW`, see `row_of`. pulses : (n, fields of Shaking). contacts : n, of blocks that may slide.
    The result does not depend on the number of workers (threads; the kernel holds no lock).
    """
    n = len(rows)
    totals = np.zeros((n, layout.TOTALS))
    numbers = rows.view(float).reshape(n, SIZE)
    workers = workers or os.cpu_count() or 1

    def slide(i, contact):
        par = Parameters(*numbers[i, :OWN], Constants(*numbers[i, OWN:]))  # type: ignore[call-arg]  # of one length
        if sliding.is_needed(par, contact, totals[i]):
            sliding.outcome(par, contact, shaking._replace(shaking=Shaking(*pulses[i])), chosen, totals[i])

    def run(part):
        kernel.run_rows(numbers[part], pulses[part], shaking, chosen, kernel.arrays(totals[part]))
        for i, contact in enumerate(contacts[part], part.start):
            if contact is not None:
                slide(i, contact)

    with compiling():
        run(slice(0, 1))  # compiled or loaded before threads start
    size = max(1, -(-n // (workers * CHUNKS_PER_WORKER)))
    parts = [slice(k, min(k + size, n)) for k in range(1, n, size)]
    if workers == 1 or len(parts) < 2:
        for part in parts:
            run(part)
        return totals
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, parts))
    return totals


def _outcome_options(
    tolerance: float, rest_rate: float, steps: int, contact: bool = False, rubbing: Sequence[Scene] = ()
) -> Options:
    """Return the `Options` of runs of which only the outcome counts.

    rubbing : scenes with a friction. They are followed as a single run is, as their demand decides whether they slide.
    """
    shortest = max(map(shortest_duration, rubbing), default=0.0)
    record = contact or bool(rubbing)
    return options(
        tolerance, rest_rate=rest_rate, record=record, decide=True, capacity=0, steps=steps, shortest=shortest
    )


def simulate_many(
    scenes: Iterable[Scene],
    *,
    scales: npt.ArrayLike | None = None,
    contact: bool = False,
    tolerance: float = TOLERANCE,
    rest_rate: float = REST_RATE,
    workers: int | None = None,
) -> Outcomes:
    """Return the outcomes of a sequence of scenes, in its order, shape (n,).

    Scenes are grouped by their ground motion (the same object or equal content), so ensembles of many scenes under
    few records are fastest. scales : (n,) factors on the scenes' motions, 1 without it. contact : also determine
    friction demand and normal force, which takes some more time.

    Examples
    --------
    Restitution known to 1 %: which of these blocks overturn?

    >>> import numpy as np
    >>> from analytic import load_scene
    >>> scene = load_scene("caryatid-rigid")
    >>> outcomes = simulate_many([scene.with_(block={"restitution": e}) for e in np.linspace(0.87, 0.89, 5)])
    >>> outcomes.overturns.shape, int(outcomes.failed.sum())
    ((5,), 0)
    """
    scenes = list(scenes)
    factors = np.ones(len(scenes)) if scales is None else np.asarray(scales, dtype=float)
    steps = max((most_steps(scene) for scene in scenes), default=0)
    rubbing = [scene for scene in scenes if scene.friction is not None]
    chosen = _outcome_options(tolerance, rest_rate, steps, contact, rubbing)
    groups: dict[str | tuple[int, bool], list[int]] = {}
    for index, scene in enumerate(scenes):
        motion = scene.motion
        shaking = ground(motion)
        key = motion.digest() if isinstance(motion, SampledMotion) else (shaking.kind, shaking.upright is None)
        groups.setdefault(key, []).append(index)
    totals = np.empty((len(scenes), layout.TOTALS))
    for members in groups.values():
        shakings = [ground(scenes[i].motion, factors[i]) for i in members]
        rows = np.array([row_of(parameters(scenes[i])) for i in members], dtype=ROW)
        pulses = np.array([shaking.shaking for shaking in shakings])
        contacts = [sliding.contact_of(scenes[i]) for i in members]
        totals[members] = run_rows(rows, pulses, shakings[0], chosen, workers, contacts)
    return Outcomes.of(totals, (len(scenes),), contact)


def overturning_map(
    scene: Scene,
    shape: str,
    frequency_ratios: npt.ArrayLike,
    amplitude_ratios: npt.ArrayLike,
    *,
    vertical_ratio: float = 0.0,
    vertical_phase: float = 0.0,
    tolerance: float = TOLERANCE,
    workers: int | None = None,
) -> Outcomes:
    """Return the outcomes over pulse frequency and amplitude, shape (len(amplitude_ratios), len(frequency_ratios)).

    Parameters
    ----------
    scene : Scene
        Block, base and bearings; its motion is replaced by the pulse. Without a duration each run goes on until its
        outcome is decided; one that is given must cover the pulse.
    shape : str
        Pulse, see `PulseMotion`.
    frequency_ratios : array
        Pulse frequency / omega_r.
    amplitude_ratios : array
        Pulse amplitude / (g tan(slenderness)).
    vertical_ratio, vertical_phase : float
        Amplitude of the vertical pulse over that of the horizontal one, and its phase [rad].
    """

    def pulse(frequency):
        level = PulseMotion(shape, 1.0, frequency)
        up = replace(level, amplitude=vertical_ratio, phase=vertical_phase) if vertical_ratio else None
        return ground(replace(level, vertical=up))

    frequencies = np.asarray(frequency_ratios, dtype=float) * scene.rocking_frequency
    unit = scene.gravity * np.tan(scene.block.slenderness)
    amplitudes = np.asarray(amplitude_ratios, dtype=float) * unit
    columns = np.array([pulse(frequency).shaking for frequency in frequencies])
    pulses = np.tile(columns, (len(amplitudes), 1))
    scales = pulses[:, Shaking._fields.index("scale")] = np.repeat(amplitudes, len(frequencies))
    pulses[:, Shaking._fields.index("upright_scale")] = vertical_ratio * scales
    rows = np.full(len(pulses), np.array(row_of(parameters(scene)), dtype=ROW))
    if scene.duration is None:
        rows["duration"] = pulses[:, Shaking._fields.index("end")] + longest_duration(scene.with_(motion=None))
    contacts = [sliding.contact_of(scene)] * len(rows)
    slowest = scene.with_(motion=PulseMotion(shape, 1.0, float(frequencies.min())))
    chosen = _outcome_options(tolerance, REST_RATE, STEPS, rubbing=[] if scene.friction is None else [slowest])
    totals = run_rows(rows, pulses, pulse(frequencies[0]), chosen, workers, contacts)
    return Outcomes.of(totals, (len(amplitudes), len(frequencies)))


def rocking_spectrum(
    motion: Motion,
    periods: npt.ArrayLike,
    slenderness: float,
    *,
    restitution_value: float | None = None,
    gravity: float = 9.81,
    duration: float | None = None,
    tolerance: float = TOLERANCE,
    workers: int | None = None,
) -> Outcomes:
    """Return the outcomes of rectangular blocks on rigid ground over their rocking period 2 pi/omega_r, shape (n,).

    Fig. 5(a) of the Caryatid paper is peak_tilt against `periods` [s]. The radius follows from the period and eq. (1);
    the mass does not matter. Without a duration each run goes on until its outcome is decided.
    """
    periods = np.asarray(periods, dtype=float)
    radii = 3 * gravity * (periods / (2 * np.pi)) ** 2 / 4  # (1) with J_O = 4/3 m R^2
    block = Block(mass=1.0, radius=1.0, slenderness=slenderness, restitution=restitution_value)
    scene = Scene(block=block, motion=motion, duration=duration, gravity=gravity)
    rows = np.full(len(periods), np.array(row_of(parameters(scene)), dtype=ROW))
    rows["R"], rows["J"], rows["p2"] = radii, 4 / 3 * radii**2, (2 * np.pi / periods) ** 2
    if duration is None:
        rows["duration"] = motion.end + CAP_PERIODS * periods
    shaking = ground(motion)
    pulses = np.tile(np.array(shaking.shaking), (len(periods), 1))
    chosen = _outcome_options(tolerance, REST_RATE, most_steps(scene))
    totals = run_rows(rows, pulses, shaking, chosen, workers)
    return Outcomes.of(totals, (len(periods),))
