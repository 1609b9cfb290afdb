"""The fragility study's result in words, tables and a figure, from the result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import norm

from ...showing.parts import Section, Table, figure_of, number, percent
from ...showing.plots import marker, style

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVEL = 0.05
READING = (
    "May an engine be trusted for the probability of overturning? Each motion is given to the analytic model "
    "and to the engine; an exact McNemar test on the motions where the two disagree tells one from the other, "
    f"adjusted after Holm for the number of intensities, at a level of {LEVEL:g}. “No difference found” is not "
    "“equal”: each answer says how large a difference would have been found."
)
REFERENCE = "analytic"
PERTURBED_STYLE = {"color": "#56B4E9", "linestyle": (0, (1, 1)), "linewidth": 1.2}
FIRST_STYLE = {"linestyle": (0, (4, 1, 1, 1)), "linewidth": 1.2}


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    text = [_asked(result), READING]
    tables = []
    for scene in result.settings["scenes"]:
        text += _answers(result, scene)
        tables += [_curve_table(result, scene), _pair_table(result, scene)]
    text.append(_checks(result))
    figure = figure_of(
        draw(result),
        _alt(result),
        "Above: share of motions that overturn the block, with 95 % Wilson intervals (markers moved "
        "apart sideways), and the lognormal curves fitted to them. Below: share of motions on which a "
        "solver and the analytic model disagree.",
    )
    evidence = tuple(
        (
            f"{row['solver']}, {row['scene']}, seed {row['seed']}, factor {row['factor']:g}",
            f"{row['reason']}\n{row.get('message') or ''}",
        )
        for row in _part(result, "failure")
    )
    return Section(
        "Fragility: probability of overturning",
        tuple(text),
        tuple(tables),
        (figure,),
        evidence=evidence,
        verdicts=tuple(_verdict(result, label) for label in _compared(result)),
    )


def draw(result: Result) -> Figure:
    """Curves over intensity above, disagreements with the analytic model below; one column per scene."""
    scenes = list(result.settings["scenes"])
    figure = Figure(figsize=(5.6 * len(scenes), 6.6), layout="constrained")
    axes = figure.subplots(2, len(scenes), squeeze=False, sharex="col", height_ratios=[2, 1])
    for (above, below), scene in zip(axes.T, scenes, strict=True):
        labels = list(dict.fromkeys(row["solver"] for row in _part(result, "curve", scene=scene)))
        for place, label in enumerate(labels):
            look = _style(label)
            rows = _part(result, "curve", scene=scene, solver=label)
            shift = 1 + 0.006 * (place - (len(labels) - 1) / 2)
            x = shift * np.array([row["intensity"] for row in rows])
            share = np.array([row["overturned"] / row["size"] if row["size"] else np.nan for row in rows])
            reach = np.array(
                [
                    [y - row["low"], row["high"] - y] if row["size"] else [np.nan] * 2
                    for y, row in zip(share, rows, strict=True)
                ]
            )
            above.errorbar(
                x,
                share,
                np.maximum(reach, 0).T,
                fmt=_marker(label),
                markersize=4,
                capsize=2,
                color=look["color"],
                linestyle="none",
                label=label,
            )
            (fit,) = _part(result, "fit", scene=scene, solver=label)
            if fit["median"] is not None:
                fine = np.geomspace(x.min() * 0.9, x.max() * 1.1, 200)
                above.plot(fine, norm.cdf(np.log(fine / fit["median"]) / fit["dispersion"]), **look)
            if label != REFERENCE:
                pairs = _part(result, "pair", scene=scene, solver=label)
                below.plot(
                    [row["intensity"] for row in pairs],
                    [100 * (row["only_a"] + row["only_b"]) / _size(row) for row in pairs],
                    marker=_marker(label),
                    markersize=4,
                    **look,
                )
        above.set(title=_scene_name(result, scene), ylim=(-0.03, 1.03), ylabel="share of motions that overturn [-]")
        above.legend(fontsize="small")
        below.set(xlabel="peak ground acceleration [g]", ylabel="disagreements [% of motions]")
        below.set_yscale("symlog", linthresh=1.0)
        below.set(ylim=(0, 110), yticks=[0, 0.5, 1, 2, 5, 10, 20, 50, 100])
        below.yaxis.set_major_formatter("{x:g}")
        for axis in (above, below):
            axis.grid(color="0.92")
    return figure


def _asked(result):
    s = result.settings
    scenes = "; ".join(
        f"{_scene_name(result, name)}, peak ground acceleration {', '.join(f'{x:.3g}' for x in scene['intensities'])} g"
        for name, scene in s["scenes"].items()
    )
    return (
        f"Over a whole motion the rocking of a block cannot be predicted point by point; its odds can. "
        f"{s['motions']} synthetic motions (near-fault pulse and noise, seeds {s['seeds'][0]} to "
        f"{s['seeds'][1]}), each scaled to several intensities, were given to {len(s['solvers'])} solvers at "
        f"their default settings: {'; '.join(s['solvers'])}. Scenes: {scenes}."
    )


def _compared(result):
    """Labels of the engines, without the analytic model's comparison with itself."""
    labels = dict.fromkeys(row["solver"] for row in _part(result, "pair"))
    return [label for label in labels if not label.startswith(REFERENCE)]


