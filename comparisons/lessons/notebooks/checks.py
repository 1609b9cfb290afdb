import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="How to check a simulation")


@app.cell(hide_code=True)
def _():
    import marimo as mo

    from comparisons.lessons import notebook
    from comparisons.lessons.topics import lesson

    LESSON = lesson("checks")
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
    from analytic import Base, Block, Scene
    from analytic.rocking import base_jump_length_as_printed, restitution

    on_base = Scene(block=Block(mass=3172.05, radius=1.0884, slenderness=0.28), base=Base(mass=212.0))
    block, rate = on_base.block, -0.8  # rad/s
    before = block.mass * block.half_height * rate
    kept = block.mass * block.half_height * restitution(on_base) * rate
    pushed = -on_base.total_mass * base_jump_length_as_printed(on_base) * rate
    found = 100 * abs((kept + pushed) / before - 1)  # %
    found
    return (found,)


@app.cell(hide_code=True)
def _(LESSON, mo, notebook):
    notebook.closing(LESSON, mo)
    return


if __name__ == "__main__":
    app.run()
