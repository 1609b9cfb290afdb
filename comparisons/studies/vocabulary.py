"""What the columns of the studies' rows are: {column: (what it is, unit)}, those of all studies and each one's own.

    columns = columns_of("restitution")
    frame = pandas.DataFrame(read_result("restitution.json").rows)  # or any other table library
    print(columns["rms"])  # ("error of restitution by swing energies: root mean square over impacts", "-")

Unit "-": a number without one, a word, or a part with units of its own. A row has the columns of its `part`; what is
not known, or does not exist, is null. Nothing here is part of what a result depends on.
"""

from __future__ import annotations

from typing import NamedTuple


class Explained(NamedTuple):
    """What a column is, and its unit."""

    what: str
    unit: str = "-"


INTERVAL = "interval of {} (95 %, bootstrap over runs): [low, high]"

SHARED = {
    "part": Explained("what the row is of, among the study's rows"),
    "scene": Explained("name of the scene, described in the settings"),
    "engine": Explained('engine, or "analytic", "twin", "time-stepping", or the name of another integrator'),
    "variant": Explained("variant of the engine; empty where there is one only"),
    "tier": Explained("how much of the scene the adapter imposes: defaults, tuned or assisted"),
    "level": Explained("value of the variant's accuracy parameter", "of the parameter, see settings"),
    "ground": Explained("what the block stands on: rigid ground, or a base"),
    "slenderness": Explained("of the block, atan(width/height)", "rad"),
    "runs": Explained("runs that the row sums up"),
    "failed": Explained("of the runs, those that failed"),
    "lost": Explained("strong impacts of the analytic model that the run, or the runs, do not have"),
    "failure": Explained("why the run failed: kind, reason, message; null where it did not"),
    "kind": Explained('of a failure: "solver", "exception", "time limit", "crash" or "undecided"'),
    "reason": Explained("why the run failed, or the value does not exist, in words"),
    "message": Explained("of a failure: the engine's own words and the evidence"),
    "last_state": Explained("of a failure: the last finite state; time [s], tilt [rad], displacement [m], their rates"),
    "p_value": Explained("of McNemar's exact test that outcomes change both ways alike"),
    "both_stand": Explained("runs that stand in the model and in the engine"),
    "both_overturn": Explained("runs that overturn in both"),
    "only_a": Explained("runs that overturn in the analytic model alone"),
    "only_b": Explained("runs that overturn in the engine alone"),
    "kappa": Explained("Cohen's kappa of the outcomes"),
    "timings": Explained("fresh processes in which the run was timed"),
    "repeatable": Explained("whether all of them gave the same numbers, bit for bit"),
    "cpu_seconds": Explained("CPU time of one run: median over the processes", "s"),
    "cpu_low": Explained("CPU time of one run: least", "s"),
    "cpu_high": Explained("CPU time of one run: most", "s"),
}

