"""What is shown of random statues with friction: what sliding changes, and how engines slide."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from analytic.response import COMPARED
from engines.comparison import END, PEAK
from engines.comparison import RESTITUTION as RESTITUTION_LIMIT

from ...measuring.errors import rms
from ...measuring.statistics import wilson
from ...running.provenance import Result
from ...showing.charts import Axis, Chart, curve, figure, key_of
from ...showing.figures import as_it_comes, leading, lines, ranks
from ...showing.glance import Glance, counted
from ...showing.parts import (
    NAME,
    Column,
    Figure,
    Judgement,
    Mark,
    Page,
    grouped,
    number,
    percent,
    power_of_ten,
    table,
    typeset,
    where,
)
from ...showing.wording import INSTEAD, NOT_COMPARED, TRUSTED, TURNED, ends, left_out, listed, tally

LEAST_RIGHT = 0.95  # share of right runs, of those not left out, from which an engine is good
LEAST_ERROR = 1e-6  # of a slip, at which the figure's axis begins
ALL, FALLS = "all", "overturns"
# share: (in words, of which scenes it is one, those scenes in words)
SHARES = {
    "slides": ("slides and never lifts", "moves", "that lift or slide"),
    "saved": ("saved by sliding", "falls_without", "that overturn without sliding"),
    "overturned": ("overturned by sliding", "upright_without", "that stay upright without sliding"),
}
RESTITUTION = "error of restitution by states, rms [-]"
WRONG = Column("runs that differ or fail", "wrong", percent=True, within="wrong_within")
SLIP = Column("error of the largest slip [-]", "error")


def page(result: Result) -> Page:
    cells, runs = where(result.rows, part="cell"), judged(result)
    every, counts = summed(cells, lambda cell: ALL), tallies(result)
    failed = where(runs, **{"class": "failed"})
    differing = [row for row in where(runs, **{"class": "differs"}) if row["tier"] != "defaults"]
    return Page(
        _title(every[0]),
        (
            "The model runs each scene with its friction, and again as if no corner could slide. The difference is the "
            "effect of sliding. Engines run only scenes in which the friction does not suffice.",
            *_reconciled(leading(counts, result.settings["variants"])),
        ),
        first=(
            _shares(cells),
            table(
                "The analytic model: random statues with a friction of 0.2 to 0.8 at rest under a motion; with 95 % "
                "Wilson intervals",
                [*summed(cells, "support"), *every],
                *_outcomes("support"),
            ),
            _engines(counts),
        ),
        more=(
            ranks(
                counts,
                NAME,
                WRONG,
                "Engines where the friction does not suffice: share of runs that differ or fail, with 95 % Wilson "
                "intervals; open marks: defaults.",
                Axis(WRONG.head, 0.0, 1.0, ticks=tuple((k / 4, f"{25 * k} %") for k in range(5))),
                opened=as_it_comes,
            ),
            table("By the kind of motion", summed(cells, "motion"), *_outcomes("motion")),
            table("By friction", summed(cells, _interval), *_outcomes(_interval)),
            _slips(runs),
            _restitutions(counts),
            _impacts(counts),
            _differences(differing),
            _failures(failed),
            *(f"{NAME.of(row)}: {row['words']}" for row in result.settings["faults"]),
        ),
        how=_how(result),
        evidence=tuple(
            (f"{NAME.text(row)}, scene {row['index']}: {_why(row)}", row["failure"]["message"] or "") for row in failed
        ),
    )


def _reconciled(rows):
    """What is counted as right, as an outcome, and as an error: counts that differ from each other, in sentences."""
    rows = [row for row in rows if row["judged"]]
    if not rows:
        return

    def each(words):
        return listed([f"{words(row)} ({row['engine']})" for row in rows])

    how = "Tuned engines" if all(row["tier"] == "tuned" for row in rows) else "Engines"
    yield (
        f"“Right” asks for everything: outcome, time of a fall, peaks and slip within {percent(PEAK, 1)}, restitution "
        f"within {RESTITUTION_LIMIT:g} and no impact missed or added. {how} are right in "
        f"{each(lambda row: '{right} of {judged}'.format(**row))} runs. The outcome alone, which the chart on the "
        "first page counts apart from the time of a fall, is another one or none in "
        f"{each(lambda row: row[TURNED] + row[INSTEAD] + row['failed'])} of these. In the "
        "other runs that are not right, a fall comes at another time, or a peak, a slip or an impact is off."
    )
    slips, hits = [row for row in rows if row["slip"] is not None], [row for row in rows if row["slipping"] is not None]
    if slips and hits:
        slip = listed(
            [
                f"{percent(row['slip'])} (median) and {percent(row['slip_worst'])} (worst) in {row['engine']}"
                for row in slips
            ]
        )
        hit = listed([f"{number(row['slipping'], 2)} ({row['engine']})" for row in hits])
        yield (
            f"The largest slip is off by {slip}. At impacts with slip, restitution by states is off by {hit}, rms. The "
            f"limit of a trusted engine, {TRUSTED:g}, is one for impacts without slip; here "
            f"{sum(row['slipping'] <= TRUSTED for row in hits) or 'none'} of these {len(hits)} meets it."
        )


def _engines(counts):
    return table(
        f"Engines where the friction does not suffice: right in the outcome, peaks within {percent(PEAK, 1)}, the slip "
        f"too, restitution within {RESTITUTION_LIMIT:g}, and impacts",
        counts,
        NAME,
        Column("kind", "tier"),
        Column("right", "{right} of {judged}"),
        *ends(counts),
        Column("error of the slip, median", "slip", percent=True),
        Column("worst", "slip_worst", percent=True),
        Column("error of restitution by states at slipping impacts, rms [-]", "slipping"),
        Column("CPU time over the model's [-]", lambda row: row["cpu"] and f"{number(row['cpu'], 2)} ×"),
    )


def _impacts(counts):
    return table(
        "Errors of restitution at impacts in which the model's corner slides before or after, and at others",
        [row for row in counts if row["impacts"]],
        NAME,
        Column("slipping impacts [-]", "impacts"),
        Column("that are missed [-]", "lost"),
        Column(RESTITUTION, "slipping"),
        Column("worst [-]", "slipping_worst"),
        Column("other impacts [-]", "others"),
        Column(RESTITUTION, "sticking"),
    )


def _differences(differing):
    return table(
        "Runs that end otherwise than the model's, or differ; without the variants “defaults”",
        differing,
        NAME,
        Column("scene", "index"),
        Column("support, motion", "{support}, {motion}"),
        Column("friction [-]", "friction", digits=3),
        Column("tan γ [-]", lambda row: float(np.tan(row["slenderness"])), digits=3),
        Column("model", "model_outcome"),
        Column("in what", lambda row: typeset("; ".join(row["differences"]))),
    )


def _failures(failed):
    return table(
        "Runs that failed, by reason",
        [
            {"engine": engine, "variant": variant, "why": why, "runs": len(rows), "scenes": _scenes(rows)}
            for (engine, variant, why), rows in grouped(failed, "engine", "variant", _why).items()
        ],
        NAME,
        Column("why", "why"),
        Column("runs", "runs"),
        Column("scenes", "scenes"),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    marks = {}
    for row in tallies(result):
        if row["judged"]:
            share = row["right"] / row["judged"]
            level = "good" if share >= LEAST_RIGHT else "fair" if share >= 0.5 else "bad"
            note = f"outcome right in {row['alike']}; {row['differs']} differ, {row['failed']} failed"
            note += f"; {left_out(row)}"
            marks[row["engine"], row["variant"]] = Mark(f"{row['right']} of {row['judged']}", level, note, share)
    return (Judgement("sliding scenes right", marks),)


def glance(result: Result) -> Glance:
    """Of the runs that differ, those that end otherwise. A slip within its tolerance is no other end."""
    outcomes = {row["index"]: row["outcome"] for row in where(result.rows, part="scene")}
    runs = [
        {
            **row,
            "class": "right" if row["class"] == "differs" and not END & set(row["quantities"]) else row["class"],
            "model_falls": outcomes[row["index"]] == "overturns",
            "falls": None if row["outcome"] == "failed" else row["outcome"] == "overturns",
            "changed": "outcome" in row.get("quantities", ()),
            "group": row["index"],
        }
        for row in where(result.rows, part="run")
    ]
    return Glance(endings=counted("blocks that may slide", runs))


def summed(cells: Iterable[Mapping[str, Any]], key: Any) -> list[dict[str, Any]]:
    """The cells' counts added up by a key, with each of `SHARES`: (how many, of how many, share, its interval)."""
    found = []
    for (name,), members in grouped(cells, key).items():
        row = {k: sum(cell[k] for cell in members) for k, value in members[0].items() if type(value) is int}
        sound = row["runs"] - row["failed"] - row["undecided"]
        row |= {"engine": "analytic", "name": name, "upright_without": sound - row["falls_without"]}
        for share, (_, whole, _) in SHARES.items():
            one = row[share] / row[whole] if row[whole] else None
            within = wilson(row[share], row[whole]) if row[whole] else None
            row |= {f"{share}_share": one, f"{share}_within": within}
        found.append(row)
    return found


