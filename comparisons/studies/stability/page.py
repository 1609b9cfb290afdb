"""The page of the stability study: hard cases and the solvers that get them right."""

import re
from itertools import product

from engines import ENGINES
from engines.simulating import in_words

from ...execution.results import Result
from ...plotting.charts import REFERENCE, Axis, Chart, broad, figure, room
from ...plotting.figures import as_it_comes, kind, subject
from ...plotting.parts import Head, Judgement, Mark, Page, grouped, table, where
from ...schemas.columns import NAME as ENGINE
from ...schemas.columns import Column, short
from .cases import FREE, SLIDING
from .study import COLUMNS, DEFAULT, DIFFERS, FAILED, FINER, RIGHT, may_slide, worst

WRONG = "wrong"  # a run with another outcome: it never has the colour of a small error
# {result: (sign in a cell, its class in the style sheet)}
SIGNS = {
    RIGHT: ("✓", RIGHT),
    DIFFERS: ("~", "degraded"),
    WRONG: ("≠", WRONG),
    FAILED: ("✗", FAILED),
    "": ("–", "shade"),
}
NOT_TRIED, NONE_FOUND = "not tried", "none found"  # of finer levels
NOT_RUN = {"result": "not run", "sign": "", "measure": "–", "value": None, "tolerance": None, "remedy": NOT_TRIED}
NOT_MODELLED = {**NOT_RUN, "result": "not modelled"}  # a case with friction, by a solver that knows none
APART = "outside the range"
MOST, SOME = 0.85, 0.6  # shares of cases from which a solver may be trusted, and is usable with care
NOTED = 2  # cases named in the note of the first table
SLANT, UPRIGHT = 4.1, 6.9  # height of a letter of the slanted and of the upright names below a matrix
STRIP = 1180  # width of the matrix over a whole page
TWIN = "second implementation"
SHORT = {TWIN: "2nd code", "time-stepping": "steps"}


def _readable(words):
    """Return words with powers of ten and minus signs as a reader writes them."""
    powers = re.sub(r"\d[.\d]*e[-+]?\d+", lambda match: short(float(match[0])).removeprefix("1·"), words)
    return powers.replace(" -", " −").replace("m/s2", "m/s²")


NAME = Column("solver, variant", lambda row: TWIN if row["engine"] == "twin" else ENGINE.of(row))
CASE = Column("case", lambda row: _readable(row["case"]))
TOLERANCE = Column("tolerance", "tolerance", digits=None)


def page(result: Result) -> Page:
    """Return the page of a result."""
    cases, measures = result.settings["cases"], result.settings["measures"]
    cells, variants = _cells(result), _judged_variants(result)
    inside, outside = _by_range(cases)
    chosen = [variant for variant in variants if variant["best"] or subject(variant) and as_it_comes(variant)]
    counts = sorted(_counts(result, cells), key=lambda row: -row[RIGHT])
    wrong = where(cells.values(), result={DIFFERS, FAILED})
    return Page(
        _title(cells, inside, outside, [row for row in variants if row["best"] and row["engine"] in ENGINES]),
        (
            "Real integrators have failed on these scenes. A result is right if every measure is within its tolerance; "
            "otherwise it differs. It fails if the solver gives up, exceeds its time limit or moves the block in a "
            "physically impossible way.",
            _reference(result),
            _best_solvers(where(counts, kind="stepping")),
            *(
                [
                    f"{len(outside)} of the {len(cases)} cases lie outside the range for which engines are tested. "
                    "They are counted separately."
                ]
                if outside
                else []
            ),
        ),
        first=_summary(cells, inside, outside, chosen, counts),
        more=_details(result, cases, measures, cells, variants, outside, chosen, wrong),
        how=(
            "The reference itself is judged by its independent second implementation and, for free rocking, by the "
            "closed form. With friction it is judged by Moreau’s time stepping, which shares no code with it. "
            "Trajectories are compared up to each scene’s sensitivity horizon and unstable point. Beyond these only "
            "the outcome is compared, and only if a change of 10⁻⁴ does not alter it. Energy drift and energy gain are "
            "counted only as far as they exceed those of the reference.",
            "Where a result is not right, finer levels are run in turn. Scenes of ten minutes are run by the engines’ "
            f"main variants only. The time limit of a run is {result.settings['time_limit']:g} s.",
            f"The range for which engines are tested: {in_words()}.",
        ),
        evidence=tuple(
            (
                f"{name}: {reason} ({'; '.join(map(CASE.of, rows))})",
                "\n".join(f"{key}: {value}" for key, value in rows[0]["failure"].items())
                + f"\nlast state: {rows[0]['last_state']}\nsettings: {rows[0]['settings'] or rows[0]['set']}",
            )
            for (name, reason), rows in grouped(where(wrong, result=FAILED), NAME.of, "measure").items()
        ),
    )


