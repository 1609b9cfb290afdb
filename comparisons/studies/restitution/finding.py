"""What the report shows of the restitution study: one sentence, one figure, one short table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.charts import Axis, Chart, figure, log_axis
from ...showing.parts import Section, Table, number
from ...showing.wording import TRUSTED, trust
from .figures import select

if TYPE_CHECKING:
    from ...running.provenance import Result

PANELS = ("rigid ground", "a sliding base")


def finding(result: Result) -> Section:
    """The `Section` of the report about one impact."""
    rows = _ranked(result)
    good = [row for row in rows if row["rms"] <= TRUSTED and not row["failed"]]
    bad = [row for row in rows if row not in good]
    title = f"One impact: {len(good)} of {len(rows)} settings of engines keep restitution within {TRUSTED:g}" + (
        f"; the others miss it by up to {number(bad[-1]['rms'], 2)}" if bad else ""
    )
    text = (
        "A block let go loses speed at every impact; eq. (7) says how much, from momentum alone. The engines are not "
        "given that number: it follows from their contact, and goes wrong where a step straddles the impact, where "
        "the corner sinks in or bounces, or where damping that nobody asked for takes energy in flight.",
    )
    return Section(
        title,
        text,
        (_table(rows),),
        (figure([_panel(result, k) for k in (0, 1)], _caption(result), _solvers(result)),),
        measured=(_how(result),),
    )


def _ranked(result):
    """A row for each engine and variant at its default: the worse of both grounds."""
    found = {}
    for row in select(result, "summary", scope="all"):
        if row["rms"] is not None:
            found.setdefault((row["engine"], row["variant"]), []).append(row)
    applied = {(knob["engine"], knob["variant"]) for knob in result.settings["knobs"] if knob["applies_impact"]}
    rows = [
        {
            "engine": engine,
            "variant": variant,
            "rms": max(row["rms"] for row in rows),
            "worst": max(row["worst"] for row in rows),
            "failed": sum(row["failed"] for row in rows),
            "runs": sum(row["runs"] for row in rows),
            "orders": [
                row["order"]
                for row in select(result, "order", engine=engine, variant=variant)
                if row["order"] is not None
            ],
        }
        for (engine, variant), rows in found.items()
        if (engine, variant) not in applied
    ]
    return sorted(rows, key=lambda row: row["rms"])


def _solvers(result):
    return list(dict.fromkeys(row["engine"] for row in _ranked(result)))


def _panel(result, ground):
    """Error over slenderness: default variants in their colours, the rest grey."""
    defaults = result.settings["default_variants"]
    series: dict[tuple[str, str], dict[float, list[float]]] = {}
    chosen = {(knob["engine"], knob["variant"]): knob["default"] for knob in result.settings["knobs"]}
    for row in select(result, "cell"):
        pair = row["engine"], row["variant"]
        if row["rms"] and (row["ratio"] is not None) == bool(ground) and row["value"] == chosen[pair]:
            series.setdefault(pair, {}).setdefault(row["slenderness"], []).append(row["rms"])
    worst = {pair: {gamma: max(values) for gamma, values in found.items()} for pair, found in series.items()}
    values = [value for found in worst.values() for value in found.values()]
    chart = Chart(
        Axis("slenderness γ [rad]", 0.0, 0.5),
        log_axis("error of restitution, rms [-]", [*values, 1e-6]),
        f"Error of restitution over slenderness on {PANELS[ground]}, every engine and variant.",
        title=f"on {PANELS[ground]}",
        height=300,
        right=88,
    )
    chart.rule(TRUSTED, "y", "trusted below")
    for grey in (True, False):
        for (engine, variant), found in sorted(worst.items()):
            if (defaults[engine] != variant) != grey:
                continue
            gammas = sorted(found)
            errors = [found[gamma] for gamma in gammas]
            says = [f"{engine}, {variant}: {number(e, 2)} at γ = {g:g}" for g, e in zip(gammas, errors, strict=True)]
            chart.line(gammas, errors, engine, grey=grey)
            chart.dots(gammas, errors, engine, grey=grey, filled=not grey, says=says)
            if not grey:
                chart.label(errors[-1], engine, engine)
    return chart


def _caption(result):
    return (
        "Error of restitution, root mean square; on the base the worst of its masses. Coloured: each engine at its "
        "best; grey: its other settings, named under the pointer."
    )


def _table(rows):
    return Table(
        "Restitution, both grounds together, least error first",
        (
            "engine, variant",
            "verdict",
            "error, rms [-]",
            "worst impact [-]",
            "order in its knob [-]",
            "failed runs [-]",
        ),
        [
            [
                f"{row['engine']}, {row['variant']}",
                trust(row["rms"], row["failed"]).removeprefix("is ").removeprefix("may be "),
                number(row["rms"], 2),
                number(row["worst"], 2),
                " to ".join(number(value, 2) for value in sorted(row["orders"])[:: max(len(row["orders"]) - 1, 1)])
                or "–",
                f"{row['failed']} of {row['runs']}",
            ]
            for row in rows
        ],
    )


def _how(result):
    s = result.settings
    return (
        f"Slenderness {min(s['slendernesses']):g} to {max(s['slendernesses']):g} rad, {len(s['starts'])} starts, rigid "
        f"ground and {len(s['ratios']) - 1} base masses, the first {s['impacts']} impacts of every run. Restitution is "
        "the root of the ratio of a swing's energy after an impact to that before it. Trusted: error of both grounds "
        f"at most {TRUSTED:g}, no failed run; measured restitution of stone scatters by some per cent. The corners are "
        "set plastic, non-slipping and planar, which are Housner's assumptions: agreement is verification of the "
        "engine, not independent physics."
    )