OWN: dict[str, dict[str, Explained]] = {
    "restitution": {
        "ratio": Explained("base mass over block mass; null: rigid ground"),
        "scope": Explained('of a summary: "all" cells at the default level, or the "ladder" of levels'),
        "impacts": Explained("strong impacts with a known error"),
        "bias": Explained("error of restitution by swing energies, e less eq. (7): mean over impacts"),
        "rms": Explained("error of restitution by swing energies: root mean square over impacts"),
        "worst": Explained("error of restitution by swing energies: largest absolute value"),
        "rms_state": Explained("error of restitution by the states at impacts: root mean square"),
        "jump_rms": Explained("error of the base's velocity jump against momentum, relative: root mean square"),
        "jump_worst": Explained("error of the base's velocity jump against momentum, relative: largest"),
        "jump_8": Explained("error of the base's velocity jump against eq. (8) corrected, relative: root mean square"),
        "jump_8_printed": Explained("the same against eq. (8) as printed"),
        "time_rms": Explained("error of impact times, relative: root mean square"),
        "cpu_per_second": Explained("CPU time over simulated time"),
        "steps_per_second": Explained("steps over simulated time", "1/s"),
        "order": Explained("slope of log error over log accuracy parameter"),
        "experiment": Explained("setting that is varied by itself"),
        "value": Explained("of that setting", "of the setting"),
        "step": Explained("step size", "s"),
        "explained": Explained("share of the error's variance that the phase within a step explains"),
        "least": Explained("end of that sawtooth nearer to zero, error over step", "1/s"),
        "most": Explained("its other end, error over step", "1/s"),
        "friction": Explained("coefficient of friction of the variant"),
        "friction_needed": Explained("max |H|/N in the analytic model"),
        "predicted": Explained("error of restitution by damping in flight, computed"),
        "measured": Explained("error of restitution that was measured"),
        "count": Explained("runs that failed for this reason"),
        "tag": Explained("which the first of these runs was"),
    },
    "overturning": {
        "shape": Explained("of the pulse"),
        "frequency": Explained("of the pulse over omega_r"),
        "amplitude": Explained("of the pulse over g tan(slenderness)"),
        "rises": Explained("whether overturning lies above the boundary"),
        "mode": Explained("impacts before overturning"),
        "low": Explained("amplitude half way to the boundary below"),
        "high": Explained("amplitude half way to the boundary above"),
        "min_normal": Explained("least N/(m g) of the analytic model; below 0 it holds the corner down"),
        "room": Explained("relative distance to the nearer of low and high"),
        "shift": Explained("of the engine's boundary from the model's, relative"),
        "half_width": Explained("of the bracket in which that boundary lies, relative"),
        "runs": Explained("runs that the search took"),
        "region": Explained('of a confusion: "scan", or "outside", "inside" the band, "held down" where N < 0'),
        "kappa_low": Explained("lower end of kappa's 95 % interval"),
        "kappa_high": Explained("upper end of kappa's 95 % interval"),
        "analytic_overturns": Explained("whether the block overturns in the analytic model"),
        "distance": Explained("from the nearest boundary of the analytic model, relative"),
    },
    "fragility": {
        "state": Explained("limit state"),
        "measure": Explained("intensity measure"),
        "size": Explained("runs that failed in no solver compared"),
        "exceeded": Explained("of these, runs beyond the limit state"),
        "points": Explained("shares beyond it in classes of intensity, with 95 % Wilson intervals"),
        "median": Explained("of the lognormal curve", "of the measure"),
        "dispersion": Explained("of the lognormal curve: standard deviation of ln(intensity)"),
        "median_interval": Explained(INTERVAL.format("the median, or of its shift"), "of the measure, or -"),
        "dispersion_interval": Explained(INTERVAL.format("the dispersion, or of its shift")),
        "p_value": Explained("of the curve's fit, or of McNemar's exact test of the outcomes"),
        "best": Explained("whether the measure has the least dispersion of its state"),
        "ratio_interval": Explained(INTERVAL.format("the dispersion over that of the best measure")),
        "undecided": Explained("runs that ended before their outcome was certain"),
        "cpu_per_run": Explained("CPU time: mean", "s"),
        "left_out": Explained("runs that failed in one of the two"),
        "difference": Explained("of the shares beyond the limit state, engine less model"),
        "detectable_difference": Explained("that the test would have found with 80 % probability"),
        "kappa_interval": Explained("95 % interval of kappa: [low, high]"),
        "differ": Explained("whether outcomes differ at the level 0.05"),
        "statement": Explained("the comparison in words"),
        "median_shift": Explained("median of the engine over that of the model"),
        "dispersion_shift": Explained("dispersion of the engine over that of the model"),
        "detectable_shift": Explained("ratio of medians that the test would have found with 80 % probability"),
        "p_holm": Explained("p_value adjusted over limit states, by Holm"),
        "seed": Explained("of the synthetic motion"),
    },
    "matters": {
        "change": Explained("how the scene was changed; null: an engine in place of the model"),
        "outcomes_changed": Explained("runs with another outcome than before the change"),
        "to_overturning": Explained("of these, runs that overturn only after it"),
        "low": Explained("lower end of the 95 % Wilson interval of their share"),
        "high": Explained("upper end of the 95 % Wilson interval of their share"),
        "tilt": Explained("relative change of the peak tilt of blocks that stay upright: median"),
        "displacement": Explained("relative change of the peak base displacement: median"),
        "faster": Explained("how many times as fast as the horizontal motion the vertical one is"),
        "ratio": Explained("peak vertical over peak horizontal acceleration"),
        "lifts_off": Explained("runs in which N reaches zero"),
        "sliding": Explained("{coefficient of friction: runs that need more}"),
        "record": Explained("file of a recorded triple"),
        "outcomes_changed_by_turning": Explained("runs with another outcome after a turn of the record"),
    },
    "speed-error": {
        "model": Explained("how the engine's model stands for the scene"),
        "law": Explained("of the bearings"),
        "parameter": Explained("accuracy parameter whose value is the level"),
        "outcome": Explained("of the run: stands, rocks, overturns or failed"),
        "errors": Explained(
            "by measure: restitution, boundary_shift, peak_displacement [-]; peak_tilt, end_tilt [slenderness]; "
            "impact_time [s]"
        ),
        "simulated": Explained("simulated time", "s"),
        "steps": Explained("steps of the run"),
        "step": Explained("mean step size", "s"),
        "cpu_per_second": Explained("CPU time over simulated time"),
        "cpu_per_step": Explained("CPU time over steps", "s"),
        "boundary_shifts": Explained("of the boundary of overturning from the reference's, relative, run by run"),
        "settings": Explained("all settings of the run"),
        "against": Explained("what the cost grows with: duration [s], or samples of the motion [1/s]"),
        "value": Explained("of what it grows with", "s or 1/s"),
        "traced_bytes": Explained("peak of what Python and numpy allocate during the run", "byte"),
        "resident_bytes": Explained("rise of the process's resident memory during the run", "byte"),
    },
    "surface": {
        "half": Explained("peak ground acceleration at which half of the motions overturn the block", "g"),
        "interval": Explained("95 % interval of it: [low, high]", "g"),
        "falls_by": Explained("by how much the share that overturns falls again above a lower intensity, at most"),
        "widest": Explained("width of the share's 95 % Wilson interval, at most"),
    },
    "random-scenes": {
        "index": Explained("number of the scene in its ensemble"),
        "class": Explained('"right", "differs", "failed" or "left out"'),
        "comparable": Explained('"yes", or why the run is not compared with the analytic model'),
        "differences": Explained("in what the run differs from the model, in words"),
        "quantities": Explained("in what the run differs from the model, by name"),
    },
    "kernel": {
        "problem": Explained("of which run: a problem, or a work of the kernel"),
        "tolerance": Explained("relative tolerance asked for"),
        "expected_impacts": Explained("impacts of the reference"),
        "impacts": Explained("impacts found"),
        "error": Explained("of the tilt at the horizon against the reference, over the slenderness"),
        "overturned": Explained("share of runs that overturn"),
        "elapsed_seconds": Explained("elapsed time of one run: median over the processes", "s"),
        "elapsed_low": Explained("elapsed time of one run: least", "s"),
        "elapsed_high": Explained("elapsed time of one run: most", "s"),
    },
}


def columns_of(kind: str) -> dict[str, Explained]:
    """{column: what it is, and its unit} of the rows of a study; of another package's, those of all studies."""
    return SHARED | OWN.get(kind, {})
