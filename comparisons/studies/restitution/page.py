"""The restitution study as a section of the report: words and tables from its result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.parts import Section, Table, figure_of, number, percent
from ...showing.wording import TRUSTED, USABLE, trust
from .figures import UNITS, by_variant, figures, knob_of, select

if TYPE_CHECKING:
    from ...running.provenance import Result

RULE = (
    f"An engine may be trusted for restitution if its error, root mean square, is at most {TRUSTED:g} on both "
    f"grounds and no run failed; at most {USABLE:g} it is usable where a per cent does not matter. At their default "
    "settings: "
)
CAPTIONS = {
    "maps": (
        "Error of restitution of every engine and variant over slenderness and base mass.",
        "Error of restitution at default settings, root mean square over all starts and impacts. Numbers in "
        "cells: runs that failed, of those made; they are not part of the error. White: no impact to measure.",
    ),
    "jump-maps": (
        "Error of the base velocity jump of every engine and variant over slenderness and base mass.",
        "Error of the base velocity jump against conservation of momentum, at default settings, relative, "
        "root mean square. White: no impact to measure.",
    ),
    "cost": (
        "Error of restitution against the accuracy knob and against CPU time, on rigid ground and on a sliding base.",
        "Error of restitution along each variant's accuracy knob (named in the legend), and the CPU time "
        "of the same runs. Low and left is better.",
    ),
    "causes": (
        "Experiments on the cause of the error, where an engine has one: phase of the step, contact stiffness, "
        "friction, damping in flight.",
        "What causes the error, one suspect at a time.",
    ),
    "eq8": (
        "Base velocity jump against eq. (8), corrected and as printed.",
        "The engines' base velocity jump against eq. (8): corrected (filled) and as printed (open). The printed "
        "form has a factor R cos γ [m] too many; only for blocks of about 1 m does that hide.",
    ),
}


def section_of(result: Result) -> Section:
    """The `Section` of a `Result` of the restitution study."""
    settings = result.settings
    defaults = [row for row in select(result, "summary", scope="all")]
    text = [_setting_words(settings), RULE + _sorted_words(result), *_cause_words(result), *_equation_words(result)]
    tables = [_verdict_table(result), _default_table(defaults), _ladder_table(result), _experiment_table(result)]
    drawn = [figure_of(figure, *CAPTIONS[name]) for name, figure in figures(result).items()]
    evidence = [
        (
            f"{row['engine']}, {row['variant']}: {row['reason']} ({row['count']} runs)",
            f"{row['message']}\n\nfirst seen: {row['tag']}\nlast finite state: {row['last_state']}",
        )
        for row in select(result, "failure")
    ]
    return Section(
        "Restitution: error, cause and cost", tuple(text), tuple(tables), tuple(drawn), evidence=tuple(evidence)
    )


def _setting_words(settings):
    gammas, starts = settings["slendernesses"], settings["starts"]
    bases = ", ".join(f"{ratio:.2g}" for ratio in settings["ratios"] if ratio is not None)
    return (
        f"Blocks of slenderness {min(gammas):g} to {max(gammas):g} rad are tilted to {min(starts):g} to "
        f"{max(starts):g} of it ({len(starts)} starts) and let go, on rigid ground and on bases of {bases} times "
        f"their mass that slide without friction. The first {settings['impacts']} impacts of each run are "
        "measured. Restitution follows from the energies of the swings before and after an impact, so that "
        "whatever takes energy counts; the base velocity jump is held against momentum with the run's own rates."
    )


def _setting(knob):
    """The default of an accuracy knob with its unit."""
    return f"{knob['knob']} = {number(knob['default'], 2)}{UNITS.get(knob['knob'], '')}"


def _asked(result, knob):
    """(rows of a variant at its default setting, those of them with an error, worst of these or None, failed runs)."""
    rows = select(result, "summary", scope="all", engine=knob["engine"], variant=knob["variant"])
    measured = [row for row in rows if row["rms"] is not None]
    return rows, measured, max((row["rms"] for row in measured), default=None), sum(row["failed"] for row in rows)


def _sorted_words(result):
    """Which variants may be trusted, which are usable, which are not to be."""
    said = {}
    for knob in result.settings["knobs"]:
        rows, _, worst, failed = _asked(result, knob)
        if rows:
            said.setdefault(trust(worst, failed), []).append(_name(knob).replace(",", ""))
    return " ".join(f"{', '.join(names)}: {words.removeprefix('is ')}." for words, names in said.items())


def _verdict_table(result):
    rows = []
    for knob in result.settings["knobs"]:
        found, measured, worst, failed = _asked(result, knob)
        if not found:
            continue
        orders = select(result, "order", engine=knob["engine"], variant=knob["variant"])
        jumps = [row["jump_rms"] for row in measured if row["jump_rms"] is not None]
        by_ground = {row["ground"]: row["rms"] for row in measured}
        rows.append(
            [
                f"{_name(knob)} ({_setting(knob)})" + ("*" if knob["applies_impact"] else ""),
                trust(worst, failed).removesuffix(" where a per cent does not matter"),
                *(number(by_ground.get(ground), 2) for ground in ("rigid ground", "sliding base")),
                number(max((row["worst"] for row in measured), default=None), 2),
                percent(max(jumps)) if jumps else "–",
                ", ".join(number(row["order"], 2) for row in orders if row["order"]) or "–",
                number(max((row["cpu_per_second"] for row in measured), default=None), 2),
                f"{failed} of {sum(row['runs'] for row in found)}, {sum(row['lost'] for row in found)}",
            ]
        )
    return Table(
        "May it be trusted for restitution, at its default setting? (*: its adapter applies eqs (7) and (8) itself)",
        (
            "engine, variant",
            "verdict",
            "error, rms: rigid ground [-]",
            "sliding base [-]",
            "worst impact [-]",
            "base velocity jump off by",
            "power of the knob: both grounds [-]",
            "CPU time per simulated second [s/s]",
            "runs failed, impacts lost [-]",
        ),
        rows,
    )


def _cause_words(result):
    """The causes that the experiments name, and which engines have none of them."""
    phases = [(min(rows, key=lambda row: row["step"]), rows) for rows in by_variant(select(result, "phase"))]
    if phases:
        yield _phase_words(phases)
    for name, words in (("stiffness", _stiffness_words), ("rebound", _rebound_words), ("friction", _friction_words)):
        for rows in by_variant(select(result, "experiment", experiment=name)):
            yield from words(result, rows)
    for rows in by_variant(select(result, "flight damping", slenderness=result.settings["experiment_slenderness"])):
        yield _damping_words(result, rows)
    causes = {row["engine"] for part in ("phase", "flight damping") for row in select(result, part)}
    causes |= {row["engine"] for row in result.settings["experiments"]}
    without = [engine for engine in result.settings["engines"] if engine not in causes]
    if without:
        yield (
            f"No cause was looked for in {', '.join(without)}. That takes a setting beside the accuracy knob that the "
            "engine's record names as one to change alone, or a variant that decides the impact at a fixed step."
        )


def _name(row):
    return f"{row['engine']}, {row['variant']}"


def _phase_words(phases):
    """phases: (row of the finest step, all rows) of each variant."""
    explained = percent(min(row["explained"] for _, rows in phases for row in rows), 3)
    ranges = "; ".join(
        f"{_name(finest)}: {number(finest['least'] * finest['step'], 2)} to "
        f"{number(finest['most'] * finest['step'], 2)} at {number(1e3 * finest['step'], 2)} ms"
        for finest, _ in phases
    )
    return (
        "Step phase. With a fixed step the error depends on where in the step the impact falls: a sawtooth of that "
        f"phase explains {explained} or more of its variance at every step length. Its ends: {ranges}. It "
        "shrinks with the step; a variant that looks ahead makes the step small only where that counts."
    )


def _stiffness_words(result, rows):
    rigid = [row for row in rows if row["ratio"] is None]
    if len(rigid) > 1:
        soft, stiff = rigid[0], rigid[-1]
        yield (
            f"Stiffness. From {number(soft['value'], 1)} to {number(stiff['value'], 1)} N/m per corner the error of "
            f"{_name(soft)} falls from {number(soft['rms'], 2)} to {number(stiff['rms'], 2)} on rigid ground, at "
            f"{number(stiff['cpu_per_second'] / soft['cpu_per_second'], 2)} times the cost."
        )


def _rebound_words(result, rows):
    failed = [row for row in rows if row["failed"]]
    if failed:
        yield (
            f"Contact damping. With a rebound of {number(failed[0]['value'], 1)} m/s (too little damping) "
            f"{failed[0]['failed']} of {failed[0]['runs']} runs of {_name(failed[0])} fail: the corners bounce."
        )


def _friction_words(result, rows):
    rigid = [row for row in rows if row["ratio"] is None]
    needed = result.settings["friction_needed"]["rigid ground"]
    enough = [row["value"] for row in rigid if row["rms"] is not None and row["rms"] <= TRUSTED]
    fails = [row["value"] for row in rigid if row["failed"]]
    yield (
        f"Friction. At slenderness {number(result.settings['experiment_slenderness'], 1)} the "
        f"model's impact needs a friction coefficient of {number(needed, 2)} on rigid ground (horizontal over "
        f"vertical impulse); in {_name(rows[0])} "
        + (f"runs fail at {number(max(fails), 2)} and below, and " if fails else "")
        + (
            f"{number(min(enough), 2)} keeps the error below {number(TRUSTED, 1)}."
            if enough
            else "no value tried keeps the error small."
        )
    )


def _damping_words(result, rows):
    fine, knob = min(rows, key=lambda row: row["value"]), knob_of(result, rows[0])
    return (
        f"Damping in flight. The damping that {_name(fine)} brings unasked, alone, put into the model, gives an "
        f"error of {number(fine['predicted'], 3)} at slenderness {fine['slenderness']:g} on rigid ground; measured "
        f"at {knob} {number(fine['value'], 2)}{UNITS.get(knob, '')}: {number(fine['measured'], 3)}. "
        f"No {knob} cures it. Other slendernesses, which lose more by other causes, are in the figure."
    )


def _equation_words(result):
    deciding = [(knob["engine"], knob["variant"]) for knob in result.settings["knobs"] if not knob["applies_impact"]]
    sizes = [
        row
        for row in select(result, "experiment", experiment="size")
        if row["jump_8"] is not None and (row["engine"], row["variant"]) in deciding
    ]
    if sizes:
        right, wrong = (max(row[key] for row in sizes) for key in ("jump_8", "jump_8_printed"))
        yield (
            f"Eq. (8). Blocks of {number(min(row['value'] for row in sizes), 2)} to "
            f"{number(max(row['value'] for row in sizes), 2)} times the Caryatid's size: the engines' base velocity "
            f"jump agrees with the corrected equation within {percent(right)}, and differs from the printed one by "
            f"up to {percent(wrong)}. The engines, which know nothing of the equation, side with momentum."
        )


def _default_table(rows):
    return Table(
        "Default settings, all slendernesses and bases together",
        (
            "engine, variant, ground",
            "runs, failed [-]",
            "restitution error: mean [-]",
            "rms [-]",
            "worst [-]",
            "rms from tilt rates at the impact [-]",
            "base velocity jump, rms [-]",
            "against (8) as printed [-]",
            "impact times, relative, rms [-]",
            "CPU time per simulated second [s/s]",
        ),
        [
            [
                f"{row['engine']}, {row['variant']}, {row['ground']}",
                f"{row['runs']}, {row['failed']}",
                *(
                    number(row[key], 2)
                    for key in (
                        "bias",
                        "rms",
                        "worst",
                        "rms_state",
                        "jump_rms",
                        "jump_8_printed",
                        "time_rms",
                        "cpu_per_second",
                    )
                ),
            ]
            for row in rows
        ],
    )


def _ladder_table(result):
    knobs = {(knob["engine"], knob["variant"]): knob["knob"] for knob in result.settings["knobs"]}
    return Table(
        "Along the accuracy knobs",
        (
            "engine, variant, ground",
            "setting (SI)",
            "restitution error, rms [-]",
            "base velocity jump, rms [-]",
            "CPU time per simulated second [s/s]",
            "steps per simulated second [1/s]",
            "failed [-]",
        ),
        [
            [
                f"{row['engine']}, {row['variant']}, {row['ground']}",
                f"{knobs[row['engine'], row['variant']]} = {number(row['value'], 3)}",
                *(number(row[key], 2) for key in ("rms", "jump_rms", "cpu_per_second")),
                number(row["steps_per_second"], 3),
                str(row["failed"]),
            ]
            for row in select(result, "summary", scope="ladder")
        ],
    )


def _experiment_table(result):
    return Table(
        "One setting changed at a time",
        (
            "experiment: engine, variant",
            "ground",
            "value (SI)",
            "restitution error, rms [-]",
            "mean [-]",
            "base velocity jump, rms [-]",
            "against (8) corrected, as printed [-]",
            "failed [-]",
        ),
        [
            [
                f"{row['experiment']}: {row['engine']}, {row['variant']}",
                "rigid ground" if row["ratio"] is None else f"base of {row['ratio']:.2g} block masses",
                number(row["value"], 3),
                *(number(row[key], 2) for key in ("rms", "bias", "jump_rms")),
                f"{number(row['jump_8'], 2)}, {number(row['jump_8_printed'], 2)}",
                str(row["failed"]),
            ]
            for row in select(result, "experiment")
        ],
    )
