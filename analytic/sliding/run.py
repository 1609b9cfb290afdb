"""The response of a block that slides: when the march is needed, the march, and what it found."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import layout as L
from ..bearing import BearingLaw
from ..compiled import compiling
from ..decision import longest_duration, run_warnings
from ..errors import SceneError
from ..response import Energy, Failure, Impact, Response, Sliding, State
from ..rocking import momentum_restitution
from . import layout as S
from .bounds import paradoxical_friction, slipping_friction
from .march import arrays, march

if TYPE_CHECKING:
    from ..layout import Ground, Options, Parameters
    from ..scene import Scene

# The kernel reads the demand at points of each step, and it may exceed them in between: with a friction above its
# reading by 1/1000, 17 of 1492 random scenes slide (by up to 2e-6 R), by 1/20 two, by 1/10 none of 2989. Above this
# share of the friction the march decides, at 3 to 12 times the kernel's CPU time.
NEAR = 0.9
GIVEN = "block.restitution"
STICKS = 1e6  # a friction at which no block slides that carries weight
ABOVE = 1.0006  # factor of a limit that is told in four digits, so that what is told is beyond it


def is_needed(par: Parameters, contact: S.Contact, totals: np.ndarray) -> bool:
    """Whether the kernel's run, with its totals (record), is no answer as it exceeds the friction.

    A block that falls slides at the end of its fall.
    """
    falls = totals[L.MODE] == L.OVERTURNED or totals[L.WILL_OVERTURN] > 0
    strikes = totals[L.IMPACTS] > 0 and contact.mu < slipping_friction(par)
    return bool(falls or strikes or totals[L.FRICTION] > NEAR * contact.mu or totals[L.NORMAL] <= 0)


def ready(par: Parameters, contact: S.Contact, ground: Ground, options: Options) -> None:
    """Load the compiled march, or compile it: once per machine, some ten seconds."""
    with compiling():
        marched(par._replace(duration=0.0), contact, ground, options)


def marched(
    par: Parameters, contact: S.Contact, ground: Ground, options: Options, rows: int = 0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(totals, impacts, changes of mode, history) of a march, by the slots of `layout`."""
    resting, capacity = par._replace(slope=min(par.slope, contact.mu)), options.capacity if options.record else 0
    while True:
        into = arrays(capacity, rows)
        march(par, resting, contact, ground._replace(upright=None), ground.upright, options, into)
        _, _, impacts, changes, history, totals = into
        most = int(max(totals[S.IMPACTS], totals[S.CHANGES]))
        if not capacity or most <= capacity:
            break
        capacity = most
    counts = [int(totals[slot]) for slot in (S.IMPACTS, S.CHANGES, S.WRITTEN)]
    tables = [table[:count] for table, count in zip((impacts, changes, history), counts, strict=True)]
    return totals, tables[0], tables[1], tables[2]


def stays(found: np.ndarray) -> bool:
    """Whether a march is sound and the block neither slid nor fell: unless it jumps, the kernel's run is the answer."""
    sound = found[S.STATUS] in (L.COMPLETE, L.DECIDED)
    return bool(sound and found[S.PATH] == 0 and found[S.END_MODE] != S.FALLEN)


def outcome(par: Parameters, contact: S.Contact, ground: Ground, options: Options, totals: np.ndarray) -> None:
    """March a run of many, and write what it found over the kernel's `totals`."""
    found, *_ = marched(par, contact, ground, options._replace(record=False))
    if totals[L.NORMAL] > 0 and stays(found):
        return
    fallen, undetermined = found[S.END_MODE] == S.FALLEN, problem(par, contact, found) is not None
    totals[L.STATUS] = L.STUCK if undetermined or found[S.STATUS] not in (L.COMPLETE, L.DECIDED) else L.COMPLETE
    for here, there in _SHARED.items():
        totals[here] = found[there]
    totals[L.WILL_OVERTURN], totals[L.SLID], totals[L.PEAK_SLIP] = fallen, found[S.PATH] > 0, found[S.PEAK_SLIP]


_SHARED = {L.LIFTED: S.LIFTED, L.CERTAIN: S.CERTAIN, L.PEAK_TILT: S.PEAK_TILT, L.PEAK_X: S.PEAK_X, L.IMPACTS: S.IMPACTS}


