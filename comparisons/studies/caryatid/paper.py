"""What the Caryatid paper prints, beside what is found here: numbers, equations, misprints.

`formulas` gives the result ``caryatid-paper``, which needs no motion: the bearing law of Fig. 3, Table 1 and the
misprints, each by a number. `motion_values` compares runs with the numbers of Figs 4 to 6.

`comparisons.metrics.agreement.branch` and `history_point` are the paper's equations written out literally, misprint
included; the corrected ones are the model's own.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from analytic import SampledMotion, Scene, load_scene, simulate
from analytic.motion import Motion
from analytic.rocking import (
    BearingLaw,
    RockingModel,
    base_jump_length,
    base_jump_length_as_printed,
    design_bearings,
    momentum_restitution,
    properties,
)

from ...metrics.agreement import branch, history_point

FREE, ISOLATED = "free-standing", "isolated"
SHIPPED = {FREE: "caryatid-rigid", ISOLATED: "caryatid-isolated"}


def caryatid(name: str, motion: Motion | None) -> Scene:
    """Return the free-standing or the isolated Caryatid under `motion`."""
    return load_scene(SHIPPED[name]).with_(motion=motion, duration=None)


REPRODUCED, CORRECTED, NOT_REPRODUCIBLE = "reproduced", "corrected", "not reproducible"
GIVEN, DERIVED, OTHER_MOTION = "input", "not printed, derived", "other motion"
NOT_CHECKABLE = "not checkable"

# Table 1(a): targets; Table 1(b): the bearings designed for them
PERIOD, X_MAX, DAMPING = 2.0, 0.30, 0.30  # s, m, share of critical
KA, KB, ALPHA, DELTA_K = 6.22e4, 6.22e3, 44.69, 1e-20  # N/m, N/m, -, N/m
COUNT, MASS, BASE_MASS, OMEGA_R = 4, 3172.05, 212.0, 2.60  # -, kg, kg, rad/s
# Of Figs 4 to 6 (Duzce 12 November 1999, East-West) the text prints outcomes and two times, and no other value.
OVERTURNING = "after approximately 35 s"  # of the paper's own file
VULNERABLE_PERIOD, VULNERABLE_ABOUT = 4.0, 0.5  # s, "four seconds" and how it is read here
OWN_FILE = "the paper's file of the same event and component starts earlier and is processed otherwise"

# Known to exist, but neither text nor numbers of it are at hand.
UNKNOWN = (
    "Figs 1 and 2; the damping ratios of Fig. 5(b); the values on the axes of Figs 3 to 6; the dimensions of "
    "the Caryatid and of its bearings beyond Table 1; the slenderness."
)


def value(
    where: str,
    quantity: str,
    printed: float | str,
    study: float | str,
    status: str,
    note: str = "",
    engine: str | None = None,
) -> dict[str, Any]:
    """Return a row: one number of the paper beside this study's, with their difference where both are numbers.

    Parameters
    ----------
    where : str
        Table, figure or equation.
    quantity : str
        What the number is, with its unit.
    printed, study : float or str
        The paper's value and this study's.
    status : str
        One of those above.
    note : str
        Reason for the status.
    engine : str or None
        Solver whose run gave the value, such as "analytic"; None: no run.
    """
    numbers = isinstance(printed, float) and isinstance(study, float) and status != GIVEN
    return {
        "part": "value",
        "where": where,
        "quantity": quantity,
        "engine": engine,
        "paper": printed,
        "study": study,
        "difference": study - printed if numbers else None,  # type: ignore[operator]  # both are numbers
        "status": status,
        "note": note,
    }


def judged(
    where: str, quantity: str, printed: float, study: float, within: float, note: str = "", papers_motion: bool = True
) -> dict[str, Any]:
    """Return a row of `value`, reproduced if it lies within half a printed digit, or within what "about" allows.

    papers_motion: whether the value comes from the paper's own motion; otherwise it is not judged.
    """
    met = abs(study - printed) <= within
    return value(where, quantity, printed, study, _status(papers_motion, met), note)


def _status(papers_motion, met):
    """Status of a number by whether the motion is the paper's, and whether it is met."""
    return OTHER_MOTION if not papers_motion else REPRODUCED if met else NOT_REPRODUCIBLE


