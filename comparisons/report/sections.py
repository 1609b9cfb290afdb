"""The sections of the report, from the result files; every number in them stands there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from analytic.response import UNCOMPARED, Difference

from ..showing.drawing import draw_scenes
from ..showing.parts import Section, Table, number
from ..showing.wording import TRUSTED, USABLE, differing, trust
from . import figures

if TYPE_CHECKING:
    from ..running.provenance import Result


def variant_groups(result: Result) -> list[dict[str, Any]]:
    """One dict a solver and variant, over all grounds and slendernesses of ``free-rocking.json``.

    solver, name, default, impacts (their number), rms, worst, jump_rms, time_rms, cpu_per_second, failures, warnings;
    root mean squares are weighted by the number of impacts behind them.
    """
    groups = {}
    for row in result.rows:
        groups.setdefault((row["solver"], row["variant"]), []).append(row)
    return [_group(solver, variant, rows) for (solver, variant), rows in groups.items()]


def _group(solver, variant, rows):
    measured = [row for row in rows if row["rms"] is not None]
    simulated = sum(row["simulated"] for row in measured)
    cpu = sum(row["cpu_per_second"] * row["simulated"] for row in measured)
    return {
        "solver": solver,
        "name": "analytic" if solver == "analytic" else f"{solver}, {variant}",
        "default": rows[0]["default"],
        "impacts": sum(len(row["impacts"]) for row in measured),
        "worst": max((row["worst"] for row in measured), default=None),
        "cpu_per_second": cpu / simulated if measured else None,
        "failures": [failure for row in rows for failure in row["failures"]],
        "warnings": list(dict.fromkeys(warning for row in rows for warning in row["warnings"])),
        **{measure: _pooled(measured, measure) for measure in ("rms", "jump_rms", "time_rms")},
    }


def _pooled(rows, measure):
    known = [(row[measure], len(row["impacts"])) for row in rows if row[measure] is not None]
    count = sum(weight for _, weight in known)
    return math.sqrt(sum(weight * value**2 for value, weight in known) / count) if count else None


def caryatid_sections(result: Result) -> list[Section]:
    """Scene, ground motion, free-standing and isolated Caryatid."""
    return [_setting_section(result), outcome_section(result), _history_section(result)]


def _setting_section(result):
    scenes = result.settings["scenes"]
    return Section(
        "The scenes and the ground motion",
        (
            "The Caryatid as a rigid block, once on rigid ground and once on a base carried by lead-rubber "
            "bearings (Table 1 of the paper). The slenderness is not printed in the paper; 0.28 rad reproduces "
            "its claims under the record it used (Duzce 1999). Under another motion they need not hold.",
        ),
        (parameters(scenes),),
        (draw_scenes(list(scenes.values())), figures.ground_motion(result)),
    )


def outcome_section(result: Result) -> Section:
    """What each solver found, and how far it is from the analytic model."""
    scenes = result.settings["scenes"]
    motion = "; ".join(dict.fromkeys(filter(None, (scene["motion"] for scene in scenes.values())))) or "no motion"
    failed = tuple(
        (f"{row['solver']} on {row['scene']}: {row['failure']['reason']}", row["failure"].get("message", ""))
        for row in result.rows
        if row["failure"]
    )
    return Section(
        "Outcomes",
        (
            f"Each solver on the same scenes under {motion}. A block that never lifts “stands”, one that lifts "
            "and stays upright “rocks”; it “overturns” at |φ| = 90°. |H|/N, horizontal over normal force under "
            "the block, is the friction coefficient needed not to slide; where the normal force N falls to 0 the "
            "block would jump. The model allows neither. Both are taken over the run, but for the fall of a "
            "block that overturns.",
            "A run goes on until its outcome is decided: until nothing that may still come can make the block "
            "overturn or keep it from it. One that ended earlier is “undecided”, with what it was so far. A "
            "warning names what lies outside what the model describes, or is odd about the record; the outcome "
            "beside it is then to be doubted. Every engine's run is compared with the analytic model's.",
            "Impact times and tilt graphs are compared up to the end, or up to the solver's sensitivity horizon "
            "where that comes first: beyond it a change of restitution, motion and start as small as the "
            "solver's own errors makes another motion, so that a difference says no more about it. The distance "
            "of two tilt graphs (Hausdorff) is how far a point of one can lie from the other, time in units of 2 "
            "π/ω_r and tilt in units of γ.",
        ),
        tuple(
            table
            for name in scenes
            for table in (
                _outcomes(result, name),
                *_warnings(scenes[name]["name"], warned(result, name)),
                *_agreement(result, name),
            )
        ),
        evidence=failed,
    )


def _history_section(result):
    scenes = result.settings["scenes"]
    rigid, isolated = scenes
    gamma = scenes[isolated]["block"]["slenderness"]
    return Section(
        "Histories and hysteresis",
        (
            "Upper axes: all solvers over each other; lower axes: by how much they differ from the analytic "
            "model. The bearings' damping of 30 % in Table 1(a) of the paper is W_D/(2 π E_s), with W_D the "
            "energy of a loop and E_s the elastic energy at its peak; the usual equivalent viscous damping, "
            "W_D/(4 π E_s), is half of it.",
        ),
        (),
        (
            figures.histories(result, rigid, "tilt", "tilt φ/γ [-]", scenes[rigid]["block"]["slenderness"]),
            figures.histories(result, isolated, "base_displacement", "base displacement x [m]"),
            figures.histories(result, isolated, "tilt", "tilt φ/γ [-]", gamma, tilt_limits(result, isolated, gamma)),
            figures.loops(result, isolated),
        ),
    )


def tilt_limits(result: Result, name: str, gamma: float) -> tuple[float | None, float | None]:
    """Contact noise of an engine is no tilt to look at: at least a hundredth of the slenderness up and down."""
    peaks = [row["peak_tilt"] for row in result.rows if row["scene"] == name and row.get("peak_tilt")]
    return (-0.01, 0.01) if max(peaks, default=0.0) < 0.01 * gamma else (None, None)


def parameters(scenes: Mapping[str, Any]) -> Table:
    """The numbers of the scenes, a column each; rows that none of them has are left out."""

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
            ("duration [s]", lambda scene: scene["duration"] or "until decided"),
            ("ground motion", lambda scene: scene.get("motion")),
        ):
            values = [pick(scene) for scene in scenes.values()]
            if all(value is None for value in values):
                continue
            yield [
                label,
                *("–" if value is None else value if isinstance(value, str) else f"{value:.6g}" for value in values),
            ]

    return Table("Parameters", ("quantity", *(scene["name"] for scene in scenes.values())), list(rows()))


# quantity with unit, key of the row, significant digits; a base's own last
OUTCOMES = (
    ("outcome", "verdict", None),
    ("overturns at [s]", "overturning_time", 5),
    ("peak |φ|/γ [-]", "peak_tilt_ratio", 4),
    ("impacts [-]", "impact_count", None),
    ("peak |H|/N [-]", "friction_demand", 3),
    ("least N/(m g) [-]", "min_normal_ratio", 3),
    ("warnings [-]", "warnings", None),
    ("run until [s]", "end", 5),
    ("steps [-]", "steps", None),
    ("CPU time [s]", "cpu_seconds", 2),
    ("CPU time per simulated second [s/s]", "cpu_per_second", 2),
)
BASE_OUTCOMES = (
    ("peak base displacement [m]", "peak_base_displacement", 5),
    ("peak absolute base acceleration [m/s²]", "peak_base_acceleration", 4),
    ("work of the bearings [J]", "bearing_work", 5),
)


def _outcomes(result, name):
    """A row for each quantity, a column for each solver."""
    rows = [row for row in result.rows if row["scene"] == name]
    scene = result.settings["scenes"][name]
    quantities = [*OUTCOMES, *(BASE_OUTCOMES if scene["base"] else ())]
    return Table(
        f"{scene['name']}, {_span(scene)}",
        ("quantity", *(row["solver"] for row in rows)),
        [[label, *(_value(row, key, digits) for row in rows)] for label, key, digits in quantities],
    )


def _span(scene):
    return "until decided" if scene["duration"] is None else f"{scene['duration']:g} s at most"


def warned(result: Result, name: str) -> dict[str, list[str]]:
    """{warning, or difference from the analytic model: the solvers whose runs of a scene carry it}."""
    carried = {}
    for row in result.rows:
        if row["scene"] == name:
            for words in (*different(row), *(warning["text"] for warning in row.get("warnings", ()))):
                carried.setdefault(words, []).append(row["solver"])
    return carried


def different(row: Mapping[str, Any]) -> list[str]:
    """In what the run of a row differs from the analytic model, or why it cannot be compared; sentences."""
    found = [Difference(**one) for one in row.get("differences", ())]
    return differing(row.get("comparable", UNCOMPARED), found)


def _warnings(name, found):
    """A table of `warned`, none where there is nothing to warn of."""
    rows = [[", ".join(solvers), warning] for warning, solvers in found.items()]
    return (Table(f"{name}: warnings", ("solver", "outside what is modelled, or differing"), rows),) if rows else ()


def _value(row, key, digits):
    value = row.get(key)
    if key == "end":
        value = value["time"] if value else None
    if key == "warnings":
        value = str(len(value)) if value else "none"
    if key == "friction_demand" and value is None and row.get("min_normal_ratio", 1) <= 0:
        return "∞ (N ≤ 0)"
    if digits is None:
        return "–" if value is None else str(value)
    return number(value, digits)


def _agreement(result, name):
    """What each engine's run differs by from the analytic model: a row for each measure, a column for each engine."""
    rows = [row for row in result.rows if row["scene"] == name and row["solver"] != "analytic" and "agreement" in row]
    if not rows:
        return ()
    scene = result.settings["scenes"][name]
    agreements = [row["agreement"] for row in rows]
    measures = [
        ["same outcome", *("yes" if agreement["same_outcome"] else "no" for agreement in agreements)],
        ["overturning time [s]", *(number(agreement["overturning_time_error"], 2) for agreement in agreements)],
        ["peak |φ|/γ [-]", *(number(agreement["peak_tilt_error"], 2) for agreement in agreements)],
        [
            "size of its errors: change of the model that does as much [-]",
            *(number(row["perturbation"], 2) for row in rows),
        ],
        ["up to its own sensitivity horizon [s]:", *(number(agreement["until"], 4) for agreement in agreements)],
        ["impact times, rms [s]", *(number(agreement["impact_time_error"], 2) for agreement in agreements)],
        ["lost impacts [-]", *(str(agreement["lost_impacts"]) for agreement in agreements)],
        ["distance of the tilt graphs [-]", *(number(agreement["graph_distance"], 2) for agreement in agreements)],
    ]
    if scene["base"]:
        measures += [
            [
                "peak base displacement [%]",
                *(number(100 * agreement["peak_displacement_error"], 2) for agreement in agreements),
            ]
        ]
    if scene["bearings"]:
        work = next(row["bearing_work"] for row in result.rows if row["scene"] == name and row["solver"] == "analytic")
        errors = (100 * (row["bearing_work"] / work - 1) if work else None for row in rows)
        measures += [["work of the bearings [%]", *(number(error, 2) for error in errors)]]
    return (
        Table(
            f"{scene['name']}: engine minus analytic model", ("difference", *(row["solver"] for row in rows)), measures
        ),
    )


