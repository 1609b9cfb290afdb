"""The sections of the report, from the result files; every number in them stands there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from analytic.response import UNCOMPARED, Difference

from ..showing.drawing import draw_scenes
from ..showing.parts import Section, Table, number
from ..showing.rows import Column, table
from ..showing.wording import TRUSTED, USABLE, differing, trust
from . import figures

if TYPE_CHECKING:
    from ..running.provenance import Result

NAME = Column("engine, variant", lambda row: ", ".join(filter(None, (row["engine"], row["variant"]))))


def scene_sections(result: Result) -> list[Section]:
    """Scenes and motion, outcomes, and the histories that the scenes have."""
    scenes = result.settings["scenes"]
    pictures = [draw_scenes(list(scenes.values()))]
    if result.settings["motion"]:
        pictures.append(figures.ground_motion(result))
    words = (
        "The Caryatid as a rigid block, once on rigid ground and once on a base carried by lead-rubber bearings (Table "
        "1 of the paper). The slenderness is not printed in the paper; 0.28 rad reproduces its claims under the record "
        "it used (Duzce 1999). Under another motion they need not hold.",
    )
    return [
        Section("The scenes", () if result.settings["own"] else words, (parameters(scenes),), tuple(pictures)),
        outcome_section(result),
        *_histories(result),
    ]


def _histories(result):
    """The section of the histories, none where every run failed or stands on rigid ground."""
    shown = []
    for name, scene in result.settings["scenes"].items():
        rows = [row for row in result.rows if row["scene"] == name and not row["failure"]]
        if not rows:
            continue
        gamma = scene["block"]["slenderness"]
        if any(row["outcome"] != "stands" for row in rows):
            limits = tilt_limits(result, name, gamma)
            shown.append(figures.histories(result, name, "tilt", "tilt φ/γ [-]", gamma, limits))
        if scene["base"]:
            shown.append(figures.histories(result, name, "base_displacement", "base displacement x [m]"))
        if scene["bearings"]:
            shown.append(figures.loops(result, name))
    if shown:
        words = (
            "Upper axes: all solvers over each other; lower axes: by how much they differ from the analytic model. A "
            "block that never lifts in any solver has no tilt to show."
        )
        if not result.settings["own"]:
            words += (
                " The bearings' damping in Table 1(a) of the paper, 30 %, is W_D/(2 π E_s); the usual equivalent "
                "viscous damping, W_D/(4 π E_s), is half of it."
            )
        yield Section("Histories and hysteresis", (words,), (), tuple(shown))


def outcome_section(result: Result) -> Section:
    """What each solver found, and how far it is from the analytic model."""
    scenes = result.settings["scenes"]
    motion = "; ".join(dict.fromkeys(filter(None, (scene["motion"] for scene in scenes.values())))) or "no motion"
    failed = tuple(
        (f"{row['engine']} on {row['scene']}: {row['failure']['reason']}", row["failure"].get("message", ""))
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
        ("quantity", *(row["engine"] for row in rows)),
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
                carried.setdefault(words, []).append(row["engine"])
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
    rows = [row for row in result.rows if row["scene"] == name and row["engine"] != "analytic" and "agreement" in row]
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
        work = next(row["bearing_work"] for row in result.rows if row["scene"] == name and row["engine"] == "analytic")
        errors = (100 * (row["bearing_work"] / work - 1) if work else None for row in rows)
        measures += [["work of the bearings [%]", *(number(error, 2) for error in errors)]]
    return (
        Table(
            f"{scene['name']}: engine minus analytic model", ("difference", *(row["engine"] for row in rows)), measures
        ),
    )


def restitution_section(result: Result) -> Section:
    """Restitution of the scenes' block against eq. (7), beside its cost."""
    starts = ", ".join(f"{start:g}" for start in result.settings["starts"])
    grounds = " and ".join(
        "on rigid ground" if mass is None else f"on a base of {mass:g} kg that slides without friction"
        for mass in result.settings["bases"]
    )
    return Section(
        "Restitution of this block",
        (
            f"Free rocking for {result.settings['seconds']:g} s, released from rest at φ/γ = {starts}, {grounds}. "
            "Restitution is φ̇⁺/φ̇⁻, from the states at the impact, and is compared with eq. (7). Error and CPU time "
            f"are those of the same runs. Trusted: error, root mean square, at most {TRUSTED:g} and no failed run; "
            f"usable: at most {USABLE:g}.",
        ),
        (
            table(
                "Restitution of this block, all grounds and starts together",
                result.rows,
                NAME,
                Column("rating", lambda row: trust(row["rms"], row["failed"])),
                Column("impacts [-]", "impacts"),
                Column("error, rms [-]", "rms"),
                Column("worst impact [-]", "worst"),
                Column("base velocity jump, relative error, rms [-]", "jump_rms"),
                Column("CPU time per simulated second [s/s]", "cpu_per_second"),
                Column("failed runs [-]", "{failed} of {runs}"),
            ),
            *_warnings("Free rocking", _carried(result.rows)),
        ),
    )


def _carried(rows):
    """{warning: names of the variants whose runs carry it}."""
    carried: dict[str, list[str]] = {}
    for row in rows:
        for warning in row["warnings"]:
            carried.setdefault(warning, []).append(NAME.text(row))
    return carried
