"""The study of a statue on a free pedestal: are engines right where two blocks stand on each other, and what falls?

Engines and a time stepping run beside the model of `analytic.stack` in scenes drawn at random, and at the first fall of
a bust. In the model alone five ways to set up that bust are compared, and states are drawn in which an impact has no
answer or two.
"""

import itertools
import math
import time
from collections.abc import Generator, Iterator, Sequence
from typing import Any

import numpy as np

from analytic import Base, Block, Pedestal, PulseMotion, Response, Scene
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.response import COMPARED, EDGE, Impact, Stack, State
from analytic.rocking import design_bearings, uplift_of_both
from analytic.scene import BASE, BEARINGS, MASS
from analytic.stack.equations import StackModel
from analytic.stack.run import FALLS, SIZABLE
from engines import get_engine
from engines.comparison import CHANGE, PEAK
from engines.events import LEAST_TILT, STILL

from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request, together
from ...execution.sweep import Row
from ...metrics.boundaries import (
    DISTANCES,
    LEVEL_DISTANCES,
    LEVEL_TOLERANCE,
    TOLERANCE,
    Edge,
    Runs,
    Setting,
    usual_settings,
)
from ...metrics.statistics import class_of
from ...schemas.columns import declared, number_of, whole_of, word_of
from ..rows import BOUNDARY, BOUNDARY_ROW, SHARED, SOUGHT
from ..rows import EDGE as EDGE_ROW

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = (
    SHARED
    | BOUNDARY
    | declared(
        whole_of("index", "scene", "number of the scene", ""),
        word_of("outcome", "outcome", "outcome of the run: stands, rocks, overturns, pedestal overturns or failed"),
        number_of("hertz", "frequency", "frequency of the pulse", "Hz"),
        number_of("peak", "peak", "peak acceleration of the pulse", "g"),
        number_of("time_error", "error of the first impacts", "largest error of the first three impact times", "s"),
        number_of("pedestal_error", "error of the pedestal's tilt", "error of its peak, over its slenderness"),
        number_of("statue_error", "error of the statue's tilt", "error of its peak, over its slenderness"),
        number_of("change", "change of peak tilts", "largest change of a peak tilt over the slenderness by 1e-4 more"),
        number_of("demand", "friction demand", "largest |H|/N of both contacts"),
        number_of("impulse", "ratio of impulses", "largest ratio of impulses along and off a contact at an impact"),
        number_of("closest", "closest landings", "least time between two landings, one of each, in rocking periods"),
        word_of("way", "set-up", "how the bust is set up"),
        number_of("width", "width of the pedestal", "width of the pedestal", "m"),
        number_of("fall", "first fall", "least amplitude at which a block falls, in steps; null: none", "g"),
        number_of("displacement", "base displacement", "peak base displacement at the first fall", "m"),
        whole_of("outside", "outside the model", "amplitudes below it at which the run leaves the model"),
        word_of("closed", "impact", "what lands, and what is open"),
        whole_of("none", "no answer", "states in which no answer keeps all pivots"),
        whole_of("second", "a second answer", "states in which another answer lets the pivot jump"),
    )
)
PARTS = {
    "scene": """engine variant index ground hertz peak comparable | outcome change? demand impulse closest?
             cpu_per_second""",
    "run": """engine variant tier index ground class comparable | outcome quantities time_error? pedestal_error?
           statue_error? cpu_per_second""",
    "edge": EDGE_ROW,
    "shift": BOUNDARY_ROW,
    "failure": SOUGHT,
    "owner": "engine variant way hertz width fall? displacement? outside",
    "unique": "engine variant ground closed runs none second",
}

SEED = 71
SECONDS = 6.0  # of every run; long after the pulse, as a fall near its boundary is slow
FULL, QUICK = (60, (1.2, 1.5, 2.0), 0.02, 1500), (8, (1.5,), 0.1, 100)  # scenes, boundaries [Hz], steps [g], states
GROUNDS, BOUNDARY_GROUND = ("rigid ground", "bearings"), "free pedestal"
STRONGER = 1.5  # amplitudes on bearings over those on the ground: weaker ones lift nothing
FIRST = 3  # impacts whose times are compared
STEPPING, STEP = "time-stepping", 1e-5  # s
LEAST_SWING = 1e-6  # rad: smaller tilts of the stepping are its contacts'
NOTHING = dict.fromkeys(("time_error", "pedestal_error", "statue_error", "cpu_per_second"))
SOLVER = f"{__name__}:time_stepping"

