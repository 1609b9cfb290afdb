"""Random scenes within the range of a statue, `engines.statue_range`, and the class of each run."""

import math
from typing import Annotated, Any

import numpy as np
import typer

from analytic import Base, Bearings, Block, PulseMotion, Response, Scene, Start, simulate
from engines import get_engine
from engines.comparison import Reference
from engines.statue_range import RANGE, in_words

from ...measuring.statistics import class_of
from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request
from ...running.provenance import commit_seed
from ...running.sweep import Row

DENSITY = (200.0, 2e4)  # kg per m3 of R^3: wood to bronze, hollow or solid
HEAVIEST_BASE = 20.0  # block masses
STIFFER = (2.0, 20.0)  # initial stiffness of a bearing over that after yielding
YIELDS = (1e-2, 1.0)  # displacement at which it yields, over R gamma
# of the pulses; by name, as one more in `pulses.PULSES` would change the scenes that are drawn
SHAPES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
PEAKS = (0.5, 6.0)  # of a motion over the uplift acceleration
FREQUENCIES = (0.5, 6.0)  # over omega_r
STARTS = 0.95  # most tilt of a released block over its slenderness


def random_scene(seed: int, index: int) -> Scene:
    """Scene number `index` of the ensemble `seed`: a statue released or under a pulse, until its outcome is decided."""
    rng = np.random.default_rng([seed, index])
    scene = random_statue(rng, f"random scene {seed}/{index}")
    side = float(rng.choice([-1.0, 1.0]))
    if rng.random() < 0.5:
        tilt = side * scene.block.slenderness * log_uniform(rng, RANGE["tilt"][0], STARTS)
        return scene.with_(start=Start(tilt=tilt))
    return scene.with_(motion=random_pulse(rng, scene, side))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """A number drawn evenly over the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def random_statue(rng: np.random.Generator, name: str) -> Scene:
    """A statue at rest, without a motion.

    A quarter stands on rigid ground, a fifth of the others on a free base. Half of the bearings have viscous damping.
    """
    block = _block(rng)
    base = bearings = None
    if rng.random() < 0.75:
        base = Base(mass=block.mass * log_uniform(rng, RANGE["base_mass"][0], HEAVIEST_BASE))
        bearings = _bearings(rng, block, base) if rng.random() < 0.8 else None
    return Scene(block=block, base=base, bearings=bearings, name=name)


def random_peak(rng: np.random.Generator, scene: Scene) -> float:
    """A peak of the ground acceleration [m/s2]: of a pulse, or of any other motion."""
    return scene.gravity * math.tan(scene.block.slenderness) * log_uniform(rng, *PEAKS)


def random_pulse(rng: np.random.Generator, scene: Scene, side: float) -> PulseMotion:
    """A pulse to `side`; every second one begins some time after the run."""
    omega, amplitude = scene.rocking_frequency, side * random_peak(rng, scene)
    start = float(rng.choice([0.0, rng.uniform(0, 0.5) / omega]))
    return PulseMotion(str(rng.choice(SHAPES)), amplitude, omega * log_uniform(rng, *FREQUENCIES), start)


def _block(rng: np.random.Generator) -> Block:
    low, high, _ = RANGE["inertia"]
    radius = log_uniform(rng, *RANGE["radius"][:2])
    mass = log_uniform(rng, *DENSITY) * radius**3
    inertia = mass * radius**2 * rng.uniform(low, high) if rng.random() < 0.5 else None  # else a cuboid's, 4/3
    slenderness = float(rng.uniform(*RANGE["slenderness"][:2]))
    return Block(mass=mass, radius=radius, slenderness=slenderness, corner_inertia=inertia)


def _bearings(rng: np.random.Generator, block: Block, base: Base) -> Bearings:
    law, count = str(rng.choice(["algebraic", "linear", "bouc-wen"])), int(rng.integers(1, 9))
    carried = block.mass + base.mass
    omega = 2 * math.pi / log_uniform(rng, *RANGE["period"][:2])
    k = carried * omega**2 / count
    share = rng.uniform(*RANGE["damping"][:2]) if rng.random() < 0.5 else 0.0
    damping = share * 2 * omega * carried / count
    if law == "linear":
        return Bearings(law=law, count=count, ka=k, damping=damping)
    # x = 1/(2 (alpha - 1)): where the algebraic law has lost half of its excess of stiffness
    alpha = 1 + 0.5 / (block.radius * block.slenderness * log_uniform(rng, *YIELDS))
    return Bearings(law=law, count=count, ka=k * log_uniform(rng, *STIFFER), kb=k, alpha=alpha, damping=damping)


SCENES, QUICK_SCENES = 500, 20  # of the engines' main variants
FEWER = 5  # other variants run one scene in so many, and at least so many

SEED = "Of the scenes, without it of the commit; with --check of the draw of runs."
Seed = Annotated[int | None, typer.Option(min=0, max=2**63, help=SEED)]
Number = Annotated[int | None, typer.Option(min=1, max=10**6, help="How many are drawn. Default 500, quick 20.")]


def plan(request: Request, *, seed: Seed = None, scenes: Number = None) -> Plan:
    """The plan of the study: scenes of an ensemble that every commit draws anew; seed: of another one."""
    seed = commit_seed() if seed is None else seed
    most = scenes or (QUICK_SCENES if request.quick else SCENES)
    drawn = [random_scene(seed, index) for index in range(most)]
    reached = [simulate(scene, history=False).peak_tilt_ratio >= RANGE["tilt"][0] for scene in drawn]
    few = min(most, max(FEWER, most // FEWER))
    cases = [
        Case(drawn[k], engine.name, variant, {"history": False, "compare": True}, {"index": k})
        for engine in map(get_engine, request.engines)
        for variant in engine.variants
        for k in range(most if variant == engine.default_variant else few)
        if reached[k]
    ]
    rows = yield Batch(cases, compared, "random scenes")
    found = [
        {
            "engine": row.case.solver,
            "variant": row.case.variant,
            "tier": get_engine(row.case.solver).variants[row.case.variant or ""].kind,
            **row.case.tag,
            **(_failed(row) if row.failed else row.values),
        }
        for row in rows
    ]
    settings = {"scenes": most, "below_range": reached.count(False), "range": in_words(), "quick": request.quick}
    return Computed(settings, found, seed=seed)


def _failed(row: Row) -> dict[str, Any]:
    """What is kept of a run that failed: left out where no run of its scene is judged, of all engines alike."""
    why = Reference.of(row.case.scene).comparable
    return {"class": class_of(why, None), "comparable": why, "failure": row.failure}


def compared(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the class of a run, and in what it differs, or why it is left out.

    A scene near an outcome boundary is left out for all engines alike; the differences of its runs are kept.
    """
    quantities = [one.quantity for one in response.differences]
    return {
        "class": class_of(response.comparable, quantities),
        "comparable": response.comparable,
        "differences": [str(one) for one in response.differences],
        "quantities": quantities,
    }
