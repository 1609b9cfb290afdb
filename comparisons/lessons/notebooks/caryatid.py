import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="The isolated Caryatid")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("caryatid")
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
    from math import tan

    from analytic import load_scene, simulate

    isolated = load_scene("caryatid-isolated")
    response = simulate(isolated)
    found = 100 * (1 - response.peak_base_acceleration / (9.81 * tan(isolated.block.slenderness)))  # %
    response.outcome, found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
