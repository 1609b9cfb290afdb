"""The calls that a variant's record names are those that its adapter makes, with these values; none is left out."""

import ast
import math
from dataclasses import dataclass, field
from unittest.mock import ANY

import pytest
from engine_cases import scene

from analytic import PulseMotion, Start
from analytic.rocking import BearingLaw
from analytic.scene import BEARINGS
from engines import get_engine
from engines.loads import ground_velocity, size_scale

MOTION = PulseMotion("one-sine", 2.0, 9.0)
START = Start(tilt=1e-3, base_velocity=0.1)
ISOLATED = scene(0.2, 212.0, 0.05, bearings=BEARINGS, motion=MOTION, start=START).with_(
    block={"radius": 0.7, "mass": 900.0}
)


@dataclass
class Call:
    """A function of an engine, its arguments in order and by name."""

    name: str
    values: list
    named: dict = field(default_factory=dict)

    def matches(self, call):
        """Whether it is the call that is told, of which the last arguments in order may be left out."""
        return (
            self.name == call.name
            and same(call.values, self.values[: len(call.values)])
            and all(name in self.named and same(value, self.named[name]) for name, value in call.named.items())
        )


def same(wanted, made):
    """Whether values are equal, but for the digits that are told."""
    if wanted is ANY or isinstance(wanted, str):
        return wanted == made
    if hasattr(wanted, "__iter__"):
        wanted, made = list(wanted), list(made)
        return len(wanted) == len(made) and all(map(same, wanted, made))
    return math.isclose(wanted, made, rel_tol=1e-5, abs_tol=1e-12)


def described(calls, names):
    """(calls, {attribute: value}) that a record names, in order; what it assigns to a name is a name from there on."""
    records, attributes = [], {}
    for text in calls:
        (node,) = ast.parse(text).body
        if isinstance(node, ast.Assign):
            target = ast.unparse(node.targets[0])
            (attributes if "." in target else names)[target] = eval(ast.unparse(node.value), names)
        else:
            call = node.value
            values = [eval(ast.unparse(argument), names) for argument in call.args]
            named = {keyword.arg: eval(ast.unparse(keyword.value), names) for keyword in call.keywords}
            records.append(Call(call.func.id, values, named))
    return records, attributes


def numbers(given):
    """The names of a script's numbers, for this scene."""
    block = given.block
    return {
        **{"sqrt": math.sqrt, "ceil": math.ceil, "g": given.gravity, "m": block.mass, "R": block.radius},
        **{"gamma": block.slenderness, "J": block.inertia, "mb": given.base.mass},
        **{"b": block.half_width, "h": block.half_height, "scale": size_scale(given)},
    }


# PyBullet: all functions of its module are watched.

ANYTHING = ("body", "slab", "box", "link", "value", "rate", "place", "turn", "speed", "spin", "sweeps")
LEFT_OUT = {"physicsClientId", "linkVisualShapeIndices", "linkCollisionShapeIndices", "linkOrientations"} | {
    "linkInertialFramePositions",
    "linkInertialFrameOrientations",
}  # of a client; of frames that are level and shapes that cannot be told apart by their numbers
KEPT = "setPhysicsEngineParameter"  # whose values hold until it is called again


@pytest.fixture
def made(monkeypatch):
    """Calls that change something in Bullet, and at each step the joints' states before it."""
    from engines.pybullet.adapter import pybullet

    calls = []

    def watch(name, function):
        def watching(*values, **named):
            calls.append(Call(name, list(values), named))
            return function(*values, **named)

        monkeypatch.setattr(pybullet, name, watching)

    for name, function in list(vars(pybullet).items()):
        if callable(function) and name[0].islower() and not name.startswith(("get", "connect", "disconnect")):
            watch(name, function)
    return calls


def each_step(made, rows):
    """(calls that build the scene and those of a step, its begin, length, the one before, row before it) of each."""
    ends = [i + 1 for i, call in enumerate(made) if call.name == "stepSimulation"]
    build = [call for call in made[: ends[0]] if call.name not in ("setGravity", "applyExternalForce", KEPT)]
    kept = []
    for number, (a, b) in enumerate(zip([0, *ends], ends, strict=False)):
        t, step = rows[number + 1][0] - rows[number + 1][1], rows[number + 1][1]
        kept = [call for call in made[a:b] if call.name == KEPT] or kept
        yield build + kept + made[a:b], t, step, rows[number][1], rows[number]


@pytest.mark.parametrize("variant", ["impact-aware", "fixed-step", "first-script"])
def test_bullet_is_called_as_its_record_says(made, monkeypatch, variant):
    from engines import loop as stepping
    from engines.pybullet.adapter import pybullet

    march, ran = stepping.march, []
    monkeypatch.setattr(stepping, "march", lambda *given: ran.append(march(*given)) or ran[-1])
    engine = get_engine("pybullet")
    assert engine.run(ISOLATED, variant, engine.variants[variant].settings).failure is None
    ((rows, _),) = ran
    law, velocity, calls = BearingLaw.of(ISOLATED.bearings), ground_velocity(MOTION), engine.variants[variant].calls
    block, plain, lengths = ISOLATED.block, variant == "first-script", []
    constants = {name: value for name, value in vars(pybullet).items() if name.isupper()}
    for group, t, step, before, row in each_step(made, rows):
        tilt, rate, z, vz = row[2], row[3], row[9], row[11]
        gaps = [
            (
                z + block.half_height * (1 - math.cos(tilt)) - side * block.half_width * math.sin(tilt),
                (side * block.half_width * math.cos(tilt) - block.half_height * math.sin(tilt)) * rate - vz,
            )
            for side in (-1, 1)
        ]
        mean = (velocity(t + step / 2) - velocity(t - before / 2)) / ((step + before) / 2)
        names = {**numbers(ISOLATED), **constants, **dict.fromkeys(ANYTHING, ANY), "before": before, "corners": gaps}
        names |= {"a": MOTION.acceleration(t) if plain else mean, "force": law.force(row[4], row[6])}
        described_calls, _ = described(calls, names)
        lengths.append((names["step"], step))
        if not same(*lengths[-1]):
            break
        assert not [each for each in described_calls if not any(call.matches(each) for call in group)], (t, before)
        for call in group:
            alike = [each for each in described_calls if call.matches(Call(each.name, each.values))]
            assert alike and call.named.keys() - LEFT_OUT <= set().union(*(each.named for each in alike)), call
    assert len(rows) - 2 <= len(lengths) > 10  # the last step ends with the run
    if variant == "impact-aware":
        assert len({step for _, step in lengths}) > 20 and min(lengths)[1] < 1e-6


