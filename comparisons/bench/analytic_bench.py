"""The whole benchmark of the analytic model: measure, write the result file, the plot and the faulty scenes."""

import json
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

from analytic.errors import SettingError
from analytic.records import read_record
from analytic.synthetic import synthetic_motion

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
    motion = read_record(record) if record else synthetic_motion()
    output = Path(output)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SettingError(f"--output {output.name}: no folder can be made there ({error.strerror})") from error
    rounds = QUICK_ROUNDS if quick else ROUNDS
    blocks, records = block_problems(), record_problems(motion)
    entries = [entry for problem in blocks for entry in block_entries(problem, quick)]
    entries += [entry for problem in records for entry in record_entries(problem, quick)]
    advance("work-precision")
    measure(entries, rounds)
    found = figures.ratios(entries, blocks, records)
    advance("independent solutions")
    found += [figures.agreement(problem) for problem in records]
    advance("throughput")
    found += figures.costs(blocks, records, motion, rounds)
    faulty = []
    if random_scenes:
        advance(f"{random_scenes} random scenes")
        faulty = check_random_scenes(random_scenes, SEED)
        found.append(
            figures.Figure(
                f"{random_scenes} random valid scenes: with NaN, hang, failure or energy gain",
                float(len(faulty)),
                "",
                "at most",
                0,
                f"seed {SEED}",
            )
        )
        if faulty:
            (output / "random-scenes.json").write_text(json.dumps(faulty, indent=1))
    rows = [entry.row() for entry in entries]
    settings = {
        "quick": quick,
        "rounds": rounds,
        "motion": motion.label,
        "random_scenes": random_scenes,
        "peers": peer_versions(),
    }
    write_result(
        output / "bench-analytic.json",
        "bench analytic",
        settings,
        [figure.row() for figure in found] + rows,
        modules=MODULES,
        seed=SEED if random_scenes else None,
    )
    from .plot import draw  # matplotlib takes its time

    draw(rows, machine(), output / "bench-analytic.png")
    return found, rows, faulty


def peer_versions() -> dict[str, str]:
    """Versions of the installed peers."""
    from importlib.metadata import version

    distributions = dict(zip(peers.PEERS, PEER_PACKAGES, strict=True))
    return {distributions[name]: version(distributions[name]) for name in peers.installed()}
