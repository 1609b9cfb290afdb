"""Sections of the report on its own runs; every number in them stands in the result files."""

from collections.abc import Callable, Mapping
from typing import Any

from analytic.records import G
from analytic.response import UNCOMPARED, Difference

from ..execution.results import Result
from ..plotting.charts import figure
from ..plotting.parts import Section, Table, across, grouped, table
from ..plotting.wording import TRUSTED, USABLE, differing, outcomes, trust
from ..schemas.columns import NAME, Column, number
from . import figures


def scene_sections(result: Result) -> list[Section]:
    """Return the sections of the page of runs: scenes and motion, outcomes, histories."""
    scenes, own_scenes = result.settings["scenes"], result.settings["own"]
    pictures = [figures.blocks(list(scenes.values()))]
    if result.settings["motion"]:
        pictures.append(figures.ground_motion(result))
    words = (
        "The Caryatid as a rigid block, once on rigid ground and once on a base carried by lead-rubber bearings (Table "
        "1 of the paper). The paper does not print the slenderness. With 0.28 rad its claims hold under the record "
        "that it used (Duzce 1999). Under another motion they need not hold."
    )
    sections = [
        Section("The scenes", () if own_scenes else (words,), (parameters(scenes),), tuple(pictures)),
        outcome_section(result),
    ]
    if shown := [picture for name in scenes for picture in _histories(result, name)]:
        words = (
            "Left: all solvers overlaid. Right: difference from the analytic model. Tilt is not drawn for a block that "
            "lifts in no solver."
        )
        if not own_scenes:
            words += (
                " The damping of the bearings in Table 1(a) of the paper, 30 %, is W_D/(2 π E_s). The usual equivalent "
                "viscous damping, W_D/(4 π E_s), is half of it."
            )
        sections.append(Section("Histories and hysteresis", (words,), (), tuple(shown)))
    return sections


def _histories(result, name):
    """Yield figures of a scene's histories and, with bearings, of their loops; none if every run failed."""
    scene = result.settings["scenes"][name]
    solvers = [row["engine"] for row in figures.drawn(result, name)]
    for charts in figures.pairs(result, name):
        yield figure(charts, charts[-1].says, solvers)
    if scene["bearings"] and solvers:
        chart = figures.loops(result, name)
        yield figure([chart], chart.says, solvers)


def failures(result: Result) -> tuple[tuple[str, str], ...]:
    """Return (run and reason, message) of runs that failed."""
    return tuple(
        (f"{row['engine']} on {row['scene']}: {row['failure']['reason']}", row["failure"].get("message", ""))
        for row in result.rows
        if row["failure"]
    )


def outcome_section(result: Result) -> Section:
    """Return the section on each solver's outcomes, and on its distance from the analytic model."""
    scenes = result.settings["scenes"]
    motion = "; ".join(dict.fromkeys(filter(None, (scene["motion"] for scene in scenes.values())))) or "no motion"
    return Section(
        "Outcomes",
        (
            f"Each solver runs the same scenes under {motion}. A block that never lifts “stands”, or “slides” on its "
            "support. A block that lifts and stays upright “rocks”. At |φ| = 90° it “overturns”. |H|/N, horizontal "
            "over normal force under the block, is the friction coefficient needed to prevent sliding. Where the "
            "normal force N falls to 0, the block jumps. In the model it slides or jumps only if the scene gives a "
            "friction coefficient. Both quantities are taken over the run, without the fall of a block that overturns.",
            "A run continues until its outcome is decided: nothing later can make the block overturn or prevent it. A "
            "run that ended earlier is “undecided”; its outcome so far is given. A warning names what lies outside the "
            "model, or what is unusual about the record. Do not rely on an outcome with a warning. Every engine's run "
            "is compared with the analytic model's.",
            "Impact times and tilt graphs are compared up to the end of the run or the sensitivity horizon, whichever "
            "comes first. The common horizon is the same for all solvers: that of a change of restitution, motion or "
            "start by 10⁻⁴. A solver's own horizon is that of a change as large as its errors; a difference beyond it "
            "says nothing about the solver. The distance of two tilt graphs (Hausdorff) is the largest distance of a "
            "point of one from the other, with time in units of 2 π/ω_r and tilt in units of γ.",
        ),
        tuple(
            table
            for name in scenes
            for table in (
                _outcome_table(result, name),
                *_warning_tables(scenes[name]["name"], warned(result, name)),
                *_agreement_tables(result, name),
            )
        ),
        evidence=failures(result),
    )


