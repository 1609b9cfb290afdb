"""What is shown of the restitution study."""

from dataclasses import replace
from typing import Any

from ...running.provenance import Result
from ...showing.figures import as_it_comes, beside, lines, shades, subject
from ...showing.parts import (
    NAME,
    RESTITUTION,
    Column,
    Head,
    Judgement,
    Mark,
    Page,
    grouped,
    number,
    setting_of,
    short,
    table,
    where,
)
from ...showing.wording import TRUSTED, USABLE, rating, trust, with_counts
from .causes import causes, equation_8
from .columns import (
    BASE,
    BASE_RATIO,
    CPU,
    DRAWN_ERROR,
    ERROR,
    FAILED,
    GAMMA,
    GROUND,
    JUMP,
    LATE,
    LOST,
    MEAN,
    PERIOD,
    STATE,
    WORST,
    WORST_JUMP,
    WORST_STATE,
    ground,
)
from .contact import contact

BOUNDS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def page(result: Result) -> Page:
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
            "A released block loses speed at every impact. Eq. (7) gives the loss from angular momentum alone. The "
            "engines are not given this number; it follows from their contact. It is wrong where a step straddles the "
            "impact, or where the corner penetrates or bounces. No corner slips here; for impacts with slip see the "
            "study of sliding.",
            "The error is measured by states: the tilt rate after over that before, at the impact, minus eq. (7), as "
            "root mean square over impacts. By swings, from the energy of the swings before and after, it includes "
            "what built-in damping dissipates in flight. Of both measures and grounds the worse one rates a variant.",
        ),
        first=(
            _over_slenderness(cells, result.settings["default_variants"]),
            table(
                "Restitution without slip, of both grounds the worse, least error by states first",
                ranked,
                NAME,
                Column("rating", lambda row: row["rating"].removeprefix("is ").removeprefix("may be ")),
                STATE,
                WORST_STATE,
                ERROR,
                Column("order by swings in its accuracy parameter, by ground [-]", "orders"),
                FAILED,
                LOST,
            ),
        ),
        more=(
            Head("Slenderness and base mass"),
            *_maps(cells),
            table(
                "All variants at their default level; assisted: the adapter applies eqs (7) and (8) itself",
                ratings.values(),
                NAME,
                Column("kind", "tier"),
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
                Column("against (8) as printed [-]", "jump_8_printed"),
                LATE,
                Column("order by swings [-]", "order"),
                CPU,
            ),
            *_on_bearings(result),
            Head("Levels"),
            *_refinement(levels),
            Head(why.title, "why"),  # the report's first page leads to it
            *why.lead,
            *why.first,
            *why.more,
            Head("Causes, one at a time"),
            *causes(result, variants),
            Head("Eq. (8), corrected and as printed"),
            *equation_8(result, cells, ratings),
        ),
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


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Error of restitution at the impact, free and on bearings, and of the base velocity jump, by (engine, variant).

    Free rocking is rated by the worse of that and the error by swings, which has what an engine loses in flight.
    """
    rows, borne = rated(result), where(result.rows, part="bearings", factor="all")
    return (
        Judgement(
            "error of restitution by states (tilt rates before and after impacts without slip), rms, free rocking, the "
            "worse of two grounds",
            {(row["engine"], row["variant"]): _free_mark(row) for row in rows},
            RESTITUTION,
        ),
        Judgement(
            "restitution by states, on bearings without slip: error, rms",
            {(row["engine"], row["variant"]): _mark(row, "rms_state", "worst_state") for row in borne},
        ),
        Judgement(
            "base velocity jump on bearings: relative error, rms",
            {(row["engine"], row["variant"]): _mark(row, "jump_rms", "jump_worst") for row in borne},
        ),
    )


def _free_mark(row):
    mark = _mark(row, "rms_state", "worst_state")
    return replace(mark, level=rating(_error(row), _wrong(row)), note=f"{mark.note}; by swings {number(row['rms'], 2)}")


def _error(row):
    """The worse of both measures of free rocking; None where one of them is not known."""
    return None if None in (row["rms"], row["rms_state"]) else max(row["rms"], row["rms_state"])


def _wrong(row):
    return row["failed"] + row["lost"]


def _mark(row, error, worst):
    """A missed impact is an error: it takes the rating away as a failed run does."""
    if row[error] is None:
        return Mark("none measured", "bad", f"{row['failed']} of {row['runs']} runs failed")
    wrong = {"failed": row["failed"], "missed": row["lost"]}
    words = with_counts(number(row[error], 2), wrong)
    level = rating(row[error], _wrong(row))
    note = f"{row['impacts']} impacts of {row['runs']} runs, worst {number(row[worst], 2)}"
    return Mark(words, level, note, row[error])


def rated(result: Result) -> list[dict[str, Any]]:
    """A row for each variant at its default level, with the worse of both grounds, by which the first screen rates it.

    Settings, rms, worst, rms_state, worst_state, jump_rms, jump_worst, impacts, lost, failed, runs, orders and, in
    words, rating.
    """
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    orders = grouped(where(result.rows, part="order"), NAME.of)
    return [
        _rated(variants[name], rows, orders[name,])
        for (name,), rows in grouped(where(result.rows, part="summary", scope="all"), NAME.of).items()
    ]


def _rated(variant, rows, orders):
    def most(key):
        return max((row[key] for row in rows if row[key] is not None), default=None)

    errors = {key: most(key) for key in ("rms", "worst", "rms_state", "worst_state", "jump_rms", "jump_worst")}
    counts = {key: sum(row[key] for row in rows) for key in ("runs", "failed", "impacts", "lost")}
    found = {**errors, **counts}
    return {
        **variant,
        "level": variant["default"],
        **found,
        "orders": [row["order"] for row in orders if row["order"] is not None],
        "rating": trust(_error(found), _wrong(found)).removesuffix(" where a per cent does not matter"),
    }


def _title(ranked):
    good = [row for row in ranked if rating(_error(row), _wrong(row)) == "good"]
    found = f"{len(good)} of {len(ranked)} engine variants reproduce restitution without slip to within {TRUSTED:g}"
    return f"One impact: {found}"


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
        "Error of restitution by states, rms; on the base, for the worst base mass. Coloured: main variants, and "
        "defaults of the engines in question. Open marks: defaults. Grey: other variants. No mark: all runs failed.",
        panel=lambda row: f"{row['ground']}: restitution",
        by=lambda row: row["variant"] if grey(row) else row["tier"],
        grey=grey,
        opened=as_it_comes,
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
            f"{error.head.capitalize()}, at default levels, over all starts and impacts. ✗: runs that failed, of "
            "those made; they are not part of the error.",
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
                f"On bearings: error of restitution over {axis.head.partition(' [')[0]}, the other values together.",
                grey=lambda row: defaults[row["engine"]] != row["variant"],
                log="y" if factor == "slenderness" else "xy",
                rules=[("y", TRUSTED, "trusted")],
            )
            for factor, axis in axes.items()
        )
    )
    yield table(
        "On bearings, apart by law and by what moves the block",
        where(rows, factor={"law", "excitation"}),
        NAME,
        Column("law or excitation", lambda row: "released" if row["of"] == "let go" else row["of"]),
        *columns,
    )


def _refinement(levels):
    over_default = Column("accuracy parameter over its default [-]", lambda row: row["level"] / row["default"])
    words = (
        "Error of restitution by swings along each variant's accuracy parameter; a stiffness refines upward, a step "
        "downward."
    )
    yield beside(
        lines(levels, over_default, DRAWN_ERROR, words, panel="ground", log="xy"),
        lines(levels, CPU, DRAWN_ERROR, "And against the CPU time of the same runs.", panel="ground", log="xy"),
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
        Column("steps per simulated second [1/s]", "steps_per_second", digits=3),
        FAILED,
    )


def _how(settings):
    gammas, starts = settings["slendernesses"], settings["starts"]
    bases = ", ".join(number(ratio, 2) for ratio in settings["ratios"] if ratio is not None)
    grid = "; ".join(f"{name} {', '.join(map(short, values))}" for name, values in settings["bearings"].items())
    return (
        f"Blocks of slenderness {min(gammas):g} to {max(gammas):g} rad, tilted to {min(starts):g} to {max(starts):g} "
        f"of it ({len(starts)} starts) and released, on rigid ground and on bases of {bases} times their mass that "
        f"slide without friction; the first {settings['impacts']} impacts of every run. Restitution by swings is the "
        "root of the ratio of a swing's energy after an impact to that before it, so that whatever takes energy "
        "counts; the base velocity jump is compared with momentum by the run's own rates.",
        f"On bearings: {grid}, each with each, the laws in turn; released at half of the slenderness, the ground at "
        "rest or under one sine of half the uplift acceleration and three times the rocking frequency. Under these "
        "forces the energy of a swing is not conserved: restitution is measured by states alone, "
        "against eq. (7), and the base velocity jump is compared with momentum, eq. (8). An impact that a "
        "run does not have counts as missed.",
        f"Trusted: error of both grounds and by both measures at most {TRUSTED:g}, no failed run, no missed impact; "
        f"usable: at most {USABLE:g}. Measured restitution of stone scatters by some per cent. The corners are set "
        "plastic, non-slipping and planar, which are Housner's assumptions: agreement is verification of the engine, "
        "not independent physics.",
    )