def judged(result: Result) -> list[dict[str, Any]]:
    """The engines' runs of scenes in which any is judged, beside what the scene is."""
    scenes = {row["index"]: row for row in where(result.rows, part="scene")}
    kept = ("support", "motion", "friction", "slenderness")
    return [
        {**row, **{key: scenes[row["index"]][key] for key in kept}, "model_outcome": scenes[row["index"]]["outcome"]}
        for row in where(result.rows, part="run")
        if row["class"] != "left out"
    ]


def tallies(result: Result) -> list[dict[str, Any]]:
    """A row for each variant: its runs by class and their `tally`, its errors, None where it has none."""
    every, found = judged(result), []
    for (engine, variant), rows in grouped(where(result.rows, part="run"), "engine", "variant").items():
        runs, left = where(every, engine=engine, variant=variant), where(rows, **{"class": "left out"})
        sound = [row for row in runs if not row.get("failure")]
        slips = np.abs([row["slip_error"] for row in sound if row["slip_error"] is not None])
        slipping, sticking = (np.array([e for row in sound for e in row[key]]) for key in ("slipping", "sticking"))
        found.append(
            {
                "engine": engine,
                "variant": variant,
                "tier": rows[0]["tier"],
                **{name: len(where(runs, **{"class": name})) for name in ("right", "differs")},
                **(counts := tally([*runs, *left], "index", _turned)),
                "judged": len(runs),
                "wrong": counts["share"],
                "wrong_within": counts["interval"],
                "alike": sum("outcome" not in row["quantities"] for row in sound),
                "slip": float(np.median(slips)) if len(slips) else None,
                "slip_worst": float(slips.max()) if len(slips) else None,
                "impacts": len(slipping),
                "others": len(sticking),
                "lost": sum(row["lost"] for row in sound),
                "slipping": rms(slipping) if len(slipping) else None,
                "slipping_worst": float(np.abs(slipping).max()) if len(slipping) else None,
                "sticking": rms(sticking) if len(sticking) else None,
                "cpu": float(np.median([row["cpu_ratio"] for row in sound])) if sound else None,
            }
        )
    return found


