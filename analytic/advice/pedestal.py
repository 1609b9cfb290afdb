"""Whether a pedestal stays on what carries it while the block stands, rocks or slides on it.

The model takes the pedestal as fixed. A free one stays if its support can give what that takes: a centre of pressure
within its width. With the forces H, N of the pedestal on the block, at the place p from the pedestal's middle (the
block's centre of pressure, or its lower corner), the pedestal's mass m_1, height H_1 and its acceleration a,

    (P1)  xi_1 = (p N - H_1 H - m_1 a H_1/2)/(m_1 (g + a_v) + N)

must not exceed the half width b_1. Of a block at rest on it that is |a| <= g b_1/h_c, where both would lift together. At
a landing the same holds of impulses. With those of the pedestal on the block, P and Q, horizontal and upward, and the
jump -P/m_b of the base's velocity,

    (P2)  xi_1 = p - (H_1 - m_1 H_1/(2 m_b)) P/Q

On rigid ground and for e of eq. (7), that is b_1 >= b + H_1 h (1 - e)/(b (1 + e)). A landing at rest has the same ratios
as a hard one. The pedestal is taken not to slide, and its mass as that of a homogeneous rectangle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..kernel.compiled import compiling, entry
from ..kernel.decision import longest_duration
from ..kernel.layout import MODES, ROCK, STICK, Block, Start
from ..motion import SampledMotion, vertical_acceleration
from ..response import Caution
from ..rocking import uplift_of_both
from ..sliding.equations import accelerations
from ..sliding.run import contact_of, slipping_friction
from ..solver import parameters, simulate

if TYPE_CHECKING:
    from ..response import Response
    from ..scene import Scene

POINTS, ROWS = 400, 300_000  # samples of a period of the block, the base or a pulse; at most in a run
WIDTHS, WIDTH_STEP = 6, 0.01  # widths tried, as a wider pedestal may let the block slide on; m, two decimals
NO_SLIP = 1.0  # a friction of a block that does not slide; its value plays no part


@dataclass(frozen=True)
class PedestalCheck:
    """What is asked of the support of a pedestal, by the model's run of a scene.

    share: largest distance of the centre of pressure under the pedestal from its middle, over its half width, up to a
    fall; inf where nothing holds it down. landing: that of the impulses of landings; None without any. uplift: the
    acceleration above which block and pedestal would lift together [m/s2]. width: that it needs [m] at the same mass,
    rounded up; None where none was found.
    """

    share: float
    landing: float | None
    uplift: float
    width: float | None

    @property
    def stays(self) -> bool:
        """Return whether the pedestal stays on what carries it."""
        return max(self.share, self.landing or 0.0) <= 1

    @property
    def text(self) -> str:
        """Return the verdict in words."""
        most = max(self.share, self.landing or 0.0)
        if self.stays:
            return f"the pedestal stays: this answer holds (its support is used to {most:.3g} of the half width)"
        cure = "fix it" if self.width is None else f"fix it, or widen it to {self.width:.4g} m"
        return f"the pedestal may lift: outside this model; {cure} (its support would need {most:.3g} half widths)"

    @property
    def cautions(self) -> tuple[Caution, ...]:
        """Return a warning where the pedestal may lift."""
        if self.stays:
            return ()
        return (Caution("limit", self.text, "pedestal", max(self.share, self.landing or 0.0), 1.0),)


def check_pedestal(scene: Scene) -> PedestalCheck | None:
    """Return the check of the scene's pedestal; None without its mass and height, or where the model's run fails.

    Raises
    ------
    SceneError
        The model refuses the scene.
    """
    if scene.pedestal is None or scene.pedestal.mass is None or (reached := _reached(scene)) is None:
        return None
    share, landing = (each and each / (0.5 * scene.pedestal.width) for each in reached)
    width, wider = _needed(reached), scene
    for _ in range(WIDTHS):
        if width is None or width <= scene.pedestal.width:
            break
        wider = scene.with_(pedestal={"width": width})
        again = _needed(_reached(wider) or reached)
        if again is not None and again <= width:
            break
        width = again
    else:
        width = None
    return PedestalCheck(share, landing, uplift_of_both(scene), width)


def _needed(reached):
    """Return the width [m] that these distances need, rounded up; None where they are not finite."""
    most = 2 * max(reached[0], reached[1] or 0.0)
    return round(WIDTH_STEP * math.ceil(most / WIDTH_STEP), 2) if math.isfinite(most) else None


def _reached(scene):
    """Return the largest |xi_1| [m] of (P1), and of (P2) or None without a landing; None where the run fails."""
    response = simulate(scene, output_step=_step(scene))
    if response.failure:
        return None
    slip = response.history.slip
    landing = _landing(scene, 0.0 if slip is None else float(np.abs(slip).max()), response.sliding is not None)
    return _pressure(scene, response), landing if response.impacts else None


def _step(scene):
    """Return the interval of the history [s]."""
    model, law = parameters(scene), scene.bearings
    rates = [scene.rocking_frequency, getattr(scene.motion, "frequency", 0.0)]
    if law is not None:
        free = model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J
        rates.append(math.sqrt(model.count * (model.kb + model.constants.dk) / free))
    step = 2 * math.pi / POINTS / max(rates)
    sampling = scene.motion.dt if isinstance(scene.motion, SampledMotion) else math.inf
    longest = longest_duration(scene) if scene.duration is None else scene.duration
    return max(min(step, sampling), longest / ROWS)


def _landing(scene: Scene, slip: float, slides: bool) -> float:
    """Return |xi_1| [m] of a landing by (P2), after a slip of up to `slip` [m].

    P/Q is that of a corner that does not slip; where the block `slides`, it may be up to the friction, and both corners
    may land.
    """
    par, block, height = parameters(scene), scene.block, scene.pedestal.height
    lost = (1 - par.e) / ((1 + par.e) * block.half_width)
    ratio = slipping_friction(par)
    # of the moment about the centre, J_G [phi'] = -h P - p Q: the corner, unless a restitution is given
    place = lost * (block.centre_inertia / block.mass + block.half_height * (block.half_height - par.arm))
    if slides:
        ratio, place = max(ratio, scene.friction), max(place, block.half_width)
    arm = height * (1 - (0.5 * scene.pedestal.mass / scene.base_mass if scene.base else 0.0))
    return slip + place + arm * ratio


def _pressure(scene: Scene, response: Response) -> float:
    """Return the largest |xi_1| [m] of (P1) up to a fall; between two samples as far as the slope beside them leads."""
    history, motion, par = response.history, scene.motion, parameters(scene)
    rows = np.zeros((len(history.time), 9))
    rows[:, 3], rows[:, 4], rows[:, 8] = history.tilt, history.tilt_rate, history.bearing_force
    rows[:, 6] = scene.gravity + vertical_acceleration(motion, history.time)
    rows[:, 7] = history.ground_acceleration
    side = np.sign(np.where(history.tilt != 0, history.tilt, history.tilt_rate))
    rows[:, 0] = np.where(side == 0, STICK, ROCK)
    if response.sliding is not None:
        times, modes = zip(*response.sliding.modes, strict=True)
        which = np.searchsorted(times, history.time, side="right") - 1
        rows[:, 0] = np.array([MODES.index(mode) for mode in modes])[which]
        rows[:, 5], moved = history.slip, np.sign(np.diff(history.slip, append=history.slip[-1]))
        rows[:, 2] = np.where(np.isin(rows[:, 0], (STICK, ROCK)), 0.0, moved)
        side = np.where(rows[:, 0] < ROCK, 0.0, side)
    rows[:, 1] = side
    if response.fall_time is not None:
        rows = rows[history.time <= response.fall_time]
    places, sizes = np.empty(len(rows)), (scene.pedestal.mass, scene.pedestal.height)
    contact = contact_of(scene.with_(friction=scene.friction or NO_SLIP))
    with compiling():
        _places(par, contact, sizes, rows, places)
    if not np.isfinite(places).all():
        return math.inf
    rises = np.abs(np.diff(places))
    beyond = np.zeros(len(places))
    beyond[1:], beyond[:-1] = rises, np.maximum(beyond[:-1], rises)
    return float(np.max(places + beyond))


@entry
def _places(par, contact, pedestal, rows, places):
    """Fill |xi_1| [m] of each row: mode, side, direction of slip, tilt, rate, slip, g + a_v, a_g, bearing force."""
    mass, height = pedestal
    b, h = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma)
    for i in range(len(rows)):
        mode, s, sigma, tilt, rate, slip, gravity, ground, force = rows[i]
        block = Block(int(mode), s, sigma, tilt, rate, slip, 0.0, 0.0, 0.0)
        _, _, _, across, normal = accelerations(par, contact, block, Start(gravity, ground, force))
        absolute = -(force + across) / contact.mb if par.on_base else ground
        moment = (slip + s * b) * normal - (0.0 if s != 0 else h * across)
        moment -= height * (across + 0.5 * mass * absolute)
        weight = mass * gravity + normal
        places[i] = abs(moment) / weight if weight > 0 else math.inf
