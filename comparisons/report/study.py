"""The report's own runs as a study, and their results in the report's folder."""

import shutil
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path

from analytic import Scene
from analytic.motion import Motion

from ..running.plan import Study
from ..running.provenance import copy_result
from ..running.study import compute
from .runs import CARYATID, RESTITUTION, SCENES, load_scenes, plan

# Under a record of more samples one engine runs at a time: each needs some 100 bytes a step several times over.
SHORT_RECORD = 200_000
UNFINISHED = "unfinished"  # folder of what a report that is broken off goes on from

STUDY = Study("report", "Scenes in every solver.", plan, by_solver=False)


def make_own_results(
    folder: str | PathLike[str],
    scenes: Mapping[str, Scene],
    *,
    engines: Sequence[str] | None = None,
    variants: Mapping[str, str | None] | None = None,
    motions: Mapping[str, Mapping[str, Sequence[Motion]]] | None = None,
    left: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Simulate what the report on one's own scenes shows, {name: scene}, and write its result files into `folder`.

    engines: those to compare, all that are installed without it; variants: of those not taken as they come; motions: of
    each scene, {record: its motions} besides its own; left: of each scene, what was left out of them and why.

    >>> from tempfile import mkdtemp
    >>> from analytic import load_scene
    >>> from comparisons.report.write import write_page
    >>> folder = mkdtemp()
    >>> make_own_results(folder, {"block": load_scene("free-rocking-rigid")}, engines=[])
    >>> write_page(folder).name
    'report.html'
    """
    many = {"motions": dict(motions or {}), "left": dict(left or {})}
    _make(folder, engines, scenes=scenes, variants=dict(variants or {}), **many, own=True)


def make_results(
    folder: str | PathLike[str], motion: Motion, *, duration: float | None = None, engines: Sequence[str] | None = None
) -> None:
    """Simulate the Caryatid of the paper, free-standing and isolated, and write the result files of the page.

    Parameters
    ----------
    folder : path
        Made if it does not exist. A report that is broken off goes on from what it finds here.
    motion : SampledMotion
    duration : float or None
        Of the runs [s]; None: until their outcome is decided.
    engines : sequence of str or None
        Those to compare; None: all that are installed.
    """
    scenes = {name: scene.with_(duration=duration) for name, scene in load_scenes(CARYATID, motion).items()}
    _make(folder, engines, scenes=scenes, variants={}, motions={}, left={}, own=False)


def _make(folder, engines, *, scenes, **options):
    """Compute the runs into `folder`, in place of what an earlier report left there."""
    unfinished = Path(folder) / UNFINISHED
    samples = max((len(getattr(scene.motion, "samples", ())) for scene in scenes.values()), default=0)
    workers = None if samples <= SHORT_RECORD else 1
    options |= {"scenes": scenes, "histories": unfinished}
    paths = compute(STUDY, unfinished, engines=engines, workers=workers, **options)
    for path in paths:
        copy_result(path, Path(folder))
    for name in {SCENES, RESTITUTION} - {path.name for path in paths}:  # of an earlier report
        for file in (Path(folder) / name, (Path(folder) / name).with_suffix(".npz")):
            file.unlink(missing_ok=True)
    shutil.rmtree(unfinished)  # complete: the next report measures its times afresh
