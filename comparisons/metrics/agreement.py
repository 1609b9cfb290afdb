"""Agreement of an engine with the analytic model: the table of tolerances and the measures of its quantities.

A measure takes (engine, variant, scenes, runs) and returns a number, the worst value. scenes: what to run, one of the
names below. runs: a dict of simulations that several measures share.

The bounds stand in the records of the engines (`engines.exudyn`), their measures stand here. The verification tests
assert every row; the report prints the table with the values measured anew. A bound is at most twice the worst value
`measured` when it was set (except for round-off). If an engine gets better, the test says so, and the bound is to be
tightened.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from analytic import PulseMotion, Response, SampledMotion, Scene, Start, load_scene, simulate
from analytic.errors import SettingError
from analytic.rocking import BearingLaw
from analytic.scene import BASE, BEARINGS, caryatid_block
from engines import ENGINES, get_engine
from engines.contract import ROUNDING
from engines.swings import Trace
from engines.trace_checks import impulse_error

from .errors import compare, impact_errors, rms

STARTS = (0.3, 0.37, 0.44, 0.51, 0.59, 0.66, 0.73, 0.8)  # released tilt over slenderness
SLENDERNESSES = (0.1, 0.2, 0.3, 0.45)
IMPACTS = 3

# Names of scenes. The first four are families of free rocking.
RIGID, SLIDING = "rigid ground", "sliding base"
RIGID_2, SLIDING_2 = "rigid ground, slenderness 0.2", "sliding base, slenderness 0.2"
DRIVEN, ISOLATED = "rocking on bearings, one-sine", "isolated Caryatid, synthetic motion"
FALLING = "one-sine of 3.8 g slenderness, rigid ground"
PULSES = "one-sine at 2 and 5 times omega_r, rigid ground"
HARD_PULSES = "one-sine at 7, one-cosine at 2 times omega_r, rigid ground"  # the overturning study's largest shifts
STANDING, STANDING_ISOLATED = (
    "60 s of shaking below uplift, rigid ground",
    "60 s of shaking below uplift, on bearings",
)

FREE_ROCKING = {
    RIGID: (None, SLENDERNESSES),
    SLIDING: (BASE, SLENDERNESSES),
    RIGID_2: (None, (0.2,)),
    SLIDING_2: (BASE, (0.2,)),
}
# {name of scenes: (slenderness, ((pulse, its frequency over omega_r), ...))}
BOUNDARIES = {
    PULSES: (0.25, (("one-sine", 2.0), ("one-sine", 5.0))),
    HARD_PULSES: (0.28, (("one-sine", 7.0), ("one-cosine", 2.0))),
}


class Unmeasurable(RuntimeError):
    """The engine's run failed, or does not have the quantity to be measured; the message tells which and why."""


def traced(engine: str, variant: str, scene: Scene, history: bool = True) -> tuple[Response, Trace]:
    """Return (the engine's response, its accepted steps as a `Trace`).

    Raises
    ------
    Unmeasurable
        The run failed, or the scene gives the restitution.
    """
    if scene.block.restitution is not None:
        raise Unmeasurable("the restitution is given: it says nothing of the engine's own impact")
    response, trace = get_engine(engine).traced(scene, variant=variant, history=history)
    if response.failure is not None:
        raise Unmeasurable(f"{engine}, {variant} failed: {response.failure.reason}. {response.failure.message}")
    return response, trace


def free_rocking(scenes: str) -> dict[float, list[Scene]]:
    """Return {slenderness: scenes} of a family: free rocking from every start, beyond the third impact."""
    base, slendernesses = FREE_ROCKING[scenes]
    family: dict[float, list[Scene]] = {}
    for slenderness in slendernesses:
        block = caryatid_block(slenderness)
        for start in STARTS:
            scene = Scene(block=block, base=base, start=Start(tilt=start * slenderness), duration=12.0)
            times = [impact.time for impact in simulate(scene, history=False).impacts[: IMPACTS + 1]]
            family.setdefault(slenderness, []).append(scene.with_(duration=times[-2] + 0.75 * (times[-1] - times[-2])))
    return family


def _free_responses(engine, variant, scenes, runs):
    key = engine, variant, scenes
    if key not in runs:
        runs[key] = {
            slenderness: [(scene, traced(engine, variant, scene)[0]) for scene in family]
            for slenderness, family in free_rocking(scenes).items()
        }
    return runs[key]


