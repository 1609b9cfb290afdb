"""What needs no ground motion: the bearing law of Fig. 3, Table 1, and the misprints, each by a number."""

import math
from typing import Any

import numpy as np
from scipy.integrate import cumulative_simpson

from analytic import load_scene, simulate
from analytic.bearing import BearingLaw
from analytic.design import design_bearings, properties, steady_cycle
from analytic.rocking import RockingModel, base_jump_length, base_jump_length_as_printed, restitution

from . import paper
from .literal import branch, history_point, momentum_after
from .paper import CORRECTED, DERIVED, GIVEN, NOT_REPRODUCIBLE, REPRODUCED, Value, judged

TURNS = (0.0, 0.06, -0.06, 0.15, -0.15, 0.30, -0.30, 0.10, -0.05, 0.30)  # m, the path of Fig. 3
REVERSAL = 0.20  # m, where the misprint of eq. (12) is shown
POINTS = 120  # per branch
RADII = np.geomspace(0.1, 10.0, 81)  # m
SLENDERNESSES = np.linspace(0.1, 0.45, 71)  # rad
AMPLITUDES = np.linspace(0.02, 0.40, 96)  # m


def formulas() -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """(rows, arrays) of the result file ``paper``."""
    scene = load_scene("caryatid-isolated").with_(motion=None)
    law = BearingLaw.of(scene.bearings)
    arrays = {**_loops(law), **_misprint_12(law), **_misprint_8(scene), **_amplitudes(scene)}
    jump = arrays["reversal/right"][0] - arrays["reversal/printed"][0]
    rows = [value.row() for value in _table(scene)]
    rows += _misprints(scene, law, jump) + _block_equations(scene) + _bearing_equations(scene, law, arrays, jump)
    return rows, arrays


def _loops(law):
    """Fig. 3: the path through `TURNS`, its reversal points, the limit curves."""
    x, f, points, z = [], [], [], 0.0
    for start, end in zip(TURNS, TURNS[1:], strict=False):
        travel = np.linspace(0.0, end - start, POINTS)
        forces = np.array([law.hysteretic(z, dx) for dx in travel])
        x.append(start + travel)
        f.append(law.kb * (start + travel) + forces)
        z = forces[-1]
        points.append((end, f[-1][-1]))
    return {
        "loops/x": np.concatenate(x),
        "loops/force": np.concatenate(f),
        "loops/reversals": np.array(points[:-1]),
        "loops/limits": np.array([[s, law.kb * s * 0.34, law.f0] for s in (-1.0, 1.0)]),
    }


def _misprint_12(law):
    """Loading of the virgin bearing to `REVERSAL` and unloading: right, and with eq. (12) as printed."""
    loading = np.linspace(0.0, REVERSAL, POINTS)
    force = np.array([law.kb * x + law.start(x) for x in loading])
    unloading = np.linspace(REVERSAL, -REVERSAL, POINTS)
    z = law.start(REVERSAL)
    x_j = history_point(law, REVERSAL, force[-1], -1)
    return {
        "reversal/loading": np.array([loading, force]),
        "reversal/x": unloading,
        "reversal/right": np.array([law.kb * x + law.hysteretic(z, x - REVERSAL) for x in unloading]),
        "reversal/literal": np.array([branch(law, x, -1, x_j) for x in unloading]),
        "reversal/printed": np.array([branch(law, x, -1, x_j, misprinted=True) for x in unloading]),
    }


def _misprint_8(scene):
    """Momentum after an impact over that before, corrected and printed, over slenderness and over radius."""
    by_slenderness = [scene.with_(block={"slenderness": float(gamma)}) for gamma in SLENDERNESSES]
    by_radius = [scene.with_(block={"radius": float(radius)}) for radius in RADII]
    arrays = {"impact/slenderness": SLENDERNESSES, "impact/radius": RADII}
    for name, scenes in (("slenderness", by_slenderness), ("radius", by_radius)):
        for form, length in (("right", base_jump_length), ("printed", base_jump_length_as_printed)):
            arrays[f"impact/{form} by {name}"] = np.array([momentum_after(scene, length(scene)) for scene in scenes])
    return arrays


def _amplitudes(scene):
    """Secant period and damping in both definitions over the amplitude."""
    at = [properties(scene.bearings, scene.total_mass, float(amplitude)) for amplitude in AMPLITUDES]
    return {
        "amplitude/x": AMPLITUDES,
        "amplitude/period": np.array([bearings.period for bearings in at]),
        "amplitude/damping 2 pi": np.array([bearings.damping_paper for bearings in at]),
        "amplitude/damping 4 pi": np.array([bearings.damping_equivalent for bearings in at]),
    }


def _table(scene):
    """Every number of the paper that needs no motion."""
    return [
        *_block_values(scene),
        *_target_values(scene),
        *_bearing_values(scene),
        Value("Figs 1, 2", "what they show", "not at hand", "not drawn", NOT_REPRODUCIBLE, "neither known here"),
    ]