def problem(par: Parameters, contact: S.Contact, totals: np.ndarray) -> tuple[str, str] | None:
    """(key, problem) where the motion of the block is not determined; for what to do see `remedies`."""
    limit, bound, when = slipping_friction(par), paradoxical_friction(par, contact), totals[S.TIME]
    given = {
        S.GIVEN_LEAVES: f"needs, at the impact at {when:.6g} s, a friction of {limit:.4g} (it is {contact.mu:.4g})",
        S.GIVEN_SLIDES: f"needs a block that sticks; at a friction of {contact.mu:.4g} it lands sliding, {when:.6g} s",
        S.GIVEN_JUMPS: f"needs a block that stays on a corner; it lands after a jump, {when:.6g} s",
    }
    if words := given.get(int(totals[S.STATUS])):
        return GIVEN, words
    if (par.tilt != 0 or par.rate != 0) and contact.mu < limit and totals[S.IMPACTS] > 0:
        words = f"below {limit:.4g}, where an impact of a block released by hand depends on the law of friction in it"
        return "friction", words
    if totals[S.STATUS] in (S.NO_MODE, L.STUCK) and contact.mu > bound:
        words = f"above {bound:.4g} (Painleve), where a block that slides, as at {when:.6g} s, may have no motion"
        return "friction", words
    return None


def remedies(key: str, scene: Scene, par: Parameters, contact: S.Contact, ground: Ground, options: Options) -> str:
    """What to give instead, in words; each is tried, the motion of the block is then determined.

    A friction is named that suffices for the impacts, or else for all of the motion up to the fall, so that the block
    does not slide before; or one at the bound of Painleve. Without a friction the motion is always determined.
    """

    def tried(par, contact):
        totals, *_ = marched(par, contact, ground, options._replace(record=False, output_step=0.0))
        sound = totals[S.STATUS] in (L.COMPLETE, L.DECIDED) and problem(par, contact, totals) is None
        return float(totals[S.HELD_FRICTION]) if sound else None

    words, of, own = [], "a friction of " if key == GIVEN else "", max(momentum_restitution(scene), 0.0)
    if key == GIVEN and tried(par._replace(e=own), contact._replace(given=False)) is not None:
        words.append("leave it out")
    limit, asked = slipping_friction(par), tried(par, contact._replace(mu=STICKS))
    least = [limit, *((max(limit, asked), max(limit, asked / NEAR)) if asked is not None else ())]
    for mu in (float(f"{one * ABOVE:.4g}") for one in least if one * ABOVE > contact.mu):
        if tried(par, contact._replace(mu=mu)) is not None:
            words.append(f"give {of}{mu:.4g} or more")
            break
    mu = float(f"{paradoxical_friction(par, contact) / ABOVE:.4g}")
    if key != GIVEN and mu < contact.mu and tried(par, contact._replace(mu=mu)) is not None:
        words.append(f"give {mu:.4g} or less")
    if key != GIVEN and tried(par._replace(tilt=0.0, rate=0.0), contact) is not None:
        words.append("let the block start at rest")
    return ", or ".join(words) or f"leave {'the friction' if key == GIVEN else 'it'} out"


def response(
    scene: Scene, par: Parameters, contact: S.Contact, ground: Ground, options: Options, known: dict[str, Any]
) -> tuple[Response, np.ndarray] | None:
    """(response without its history, rows of the history: columns of `History` less the last, slip and its rate).

    None where the kernel's run is the answer.

    known : fields of `Response` that are known before the run.

    Raises
    ------
    SceneError
        The motion of the block is not determined.
    """
    ready(par, contact, ground, options)
    rows = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    begin = time.process_time()
    totals, impacts, changes, table = marched(par, contact, ground, options, rows)
    if totals[S.NORMAL] > 0 and stays(totals):
        return None
    if found := problem(par, contact, totals):
        key, words = found
        value = scene.friction if key == "friction" else scene.block.restitution
        remedy = remedies(key, scene, par, contact, ground, options)
        raise SceneError(key, value, words, remedy, scene.name or None)
    fallen = totals[S.END_MODE] == S.FALLEN
    if not fallen and abs(totals[S.END_TILT]) > par.gamma and totals[S.TIME] >= ground.shaking.end:
        later = par._replace(duration=par.duration + longest_duration(scene))
        fallen = _falls_later(later, contact, ground, options, totals)
    cpu = time.process_time() - begin
    tilt, rate, _, _, x, v, z = totals[S.END_TILT : S.END_Z + 1].tolist()
    law, gamma = BearingLaw.of(scene.bearings), scene.block.slenderness
    end = State(float(totals[S.TIME]), tilt, rate, x, v, law.force(x, z, v))
    failure = None
    if totals[S.STATUS] not in (L.COMPLETE, L.DECIDED):
        failure = Failure(_REASONS[int(totals[S.STATUS])], last_state=end)
    uplifts, rests, unstable = *_turns(changes), float(totals[S.UNSTABLE_TIME])
    upright = "rocks" if totals[S.LIFTED] else "slides" if totals[S.PATH] > 0 else "stands"
    response = Response(
        engine="analytic",
        variant="kernel",
        outcome="failed" if failure else "overturns" if fallen else upright,
        overturning_time=float(totals[S.OVER_TIME] or end.time) if fallen else None,
        unstable_time=unstable if unstable >= 0 else None,
        fall_time=float(totals[S.FALL_TIME]) if fallen else None,
        peak_tilt=float(totals[S.PEAK_TILT]),
        peak_tilt_ratio=float(totals[S.PEAK_TILT]) / gamma,
        peak_base_displacement=float(totals[S.PEAK_X]),
        peak_base_acceleration=float(totals[S.PEAK_ACCELERATION]),
        impacts=tuple(Impact(*row) for row in impacts[:, :4].tolist()),
        uplifts=uplifts,
        rests=rests,
        friction_demand=float(totals[S.FRICTION]),
        min_normal_ratio=float(totals[S.NORMAL]),
        end=end,
        cpu_seconds=cpu,
        steps=int(totals[S.STEPS]),
        failure=failure,
        decided=failure is None and bool(totals[S.CERTAIN]),
        warnings=run_warnings(
            scene,
            float(totals[S.FRICTION]),
            float(totals[S.NORMAL]),
            float(totals[S.PEAK_X]),
            v,
            slides=True,
            peak_slip=0.0 if fallen else float(totals[S.PEAK_SLIP]),
        ),
        energy=_energy(scene, par, totals, end),
        sliding=_sliding(totals, changes),
        **known,
    )
    return response, table


