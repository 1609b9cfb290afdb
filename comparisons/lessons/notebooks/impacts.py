import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="Why impacts lose speed")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("impacts")
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
    from analytic import Block, Scene, Start, simulate

    statue = Block(mass=3172.05, radius=1.0884, slenderness=0.28)  # kg, m, rad
    response = simulate(Scene(block=statue, start=Start(tilt=0.8 * 0.28)))
    first = response.impacts[0]
    found = first.rate_after / first.rate_before
    found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
