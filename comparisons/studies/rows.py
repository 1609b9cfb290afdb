"""What a row of each study has: its columns by `part`, and a result read whose rows are so.

A new column needs a line in `comparisons.studies.vocabulary` alone: a row may then have it. One that a page cannot do
without also stands here, and a result without it is refused.
"""

import shlex
from collections import Counter
from collections.abc import Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from ..running.by_solver import MODEL, engine_of, read
from ..running.provenance import Result, ResultError
from ..running.readable import readable
from .vocabulary import columns_of

SHOWN = 80  # characters of a wrong value
NOTHING = ("failure", "why_not")  # a row that has one of these says why it has no numbers
ERRORS = """runs failed impacts lost bias? rms? worst? rms_state? worst_state? jump_rms? jump_worst? jump_8?
    jump_8_printed? time_rms? cpu_per_second? steps_per_second?"""
PULSE = "engine variant level ground shape frequency amplitude"
EDGE = "ground shape frequency amplitude rises mode low high min_normal"
BOUNDARY = f"{PULSE} rises mode room shift? half_width? reason? runs"
SOUGHT = f"{PULSE} min_normal kind reason message"  # of a boundary, by a run that failed
CHANGED = "runs outcomes_changed? low? high?"
CASE = "case engine variant level? set cpu_seconds? result outcome | outside errors until? impacts steps"
RUN = """engine variant? outcome failure? | scene overturning_time? unstable_time? peak_tilt? peak_tilt_ratio?
    peak_base_displacement? friction_demand? min_normal_ratio? end steps settings versions decided warnings differences
    comparable impact_count"""
# study: part ("" where rows have none): columns of each of its rows; "?": null may stand there. Those behind "|" a row
# without numbers (`NOTHING`) need not have.
ROWS = {
    "restitution": {
        "cell": f"engine variant level ratio? slenderness {ERRORS}",
        "summary": f"scope engine variant ground level {ERRORS}",
        "order": "engine variant ground order?",
        "bearings": """engine variant factor of? runs failed rms_state? jump_rms? jump_worst? time_rms? cpu_per_second?
            impacts lost worst_state?""",
        "experiment": f"engine variant experiment ratio? value {ERRORS}",
        "phase": "engine variant step runs bias rms explained? least most",
        "flight damping": "engine variant friction? level slenderness friction_needed predicted measured",
        "failure": "engine variant reason count message tag",
        "why": "engine variant ground failure? | tier best placed error cause? words? parts steps energy_lost frames",
    },
    "overturning": {
        "edge": EDGE,
        "shift": BOUNDARY,
        "refinement": BOUNDARY,
        "confusion": """engine variant level ground region both_stand both_overturn only_a only_b kappa? kappa_low?
            kappa_high?""",
        "scan": "engine variant level runs failed both_stand both_overturn only_a only_b interval",
        "disagreement": f"{PULSE} min_normal analytic_overturns distance?",
        "failure": SOUGHT,
    },
    "recorded": {
        "scene": """engine variant record component configuration slenderness intensity scale outcome tilt displacement
            comparable horizon""",
        "run": """engine variant tier record component configuration class comparable horizon model_outcome model_tilt
            model_displacement outcome | differences quantities tilt displacement own_horizon tilt_error?
            displacement_error? own_tilt_error? own_displacement_error?""",
        "absent": "engine variant reason",
    },
    "fragility": {
        "fit": """scene state measure size exceeded points median? dispersion? median_interval? dispersion_interval?
            p_value? reason?""",
        "check": "scene engine variant runs undecided failed",
        "run": "scene engine variant seed comparable class quantities? model_overturns overturns?",
        "cost": "scene engine variant runs cpu_per_run?",
        "effect": """scene engine variant state left_out measure both_stand both_overturn only_a only_b p_value
            difference detectable_difference? median_shift? median_interval? dispersion_shift? dispersion_interval?
            detectable_shift? reason? p_holm""",
        "failure": "scene engine variant seed kind reason message",
    },
    "shake-table": {
        "score": """engine variant specimen forecast judged size right low high misses false_alarms brier?
            brier_interval?""",
        "fit": """engine variant specimen change slenderness centre spread alone_right neighbours size right brier
            brier_interval misses false_alarms""",
        "paired": """engine variant specimen forecast beside difference interval more_right more_interval disagree
            right""",
        "engine": """engine variant tier specimen size failed both_stand both_overturn only_a only_b p_value?
            records_a records_b p_records? near on_edge equal interval right? low? high? misses? false_alarms?
            model_right? tilt?""",
        "failure": "engine variant specimen test kind reason message",
        "absent": "engine variant reason",
    },
    "sensitivity": {
        "change": f"scene engine variant change? failed to_overturning? p_value? tilt? displacement? {CHANGED}",
        "vertical": f"scene faster ratio lifts_off {CHANGED}",
    },
    "statues": {
        "cell": """engine variant support motion friction runs failed undecided moves lacking slides falls_without saved
            overturned""",
        "scene": "engine variant index support motion friction slenderness raised outcome comparable slip tilt",
        "run": "engine variant tier index friction? class comparable | differences quantities",
        "drawn edge": f"{EDGE} slenderness radius base_mass? law? period?",
        "drawn shift": BOUNDARY,
        "failure": SOUGHT,
    },
    "stability": {"default settings": CASE, "finer settings": CASE},
    "speed-error": {
        "work-precision": """scene engine variant model law? parameter? level? outcome? failure? timings errors lost?
            repeatable | cpu_seconds cpu_low cpu_high simulated steps? step? cpu_per_second cpu_per_step?
            boundary_shifts? settings"""
    },
    "caryatid": {
        "value": "where quantity engine? paper study difference? status note",
        "misprint": "where printed corrected measure value_corrected value_printed",
        "equation": "number what status check value",
        "run": f"scene {RUN}",
        "rocking spectrum": f"period {RUN}",
        "displacement spectrum": f"period damping {RUN}",
        "equivalent": "definition damping period displacement nonlinear",
        "claim": "claim intervals evaluations?",
        "vulnerable": "slenderness step period",
        "benefit": """motion cells 'both stay upright' 'only the isolated one does' 'only the free-standing one does'
            'both overturn' 'only the isolated one does, within 0.30 m' 'isolated lifts' 'beyond x_max'""",
    },
    "tolerances": {"tolerance": "quantity engine variant scenes bound? unit measured? source found? holds? failure?"},
    "mistakes": {
        "run": """engine variant scene mistake? done? group? expected outcome reason? error? energy? graph?
            displacement? steps?"""
    },
}