def restitution_sections(result: Result) -> list[Section]:
    """Restitution against eq. (7), and error beside cost."""
    return [_impact_section(result), _cost_section(result)]


def _impact_section(result):
    starts = ", ".join(f"{start:g}" for start in result.settings["starts"])
    few = ", ".join(f"{start:g}" for start in result.settings["variant_starts"])
    grounds = {
        "rigid ground": "on rigid ground",
        "sliding base": "on a base of {mass:g} kg that slides without friction",
    }
    on = " and ".join(grounds[name].format(**(base or {})) for name, base in result.settings["bases"].items())
    return Section(
        "Restitution per impact",
        (
            f"Free rocking for {result.settings['seconds']:g} s, released from rest at φ/γ = {starts} (variants "
            f"that are not the default: {few}), {on}. The engines "
            f"are given no restitution{_applied(result)}: it follows from their contact. It is measured as φ̇⁺/φ̇⁻, "
            "the tilt rate after over that before the impact, from the states in clean flight, carried to the "
            "impact by the model's equations, for every "
            f"impact at least {100 * result.settings['slowest_impact']:g} % as fast as the run's fastest.",
            "The variants of an engine are ways to set it up: as a first script gets it (defaults), well set, but on "
            "its own (tuned), or with a velocity, position or constraint set by the adapter at the model's event "
            "(assisted). The table of what each engine computes says which is which.",
        ),
        tuple(_restitution_table(result, ground) for ground in result.settings["bases"]),
        (figures.restitution(result),),
    )