_REASONS = {
    L.STUCK: "the step became too small to advance",
    L.NOT_FINITE: "the state is not finite",
    L.SPENT: "too many steps",
    S.NO_MODE: "not exactly one mode of contact is admissible",
}


def _falls_later(par: Parameters, contact: S.Contact, ground: Ground, options: Options, totals: np.ndarray) -> bool:
    """Whether a block past its balance falls when it is followed on; writes its times over those of `totals`."""
    further, *_ = marched(par, contact, ground, options._replace(record=False, output_step=0.0))
    falls = bool(further[S.END_MODE] == S.FALLEN)
    if falls:
        totals[S.CERTAIN], totals[S.FALL_TIME], totals[S.OVER_TIME] = 1.0, further[S.FALL_TIME], further[S.TIME]
    return falls


def _sliding(totals: np.ndarray, changes: np.ndarray) -> Sliding:
    return Sliding(
        peak=float(totals[S.PEAK_SLIP]),
        end=float(totals[S.END_SLIP]),
        path=float(totals[S.PATH]),
        work=float(totals[S.FRICTION_WORK]),
        modes=tuple((t, S.MODES[int(mode)]) for t, mode in changes.tolist()),
    )


def _turns(changes: np.ndarray) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times at which the block lifts from full contact, and at which it returns to it [s]."""
    level = changes[:, 1] < S.ROCK
    turns = np.flatnonzero(level[1:] != level[:-1]) + 1
    return tuple(changes[turns[~level[turns]], 0].tolist()), tuple(changes[turns[level[turns]], 0].tolist())


def _energy(scene: Scene, par: Parameters, totals: np.ndarray, end: State) -> Energy:
    """Changes from the start, in the ground's frame."""
    start, m, R, gamma = scene.start, par.m, par.R, par.gamma
    mb, centre = (scene.base.mass if scene.base else 0.0), scene.block.centre_inertia

    def kinetic(tilt, rate, v, speed, rise):
        angle = math.copysign(gamma, tilt if tilt != 0 else rate) - tilt
        drift, climb = speed + R * math.cos(angle) * rate, rise + R * math.sin(angle) * rate
        return 0.5 * (m * ((v + drift) ** 2 + climb**2) + centre * rate**2 + mb * v * v)

    def potential(tilt, x, gap):
        rise = 2 * math.sin(gamma - 0.5 * abs(tilt)) * math.sin(0.5 * abs(tilt))
        return m * par.g * (R * rise + gap) + 0.5 * par.count * par.kb * x * x

    now, then = (end.base_velocity, start.base_velocity) if scene.base else (0.0, 0.0)
    return Energy(
        kinetic=float(
            kinetic(end.tilt, end.tilt_rate, now, totals[S.END_SPEED], totals[S.END_RISE])
            - kinetic(start.tilt, start.tilt_rate, then, 0.0, 0.0)
        ),
        potential=float(
            potential(end.tilt, end.base_displacement, totals[S.END_GAP])
            - potential(start.tilt, start.base_displacement, 0.0)
        ),
        input=float(totals[S.INPUT]),
        hysteretic=float(totals[S.HYSTERETIC]),
        viscous=float(totals[S.VISCOUS]),
        impact_loss=float(totals[S.IMPACT_LOSS]),
        friction=float(totals[S.FRICTION_WORK]),
    )
