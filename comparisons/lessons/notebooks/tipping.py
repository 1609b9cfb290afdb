import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="When does a block tip?")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("tipping")
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
    from math import pi

    from analytic import Block, PulseMotion, Scene, simulate

    statue = Block(mass=3172.05, radius=1.0884, slenderness=0.28)  # kg, m, rad
    pulse = PulseMotion("one-sine", amplitude=0.4 * 9.81, frequency=2 * pi / 0.8)  # m/s2, rad/s
    response = simulate(Scene(block=statue, motion=pulse))
    found = response.peak_tilt_ratio
    response.outcome, found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