def _turned(row):
    return (row["outcome"] == FALLS) != (row["model_outcome"] == FALLS)


def _why(row):
    return row["failure"]["reason"]


def _scenes(rows):
    return ", ".join(str(row["index"]) for row in rows)


def _title(every):
    return (
        f"Sliding: it saves {every['saved']} of {every['falls_without']} random statues that overturn without it, and "
        f"overturns {every['overturned']} of {every['upright_without']} others"
    )


def _interval(cell):
    return "{:g} to {:g}".format(*cell["friction"])


def _outcomes(key):
    """Columns of `summed` cells by a key."""
    head = key if isinstance(key, str) else "friction [-]"
    shares = (Column(f"{words}, of those {of}", partial(_counted, share=s)) for s, (words, _, of) in SHARES.items())
    return (
        Column(head, "name"),
        Column("scenes [-]", "runs"),
        Column("that lift or slide [-]", "moves"),
        Column("that need more than the friction [-]", "lacking"),
        *shares,
        Column("undecided, failed [-]", "{undecided}, {failed}"),
    )


def _counted(row, share):
    within, words = row[f"{share}_within"], f"{row[share]} of {row[SHARES[share][1]]}"
    return words if within is None else f"{words}, {number(100 * within[0], 2)} to {percent(within[1])}"