def _verdict(result, label):
    """May I trust it for the probability of overturning?"""
    pairs = _part(result, "pair", solver=label)
    differ, size = sum(row["only_a"] + row["only_b"] for row in pairs), sum(_size(row) for row in pairs)
    apart = [
        _scene_name(result, scene)
        for scene in result.settings["scenes"]
        if any(row["p_holm"] <= LEVEL for row in pairs if row["scene"] == scene)
    ]
    words = (
        f"is not to be trusted for the probability of overturning ({', '.join(apart)})"
        if apart
        else ("may be trusted for the probability of overturning, as no difference was found")
    )
    return f"{label} {words}: {differ} of {size} outcomes differ from the analytic model's."


def _answers(result, scene):
    """One paragraph for each solver: does it differ from the analytic model?"""
    for label in dict.fromkeys(row["solver"] for row in _part(result, "pair", scene=scene)):
        pairs = _part(result, "pair", scene=scene, solver=label)
        only_a, only_b = (sum(row[key] for row in pairs) for key in ("only_a", "only_b"))
        size = sum(_size(row) for row in pairs)
        smallest = min(row["p_holm"] for row in pairs)
        worst = max(pairs, key=lambda row: abs(row["difference"]))
        counts = (
            f"{only_a + only_b} of {size} outcomes differ ({only_a} overturn in the analytic model alone, "
            f"{only_b} in {label} alone); smallest exact McNemar p over the intensities, adjusted after Holm, "
            f"{number(smallest, 2)}; largest difference of the probability {_points(worst['difference'])} "
            f"percentage points, at {worst['intensity']:.3g} g"
        )
        if smallest <= LEVEL:
            yield (
                f"{_scene_name(result, scene)}, {label}: they differ; do not trust it. {counts}."
                f"{_cause(result, scene, label)}"
            )
            continue
        least = [row["detectable_difference"] for row in pairs]
        bound = (
            "no difference, however large, could have been found so"
            if None in least
            else f"at each intensity by itself, a difference of {number(100 * max(least), 2)} percentage points or "
            "more would have been found with at least 80 % probability, before the adjustment"
        )
        yield f"{_scene_name(result, scene)}, {label}: no difference found at this sample size. {counts}; {bound}."


def _cause(result, scene, label):
    """Why a solver's block stays up: friction that lets it slide."""
    friction, steepness = result.settings["friction"].get(label), result.settings["scenes"][scene]["tan_slenderness"]
    if friction is None or friction >= steepness:
        return ""
    return (
        f" Its friction, {friction:g} by its defaults, is below tan(slenderness) = {number(steepness)}: the "
        "block slides where it should lift."
    )


