import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="A lead-rubber bearing")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("bearing")
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

    from analytic.bearing import BearingLaw
    from analytic.caryatid import BEARINGS

    law = BearingLaw.of(BEARINGS)
    x = np.concatenate([[0.0], 0.30 * np.cos(np.linspace(0, 2 * np.pi, 20001))])  # m, from rest to a cycle
    force = law.kb * x + law.path(x)  # N, of one bearing
    found = np.trapezoid(force[1:], x[1:])  # J
    found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