def _shares(cells: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Shares over friction, a panel for each support."""
    looks = {words: curve(rank) for rank, (words, *_) in enumerate(SHARES.values())}
    ends = [end for cell in cells for end in cell["friction"]]
    charts = []
    for (support,), members in grouped(cells, "support").items():
        chart = Chart(
            Axis("friction μ [-]", min(ends), max(ends)),
            Axis("share of scenes [-]", 0.0, 1.0),
            f"{support}: share of scenes, over friction, in which the block is {', '.join(looks)}.",
            title=f"{support}: what sliding does",
            height=300,
        )
        rows = summed(members, lambda cell: tuple(cell["friction"]))
        for share, (words, whole, of) in SHARES.items():
            drawn = [row for row in rows if row[whole]]
            xs = [sum(row["name"]) / 2 for row in drawn]
            ys = [row[f"{share}_share"] for row in drawn]
            lows, highs = ([row[f"{share}_within"][end] for row in drawn] for end in (0, 1))
            told = [f"{words}, of those {of}: {_counted(row, share)}" for row in drawn]
            chart.reach(xs, ys, lows, highs, words, look=looks[words])
            chart.line(xs, ys, words, look=looks[words])
            chart.dots(xs, ys, words, says=told, look=looks[words])
        charts.append(chart)
    keys = {words: key_of(words, look=look) for words, look in looks.items()}
    caption = "Share of scenes over friction, with 95 % Wilson intervals: " + "; ".join(
        f"{words}, of those {of}" for words, _, of in SHARES.values()
    )
    return figure(charts, f"{caption}.", keys, keys) if charts else None


def _slips(runs: Sequence[Mapping[str, Any]]) -> Figure | None:
    """How many runs of blocks that stay upright have at most which error of the slip, where there is one."""
    rows = []
    upright = [row for row in where(runs, tier={"tuned", "defaults"}) if row["model_outcome"] != FALLS]
    for (engine, variant, tier), members in grouped(upright, "engine", "variant", "tier").items():
        errors = sorted(abs(row["slip_error"]) for row in members if row.get("slip_error") is not None)
        whole = len(errors) + sum(row["outcome"] in ("failed", FALLS) for row in members)
        found = {"engine": engine, "variant": variant, "tier": tier}
        rows += [{**found, "error": max(e, LEAST_ERROR), "share": k / whole} for k, e in enumerate(errors, 1)]
    return lines(
        rows,
        SLIP,
        Column("share of runs [-]", "share"),
        "Of the runs of blocks that stay upright, the share whose error of the largest slip is at most the value on "
        "the axis. The remaining runs failed or overturned.",
        panel="tier",
        log="x",
    )


def _restitutions(counts: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Root mean square errors of restitution at slipping and other impacts, a panel each."""
    rows = [
        {**row, "kind": kind, "rms": row[key]}
        for key, kind in (("slipping", "slipping impacts"), ("sticking", "other impacts"))
        for row in counts
        if row["impacts"]
    ]
    axis = Axis(RESTITUTION, 1e-6, 1.0, "log", tuple((10.0**k, power_of_ten(10.0**k)) for k in range(-6, 1, 2)))
    caption = "Errors of restitution, root mean square; slipping impacts: the model's corner slides before or after."
    return ranks(rows, NAME, Column(RESTITUTION, "rms"), caption, axis, panel="kind")


def _how(result: Result) -> tuple[str, ...]:
    settings, scenes = result.settings, where(result.rows, part="scene")
    left = [row["comparable"] for row in scenes if row["comparable"] != COMPARED]
    known = [NOT_COMPARED.get(why, why) for why in left]
    reasons = ", ".join(f"{known.count(why)} {why}" for why in dict.fromkeys(known)) or "none"
    recorded = f"components of {settings['source']}" if settings["source"] else "none, as their package is missing here"
    raised, ratio = percent(settings["vertical"]), number(settings["ratio"], 2)
    low, high = settings["peak"]
    return (
        f"{settings['scenes']} scenes drawn at random (seed {result.provenance['seed']}, of the commit): "
        f"{settings['range']}; on rigid ground or on bearings, as no motion reaches a block whose base has none. Half "
        f"of the motions are pulses, a quarter synthetic, a quarter recorded ({recorded}), each times a factor: its "
        f"peak is {low:g} to {high:g} times g tan γ. {raised} have a vertical component, {ratio} times the horizontal "
        "peak. Friction is drawn evenly. What the shares say depends on how the scenes are drawn.",
        "Without sliding: the same scene without a friction, whose block turns about corners that never slip. It needs "
        "more than the friction where the demand |H|/N exceeds it before any last fall, or N falls to 0. Undecided: "
        "the base goes on swinging, so that the end is not certain.",
        f"Engines run {len(scenes)} scenes in which that is so, the first ones drawn; variants other than the main "
        f"ones of the engines in question one in {settings['fewer']}. Left out, of all engines alike: "
        f"{reasons}. Near an outcome boundary: a change by 10⁻⁴, of the friction too, makes such a difference in the "
        "model. Errors of the slip are relative, of blocks that stay upright; a slip too small to count is compared as "
        "one of 0.005 R. CPU time is that of the stepping over that of the model’s march, median over scenes.",
    )
