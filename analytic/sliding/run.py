"""The response of a block that may slide: when the march is needed, its result, and what it cannot determine."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ..errors import SceneError
from ..kernel import layout as L
from ..kernel.compiled import compiling
from ..kernel.decision import longest_duration
from ..response import Sliding
from ..rocking import momentum_restitution
from .march import arrays, march

if TYPE_CHECKING:
    from ..kernel.layout import Ground, Options, Parameters
    from ..scene import Scene

# The kernel reads the demand at points of each step, and it may exceed them in between: with a friction above its
# reading by 1/1000, 17 of 1492 random scenes slide (by up to 2e-6 R), by 1/20 two, by 1/10 none of 2989. Above this
# share of the friction the march decides, at 3 to 12 times the kernel's CPU time.
NEAR = 0.9
GIVEN = "block.restitution"
ABOVE = 1.0006  # factor by which a limit is exceeded, so that the four digits in a message lie beyond it


def contact_of(scene: Scene) -> L.Contact | None:
    """Return the numbers of the contact; None without a friction."""
    if scene.friction is None:
        return None
    mass = scene.base_mass if scene.base else math.inf
    given, edge = scene.block.restitution is not None, scene.edge
    return L.Contact(float(scene.friction), mass, scene.block.centre_inertia, given, edge)


def slipping_friction(par: Parameters) -> float:
    """Return mu_c, the friction that the impact of a block that does not slide needs: horizontal over vertical impulse.

    (1 - e) (h - arm)/((1 + e) b), from the velocities of the centre of mass before and after it and the base's jump,
    eq. (8): with e of eq. (7) m b h/(J_G + m h^2 + J_G m/m_b), on rigid ground without the last term. That is always
    below tan(gamma), so that a block that lifts from rest does not slip at its impacts unless it slid before.
    """
    b, h = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma)
    return (1 - par.e) * (h - par.arm) / ((1 + par.e) * b)


def paradoxical_friction(par: Parameters, contact: L.Contact) -> float:
    """Return the friction above which a sliding corner may have no motion, or several (Painleve): 2 sqrt(k (1 + k)).

    k = J_G/(m R^2); the friction is 4/3 for a rectangle.
    """
    k = contact.centre / (par.m * par.R**2)
    return 2 * math.sqrt(k * (1 + k))


def is_needed(par: Parameters, contact: L.Contact, totals: np.ndarray) -> bool:
    """Return whether the kernel's run, with its totals (record), exceeds the friction and is therefore no answer.

    A block that falls slides at the end of its fall.
    """
    falls = totals[L.MODE] == L.FALLEN or totals[L.WILL_OVERTURN] > 0
    strikes = totals[L.IMPACTS] > 0 and contact.mu < slipping_friction(par)
    return bool(falls or strikes or totals[L.FRICTION] > NEAR * contact.mu or totals[L.NORMAL] <= 0)


def ready(par: Parameters, contact: L.Contact, ground: Ground, options: Options) -> None:
    """Load the compiled march, or compile it: once per machine, some ten seconds."""
    with compiling():
        marched(par._replace(duration=0.0), contact, ground, options)


def marched(
    par: Parameters, contact: L.Contact, ground: Ground, options: Options, rows: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (totals, impacts, changes of mode, history) of a march, by the slots of `layout`."""
    resting, capacity = par._replace(slope=min(par.slope, contact.mu)), options.capacity if options.record else 0
    while True:
        into = arrays(capacity, rows)
        march(par, resting, contact, ground._replace(upright=None), ground.upright, options, into)
        _, _, impacts, changes, history, totals = into
        most = int(max(totals[L.IMPACTS], totals[L.CHANGES]))
        if not capacity or most <= capacity:
            break
        capacity = most
    counts = [int(totals[slot]) for slot in (L.IMPACTS, L.CHANGES, L.WRITTEN)]
    tables = [table[:count] for table, count in zip((impacts, changes, history), counts, strict=True)]
    return totals, tables[0], tables[1], tables[2]


def stays(totals: np.ndarray) -> bool:
    """Return whether a march is sound and the block neither slid nor fell, off its pedestal or over.

    Unless the block jumps, the kernel's run is then the answer.
    """
    sound = totals[L.STATUS] in (L.COMPLETE, L.DECIDED)
    return bool(sound and totals[L.PATH] == 0 and totals[L.MODE] < L.FALLEN)


def outcome(par: Parameters, contact: L.Contact, ground: Ground, options: Options, totals: np.ndarray) -> None:
    """March one run of many, and write its result over the kernel's `totals`."""
    result, *_ = marched(par, contact, ground, options._replace(record=False))
    if totals[L.NORMAL] > 0 and stays(result):
        return
    fallen, undetermined = result[L.MODE] == L.FALLEN, problem(par, contact, result) is not None
    totals[L.STATUS] = L.STUCK if undetermined or result[L.STATUS] not in (L.COMPLETE, L.DECIDED) else L.COMPLETE
    slots = [L.MODE, L.LIFTED, L.CERTAIN, L.PEAK_TILT, L.PEAK_X, L.IMPACTS, L.PATH, L.PEAK_SLIP]
    totals[slots], totals[L.WILL_OVERTURN] = result[slots], fallen


