"""The page of the restitution study: errors at impacts, and their causes.

It shows the error of restitution over slenderness and base mass, on bearings and at all levels. Then it takes the first
impact of a block apart to show why engines err, changes suspected causes one at a time, and compares the base velocity
jump with eq. (8).
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...execution.results import Result
from ...metrics.errors import rms
from ...plotting.charts import Axis, Chart, figure, key_of
from ...plotting.figures import SUBJECTS, Series, as_it_comes, beside, kind, lines, shades, subject
from ...plotting.parts import RESTITUTION, Figure, Head, Judgement, Mark, Page, Table, grouped, setting_of, table, where
from ...plotting.wording import TRUSTED, USABLE, listed, rating, trust, with_counts
from ...schemas.columns import NAME, Column, Row, number, percent, short
from .study import COLUMNS, STEPS

FLOOR = 1e-9  # smaller errors are drawn here

ERROR = COLUMNS["rms"]
DRAWN_ERROR = Column(ERROR.head, lambda row: row["rms"] and max(row["rms"], FLOOR))
MEAN, WORST = COLUMNS["bias"], COLUMNS["worst"]
JUMP = COLUMNS["jump_rms"]
STATE = COLUMNS["rms_state"]
WORST_STATE = COLUMNS["worst_state"]
WORST_JUMP = COLUMNS["jump_worst"]
LATE = COLUMNS["time_rms"]
LOST = COLUMNS["lost"]
CPU = COLUMNS["cpu_per_second"]
FAILED = Column("failed runs [-]", "{failed} of {runs}")
GROUND = COLUMNS["ground"]
GAMMA = COLUMNS["slenderness"]
BASE_RATIO, PERIOD = COLUMNS["ratio"], Column("isolation period [s]", "period")
BASE = Column("base mass over block mass [-]", lambda row: "rigid" if row["ratio"] is None else short(row["ratio"]))


def ground(row: Row) -> str:
    """Return what the block of a row stands on, in words."""
    return "rigid ground" if row["ratio"] is None else "sliding base"


def causes(result: Result, variants: Mapping[str, Row]) -> Iterator[Figure | Table | str | None]:
    """Yield what is shown of experiments that change one cause: step phase, settings, friction, damping in flight."""
    phases, damped = where(result.rows, part="phase"), where(result.rows, part="flight damping")
    yield from _step_phases(result, phases)
    settings = [{**row, "ground": ground(row)} for row in where(result.rows, part="experiment")]
    changed: dict[str, Any] = dict(
        panel=lambda row: f"{row['experiment']}: {NAME.of(row)}", series=Series(by="ground"), log="xy"
    )
    needed = [("x", mu, f"{ground}: {number(mu, 2)}") for ground, mu in result.settings["friction_needed"].items()]
    yield beside(
        lines(
            where(settings, experiment="stiffness"),
            COLUMNS["value"].called("contact stiffness [N/m]"),
            DRAWN_ERROR,
            f"One setting changed alone, at slenderness {result.settings['experiment_slenderness']:g}.",
            **changed,
        ),
        lines(
            where(settings, experiment="friction"),
            COLUMNS["value"].called("friction coefficient [-]"),
            DRAWN_ERROR,
            "Dashed: the friction coefficient that the model's impact needs (horizontal over vertical impulse).",
            rules=needed,
            **changed,
        ),
    )
    yield from _damping(damped, variants)
    yield table(
        "One setting changed at a time",
        settings,
        COLUMNS["experiment"],
        NAME,
        BASE,
        COLUMNS["value"],
        ERROR,
        MEAN,
        JUMP,
        COLUMNS["jump_8"],
        COLUMNS["jump_8_printed"],
        CPU,
        FAILED,
    )
    sought = {row["engine"] for row in (*phases, *damped, *result.settings["experiments"])}
    if without := [engine for engine in result.settings["engines"] if engine not in sought]:
        yield (
            f"No causes were tested in {listed(without)}. Such a test needs a tuned variant with a fixed step, or a "
            "setting besides the accuracy parameter that the engine's record names as one to change alone."
        )


def _step_phases(result, phases):
    """Figure and table of the error over where in a step the impact falls."""
    points = [
        {**row, "phase": phase, "error": error / row["step"], "by": f"step {1e3 * row['step']:g} ms"}
        for row in phases
        for key in (f"phase/{row['engine']}/{row['variant']}/{row['step']:g}",)
        for phase, error in zip(result.arrays[f"{key}/phase"], result.arrays[f"{key}/error"], strict=True)
    ]
    yield lines(
        points,
        Column("place of the impact within the step [-]", "phase"),
        Column("error of restitution over step [1/s]", "error"),
        "Step phase: with a fixed step the error depends on where in the step the impact falls.",
        panel=NAME.of,
        series=Series(by="by", joined=False),
    )
    yield table(
        "Step phase: a sawtooth of the impact's place within the step, fitted to the error by swings",
        phases,
        NAME,
        COLUMNS["step"],
        COLUMNS["explained"],
        Column("least error [-]", lambda row: row["least"] * row["step"]),
        Column("greatest error [-]", lambda row: row["most"] * row["step"]),
    )


def _damping(damped, variants):
    """Figure and table of damping in flight as the cause of the error.

    Blocks that need more friction than the variant has slide, so they are in the table only.
    """
    rows = [{**variants[NAME.of(row)], **row, "whose": NAME.of(row)} for row in damped]
    stick = [row for row in rows if row["friction"] is None or row["friction_needed"] < row["friction"]]
    predicted = [
        {**same[0], "engine": "analytic", "by": "damped as it is", "error": same[0]["predicted"]}
        for same in grouped(stick, "whose", "slenderness").values()
    ]
    yield lines(
        [*predicted, *({**row, "error": row["measured"], "by": setting_of(row)} for row in stick)],
        GAMMA,
        Column("mean error of restitution [-]", "error"),
        "Damping in flight, built into the engine: the error of the analytic model with this damping added (“damped as "
        "it is”), and the error measured in the engine. Blocks that slide are not drawn.",
        panel="whose",
        series=Series(by="by"),
    )
    yield table(
        "Damping in flight, on rigid ground",
        rows,
        NAME,
        Column("setting", setting_of),
        GAMMA,
        COLUMNS["predicted"],
        COLUMNS["measured"],
        COLUMNS["friction_needed"],
        COLUMNS["friction"],
    )


def equation_8(result: Result, cells: Iterable[Row], ratings: Mapping[str, Row]) -> Iterator[Figure | None]:
    """Yield a figure of the base velocity jump against both forms of eq. (8).

    It goes over slenderness and over the block's size.
    """
    forms = {"jump_8": "(8) corrected", "jump_8_printed": "(8) as printed"}
    defaults = result.settings["default_variants"]
    main_cells = [row for row in cells if defaults[row["engine"]] == row["variant"] and row["jump_8"] is not None]
    sizes = [row for row in where(result.rows, experiment="size") if row["jump_8"] is not None]
    over_slenderness = [
        {"engine": engine, "slenderness": gamma, "error": rms([row[form] for row in rows]), "by": words}
        for form, words in forms.items()
        for (engine, gamma), rows in grouped(main_cells, "engine", "slenderness").items()
    ]
    over_size = [{**row, "error": row[form], "by": words} for form, words in forms.items() for row in sizes]
    trusted = [row for row in sizes if ratings[NAME.of(row)]["rating"] == "may be trusted"]
    errors = [percent(max((row[form] for row in trusted), default=None)) for form in forms]
    jump = Column("jump over eq. (8), less 1, rms [-]", "error")
    size = Column("size of the block R [m]", lambda row: row["value"] * result.settings["radius"])
    yield beside(
        lines(
            over_slenderness,
            GAMMA,
            jump,
            "Base velocity jump against eq. (8), over the slenderness and over the size of the block.",
            series=Series(by="by"),
            log="y",
        ),
        lines(
            over_size,
            size,
            jump,
            f"In the variants that may be trusted, the jump differs by at most {errors[0]} from the corrected form, "
            f"and by up to {errors[1]} from the printed one, which has a factor R cos γ [m] too many. The engines are "
            "not given the equation.",
            series=Series(by="by"),
            log="xy",
        ),
    )


RIGID = "rigid ground"
WINDOW = 20.0  # ms before and after the landing that are drawn
MARKED = 40  # most values of a line that has a mark at each
# {frame: (its title, key of its values, unit of the page over that of the values, label)}
FRAMES = {
    "straddle": ("1. the steps straddle the impact", "landing", 1e3, "height of the corner [mm]"),
    "penetration": ("2. the corner sinks in", "landing", 1e3, "height of the corner [mm]"),
    "rebound": ("3. it is pushed out again", "speed", 1.0, "speed away from the ground [-]"),
    "energy": ("4. energy is lost or gained", "energy", 1.0, "energy over that before [-]"),
}
CONTACT_ERROR = COLUMNS["error"]


def contact(result: Result) -> Page:
    """Return the page of the impact taken apart, which `page` includes as sections that say why engines err."""
    settings, rows = result.settings["why"], where(result.rows, part="why")
    analysed = [row for row in rows if row["failure"] is None and "why_not" not in row]
    ranked = sorted(analysed, key=lambda row: -abs(row["error"]))
    wrong, best = [row for row in ranked if row["cause"]], where(ranked, best=True)
    sound = where(best, cause=None)
    columns = (
        NAME,
        COLUMNS["ground"],
        CONTACT_ERROR,
        Column("cause", lambda row: row["cause"] or f"none (below {settings['least']:g})"),
        COLUMNS["steps"],
        COLUMNS["deepest"],
        COLUMNS["energy_lost"],
        Column("main variant", lambda row: "yes" if row["best"] else "no"),
    )
    causes = listed([f"“{cause}”" for cause in dict.fromkeys(row["cause"] for row in wrong)])
    return Page(
        f"Why engines err: {len(sound)} of {len(best)} impacts of main variants are off by less than "
        f"{settings['least']:g}" + f"; larger errors of any variant are put down to {causes}" * bool(causes),
        (
            "Newton’s laws give the impulses that an engine must have applied between two steps. These impulses split "
            "the error of restitution into parts that add up to it. The parts show the cause without knowledge of the "
            "solver or its settings.",
        ),
        first=(
            _frames([row for row in where(analysed, ground=RIGID) if row["best"] or row["tier"] == "defaults"]),
            table(
                "The first impact in all main variants, and in other variants whose error has a cause",
                [*wrong, *sound],
                *columns,
            ),
        ),
        more=(
            table("The first impact in all other variants", where(ranked, cause=None, best=False), *columns),
            table(
                "Causes",
                [{"cause": cause, "words": words} for cause, words in settings["causes"].items()],
                COLUMNS["cause"],
                COLUMNS["words"],
            ),
        ),
        how=(
            f"A block of slenderness {settings['slenderness']:g} rad is released from {settings['start']:g} of it, on "
            "rigid ground and on the Caryatid’s base, which slides freely. Its first impact is taken apart in every "
            f"variant of every engine, at the default level. Errors of at least {settings['least']:g} get a cause.",
        ),
        evidence=tuple(
            (f"{NAME.of(row)}, {row['ground']}", row.get("why_not") or row["failure"]["reason"])
            for row in rows
            if row["failure"] is not None or "why_not" in row
        ),
    )


def _frames(rows):
    """Figure of the contact in four frames.

    It is not drawn by `lines`: hundreds of values form a curve, and their ends lie outside the frame.
    """
    charts = []
    for name, (title, key, unit, label) in FRAMES.items():
        series = []
        for row in sorted(rows, key=_coloured):
            frame = row["frames"].get(name, {"time": []})
            time = 1e3 * np.array(frame["time"])
            near = np.abs(time) <= 1.5 * WINDOW
            if near.any():
                series.append((row, time[near], unit * np.array(frame[key])[near]))
        if not series:
            continue
        low, high = np.percentile(np.concatenate([values for *_, values in series]), (1, 99))
        room = 0.08 * float(high - low) or 1.0
        chart = Chart(
            Axis("time from the landing [ms]", -WINDOW, WINDOW),
            Axis(label, float(low) - room, float(high) + room),
            f"{title}: {label} in {', '.join(dict.fromkeys(row['engine'] for row, *_ in series))}.",
            title=title,
            height=260,
            left=70,
        )
        for row, time, values in series:
            grey, series_kind, inside = not _coloured(row), kind(row), np.abs(time) <= WINDOW
            chart.line(time, values, series_kind, grey=grey)
            if len(values) <= MARKED:
                says = [f"{NAME.of(row)}: {value:.3g}" for value in values[inside]]
                filled = not as_it_comes(row)
                chart.dots(time[inside], values[inside], series_kind, grey=grey, filled=filled, says=says, beyond=True)
        charts.append(chart)
    caption = (
        f"First impact on rigid ground. Coloured: main variants, and the defaults of {SUBJECTS}. Grey: other defaults. "
        "Open marks: defaults. Arrowheads: values outside the plot. Panels 2 and 3 show only engines in which the "
        "position of the block is read."
    )
    keys = {kind(row): key_of(kind(row), filled=not as_it_comes(row)) for row in rows if _coloured(row)}
    return figure(charts, caption, keys, keys)


def _coloured(row):
    """Return whether the row has a colour: main variants and subject engines do."""
    return row["best"] or subject(row)


BOUNDS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def page(result: Result) -> Page:
    """Return the page of a result."""
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    default = where(result.rows, part="summary", scope="all")
    cells = [
        {**row, "ground": ground(row), "tier": variants[NAME.of(row)]["tier"]}
        for row in where(result.rows, part="cell")
        if row["level"] == variants[NAME.of(row)]["default"]
    ]
    levels = [{**variants[NAME.of(row)], **row} for row in where(result.rows, part="summary", scope="levels")]
    orders = {(NAME.of(row), row["ground"]): row["order"] for row in where(result.rows, part="order")}
    ratings = {NAME.of(row): row for row in rated(result)}
    ranked = sorted(
        (row for row in ratings.values() if not row["applies_impact"]), key=lambda row: row["rms_state"] or 1e9
    )
    why = contact(result)
    return Page(
        _title(ranked),
        (
            "A released block loses speed at every impact. Eq. (7) gives this loss from angular momentum alone. The "
            "engines are not given eq. (7); their loss follows from their contact. It is wrong where a step straddles "
            "the impact, or where the corner penetrates or bounces. No corner slips here; the study of random statues "
            "has impacts with slip.",
            "Restitution is measured in two ways. By states, it is the tilt rate just after an impact over that just "
            "before. By swings, it follows from the energies of the swings before and after the impact, and so "
            "includes what built-in damping dissipates in flight. The error is the difference from eq. (7), as root "
            "mean square (rms) over the impacts. A variant is rated by the worse of the two measures on the worse of "
            "the two grounds.",
        ),
        first=(*_summary(result, cells, ranked), _over_step(levels)),
        more=_details(result, variants, default, cells, levels, orders, ratings, why),
        how=(*_how(result.settings), *why.how),
        evidence=(
            *(
                (
                    f"{row['engine']}, {row['variant']}: {row['reason']} ({row['count']} runs)",
                    f"{row['message']}\n\nfirst seen: {row['tag']}\nlast finite state: {row['last_state']}",
                )
                for row in where(result.rows, part="failure")
            ),
            *why.evidence,
        ),
    )


def _summary(result, cells, ranked):
    """Parts that the report's first page shows too."""
    return (
        _over_slenderness(cells, result.settings["default_variants"]),
        table(
            "Restitution without slip, on the worse of the two grounds. The least error by states comes first",
            ranked,
            NAME,
            Column("rating", lambda row: row["rating"].removeprefix("is ").removeprefix("may be ")),
            STATE,
            WORST_STATE,
            ERROR,
            Column("order of the error by swings in the accuracy parameter, by ground [-]", "orders"),
            FAILED,
            LOST,
        ),
    )


