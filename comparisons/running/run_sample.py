"""A random sample of a study's runs, stored with its result, so that they can be repeated without the plan."""

import inspect
import random
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from analytic import PulseMotion, SampledMotion, Scene, synthetic_motion
from analytic.synthetic import STYLES

from .cases import Case, name_of
from .plan import Batch
from .provenance import json_ready
from .sweep import Row

SIZE = 60  # runs stored with a result
SEED = 0  # of their choice
LONGEST, MOTIONS = 5000, 4  # of motions stored sample by sample: their length, and how many different ones
SYNTHETIC = re.compile(rf"synthetic ({'|'.join(STYLES)}) motion, seed (\d+)\b")
NAMELESS = "sampled motion"  # label of a motion that a study makes by a formula; a record has its file's name


def sample_of(runs: Iterable[tuple[Batch, Row]]) -> list[dict[str, Any]]:
    """At most `SIZE` of the runs, chosen at random, as JSON values.

    Left out are runs under recorded motions, whose values may not be passed on; under long motions made by a formula;
    and those whose measure is not a function.
    """
    known = [(batch, row) for batch, row in runs if inspect.isfunction(batch.measure)]
    found: list[dict[str, Any]] = []
    stored: set[str] = set()  # digests of motions stored sample by sample
    for batch, row in random.Random(SEED).sample(known, len(known)):
        motion = _motion_table(row.case.scene.motion)
        if motion is None or len(stored | _long(motion)) > MOTIONS:
            continue
        stored |= _long(motion)
        found.append(_run_table(batch, row, motion))
        if len(found) == SIZE:
            break
    return found


def case_of(run: Mapping[str, Any]) -> Case:
    """The case of a stored run.

    Raises
    ------
    SceneError
        It is no scene today.
    """
    scene = Scene(**{**run["scene"], "motion": _motion(run["scene"]["motion"])})
    return Case(scene, run["engine"], run["variant"], run["settings"], run["tag"])


def outcome_of(row: Row) -> dict[str, Any]:
    """What is compared of a run: its values, or of one that failed the kind of failure and the reason."""
    if row.failure:
        return {"values": None, "failure": {name: row.failure[name] for name in ("kind", "reason")}}
    return {"values": row.values, "failure": None}


def _run_table(batch, row, motion):
    case = row.case
    scene = {**case.scene.model_dump(exclude={"motion"}), "motion": motion}
    return {
        "engine": case.solver,
        **{name: getattr(case, name) for name in ("variant", "settings", "tag")},
        "measure": name_of(batch.measure),
        "time_limit": batch.time_limit,
        **outcome_of(row),
        "digest": case.scene.digest(),
        "scene": json_ready(scene),
    }


def _motion_table(motion):
    """A motion as JSON values: {} without one, None for one that is not stored."""
    if motion is None:
        return {}
    if isinstance(motion, PulseMotion):
        return asdict(motion)
    own = SYNTHETIC.match(motion.label)
    if not own and motion.label != NAMELESS:
        return None
    vertical = _motion_table(motion.vertical)
    table = {"dt": motion.dt, "label": motion.label, "warnings": list(motion.warnings), "vertical": vertical}
    if own and (factor := _factor(motion, synthetic_motion(own[1], int(own[2])))):
        return None if vertical is None else table | {"style": own[1], "seed": int(own[2]), "factor": factor}
    if vertical is None or len(motion.samples) > LONGEST:
        return None
    return table | {"samples": motion.samples.tolist(), "digest": motion.digest()}


def _factor(motion, base):
    """The number by which `base` is multiplied to give the very samples of `motion`; None if there is none."""
    if len(motion.samples) != len(base.samples):
        return None
    peak = np.abs(base.samples).argmax()
    near = float(motion.samples[peak] / base.samples[peak])
    tried = (near, float(np.nextafter(near, np.inf)), float(np.nextafter(near, -np.inf)))
    return next((factor for factor in tried if np.array_equal(base.samples * factor, motion.samples)), None)


def _long(motion):
    """Digests of what a motion's table holds sample by sample."""
    own = {motion["digest"]} if "samples" in motion else set()
    return own | (_long(motion["vertical"]) if motion.get("vertical") else set())


def _motion(table):
    if not table:
        return None
    table = {**table, "vertical": _motion(table["vertical"])}
    if "shape" in table:
        return PulseMotion(**table)
    if "style" in table:
        samples = synthetic_motion(table["style"], table["seed"]).samples * table["factor"]
    else:
        samples = np.array(table["samples"])
    return SampledMotion(table["dt"], samples, table["label"], tuple(table["warnings"]), table["vertical"])
