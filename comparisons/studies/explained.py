"""What a column of a study's rows is said to be, and the columns that several studies have."""

from functools import partial
from typing import NamedTuple

TYPES = {
    "number": (int, float),
    "whole number": (int,),
    "word": (str,),
    "flag": (bool,),
    "list": (list,),
    "table": (dict,),
}  # of JSON


class Explained(NamedTuple):
    """What a column is, its unit, and its type: of `TYPES`, or several, as "number or word"."""

    what: str
    unit: str = "-"
    type: str = "number"

    def holds(self, value: object) -> bool:
        """Whether a value, other than null, is of the column's type."""
        return any(type(value) in TYPES[one] for one in self.type.split(" or "))


number, word, flag = Explained, partial(Explained, type="word"), partial(Explained, type="flag")
whole, series, table = (partial(Explained, type=name) for name in ("whole number", "list", "table"))

INTERVAL = "interval of {} (95 %, bootstrap over runs): [low, high]"

SHARED = {
    "part": word("what the row is of, among the study's rows"),
    "scene": word("name of the scene, described in the settings"),
    "engine": word('engine, or "analytic", "twin", "time-stepping", or the name of another integrator'),
    "variant": word("variant of the engine; empty where there is one only"),
    "tier": word("kind of the variant: defaults, tuned or assisted"),
    "level": number("value of the variant's accuracy parameter", "of the parameter, see settings"),
    "ground": word("what the block stands on: rigid ground, or a base"),
    "slenderness": number("of the block, atan(width/height)", "rad"),
    "runs": whole("runs that the row sums up"),
    "failed": whole("of the runs, those that failed"),
    "lost": whole("missed impacts: strong impacts of the analytic model that the run, or the runs, do not have"),
    "failure": table("why the run failed: kind, reason, message; null where it did not"),
    "kind": word('of a failure: "solver", "exception", "time limit", "crash" or "undecided"'),
    "reason": word("why the run failed, or the value does not exist, in words"),
    "message": word("of a failure: the engine's own words and the evidence"),
    "exit_code": whole("of a failure: of the process that crashed"),
    "time_limit": number("of a failure: the time limit it reached", "s"),
    "last_state": table("of a failure: the last finite state; time [s], tilt [rad], displacement [m], their rates"),
    "p_value": number("of McNemar's exact test that outcomes change both ways alike"),
    "both_stand": whole("runs that stand in the model and in the engine"),
    "both_overturn": whole("runs that overturn in both"),
    "only_a": whole("runs that overturn in the analytic model alone"),
    "only_b": whole("runs that overturn in the engine alone"),
    "comparable": word('"yes", or why no engine is compared in this scene'),
    "class": word('"right", "differs", "failed" or "left out"'),
    "differences": series("in what the run differs from the model, in words"),
    "quantities": series("in what the run differs from the model, by name"),
    "outcome": word("of the run: stands, slides, rocks, overturns or failed"),
    "cpu_seconds": number("CPU time of one run: median over the processes", "s"),
}
