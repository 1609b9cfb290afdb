"""The rigid-body rocking model on lead-rubber bearings: the reference of this study."""

from .errors import EngineNotInstalled, SceneError, SettingError
from .motion import PulseMotion, SampledMotion
from .response import Energy, Failure, History, Impact, Response, State
from .scene import Base, Bearings, Block, Scene, Start
from .solver import simulate

__all__ = ["Base", "Bearings", "Block", "Energy", "EngineNotInstalled", "Failure", "History", "Impact",
           "PulseMotion", "Response", "SampledMotion", "Scene", "SceneError", "SettingError", "Start", "State", "simulate"]
