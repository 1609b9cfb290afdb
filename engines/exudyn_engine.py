"""exudyn: ``get_engine("exudyn").simulate(scene, variant=...)``."""

import dataclasses
import platform
from importlib.metadata import version

from analytic.errors import SettingError

from . import exudyn_corners, exudyn_joints, exudyn_native
from .observe import observe

_MODULES = {exudyn_corners.CompliantCorners: exudyn_corners,
            exudyn_joints.SwitchedJoints: exudyn_joints,
            exudyn_native.NativeContact: exudyn_native}
VARIANTS = {"compliant-corners": exudyn_corners.CompliantCorners(),
            "switched-joints": exudyn_joints.SwitchedJoints(),
            "native-contact": exudyn_native.NativeContact()}
DEFAULT_VARIANT = "compliant-corners"

DECIDES = {
    "compliant-corners": "exudyn decides contact, impact, sliding and rest through stiff corner springs",
    "switched-joints": "exudyn decides the motion; uplift, impact and rest are the adapter's",
    "native-contact": "exudyn decides contact, impact, sliding and rest through its sphere-triangle contact",
}


def versions():
    """Versions that determine the result."""
    return {"exudyn": version("exudyn"), "python": platform.python_version()}


def simulate(scene, *, variant=None, history=True, **settings):
    """The response of a scene in exudyn."""
    name, chosen = _choose(variant, settings)
    run = _MODULES[type(chosen)].run(scene, chosen)
    return observe(scene, run.trace, engine="exudyn", variant=name, cpu_seconds=run.cpu_seconds, steps=run.steps,
                   settings=dataclasses.asdict(chosen), versions=versions(), history=history,
                   failure=run.failure, ended=run.ended)


def _choose(variant, changes):
    name = variant or DEFAULT_VARIANT
    if name not in VARIANTS:
        raise SettingError(f"exudyn has no variant {name!r}: choose one of {', '.join(VARIANTS)}")
    chosen = VARIANTS[name]
    fields = [field.name for field in dataclasses.fields(chosen)]
    unknown = [key for key in changes if key not in fields]
    if unknown:
        raise SettingError(f"exudyn {name} has no setting {unknown[0]!r}: its settings are {', '.join(fields)}")
    return name, dataclasses.replace(chosen, **changes)
