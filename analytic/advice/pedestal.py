"""Whether a pedestal stays on what carries it while the block stands, rocks or slides on it.

The model takes the pedestal as fixed. A free one stays if its support can give what that takes: a centre of pressure
within its width. With the forces H, N of the pedestal on the block, at the place p from the pedestal's middle (the
block's centre of pressure, or its lower corner), the pedestal's mass m_1, height H_1 and its acceleration a,

    (P1)  xi_1 = (p N - H_1 H - m_1 a H_1/2)/(m_1 (g + a_v) + N)

must not exceed the half width b_1. Of a block at rest on it that is |a| <= g b_1/h_c, where both would lift together.
At a landing the same holds of impulses. With those of the pedestal on the block, P and Q, horizontal and upward, and
the jump -P/m_b of the base's velocity,

    (P2)  xi_1 = p - (H_1 - m_1 H_1/(2 m_b)) P/Q

On rigid ground and for e of eq. (7), that is b_1 >= b + H_1 h (1 - e)/(b (1 + e)). A soft landing has the same ratios
as a hard one. The pedestal is taken not to slide, and its mass as that of a homogeneous rectangle.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from ..kernel import layout as L
from ..kernel.compiled import entry
from ..motion import SampledMotion, vertical_acceleration
from ..response import Caution
from ..rocking import uplift_of_both
from ..scene import Scene
from ..sliding import run as sliding
from ..sliding.equations import accelerations
from ..solver import parameters, simulate

POINTS, ROWS = 1000, 300_000  # samples of the shortest period of block, base and pulse; at most in a run
FARTHEST = 1e6  # m, of a centre of pressure; where the support would have to pull, too
NO_SLIP = 1.0  # a friction of a block that does not slide; its value plays no part


@dataclass(frozen=True)
class PedestalCheck:
    """What is asked of the support of a pedestal, by the model's run of a scene.

    share: largest distance of the centre of pressure under the pedestal from its middle, over its half width, up to a
    fall. landing: that of the impulses of landings; 0 without any. uplift: the
    acceleration above which block and pedestal would lift together [m/s2]. width: on which it stays [m], of the same
    mass; None where none was found.
    """

    share: float
    landing: float
    uplift: float
    width: float | None

    @property
    def most(self) -> float:
        """Return the larger of both shares; the pedestal stays on what carries it up to 1."""
        return max(self.share, self.landing)

    @property
    def text(self) -> str:
        """Return the verdict in words."""
        used = f"centre of pressure under it up to {self.most:.3g} half widths from its middle"
        if self.most <= 1:
            return f"The pedestal stays: this answer holds ({used})."
        cure = "fix it" if self.width is None else f"fix it, or widen it to {self.width:.4g} m"
        return f"The pedestal may lift: outside this model; {cure} ({used})."

    @property
    def cautions(self) -> tuple[Caution, ...]:
        """Return a warning where the pedestal may lift."""
        return (Caution("limit", self.text, "pedestal", self.most, 1.0),) if self.most > 1 else ()


def check_pedestal(scene: Scene) -> PedestalCheck | None:
    """Return the check of a fixed pedestal; None without its mass and height, or where the model has no run."""
    if scene.pedestal is None or scene.pedestal.mass is None or scene.is_stack or (reached := _reached(scene)) is None:
        return None
    half, width = 0.5 * scene.pedestal.width, max(scene.pedestal.width, math.ceil(200 * max(reached)) / 100)
    again = reached if width == scene.pedestal.width else _reached(scene.with_(pedestal={"width": width}))
    holds = again is not None and 2 * max(again) <= width
    return PedestalCheck(reached[0] / half, reached[1] / half, uplift_of_both(scene), width if holds else None)


def _reached(scene):
    """Return the largest |xi_1| [m] of (P1) and of (P2); None where the model has no run."""
    try:
        response = simulate(scene, output_step=_step(scene))
    except SceneError:
        return None
    return None if response.failure else (_pressure(scene, response), _landing(scene, response))


def _step(scene):
    """Return the interval of the history [s]."""
    par = parameters(scene)
    free = par.M - (par.m * par.R * math.cos(par.gamma)) ** 2 / par.J  # effective mass of the base
    ringing = math.sqrt(par.count * (par.kb + par.constants.dk) / free)
    step = 2 * math.pi / POINTS / max(scene.rocking_frequency, ringing, getattr(scene.motion, "frequency", 0.0))
    return max(min(step, scene.motion.dt / 4) if isinstance(scene.motion, SampledMotion) else step, par.duration / ROWS)


def _landing(scene, response):
    """Return |xi_1| [m] of a landing by (P2); 0 where there is none.

    P/Q is that of a corner that does not slip; where the block slides, it may be up to the friction, and both corners
    may land.
    """
    if not response.impacts:
        return 0.0
    par, block, pedestal, slip = parameters(scene), scene.block, scene.pedestal, 0.0
    ratio, b = sliding.slipping_friction(par), block.half_width
    # of the moment about the centre, J_G [phi'] = -h P - p Q: the corner, unless a restitution is given
    moment = block.centre_inertia / block.mass + block.half_height * (block.half_height - par.arm)
    place = (1 - par.e) / ((1 + par.e) * b) * moment
    if response.sliding is not None:
        ratio, place, slip = max(ratio, scene.friction), max(place, b), response.sliding.peak
    arm = pedestal.height * (1 - (0.5 * pedestal.mass / scene.base_mass if scene.base else 0.0))
    return slip + place + arm * ratio


def _pressure(scene, response):
    """Return the largest |xi_1| [m] of (P1) up to a fall; between two samples as far as the slope beside them leads."""
    history, slip, moved = response.history, 0.0, 0.0
    side = np.sign(np.where(history.tilt != 0, history.tilt, history.tilt_rate))
    mode = np.where(side == 0, L.STICK, L.ROCK)
    if response.sliding is not None:
        times, modes = zip(*response.sliding.modes, strict=True)
        mode = np.array([L.MODES.index(name) for name in modes])[np.searchsorted(times, history.time, "right") - 1]
        slip, side = history.slip, np.where(mode < L.ROCK, 0.0, side)
        moved = np.isin(mode, (L.SLIDE, L.SLIDE_ROCK)) * np.sign(np.diff(slip, append=2 * slip[-1] - slip[-2]))
    gravity = scene.gravity + vertical_acceleration(scene.motion, history.time)
    state = mode, side, moved, history.tilt, history.tilt_rate, slip
    rows = np.column_stack(np.broadcast_arrays(*state, gravity, history.ground_acceleration, history.bearing_force))
    rows = rows[history.time <= (math.inf if response.fall_time is None else response.fall_time)]
    places, contact = np.empty(len(rows)), sliding.contact_of(scene.with_(friction=scene.friction or NO_SLIP))
    _places(parameters(scene), contact, (scene.pedestal.mass, scene.pedestal.height), rows, places)
    # slopes within a mode; of two on each side the lesser one, as the other may be a jump of the ground's acceleration
    rises = np.pad(np.abs(np.diff(places)) * (np.diff(rows[:, :3], axis=0) == 0).all(axis=1), 2)
    return float(np.max(places + np.maximum(np.minimum(rises[:-3], rises[1:-2]), np.minimum(rises[2:-1], rises[3:]))))


@entry
def _places(par, contact, pedestal, rows, places):
    """Fill |xi_1| [m] of each row: mode, side, direction of slip, tilt, rate, slip, g + a_v, a_g, bearing force."""
    mass, height = pedestal
    b, h = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma)
    for i in range(len(rows)):
        mode, s, sigma, tilt, rate, slip, gravity, ground, force = rows[i]
        block = L.Block(int(mode), s, sigma, tilt, rate, slip, 0.0, 0.0, 0.0)
        _, _, _, across, normal = accelerations(par, contact, block, L.Start(gravity, ground, force))
        absolute = -(force + across) / contact.mb if par.on_base else ground
        moment = (slip + s * b) * normal - (0.0 if s != 0 else h * across)
        moment -= height * (across + 0.5 * mass * absolute)
        weight = mass * gravity + normal
        places[i] = min(abs(moment) / weight, FARTHEST) if weight > 0 else FARTHEST
