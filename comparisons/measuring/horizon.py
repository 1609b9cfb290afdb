"""The sensitivity horizon of a scene: the time up to which trajectories can be compared.

Rocking under a long record is chaotic: a change of the restitution in the fourth digit soon gives another motion, in
the exact model, too. Point-wise agreement of two solvers can be required only until then. The horizon depends on the
size of a solver's errors, so that each solver has its own.
"""

from dataclasses import dataclass

import numpy as np

from analytic import Caution, Response, Scene, SceneError, simulate
from analytic.rocking import RockingModel
from engines.copies import changed_copies
from engines.matching import impacts_of, matched

from .errors import state_restitution

# Relative change of the copies without a solver; errors of tuned engines are equivalent to 1e-5 to 1e-3.
PERTURBATION = 1e-4
# Sizes that a solver's perturbation is given: from the least on, in these steps, to the most.
LEAST, LADDER, MOST = 1e-6, 2.0, 0.5
# Copies further apart than this share of the slenderness no longer show the same motion.
SPREAD = 0.01
# Share of SPREAD at which a solver's own distance from the model is taken as the measure of its errors: early enough
# to foretell where it reaches SPREAD, and above what sampling its history costs.
EARLY = 0.1
# Sampling of the copies: periods 2 pi/omega_r contain this many samples, so that no part of a swing is overlooked.
SAMPLES_PER_PERIOD = 1000


@dataclass(frozen=True, eq=False)
class Horizon:
    """The sensitivity horizon [s], the last time before a copy parts or the run's end; and the spread it comes from.

    perturbation: relative change of the copies [-]. time [s] and spread, arrays of shape (n,): the largest |tilt of a
    copy - tilt of the scene| / slenderness up to each time. Copies are told apart by name in `copies`: the time [s] at
    which each parted, or None.
    """

    horizon: float
    perturbation: float
    time: np.ndarray
    spread: np.ndarray
    copies: dict

    @property
    def parts(self) -> bool:
        """Whether a copy parts before the run ends."""
        return any(time is not None for time in self.copies.values())


def unsure_outcome(scene: Scene, outcome: str, perturbation: float = LEAST) -> Caution | None:
    """A warning where the model's `outcome` is another one for one of the `changed_copies`, or None."""
    for name, copy in changed_copies(scene, perturbation).items():
        try:
            other = simulate(copy, history=False).outcome
        except SceneError as error:  # of the copy, not of the scene
            other = f"cannot be run ({error.problem})"
        if other != outcome:
            words = (
                f"with {name} by {perturbation:.0e} the block {other}, without it {outcome}: the scene is near an "
                "outcome boundary; see rocking margin"
            )
            return Caution("model", words, "outcome", perturbation)
    return None


def sensitivity_horizon(scene: Scene, *, perturbation: float = PERTURBATION) -> Horizon:
    """Time until which the motion of a scene can be compared point by point.

    Parameters
    ----------
    scene : Scene
    perturbation : float
        Relative change of restitution, motion amplitude and start, above 0 and below 1. A copy that the model refuses
        is left out.
    """
    period = 2 * np.pi / scene.rocking_frequency
    step = min(period / SAMPLES_PER_PERIOD, (scene.duration or period) / 2)
    base = simulate(scene, output_step=step).history
    largest = np.zeros(len(base.time))
    parted = {}
    for name, copy in changed_copies(scene, perturbation).items():
        try:
            other = simulate(copy, output_step=step).history
        except SceneError:
            continue
        # Where one has overturned and stopped, it keeps its last tilt.
        tilt = np.interp(base.time, other.time, other.tilt)
        apart = np.abs(tilt - base.tilt) / scene.block.slenderness
        beyond = np.flatnonzero(apart > SPREAD)
        parted[name] = float(base.time[max(beyond[0] - 1, 0)]) if len(beyond) else None
        largest = np.maximum(largest, apart)
    times = [time for time in parted.values() if time is not None]
    return Horizon(
        min(times, default=float(base.time[-1])), perturbation, base.time, np.maximum.accumulate(largest), parted
    )


def perturbation_of(scene: Scene, response: Response, reference: Response) -> float:
    """Size of the relative change of `changed_copies` that moves the model as far as a solver's errors move the solver.

    Measured in the run: from `restitution_error` on, `LADDER` times as large until the copies are as far off the model
    as the solver's tilt is where it is first off by `EARLY` of `SPREAD`. That holds whatever moves the block:
    compliance, steps, times of uplift, missed impacts.

    Parameters
    ----------
    scene : Scene
    response, reference : Response
        The solver's, and the analytic model's; with histories.

    Returns
    -------
    float
        At least `LEAST`, at most `MOST`.
    """
    own, model = response.history, reference.history
    time = model.time[model.time <= own.time[-1]]
    apart = np.abs(np.interp(time, own.time, own.tilt) - model.tilt[: len(time)]) / scene.block.slenderness
    off = np.flatnonzero(apart > EARLY * SPREAD)
    until = time[off[0]] if len(off) else np.inf
    error = (
        _slipping_error(scene, response, reference, until)
        if reference.sliding
        else restitution_error(scene, response, until=until)
    )
    size = max(LEAST, error)
    if len(off) and off[0] > 0:
        short = scene.with_(duration=float(time[off[0]]))
        while size < MOST and sensitivity_horizon(short, perturbation=size).spread[-1] < apart[off[0]]:
            size *= LADDER
    return float(min(size, MOST))


def restitution_error(scene: Scene, response: Response, *, until: float = np.inf) -> float:
    """Relative error of e_phi, rms over the impacts resolved up to `until` [s], weighted by rate; 0 without any."""
    rates = np.array([impact.rate_before for impact in response.impacts if impact.time <= until])
    e = RockingModel.of(scene).restitution
    if not len(rates) or e == 0:
        return 0.0
    errors = state_restitution(response)[: len(rates)] / e - 1
    return float(np.sqrt(np.sum((rates * errors) ** 2) / np.sum(rates**2)))


def _slipping_error(scene: Scene, response: Response, reference: Response, until: float) -> float:
    """As `restitution_error`, of a block that slides: against its matching impacts in the model, as it is not (7)."""
    here, there = impacts_of(response), impacts_of(reference)
    meant, partner = matched(scene, there, here, until)
    (_, before, after), (_, model, left) = here[partner[partner >= 0]].T, meant[partner >= 0].T
    if not len(before):
        return 0.0
    errors = after / before / (left / model) - 1
    return float(np.sqrt(np.sum((before * errors) ** 2) / np.sum(before**2)))


def solver_horizon(scene: Scene, response: Response, reference: Response) -> Horizon:
    """The `Horizon` of one solver: that of its own size of perturbation, `perturbation_of`."""
    return sensitivity_horizon(scene, perturbation=perturbation_of(scene, response, reference))
