"""What a caller may ask of an engine: one of its variants with other settings, and no restitution."""

import math
from dataclasses import fields, replace

from analytic.errors import SceneError, SettingError


def choose(engine, variants, default, variant, changes):
    """(name, settings) of a variant with fields replaced.

    Parameters
    ----------
    engine : str
        For the message.
    variants : dict
        Frozen dataclasses of numbers above 0, by name.
    default : str
        Name of the variant taken where `variant` is None.
    changes : dict
        {field: number}

    Raises
    ------
    SettingError
        Unknown variant or setting, or a value that is no finite number above 0.
    """
    name = default if variant is None else variant
    if name not in variants:
        raise SettingError(f"{engine} has no variant {name!r}: choose one of {', '.join(variants)}")
    known = [field.name for field in fields(variants[name])]
    for key, value in changes.items():
        if key not in known:
            raise SettingError(f"{engine} {name} has no setting {key!r}: its settings are {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
            raise SettingError(f"{engine} {name}: {key} = {value!r} is not a positive number")
    return name, replace(variants[name], **{key: float(value) for key, value in changes.items()})


def leave_restitution(scene, remedy="use the analytic model"):
    """Raise `SceneError` where a scene overrides the restitution, which a contact engine decides itself."""
    if scene.block.restitution is not None:
        raise SceneError("block.restitution", scene.block.restitution, "a contact engine decides the impact itself",
                         f"leave it out, or {remedy}")
