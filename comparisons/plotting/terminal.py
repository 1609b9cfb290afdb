"""Tables and sentences in the terminal: of responses, their differences and warnings."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.table import Table
from rich.text import Text

from analytic import Caution, Response, Scene
from analytic.response import FALLS

from ..execution.writing import readable
from ..schemas.columns import percent
from .parts import grouped
from .wording import MOST_NAMED, differing, listed, outcomes

if TYPE_CHECKING:
    from ..metrics.errors import Horizon

LONGEST_NUMBER = 15  # characters: sign, nine digits, point, exponent; longer words are names and may be broken
WIDE = 10**4  # columns: wider than any table


@dataclass(frozen=True)
class Grid:
    """A table that fits the terminal: lines are broken at blanks, then the last columns are left out.

    A sentence below names the columns left out. No number is broken. sides: alignment of each column. first: whether a
    column is broken before others.
    """

    heads: list[str]
    rows: list[list[Text]]
    sides: list[Any]
    first: list[bool]
    look: dict[str, Any]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        count = len(self.heads)
        while (widths := self._widths(count, self._room(count, console, options))) is None:
            count -= 1
        yield self._table(widths)
        if count < len(self.heads):
            least = [self._least(column) for column in range(len(self.heads))]
            needed = options.max_width - self._room(len(least), console, options) + sum(least)
            more = ", ".join(head.replace("-\n", "").replace("\n", " ") for head in self.heads[count:])
            yield Text(f"A terminal of {needed} columns (or COLUMNS={needed}) shows more: {more}.")

    def _widths(self, count, room):
        """Return the widths of the first `count` columns within this room; None if there is too little room."""
        widths = [max(1, *map(cell_len, self._lines(column))) for column in range(count)]
        least = [self._least(column) for column in range(count)]
        for early in (True, False):
            while sum(widths) > room:
                wide = [k for k in range(count) if self.first[k] >= early and widths[k] > least[k]]
                if not wide:
                    break
                widths[max(wide, key=widths.__getitem__)] -= 1
        return [min(widths[0], max(room, 1))] if count == 1 else widths if sum(widths) <= room else None

    def _lines(self, column):
        return "\n".join((self.heads[column], *(row[column].plain for row in self.rows))).split("\n")

    def _least(self, column):
        """Return the width of a column that keeps all but the longest words whole."""
        words = (word for line in self._lines(column) for word in line.split())
        return max((min(cell_len(word), LONGEST_NUMBER) for word in words), default=1)

    def _room(self, count, console, options):
        """Return the width that the terminal has for the cells of `count` columns."""
        empty = console.measure(self._table([1] * count), options=options.update_width(WIDE)).maximum - count
        return options.max_width - empty

    def _table(self, widths):
        table = Table(**self.look)
        for head, side, width in zip(self.heads, self.sides, widths, strict=False):
            table.add_column(Text(head), justify=side, width=width, overflow="fold")
        for row in self.rows:
            table.add_row(*row[: len(widths)])
        return table


def grid(
    heads: Sequence[str],
    rows: Iterable[Sequence[str | Text]],
    *,
    left: Collection[str] = (),
    wraps: Collection[str] = (),
    **look: Any,
) -> Grid:
    """Return a table of cells as they are: a unit in brackets is no markup.

    left : heads of the columns that are aligned to the left, besides the first. wraps : heads of the columns that a
    narrow terminal breaks first. look : keywords of `rich.table.Table`.
    """
    cells = [[Text(cell) if isinstance(cell, str) else cell for cell in row] for row in rows]
    sides = ["left" if head == heads[0] or head in left else "right" for head in heads]
    look = {"box": box.SIMPLE_HEAD, "padding": (0, 1, 0, 0), **look}
    return Grid(list(heads), cells, sides, [head in wraps for head in heads], look)


def echo(*parts: Grid | Text | str, wrap: bool = False) -> None:
    """Print tables and sentences; wrap: whether sentences are broken to the width of the terminal."""
    console = Console(highlight=False)
    for part in parts:
        console.print(Text(part) if isinstance(part, str) else part, soft_wrap=not (wrap or isinstance(part, Grid)))


def digits(value: float | None, form: str = ".4g") -> str:
    """Return a number in this format; a hyphen for None and nan."""
    return "-" if value is None or math.isnan(value) else f"{value:{form}}"


TITLE_CHARACTERS = 100
MOST_MODES = 8  # changes of contact, at most, in a list of modes
MOTION = "motion"  # the kind of warnings about the scene, not about a solver


def _name(scene):
    return readable(scene.name, TITLE_CHARACTERS)


def summary(scene: Scene, response: Response) -> Grid:
    """Return the main numbers of one response as a table."""
    title = f"{_name(scene)}: {response.engine}" + (f", {response.variant}" if response.variant else "")
    rows = {
        "outcome": response.outcome_text,
        "overturning time [s]": digits(response.overturning_time, ".6g"),
        **({"falls off at [s]": digits(response.end.time, ".6g")} if response.outcome == FALLS[0] else {}),
        "peak tilt [rad]": digits(response.peak_tilt),
        "peak tilt / slenderness": digits(response.peak_tilt_ratio),
        "peak base displacement [m]": digits(response.peak_base_displacement) + _travel(scene, response),
        "peak base acceleration [m/s2]": digits(response.peak_base_acceleration),
        "impacts": str(response.impact_count),
        **_slip(response),
        **_pedestal(response),
        "friction demand |H|/N": digits(response.friction_demand),
        "least normal force N/(m g)": digits(response.min_normal_ratio),
        "CPU time [s]": digits(response.cpu_seconds, ".3g"),
        "steps": str(response.steps),
    }
    return named_values(rows, title)


def _travel(scene, response):
    """Return in words which share of x_max the base has used, if it is known."""
    limit, peak = scene.bearings and scene.bearings.x_max, response.peak_base_displacement
    return "" if limit is None or math.isnan(peak) else f", {percent(peak / limit)} of x_max"


def _slip(response):
    """Return the rows of a block that slides on its support."""
    slid = response.sliding
    if not (slid and slid.peak):
        return {}
    return {
        "largest slip [m]": digits(slid.peak),
        "slip at the end [m]": digits(slid.end),
        "way slid, to and fro [m]": digits(slid.path),
        **({} if math.isnan(slid.work) else {"work of friction [J]": digits(slid.work)}),
        **({"contact": mode_words(slid.modes)} if slid.modes else {}),
    }


def _pedestal(response):
    """Return the rows of a free pedestal under the block."""
    if (stack := response.stack) is None:
        return {}
    return {
        "what rocks": " and ".join(stack.rocked) or "nothing",
        "peak tilt of the pedestal [rad]": digits(stack.peak_tilt),
        "impacts of the pedestal": str(len(stack.impacts)),
        "friction demand of the pedestal": digits(stack.friction_demand),
    }


def mode_words(modes: Sequence[tuple[float, str]], most: int = MOST_MODES) -> str:
    """Return modes of contact and their begins, at most `most`: "stick, from 0.0614 s rock"; impacts end no mode."""
    changes = [change for k, change in enumerate(modes) if k == 0 or change[1] != modes[k - 1][1]]
    words = [f"from {time:.4g} s {mode}" if time else mode for time, mode in changes[:most]]
    left = len(changes) - most
    return ", ".join([*words, f"{left} more changes (--json)"] if left > 0 else words)


def named_values(rows: Mapping[str, str], title: str) -> Grid:
    """Return a table of {name: value}."""
    look = {"box": box.SIMPLE, "padding": (0, 1), "show_header": False}
    return grid(["name", "value"], rows.items(), left=["value"], wraps=["name", "value"], title=Text(title), **look)


def comparison(scene: Scene, responses: Sequence[Response], horizons: Mapping[str, Horizon]) -> Grid:
    """Return a table of responses of several solvers, the first being the reference; horizons: {solver: `Horizon`}."""
    limit = _limit(horizons) if horizons else "" if scene.is_stack else "No sensitivity horizon known."
    slides = any(response.sliding and response.sliding.peak for response in responses)
    stacked = any(response.stack for response in responses)
    slip = "; slip: largest slip of the block" if slides else ""
    pedestal = ";\nlower: peak tilt of the pedestal, from which the block's is measured" if stacked else ""
    caption = (
        "over: time of overturning; tilt: peak tilt over slenderness;\n"
        f"base: peak base displacement{slip}{pedestal}; d: difference from the first row.\n" + limit
    )
    heads = ["solver", "outcome", "over\n[s]", "tilt\n[-]", "d\n[-]", "base\n[m]", "d\n[%]", "im-\npacts", "CPU\n[ms]"]
    heads[5:5] = [*["slip\n[m]", "d\n[%]"] * slides, *["lower\n[rad]"] * stacked]
    reference, rows = responses[0], []
    for response in responses:
        tilt, displacement = "", ""
        if response is not reference and not response.failure and not reference.failure:
            if not {*FALLS} & {response.outcome, reference.outcome}:
                tilt = f"{response.peak_tilt_ratio - reference.peak_tilt_ratio:+.0e}"
            if reference.peak_base_displacement > 0:
                displacement = f"{100 * (response.peak_base_displacement / reference.peak_base_displacement - 1):+.0e}"
        rows.append(
            [
                f"{response.engine}\n{response.variant}".rstrip(),
                response.outcome_text.replace(" ", "\n", 1),  # "undecided" stands above what is so far
                digits(response.overturning_time, ".4f"),
                digits(response.peak_tilt_ratio, ".4f"),
                tilt,
                *(_slipped(response, reference) if slides else ()),
                *([digits(response.stack.peak_tilt if response.stack else None, ".4f")] if stacked else ()),
                digits(response.peak_base_displacement, ".4f"),
                displacement,
                str(response.impact_count),
                digits(1e3 * response.cpu_seconds, ".1f"),
            ]
        )
    return grid(heads, rows, left=["outcome"], title=Text(_name(scene)), show_edge=False, caption=caption)


def _slipped(response, reference):
    """Return the largest slip, and by how many per cent it differs from the reference's if both stay upright."""
    if response.failure or response.sliding is None and response is not reference:
        return "-", ""
    slip, reference_slip = (run.sliding.peak if run.sliding else 0.0 for run in (response, reference))
    apart = response is not reference and not reference.failure and reference_slip > 0
    if not apart or {*FALLS} & {response.outcome, reference.outcome}:
        return digits(slip), ""
    return digits(slip), f"{100 * (slip / reference_slip - 1):+.0e}"