PARAMETERS: tuple[tuple[str, Callable[[Mapping[str, Any]], Any]], ...] = (
    ("mass of the block m [kg]", lambda scene: scene["block"]["mass"]),
    ("corner to centre of mass R [m]", lambda scene: scene["block"]["radius"]),
    ("slenderness γ [rad]", lambda scene: scene["block"]["slenderness"]),
    ("rocking frequency ω_r [rad/s], eq. (1)", lambda scene: scene["rocking_frequency"]),
    ("restitution e_φ [-], eq. (7) unless given", lambda scene: scene["restitution"]),
    ("mass of the base m_b [kg]", lambda scene: (scene["base"] or {}).get("mass")),
    ("bearings [-]", lambda scene: (scene["bearings"] or {}).get("count")),
    ("k_a of each [N/m]", lambda scene: (scene["bearings"] or {}).get("ka")),
    ("k_b of each [N/m]", lambda scene: (scene["bearings"] or {}).get("kb")),
    ("α [-]", lambda scene: (scene["bearings"] or {}).get("alpha")),
    ("friction of the block on its support [-]", lambda scene: scene.get("friction")),
    ("duration [s]", lambda scene: scene["duration"] or "until decided"),
    ("ground motion", lambda scene: scene.get("motion")),
)


def parameters(scenes: Mapping[str, Any]) -> Table:
    """Return a table of the scenes' numbers, a column for each scene; a row without any number is left out."""

    def cell(value):
        return "–" if value is None else value if isinstance(value, str) else f"{value:.6g}"

    values_of = {label: [pick(scene) for scene in scenes.values()] for label, pick in PARAMETERS}
    rows = [[label, *map(cell, values)] for label, values in values_of.items() if values.count(None) < len(values)]
    return Table("Parameters", ("quantity", *(scene["name"] for scene in scenes.values())), rows)


def _column(head: str, key: str, digits: int = 2) -> Column:
    """Return the column of a quantity that not every run has."""
    return Column(head, lambda row: row.get(key), digits)


OUTCOMES = (
    Column("outcome", "outcome_text"),
    _column("overturns at [s]", "overturning_time", 5),
    _column("peak |φ|/γ [-]", "peak_tilt_ratio", 4),
    _column("impacts [-]", "impact_count"),
    Column("peak |H|/N [-]", lambda row: _demand(row), 3),
    _column("least N/(m g) [-]", "min_normal_ratio", 3),
    Column("warnings [-]", lambda row: len(row.get("warnings") or ()) or "none"),
    Column("run until [s]", lambda row: (row.get("end") or {}).get("time"), 5),
    _column("steps [-]", "steps"),
    _column("CPU time [s]", "cpu_seconds"),
    _column("CPU time per simulated second [s/s]", "cpu_per_second"),
)
BASE_OUTCOMES = (
    _column("peak base displacement [m]", "peak_base_displacement", 5),
    _column("peak absolute base acceleration [m/s²]", "peak_base_acceleration", 4),
    _column("work of the bearings [J]", "bearing_work", 5),
)


def _demand(row):
    demand, least = row.get("friction_demand"), row.get("min_normal_ratio")
    return "∞ (N ≤ 0)" if demand is None and least is not None and least <= 0 else demand


def _slip(head: str, key: str) -> Column:
    """Return the column of a number that only a sliding block has."""
    return Column(head, lambda row: (row.get("sliding") or {}).get(key), 4)


SLIP = (
    _slip("largest slip [m]", "peak"),
    _slip("slip at the end [m]", "end"),
    _slip("way slid, to and fro [m]", "path"),
    _slip("work of friction [J]", "work"),
)


def _outcome_table(result, name):
    """Return the table of outcomes of a scene: a row for each quantity, a column for each solver."""
    rows = [row for row in result.rows if row["scene"] == name]
    scene = result.settings["scenes"][name]
    span = "until decided" if scene["duration"] is None else f"{scene['duration']:g} s at most"
    quantities = [*OUTCOMES, *(BASE_OUTCOMES if scene["base"] else ()), *(SLIP if figures.slides(rows) else ())]
    return across(f"{scene['name']}, {span}", rows, Column("quantity", "engine"), *quantities)