def is_papers_motion(motion: Motion) -> bool:
    """Return whether the motion is a Duzce record, by its name: only then can the paper's numbers be met."""
    return "DUZCE" in motion.label.upper() and not motion.label.startswith("synthetic")


def motion_values(rows: Sequence[Mapping[str, Any]], motion: SampledMotion, least: float) -> Iterator[dict[str, Any]]:
    """Yield rows of the paper's numbers in Figs 4 to 6, each beside what every solver's rows give.

    least: slenderness [rad] that does not rock on the bearings.
    """
    papers_motion = is_papers_motion(motion)
    for row in rows:
        if row["part"] == "run":
            yield from _run_values(row, motion, papers_motion)
    status, note = (GIVEN, OWN_FILE) if papers_motion else (OTHER_MOTION, "")
    yield value("Fig. 4(a)", "ground motion", "Duzce 12 Nov 1999, East-West", motion.label, status, note)
    note = "the paper's damping ratios and values are not at hand"
    yield value("Fig. 5(b)", "peak displacements of oscillators", "not at hand", "drawn", NOT_REPRODUCIBLE, note)
    for row in rows:
        if row["part"] == "vulnerable":
            note = f"largest T_r that overturns, in steps of {row['step']:g} s, γ = {row['slenderness']:g} rad"
            about = VULNERABLE_PERIOD, row["period"], VULNERABLE_ABOUT
            yield judged("Fig. 5(a)", "vulnerable below T_r of [s]", *about, note, papers_motion)
    what = "least slenderness that does not rock on the bearings [rad]"
    yield value("text", what, "not printed", least, DERIVED, "atan(max|a|/g)")


def _run_values(row, motion, papers_motion):
    """Rows of Figs 4(b) and 6 in one solver's run."""
    what, engine = f"{row['scene']} Caryatid", row["engine"]

    def compared(place, quantity, printed, study, status=None, note=""):
        study, note = "does not happen" if study is None else study, note if papers_motion else ""
        status = status if papers_motion and status else _status(papers_motion, study == printed)
        return value(place, quantity, printed, study, status, note, engine)

    if row["outcome"] == "failed":
        why = row["failure"]["reason"]
        yield value("Figs 4(b), 6", what, "runs", "failed", NOT_REPRODUCIBLE, why, engine)
    elif row["scene"] == FREE:
        time, after = row["overturning_time"], "overturning after the peak of the motion [s]"
        yield compared("Fig. 4(b)", what, "overturns", row["outcome"])
        time = None if time is None else time - motion.peak_time
        yield compared("Fig. 4(b)", after, OVERTURNING, time, NOT_CHECKABLE, OWN_FILE)
    else:
        peak = row["peak_base_displacement"]
        acceleration = row["peak_base_acceleration"] / caryatid(ISOLATED, motion).gravity
        yield compared("Fig. 6", what, "stands", row["outcome"])
        yield compared("Fig. 6", "peak displacement of the base [m]", "not printed", peak, DERIVED)
        yield compared("Fig. 6", "peak absolute acceleration [g]", "not printed", acceleration, DERIVED)
        yield compared("Fig. 6", "peak displacement below x_max = 0.30 m", "yes", "yes" if peak < X_MAX else "no")


TURNS = (0.0, 0.06, -0.06, 0.15, -0.15, 0.30, -0.30, 0.10, -0.05, 0.30)  # m, the path of Fig. 3
REVERSAL = 0.20  # m, where the misprint of eq. (12) is shown
POINTS = 120  # per branch
RADII = np.geomspace(0.1, 10.0, 81)  # m
SLENDERNESSES = np.linspace(0.1, 0.45, 71)  # rad
AMPLITUDES = np.linspace(0.02, 0.40, 96)  # m


