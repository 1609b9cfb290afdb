"""The page of the mistakes study: the script as it is and with each mistake, costliest first."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ...execution.results import Result
from ...plotting.charts import Axis, Chart, figure, key_of, log_axis, room
from ...plotting.parts import Figure, Page, grouped, table, where
from ...plotting.wording import TRUSTED, listed
from ...schemas.columns import Column, number, short
from .study import COLUMNS

AS_IT_IS = "no mistake"
MARKS: dict[str, dict[str, Any]] = {
    "graph": {"filled": True},
    "error": {"filled": False},
    "lost": {"mark": "X"},
}  # {what is drawn: how its marks look}
WORDS = {"graph": "tilt", "error": "restitution", "lost": "another outcome, or failed"}


def page(result: Result) -> Page:
    """Return the page of a result."""
    by_engine = {engine: _ranked(result, engine) for (engine,) in grouped(result.rows, "engine")}
    all_rows = [row for rows in by_engine.values() for row in rows]
    mistakes = [row for row in all_rows if row["group"] not in (None, result.settings["no_matter"])]
    lost = [row for row in mistakes if row["lost"]]
    same_outcome = [row for row in mistakes if not row["lost"] and row["error"] is not None and row["error"] <= TRUSTED]
    worst = max(same_outcome, key=lambda row: row["graph"], default=None)
    sentences = [
        "The scripts that rocking script writes agree with the analytic model. Here one thing at a time is changed in "
        "them to what a first script might do."
    ]
    if worst:
        sentences.append(
            f"The error of restitution does not show every mistake: with {worst['mistake']} in {worst['engine']} it is "
            f"at most {number(worst['error'], 1)}, but the tilt is off by {number(worst['graph'], 2)} of the "
            "slenderness."
        )
    return Page(
        f"What a mistake costs: {len(lost)} of {len(mistakes)} mistakes in scripts for "
        f"{listed(list(by_engine)) or 'no engine'} change an outcome or make a run fail",
        tuple(sentences),
        first=(
            _dots(by_engine, result.settings["no_matter"]),
            _counts(mistakes, where(all_rows, group=result.settings["no_matter"])),
        ),
        more=tuple(_table(engine, rows) for engine, rows in by_engine.items()),
        how=(
            "There are four scenes. The Caryatid is released from 0.6 of its slenderness, on rigid ground for 5 s, and "
            "on its base and bearings for 3 s. A block of 0.3 rad on rigid ground is overturned by a one-sine pulse. A "
            "block of 0.15 rad stands on the bearings under the first 9 s of the synthetic record. A mistake is made "
            "only in scenes that have what it concerns.",
            "Each script runs by itself; its steps are measured like those of any engine. The error of restitution is "
            "the root mean square difference from eq. (7), at impacts of at least a tenth of the fastest rate, in the "
            "worst scene. The error by energy follows from the rates at successive impacts. The error of the tilt is "
            "the largest difference from the analytic model at the same time, until either block is beyond its "
            "unstable point; so late impacts count. A run fails if it ends in an error, gains energy, or leaves its "
            "place.",
        ),
    )


def _counts(mistakes, harmless):
    """Table of how many mistakes there are of each kind, by engine and in all."""
    groups = {
        engine: (changed, where(harmless, engine=engine)) for (engine,), changed in grouped(mistakes, "engine").items()
    }
    groups |= {"all": (mistakes, harmless)} if len(groups) > 1 else {}
    rows = [
        {
            "engine": engine,
            "mistakes": len(changed),
            "lost": sum(row["lost"] > 0 for row in changed),
            "off": sum((row["error"] or 0.0) > TRUSTED for row in where(changed, lost=0)),
            "harmless": len(others),
        }
        for engine, (changed, others) in groups.items()
    ]
    return table(
        "How many mistakes",
        rows,
        COLUMNS["engine"].called("engine"),
        Column("mistakes", "mistakes"),
        Column("another outcome, or a run that fails", "lost"),
        Column(f"of the others: e off by more than {TRUSTED:g}", "off"),
        Column("changes that do not matter", "harmless"),
    )


def _ranked(result: Result, engine: str) -> list[dict[str, Any]]:
    """Return a row for each mistake of an engine, over its scenes, and one for the script as it is; costliest first."""
    bearings = set(result.settings["on_bearings"])
    rows = []
    for _, runs in grouped(where(result.rows, engine=engine), "mistake").items():
        on_rigid = [run for run in runs if run["scene"] not in bearings]
        rows.append(
            {
                **runs[0],
                "name": runs[0]["mistake"] or AS_IT_IS,
                "lost": sum(run["outcome"] != run["expected"] for run in runs),
                "outcomes": _outcomes(runs),
                "rigid": _largest(on_rigid, "error"),
                "bearings": _largest(where(runs, scene=bearings), "error"),
                **{name: _largest(runs, name) for name in ("error", "energy", "graph", "displacement")},
            }
        )
    return sorted(rows, key=lambda row: (-row["lost"], -max(row["graph"] or 0.0, row["error"] or 0.0)))


def _largest(runs, name):
    """Largest of the known values; None without one."""
    return max((run[name] for run in runs if run[name] is not None), default=None)


def _outcomes(runs: Sequence[dict[str, Any]]) -> str:
    """Return in words where the outcome is not the model's, or why the run failed, each with its scenes."""
    wrong = [run for run in runs if run["outcome"] != run["expected"]]
    by_words = grouped(
        wrong,
        lambda run: (
            f"fails: {run['reason']}" if run["reason"] else f"{run['outcome']} where the model {run['expected']}"
        ),
    )
    places = {
        words: ", ".join(run["scene"].replace(", ", " on ") for run in scenes) for (words,), scenes in by_words.items()
    }
    everywhere = len(runs) > 1 and len(by_words) == 1 and len(wrong) == len(runs)
    phrases = [f"{words} ({'all scenes' if everywhere else scenes})" for words, scenes in places.items()]
    return "; ".join(phrases) or "as the model"


