import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="Two blocks a hair apart")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("chaos")
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

    from analytic import simulate_many
    from comparisons.lessons.topics.chaos import RESTITUTION, scene

    spread = RESTITUTION * (1 + 0.01 * np.linspace(-1, 1, 200))
    crowd = simulate_many([scene().with_(block={"restitution": e}) for e in spread])
    found = 100 * crowd.overturns.mean()  # %
    found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