def _cost_section(result):
    groups = variant_groups(result)
    rows = [
        [
            group["name"],
            trust(group["rms"], len(group["failures"])),
            str(group["impacts"]),
            number(group["rms"], 2),
            number(group["worst"], 2),
            number(group["jump_rms"], 2),
            number(group["time_rms"], 2),
            number(group["cpu_per_second"], 2),
            str(len(group["failures"])),
        ]
        for group in groups
    ]
    return Section(
        "Error beside cost",
        (
            "Error and CPU time of the very same runs. Impact times are held against the closed form (elliptic "
            "integrals) on rigid ground, so the analytic model is on trial there as well. CPU time is that of the "
            "simulation alone: no import, no compilation, no building of the scene.",
            f"Restitution may be trusted if its error, root mean square, is at most {TRUSTED:g} and no run "
            f"failed; at most {USABLE:g} it is usable where a per cent does not matter.",
        ),
        (
            Table(
                "Error beside cost, all grounds and slendernesses together",
                (
                    "solver",
                    "restitution",
                    "impacts [-]",
                    "restitution error, rms [-]",
                    "restitution error, worst [-]",
                    "base velocity jump, relative error, rms [-]",
                    "impact times, relative error, rms [-]",
                    "CPU time per simulated second [s/s]",
                    "failed runs [-]",
                ),
                rows,
            ),
            *_warnings(
                "Free rocking",
                {
                    warning: [group["name"] for group in groups if warning in group["warnings"]]
                    for group in groups
                    for warning in group["warnings"]
                },
            ),
        ),
        (figures.error_and_cost(groups),),
    )


