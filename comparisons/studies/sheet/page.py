"""What is shown of the sheet study."""

from ...running.provenance import Result
from ...showing.parts import NAME, Column, Page, grouped, table, where
from ...showing.wording import USABLE


def page(result: Result) -> Page:
    scenes = result.settings["scenes"]
    rows = [
        {"name": name, **dict.fromkeys(scenes), **{row["scene"]: _error(row) for row in own}}
        for (name,), own in grouped(result.rows, NAME.text).items()
    ]
    for row in rows:
        within = all(isinstance(row[scene], float) and row[scene] <= USABLE for scene in scenes)
        row["within"] = "yes" if within else "no"
    right = where(rows, within="yes")
    exact = {"name": "the exact answers themselves", "within": "–", **result.settings["own_error"]}
    return Page(
        f"The problem sheet: {len(right)} of {len(rows)} variants are within {USABLE:g} in all {len(scenes)} scenes",
        (
            "Scenes stated as equations and numbers, for codes that are not ours (rocking sheet, rocking score), here "
            "solved by the engines at default levels. Error: the largest of a scene’s answers, over the scale of "
            "each. The exact answers’ own is the largest difference to another tolerance and to a second "
            "implementation.",
        ),
        more=(
            table(
                "Largest error of a scene’s answers [-]",
                [*rows, exact],
                Column("engine, variant", "name"),
                Column(f"all within {USABLE:g}", "within"),
                *(Column(scene, scene) for scene in scenes),
            ),
            table(
                "The scenes",
                [{"name": name, "title": title} for name, title in scenes.items()],
                Column("scene", "name"),
                Column("what it is", "title"),
            ),
        ),
    )


def _error(row):
    """The largest error, or why there is none."""
    if row["failure"]:
        return "failed"
    return f"{len(row['missing'])} missing" if row["missing"] else row["error"]
