"""The sections of the report, from the result files; every number in them stands there."""

import math

from . import figures
from .content import Section, Table, number
from .drawing import draw_scenes


def variant_groups(result):
    """One dict a solver and variant, over all grounds and slendernesses of ``free-rocking.json``.

    solver, name, default, impacts (their number), rms, worst, jump_rms, time_rms, cpu_per_second, failures; root mean
    squares are weighted by the number of impacts behind them.
    """
    groups = {}
    for row in result.rows:
        groups.setdefault((row["solver"], row["variant"]), []).append(row)
    return [_group(solver, variant, rows) for (solver, variant), rows in groups.items()]


def _group(solver, variant, rows):
    measured = [row for row in rows if row["rms"] is not None]
    simulated = sum(row["simulated"] for row in measured)
    cpu = sum(row["cpu_per_second"] * row["simulated"] for row in measured)
    return {"solver": solver, "name": "analytic" if solver == "analytic" else f"{solver}, {variant}",
            "default": rows[0]["default"], "impacts": sum(len(row["impacts"]) for row in measured),
            "worst": max((row["worst"] for row in measured), default=None),
            "cpu_per_second": cpu / simulated if measured else None,
            "failures": [failure for row in rows for failure in row["failures"]],
            **{measure: _pooled(measured, measure) for measure in ("rms", "jump_rms", "time_rms")}}


def _pooled(rows, measure):
    known = [(row[measure], len(row["impacts"])) for row in rows if row[measure] is not None]
    count = sum(weight for _, weight in known)
    return math.sqrt(sum(weight * value**2 for value, weight in known) / count) if count else None


def caryatid_sections(result):
    """Scene, ground motion, free-standing and isolated Caryatid."""
    scenes = result.settings["scenes"]
    rigid, isolated = scenes
    failed = tuple((f"{row['solver']} on {row['scene']}: {row['failure']['reason']}",
                    row["failure"].get("message", "")) for row in result.rows if row["failure"])
    motion = result.settings["motion"]["label"]
    gamma = scenes[isolated]["block"]["slenderness"]
    return [
        Section("The scenes and the ground motion", (
            "The Caryatid as a rigid block, once on rigid ground and once on a base carried by lead-rubber bearings "
            "(Table 1 of the paper). The slenderness is not printed in the paper; 0.28 rad reproduces its claims.",),
            (_parameters(scenes),), (draw_scenes(list(scenes.values())), figures.ground_motion(result))),
        Section("Outcomes", (f"Each solver on the same scenes under {motion}. Overturning is |φ| = 90°. Friction "
                             "demand |H|/N and normal force N/(m g) are what the model's assumptions of no sliding "
                             "and no jumping ask for.",), (_outcomes(result), _agreement(result)), evidence=failed),
        Section("Histories and hysteresis", (
            "The bearings' damping of 30 % in Table 1(a) is W_D/(2 π E_s); the usual equivalent viscous damping "
            "W_D/(4 π E_s) is half of it.",), (), (
            figures.histories(result, rigid, "tilt", "tilt φ/γ [-]", scenes[rigid]["block"]["slenderness"]),
            figures.histories(result, isolated, "base_displacement", "base displacement x [m]"),
            figures.histories(result, isolated, "tilt", "tilt φ/γ [-]", gamma, _tilt_limits(result, isolated, gamma)),
            figures.loops(result, isolated))),
    ]


def _tilt_limits(result, name, gamma):
    """Contact noise of an engine is no tilt to look at: at least a hundredth of the slenderness up and down."""
    peaks = [row["peak_tilt"] for row in result.rows if row["scene"] == name and row.get("peak_tilt")]
    return (-0.01, 0.01) if max(peaks, default=0.0) < 0.01 * gamma else (None, None)


def _by_scene(result):
    scenes = list(result.settings["scenes"])
    return sorted(result.rows, key=lambda row: scenes.index(row["scene"]))


def _hundred(fraction):
    return None if fraction is None else 100 * fraction


def _parameters(scenes):
    def rows():
        for label, pick in (
                ("mass of the block m [kg]", lambda scene: scene["block"]["mass"]),
                ("corner to centre of mass R [m]", lambda scene: scene["block"]["radius"]),
                ("slenderness γ [rad]", lambda scene: scene["block"]["slenderness"]),
                ("rocking frequency ω_r [rad/s], eq. (1)", lambda scene: scene["rocking_frequency"]),
                ("restitution e_φ [-], eq. (7)", lambda scene: scene["restitution"]),
                ("mass of the base m_b [kg]", lambda scene: (scene["base"] or {}).get("mass")),
                ("bearings [-]", lambda scene: (scene["bearings"] or {}).get("count")),
                ("k_a of each [N/m]", lambda scene: (scene["bearings"] or {}).get("ka")),
                ("k_b of each [N/m]", lambda scene: (scene["bearings"] or {}).get("kb")),
                ("α [-]", lambda scene: (scene["bearings"] or {}).get("alpha")),
                ("duration [s]", lambda scene: scene["duration"])):
            values = [pick(scene) for scene in scenes.values()]
            yield [label, *("–" if value is None else f"{value:.6g}" for value in values)]
    return Table("Parameters", ("quantity", *(scene["name"] for scene in scenes.values())), list(rows()))