BUST, HEIGHT, WIDTH, SQUARE = (0.25, 0.7, 120.0), 1.0, 0.4, 430 / 0.4**2  # m, m, kg; of the pedestal; kg/m2
WIDTHS, PULSES, WIDE = (0.35, 0.4, 0.5, 0.6), (0.8, 1.2, 2.0), 1.2  # m, Hz; Hz of the pulse for all widths
WAYS = ("fixed", "glued", "free", "isolated", "isolated and free")
PLATE, DESIGN = 50.0, {"period": 2.0, "damping": 0.1, "x_max": 0.3}  # kg; of `design_bearings`, s, -, m
CHUNK, MOST = 6, 3.0  # amplitudes at once; the largest [g]
NEAR = 1e-6  # relative, of the model's boundaries
# {impact: (interfaces that land, whether each block is open before)}; what does not land is open, or at rest
CLOSED = {
    "both land joined": ((True, True), (True, False)),
    "the statue lands, the pedestal rests": ((True, True), (False, True)),
    "both land at once": ((True, True), (True, True)),
    "the pedestal lands, the statue is tilted": ((True, False), (True, True)),
    "the statue lands, the pedestal is tilted": ((False, True), (True, True)),
}


def rectangle(width: float, height: float, mass: float) -> Block:
    """Return a homogeneous block [m, m, kg]."""
    return Block(mass=mass, radius=0.5 * math.hypot(width, height), slenderness=math.atan2(width, height))


def museum(index: int) -> Scene:
    """Return scene `index` of the ensemble: marble on stone under one sine, every second one on bearings."""
    rng = np.random.default_rng([SEED, index])
    width, height, tangent = rng.uniform(0.35, 0.9), rng.uniform(0.4, 1.3), rng.uniform(0.12, 0.4)
    across, hertz, factor = width * rng.uniform(0.3, 0.9), rng.uniform(0.8, 2.5), rng.uniform(1.05, 2.2)
    mass, block = 2700 * width**2 * height, rectangle(across, across / tangent, 1500 * across**3 / tangent)
    scene = Scene(block=block, pedestal=Pedestal(width=width, mass=mass, height=height, free=True), duration=SECONDS)
    if index % 2:  # the paper's bearings, as many as carry the weight
        count = max(1, round(BEARINGS.count * (mass + block.mass) / MASS))
        base, factor = Base(mass=BASE.mass * count / BEARINGS.count), STRONGER * factor
        scene = scene.with_(base=base, bearings=BEARINGS.model_copy(update={"count": count}))
    pulse = PulseMotion("one-sine", factor * uplift_of_both(scene), 2 * math.pi * hertz)
    return scene.with_(motion=pulse, name=f"museum {index}")


def bust(way: str, width: float = WIDTH) -> Scene:
    """Return the bust in one of `WAYS`, on a pedestal as deep as wide."""
    block, mass = rectangle(*BUST), SQUARE * width**2
    pedestal = Pedestal(width=width, mass=mass, height=HEIGHT, free=way.endswith("free"))
    if way.startswith("isolated"):
        bearings = design_bearings(block.mass + mass + PLATE, **DESIGN)
        return Scene(block=block, pedestal=pedestal, base=Base(mass=PLATE), bearings=bearings, duration=SECONDS)
    if way != "glued":
        return Scene(block=block, pedestal=pedestal, duration=SECONDS)
    parts = ((mass, 0.5 * HEIGHT, mass * (width**2 + HEIGHT**2) / 12),
             (block.mass, HEIGHT + block.half_height, block.centre_inertia))  # fmt: skip
    total, half = mass + block.mass, 0.5 * width
    high = sum(part * z for part, z, _ in parts) / total
    inertia = sum(own + part * (z * z + half * half) for part, z, own in parts)
    slenderness, radius = math.atan2(half, high), math.hypot(half, high)
    return Scene(
        block=Block(mass=total, radius=radius, slenderness=slenderness, corner_inertia=inertia), duration=SECONDS
    )


def time_stepping(scene: Scene, *, step: float = STEP, history: bool = False) -> Response:
    """Return the run of `analytic.checks.two_bodies`, as far as it is read here; it keeps no history."""
    fixed = scene.with_(pedestal={"free": False})
    simulate_two_bodies(fixed.with_(duration=step), step=step)  # compiled, before the clock starts
    clock = time.process_time()
    run = simulate_two_bodies(fixed, step=step)
    cpu, relative = time.process_time() - clock, run.upper - run.lower
    peak, lower, upper = (float(np.abs(tilt).max()) for tilt in (relative, run.lower, run.upper))
    on_ground, on_top = (tuple(landings(run.time, tilt)) for tilt in (run.lower, relative))
    return Response.unmeasured(
        engine=STEPPING,
        variant="",
        outcome={"lower": FALLS[0], "upper": FALLS[1], "": "rocks"}[run.fallen],
        peak_tilt=peak,
        peak_tilt_ratio=peak / scene.block.slenderness,
        impacts=on_top,
        stack=Stack((), lower, upper, on_ground, (), (), math.nan, math.nan, (math.nan, math.nan), None),
        cpu_seconds=cpu,
        settings={"step": step},
        versions={},
        end=State(float(run.time[-1]), *[math.nan] * 5),
    )