def warned(result: Result, name: str) -> dict[str, list[str]]:
    """Return {warning, or difference from the analytic model: the solvers whose runs of a scene have it}."""
    rows = [row for row in result.rows if row["scene"] == name]
    texts = [[*different(row), *(warning["text"] for warning in row.get("warnings", ()))] for row in rows]
    return _names_by_text([row["engine"] for row in rows], texts)


def _names_by_text(names, texts):
    """Return {text: the names that have it}; texts: a list of texts for each name."""
    pairs = [(name, text) for name, carried in zip(names, texts, strict=True) for text in carried]
    return {text: [name for name, _ in members] for (text,), members in grouped(pairs, lambda pair: pair[1]).items()}


def different(row: Mapping[str, Any]) -> list[str]:
    """Return how the run of a row differs from the analytic model, or why it cannot be compared, in sentences."""
    differences = [Difference(**difference) for difference in row.get("differences", ())]
    return differing(row.get("comparable", UNCOMPARED), differences)


def _warning_tables(name, carried):
    """Return the table of warnings as `warned` gives them, in a tuple; an empty tuple without warnings."""
    rows = [[", ".join(solvers), warning] for warning, solvers in carried.items()]
    return (Table(f"{name}: warnings", ("solver", "warning, or difference from the model"), rows),) if rows else ()


def _distance(head: str, key: str, digits: int = 2, *, percent: bool = False, until: str = "agreement") -> Column:
    """Return the column of a distance from the analytic model, up to the common horizon ("agreement") or its own."""
    return Column(head, lambda row: row[until][key], digits, percent)


def _trajectory_columns(which: str, until: str) -> tuple[Column, ...]:
    return (
        _distance(f"up to {which} sensitivity horizon [s]:", "until", 4, until=until),
        _distance("impact times, rms [s]", "impact_time_error", until=until),
        _distance("missed impacts [-]", "lost_impacts", until=until),
        _distance("distance of the tilt graphs [-]", "graph_distance", until=until),
    )


AGREEMENT = (
    Column("same outcome", lambda row: "yes" if row["agreement"]["same_outcome"] else "no"),
    _distance("overturning time [s]", "overturning_time_error"),
    _distance("peak |φ|/γ [-]", "peak_tilt_error"),
    *_trajectory_columns("the common", "agreement"),
    Column("change of the model with as large an effect as the engine's errors [-]", "perturbation"),
    *_trajectory_columns("its own", "own_agreement"),
)


def _peak_slip(row):
    return (row.get("sliding") or {}).get("peak")


def _agreement_tables(result, name):
    """Return a table of differences from the analytic model: a row for each measure, a column for each engine."""
    rows = [row for row in result.rows if row["scene"] == name and row["engine"] != "analytic" and "agreement" in row]
    if not rows:
        return ()
    scene, measures = result.settings["scenes"][name], [*AGREEMENT]
    model = next(row for row in result.rows if row["scene"] == name and row["engine"] == "analytic")
    if slip := _peak_slip(model):
        measures.append(Column("largest slip", lambda row: _peak_slip(row) and _peak_slip(row) / slip - 1, 2, True))
    if scene["base"]:
        measures.append(_distance("peak base displacement", "peak_displacement_error", percent=True))
    if scene["bearings"]:
        work = model["bearing_work"]
        error = Column("work of the bearings", lambda row: row["bearing_work"] / work - 1 if work else None, 2, True)
        measures.append(error)
    return (across(f"{scene['name']}: engine minus analytic model", rows, Column("difference", "engine"), *measures),)