def _outcomes(result):
    rows = []
    for row in _by_scene(result):
        if row["failure"]:
            rows.append([result.settings["scenes"][row["scene"]]["name"], row["solver"], "failed", *["–"] * 8])
            continue
        rows.append([result.settings["scenes"][row["scene"]]["name"], row["solver"], row["outcome"],
                     number(row["overturning_time"], 4), number(row["peak_tilt_ratio"], 4),
                     number(row["peak_base_displacement"], 4), number(row["peak_base_acceleration"] / 9.81, 4),
                     str(row["impact_count"]), number(row["friction_demand"]), number(row["min_normal_ratio"]),
                     number(row["cpu_seconds"], 2)])
    return Table("Outcomes", ("scene", "solver", "outcome", "overturns at [s]", "peak |φ|/γ [-]", "peak |x| [m]",
                              "peak base acceleration [g]", "impacts [-]", "peak |H|/N [-]", "least N/(m g) [-]",
                              "CPU time [s]"), rows)


def _agreement(result):
    rows = []
    for row in _by_scene(result):
        found = row.get("agreement")
        if found is None or row["solver"] == "analytic":
            continue
        work = next((other["bearing_work"] for other in result.rows if other["scene"] == row["scene"]
                     and other["solver"] == "analytic" and other.get("bearing_work")), None)
        rows.append([result.settings["scenes"][row["scene"]]["name"], row["solver"],
                     "yes" if found["same_outcome"] else "no", number(found["overturning_time_error"], 2),
                     number(found["peak_tilt_error"], 2), number(_hundred(found["peak_displacement_error"]), 2),
                     number(_hundred(row["bearing_work"] / work - 1 if work else None), 2), str(found["lost_impacts"]),
                     number(found["graph_distance"], 2), number(found["until"], 4), number(row["cpu_per_second"], 2)])
    return Table("Difference from the analytic model, with its cost. The last five columns hold up to the time named: "
                 "the end, or the sensitivity horizon where that comes first (restitution, motion and start changed by "
                 "1/10 000 then make another motion).",
                 ("scene", "solver", "same outcome", "overturning time [s]", "peak |φ|/γ [-]", "peak |x| [%]",
                  "work of the bearings [%]", "lost impacts [-]", "distance of tilt graphs [-]", "up to [s]",
                  "CPU time per simulated second [s/s]"), rows)


def restitution_sections(result):
    """Restitution against eq. (7), and error beside cost."""
    starts = ", ".join(f"{start:g}" for start in result.settings["starts"])
    few = ", ".join(f"{start:g}" for start in result.settings["variant_starts"])
    groups = variant_groups(result)
    rows = [[group["name"], str(group["impacts"]), number(group["rms"], 2), number(group["worst"], 2),
             number(group["jump_rms"], 2), number(group["time_rms"], 2), number(group["cpu_per_second"], 2),
             str(len(group["failures"]))] for group in groups]
    return [
        Section("Restitution per impact", (
            f"Free rocking for {result.settings['seconds']:g} s, released from rest at φ/γ = {starts} (variants that "
            f"are not the default: {few}), on rigid ground and on a base of "
            f"{result.settings['bases']['sliding base']['mass']:g} kg that slides without friction. The engines are "
            "given no restitution (but for switched-joints, which applies the model's own impact): it follows from "
            "their contact. It is measured as φ̇⁺/φ̇⁻ from the states in clean flight, carried to the impact by the model's equations, for every impact at least "
            f"{100 * result.settings['slowest_impact']:g} % as fast as the run's fastest.",),
            tuple(_restitution_table(result, ground) for ground in result.settings["bases"]),
            (figures.restitution(result),)),
        Section("Error beside cost", (
            "Error and CPU time of the very same runs. Impact times are held against the closed form (elliptic "
            "integrals) on rigid ground, so the analytic model is on trial there as well. CPU time is that of the "
            "simulation alone: no import, no compilation, no building of the scene.",),
            (Table("Error beside cost, all grounds and slendernesses together",
                   ("solver", "impacts [-]", "restitution error, rms [-]", "restitution error, worst [-]",
                    "base velocity jump, relative error, rms [-]", "impact times, relative error, rms [-]",
                    "CPU time per simulated second [s/s]", "failed runs [-]"), rows),),
            (figures.error_and_cost(groups),)),
    ]


def _restitution_table(result, ground):
    """Errors over slenderness, a row for each solver and variant."""
    rows = [row for row in result.rows if row["ground"] == ground]
    gammas = sorted({row["slenderness"] for row in rows})
    formula = {row["slenderness"]: row["restitution"] for row in rows}
    table = [["eq. (7) itself [-]", *(f"{formula[gamma]:.6f}" for gamma in gammas)]]
    for solver, variant in dict.fromkeys((row["solver"], row["variant"]) for row in rows):
        found = {row["slenderness"]: row["rms"] for row in rows if (row["solver"], row["variant"]) == (solver, variant)}
        table.append([f"{solver}, {variant}", *(number(found.get(gamma), 2) for gamma in gammas)])
    return Table(f"Error of restitution on {'a ' if ground == 'sliding base' else ''}{ground}, root mean square [-]",
                 ("solver", *(f"γ = {gamma:g} rad" for gamma in gammas)), table)
