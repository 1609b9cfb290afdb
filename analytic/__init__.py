"""The rigid-body rocking model on lead-rubber bearings: the reference of this study.

A `Scene` says what is modelled, `simulate` returns a `Response`. All quantities are in SI units and radians.

Examples
--------
One scene, from a file or by its name, and what came out:

>>> from analytic import load_scene, simulate
>>> statue = load_scene("caryatid-rigid")
>>> response = simulate(statue)
>>> response.outcome, len(response.impacts), round(response.peak_tilt_ratio, 3)
('overturns', 1, 5.61)

A scene in Python, and the same with other values (`Scene.with_` changes a copy):

>>> from analytic import Block, PulseMotion, Scene
>>> block = Block(mass=3172.05, radius=1.0884, slenderness=0.28)  # kg, m, rad
>>> scene = Scene(block=block, motion=PulseMotion("one-sine", amplitude=4.0, frequency=8.0))  # m/s2, rad/s
>>> simulate(scene).outcome, simulate(scene.with_(block={"slenderness": 0.2})).outcome
('rocks', 'overturns')

Many runs, on all cores; here the same scene at five scales of its motion:

>>> from analytic import simulate_many
>>> simulate_many([scene] * 5, scales=[0.5, 0.8, 1.0, 1.2, 1.5]).overturns
array([False, False, False,  True,  True])

An own record (`analytic.records` has the formats), and a motion in place of it where there is none:

>>> from analytic import synthetic_motion
>>> motion = synthetic_motion()  # or read_record("RSN1605_DUZCE_DZC270.AT2").motion
>>> round(motion.peak / 9.81, 3)  # g
0.515

The history as arrays, for numpy or matplotlib; `comparisons.plotting.plots.draw_histories` draws it:

>>> history = response.history
>>> history.time.shape == history.tilt.shape == history.ground_acceleration.shape
True
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .batch import Outcomes, overturning_map, rocking_spectrum, simulate_many
    from .errors import EngineNotInstalled, SceneError, SettingError
    from .motion import PulseMotion, SampledMotion
    from .records import read_record
    from .records.synthetic import synthetic_motion
    from .response import Caution, Difference, Energy, Failure, History, Impact, Response, State
    from .scene import Base, Bearings, Block, Pedestal, Scene, Start
    from .scene_file import load_scene, shipped_scenes
    from .solver import simulate

__all__ = [
    "Base",
    "Bearings",
    "Block",
    "Caution",
    "Difference",
    "Energy",
    "EngineNotInstalled",
    "Failure",
    "History",
    "Impact",
    "Outcomes",
    "Pedestal",
    "PulseMotion",
    "Response",
    "SampledMotion",
    "Scene",
    "SceneError",
    "SettingError",
    "Start",
    "State",
    "load_scene",
    "overturning_map",
    "read_record",
    "rocking_spectrum",
    "shipped_scenes",
    "simulate",
    "simulate_many",
    "synthetic_motion",
]

# The same names by module: each is imported when first used (PEP 562), as some modules load a compiler.
_NAMES = {
    "batch": ("Outcomes", "overturning_map", "rocking_spectrum", "simulate_many"),
    "errors": ("EngineNotInstalled", "SceneError", "SettingError"),
    "motion": ("PulseMotion", "SampledMotion"),
    "records": ("read_record",),
    "records.synthetic": ("synthetic_motion",),
    "response": ("Caution", "Difference", "Energy", "Failure", "History", "Impact", "Response", "State"),
    "scene": ("Base", "Bearings", "Block", "Pedestal", "Scene", "Start"),
    "scene_file": ("load_scene", "shipped_scenes"),
    "solver": ("simulate",),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value = getattr(importlib.import_module(f".{_MODULES[name]}", __name__), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