def landings(times: np.ndarray, tilt: np.ndarray) -> Iterator[Impact]:
    """Yield the impacts that end the swings of a tilt; their times are extrapolated from the last two steps before."""
    side = np.sign(tilt) * (np.abs(tilt) > LEAST_SWING)
    last = np.flatnonzero((side[1:-1] != 0) & (side[2:] != side[1:-1]) & (side[:-2] == side[1:-1])) + 1
    rates = (tilt[last] - tilt[last - 1]) / (times[last] - times[last - 1])
    for when, rate in zip((times[last] - tilt[last] / rates).tolist(), rates.tolist(), strict=True):
        yield Impact(when, rate, math.nan, math.nan)


def measured(case: Case, response: Response) -> dict[str, Any]:
    """Measure a run of two blocks; tilts: peaks of both over their slendernesses, landings: times [s] on each."""
    scene, stack = case.scene, response.stack
    assert stack is not None
    slabs = StackModel.of(scene).slabs
    tilts = [stack.peak_tilt / slabs[0].slenderness, response.peak_tilt_ratio]
    moved = "rocks" if max(tilts) >= STILL else "stands"
    impacts = [
        [
            impact.time
            for impact in row
            if abs(impact.rate_before) > SIZABLE * scene.rocking_frequency * slab.slenderness
        ]
        for row, slab in zip((stack.impacts, response.impacts), slabs, strict=True)
    ]
    return {
        "outcome": response.outcome if response.outcome in FALLS else moved,
        "tilts": tilts,
        "landings": impacts,
        "demand": max(stack.friction_demand, response.friction_demand),
        "impulse": max(stack.impulses),
        "closest": stack.closest,
        "simulated": response.end.time,
    }


def fate(case: Case, response: Response) -> dict[str, Any]:
    """Measure whether anything falls, and how far the base moves."""
    return {
        "falls": response.outcome in FALLS,
        "displacement": response.peak_base_displacement,
        "impacts": len(response.impacts),
        "normal": response.min_normal_ratio,
    }


def scene_row(row: Row, copies: Sequence[Row]) -> dict[str, Any]:
    """Row of the model's run; copies: with the motion changed by `CHANGE`."""
    scene, values = row.case.scene, row.values
    about = {
        "part": "scene",
        "engine": "analytic",
        "variant": "",
        "index": row.case.tag["index"],
        "ground": GROUNDS[scene.base is not None],
        "hertz": scene.motion.frequency / (2 * math.pi),
        "peak": scene.motion.amplitude / scene.gravity,
    }
    if row.failed:
        return {**about, "outcome": "failed", "comparable": row.failure["reason"], "failure": row.failure}
    outcomes = {None if copy.failed else copy.values["outcome"] for copy in copies}
    alike = outcomes == {values["outcome"]}
    apart = [abs(a - b) for copy in copies if alike for a, b in zip(copy.values["tilts"], values["tilts"], strict=True)]
    return {
        **about,
        "comparable": COMPARED if alike else EDGE,
        **{name: values[name] for name in ("outcome", "demand", "impulse", "closest")},
        "change": max(apart, default=None) if values["outcome"] not in FALLS else None,
        "cpu_per_second": row.cost["cpu_seconds"] / values["simulated"],
    }


