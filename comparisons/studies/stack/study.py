"""The study of a statue on a free pedestal: are engines right where two blocks stand on each other, and what falls?

Engines and a time stepping run beside the model of `analytic.stack` in scenes drawn at random, and at the first fall of
a bust. In the model alone five ways to set up that bust are compared, and states are drawn in which an impact has no
answer or two.
"""

import itertools
import math
import time
from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from analytic import Base, Block, Pedestal, PulseMotion, Response, Scene, simulate
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.response import COMPARED, EDGE, Impact, Stack, State
from analytic.rocking import design_bearings, uplift_of_both
from analytic.scene import BASE, BEARINGS, MASS
from analytic.stack.equations import StackModel
from analytic.stack.run import FALLS, SIZABLE
from engines import get_engine
from engines.comparison import CHANGE, PEAK
from engines.events import LEAST_TILT, STILL
from engines.loads import FRICTION

from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.sweep import Row
from ...metrics.boundaries import (
    BESIDE,
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
        number_of("hertz", "frequency", "frequency of the pulse", "Hz", digits=None),
        number_of("peak", "peak", "peak acceleration of the pulse", "g"),
        number_of("time_error", "error of the first impacts", "largest error of the first three impact times", "s"),
        number_of("pedestal_error", "error of the pedestal's tilt", "error of its peak, over its slenderness"),
        number_of("statue_error", "error of the statue's tilt", "error of its peak, over its slenderness"),
        number_of("change", "change of peak tilts", "largest change of a peak tilt over the slenderness by 1e-4 more"),
        number_of("demand", "friction demand", "largest |H|/N of both contacts"),
        number_of("impulse", "ratio of impulses", "largest ratio of impulses along and off a contact at an impact"),
        number_of("closest", "closest landings", "least time between two landings, one of each, in rocking periods"),
        word_of("way", "mounting", "how the bust is set up"),
        number_of("width", "width of the pedestal", "width of the pedestal", "m", digits=None),
        number_of("fall", "first fall", "least peak at which a block falls, in steps; null: none", "g", digits=None),
        number_of("displacement", "base displacement", "peak base displacement at the first fall", "m"),
        whole_of("outside", "outside the model", "lower peaks at which the run leaves the model"),
        word_of("closed", "impact", "what lands, and what is open"),
        whole_of("none", "no answer", "states in which no answer keeps all pivots"),
        whole_of("second", "a second answer", "states in which another answer lets the pivot jump"),
    )
)
PARTS = {
    "scene": """engine variant index ground hertz peak comparable | outcome change? demand impulse closest?
             cpu_per_second""",
    "run": """engine variant tier index ground class comparable | outcome quantities time_error? pedestal_error?
           statue_error? cpu_per_second?""",
    "edge": EDGE_ROW,
    "shift": BOUNDARY_ROW,
    "check": BOUNDARY_ROW,
    "failure": SOUGHT,
    "mounting": "engine variant way hertz width fall? displacement? outside",
    "unique": "engine variant ground closed runs none second",
}

