"""The study's result files as sections of the report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from engines import missing_words

from ...showing.parts import Section, Table, figure_of, number, percent
from . import paper
from .figures import drawings
from .runs import FREE, ISOLATED
from .variations import CATEGORIES, FRICTION_LIMITS, ONLY_FREE, ONLY_ISOLATED, WITHIN

if TYPE_CHECKING:
    from ...running.provenance import Result


def section(result: Result) -> Section:
    """The `Section` of one result file of the study."""
    figures = tuple(figure_of(drawing.figure, drawing.alt, drawing.caption) for drawing in drawings(result).values())
    part = {"paper": _paper, "motion": _motion, "histories": _histories}[result.settings["part"]]
    title, text, tables = part(result)
    return Section(title, tuple(text), tuple(tables), figures)


def _rows(result, part):
    return [row for row in result.rows if row["part"] == part]


def _cell(value):
    return value if isinstance(value, str) else number(value, 6)


def _value_table(result, caption):
    rows = [
        [
            f"{row['where']}: {row['quantity']}",
            _cell(row["paper"]),
            _cell(row["study"]),
            number(row["difference"], 2),
            row["status"],
            row["note"],
        ]
        for row in _rows(result, "value")
    ]
    return Table(caption, ("number of the paper", "paper", "this study", "difference", "status", "note"), rows)


def _paper(result):
    counts = {}
    for row in _rows(result, "equation"):
        counts[row["status"]] = counts.get(row["status"], 0) + 1
    misprints = Table(
        "Misprints and definitions",
        ("where", "printed", "should be", "measure", "corrected", "printed"),
        [
            [
                row["where"],
                row["printed"],
                row["corrected"],
                row["measure"],
                number(row["value_corrected"], 5),
                number(row["value_printed"], 5),
            ]
            for row in _rows(result, "misprint")
        ],
    )
    equations = Table(
        "Every equation, Fig. 3 and Table 1",
        ("number", "what", "status", "how it was checked", "value"),
        [
            [row["number"], row["what"], row["status"], row["check"], number(row["value"], 6)]
            for row in _rows(result, "equation")
        ],
    )
    text = [
        f"Of the paper's equations, Fig. 3 and Table 1, {counts.get(paper.REPRODUCED, 0)} are reproduced and "
        f"{counts.get(paper.CORRECTED, 0)} are corrected: (8), which breaks the conservation of momentum, and "
        "(12), which makes the bearing force jump. Two definitions need care: the damping of 30 % is twice the "
        "usual equivalent damping, and the period of 2 s is the secant period at 0.30 m.",
        f"Not at hand, and so not compared: {paper.UNKNOWN}",
    ]
    return (
        "The Caryatid paper: equations, Table 1, misprints",
        text,
        [_value_table(result, "Paper, this study, difference"), equations, misprints],
    )


def _motion(result):
    label = result.settings["motion"]["label"]
    text = [
        _outcome_text(result),
        _slenderness_text(result),
        _benefit_text(result),
        _contact_text(result),
        _cost_text(result),
    ]
    if result.settings["missing"]:
        text.append("Not installed, and so not compared: " + "; ".join(missing_words(result.settings["missing"])))
    tables = [
        _value_table(result, f"Figs 4 to 6 under {label}: paper, this study, difference"),
        _run_table(result),
        _claim_table(result),
        _critical_table(result),
        _seed_table(result),
        _contact_table(result),
        _cost_table(result),
    ]
    return f"The Caryatid paper: simulations under {label}", text, tables


def _histories(result):
    solvers = dict.fromkeys(row["solver"] for row in result.rows)
    return (
        f"The Caryatid paper: Figs 4 and 6 under {result.settings['motion']['label']}",
        [f"Tilt and displacement over time, over each other: {', '.join(solvers)}."],
        [],
    )


def _outcome_text(result):
    peak = result.settings["motion"]["peak_time"]
    words = []
    for row in _rows(result, "run"):
        if row["outcome"] == "failed":
            words.append(f"{row['solver']}, {row['scene']}: failed, {row['failure']['reason']}")
        elif row["outcome"] == "overturns":
            after = number(row["overturning_time"] - peak, 5)
            words.append(f"{row['solver']}, {row['scene']}: overturns {after} s after the peak")
        else:
            words.append(
                f"{row['solver']}, {row['scene']}: {row['outcome']}, {number(row['peak_base_displacement'], 5)} m"
            )
    equivalent = "; ".join(
        f"{row['definition']} = {percent(row['damping'], 3)}: {number(row['displacement'], 3)} m"
        for row in _rows(result, "equivalent")
    )
    nonlinear = _rows(result, "equivalent")[0]["nonlinear"]
    return (
        "; ".join(words) + f". A linear oscillator at the design period would have: {equivalent}; the bearings "
        f"themselves {number(nonlinear, 3)} m."
    )


def _spans(intervals):
    return ", ".join(f"{low:.4f} to {high:.4f}" for low, high in intervals) or "nowhere"


def _slenderness_text(result):
    together = next(row for row in _rows(result, "claim") if row["claim"] == "all three")["intervals"]
    chosen = result.settings["slenderness"]
    fits = any(low <= chosen <= high for low, high in together)
    where = (
        f"for γ = {_spans(together)} rad; the {chosen:g} rad chosen {'lies' if fits else 'does not lie'} within"
        if together
        else "for no slenderness"
    )
    return (
        "The paper does not print the slenderness. With this motion its three claims (free-standing overturns, "
        f"vulnerable below T_r of about 4 s, isolated does not rock) hold together {where}."
    )


def _benefit_text(result):
    rows = _rows(result, "benefit")
    others = rows[1:]
    better, worse, within = (
        (percent(rows[0][key]), percent(sum(row[key] for row in others) / len(others)))
        for key in (CATEGORIES[ONLY_ISOLATED], CATEGORIES[ONLY_FREE], WITHIN)
    )
    first = {(row["scene"], row["what"]): number(row["first"]) for row in _rows(result, "critical intensity")}
    return (
        "Over slenderness 0.1 to 0.45 rad and intensity 0.25 to 3, isolation decides for the better in "
        f"{better[0]} and for the worse in {worse[0]} of the map with this motion; over {len(others)} synthetic "
        f"motions in {better[1]} and {worse[1]} on average. Where the bearings stay inside their 0.30 m it is for "
        f"the better in {within[0]} and {within[1]}. The Caryatid first overturns at {first[FREE, 'overturns']} "
        f"times the motion free-standing and at {first[ISOLATED, 'overturns']} times isolated, where it lifts from "
        f"{first[ISOLATED, 'lifts']} on; its bearings reach 0.30 m at {first[ISOLATED, 'exceeds x_max']} times: "
        "beyond that the law describes no built bearing."
    )


def _contact_text(result):
    free, isolated = _rows(result, "contact")

    def both(key, write):
        return f"{write(free[key])} free-standing and {write(isolated[key])} isolated"

    return (
        "No sliding, no jump? The Caryatid itself asks for a friction of "
        f"{both('friction_demand', number)} (runs that overturn: until the tilt first "
        "reaches γ); its normal force never falls below "
        f"{both('min_normal_ratio', number)}, over m g. Over the map a friction of 0.5 is not enough in "
        f"{both('friction above 0.5', percent)}; the normal force vanishes, a jump, in {both('jumps', percent)}. "
        f"An impact by itself asks for {both('impact_friction', number)}, at any speed."
    )


def _cost_text(result):
    words = []
    for row in _rows(result, "cost"):
        if row["ratio"] is not None:
            words.append(
                f"{row['solver']} ({row['what']}) {number(row['ratio'], 3)} "
                f"[{number(row['ratio_low'], 3)} to {number(row['ratio_high'], 3)}]"
            )
    cheaper = [row for row in _rows(result, "cost") if row["ratio_high"] is not None and row["ratio_high"] < 1]
    verdict = (
        "in none of these settings is the algebraic law the cheaper one beyond the spread"
        if not cheaper
        else "the algebraic law is the cheaper one beyond the spread in: "
        + ", ".join(f"{row['solver']} ({row['what']})" for row in cheaper)
    )
    return (
        "The cost claim: CPU time of the algebraic bearing over that of a Bouc-Wen bearing of the same f₀, k_a, "
        f"k_b, at equal error, median and 10 to 90 % of rounds: {'; '.join(words)}. So {verdict}. The Bouc-Wen law "
        "here is the simplest one, linear in z: a multiplication where the algebraic law raises to a power. Laws "
        "with other exponents, or solved by iteration in each step, are not measured here."
    )


def _run_table(result):
    rows = []
    for row in result.rows:
        if row["part"] == "run":
            what = f"{row['scene']} Caryatid"
        elif row["part"] == "rocking spectrum":
            what = f"Fig. 5(a), T_r = {row['period']:.3f} s"
        elif row["part"] == "displacement spectrum":
            what = f"Fig. 5(b), T_bi = {row['period']:g} s, ξ = {percent(row['damping'])}"
        else:
            continue
        if row["outcome"] == "failed":
            rows.append([what, row["solver"], "failed: " + row["failure"]["reason"], *["–"] * 6])
            continue
        rows.append(
            [
                what,
                row["solver"],
                row["outcome"],
                number(row["overturning_time"], 5),
                number(row["peak_tilt_ratio"], 4),
                number(row["peak_base_displacement"], 5),
                number(row["friction_demand"], 3),
                number(row["min_normal_ratio"], 3),
                number(row["cpu_seconds"], 2),
            ]
        )
    heads = (
        "scene",
        "solver",
        "outcome",
        "overturning time [s]",
        "peak |φ|/γ [-]",
        "peak displacement [m]",
        "friction demand [-]",
        "least N/(m g) [-]",
        "CPU time [s]",
    )
    return Table("All runs", heads, rows)


def _claim_table(result):
    rows = [[row["claim"], _spans(row["intervals"])] for row in _rows(result, "claim")]
    rows.append(["check: atan(max|a|/g) on the bearings", f"from {result.settings['uplift_slenderness']:.4f}"])
    return Table("Slendernesses that fit the paper's claims", ("claim", "holds for γ [rad]"), rows)


def _critical_table(result):
    return Table(
        "The Caryatid at other intensities: times the motion at which its state changes",
        ("scene and what", "first at [-]", "all changes [-]"),
        [
            [
                f"{row['scene']} {row['what']}",
                number(row["first"], 4),
                ", ".join(f"{value:.3f}" for value in row["changes"]) or "none up to 4",
            ]
            for row in _rows(result, "critical intensity")
        ],
    )


def _seed_table(result):
    keys = {
        **{text: text for text in (*CATEGORIES, WITHIN)},
        "isolated lifts": "isolated lifts",
        "beyond x_max": "isolated upright beyond 0.30 m",
    }
    rows = [[row["motion"], *(number(100 * row[key], 3) for key in keys)] for row in _rows(result, "benefit")]
    return Table(
        "Share of the map over slenderness and intensity", ("motion", *(f"{text} [%]" for text in keys.values())), rows
    )


def _contact_table(result):
    return Table(
        "No sliding, no jump: the Caryatid, and share of the map over slenderness and intensity",
        (
            "scene",
            "friction demand [-]",
            "least N/(m g) [-]",
            "friction of an impact [-]",
            *(f"friction above {limit:g} [% of map]" for limit in FRICTION_LIMITS),
            "N ≤ 0 [% of map]",
        ),
        [
            [
                row["scene"],
                number(row["friction_demand"], 3),
                number(row["min_normal_ratio"], 3),
                number(row["impact_friction"], 3),
                *(number(100 * row[f"friction above {limit:g}"], 3) for limit in FRICTION_LIMITS),
                number(100 * row["jumps"], 2),
            ]
            for row in _rows(result, "contact")
        ],
    )


def _cost_table(result):
    rows = []
    for row in _rows(result, "cost"):
        cpu = [number(times[-1], 2) for times in row["cpu_seconds"]]
        at = (
            "equal by construction"
            if row["errors"] is None
            else (
                ", ".join(number(error, 1) for error in row["at_errors"])
                if row["at_errors"]
                else " and ".join(number(errors[-1], 1) for errors in row["errors"])
            )
        )
        rows.append(
            [
                row["solver"],
                row["what"],
                at,
                *cpu,
                number(row["ratio"], 3),
                f"{number(row['ratio_low'], 3)} to {number(row['ratio_high'], 3)}",
                str(row["ratios"]),
            ]
        )
    return Table(
        "Algebraic against Bouc-Wen bearing: CPU time at equal error (relative to the peak displacement)",
        (
            "solver",
            "how",
            "error [-]",
            "algebraic, finest [s]",
            "Bouc-Wen, finest [s]",
            "ratio, median [-]",
            "10 to 90 %",
            "rounds and errors",
        ),
        rows,
    )