def run_row(row: Row, model: Row, comparable: str) -> dict[str, Any]:
    """Row of a run beside the model's: errors of the first impacts, and of the peaks of blocks that stay upright."""
    engine, own, values = row.case.solver, row.values, model.values
    about = {
        "part": "run",
        "engine": STEPPING if engine == SOLVER else engine,
        "variant": row.case.variant or "",
        "tier": "model" if engine == SOLVER else get_engine(engine).variants[row.case.variant].kind,
        "index": row.case.tag["index"],
        "ground": GROUNDS[row.case.scene.base is not None],
        "comparable": comparable,
    }
    if row.failed or model.failed:
        about |= {"failure": row.failure} if row.failed else {}
        return {**about, "class": class_of(comparable, None), "outcome": own["outcome"], "quantities": [], **NOTHING}
    upright = not {own["outcome"], values["outcome"]} & {*FALLS}
    errors = [abs(a - b) if upright else None for a, b in zip(own["tilts"], values["tilts"], strict=True)]
    quantities = ["outcome"] * (own["outcome"] != values["outcome"]) + ["peak_tilt"] * any(
        error > PEAK * max(tilt, LEAST_TILT) for error, tilt in zip(errors, values["tilts"], strict=True) if upright
    )
    first = sorted((when, k) for k in (0, 1) for when in values["landings"][k])[:FIRST]
    late = [min((abs(other - when) for other in own["landings"][k]), default=math.inf) for when, k in first]
    return {
        **about,
        "class": class_of(comparable, quantities),
        "outcome": own["outcome"],
        "quantities": quantities,
        "time_error": max(late) if late and max(late) < math.inf else None,
        "pedestal_error": errors[0],
        "statue_error": errors[1],
        "cpu_per_second": row.cost["cpu_seconds"] / own["simulated"],
    }


def answers(index: int, kind: str, draw: int) -> tuple[bool, bool]:
    """Return whether an impact in a random state has no answer without a jump of the pivot, and one with a jump.

    The blocks are those of `museum`, on the ground or on bearings.
    """
    scene, (shut, opened) = museum(index), CLOSED[kind]
    model, rng = StackModel.of(scene), np.random.default_rng([SEED, index, draw])
    gammas = np.array([slab.slenderness for slab in model.slabs])
    sides = rng.choice([-1, 1], 2) * opened
    tilts = sides * gammas * rng.uniform(0, 0.9, 2) * np.logical_not(shut)
    rates = gammas * scene.rocking_frequency * rng.uniform(-1, 1, 2)
    rates = np.where(shut, -sides * np.abs(rates), rates)  # what lands closes
    v = 0.0 if scene.base is None else float(rng.normal(0, 0.3))
    found = model.impact(sides.tolist(), np.cumsum(tilts).tolist(), np.cumsum(rates).tolist(), v, shut)
    jumps = [answer.jumps for answer in found]
    return all(jumps), any(jumps) and not all(jumps)


def unique(states: int) -> Iterator[dict[str, Any]]:
    """Yield rows on how many of so many random states have no answer, or a second one."""
    for ground, kind in itertools.product((0, 1), CLOSED):
        none, second = np.sum([answers(2 * k + ground, kind, k) for k in range(states)], axis=0).tolist()
        about = {"part": "unique", "engine": "analytic", "variant": "", "ground": GROUNDS[ground], "closed": kind}
        yield {**about, "runs": states, "none": none, "second": second}


Search = Generator[list[float], list[Row], tuple[float | None, Row | None, int]]


def first_fall(step: float, tolerance: float = math.inf) -> Search:
    """Search for the least peak [g] at which a block falls, in steps, and by bisection if `tolerance` (relative) is given.

    Returns
    -------
    generator
        For `plan.together`. It yields peaks, is sent their rows, and returns the first peak that falls, or None, its
        row, and at how many lower ones a run leaves the model.
    """
    outside = 0
    for begin in range(1, round(MOST / step) + 1, CHUNK):
        peaks = [step * k for k in range(begin, begin + CHUNK)]
        for peak, row in zip(peaks, (yield peaks), strict=True):
            if not row.failed and row.values["falls"]:
                low, high = peak - step, peak
                while high - low > tolerance * high:
                    middle = 0.5 * (low + high)
                    (between,) = yield [middle]
                    falls = not between.failed and between.values["falls"]
                    low, high, row = (low, middle, between) if falls else (middle, high, row)
                return high, row, outside
            outside += row.failed
    return None, None, outside


def searched(searches: Sequence[tuple[Scene, float, Search]], label: str) -> Generator[Batch, list[Row], list[Any]]:
    """Return the results of searches in the model, each of a scene under one sine of so many Hz."""
    rounds, rows = together([search for *_, search in searches]), None
    while True:
        try:
            asked = rounds.send(rows)  # type: ignore[arg-type]  # None starts it
        except StopIteration as stop:
            return stop.value
        cases = [Case(shaken(*searches[k][:2], peak), settings={"history": False}) for k, peak in asked]
        rows = yield Batch(cases, fate, label)


def shaken(scene: Scene, hertz: float, peak: float) -> Scene:
    """Return the scene under one sine; peak [g]."""
    return scene.with_(motion=PulseMotion("one-sine", peak * scene.gravity, 2 * math.pi * hertz))


def able(engines: Sequence[str]) -> list[str]:
    """Return the engines that stack blocks."""
    return [name for name in engines if hasattr(get_engine(name).load(), "run_stack")]