def restitution_section(result: Result, given: bool = False) -> Section:
    """Return the section on restitution of the scenes' block against eq. (7); given: whether a scene states another."""
    starts = ", ".join(f"{start:g}" for start in result.settings["starts"])
    grounds = " and ".join(
        "on rigid ground" if mass is None else f"on a base of {mass:g} kg that slides without friction"
        for mass in result.settings["bases"]
    )
    return Section(
        "Restitution of this block",
        (
            f"The block rocks freely for {result.settings['seconds']:g} s, released from rest at φ/γ = {starts}, "
            f"{grounds}. Restitution is measured by states, φ̇⁺/φ̇⁻ at the impact, without slip, and compared with eq. "
            f"(7). Error and CPU time come from the same runs. Trusted: an rms error of at most {TRUSTED:g}, no failed "
            f"run and no missed impact. Usable: the same with at most {USABLE:g}.",
            *(["The restitution that the scene states is not used here: it would rate no engine."] if given else []),
        ),
        (
            table(
                "Restitution of this block, all grounds and starts together",
                result.rows,
                NAME,
                Column("rating", lambda row: trust(row["rms"], row["failed"] + row["lost"])),
                Column("impacts [-]", "impacts"),
                Column("missed impacts [-]", "lost"),
                Column("error, rms [-]", "rms"),
                Column("worst impact [-]", "worst"),
                Column("base velocity jump, relative error, rms [-]", "jump_rms"),
                Column("CPU time per simulated second [s/s]", "cpu_per_second"),
                Column("failed runs [-]", "{failed} of {runs}"),
            ),
            *_warning_tables(
                "Free rocking", _names_by_text(map(NAME.text, result.rows), [row["warnings"] for row in result.rows])
            ),
        ),
    )


CAPTION = (
    "Left: all solvers overlaid. Right: difference from the analytic model; values below 10⁻⁹ are drawn there. Tilt is "
    "not drawn where the block lifts in no solver."
)


def earthquake(result: Result) -> Section:
    """Return the section of the first page on the report's own runs."""
    scenes, motion = result.settings["scenes"], result.settings["motion"]
    charts = [chart for name in scenes for pair in figures.pairs(result, name) for chart in pair]
    found_words = "; ".join(
        f"{scene['name']}: {outcomes([{**row, 'differences': ()} for row in result.rows if row['scene'] == name])}"
        for name, scene in scenes.items()
    )
    under = f"Under {motion['label']}, peak {number(motion['peak'] / G)} g. " if motion else ""
    warnings = [
        [scenes[name]["name"], ", ".join(who), words] for name in scenes for words, who in warned(result, name).items()
    ]
    warning_table = Table("Warnings, and differences from the analytic model", ("scene", "solver", "warning"), warnings)
    return Section(
        f"{'One earthquake' if motion else 'One scene'}: {found_words}",
        (
            f"{under}Each solver runs until its outcome is decided. Tilt is compared up to the common sensitivity "
            "horizon.",
        ),
        (_first_page_table(result), warning_table) if warnings else (_first_page_table(result),),
        (
            figure(
                charts,
                f"{CAPTION}{SHADED if figures.slides(result.rows) else ''}",
                [row["engine"] for row in result.rows],
            ),
        )
        if charts
        else (),
        evidence=failures(result),
        measured=(
            "Distance of tilt graphs (Hausdorff): the largest distance of a point of one from the other, with time in "
            "units of 2π/ω_r and tilt in units of γ. Friction demand and normal force are taken over the run, without "
            "the fall of a block that overturns. For engines they are computed from the states by the model's "
            "equations. The page of the runs has all measurements and the bearing loops.",
        ),
    )


def _first_page_table(result):
    def agreement(key):
        return lambda row: (row.get("agreement") or {}).get(key) if row["engine"] != figures.ANALYTIC else None

    return table(
        "Outcomes, and distance from the analytic model up to the sensitivity horizon",
        result.rows,
        Column("solver", "engine"),
        Column("scene", lambda row: result.settings["scenes"][row["scene"]]["name"]),
        Column("outcome", "outcome_text"),
        Column("overturns at [s]", lambda row: row.get("overturning_time"), 5),
        Column("peak |φ|/γ [-]", lambda row: row.get("peak_tilt_ratio"), 3),
        Column("peak x [m]", lambda row: row.get("peak_base_displacement"), 4),
        *([_slip("largest slip [m]", "peak")] if figures.slides(result.rows) else ()),
        Column("error of peak x", agreement("peak_displacement_error"), percent=True),
        Column("distance of tilt graphs [-]", agreement("graph_distance")),
        Column("horizon [s]", agreement("until"), 3),
        Column("warnings", lambda row: len(row.get("warnings") or ())),
    )


SHADED = " Shaded: the block slides in the analytic model."