ERRORS, SEED = ("time_error", "pedestal_error", "statue_error", "cpu_per_second"), 71
SECONDS, FIRST = 6.0, 3  # of every run, long after the pulse, as falls near a boundary are slow; impacts compared
FULL, QUICK = (60, (1.2, 1.5, 2.0), 0.02, 1500), (8, (1.5,), 0.1, 100)  # scenes, boundaries [Hz], steps [g], states
GROUNDS, FREE, SINE = ("rigid ground", "bearings"), "free pedestal", "one-sine"
# range of each number of a random scene; peak: over the acceleration that lifts the weaker block
LIMITS = {
    "width": (0.35, 0.9),
    "height": (0.4, 1.3),
    "tangent": (0.12, 0.4),
    "share": (0.3, 0.9),
    "hertz": (0.8, 2.5),
    "peak": (1.05, 2.2),
}
STRONGER = 1.5  # amplitudes on bearings over those on the ground: weaker ones lift nothing
NEAR, LEAST_SWING = 1e-6, 1e-6  # of the model's boundaries; rad: smaller tilts of the stepping are its contacts'
STEPPING, SOLVER, STEP = "time-stepping", f"{__name__}:time_stepping", 1e-5  # s
# bust: width, height [m], mass [kg]; pedestal: width, height [m], mass over width squared [kg/m2]
BUST, WIDTH, HEIGHT, SQUARE = (0.25, 0.7, 120.0), 0.4, 1.0, 430 / 0.4**2
PLATE, PERIOD, DAMPING, X_MAX = 50.0, 2.0, 0.1, 0.3  # mass of the base [kg]; of `design_bearings` [s, -, m]
WAYS, PULSES, MOST = ("fixed", "glued", "free", "isolated", "isolated and free"), (0.8, 1.2, 2.0), 1.8  # Hz; g
WIDTHS, WIDE = (0.35, 0.5, 0.6), 1.2  # m, beside `WIDTH`; Hz of the pulse
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
    limits = zip(*LIMITS.values(), strict=True)
    width, height, tangent, share, hertz, factor = np.random.default_rng([SEED, index]).uniform(*limits).tolist()
    across, mass = width * share, 2700 * width**2 * height
    block = rectangle(across, across / tangent, 1500 * across**3 / tangent)
    scene = Scene(block=block, pedestal=Pedestal(width=width, mass=mass, height=height, free=True), duration=SECONDS)
    if index % 2:  # the paper's bearings, as many as carry the weight
        count = max(1, round(BEARINGS.count * (mass + block.mass) / MASS))
        base, factor = Base(mass=BASE.mass * count / BEARINGS.count), STRONGER * factor
        scene = scene.with_(base=base, bearings=BEARINGS.model_copy(update={"count": count}))
    return shaken(scene, hertz, factor * uplift_of_both(scene) / scene.gravity)


def bust(way: str, width: float = WIDTH) -> Scene:
    """Return the bust in one of `WAYS`, on a pedestal as deep as wide."""
    block, mass, half = rectangle(*BUST), SQUARE * width**2, 0.5 * width
    pedestal = Pedestal(width=width, mass=mass, height=HEIGHT, free=way.endswith("free"))
    if way == "glued":  # one block about the corner of the pedestal
        total, top = mass + block.mass, HEIGHT + block.half_height
        high = (0.5 * HEIGHT * mass + top * block.mass) / total
        inertia = rectangle(width, HEIGHT, mass).inertia + block.centre_inertia + block.mass * (half**2 + top**2)
        radius, slenderness = math.hypot(half, high), math.atan2(half, high)
        block = Block(mass=total, radius=radius, slenderness=slenderness, corner_inertia=inertia)
        return Scene(block=block, duration=SECONDS)
    scene = Scene(block=block, pedestal=pedestal, duration=SECONDS)
    bearings = design_bearings(mass + block.mass + PLATE, PERIOD, DAMPING, X_MAX)
    return scene.with_(base=Base(mass=PLATE), bearings=bearings) if way.startswith("isolated") else scene


def time_stepping(scene: Scene, *, step: float = STEP, history: bool = False) -> Response:
    """Return the run of `analytic.checks.two_bodies`, as far as it is read here; it keeps no history."""
    fixed = scene.with_(pedestal={"free": False})
    simulate_two_bodies(fixed.with_(duration=step), step=step)  # compiled, before the clock starts
    clock = time.process_time()
    run = simulate_two_bodies(fixed, step=step)
    cpu, tilts = time.process_time() - clock, (run.lower, run.upper, run.upper - run.lower)
    lower, upper, peak = (float(np.abs(tilt).max()) for tilt in tilts)
    below, _, above = (landings(run.time, tilt) for tilt in tilts)
    return Response.unmeasured(
        engine=STEPPING,
        variant="",
        outcome={"lower": FALLS[0], "upper": FALLS[1], "": "rocks"}[run.fallen],
        peak_tilt=peak,
        peak_tilt_ratio=peak / scene.block.slenderness,
        impacts=above,
        stack=Stack((), lower, upper, below, (), (), math.nan, math.nan, (math.nan, math.nan), None),
        cpu_seconds=cpu,
        settings={"step": step},
        versions={},
        end=State(float(run.time[-1]), *[math.nan] * 5),
    )