def _limit(horizons):
    """Return sentences on the time up to which histories can be compared."""
    if not any(known.parts for known in horizons.values()):
        size = max(known.perturbation for known in horizons.values())
        return (
            f"Changes of the scene as large as the solvers' errors, {size:.0e} at most, do not grow:\n"
            "to the end, a difference between histories is a solver's error."
        )
    lines = ["Sensitivity horizon, beyond which only outcomes can be compared,", "by each solver's own size of error:"]
    for name, known in horizons.items():
        until = f"{known.horizon:.3g} s" if known.parts else "none, to the end"
        lines.append(f"{name} {until} ({known.perturbation:.0e})")
    return "\n".join(lines)


def show(table: Grid, responses: Sequence[Response], about: Sequence[Caution] = (), notes: Sequence[str] = ()) -> None:
    """Print a table of responses; below it their differences from the analytic model, and their warnings.

    Warnings `about` the scene itself stand first, in bold; `notes` on it stand below the table. A sentence on the
    outcomes of several responses follows the former. Warnings of a result that is sensitive to small changes of the
    motion stand last, in bold.
    """
    echo(*(Text(f"Warning: {readable(str(warning))}", "bold") for warning in about))
    if len(responses) > 1:
        sentence = outcomes([{**response.to_json(), "outcome_text": response.outcome_text} for response in responses])
        echo(f"{sentence[0].upper()}{sentence[1:]}.", wrap=True)
    motion = [warning for response in responses for warning in response.warnings if warning.kind == MOTION]
    echo(table, *(readable(words) for words in (*remarks(responses), *notes)))
    echo(*(Text(readable(str(warning)), "bold") for warning in motion))


