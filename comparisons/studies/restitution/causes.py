"""What is shown of the causes of errors, each changed alone, and of eq. (8)."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from ...measuring.errors import rms
from ...running.provenance import Result
from ...showing.figures import beside, lines
from ...showing.parts import NAME, Column, Figure, Row, Table, grouped, number, percent, setting_of, table, where
from .columns import BASE, CPU, DRAWN_ERROR, ERROR, FAILED, GAMMA, JUMP, MEAN, ground


def causes(result: Result, variants: Mapping[str, Row]) -> Iterator[Figure | Table | str | None]:
    """Experiments that change one suspected cause: step phase, settings, friction, damping in flight."""
    phases, damped = where(result.rows, part="phase"), where(result.rows, part="flight damping")
    points = [
        {**row, "phase": phase, "error": error / row["step"], "by": f"step {1e3 * row['step']:g} ms"}
        for row in phases
        for key in (f"phase/{row['engine']}/{row['variant']}/{row['step']:g}",)
        for phase, error in zip(result.arrays[f"{key}/phase"], result.arrays[f"{key}/error"], strict=True)
    ]
    yield lines(
        points,
        Column("place of the impact within the step [-]", "phase"),
        Column("error of restitution over step [1/s]", "error"),
        "Step phase: with a fixed step the error depends on where in the step the impact falls.",
        panel=NAME.of,
        by="by",
        joined=False,
    )
    yield table(
        "Step phase: a sawtooth of the impact's place within the step, fitted to the error by swings",
        phases,
        NAME,
        Column("step [ms]", lambda row: 1e3 * row["step"]),
        Column("variance explained", "explained", digits=3, percent=True),
        Column("least error [-]", lambda row: row["least"] * row["step"]),
        Column("greatest error [-]", lambda row: row["most"] * row["step"]),
    )
    settings = [{**row, "ground": ground(row)} for row in where(result.rows, part="experiment")]
    changed: dict[str, Any] = dict(panel=lambda row: f"{row['experiment']}: {NAME.of(row)}", by="ground", log="xy")
    needed = [("x", mu, f"{ground}: {number(mu, 2)}") for ground, mu in result.settings["friction_needed"].items()]
    yield beside(
        lines(
            where(settings, experiment="stiffness"),
            Column("contact stiffness [N/m]", "value", digits=None),
            DRAWN_ERROR,
            f"One setting changed alone, at slenderness {result.settings['experiment_slenderness']:g}.",
            **changed,
        ),
        lines(
            where(settings, experiment="friction"),
            Column("friction coefficient [-]", "value", digits=None),
            DRAWN_ERROR,
            "Dashed: friction that the model's impact needs, horizontal over vertical impulse.",
            rules=needed,
            **changed,
        ),
    )
    yield from _damping(damped, variants)
    yield table(
        "One setting changed at a time",
        settings,
        Column("experiment", "experiment"),
        NAME,
        BASE,
        Column("value (SI)", "value", digits=None),
        ERROR,
        MEAN,
        JUMP,
        Column("against (8) corrected [-]", "jump_8"),
        Column("as printed [-]", "jump_8_printed"),
        CPU,
        FAILED,
    )
    sought = {row["engine"] for row in (*phases, *damped, *result.settings["experiments"])}
    if without := [engine for engine in result.settings["engines"] if engine not in sought]:
        yield (
            f"No cause was looked for in {', '.join(without)}: that takes a setting beside the accuracy parameter that "
            "the engine's record names as one to change alone, or a tuned variant with a fixed step."
        )


def _damping(damped, variants):
    """Blocks that need more friction than the variant's slide: they are in the table only."""
    rows = [{**variants[NAME.of(row)], **row, "whose": NAME.of(row)} for row in damped]
    stick = [row for row in rows if row["friction"] is None or row["friction_needed"] < row["friction"]]
    predicted = [
        {**same[0], "engine": "analytic", "by": "damped as it is", "error": same[0]["predicted"]}
        for same in grouped(stick, "whose", "slenderness").values()
    ]
    yield lines(
        [*predicted, *({**row, "error": row["measured"], "by": setting_of(row)} for row in stick)],
        GAMMA,
        Column("mean error of restitution [-]", "error"),
        "Damping in flight, built into the engine: the error it gives the model alone, and the error measured, where "
        "the block does not slide.",
        panel="whose",
        by="by",
    )
    yield table(
        "Damping in flight, on rigid ground",
        rows,
        NAME,
        Column("setting", setting_of),
        GAMMA,
        Column("predicted by the damping alone [-]", "predicted", digits=3),
        Column("measured [-]", "measured", digits=3),
        Column("friction needed [-]", "friction_needed"),
        Column("friction there [-]", "friction"),
    )


def equation_8(result: Result, cells: Iterable[Row], ratings: Mapping[str, Row]) -> Iterator[Figure | None]:
    """The base velocity jump against both forms, over slenderness and over the block's size."""
    forms = {"jump_8": "(8) corrected", "jump_8_printed": "(8) as printed"}
    defaults = result.settings["default_variants"]
    own = [row for row in cells if defaults[row["engine"]] == row["variant"] and row["jump_8"] is not None]
    sizes = [row for row in where(result.rows, experiment="size") if row["jump_8"] is not None]
    over_slenderness = [
        {"engine": engine, "slenderness": gamma, "error": rms([row[form] for row in rows]), "by": words}
        for form, words in forms.items()
        for (engine, gamma), rows in grouped(own, "engine", "slenderness").items()
    ]
    over_size = [{**row, "error": row[form], "by": words} for form, words in forms.items() for row in sizes]
    trusted = [row for row in sizes if ratings[NAME.of(row)]["rating"] == "may be trusted"]
    found = [percent(max((row[form] for row in trusted), default=None)) for form in forms]
    jump = Column("jump over eq. (8), less 1, rms [-]", "error")
    size = Column("size of the block R [m]", lambda row: row["value"] * result.settings["radius"])
    yield beside(
        lines(over_slenderness, GAMMA, jump, "Base velocity jump against eq. (8).", by="by", log="y"),
        lines(
            over_size,
            size,
            jump,
            f"Over the block's size, in the variants that may be trusted, it is off by at most {found[0]} from the "
            f"corrected form and by up to {found[1]} from the printed one, which has a factor R cos γ [m] too many. "
            "The engines know nothing of the equation.",
            by="by",
            log="xy",
        ),
    )
