"""A study's plan, answered in this process: by real rows, or by rows of runs that are made up."""

from comparisons.running.study import Batch, Found


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
