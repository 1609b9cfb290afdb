"""The whole benchmark of the analytic model: measure, write the result file, the plot and the faulty scenes."""

import json
from collections.abc import Callable
from os import PathLike
from typing import Any

from analytic.records import read_record
from analytic.synthetic import synthetic_motion

from ..running.files import make_folder
from ..running.provenance import machine, write_result
from . import figures, peers
from .problems import block_problems, record_problems
from .random_scenes import check_random_scenes
from .work_precision import block_entries, measure, record_entries

ROUNDS, QUICK_ROUNDS = 15, 5
SEED = 0
MODULES = ("comparisons.bench.analytic_bench", "analytic.kernel")
PEER_PACKAGES = ("heyoka", "scikit-sundae", "CyRK")


def bench_analytic(
    output: str | PathLike[str],
    *,
    quick: bool = False,
    random_scenes: int = 0,
    record: str | PathLike[str] | None = None,
    advance: Callable[[str], Any] = lambda total: None,
) -> tuple[list[figures.Figure], list[dict[str, Any]], list[dict[str, Any]]]:
    """Run it; returns (figures, rows of work-precision, faulty random scenes).

    Parameters
    ----------
    output : Path
        Folder for bench-analytic.json, bench-analytic.png and, where some fail, random-scenes.json.
    quick : bool
        Fewer tolerances and rounds, under a minute.
    random_scenes : int
        How many random valid scenes to run through the kernel.
    record : path or None
        Record of the isolated Caryatid; the shipped synthetic motion without one.
    advance : callable
        Called with a word on what comes next.

    Raises
    ------
    SceneError, SettingError
        The record cannot be read, or the folder cannot be made: before anything runs.
    """
    motion = synthetic_motion() if record is None else read_record(record)
    output = make_folder(output)
    rounds = QUICK_ROUNDS if quick else ROUNDS
    blocks, records = block_problems(), record_problems(motion)
    entries = [entry for problem in blocks for entry in block_entries(problem, quick)]
    entries += [entry for problem in records for entry in record_entries(problem, quick)]
    advance("work-precision")
    measure(entries, rounds)
    measured = figures.ratios(entries, blocks, records)
    advance("independent solutions")
    measured += [figures.agreement(problem) for problem in records]
    advance("throughput")
    measured += figures.costs(blocks, records, motion, rounds)
    faulty = []
    if random_scenes:
        advance(f"{random_scenes} random scenes")
        faulty = check_random_scenes(random_scenes, SEED)
        what = f"{random_scenes} random valid scenes: with NaN, hang, failure or energy gain"
        measured.append(figures.Figure(what, float(len(faulty)), "", "at most", 0, f"seed {SEED}"))
        if faulty:
            (output / "random-scenes.json").write_text(json.dumps(faulty, indent=1))
    rows, asked = [entry.row() for entry in entries], {"quick": quick, "rounds": rounds, "motion": motion.label}
    settings = {**asked, "random_scenes": random_scenes, "peers": peer_versions()}
    _write(output, settings, [figure.row() for figure in measured], rows)
    return measured, rows, faulty


def _write(output, settings, measured, rows):
    """The result file, and the plot of the solvers' rows."""
    from .plot import draw  # matplotlib takes its time

    seed = SEED if settings["random_scenes"] else None
    path = output / "bench-analytic.json"
    write_result(path, "bench analytic", settings, measured + rows, modules=MODULES, seed=seed)
    draw(rows, machine(), path.with_suffix(".png"))


def peer_versions() -> dict[str, str]:
    """Versions of the installed peers."""
    from importlib.metadata import version

    distributions = dict(zip(peers.PEERS, PEER_PACKAGES, strict=True))
    return {distributions[name]: version(distributions[name]) for name in peers.installed()}
