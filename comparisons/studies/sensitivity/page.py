"""The page of the sensitivity study: how often small changes of motion and block change the outcome."""

from ...execution.results import Result
from ...metrics.statistics import wilson
from ...plotting.charts import REFERENCE, Axis
from ...plotting.figures import ranks, shades
from ...plotting.glance import Glance
from ...plotting.parts import Head, Page, grouped, table, where
from ...plotting.wording import listed
from ...schemas.columns import NAME, Column, percent, short
from .study import COLUMNS

LEAST = 5e-4  # share at which smaller shares are drawn
TICKS = ((LEAST, "0"), (0.01, "1 %"), (0.1, "10 %"), (1.0, "100 %"))
BOUNDS = (0.01, 0.03, 0.1, 0.2, 0.3)

SCENE, RUNS = COLUMNS["scene"], COLUMNS["runs"].called("runs")
TOLD = ("motion rotated by 30°", "slenderness ±1 %")  # on the first screen
ROTATED = {"direction turned by 30°": "motion rotated by 30°"}  # {name of a change in rows: its name on the page}
WHAT = Column("change or engine", lambda row: ROTATED.get(row["change"], row["change"]) or NAME.of(row))
SHARE = Column(
    "outcomes changed",
    lambda row: row["outcomes_changed"] / row["runs"] if row["runs"] else None,
    percent=True,
    within=lambda row: row["runs"] and "low" in row and (row["low"], row["high"]),
)
COUNT = Column("runs changed [-]", "{outcomes_changed} of {runs}")
RATIO = COLUMNS["ratio"]
FASTER = COLUMNS["faster"]


def page(result: Result) -> Page:
    """Return the page of a result."""
    ranked = {scene: _ranked(where(result.rows, part="change", scene=scene)) for scene in result.settings["scenes"]}
    defaults, vertical = result.settings["default_variants"], where(result.rows, part="vertical")
    shown = [
        row for rows in ranked.values() for row in rows if defaults.get(row["engine"], row["variant"]) == row["variant"]
    ]
    tables = [
        table(
            f"{scene}: outcomes changed, and median change of peaks where the block stays upright",
            members,
            WHAT,
            SHARE,
            COUNT,
            COLUMNS["to_overturning"],
            COLUMNS["p_value"],
            COLUMNS["tilt"],
            COLUMNS["displacement"],
            COLUMNS["failed"],
        )
        for scene, members in ranked.items()
    ]
    return Page(
        _title(shown),
        (
            "Near the overturning boundary small changes decide the outcome. Each motion and block is changed in one "
            "way at a time; engines run them unchanged. An outcome counts as changed if it differs from that of the "
            "analytic model in the unchanged scene.",
            *(_against_engines(scene, where(shown, scene=scene)) for scene in ranked),
        ),
        first=(
            ranks(
                shown,
                WHAT,
                SHARE,
                "Share of outcomes that each change alters, with 95 % Wilson intervals. Without colour: changes of the "
                "scene in the analytic model. Coloured: the engines’ main variants in the unchanged scene. Arrowhead: "
                "no outcome changed.",
                Axis("outcomes changed", LEAST, 1.0, "log", TICKS),
                panel=lambda row: f"{row['scene']}: outcomes changed",
            ),
            *tables[:1],
        ),
        more=_details(vertical, tables),
        how=_how(result.settings),
    )


def glance(result: Result) -> Glance:
    """Return a sentence for the report's first screen: what else changes the outcomes of the first scene, how often."""
    scene = next(iter(result.settings["scenes"]))
    shares = {WHAT.of(row): SHARE.of(row) for row in where(result.rows, part="change", scene=scene)}
    told = [f"{percent(shares[change])} ({change})" for change in TOLD if shares.get(change)]
    words = f"For comparison, near overturning the model's outcome changes in {listed(told)} of runs ({scene})."
    return Glance(says={"matters": ("", words if told else "")})


def _details(vertical, tables):
    """Parts that only the study's own page shows."""
    return (
        *tables[1:],
        Head("Vertical motion"),
        shades(
            [row for row in vertical if row["ratio"]],
            RATIO,
            COLUMNS["faster"].called("times as fast"),
            Column(SHARE.head, SHARE.value, digits=1, percent=True),
            "Share of outcomes that the vertical motion changes. V/H is peak vertical over peak horizontal "
            "acceleration; the other axis tells how many times as fast the vertical motion runs.",
            bounds=BOUNDS,
            panel="scene",
        ),
        table(
            "Vertical motion: outcomes changed, and share of runs that end because N reaches zero",
            vertical,
            SCENE,
            RATIO,
            FASTER,
            SHARE,
            Column("N reaches zero", lambda row: row["lifts_off"] / row["runs"], percent=True),
            RUNS,
        ),
    )


def _ranked(rows):
    """Rows in order of the share of outcomes changed, largest first."""
    return sorted(rows, key=lambda row: (-(SHARE.of(row) or 0), not row["runs"], WHAT.of(row)))


def _largest_share(rows):
    """Row with the largest share of outcomes changed; None without rows."""
    return max(rows, key=lambda row: SHARE.of(row) or 0, default=None)


def _title(shown):
    """Title of the page: what alters most outcomes in the first scene, and the engine that alters most in any."""
    first = _largest_share(grouped(where(shown, engine=REFERENCE), "scene")[shown[0]["scene"],])
    title = f"What matters more than the engine: {WHAT.of(first)} changes {percent(SHARE.of(first))} of outcomes"
    if most := _largest_share([row for row in shown if row["engine"] != REFERENCE and row["runs"]]):
        title += (
            f", an engine’s main variant at most {percent(SHARE.of(most))} (95 % upper limit {percent(most['high'])})"
        )
    return title


def _against_engines(scene, shown):
    """Sentence on how many changes certainly alter more outcomes than the engine whose interval ends highest."""
    changes = where(shown, engine=REFERENCE)
    engines = [row for row in shown if row["engine"] != REFERENCE and row["runs"]]
    if not engines:
        return f"{scene.capitalize()}: no engine was run."
    worst = max(engines, key=lambda row: row["high"])
    above = sum(row["low"] > worst["high"] for row in changes)
    return (
        f"{scene.capitalize()}: {above} of {len(changes)} changes clearly alter more outcomes than any engine’s main "
        "variant does. Their 95 % intervals lie wholly above the highest upper limit of these variants, "
        f"{percent(worst['high'])} ({NAME.of(worst)})."
    )


def _how(settings):
    scenes = "; ".join(
        f"{name} ({scene['scene']}), slenderness {', '.join(f'{gamma:g}' for gamma in scene['slendernesses'])} rad "
        f"(engines: {scene['slenderness_of_engines']:g})"
        for name, scene in settings["scenes"].items()
    )
    best, others = settings["motions_of_engines"], settings["motions_of_other_variants"]
    unseen = [percent(wilson(0, runs)[1]) for runs in (best, others) if runs]
    return (
        f"{settings['motions']} synthetic motions are scaled by lognormal factors, with a median that overturns half "
        f"of the blocks and a deviation of {short(settings['spread'])}. Scenes: {scenes}. Of the motions with a peak "
        f"of at least {settings['lifting']:g} g tan γ, engines run the first {best} in their main variant and the "
        f"first {others} in other variants"
        + (
            f"; if none of these changes the outcome, the 95 % upper limits are {' and '.join(unseen)}."
            if unseen
            else "."
        ),
        "The vertical motion is that of another seed. Bearings are vertically rigid in the model, but real ones "
        "vibrate vertically at 10 to 20 Hz. So twice the usual vertical motion is run, too.",
    )