def _details(result, variants, default, cells, levels, orders, ratings, why):
    """Parts that only the study's own page shows."""
    return (
        Head("Slenderness and base mass"),
        *_maps(cells),
        table(
            "All variants at their default level; assisted: the adapter applies eqs (7) and (8) itself",
            ratings.values(),
            NAME,
            COLUMNS["tier"],
            Column("rating", "rating"),
            Column("default level", setting_of),
        ),
        table(
            "Default levels, all slendernesses and bases together",
            [{**row, "order": orders[NAME.of(row), row["ground"]]} for row in default],
            NAME,
            GROUND,
            FAILED,
            LOST,
            MEAN,
            ERROR,
            WORST,
            STATE,
            JUMP,
            COLUMNS["jump_8_printed"].called("against (8) as printed"),
            LATE,
            COLUMNS["order"],
            CPU,
        ),
        *_on_bearings(result),
        Head("Levels"),
        *_refinement(levels),
        Head(why.title, "why"),  # the report's first page links to it
        *why.lead,
        *why.first,
        *why.more,
        Head("Causes, one at a time"),
        *causes(result, variants),
        Head("Eq. (8), corrected and as printed"),
        *equation_8(result, cells, ratings),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge the error of restitution, free and on bearings, and that of the base velocity jump, by (engine, variant).

    Free rocking is rated by the worse of two errors: that by states, and that by swings, which includes what an engine
    loses in flight.
    """
    rows, borne = rated(result), where(result.rows, part="bearings", factor="all")
    return (
        Judgement(
            "rms error of restitution by states (tilt rate after an impact over that before), in free rocking without "
            "slip, on rigid ground or a sliding base, whichever is worse",
            {(row["engine"], row["variant"]): _free_mark(row) for row in rows},
            RESTITUTION,
        ),
        Judgement(
            "rms error of restitution by states, on bearings without slip",
            {(row["engine"], row["variant"]): _mark(row, "rms_state", "worst_state") for row in borne},
        ),
        Judgement(
            "relative rms error of the base velocity jump, on bearings",
            {(row["engine"], row["variant"]): _mark(row, "jump_rms", "jump_worst") for row in borne},
        ),
    )


def _free_mark(row):
    """Mark of free rocking: it shows the error by states; the worse of both measures gives the rating."""
    mark = _mark(row, "rms_state", "worst_state")
    return replace(
        mark, level=rating(_worse_error(row), _failures(row)), note=f"{mark.note}; by swings {number(row['rms'], 2)}"
    )


def _worse_error(row):
    """Return the worse of both measures of free rocking; None where one of them is not known."""
    return None if None in (row["rms"], row["rms_state"]) else max(row["rms"], row["rms_state"])


def _failures(row):
    """Number of failed runs and missed impacts."""
    return row["failed"] + row["lost"]


def _mark(row, error, worst):
    """Mark of an error.

    A missed impact counts as an error: it takes the rating away, as a failed run does.
    """
    if row[error] is None:
        return Mark("none measured", "bad", f"{row['failed']} of {row['runs']} runs failed")
    wrong = {"failed": row["failed"], "missed": row["lost"]}
    words = with_counts(number(row[error], 2), wrong)
    level = rating(row[error], _failures(row))
    note = f"{row['impacts']} impacts of {row['runs']} runs, worst {number(row[worst], 2)}"
    return Mark(words, level, note, row[error])


def rated(result: Result) -> list[dict[str, Any]]:
    """Return a row for each variant at its default level, with the worse of both grounds.

    The first screen rates variants by it. It has the variant's settings, rms, worst, rms_state, worst_state, jump_rms,
    jump_worst, impacts, lost, failed, runs, orders and, in words, rating.
    """
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    orders = grouped(where(result.rows, part="order"), NAME.of)
    return [
        _worse_of_grounds(variants[name], rows, orders[name,])
        for (name,), rows in grouped(where(result.rows, part="summary", scope="all"), NAME.of).items()
    ]


def _worse_of_grounds(variant, rows, orders):
    def most(key):
        return max((row[key] for row in rows if row[key] is not None), default=None)

    errors = {key: most(key) for key in ("rms", "worst", "rms_state", "worst_state", "jump_rms", "jump_worst")}
    counts = {key: sum(row[key] for row in rows) for key in ("runs", "failed", "impacts", "lost")}
    summary = {**errors, **counts}
    return {
        **variant,
        "level": variant["default"],
        **summary,
        "orders": [row["order"] for row in orders if row["order"] is not None],
        "rating": trust(_worse_error(summary), _failures(summary)).removesuffix(" where a per cent does not matter"),
    }


def _title(ranked):
    good = [row for row in ranked if rating(_worse_error(row), _failures(row)) == "good"]
    answer = f"{len(good)} of {len(ranked)} engine variants reproduce restitution without slip to within {TRUSTED:g}"
    return f"One impact: {answer}"


def _over_slenderness(cells, defaults):
    def grey(row):
        return defaults[row["engine"]] != row["variant"] and not (subject(row) and as_it_comes(row))

    worst = [
        max(rows, key=lambda row: row["rms_state"])
        for rows in grouped(
            [row for row in cells if row["rms_state"]], "ground", "engine", "variant", "slenderness"
        ).values()
    ]
    return lines(
        worst,
        GAMMA,
        STATE,
        "Rms error of restitution by states; on the sliding base, that of the worst base mass. Coloured: main "
        f"variants, and the defaults of {SUBJECTS}. Open marks: defaults. Grey: other variants. No mark: all runs "
        "failed.",
        panel=lambda row: f"{row['ground']}: restitution",
        series=Series(by=lambda row: row["variant"] if grey(row) else row["tier"], grey=grey, opened=as_it_comes),
        log="y",
        rules=[("y", TRUSTED, "trusted")],
    )


def _maps(cells):
    for error, rows in ((ERROR, cells), (JUMP, [row for row in cells if row["ratio"] is not None])):
        yield shades(
            rows,
            BASE,
            GAMMA,
            Column(error.head, error.value, digits=1),
            f"{error.head.capitalize()}, at default levels, over all starts and impacts. ✗: how many of the runs "
            "failed; these are not part of the error.",
            bounds=BOUNDS,
            panel=NAME.of,
            failed=lambda row: FAILED.of(row).replace(" of ", "/") if row["failed"] else "",
        )


def _on_bearings(result):
    rows, defaults = where(result.rows, part="bearings"), result.settings["default_variants"]
    if not rows:
        return
    columns = [FAILED, LOST, STATE, WORST_STATE, JUMP, WORST_JUMP, LATE, CPU]
    axes = {"slenderness": GAMMA, "ratio": BASE_RATIO, "period": PERIOD}
    yield Head("On bearings")
    yield table("On bearings, at default levels, all scenes together", where(rows, factor="all"), NAME, *columns)
    yield beside(
        *(
            lines(
                [{**row, factor: row["of"]} for row in where(rows, factor=factor) if row["rms_state"]],
                axis,
                STATE,
                f"On bearings: error of restitution over {axis.head.partition(' [')[0]}, all other values together.",
                series=Series(grey=lambda row: defaults[row["engine"]] != row["variant"]),
                log="y" if factor == "slenderness" else "xy",
                rules=[("y", TRUSTED, "trusted")],
            )
            for factor, axis in axes.items()
        )
    )
    yield table(
        "On bearings, by law and by what moves the block",
        where(rows, factor={"law", "excitation"}),
        NAME,
        Column("law or excitation", lambda row: "released" if row["of"] == "let go" else row["of"]),
        *columns,
    )


def _over_step(levels):
    """Error over a fixed step, of all variants that take one."""
    return lines(
        where(levels, parameter="step"),
        COLUMNS["level"].called("fixed step [s]"),
        DRAWN_ERROR,
        "Error of restitution by swings over the size of a fixed step, for tuned variants and defaults. Variants that "
        "refine their step at impacts are not shown.",
        panel="ground",
        log="xy",
        rules=[("x", step, words) for words, step in STEPS.items()],
    )


def _refinement(levels):
    over_default = Column("accuracy parameter over its default [-]", lambda row: row["level"] / row["default"])
    words = (
        "Error of restitution by swings over each variant's accuracy parameter. A larger stiffness is finer, and so is "
        "a smaller step."
    )
    yield beside(
        lines(levels, over_default, DRAWN_ERROR, words, panel="ground", log="xy"),
        lines(levels, CPU, DRAWN_ERROR, "The same errors over the CPU time of their runs.", panel="ground", log="xy"),
    )
    yield table(
        "All levels",
        levels,
        NAME,
        GROUND,
        Column("setting", setting_of),
        ERROR,
        JUMP,
        CPU,
        COLUMNS["steps_per_second"],
        FAILED,
    )


def _how(settings):
    gammas, starts = settings["slendernesses"], settings["starts"]
    bases = ", ".join(number(ratio, 2) for ratio in settings["ratios"] if ratio is not None)
    grid = "; ".join(f"{name} {', '.join(map(short, values))}" for name, values in settings["bearings"].items())
    return (
        f"Blocks of slenderness {min(gammas):g} to {max(gammas):g} rad are tilted to {min(starts):g} to "
        f"{max(starts):g} of it ({len(starts)} starts) and released. They stand on rigid ground, or on bases that "
        f"slide without friction, of {bases} times their mass. The first {settings['impacts']} impacts of every run "
        "are measured. Restitution by swings is the square root of the energy of the swing after an impact over that "
        "of the swing before it, so anything that dissipates energy counts. The base velocity jump is compared with "
        "the jump that conserves momentum at the run's own rates.",
        f"On bearings, all combinations of these values are run: {grid}. Ratios are those of base mass to block mass; "
        "the bearing laws alternate. The block is released from half of its slenderness. The ground is at rest, or "
        "moves by one sine of half the uplift acceleration and three times the rocking frequency. The bearings change "
        "the energy of a swing, so restitution is measured by states alone, against eq. (7). The base velocity jump is "
        "compared with momentum, eq. (8). An impact of the model that a run lacks counts as missed.",
        f"Trusted: an error of at most {TRUSTED:g} on both grounds by both measures, no failed run and no missed "
        f"impact. Usable: the same with at most {USABLE:g}. For comparison, the measured restitution of stone scatters "
        "by some per cent. Corners that are plastic, do not slip, and move in a plane are Housner's assumptions. "
        "Agreement under them verifies the engine; it is no independent evidence on the physics.",
    )