def _checks(result):
    undecided = sum(row.get("undecided", row.get("decided_later")) for row in _part(result, "check"))
    runs = sum(row["runs"] for row in _part(result, "check"))
    failed = len(_part(result, "failure"))
    unfitted = "".join(
        f" No curve fits {row['solver']} ({row['scene']}): {row['reason']}."
        for row in _part(result, "fit")
        if row["median"] is None
    )
    return (
        f"Runs of the analytic model whose outcome was not decided at their end: {undecided} of {runs}. "
        f"Runs that failed: {failed}. “{_perturbed(result)}” is the analytic "
        f"model with its restitution changed by 1 part in {1 / result.settings['change']:.0f}: disagreements as many "
        "as it has with itself are nothing to blame an engine for." + unfitted
    )


def _perturbed(result):
    return next((row["solver"] for row in _part(result, "fit") if row["solver"].startswith("analytic, ")), "")


def _curve_table(result, scene):
    labels = list(dict.fromkeys(row["solver"] for row in _part(result, "curve", scene=scene)))
    rows = []
    for label in labels:
        cells = [
            f"{row['overturned']}/{row['size']} ({percent(row['low'])} to {percent(row['high'])})"
            if row["size"]
            else "–"
            for row in _part(result, "curve", scene=scene, solver=label)
        ]
        (fit,) = _part(result, "fit", scene=scene, solver=label)
        median, dispersion = "no fit", "–"
        if fit["median"] is not None:
            median, dispersion = (
                f"{number(fit[key])} ({number(fit[key + '_interval'][0])} to {number(fit[key + '_interval'][1])})"
                for key in ("median", "dispersion")
            )
        rows.append([label, *cells, median, dispersion, number(fit["cpu_per_run"], 2)])
    return Table(
        f"{_scene_name(result, scene)}: motions that overturn (95 % Wilson interval), lognormal fit (its "
        "intervals take the intensities as independent and are indicative), and CPU time",
        (
            "solver",
            *(f"{x:.3g} g" for x in result.settings["scenes"][scene]["intensities"]),
            "median [g]",
            "dispersion [-]",
            "CPU time per run [s]",
        ),
        rows,
    )


def _pair_table(result, scene):
    rows = []
    for row in _part(result, "pair", scene=scene):
        rows.append(
            [
                f"{row['solver']}, {row['intensity']:.3g} g",
                str(row["both_stand"]),
                str(row["both_overturn"]),
                str(row["only_a"]),
                str(row["only_b"]),
                number(row["kappa"], 3),
                number(row["p_value"], 2),
                number(row["p_holm"], 2),
                "yes" if row["p_holm"] <= LEVEL else "not found",
            ]
        )
    return Table(
        f"{_scene_name(result, scene)}: the same motion in the analytic model and in another solver",
        (
            "solver, intensity",
            "both stand [-]",
            "both overturn [-]",
            "only the analytic model overturns [-]",
            "only this solver overturns [-]",
            "Cohen's kappa [-]",
            "exact McNemar p [-]",
            "p after Holm [-]",
            "they differ",
        ),
        rows,
    )


def _scene_name(result, scene):
    given = result.settings["scenes"][scene]
    ground = "on rigid ground" if given["base"] is None else f"on {given['bearings']['count']} bearings"
    return f"{scene} block of slenderness {given['block']['slenderness']:g} {ground}"


def _alt(result):
    medians = [
        f"{row['solver']} {number(row['median'])} g ({row['scene']})"
        for row in _part(result, "fit")
        if row["median"] is not None
    ]
    return "Rising curves of the share of motions that overturn against intensity. Medians: " + "; ".join(medians) + "."


def _points(difference):
    return number(100 * difference, 2)


def _size(row):
    return row["both_stand"] + row["both_overturn"] + row["only_a"] + row["only_b"]


def _marker(label):
    return marker(label) if "," not in label else "d"


def _style(label):
    if "," not in label:
        return style(label)
    engine = label.partition(",")[0]
    return PERTURBED_STYLE if engine == REFERENCE else {**style(engine), **FIRST_STYLE}


def _part(result, part, **wanted):
    return [
        row for row in result.rows if row["part"] == part and all(row[key] == value for key, value in wanted.items())
    ]