def _table(engine, rows):
    return table(
        f"{engine}: each mistake, in its worst scene",
        rows,
        Column("mistake", "name"),
        Column("what was done", lambda row: row["done"] or "the script as it is"),
        Column("concerns", lambda row: row["group"] or "–"),
        Column("outcome", "outcomes"),
        Column("error of restitution, rigid ground [-]", "rigid"),
        Column("on bearings [-]", "bearings"),
        COLUMNS["energy"],
        COLUMNS["graph"],
        COLUMNS["displacement"],
    )


def _dots(by_engine: dict[str, list[dict[str, Any]]], no_matter: str) -> Figure | None:
    """Figure with a panel for each engine: errors of restitution and of the tilt, a row for each mistake."""
    shown = {engine: [row for row in rows if row["group"] != no_matter] for engine, rows in by_engine.items()}
    values = [row[name] for rows in shown.values() for row in rows for name in ("graph", "error") if row[name]]
    if not values:
        return None
    axis = log_axis("error of e; of the tilt over γ [-]", values)
    axis = replace(axis, ticks=axis.marks()[::2])  # there is no room for more beside the names
    charts = [_chart(engine, rows, axis) for engine, rows in shown.items()]
    keys = {
        f"{engine}, {WORDS[name]}": key_of(engine, filled=look.get("filled", True), joined=False)
        for engine in shown
        for name, look in MARKS.items()
        if name != "lost"
    }
    caption = (
        "Each mistake in its worst scene, the costliest first; the script without a mistake comes last. Filled: "
        "largest difference of the tilt. Open: error of restitution at impacts. Cross at the right: another outcome "
        "than the model’s, or a failed run. Changes that do not matter are not drawn; the study’s page lists them."
    )
    return figure(charts, caption, keys, keys)


def _chart(engine: str, rows: Sequence[dict[str, Any]], axis: Axis) -> Chart:
    names = tuple((place, f"{row['name']}\u2002") for place, row in enumerate(rows))
    chart = Chart(
        axis,
        Axis("", len(rows) - 0.5, -0.5, ticks=names),
        f"{engine}: errors with {', '.join(row['name'] for row in rows)}.",
        title=engine,
        height=90 + 21 * len(rows),
        left=room(row["name"] for row in rows),
        right=24,
    )
    for name, look in MARKS.items():
        drawn = [row for row in rows if row[name]]
        places = [rows.index(row) for row in drawn]
        across = [axis.high if name == "lost" else row[name] for row in drawn]
        says = [
            f"{row['name']}: {row['outcomes'] if name == 'lost' else f'{WORDS[name]} {short(row[name])}'}"
            for row in drawn
        ]
        chart.dots(across, places, f"{engine}, {WORDS[name]}", says=says, **look)
    return chart