def landings(times: np.ndarray, tilt: np.ndarray) -> tuple[Impact, ...]:
    """Return the impacts that end the swings of a tilt; their times are extrapolated from the last two steps before."""
    side = np.sign(tilt) * (np.abs(tilt) > LEAST_SWING)
    last = np.flatnonzero((side[1:-1] != 0) & (side[2:] != side[1:-1]) & (side[:-2] == side[1:-1])) + 1
    rates = (tilt[last] - tilt[last - 1]) / (times[last] - times[last - 1])
    ends = (times[last] - tilt[last] / rates).tolist(), rates.tolist()
    return tuple(Impact(when, rate, math.nan, math.nan) for when, rate in zip(*ends, strict=True))


def measured(case: Case, response: Response) -> dict[str, Any]:
    """Measure a run of two blocks; tilts: peaks of both over their slendernesses, landings: times [s] on each."""
    scene, stack, slabs = case.scene, cast(Any, response.stack), StackModel.of(case.scene).slabs
    tilts = [stack.peak_tilt / slabs[0].slenderness, response.peak_tilt_ratio]
    least = [SIZABLE * scene.rocking_frequency * slab.slenderness for slab in slabs]  # rates of landings that count
    demand, impulse = max(stack.friction_demand, response.friction_demand), max(stack.impulses)
    pressed = min(stack.min_normal_ratio, response.min_normal_ratio) > 0
    return {
        "outcome": response.outcome if response.outcome in FALLS else "rocks" if max(tilts) >= STILL else "stands",
        "tilts": tilts,
        "landings": [
            [impact.time for impact in impacts if abs(impact.rate_before) > rate]
            for impacts, rate in zip((stack.impacts, response.impacts), least, strict=True)
        ],
        "demand": demand,
        "impulse": impulse,
        "closest": stack.closest,
        "held": ""
        if pressed and max(demand, impulse) <= FRICTION
        else f"a contact pulls, or needs a friction above {FRICTION:g}",
        "simulated": response.end.time,
    }


def fate(case: Case, response: Response) -> dict[str, Any]:
    """Measure whether a block falls, and how far the base moves."""
    return {"falls": response.outcome in FALLS, "displacement": response.peak_base_displacement}


def scene_row(row: Row, *copies: Row) -> dict[str, Any]:
    """Return the row of the model's run; copies: with the motion changed by `CHANGE`."""
    scene, values = row.case.scene, row.values
    about = {
        "part": "scene",
        "engine": "analytic",
        "variant": "",
        "index": row.case.tag["index"],
        "ground": GROUNDS[scene.base is not None],
        "hertz": scene.motion.frequency / (2 * math.pi),
        "peak": scene.motion.amplitude / scene.gravity,
        "outcome": values["outcome"],
    }
    if row.failed:
        return {**about, "comparable": row.failure["reason"], "failure": row.failure}
    alike = all(copy.values["outcome"] == values["outcome"] for copy in copies)
    changes = [np.abs(np.subtract(copy.values["tilts"], values["tilts"])).max() for copy in copies if alike]
    return {
        **about,
        "comparable": values["held"] or (COMPARED if alike else EDGE),
        "change": None if values["outcome"] in FALLS else max(map(float, changes), default=None),
        **{name: values[name] for name in ("demand", "impulse", "closest")},
        "cpu_per_second": row.cost["cpu_seconds"] / values["simulated"],
    }