def _block_values(scene):
    """What the text says of block and base."""
    radius = 3 * scene.gravity / (4 * paper.OMEGA_R**2)  # (1) with J_O = 4/3 m R^2
    return [
        Value("text", "mass of the Caryatid m [kg]", paper.MASS, scene.block.mass, GIVEN),
        Value("text", "mass of the base m_b [kg]", paper.BASE_MASS, scene.base.mass, GIVEN),
        judged(
            "eq. (1)",
            "rocking frequency ω_r [rad/s]",
            paper.OMEGA_R,
            scene.rocking_frequency,
            0.005,
            "with R = 1.0884 m, itself derived from ω_r",
        ),
        Value(
            "eq. (1)",
            "radius R [m]",
            "not at hand",
            radius,
            DERIVED,
            "follows from ω_r and J_O = 4/3 m R² of a rectangle",
        ),
        Value(
            "text",
            "slenderness γ [rad]",
            "not printed",
            scene.block.slenderness,
            DERIVED,
            "chosen; the interval that fits the paper's claims is with each motion",
        ),
    ]


def _target_values(scene):
    """Table 1(a)."""
    got = properties(scene.bearings, scene.total_mass, paper.X_MAX)
    return [
        judged(
            "Table 1(a)",
            "period T_bi [s]",
            paper.PERIOD,
            got.period,
            0.005,
            f"as secant period at x_max; with k_b alone it would be {got.period_kb:.3f} s",
        ),
        Value("Table 1(a)", "displacement x_max [m]", paper.X_MAX, paper.X_MAX, GIVEN),
        judged(
            "Table 1(a)",
            "damping ξ as W_D/(2π E_s) [%]",
            100 * paper.DAMPING,
            100 * got.damping_paper,
            0.5,
            "the only definition that gives the printed value",
        ),
        Value(
            "Table 1(a)",
            "damping ξ as W_D/(4π E_s) [%]",
            100 * paper.DAMPING,
            100 * got.damping_equivalent,
            CORRECTED,
            "the usual equivalent viscous damping: half of what is printed",
        ),
    ]


def _bearing_values(scene):
    """Table 1(b), beside what follows from Table 1(a)."""
    targets = scene.total_mass, paper.PERIOD, paper.DAMPING, paper.X_MAX
    designed = design_bearings(*targets, count=paper.COUNT, definition="paper")
    return [
        Value("Table 1(b)", "number of bearings n_d [-]", float(paper.COUNT), float(scene.bearings.count), GIVEN),
        judged("Table 1(b)", "k_a [N/m]", paper.KA, designed.ka, 50.0, "designed from Table 1(a) with k_a/k_b = 10"),
        judged("Table 1(b)", "k_b [N/m]", paper.KB, designed.kb, 5.0, "designed from Table 1(a) with k_a/k_b = 10"),
        judged("Table 1(b)", "α [-]", paper.ALPHA, designed.alpha, 0.005, "designed from Table 1(a)"),
        Value("Table 1(b)", "δ_k [N/m]", paper.DELTA_K, scene.bearings.delta_k, GIVEN),
    ]


def _misprints(scene, law, jump):
    got = properties(scene.bearings, scene.total_mass, paper.X_MAX)
    loss, force = steady_cycle(law, paper.X_MAX)
    after = momentum_after(scene, base_jump_length(scene))
    printed = momentum_after(scene, base_jump_length_as_printed(scene))

    def misprint(where, says, should, measure, right, wrong):
        return {
            "part": "misprint",
            "where": where,
            "printed": says,
            "corrected": should,
            "measure": measure,
            "value_corrected": right,
            "value_printed": wrong,
        }

    return [
        misprint(
            "eq. (8)",
            "e_x with a factor R cos γ too many: a length squared",
            "e_x = 2R³ sin²γ cosγ m m̃/(…)",
            "momentum after an impact over that before, γ = 0.28 rad [-]",
            after,
            printed,
        ),
        misprint(
            "eq. (12)",
            "bracket 1 + x − x_j + 2x₀",
            "bracket 1 − x + x_j + 2x₀",
            "force jump at a reversal over 2 f₀ [-]",
            _continuity(law),
            jump / (2 * law.f0),
        ),
        misprint(
            "Table 1(a), ξ",
            "30 %, which is W_D/(2π E_s)",
            "equivalent viscous damping W_D/(4π E_s)",
            "damping at x_max [%]",
            100 * got.damping_equivalent,
            100 * loss / (math.pi * force * paper.X_MAX),
        ),
        misprint(
            "Table 1(a), T_bi",
            "2 s, said of the isolated system",
            "secant period at x_max = 0.30 m only",
            "period: secant at x_max, and with k_b alone [s]",
            got.period,
            got.period_kb,
        ),
    ]


