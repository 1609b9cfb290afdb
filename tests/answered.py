"""A study's plan, answered in this process: by real rows, or by rows of runs that are made up."""

import dataclasses
import json

from analytic import simulate
from comparisons.execution.plan import Batch, Computed
from comparisons.execution.results import digest_of, write_result
from comparisons.execution.sweep import Done, Executor, Row, lines_of, run_sweep
from comparisons.studies.rows import read_study


class Here(Executor):
    """Runs in this process, one task at a time."""

    slots = 1

    def submit(self, task):
        self.task = task

    def next(self):
        return Done(self.task.ticket, lines_of(self.task))

    def __exit__(self, *_):
        pass


def by_runs(folder):
    """Answers batches by runs in this process, kept in a folder."""
    return lambda batch: run_sweep(
        batch.cases, store=folder / "runs.jsonl", measure=batch.measure, executor=Here(), progress=False
    )


def by_model(scene=lambda case: case.scene, failure=lambda case: None, history=False):
    """Answer batches by the analytic model in each solver's place, on ``scene(case)``; ``failure(case)`` may be one."""

    def row(batch, case):
        response = dataclasses.replace(simulate(scene(case), history=history), engine=case.solver)
        failed = failure(case)
        values = {"outcome": "failed"} if failed else batch.measure(case, response)
        if failed and failed["kind"] == "solver":  # which leaves a whole response, as the executors have it
            values = response.to_json() | values
            del values["failure"], values["cpu_seconds"]
        return Row(case, values, failed, {"cpu_seconds": 0.25} | values.pop("cost", {}), False)

    return lambda batch: [row(batch, case) for case in batch.cases]


def answered(plan, run, most=None):
    """The answers (list of `Computed`), at most so many, of a plan whose batches get ``run(batch)``, a list of rows."""
    answers, rows = [], None
    while len(answers) != most:
        try:
            step = plan.send(rows)
        except StopIteration as stop:
            return [*answers, *([stop.value] if stop.value not in answers else [])]
        rows = None
        if isinstance(step, Computed):
            answers.append(step)
        else:
            assert isinstance(step, Batch)
            rows = run(step)
    return answers


def stored(folder, name, found, **settings):
    """The `Result` of a study's `Computed`, with these `settings` besides, as it comes back from a file in `folder`."""
    settings = {"changed_while_running": [], **found.settings, **settings}
    return read_study(
        write_result(folder / f"{name}.json", name, settings, found.rows, found.arrays, modules=["analytic.errors"])
    )


def edit(path, change):
    """Edit a result file by ``change(its content)``, as one who makes its digest anew; returns the path."""
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps({**content, "digest": digest_of(content)}))
    return path
