"""The fragility study's result in words, tables and figures, from the result alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...showing.parts import Section, figure_of, number, percent
from .figures import FITS, draw_curves, draw_dispersions, draw_effects, is_shown, parted, states_in
from .tables import LEVEL, effect_table, fit_table, ranged, shift, size

if TYPE_CHECKING:
    from ...running.provenance import Result

ANALYTIC, OVERTURNING = "analytic", "overturning"


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    scenes = list(result.settings["scenes"])
    text, tables = [_asked(result), _reading(result)], []
    for scene in scenes:
        text += [_efficiency(result, scene), _shown(result, scene), *_answers(result, scene)]
        tables += [fit_table(result, scene), effect_table(result, scene)]
    text.append(_checks(result))
    evidence = tuple(
        (f"{row['solver']}, {row['scene']}, seed {row['seed']}", f"{row['reason']}\n{row.get('message') or ''}")
        for row in parted(result, "failure")
    )
    return Section(
        "Fragility: probability of a limit state", tuple(text), tuple(tables), _figures(result), evidence=evidence
    )


def _figures(result):
    scenes = list(result.settings["scenes"])
    efficient = " ".join(_efficiency(result, scene) for scene in scenes)
    shifts = "; ".join(
        f"{row['solver']} {shift(row['median_shift'])} ({row['scene']})"
        for row in parted(result, "effect", state=OVERTURNING)
    )
    return (
        figure_of(
            draw_curves(result),
            "Shares of runs that exceed each limit state, rising over intensity. "
            + " ".join(_shown(result, scene) for scene in scenes),
            "Share of runs that exceed a limit state, with 95 % Wilson intervals, in bins of equally many "
            "runs over the "
            f"measure of least dispersion. A lognormal curve is drawn only where the test of its fit has p ≥ {FITS:g}.",
        ),
        figure_of(
            draw_dispersions(result),
            f"Dispersion of every intensity measure for each limit state. {efficient}",
            "Dispersion of the fitted curve in each intensity measure, with 95 % bootstrap intervals: the smaller, the "
            "more the measure tells. Coloured: the least.",
        ),
        figure_of(
            draw_effects(result),
            f"Shift of the median intensity by each solver. Overturning: {shifts}.",
            "Shift of the median intensity by a solver against the analytic model on the same runs, with "
            "95 % intervals "
            "from paired bootstrap. In each row from above: "
            + ", ".join(states_in(result, scenes[-1]))
            + ". Grey: shifts that would not have been found; without a bar: no run differs. Open: first scripts.",
        ),
    )


def _asked(result):
    s = result.settings
    scenes = "; ".join(
        f"{name} ({scene['scene']}), slenderness γ {scene['slendernesses'][0]:g} to {scene['slendernesses'][1]:g} rad"
        for name, scene in s["scenes"].items()
    )
    stretch, radius, peak = (s["drawn"][key] for key in ("stretch", "radius", "peak"))
    return (
        "Over a whole motion the rocking of a block cannot be predicted point by point; its odds can. "
        f"{s['runs']} runs "
        f"of the analytic model for each scene, no two alike: every one has a synthetic near-fault motion of its own "
        f"(seeds 0 to {s['runs'] - 1}), whose time is stretched by {stretch[0]:g} to {stretch[1]:g} and whose peak is "
        f"{peak[0]:g} to {peak[1]:g} g, and a block of its own, radius {radius[0]:g} to {radius[1]:g} m; "
        "all evenly over "
        "the logarithm. The stretching is there because all synthetic motions have nearly one spectrum: without it no "
        "measure of intensity could tell more than another, and blocks of one slenderness would make PGA and "
        f"PGA/(g tan γ) the same. Scenes: {scenes}."
    )


def _reading(result):
    s = result.settings
    return (
        f"Sa is the spectral acceleration at the isolation period, {s['period']:.2f} s (secant at "
        f"{s['x_max']:g} m), at {percent(s['damping'])} damping; spectral velocity and displacement are it times a "
        "constant, so that their dispersion is the same. g tan γ is the uplift acceleration, ω_r the "
        "rocking frequency. "
        "A dispersion is that of the lognormal curve P = Φ(ln(x/median)/dispersion) of greatest likelihood, its "
        "interval from bootstrap over runs; p is that of Pearson's test of the curve's fit, and a curve "
        f"with p < {FITS:g} "
        f"is not shown. Engines get the first {s['runs_of_engines']} runs, first scripts the first "
        f"{s['runs_of_first_scripts']}, whose PGA is {s['near'][0]:g} to {s['near'][1]:g} times g tan γ, and are held "
        "against the model run by run: exact McNemar test, adjusted after Holm for the limit states, at a level of "
        f"{LEVEL:g}. “No difference found” is not “equal”: each answer says which shift would have been found with "
        "80 % probability."
    )


def _efficiency(result, scene):
    told = []
    for state in states_in(result, scene):
        rows = parted(result, "fit", scene=scene, state=state)
        best = next((row for row in rows if row["best"]), None)
        if best is None:
            told.append(f"{state}: no curve")
            continue
        equal = [row["measure"] for row in rows if row["ratio_interval"] and row["ratio_interval"][0] <= 1]
        usual = next(row for row in rows if row["measure"] == "PGA")["dispersion"]
        words = f"{state}: {best['measure']}, {ranged(best['dispersion'], best['dispersion_interval'])}"
        words += f" (PGA: {number(usual, 2)})" if best["measure"] != "PGA" else ""
        told.append(words + (f", not certainly less than {', '.join(equal)}" if equal else ""))
    return f"{scene}: least dispersion for " + "; ".join(told) + "."


def _shown(result, scene):
    rows = [row for row in parted(result, "fit", scene=scene) if row["p_value"] is not None]
    fitting = [row for row in rows if is_shown(row)]
    told = "; ".join(f"{row['state']} over {row['measure']}, p = {number(row['p_value'], 2)}" for row in fitting)
    return f"{scene}: a lognormal curve fits in {len(fitting)} of {len(rows)} cases" + (f" ({told})." if told else ".")


def _answers(result, scene):
    """One paragraph for each solver: does it differ from the analytic model?"""
    for label in result.settings["solvers"]:
        rows = parted(result, "effect", scene=scene, solver=label)
        if not rows:
            yield f"{scene}, {label}: no run succeeded."
            continue
        apart = [row["state"] for row in rows if row["p_holm"] <= LEVEL]
        flips = [row["only_a"] + row["only_b"] for row in rows]
        counts = ", ".join(f"{flip} for {row['state']}" for flip, row in zip(flips, rows, strict=True))
        failed = f" ({rows[0]['left_out']} more failed)" if rows[0]["left_out"] else ""
        said = f"of {size(rows[0])} runs{failed} these differ: {counts}"
        known = [row for row, flip in zip(rows, flips, strict=True) if flip and row["median_shift"] is not None]
        if known:
            most = max(known, key=lambda row: abs(math.log(row["median_shift"])))
            said += (
                f"; largest shift of a median {shift(most['median_shift'], most['median_interval'])} "
                f"({most['state']}), "
                f"dispersion times {ranged(most['dispersion_shift'], most['dispersion_interval'], 3)}"
            )
        yield (
            f"{scene}, {label}: they differ ({', '.join(apart)}); {said}.{_cause(result, scene, label)}"
            if apart
            else f"{scene}, {label}: no difference found; {said}. {_resolved(rows)}"
        )


def _resolved(rows):
    """Which difference would have been found, at worst over the limit states."""
    least = [row["detectable_difference"] for row in rows]
    if None in least:
        return "No difference, however large, could have been found so."
    shifts = [row["detectable_shift"] for row in rows if row["detectable_shift"] is not None]
    medians = f", shifts of a median by {shift(max(shifts))}" if shifts else ""
    return f"Differences of {number(100 * max(least), 2)} percentage points{medians} would have been found."


def _cause(result, scene, label):
    """Why a solver's block stays up: friction that lets it slide."""
    friction = result.settings["friction"].get(label)
    steepest = math.tan(result.settings["scenes"][scene]["slendernesses"][1])
    if friction is None or friction >= steepest:
        return ""
    return (
        f" Its friction, {friction:g} by its defaults, is below tan γ of the least slender blocks "
        f"({number(steepest)}): "
        "these slide where they should lift."
    )


def _checks(result):
    runs, undecided, failed = (
        sum(row[key] for row in parted(result, "check")) for key in ("runs", "undecided", "failed")
    )
    perturbed = result.settings["solvers"][0]
    return (
        f"Runs of the analytic model whose outcome was not decided at their end: {undecided} of {runs}; "
        f"failed: {failed}. "
        f"Runs of others that failed: {len(parted(result, 'failure'))}. “{perturbed}” is the analytic model with its "
        f"restitution changed by 1 part in {1 / result.settings['change']:.0f}: disagreements as many as it has with "
        "itself are nothing to blame an engine for."
    )
