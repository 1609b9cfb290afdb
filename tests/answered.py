"""A study's plan, answered in this process: by real rows, or by rows of runs that are made up."""

from comparisons.running.study import Batch, Found
from comparisons.running.sweep import Serial, run_sweep


def by_runs(folder):
    """Answers batches by runs in this process, kept in a folder."""
    return lambda batch: run_sweep(
        batch.cases, store=folder / "runs.jsonl", measure=batch.measure, executor=Serial(), progress=False
    )


def answered(plan, run, most=None):
    """The answers (list of `Found`), at most so many, of a plan whose batches get ``run(batch)``, a list of rows."""
    answers, rows = [], None
    while len(answers) != most:
        try:
            step = plan.send(rows)
        except StopIteration as stop:
            return [*answers, *([stop.value] if stop.value not in answers else [])]
        rows = None
        if isinstance(step, Found):
            answers.append(step)
        else:
            assert isinstance(step, Batch)
            rows = run(step)
    return answers