def run_row(row: Row, model: Row, comparable: str) -> dict[str, Any]:
    """Return the row of a run beside the model's, with errors of the first impacts, and of blocks that stay upright."""
    own, expected, engine = row.values, model.values, row.case.solver
    about = {
        "part": "run",
        "engine": engine,
        "variant": row.case.variant or "",
        "tier": "model" if engine == SOLVER else get_engine(engine).variants[row.case.variant].kind,
        "index": row.case.tag["index"],
        "ground": GROUNDS[row.case.scene.base is not None],
        "comparable": comparable,
        "outcome": own["outcome"],
    }
    if row.failed or model.failed:
        about |= {"failure": row.failure} if row.failed else {**dict.fromkeys(ERRORS), "quantities": []}
        return {**about, "class": class_of(comparable, None)}
    errors = np.abs(np.subtract(own["tilts"], expected["tilts"]))
    upright = not {own["outcome"], expected["outcome"]} & {*FALLS}
    off = upright and (errors > PEAK * np.maximum(expected["tilts"], LEAST_TILT)).any()
    quantities = ["outcome"] if own["outcome"] != expected["outcome"] else ["peak_tilt"] if off else []
    first = sorted((when, k) for k in (0, 1) for when in expected["landings"][k])[:FIRST]
    late = max((min((abs(t - when) for t in own["landings"][k]), default=math.inf) for when, k in first), default=None)
    return {
        **about,
        "class": class_of(comparable, quantities),
        "quantities": quantities,
        "time_error": None if late == math.inf else late,
        **dict(zip(("pedestal_error", "statue_error"), errors.tolist() if upright else (None, None), strict=True)),
        "cpu_per_second": row.cost["cpu_seconds"] / own["simulated"],
    }


def mounting_row(way: str, hertz: float, width: float, peaks: Sequence[float], rows: Sequence[Row]) -> dict[str, Any]:
    """Return the row of a mounting from its runs at rising peaks."""
    first = next((k for k, row in enumerate(rows) if not row.failed and row.values["falls"]), None)
    return {
        **{"part": "mounting", "engine": "analytic", "variant": "", "way": way, "hertz": hertz, "width": width},
        "fall": None if first is None else peaks[first],
        "displacement": None if first is None or way not in WAYS[3:] else rows[first].values["displacement"],
        "outside": sum(row.failed for row in rows[:first]),
    }


def answers(index: int, kind: str) -> tuple[bool, bool]:
    """Return whether an impact in a random state has no answer that keeps the pivots; and such a one and another."""
    scene, (shut, opened), rng = museum(index), CLOSED[kind], np.random.default_rng([SEED, index, 1])
    model, sides, frequency = StackModel.of(scene), rng.choice([-1, 1], 2) * opened, scene.rocking_frequency
    tilts, rates = (rng.uniform(0, 1, (2, 2)) * [[0.9], [frequency]]) * [slab.slenderness for slab in model.slabs]
    turns = np.where(shut, -sides, rng.choice([-1, 1], 2))  # what lands closes
    tilts, rates = np.cumsum(sides * tilts * np.logical_not(shut)), np.cumsum(turns * rates)
    v = float(rng.normal(0, 0.3)) if scene.base else 0.0
    jumps = {None in answer.sides for answer in model.impact(sides.tolist(), tilts.tolist(), rates.tolist(), v, shut)}
    return False not in jumps, jumps == {True, False}


def shaken(scene: Scene, hertz: float, peak: float) -> Scene:
    """Return the scene under one sine; peak [g]."""
    return scene.with_(motion=PulseMotion(SINE, peak * scene.gravity, 2 * math.pi * hertz))


def edge_of(scene: Scene, hertz: float, peak: float) -> Edge:
    """Return a boundary of the model at a peak [g], as the searches of `metrics.boundaries` take it."""
    amplitude, frequency = peak / math.tan(scene.block.slenderness), 2 * math.pi * hertz / scene.rocking_frequency
    beside = simulate(shaken(scene, hertz, peak * (1 + BESIDE)), history=False)
    room = 0.5 * amplitude, 2 * amplitude  # no other boundary is known
    return Edge(FREE, SINE, frequency, amplitude, True, len(beside.impacts), *room, beside.min_normal_ratio)


