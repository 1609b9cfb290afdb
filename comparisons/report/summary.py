"""What the report's own runs found, in sentences."""

from engines import missing_words

from ..running.provenance import Result
from ..showing.parts import number, percent
from ..showing.wording import outcomes

MOST_WARNINGS = 3  # of a scene, at the top of the page


def summary(scenes: Result, block: Result | None) -> list[str]:
    """Sentences, list of str: outcomes, engines that are missing, runs that failed."""
    sentences = []
    for name, scene in scenes.settings["scenes"].items():
        rows = [row for row in scenes.rows if row["scene"] == name]
        sentences.append(f"{scene['name']}: {outcomes(rows)}.{_times(rows)}{_displacement(rows)}{_warned(rows)}")
    sentences += [f"Not in this report: {words}." for words in missing_words(scenes.settings["missing"])]
    failed = [
        f"{row['engine']} on {row['scene']} ({row['failure']['reason']})" for row in scenes.rows if row["failure"]
    ]
    failed += [
        f"{row['failed']} of free rocking in {row['engine']}, {row['variant']} ({row['failures'][0]['reason']})"
        for row in (block.rows if block else ())
        if row["failed"]
    ]
    if failed:
        sentences.append("Failed runs: " + "; ".join(failed) + ".")
    return sentences


def _warned(rows):
    """The warnings of a scene's runs, each once; the table beside the outcomes says whose they are."""
    warnings = list(dict.fromkeys(warning["text"] for row in rows for warning in row.get("warnings", ())))
    if not warnings:
        return ""
    more = f"; {len(warnings) - MOST_WARNINGS} more in the table of warnings" if len(warnings) > MOST_WARNINGS else ""
    return f" Warning: {'; '.join(text.rstrip('.') for text in warnings[:MOST_WARNINGS])}{more}."


def _times(rows):
    times = [row["overturning_time"] for row in rows if row.get("overturning_time") is not None]
    if not times:
        return ""
    low, high = number(min(times), 4), number(max(times), 4)
    return f" Overturning at {low if low == high else f'{low} to {high}'} s."


def _displacement(rows):
    peaks = {row["engine"]: row["peak_base_displacement"] for row in rows if row.get("peak_base_displacement")}
    if "analytic" not in peaks:
        return ""
    text = f" In the model the base moves by at most {number(peaks['analytic'], 4)} m"
    apart = {solver: abs(peak / peaks["analytic"] - 1) for solver, peak in peaks.items() if solver != "analytic"}
    if apart:
        worst = max(apart, key=lambda solver: apart[solver])
        text += f"; engines are off by up to {percent(apart[worst])} ({worst})"
    return f"{text}."