def _applied(result):
    """Which variants are the exception: their adapter applies the model's own impact."""
    names = [
        f"{engine}, {variant}"
        for engine, variants in result.settings["variants"].items()
        for variant, kind in variants.items()
        if kind["applies_impact"]
    ]
    return f" (but for {' and '.join(names)}, whose adapter applies the model's own impact)" if names else ""


def _restitution_table(result, ground):
    """Errors over slenderness, a row for each solver and variant."""
    rows = [row for row in result.rows if row["ground"] == ground]
    gammas = sorted({row["slenderness"] for row in rows})
    formula = {row["slenderness"]: row["restitution"] for row in rows}
    table = [["eq. (7) itself [-]", *(f"{formula[gamma]:.6f}" for gamma in gammas)]]
    for solver, variant in dict.fromkeys((row["solver"], row["variant"]) for row in rows):
        errors = {
            row["slenderness"]: row["rms"] for row in rows if (row["solver"], row["variant"]) == (solver, variant)
        }
        table.append([f"{solver}, {variant}", *(number(errors.get(gamma), 2) for gamma in gammas)])
    return Table(
        f"Error of restitution on {'a ' if ground == 'sliding base' else ''}{ground}, root mean square [-]",
        ("solver", *(f"γ = {gamma:g} rad" for gamma in gammas)),
        table,
    )