# Long, because a plan is best read in one piece, from the first run to the last row.
def plan(request: Request, size: tuple[int, Sequence[float], float, int] | None = None) -> Plan:
    """Plan the study.

    Rows by "part": "scene", the model's run of a random scene, and "run", another solver's; "mounting", the first fall
    of a bust in the model; "edge", "shift", "check" and "failure", that of the free one, in engines and the time
    stepping, see `metrics.boundaries`; "unique", how many random states have no answer of the impact law, or a second.

    size : number of scenes, frequencies of the boundaries [Hz], step of the peaks [g], and number of states, in place
        of FULL or QUICK.
    """
    count, hertzes, step, states = size or (QUICK if request.quick else FULL)
    engines = [name for name in request.engines if hasattr(get_engine(name).load(), "run_stack")]
    quiet, (main, others), stepping = {"history": False}, usual_settings(engines), Setting(SOLVER, "", STEP)
    scenes = list(enumerate(map(museum, range(count))))
    near = [
        (k, scene.with_(motion=scene.motion.scaled(factor)))
        for k, scene in scenes
        for factor in (1, 1 + CHANGE, 1 - CHANGE)
    ]
    model = yield Batch([Case(scene, settings=quiet, tag={"index": k}) for k, scene in near], measured, "model")
    rows = [scene_row(*model[k : k + 3]) for k in range(0, len(model), 3)]
    solvers = [(one.engine, one.variant or None, quiet) for one in (stepping, *main, *others)]
    engine_runs = yield Batch(
        [Case(scene, *solver, {"index": k}) for solver in solvers for k, scene in scenes], measured, "engines"
    )
    runs = [(row.case.tag["index"], row) for row in engine_runs]
    rows += [run_row(row, model[3 * k], rows[k]["comparable"]) for k, row in runs]
    mountings = [*itertools.product(WAYS, PULSES, [WIDTH]), *itertools.product(WAYS[:3], [WIDE], WIDTHS)]
    mountings += [("free", hertz, WIDTH) for hertz in hertzes if hertz not in PULSES]
    peaks, stack = [round(step * k, 12) for k in range(1, round(MOST / step) + 1)], bust("free")
    falls = yield Batch(
        [Case(shaken(bust(way, width), hertz, g), settings=quiet) for way, hertz, width in mountings for g in peaks],
        fate,
        "mountings",
    )
    found = [
        mounting_row(way, hertz, width, peaks, falls[k : k + len(peaks)])
        for (way, hertz, width), k in zip(mountings, range(0, len(falls), len(peaks)), strict=True)
    ]
    free = [
        row
        for row in found
        if row["way"] == "free" and row["width"] == WIDTH and row["hertz"] in hertzes and row["fall"]
    ]
    rough = [edge_of(stack, row["hertz"], row["fall"] - 0.5 * step) for row in free]
    search, unit = Runs({FREE: stack}), math.tan(stack.block.slenderness)
    located = yield from search.search("edge", [Setting("analytic", "", 0.0)], rough, DISTANCES, NEAR)
    edges = [
        edge_of(stack, row["hertz"], edge.amplitude * unit * (1 + each["shift"]))
        for row, edge, each in zip(free, rough, located, strict=True)
        if each["shift"] is not None
    ]
    for part, settings, distances, tolerance in (
        ("check", [stepping], DISTANCES, TOLERANCE),
        ("shift", main, DISTANCES, TOLERANCE),
        ("shift", others, LEVEL_DISTANCES, LEVEL_TOLERANCE),
    ):
        found += yield from search.search(part, settings, edges, distances, tolerance)
    rows += [*found, *({"part": "edge", "engine": "analytic", "variant": "", **vars(edge)} for edge in edges)]
    for k, kind in itertools.product((0, 1), CLOSED):
        none, second = np.sum([answers(2 * index + k, kind) for index in range(states)], axis=0).tolist()
        about = {"part": "unique", "engine": "analytic", "variant": "", "ground": GROUNDS[k], "closed": kind}
        rows.append({**about, "runs": states, "none": none, "second": second})
    return Computed(
        {
            "quick": request.quick,
            "scenes": count,
            "step": step,
            "tolerance": TOLERANCE,
            "unit": unit,
            "omega_r": stack.rocking_frequency,
            "bearings": bust("isolated").bearings.model_dump(),
            "engines": engines,
            "variants": [variant_settings(each.engine, each.variant) for each in (*main, *others)],
            "default_variants": {each.engine: each.variant for each in main},
        },
        [row | {"engine": STEPPING} if row["engine"] == SOLVER else row for row in (*rows, *search.failures)],
        seed=SEED,
    )