def _continuity(law):
    """Force jump of the corrected eq. (12) at `REVERSAL`, over 2 f0."""
    force = law.kb * REVERSAL + law.start(REVERSAL)
    x_j = history_point(law, REVERSAL, force, -1)
    return abs(branch(law, REVERSAL, -1, x_j) - force) / (2 * law.f0)


def _rocking_run():
    """An isolated block that rocks under the shipped motion: what eqs (3) to (6) are checked on."""
    return simulate(load_scene("caryatid-isolated").with_(block={"slenderness": 0.15}), history=False)


def _momentum_residual():
    """Eq. (2) integrated: (m + m_b)(v + int a_g dt) + int n_d f dt over a run, over the largest of its impulses."""
    scene = load_scene("caryatid-isolated")
    scene = scene.with_(duration=scene.motion.end)
    history = simulate(scene, output_step=scene.motion.dt / 8).history
    ground = cumulative_simpson(history.ground_acceleration, x=history.time, initial=0)
    bearings = cumulative_simpson(history.bearing_force, x=history.time, initial=0)
    left = scene.total_mass * (history.base_velocity + ground) + bearings
    return float(np.abs(left).max() / np.abs(bearings).max())


def _impact_by_balances(scene, rate):
    """(phi'+, jump of x') from linear momentum and the block's angular momentum about its new corner alone."""
    m, b, h = scene.block.mass, scene.block.half_width, scene.block.half_height
    about = scene.block.centre_inertia
    balances = np.array([[m * h, scene.total_mass], [about + m * (h * h + b * b), m * h]])
    return np.linalg.solve(balances, [m * h * rate, (about + m * (h * h - b * b)) * rate])


def _equation(number, what, status, check, value):
    return {"part": "equation", "number": number, "what": what, "status": status, "check": check, "value": value}


def _block_equations(scene):
    """Eqs (1) to (8), each by a number that it must give."""
    run, rate = _rocking_run(), -0.7
    spin, base = _impact_by_balances(scene, rate)
    _, corrected = RockingModel.of(scene).impact(rate)
    ledger = abs(run.energy.imbalance / run.energy.input)
    return [
        _equation("(1)", "rocking frequency", REPRODUCED, "ω_r [rad/s], 2.60 printed", scene.rocking_frequency),
        _equation(
            "(2)",
            "full contact on the bearings",
            REPRODUCED,
            "momentum balance over a run in full contact, over its largest impulse [-]",
            _momentum_residual(),
        ),
        _equation(
            "(3)–(6)",
            "rocking on the base, re-derived",
            REPRODUCED,
            f"imbalance of the energy over the input, {run.impact_count} impacts [-]",
            ledger,
        ),
        _equation(
            "(7)",
            "restitution e_φ",
            REPRODUCED,
            "difference from the momentum balances [-]",
            abs(restitution(scene) - spin / rate),
        ),
        _equation(
            "(8)",
            "jump of the base velocity",
            CORRECTED,
            "corrected form, relative difference from the momentum balances [-]; printed form: "
            f"{base_jump_length_as_printed(scene) / base_jump_length(scene) - 1:.3%} off",
            abs(corrected / base - 1),
        ),
    ]


def _bearing_equations(scene, law, arrays, jump):
    """Eqs (9) to (14), Fig. 3 and Table 1, likewise."""
    literal = np.abs(arrays["reversal/literal"] - arrays["reversal/right"]).max() / law.f0
    return [
        _equation(
            "(9)–(11)",
            "bearing force and its history x_j",
            REPRODUCED,
            "literal x_j form against the stable form, over f₀ [-] (literal is NaN beyond 1.33 m of travel)",
            float(literal),
        ),
        _equation(
            "(12)",
            "unloading branch",
            CORRECTED,
            f"force jump at a reversal over 2 f₀, corrected [-]; printed form: {jump / (2 * law.f0):.4f}",
            _continuity(law),
        ),
        _equation("(13)", "x₀ from k_a, k_b, α, δ_k", REPRODUCED, "2 x₀ [m]", 2 * law.x0),
        _equation("(14)", "f₀ from k_a, k_b, α, x₀", REPRODUCED, "f₀ of one bearing [N]", law.f0),
        _equation(
            "Fig. 3",
            "bearing law with its curves and reversal points",
            REPRODUCED,
            "W_D of one bearing at 0.30 m [J]",
            steady_cycle(law, paper.X_MAX)[0],
        ),
        _equation(
            "Table 1(a)",
            "design targets",
            REPRODUCED,
            "T_bi as secant period at x_max [s]",
            properties(scene.bearings, scene.total_mass, paper.X_MAX).period,
        ),
        _equation(
            "Table 1(b)",
            "bearings",
            REPRODUCED,
            "α designed from Table 1(a) [-]",
            design_bearings(scene.total_mass, paper.PERIOD, paper.DAMPING, paper.X_MAX, definition="paper").alpha,
        ),
    ]
