import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="What an engine does at a corner")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("corner")
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
    import numpy as np

    from analytic import simulate
    from analytic.time_stepping import simulate_time_stepping
    from comparisons.lessons.engine_runs import SCENE

    exact = simulate(SCENE, history=False).impacts[0].time
    steps = np.linspace(4e-3, 5e-3, 41)  # s
    shifts = [simulate_time_stepping(SCENE, step=step).impacts[0].time - exact for step in steps]
    found = 1e3 * max(abs(shift) for shift in shifts)  # ms
    found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
