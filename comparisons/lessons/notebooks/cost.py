import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="Speed against error")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("cost")
    mo.md(notebook.opening(LESSON))
    return LESSON, mo, notebook


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    controls = notebook.controls(LESSON, mo)
    mo.vstack(controls.elements)
    return (controls,)


@app.cell(hide_code=True)
def picture(LESSON, controls, mo, notebook):
    notebook.place(LESSON, controls.value, mo)
    return


@app.cell(hide_code=True)
def _(mo):
    mo.md("## In a few lines\n\nChange a number; what hangs on it follows.")
    return


@app.cell
def code():
    from comparisons.lessons.engine_runs import engine_runs, own_runs
    from comparisons.lessons.topics.cost import TARGET, model_runs, trusted

    best = trusted((*model_runs(), *own_runs(), *engine_runs()), TARGET)
    found = len(best)
    {name: (f"{run.knob} = {run.value:g}", f"{1e3 * run.cpu:.3g} ms") for name, run in best.items()}
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
