"""exudyn: ``get_engine("exudyn").simulate(scene, variant=...)``."""

import math
import platform
from dataclasses import asdict, replace
from importlib.metadata import version

import numpy as np

from analytic.bearing import BearingLaw
from analytic.response import Failure, State

from . import exudyn_corners, exudyn_joints, exudyn_native
from .checks import replay_bearing
from .deciding import until_decided
from .observe import failed_response, observe
from .settings import choose, leave_restitution
from .verified import Range, outside

_MODULES = {exudyn_corners.CompliantCorners: exudyn_corners,
            exudyn_joints.SwitchedJoints: exudyn_joints,
            exudyn_native.NativeContact: exudyn_native}
VARIANTS = {"compliant-corners": exudyn_corners.CompliantCorners(),
            "switched-joints": exudyn_joints.SwitchedJoints(),
            "native-contact": exudyn_native.NativeContact()}
# Replayed bearing force, over f0: round-off stays below 1e-12.
REPLAY_LIMIT = 1e-9
DEFAULT_VARIANT = "compliant-corners"

DECIDES = {
    "compliant-corners": "the integration decides contact, impact, sliding and rest; the corners' law, Hunt-Crossley "
                         "contact with Coulomb's friction, is the adapter's: plastic, non-slipping (unless the scene "
                         "gives a coefficient) and planar, as Housner assumes, so that an impact which agrees with "
                         "him verifies law and integration",
    "switched-joints": "exudyn decides the motion; uplift, impact and rest are the adapter's",
    "native-contact": "exudyn decides contact, impact, sliding and rest through its sphere-triangle contact",
}

# Held against the analytic model in random scenes. The constants of compliant-corners follow size and start, and its
# steps bearings of any stiffness and damping, or the run ends as one of too many steps. At the fixed step of
# switched-joints a base that vibrates faster is off by 3 to 20 %; smaller and flatter swings are too short for it.
VERIFIED = {
    "compliant-corners": Range(slenderness=(0.03, 1.2), inertia=(1.01, 3.0), base_mass=(1e-5, 100.0),
                               radius=(1e-3, 30.0)),
    "switched-joints": Range(slenderness=(0.03, 1.2), inertia=(1.01, 3.0), base_mass=(1e-4, 100.0),
                             radius=(0.05, 30.0), stiffness=(0.0, 0.3), damping=(0.0, 10.0), tilt=(0.01, math.inf)),
    "native-contact": Range(slenderness=(0.1, 0.3), inertia=(1.2, 2.0), base_mass=(0.05, 100.0), radius=(0.5, 2.0),
                            tilt=(0.1, math.inf)),
}
# Said of every run of a variant.
CAVEATS = {"native-contact": ("native-contact is set up as a first script would: its restitution is off by 1 to 10 %, "
                              "whatever the step",)}


def versions():
    """Versions that determine the result."""
    return {"exudyn": version("exudyn"), "python": platform.python_version()}


@until_decided
def simulate(scene, *, variant=None, history=True, **settings):
    """The response of a scene in exudyn.

    Parameters
    ----------
    scene : Scene
    variant : str or None
        One of VARIANTS; None is the default one.
    history : bool
        Keep the history in the response.
    **settings
        Fields of the variant's settings, in place of their defaults.

    Raises
    ------
    SettingError
        Unknown variant or setting, or a setting that is not a positive number.
    SceneError
        The scene overrides the restitution, and exudyn's contact decides it.
    Mismatch
        exudyn holds other values than the scene asks for; nothing was run.
    """
    name, chosen = choose("exudyn", VARIANTS, DEFAULT_VARIANT, variant, settings)
    if name != "switched-joints":
        leave_restitution(scene, "use the variant switched-joints")
        if scene.friction is not None:
            chosen = replace(chosen, friction=scene.friction)
    run = _MODULES[type(chosen)].run(scene, chosen)
    if run.trace is None:
        failure = replace(run.failure or Failure("the run ended before its first step"), last_state=_start(scene))
        return failed_response(scene, failure, engine="exudyn", variant=name, settings=asdict(chosen),
                               versions=versions(), cpu_seconds=run.cpu_seconds, steps=max(run.steps, 0))
    step, peak = float(np.diff(run.trace.time).max()), float(np.abs(run.trace.tilt).max())
    rocks = peak > run.trace.contact_tilt  # NaN does not
    warnings = (*CAVEATS.get(name, ()),
                *outside(scene, VERIFIED[name], step=step, peak_tilt=peak if rocks else None))
    return observe(scene, run.trace, engine="exudyn", variant=name, cpu_seconds=run.cpu_seconds, steps=run.steps,
                   settings=asdict(chosen), versions=versions(), history=history,
                   failure=run.failure or _fault(scene, run), ended=run.ended, warnings=warnings)


def _fault(scene, run):
    """The failure of a run that exudyn took for a success, or None."""
    if not all(np.isfinite(getattr(run.trace, name)).all() for name in run.trace.COLUMNS):
        return None  # observe reports it, with the last finite state
    difference = replay_bearing(scene, run.trace)
    if difference > REPLAY_LIMIT:
        return Failure("the bearing force is not the law's", f"it differs by {difference:.3g} f0 when replayed")
    return None


def _start(scene):
    law, start = BearingLaw.of(scene.bearings), scene.start
    x, v = start.base_displacement, start.base_velocity
    return State(0.0, start.tilt, start.tilt_rate, x, v, float(law.force(x, law.start(x), v)))