def momentum_after(scene: Scene, jump_length: float, rate: float = -1.0) -> float:
    """Return the horizontal momentum after an impact over that before it, for a base velocity jump -e_x phi'-.

    It is 1 if momentum is conserved.

    Before: m h w (the base stands). After: m h e_phi w + (m + m_b) jump.
    """
    before = scene.block.mass * scene.block.half_height * rate
    return (momentum_restitution(scene) * before - scene.total_mass * jump_length * rate) / before


def formulas() -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Return the rows and arrays of the result ``caryatid-paper``."""
    scene = load_scene("caryatid-isolated").with_(motion=None)
    law = BearingLaw.of(scene.bearings)
    arrays = {**_loops(law), **_reversal(law), **_momentum(scene), **_amplitudes(scene)}
    loaded, unloading = arrays["reversal/loading"][1, -1], arrays["reversal/right"]
    jumps = {  # of the force at a reversal, over 2 f0, with eq. (12) corrected and as printed
        "corrected": abs(arrays["reversal/literal"][0] - loaded) / (2 * law.f0),
        "printed": (unloading[0] - arrays["reversal/printed"][0]) / (2 * law.f0),
    }
    literal = np.abs(arrays["reversal/literal"] - unloading).max() / law.f0
    got = properties(scene.bearings, scene.total_mass, X_MAX)
    designed = design_bearings(scene.total_mass, PERIOD, DAMPING, X_MAX, count=COUNT, definition="paper")
    equations = _equations(scene, law, got, designed, jumps, float(literal))
    return [*_values(scene, got, designed), *_misprints(scene, got, jumps), *equations], arrays


def _loops(law):
    """Arrays of Fig. 3: the path through `TURNS`, its reversal points, the limit curves."""
    x, f, z = [], [], 0.0
    for start, end in pairwise(TURNS):
        travel = np.linspace(0.0, end - start, POINTS)
        forces = np.array([law.hysteretic(z, dx) for dx in travel])
        x.append(start + travel)
        f.append(law.kb * (start + travel) + forces)
        z = forces[-1]
    return {
        "loops/x": np.concatenate(x),
        "loops/force": np.concatenate(f),
        "loops/reversals": np.column_stack([TURNS[1:-1], [force[-1] for force in f[:-1]]]),
        "loops/limits": np.array([[s, law.kb * s * 0.34, law.f0] for s in (-1.0, 1.0)]),
    }


def _reversal(law):
    """Arrays of loading the virgin bearing to `REVERSAL` and unloading it, correctly and with eq. (12) as printed."""
    loading, unloading = np.linspace(0.0, REVERSAL, POINTS), np.linspace(REVERSAL, -REVERSAL, POINTS)
    force = np.array([law.kb * x + law.start(x) for x in loading])
    z, x_j = law.start(REVERSAL), history_point(law, REVERSAL, force[-1], -1)
    return {
        "reversal/loading": np.array([loading, force]),
        "reversal/x": unloading,
        "reversal/right": np.array([law.kb * x + law.hysteretic(z, x - REVERSAL) for x in unloading]),
        "reversal/literal": np.array([branch(law, x, -1, x_j) for x in unloading]),
        "reversal/printed": np.array([branch(law, x, -1, x_j, misprinted=True) for x in unloading]),
    }


def _momentum(scene):
    """Arrays of the momentum after an impact over that before, by eq. (8) corrected and printed.

    They go over slenderness and over radius.
    """
    arrays = {"impact/slenderness": SLENDERNESSES, "impact/radius": RADII}
    for by in ("slenderness", "radius"):
        scenes = [scene.with_(block={by: float(size)}) for size in arrays[f"impact/{by}"]]
        for form, length in (("right", base_jump_length), ("printed", base_jump_length_as_printed)):
            arrays[f"impact/{form} by {by}"] = np.array([momentum_after(scene, length(scene)) for scene in scenes])
    return arrays


def _amplitudes(scene):
    """Arrays of secant period and damping in both definitions over the amplitude."""
    at = [properties(scene.bearings, scene.total_mass, float(amplitude)) for amplitude in AMPLITUDES]
    return {
        "amplitude/x": AMPLITUDES,
        "amplitude/period": np.array([bearings.period for bearings in at]),
        "amplitude/damping 2 pi": np.array([bearings.damping_paper for bearings in at]),
        "amplitude/damping 4 pi": np.array([bearings.damping_equivalent for bearings in at]),
    }


def _values(scene, got, designed):
    """Rows of every number of the paper that needs no motion."""
    radius = 3 * scene.gravity / (4 * OMEGA_R**2)  # (1) with J_O = 4/3 m R^2
    secant = f"as secant period at x_max; with k_b alone it would be {got.period_kb:.3f} s"
    ours, usual = "damping ξ as W_D/(2π E_s) [%]", "damping ξ as W_D/(4π E_s) [%]"
    from_a, ten = "designed from Table 1(a)", "designed from Table 1(a) with k_a/k_b = 10"
    return [
        value("text", "mass of the Caryatid m [kg]", MASS, scene.block.mass, GIVEN),
        value("text", "mass of the base m_b [kg]", BASE_MASS, scene.base.mass, GIVEN),
        judged(
            "eq. (1)",
            "rocking frequency ω_r [rad/s]",
            OMEGA_R,
            scene.rocking_frequency,
            0.005,
            "with R = 1.0884 m, itself derived from ω_r",
        ),
        value(
            "eq. (1)",
            "radius R [m]",
            "not at hand",
            radius,
            DERIVED,
            "follows from ω_r and J_O = 4/3 m R² of a rectangle",
        ),
        value(
            "text",
            "slenderness γ [rad]",
            "not printed",
            scene.block.slenderness,
            DERIVED,
            "chosen; the interval that fits the paper's claims is with each motion",
        ),
        judged("Table 1(a)", "period T_bi [s]", PERIOD, got.period, 0.005, secant),
        value("Table 1(a)", "displacement x_max [m]", X_MAX, X_MAX, GIVEN),
        judged(
            "Table 1(a)",
            ours,
            100 * DAMPING,
            100 * got.damping_paper,
            0.5,
            "the only definition that gives the printed value",
        ),
        value(
            "Table 1(a)",
            usual,
            100 * DAMPING,
            100 * got.damping_equivalent,
            CORRECTED,
            "the usual equivalent viscous damping: half of what is printed",
        ),
        value("Table 1(b)", "number of bearings n_d [-]", float(COUNT), float(scene.bearings.count), GIVEN),
        judged("Table 1(b)", "k_a [N/m]", KA, designed.ka, 50.0, ten),
        judged("Table 1(b)", "k_b [N/m]", KB, designed.kb, 5.0, ten),
        judged("Table 1(b)", "α [-]", ALPHA, designed.alpha, 0.005, from_a),
        value("Table 1(b)", "δ_k [N/m]", DELTA_K, scene.bearings.delta_k, GIVEN),
        value("Figs 1, 2", "what they show", "not at hand", "not drawn", NOT_REPRODUCIBLE, "neither known here"),
    ]


def _rows(part, keys, *rows):
    """Return rows of a part, with values in the order of the keys."""
    return [{"part": part, **dict(zip(keys, row, strict=True))} for row in rows]


def _misprints(scene, got, jumps):
    return _rows(
        "misprint",
        ("where", "printed", "corrected", "measure", "value_corrected", "value_printed"),
        (
            "eq. (8)",
            "e_x with a factor R cos γ too many: a length squared",
            "e_x = 2R³ sin²γ cosγ m m̃/(…)",
            "momentum after an impact over that before, γ = 0.28 rad [-]",
            momentum_after(scene, base_jump_length(scene)),
            momentum_after(scene, base_jump_length_as_printed(scene)),
        ),
        (
            "eq. (12)",
            "bracket 1 + x − x_j + 2x₀",
            "bracket 1 − x + x_j + 2x₀",
            "force jump at a reversal over 2 f₀ [-]",
            jumps["corrected"],
            jumps["printed"],
        ),
        (
            "Table 1(a), ξ",
            "30 %, which is W_D/(2π E_s)",
            "equivalent viscous damping W_D/(4π E_s)",
            "damping at x_max [%]",
            100 * got.damping_equivalent,
            100 * got.cycle_loss / (math.pi * got.force * X_MAX),
        ),
        (
            "Table 1(a), T_bi",
            "2 s, said of the isolated system",
            "secant period at x_max = 0.30 m only",
            "period: secant at x_max, and with k_b alone [s]",
            got.period,
            got.period_kb,
        ),
    )


def _momentum_residual():
    """Return the residual of eq. (2) integrated over a run, over the largest of its impulses.

    It is (m + m_b)(v + int a_g dt) + int n_d f dt.
    """
    scene = load_scene("caryatid-isolated")
    history = simulate(scene.with_(duration=scene.motion.end), output_step=scene.motion.dt / 8).history
    ground = cumulative_simpson(history.ground_acceleration, x=history.time, initial=0)
    bearings = cumulative_simpson(history.bearing_force, x=history.time, initial=0)
    left = scene.total_mass * (history.base_velocity + ground) + bearings
    return float(np.abs(left).max() / np.abs(bearings).max())


def _impact_by_balances(scene, rate):
    """Return (phi'+, jump of x') from linear momentum and the block's angular momentum about its new corner alone."""
    m, b, h, about = scene.block.mass, scene.block.half_width, scene.block.half_height, scene.block.centre_inertia
    balances = np.array([[m * h, scene.total_mass], [about + m * (h * h + b * b), m * h]])
    return np.linalg.solve(balances, [m * h * rate, (about + m * (h * h - b * b)) * rate])


