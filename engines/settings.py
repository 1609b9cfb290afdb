"""Choice of a variant and check of what is asked of it: its settings, and no given restitution."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from analytic.errors import SceneError, SettingError

from .couple import ALONE, reached

if TYPE_CHECKING:
    from analytic import Scene

    from .contract import Engine


def choose(engine: Engine, variant: str | None, changes: Mapping[str, Any]) -> tuple[str, Any]:
    """(name, settings) of an engine's variant with fields replaced.

    Parameters
    ----------
    engine : Engine
    variant : str or None
        None: the main one.
    changes : dict
        {field: number}

    Raises
    ------
    SettingError
        The variant or the setting is unknown, or a value is not a finite number above 0.
    """
    name, variants = engine.default_variant if variant is None else variant, engine.variants
    if name not in variants:
        raise SettingError(f"{engine.name} has no variant {name!r}: choose one of {', '.join(variants)}")
    settings = variants[name].settings
    known = [field.name for field in fields(settings)]
    for key, value in changes.items():
        if key not in known:
            raise SettingError(f"{engine.name} {name} has no setting {key!r}: its settings are {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
            raise SettingError(f"{engine.name} {name}: {key} = {value!r} is not a positive number")
    return name, replace(settings, **{key: float(value) for key, value in changes.items()})


def refuse_restitution(engine: Engine, scene: Scene) -> None:
    """Raise `SceneError` where a scene gives the restitution and the engine computes the impact itself."""
    if scene.block.restitution is not None:
        able = [
            name
            for name, variant in engine.variants.items()
            if variant.takes_restitution and (variant.applies_impact or reached(scene))
        ]
        raise SceneError(
            "block.restitution",
            scene.block.restitution,
            "a contact engine computes the impact itself",
            f"leave it out, use the variant {able[0]}, {ALONE}" if able else f"leave it out, {ALONE}",
        )