def read_study(path: str | PathLike[str], name: str | None = None) -> Result:
    """The `Result` at `path`, a folder of files by solver or one file, its rows such as its study writes; those of
    another package's study are not looked at. name: of the study that it must be of.

    Raises
    ------
    ResultError
        As `by_solver.read`; or it is of another study, or a row is not as it should be.
    """
    result, file = read(path), Path(path).name
    if name not in (None, result.kind):
        raise ResultError(f"{file}: a result of {result.kind}; give one that rocking study {name} wrote")
    place: Counter[str] = Counter()
    for row in result.rows if result.kind in ROWS else ():
        who = engine_of(row)
        solver = who if who in result.provenance.get("engines", ()) else MODEL
        place[solver] += 1
        if wrong := wrong_with(row, result.kind):
            whose = f"{file}/{solver}.json" if Path(path).is_dir() else file
            raise ResultError(f"{whose}, row {place[solver]}: {wrong}; run rocking study {result.kind} again")
    return result


def wrong_with(row: Mapping[str, Any], kind: str) -> str | None:
    """What is wrong with a row of the study `kind`, in words; None if nothing is."""
    known, part = columns_of(kind), row.get("part", "")
    if part not in list(ROWS[kind]):
        return f"part = {_shown(part)} is none of {', '.join(ROWS[kind])}"
    always, numbers = _columns(kind, part)
    for name, null in (always if any(row.get(name) for name in NOTHING) else always | numbers).items():
        if name not in row:
            return f"column {name!r} is missing"
        if row[name] is None and not null:
            return f"column {name!r} is null"
    for name, value in row.items():
        if name not in known:
            return f"column {name!r} = {_shown(value)} is none of this study"
        if value is not None and not known[name].holds(value):
            return f"column {name!r} = {_shown(value)} is no {known[name].type}"
    return None


@cache
def _columns(kind, part):
    """The columns of a part, {name: whether null may stand there}: those of each row, those of a row with numbers."""
    words = shlex.split(ROWS[kind][part])
    bar = words.index("|") if "|" in words else len(words)
    return [{word.removesuffix("?"): word.endswith("?") for word in some} for some in (words[:bar], words[bar + 1 :])]


def _shown(value):
    return readable(repr(value), SHOWN)