# Long, because the paper has many equations.
def _equations(scene, law, got, designed, jumps, literal):
    """Rows of eqs (1) to (14), Fig. 3 and Table 1, each with a number that it must give."""
    run = simulate(load_scene("caryatid-isolated").with_(block={"slenderness": 0.15}), history=False)  # it rocks
    rate = -0.7
    spin, base = _impact_by_balances(scene, rate)
    _, corrected = RockingModel.of(scene).impact(rate)
    off = base_jump_length_as_printed(scene) / base_jump_length(scene) - 1
    return _rows(
        "equation",
        ("number", "what", "status", "check", "value"),
        ("(1)", "rocking frequency", REPRODUCED, "ω_r [rad/s], 2.60 printed", scene.rocking_frequency),
        (
            "(2)",
            "full contact on the bearings",
            REPRODUCED,
            "momentum balance over a run in full contact, over its largest impulse [-]",
            _momentum_residual(),
        ),
        (
            "(3)–(6)",
            "rocking on the base, re-derived",
            REPRODUCED,
            f"imbalance of the energy over the input, {run.impact_count} impacts [-]",
            abs(run.energy.imbalance / run.energy.input),
        ),
        (
            "(7)",
            "restitution e_φ",
            REPRODUCED,
            "difference from the momentum balances [-]",
            abs(momentum_restitution(scene) - spin / rate),
        ),
        (
            "(8)",
            "jump of the base velocity",
            CORRECTED,
            f"corrected form, relative difference from the momentum balances [-]; printed form: {off:.3%} off",
            abs(corrected / base - 1),
        ),
        (
            "(9)–(11)",
            "bearing force and its history x_j",
            REPRODUCED,
            "literal x_j form against the stable form, over f₀ [-] (literal is NaN beyond 1.33 m of travel)",
            literal,
        ),
        (
            "(12)",
            "unloading branch",
            CORRECTED,
            f"force jump at a reversal over 2 f₀, corrected [-]; printed form: {jumps['printed']:.4f}",
            jumps["corrected"],
        ),
        ("(13)", "x₀ from k_a, k_b, α, δ_k", REPRODUCED, "2 x₀ [m]", 2 * law.constants.x0),
        ("(14)", "f₀ from k_a, k_b, α, x₀", REPRODUCED, "f₀ of one bearing [N]", law.f0),
        (
            "Fig. 3",
            "bearing law with its curves and reversal points",
            REPRODUCED,
            "W_D of one bearing at 0.30 m [J]",
            got.cycle_loss,
        ),
        ("Table 1(a)", "design targets", REPRODUCED, "T_bi as secant period at x_max [s]", got.period),
        ("Table 1(b)", "bearings", REPRODUCED, "α designed from Table 1(a) [-]", designed.alpha),
    )