def remarks(responses: Sequence[Response]) -> list[str]:
    """Return sentences: how responses differ from the analytic model, or why they cannot be compared; and warnings.

    Equal sentences of several solvers are joined.
    """
    different = [(each.engine, words) for each in responses for words in differing(each.comparable, each.differences)]
    warnings = [(each.engine, warning) for each in responses for warning in each.warnings if warning.kind != MOTION]
    sentences = [
        f"{'each of ' * (len(pairs) > 1)}{listed([name for name, _ in pairs])} {words}"
        for (words,), pairs in grouped(different, lambda pair: pair[1]).items()
    ]
    return sentences + warned(warnings, len(responses), "all solvers")


def warned(pairs: Iterable[tuple[str, Caution]], count: int, everyone: str) -> list[str]:
    """Return warnings and whom they concern. Warnings about one quantity are joined: the largest value, and the range.

    pairs : (who, warning). everyone : what all `count` of them are called.
    """
    sentences = []
    for members in grouped(pairs, lambda pair: pair[1].kind, lambda pair: pair[1].quantity or pair[1].text).values():
        names = list(dict.fromkeys(who for who, _ in members))
        further = [f"{len(names) - MOST_NAMED} more"] if len(names) > MOST_NAMED + 1 else []
        who = everyone if 1 < len(names) == count else listed([*names[: MOST_NAMED if further else None], *further])
        values = {f"{warning.value:.3g}": warning.value for _, warning in members if warning.value is not None}
        spread = f" ({min(values.values()):.3g} to {max(values.values()):.3g})" if len(values) > 1 else ""
        worst = max((warning for _, warning in members), key=lambda warning: abs(warning.value or 0.0))
        sentences.append(f"Warning, {who}: {worst}{spread}")
    return sentences