# exudyn: its system and its settings as they are when a solver is called, beside exudyn's defaults.

WITHOUT_OUTPUT = ("solution.", "timeIntegration.verboseMode")
OF_THE_RUN = ("timeIntegration.startTime", "timeIntegration.endTime", "timeIntegration.numberOfSteps")
OF_THE_SYSTEM = {"name", "markerNumbers", "nodeNumber", "trianglePoints", "offset", "initialCoordinates"} | {
    "initialVelocities",
    "numberOfDataCoordinates",
    "markerNumber",
    "loadVector",
}


def flat(settings, above=""):
    """{dotted name: value} of exudyn's settings."""
    values = {}
    for name, value in settings.items():
        values |= flat(value, f"{above}{name}.") if isinstance(value, dict) else {f"{above}{name}": value}
    return values


def contacts(mbs, kinds):
    """(displacement, velocity, force) of the connectors of the corners, where a variant has them: the last two."""
    objects = range(mbs.systemData.NumberOfObjects())
    springs = [i for i in objects if mbs.GetObject(i)["objectType"] == "ConnectorCartesianSpringDamper"][1:]
    return [
        [mbs.GetObjectOutput(i, kind) for kind in (kinds.Displacement, kinds.Velocity, kinds.Force)] for i in springs
    ]


def items(mbs):
    """(call that makes it, names of what is not as usual) of the objects, nodes and loads of a system."""
    system, objects = mbs.systemData, []
    for kind, count, get, usual in (
        ("Object", system.NumberOfObjects(), mbs.GetObject, mbs.GetObjectDefaults),
        ("Node", system.NumberOfNodes(), mbs.GetNode, mbs.GetNodeDefaults),
        ("Load", system.NumberOfLoads(), mbs.GetLoad, mbs.GetLoadDefaults),
    ):
        for item in map(get, range(count)):
            name = item[f"{kind.lower()}Type"]
            changed = {key for key, value in item.items() if str(value) != str(usual(name).get(key)) and key[0] != "V"}
            name = "ContactSphereTriangle" if "trianglePoints" in item else name  # exudyn 1.13 tells another
            objects.append((Call(kind + name, [], item), changed - OF_THE_SYSTEM - {f"{kind.lower()}Type"}))
    return objects


@pytest.mark.parametrize("variant", ["compliant-corners", "native-contact"])
def test_exudyn_is_called_as_its_record_says(monkeypatch, variant):
    import exudyn as exu

    solved = {}

    def watch(solver):
        solve = solver.SolveSystem

        def watching(self, mbs, settings):
            integrator = ("explicit", "implicit")["Implicit" in solver.__name__]
            done = solve(self, mbs, settings)
            solved[integrator] = flat(settings.GetDictionary()), items(mbs), contacts(mbs, exu.OutputVariableType)
            return done

        monkeypatch.setattr(solver, "SolveSystem", watching)

    watch(exu.MainSolverExplicit), watch(exu.MainSolverImplicitSecondOrder)
    engine = get_engine("exudyn")
    given = ISOLATED.with_(duration=0.5)
    assert engine.run(given, variant, engine.variants[variant].settings).failure is None
    assert solved.keys() == {"implicit"} | ({"explicit"} if variant == "compliant-corners" else set())
    usual, calls = flat(exu.SimulationSettings().GetDictionary()), engine.variants[variant].calls
    for integrator, (settings, made, forces) in solved.items():
        start, end = settings["timeIntegration.startTime"], settings["timeIntegration.endTime"]
        names = {**numbers(given), "DynamicSolverType": exu.DynamicSolverType, "start": start, "end": end}
        names |= dict.fromkeys(("f", "mbs", "name", "item", "chord", "dampers"), ANY)
        for where, rate, force in forces:  # of the corners
            names |= {"depth": -where[1], "rise": rate[1], "across": where[0], "slide": rate[0]}
            assert same(described(calls, dict(names))[0][-1].named["springForceUserFunction"], force)
        assert bool(forces) == (variant == "compliant-corners")
        described_calls, attributes = described(calls, names)
        described_calls = [each for each in described_calls if each.name != "CreateSymbolicUserFunction"]
        wanted = {
            name.partition(".")[2]: value
            for name, value in attributes.items()
            if name.startswith((integrator, "settings"))
        }
        assert all(same(value, settings[name]) for name, value in wanted.items()), (integrator, wanted)
        others = {name for name, value in settings.items() if str(value) != str(usual[name])}
        assert {each for each in others if not each.startswith(WITHOUT_OUTPUT)} <= {*wanted, *OF_THE_RUN}
        for each in described_calls[: -1 if forces else None]:  # the last was compared at each corner
            assert any(call.matches(each) for call, _ in made), each
        for call, changed in made:
            assert changed <= set().union(*(each.named for each in described_calls if each.name == call.name)), (
                call.name,
                changed,
            )