def plan(request: Request, size: tuple[int, Sequence[float], float, int] | None = None) -> Plan:
    """Plan the study.

    Rows by "part": "scene", the model's run of a random scene, and "run", another solver's; "edge", "shift" and
    "failure", the first fall of the bust on its pedestal in the model and in other solvers, see `overturning`; "owner",
    the first fall of a set-up in the model; "unique", how many random states have no answer of the impact law, or two.

    size : numbers of scenes, frequencies of the boundaries [Hz], step of first falls [g], and number of states, in
        place of FULL or QUICK.
    """
    count, frequencies, step, states = size or (QUICK if request.quick else FULL)
    engines, quiet = able(request.engines), {"history": False}
    main, others = usual_settings(engines)
    # 1. random scenes
    scenes = list(map(museum, range(count)))
    factors = (1.0, 1 + CHANGE, 1 - CHANGE)
    cases = [
        Case(scene.with_(motion=scene.motion.scaled(factor)), settings=quiet, tag={"index": k})
        for k, scene in enumerate(scenes) for factor in factors
    ]  # fmt: skip
    runs = yield Batch(cases, measured, "analytic model")
    model, copies = runs[::3], list(zip(runs[1::3], runs[2::3], strict=True))
    rows = [scene_row(*each) for each in zip(model, copies, strict=True)]
    comparable = [row["comparable"] for row in rows]
    solvers = [(SOLVER, None, quiet), *((each.engine, each.variant, quiet) for each in (*main, *others))]
    cases = [Case(scene, *solver, {"index": k}) for solver in solvers for k, scene in enumerate(scenes)]
    for row in (yield Batch(cases, measured, "engines")):
        index = row.case.tag["index"]
        rows.append(run_row(row, model[index], comparable[index]))
    # 2. the first fall of the bust, on rigid ground
    stack = bust("free")
    found = yield from searched([(stack, hertz, first_fall(step, NEAR)) for hertz in frequencies], "boundaries")
    edges = [edge_of(stack, hertz, peak, row) for hertz, (peak, row, _) in zip(frequencies, found, strict=True) if row]
    rows += [{"part": "edge", "engine": "analytic", "variant": "", **vars(edge)} for edge in edges]
    search = Runs({BOUNDARY_GROUND: stack})
    fine = [Setting(SOLVER, "", STEP), *main]
    for settings, distances, tolerance in ((fine, DISTANCES, TOLERANCE), (others, LEVEL_DISTANCES, LEVEL_TOLERANCE)):
        rows += yield from search.search("shift", settings, edges, distances, tolerance)
    # 3. the owner's table: set-ups at each frequency, and widths at one
    ways = [(way, hertz, WIDTH) for way in WAYS for hertz in PULSES]
    ways += [(way, WIDE, width) for way in ("fixed", "glued", "free") for width in WIDTHS if width != WIDTH]
    found = yield from searched([(bust(way, width), hertz, first_fall(step)) for way, hertz, width in ways], "owner")
    for (way, hertz, width), (peak, row, outside) in zip(ways, found, strict=True):
        about = {"part": "owner", "engine": "analytic", "variant": "", "way": way, "hertz": hertz, "width": width}
        moved = row.values["displacement"] if row and way.startswith("isolated") else None
        rows.append({**about, "fall": peak, "displacement": moved, "outside": outside})
    rows += unique(states)
    rows += search.failures
    return Computed(
        {
            "quick": request.quick,
            "scenes": count,
            "step": step,
            "seconds": SECONDS,
            "tolerance": TOLERANCE,
            "unit": math.tan(stack.block.slenderness),
            "omega_r": stack.rocking_frequency,
            "bearings": bust("isolated").bearings.model_dump(),
            "engines": engines,
            "variants": [variant_settings(each.engine, each.variant) for each in (*main, *others)],
            "default_variants": {each.engine: each.variant for each in main},
        },
        [row | ({"engine": STEPPING} if row["engine"] == SOLVER else {}) for row in rows],
        seed=SEED,
    )


def edge_of(scene: Scene, hertz: float, peak: float, row: Row) -> Edge:
    """Return a boundary of the model as searches of engines take it: in their units, with no other one near."""
    amplitude = peak / math.tan(scene.block.slenderness)
    frequency = 2 * math.pi * hertz / scene.rocking_frequency
    mode, normal = row.values["impacts"], row.values["normal"]
    return Edge(BOUNDARY_GROUND, "one-sine", frequency, amplitude, True, mode, 0.5 * amplitude, 2 * amplitude, normal)