def impact_rms(kind: str, engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the rms error of the first three impacts over starts and impacts, for the worst slenderness.

    kind: one of `impact_errors`: "state", of e_phi against eq. (7); "jump", of the base velocity jump against momentum,
    relative.
    """
    return max(
        rms(np.concatenate([impact_errors(scene, response, IMPACTS)[kind] for scene, response in pairs]))
        for pairs in _free_responses(engine, variant, scenes, runs).values()
    )


def swing_restitution_bias(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return |mean error| of e_phi against eq. (7), from the energies of the swings around the first three impacts."""
    errors = [
        impact_errors(scene, response, IMPACTS)["swing"]
        for pairs in _free_responses(engine, variant, scenes, runs).values()
        for scene, response in pairs
    ]
    return float(abs(np.nanmean(np.concatenate(errors))))


def impact_times(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the largest error of the times of the first three impacts [s]."""
    worst = 0.0
    for pairs in _free_responses(engine, variant, scenes, runs).values():
        for scene, response in pairs:
            wanted = [impact.time for impact in simulate(scene, history=False).impacts[:IMPACTS]]
            times = [impact.time for impact in response.impacts[:IMPACTS]]
            if len(times) < len(wanted):
                raise Unmeasurable(f"{engine}, {variant}: {len(times)} impacts, the model has {len(wanted)}")
            worst = max(worst, *np.abs(np.subtract(times, wanted)))
    return float(worst)


def named_scene(name: str) -> Scene:
    """Return the scene of this name, of those that are single scenes; `KeyError` for another name."""
    block, shaking = caryatid_block(0.2), 0.01 * np.arange(6001)
    level = np.sin(8 * shaking) + 0.5 * np.sin(26 * shaking)
    level /= np.abs(level).max()
    standing = Scene(block=block, duration=60.0, motion=SampledMotion(0.01, level * (0.9 * 9.81 * math.tan(0.2))))
    below = SampledMotion(0.01, level * 0.5)
    rocking = PulseMotion("one-sine", 3.0, 8.0)
    return {
        ISOLATED: load_scene("caryatid-isolated"),
        DRIVEN: Scene(block=caryatid_block(0.15), base=BASE, bearings=BEARINGS, motion=rocking, duration=3.0),
        FALLING: Scene(block=block, motion=PulseMotion("one-sine", 3.8 * 9.81 * 0.2, 5.2), duration=5.0),
        STANDING: standing,
        STANDING_ISOLATED: standing.with_(base=BASE, bearings=BEARINGS, motion=below),
    }[name]


def _agreement(engine, variant, scenes, runs):
    key = engine, variant, scenes
    if key not in runs:
        scene = named_scene(scenes)
        runs[key] = compare(scene, traced(engine, variant, scene)[0], simulate(scene))
    if not runs[key].same_outcome:
        raise Unmeasurable(f"{engine}, {variant}: another outcome than the model's in {scenes}")
    return runs[key]


def error_of(error: str, engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return |error| of a run over the whole scene. error: a field of `errors.Agreement`, which also gives the unit."""
    return abs(getattr(_agreement(engine, variant, scenes, runs), error))


def boundary_scene(slenderness: float, pulse: str, frequency: float, amplitude: float) -> Scene:
    """Return a scene of one pulse on rigid ground. frequency: over omega_r; amplitude: over g tan(slenderness)."""
    scene = Scene(block=caryatid_block(slenderness), duration=1.0)
    motion = PulseMotion(pulse, amplitude * 9.81 * math.tan(slenderness), frequency * scene.rocking_frequency)
    return scene.with_(motion=motion, duration=motion.end + 6.0)


def first_boundary(*pulse: Any) -> float:
    """Return the least amplitude over g tan(slenderness) at which the model overturns, by a scan and bisection.

    pulse: slenderness, shape and frequency, as for `boundary_scene`.
    """

    def falls(amplitude):
        return simulate(boundary_scene(*[*pulse, amplitude]), history=False).outcome == "overturns"

    amplitudes = np.arange(1.0, 12.0, 0.02)
    over = next(k for k, a in enumerate(amplitudes) if falls(float(a)))
    low, high = float(amplitudes[over - 1]), float(amplitudes[over])
    while high - low > 1e-7 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if falls(middle) else (middle, high)
    return high


def boundary_shift(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the largest relative shift of the first overturning boundary, including its bracket, under the pulses."""
    slenderness, pulses = BOUNDARIES[scenes]
    worst = 0.0
    for pulse in pulses:
        exact = first_boundary(slenderness, *pulse)

        def falls(shift, exact=exact, pulse=pulse):
            scene = boundary_scene(*[slenderness, *pulse, exact * (1 + shift)])
            return traced(engine, variant, scene, history=False)[0].outcome == "overturns"

        low, high = -1e-4, 1e-4
        while falls(low):
            low *= 4
        while not falls(high):
            high *= 4
        while high - low > max(1.3e-5, 0.05 * max(-low, high)):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if falls(middle) else (middle, high)
        worst = max(worst, abs(low), abs(high))
    return worst


def bearing_replay(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the largest difference over n_d f0 of the engine's bearing force from `paper_force` of its motion."""
    scene = named_scene(scenes)
    trace, law = traced(engine, variant, scene)[1], BearingLaw.of(scene.bearings)
    force = paper_force(law, trace.base_displacement)
    return float(np.abs(trace.bearing_force - force).max() / (law.count * law.f0))


def bearing_impulse(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the relative error of the bearing impulse that the momentum of the engine's motion shows.

    Unlike `bearing_replay` this does not use the force that the adapter reports.
    """
    scene = named_scene(scenes)
    return impulse_error(scene, traced(engine, variant, scene)[1])


def paper_force(law: BearingLaw, x: np.ndarray) -> np.ndarray:
    """Return the force of all bearings [N] along displacements x [m], shape (n,), x[0] = 0, by eqs (9) to (12).

    This is a second implementation beside `analytic.rocking`. Its history is the reversal points, there it is the last
    point. The sign in (12) is corrected. Travel since a reversal is at most 1.3 m.
    """
    force, s, x_j = np.zeros(len(x)), 0.0, 0.0
    for i in range(1, len(x)):
        direction = math.copysign(1.0, x[i] - x[i - 1]) if x[i] != x[i - 1] else s
        if direction != s:  # a reversal, or the first step
            s, x_j = direction, history_point(law, x[i - 1], force[i - 1], direction)
        if s:
            force[i] = branch(law, x[i], s, x_j)
    return law.count * force


def branch(law: BearingLaw, x: float, s: float, x_j: float, misprinted: bool = False) -> float:
    """Return the force of one bearing [N] on the branch of direction s, eqs (9) to (12), with the paper's x_j [m].

    The bracket is 1 + s x - s x_j + 2 x0. As printed, eq. (12) for unloading (s = -1) has the signs of loading:
    1 + x - x_j + 2 x0.
    """
    bracket = 1 + (1 if misprinted else s) * (x - x_j) + 2 * law.constants.x0
    return (
        law.kb * x
        + law.dk * (bracket ** (1 - law.constants.alpha) - law.constants.d0) / (s * (1 - law.constants.alpha))
        + s * law.f0
    )


def history_point(law: BearingLaw, x: float, force: float, s: float) -> float:
    """Return x_j [m] of the branch of direction s through a reversal at x [m] and force [N], eqs (10), (12)."""
    a, z = 1 - law.constants.alpha, force - law.kb * x
    return x + s * (1 + 2 * law.constants.x0 - (law.constants.d0 + a * (s * z - law.f0) / law.dk) ** (1 / a))


def corner_lift(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the largest lift [m] of a corner of a block that should stand."""
    scene = named_scene(scenes)
    response = traced(engine, variant, scene, history=False)[0]
    if response.outcome != "stands":
        raise Unmeasurable(f"{engine}, {variant}: {response.outcome} in {scenes}")
    return 2 * scene.block.half_width * response.peak_tilt


def base_drift(engine: str, variant: str, scenes: str, runs: dict[Any, Any]) -> float:
    """Return the largest difference of the base displacement from the model's [m] while the block stands."""
    scene = named_scene(scenes)
    history, reference = traced(engine, variant, scene)[0].history, simulate(scene).history
    return float(
        np.abs(np.interp(reference.time, history.time, history.base_displacement) - reference.base_displacement).max()
    )


@dataclass(frozen=True)
class Tolerance:
    """A row of the table: `quantity` of an engine's variant over `scenes`, as `measure` gives it, is at most `bound`.

    measured: the worst value when the bound was set. round_off: the bound is a requirement, and the measured value mere
    round-off, far below it. source: the cause of the error. bound, measured: None for an engine that states no
    tolerances; its values then neither hold nor fail.
    """

    quantity: str
    measure: Callable
    engine: str
    variant: str
    scenes: str
    bound: float | None
    unit: str
    measured: float | None
    source: str
    round_off: bool = False

    @property
    def name(self) -> str:
        return f"{self.quantity}: {self.engine}, {self.variant}, {self.scenes}"

    def found(self, runs: dict[Any, Any] | None = None) -> float:
        """Measure the quantity now. runs: a dict of simulations that rows share.

        Raises
        ------
        Unmeasurable
            A run failed.
        EngineNotInstalled
        """
        return self.measure(self.engine, self.variant, self.scenes, {} if runs is None else runs)

    def holds(self, value: float) -> bool | None:
        """Return whether a measured value is within the bound; None without a bound."""
        return None if self.bound is None else value <= self.bound

    def result(self, value: float | None, failure: str | None) -> dict[str, Any]:
        """Return the row as JSON values, with the `value` found or the reason of a failure."""
        names = "quantity", "engine", "variant", "scenes", "bound", "unit", "measured", "source"
        holds = self.holds(math.inf if value is None else value)
        return {name: getattr(self, name) for name in names} | {"found": value, "holds": holds, "failure": failure}

    def check(self, runs: dict | None = None) -> float:
        """Measure the quantity now and assert that it holds its bound, if any. Tests of an engine can call this:

            @pytest.mark.parametrize("row", rows("exudyn"), ids=lambda row: row.name)
            def test_engine(row):
                row.check()

        Raises
        ------
        AssertionError
            It does not hold; the message gives the value.
        Unmeasurable, EngineNotInstalled
            As for `found`.
        """
        value = self.found(runs)
        assert self.holds(value) is not False, f"{self.name}: {value:.3g} {self.unit}, tolerated {self.bound:.3g}"
        return value


# {quantity: (its measure, its unit)}
QUANTITIES: dict[str, tuple[Callable[..., float], str]] = {
    "restitution, rms": (partial(impact_rms, "state"), "-"),
    "restitution from swings, |mean error|": (swing_restitution_bias, "-"),
    "base velocity jump, rms": (partial(impact_rms, "jump"), "relative"),
    "impact times": (impact_times, "s"),
    "peak tilt": (partial(error_of, "peak_tilt_error"), "slenderness"),
    "peak displacement": (partial(error_of, "peak_displacement_error"), "relative"),
    "tilt graph": (partial(error_of, "graph_distance"), "-"),
    "overturning time": (partial(error_of, "overturning_time_error"), "s"),
    "overturning boundary": (boundary_shift, "relative"),
    "bearing force replayed": (bearing_replay, "f0"),
    "bearing impulse in the motion": (bearing_impulse, "relative"),
    "corner lift at rest": (corner_lift, "m"),
    "base drift at rest": (base_drift, "m"),
}


def _table():
    table = []
    for engine in ENGINES.values():
        for variant, bounds in engine.tolerance_rows().items():
            for bound in bounds:
                if bound.quantity not in QUANTITIES:
                    raise SettingError(
                        f"{engine.origin or engine.name}: {bound.quantity!r} is no quantity of the "
                        f"tolerance table; choose among {', '.join(QUANTITIES)}"
                    )
                measure, unit = QUANTITIES[bound.quantity]
                table.append(
                    Tolerance(
                        bound.quantity,
                        measure,
                        engine.name,
                        variant,
                        bound.scenes,
                        bound.bound,
                        unit,
                        bound.measured,
                        bound.source,
                        round_off=bound.source == ROUNDING,
                    )
                )
    return tuple(table)


TABLE = _table()


def rows(engine: str, variant: str | None = None) -> tuple[Tolerance, ...]:
    """Return the rows of an engine's variant; None: its main one.

    An engine that states no tolerances gets the rows of the first engine, without bounds.

    Raises
    ------
    EngineNotInstalled
    SettingError
        The engine has no such variant.

    Examples
    --------
    >>> row = rows("exudyn")[0]
    >>> row.check() <= row.bound
    True
    """
    known = get_engine(engine)
    variant = variant or known.default_variant
    if variant not in known.variants:
        raise SettingError(f"{engine} has no variant {variant!r}; choose among {', '.join(known.variants)}")
    if not known.tolerance_rows():
        first = next(iter(ENGINES.values()))
        usual = rows_of(first.name, next(iter(first.tolerance_rows())))
        free: dict[str, Any] = dict(engine=engine, variant=variant, bound=None, measured=None, source="")
        return tuple(replace(row, **free) for row in usual)
    return rows_of(engine, variant)


def rows_of(engine: str, variant: str) -> tuple[Tolerance, ...]:
    """Return the rows of `TABLE` for an engine's variant."""
    return tuple(row for row in TABLE if (row.engine, row.variant) == (engine, variant))


def measure_all(rows: Iterable[Tolerance] = TABLE) -> list[dict[str, Any]]:
    """Measure rows of the table now. Returns a list of dicts of JSON values, in the order of `rows`.

    Each has the row's columns, `found` (None if a run failed), `holds` (None without a bound) and `failure` (words or
    None).
    """
    runs: dict[Any, Any] = {}
    results = []
    for row in rows:
        value, failure = None, None
        try:
            value = row.found(runs)
        except Unmeasurable as error:
            failure = str(error)
        results.append(row.result(value, failure))
    return results