def problem(par: Parameters, contact: L.Contact, totals: np.ndarray) -> tuple[str, str] | None:
    """Return (key, problem) where the motion of the block is not determined, else None; for remedies see `remedies`."""
    limit, bound, when = slipping_friction(par), paradoxical_friction(par, contact), totals[L.TIME]
    given = {
        L.GIVEN_LEAVES: f"needs, at the impact at {when:.6g} s, a friction of {limit:.4g} (it is {contact.mu:.4g})",
        L.GIVEN_SLIDES: f"needs a block that sticks; at a friction of {contact.mu:.4g} it lands sliding, {when:.6g} s",
        L.GIVEN_JUMPS: f"needs a block that stays on a corner; it lands after a jump, {when:.6g} s",
    }
    if words := given.get(int(totals[L.STATUS])):
        return GIVEN, words
    if (par.tilt != 0 or par.rate != 0) and contact.mu < limit and totals[L.IMPACTS] > 0:
        words = f"below {limit:.4g}, where an impact of a block released by hand depends on the law of friction in it"
        return "friction", words
    if totals[L.STATUS] in (L.NO_MODE, L.STUCK) and contact.mu > bound:
        words = f"above {bound:.4g} (Painleve), where a block that slides, as at {when:.6g} s, may have no motion"
        return "friction", words
    return None


def remedies(key: str, scene: Scene, par: Parameters, contact: L.Contact, ground: Ground, options: Options) -> str:
    """Return what to give instead, in words; each is tried, and with it the motion of the block is determined.

    It names a friction that suffices for the impacts, or one at the bound of Painleve. Without a friction the motion is
    always determined.
    """

    def tried(par, contact):
        totals, *_ = marched(par, contact, ground, options._replace(record=False, output_step=0.0))
        return totals[L.STATUS] in (L.COMPLETE, L.DECIDED) and problem(par, contact, totals) is None

    words, prefix, momentum = [], "a friction of " if key == GIVEN else "", max(momentum_restitution(scene), 0.0)
    if key == GIVEN and tried(par._replace(e=momentum), contact._replace(given=False)):
        words.append("leave it out")
    least, most = (
        float(f"{mu:.4g}") for mu in (slipping_friction(par) * ABOVE, paradoxical_friction(par, contact) / ABOVE)
    )
    if least > contact.mu and tried(par, contact._replace(mu=least)):
        words.append(f"give {prefix}{least:.4g} or more")
    if key != GIVEN and most < contact.mu and tried(par, contact._replace(mu=most)):
        words.append(f"give {most:.4g} or less")
    if key != GIVEN and tried(par._replace(tilt=0.0, rate=0.0), contact):
        words.append("let the block start at rest")
    return ", or ".join(words) or f"leave {'the friction' if key == GIVEN else 'it'} out"


def slid(
    scene: Scene, par: Parameters, contact: L.Contact, ground: Ground, options: Options
) -> tuple[float, np.ndarray, list[np.ndarray], np.ndarray, Sliding] | None:
    """March a block that may slide; return None where the kernel's run is the answer.

    Returns
    -------
    (CPU seconds, totals, [impacts, uplifts, rests, history with the slip], changes of `stored`, `Sliding`)

    Raises
    ------
    SceneError
        The motion of the block is not determined.
    """
    ready(par, contact, ground, options)
    rows = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    begin = time.process_time()
    totals, impacts, changes, table = marched(par, contact, ground, options, rows)
    if totals[L.NORMAL] > 0 and stays(totals):
        return None
    if undetermined := problem(par, contact, totals):
        key, words = undetermined
        value = scene.friction if key == "friction" else scene.block.restitution
        remedy = remedies(key, scene, par, contact, ground, options)
        raise SceneError(key, value, words, remedy, scene.name or None)
    if totals[L.MODE] < L.FALLEN and abs(totals[L.END_TILT]) > par.gamma and totals[L.TIME] >= ground.shaking.end:
        later = par._replace(duration=par.duration + longest_duration(scene))
        further, *_ = marched(later, contact, ground, options._replace(record=False, output_step=0.0))
        if further[L.MODE] == L.FALLEN:
            totals[L.CERTAIN], totals[L.FALL_TIME], totals[L.OVER_TIME] = 1.0, further[L.FALL_TIME], further[L.TIME]
    level = changes[:, 1] < L.ROCK
    turns = np.flatnonzero(level[1:] != level[:-1]) + 1  # from full contact, or back to it
    uplifts, rests = changes[turns[~level[turns]], 0], changes[turns[level[turns]], 0]
    sliding = Sliding(
        peak=float(totals[L.PEAK_SLIP]),
        end=float(totals[L.END_SLIP]),
        path=float(totals[L.PATH]),
        work=float(totals[L.FRICTION_WORK]),
        modes=tuple((t, L.MODES[int(mode)]) for t, mode in changes.tolist()),
    )
    ends = totals[[L.END_TILT, L.END_RATE, L.END_X, L.END_V, L.END_SPEED, L.END_RISE, L.END_GAP]].tolist()
    energies = stored(scene, par, ends) - stored(scene, par, (par.tilt, par.rate, par.x, par.v, 0.0, 0.0, 0.0))
    return time.process_time() - begin, totals, [impacts[:, :4], uplifts, rests, table[:, :7]], energies, sliding


def stored(scene: Scene, par: Parameters, state: Iterable[float]) -> np.ndarray:
    """Return (kinetic, potential) energy [J] in the ground's frame.

    state : tilt, its rate, x, x', slip rate, rise, gap.
    """
    (tilt, rate, x, v, speed, rise, gap), R, gamma = state, par.R, par.gamma
    angle = math.copysign(gamma, tilt if tilt != 0 else rate) - tilt
    drift, climb = speed + R * math.cos(angle) * rate, rise + R * math.sin(angle) * rate
    base = scene.base_mass * v * v
    moving = par.m * ((v + drift) ** 2 + climb**2) + scene.block.centre_inertia * rate**2 + base
    height = R * (2 * math.sin(gamma - 0.5 * abs(tilt)) * math.sin(0.5 * abs(tilt))) + gap
    return np.array([0.5 * moving, par.m * par.g * height + 0.5 * par.count * par.kb * x * x])
