"""The cause of an engine's error of restitution, from the steps of one contact only, without its settings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from engines import get_engine

from .agreement import Unmeasurable
from .autopsy import Contact, contact_of, frames

if TYPE_CHECKING:
    from analytic import Scene

LEAST = 1e-3  # of e, or of the rate before: a smaller error has no cause worth a name
CAUSES = {
    "damping": "the block loses speed in flight: something is damped that was not asked for",
    "shape": "a corner in the air bears weight: the contact is not where the block's corner is",
    "gap": "the corner is struck more than a step before or after it is level with the pivot: a slop, margin or radius",
    "iterations": "the impulse is spread over steps, pulls or slips: the solver stops before it converges",
    "adhesion": "the corner that should lift is pulled at, over many steps: the contact's damper acts outward, too",
    "compliance": "the impulse takes many steps to grow and to fade, while the block turns on: the contact is soft",
    "rebound": "the struck corner leaves the ground at once: a restitution, or a penetration corrected by a velocity",
    "friction": "a corner slides, friction and normal impulse being in one ratio: the friction is too small",
    "unseen": "the contact itself, and more than a step explains; the engine does not report where the block was",
    "step": "no part is larger than what the block gains in one step: the step straddles the impact",
}
# Steps over which a sudden strike extends. Velocity-level solvers strike within one step, which appears in two, as
# velocities are those of the steps' ends; without convergence they take up to eight (one iteration, started from the
# step before). A resolved compliant contact takes a dozen or more.
AT_ONCE, MANY = 2, 10
SATURATED = 5.0  # largest friction over normal impulse of a sliding contact, over the strike's, in which it may turn
STRADDLING = 2.0  # parts over what gravity gains in a step, up to which the step explains them: a strike is seen in two
HALF = 0.5  # of the largest part, from which on a part or a reason of parts is named


def cause_of(contact: Contact) -> str | None:
    """One of `CAUSES`, or None where the error is below `LEAST`."""
    parts = {name: abs(value) for name, value in contact.parts.items()}
    flight, shape = parts.pop("flight"), parts.pop("shape", 0.0)
    if max(flight, abs(contact.error)) < LEAST:
        return None
    largest = max(parts.values())
    if flight >= max(LEAST, largest, STRADDLING * contact.phase):
        return "damping"
    if contact.placed and shape >= HALF * max(largest, LEAST):
        return "shape"
    part = max(parts, key=parts.__getitem__)
    pulled = contact.placed and parts["pull"] >= HALF * largest
    if contact.steps >= MANY:
        slides = part == "slip" and _saturated(contact)
        return "friction" if slides else "adhesion" if pulled else "compliance"
    if largest <= STRADDLING * contact.phase:
        return "step"
    return _sudden(contact, part, pulled)


def _sudden(contact, part, pulled):
    """The cause of a sudden strike's error that one step does not explain, by its largest part."""
    if not contact.placed:
        return "unseen"
    if part == "slip":
        return "friction" if _saturated(contact) else "iterations"
    if pulled or contact.steps > AT_ONCE:
        return "iterations"
    return "gap" if part == "support" else "rebound"


def _saturated(contact):
    """Whether friction over normal impulse is nowhere larger than at the strike, as of a contact that slides."""
    window = slice(contact.first, contact.last)
    upward, strike = contact.impulse[window].sum(axis=1), contact.strike[window]
    loaded = upward > 1e-3 * upward.max()
    demand = np.abs(contact.friction[window][loaded]) / upward[loaded]
    return bool(demand.max() <= SATURATED * np.average(demand, weights=np.maximum(strike[loaded], 0.0)))


def diagnosis(engine: str, variant: str, scene: Scene, which: int = 0, **settings: Any) -> dict[str, object]:
    """The analysis of impact number `which` of a run, ready for JSON.

    Returns
    -------
    dict
        engine, variant, "tier" (its kind), best (the engine's main variant); if it can be analysed: placed, error,
        cause and words (None below `LEAST`), parts, steps, energy_lost (over the kinetic one before), frames, and where
        the block is placed deepest [m]; else why_not.
    """
    record = get_engine(engine)
    row: dict[str, object] = {"engine": engine, "variant": variant, "tier": record.variants[variant].kind}
    row["best"] = variant == record.default_variant
    _, trace = record.traced(scene, variant=variant, history=False, **settings)
    try:
        if trace is None:
            raise Unmeasurable("the run has no steps")
        contact = contact_of(scene, trace, which)
    except Unmeasurable as error:
        return row | {"why_not": str(error)}
    cause = cause_of(contact)
    row |= {
        "placed": contact.placed,
        "error": contact.error,
        "cause": cause,
        "words": cause and CAUSES[cause],
        "parts": contact.parts,
        "steps": contact.steps,
        "energy_lost": float(contact.energy[contact.first] - contact.energy[contact.last]),
        "frames": frames(contact),
    }
    return row | ({"deepest": contact.deepest} if contact.placed else {})