def _summary(cells, inside, outside, chosen, counts):
    """Parts that the report's first page shows too."""
    return (
        _strip(
            cells,
            inside,
            chosen,
            "Results at default levels. Blank or ✓: right; ~: differs; ≠: another outcome; ✗: failed; –: not run, or "
            "not modelled. The pointer shows the measure farthest outside its tolerance. 2nd code: the independent "
            "second implementation. Steps: plain time stepping of the equations. Neither of these models friction.",
        ),
        table(
            "Results at default levels",
            counts,
            NAME,
            *(Column(f"{name} [-]", name) for name in (RIGHT, DIFFERS, FAILED)),
            Column("right at finer levels [-]", FINER),
            *([Column(f"right {APART}", APART)] if outside else []),
        ),
    )


def _details(result, cases, measures, cells, variants, outside, chosen, wrong):
    """Parts that only the study's own page shows."""
    return (
        _matrix(cells, outside, chosen, "Cases outside the tested range, which are counted separately."),
        _matrix(
            cells,
            cases,
            [variant for variant in variants if variant not in chosen],
            "The engines’ other variants in all cases. –: not run, or friction not modelled.",
        ),
        table(
            "Where default levels are not right",
            wrong,
            CASE,
            NAME,
            COLUMNS["result"],
            Column("measure farthest outside", "measure"),
            Column("value", "value", digits=None),
            TOLERANCE,
            Column("also outside", "others"),
            Column("finer level that is right", "remedy"),
        ),
        Head("Measures and cases"),
        table(
            "Measures",
            [
                {"kind": kind, "name": name, "unit": unit or "-", "what": what, "tolerance": limit, "reason": reason}
                for kind, limits in result.settings["tolerances"].items()
                for name, (limit, reason) in limits.items()
                for unit, what in (measures[name],)
            ],
            Column("measure", "name"),
            Column("solvers", "kind"),
            Column("what it is", "what"),
            TOLERANCE,
            Column("unit", "unit"),
            Column("reason", lambda row: _readable(row["reason"])),
        ),
        table(
            "Cases",
            [{**case, "case": name} for name, case in cases.items()],
            CASE,
            Column("what is hard", lambda row: _readable(row["title"])),
            Column("judged by, and its own tolerances", _judged_by),
            Column(APART, lambda case: ", ".join(f"{name} {short(v)}" for name, v in _outside(case).items()) or "–"),
            Column("duration [s]", "duration", digits=None),
        ),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge how many hard cases are right, by (engine, variant)."""
    marks, cells = {}, _cells(result)
    for row in _counts(result, cells):
        if not row["run"]:
            continue
        level = "good" if row[RIGHT] >= MOST * row["run"] else "fair" if row[RIGHT] >= SOME * row["run"] else "bad"
        failed = [
            case
            for (case, name), cell in cells.items()
            if name == NAME.of(row) and cell["result"] == FAILED and not _outside(result.settings["cases"][case])
        ]
        more = f" and {len(failed) - NOTED} more" if len(failed) > NOTED else ""
        note = f"failed: {', '.join(map(_readable, failed[:NOTED]))}{more}" if failed else "none failed"
        beyond = f" ({row[APART]} {APART})" if row[APART] else ""
        marks[row["engine"], row["variant"]] = Mark(
            f"{row[RIGHT]} of {row['run']}{beyond}", level, note, row[RIGHT] / row["run"]
        )
    return (Judgement("hard cases right", marks),)


def _judged_variants(result):
    """Return the variants that have a row: all but the reference, which judges them."""
    return [variant for variant in result.settings["variants"] if variant["engine"] != REFERENCE]


def _reference(result):
    """Sentences on the reference: it judges the others, and is judged itself."""
    model_rows = where(result.rows, part=DEFAULT, engine=REFERENCE)
    right = len(where(model_rows, result=RIGHT))
    return (
        "The reference is the analytic model. It judges all others, so it has no row of its own. Its own judges (see "
        f"the method) find it right in {right} of {len(model_rows)} cases."
    )


def _cells(result):
    """Return {(case, name): row at the default level, its measure farthest outside, and the result of finer levels}.

    Finer levels are run in turn until one is right: the last one counts.

    These are run in turn until one is right: the last one counts.
    """
    cells = {
        (name, NAME.of(variant)): NOT_MODELLED
        if case["oracle"] == SLIDING and not may_slide(variant["engine"], variant["applies_impact"])
        else NOT_RUN
        for name, case in result.settings["cases"].items()
        for variant in _judged_variants(result)
    }
    finer = {(row["case"], NAME.of(row)): row for row in where(result.rows, part=FINER)}
    for row in where(result.rows, part=DEFAULT):
        if row["engine"] == REFERENCE:
            continue
        key = row["case"], NAME.of(row)
        cells[key] = {**row, **_farthest(row, result.settings["measures"]), "remedy": _remedy(row, finer.get(key))}
    return cells


def _farthest(row, measures):
    if row["result"] == FAILED:
        kind, reason = row["failure"]["kind"], row["failure"]["reason"]
        measure = kind if kind == "time limit" else reason
        return {"sign": FAILED, "measure": measure, "value": None, "tolerance": None, "others": []}
    name, value, limit = worst(row)
    wrong = name == "outcome" and row["result"] == DIFFERS
    return {
        "sign": WRONG if wrong else row["result"],
        "measure": f"outcome: {row['outcome']}" if wrong else f"{name} [{measures[name][0] or '-'}]",
        "value": value,
        "tolerance": limit,
        "others": [other for other in row["outside"] if other != name],
    }


def _remedy(row, finer):
    if finer is None or finer["result"] != RIGHT:
        return NOT_TRIED if finer is None else NONE_FOUND
    unit = {"stiffness": " N/m", "tolerance": ""}
    changed = [(key, value) for key, value in finer["set"].items() if row["set"].get(key) != value]
    return ", ".join(f"{key.replace('_', ' ')} = {short(value)}{unit.get(key, ' s')}" for key, value in changed)


def _counts(result, cells):
    """Yield each variant with counts of its results.

    Within the range: numbers of results by kind, of runs, and of results rerun at finer levels and then right. Outside
    the range: its right results, in words.
    """
    _, outside = _by_range(result.settings["cases"])
    for variant in _judged_variants(result):
        ran = {case: cell for (case, name), cell in cells.items() if name == NAME.of(variant) and "engine" in cell}
        beyond = [cell for case, cell in ran.items() if case in outside]
        rows = [cell for case, cell in ran.items() if case not in outside]
        counts = {kind: len(where(rows, result=kind)) for kind in (RIGHT, DIFFERS, FAILED)}
        tried = [row for row in rows if row["remedy"] != NOT_TRIED]
        cured = len(tried) - len(where(tried, remedy=NONE_FOUND))
        right = f"{len(where(beyond, result=RIGHT))} of {len(beyond)}" if beyond else ""
        yield {**variant, **counts, "run": len(rows), "tried": len(tried), FINER: cured, APART: right}


def _outside(case):
    """Return {quantity outside the range for which engines are tested: its value} of a case.

    Older results do not store it; for them it is empty.
    """
    return case.get("outside", {})


def _by_range(cases):
    """Return the cases inside the range for which engines are tested, and those outside."""
    outside = {name: case for name, case in cases.items() if _outside(case)}
    return {name: case for name, case in cases.items() if name not in outside}, outside


def _title(cells, inside, outside, engines):
    names = [NAME.of(engine) for engine in engines]
    none, beyond = (
        [case for case in cases if not any(cells[case, name]["result"] == RIGHT for name in names)]
        for cases in (inside, outside)
    )
    listed = _readable(f" ({'; '.join(none[:3])}{' …' if len(none) > 3 else ''})") if none else ""
    more = f", and {len(beyond)} of {len(outside)} outside the tested range" if outside else ""
    who = "every engine" if len(names) > 2 else " and ".join(names)
    return f"Hard cases: {len(none)} of {len(inside)} defeat {who}{listed}{more}"


def _best_solvers(counts):
    """Sentences on the solvers with most right cases, and on the effect of finer levels."""
    most = max((row[RIGHT] for row in counts), default=0)
    names = " and ".join(NAME.of(row) for row in counts if row[RIGHT] == most)
    run, right, tried, cured = (sum(row[key] for row in counts) for key in ("run", RIGHT, "tried", FINER))
    return (
        f"Best is {names}, with {most} cases right. Of the {run - right} wrong results of all time-stepping solvers, "
        f"{tried} were rerun at finer levels; {cured} then became right."
    )


def _matrix(cells, cases, variants, caption):
    """Figure with a line for each case and a column for each variant, in two halves; None without variants or cases."""
    charts = _halves(cells, cases, variants)
    return figure(charts, caption) if charts else None


def _strip(cells, cases, variants, caption):
    """Figure with a column for each case and a line for each variant; on a phone as `_matrix`."""
    halves, names = _halves(cells, cases, variants), {NAME.of(variant): _label(variant) for variant in variants}
    if not halves:
        return None
    foot = 14 + round(UPRIGHT * max(len(_readable(case)) for case in cases))
    chart = Chart(
        Axis("", -0.5, len(cases) - 0.5, ticks=tuple(enumerate(map(_readable, cases)))),
        Axis("", len(names) - 0.5, -0.5, ticks=tuple(enumerate(names.values()))),
        " ".join(half.says for half in halves),
        left=room(names.values()),
        right=4,
        foot=foot,
        height=16 + foot + 22 * len(names),
        width=STRIP,
        turned=True,
    )
    for (i, case), (j, name) in product(enumerate(cases), enumerate(names)):
        sign, kind, says = _drawn_cell(cells[case, name], case, name)
        chart.cell(i, j, kind, "" if sign == SIGNS[RIGHT][0] else sign, says)
    return broad(chart, halves, caption)


def _halves(cells, cases, variants):
    """Charts of the two halves of `_matrix`."""
    names = {NAME.of(variant): _label(variant) for variant in variants}
    if not names or not cases:
        return []
    middle, foot, charts = (len(cases) + 1) // 2, 22 + round(SLANT * max(map(len, names.values()))), []
    for half in (list(cases)[:middle], list(cases)[middle:]):
        right = {name: [cells[case, name]["result"] for case in half].count(RIGHT) for name in names}
        chart = Chart(
            Axis("", -0.5, len(names) - 0.5, ticks=tuple(enumerate(names.values()))),
            Axis("", len(half) - 0.5, -0.5, ticks=tuple(enumerate(map(_readable, half)))),
            f"Right of {len(half)} cases: {', '.join(f'{name} {count}' for name, count in right.items())}.",
            left=room(map(_readable, half), 168),
            right=4,
            foot=foot,
            height=16 + foot + 19 * len(half),
        )
        for (j, case), (i, name) in product(enumerate(half), enumerate(names)):
            sign, kind, says = _drawn_cell(cells[case, name], case, name)
            chart.cell(i, j, kind, sign, says)
        charts.append(chart)
    return charts


def _drawn_cell(cell, case, name):
    """Return (sign, style class, tooltip) of a cell."""
    sign, kind = SIGNS[cell["sign"]]
    worst = f"{cell['measure']} {short(cell['value'])}, tolerance {short(cell['tolerance'])}"
    return sign, kind, f"{_readable(case)}, {name}: {cell['result']}; {worst}; finer levels: {cell['remedy']}"


def _label(variant):
    """Label below a column; in the first figure it is the variant's kind alone."""
    name = NAME.of(variant)
    if variant["best"] or subject(variant) and as_it_comes(variant):
        return SHORT.get(name, kind(variant).removesuffix(", "))
    return name


def _judged_by(case):
    """Words on what judges a case, and its own tolerances."""
    until = case["twin_until"]
    judges = {FREE: "closed form", SLIDING: "Moreau’s time stepping"}
    words = f"reference, itself by {judges.get(case['oracle'], f'the {TWIN}')}"
    words += "" if until is None else f" (this one up to {until:g} s; beyond, the energy ledger)"
    special = [
        f"{name} {short(limit)} for {kind} solvers: {reason}"
        for kind, limits in case["tolerances"].items()
        for name, (limit, reason) in limits.items()
    ]
    return _readable("; ".join([words, *special]))
