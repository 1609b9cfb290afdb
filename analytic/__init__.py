"""The rigid-body rocking model on lead-rubber bearings: the reference of this study."""

from ._cache import kernel_cache
from .errors import EngineNotInstalled, SceneError, SettingError
from .motion import PulseMotion, SampledMotion
from .records import read_record
from .response import Caution, Difference, Energy, Failure, History, Impact, Response, State
from .synthetic import synthetic_motion

with kernel_cache():
    from . import time_stepping  # noqa: F401 compiled, too
    from .batch import Outcomes, overturning_map, rocking_spectrum, simulate_many
    from .scene import Base, Bearings, Block, Scene, Start
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
