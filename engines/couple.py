"""A given restitution in a contact engine: a couple on the block before each landing.

A contact engine computes the restitution of eq. (7), and parameters of its contact do not change it: an impulse at the
landing corner has no moment about that corner. A couple takes a share of the tilt rate before the landing instead. It
acts from the time at which the block, at its rate w0 at tilt phi0, would need less than `acts` to reach the ground:

    M = -J' k phi',   J' = J_O - (m h)^2/M on a base, J_O on the ground,   k = (1 - f) |w0/phi0|

As d(phi')/d(phi) = -k is constant, it takes (1 - f) w0 exactly, whatever the amplitude; f is the given restitution over
that of (7). Gravity and base accelerate the block meanwhile, by a, of which it keeps f, too: k is larger by
a (T - f T0)/phi0, with T0 = |phi0/w0| the time to the ground without couple and T = T0 ln(1/f)/(1 - f) with it. The
base keeps the momentum of block and base, so the jump of its velocity is that of (8) for the given restitution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Self

from analytic.errors import SceneError
from analytic.rocking import RockingModel, momentum_restitution

if TYPE_CHECKING:
    from analytic import Scene

# Of the restitution of (7). A block that is slowed further hardly reaches the ground; one that is sped up is lifted
# where (f - 1) b |phi'| exceeds g `acts`: at f = 1.02 e is off by up to .06, at 1.05 by up to .4.
LEAST, MOST = 0.1, 1.0
FRICTION = 5.0  # coefficient in every tuned variant where the scene gives none, at least: no sliding
ALONE = "or run the analytic model, which takes any up to 1: `rocking run SCENE` without --engine"


def reached(scene: Scene) -> bool:
    """Whether a couple gives the restitution that a scene asks for, if it does."""
    given, own = scene.block.restitution, momentum_restitution(scene)
    return given is None or own > 0 and LEAST * own <= given <= MOST * own


def share_of(scene: Scene) -> float | None:
    """f of a scene that gives the restitution, else None.

    Raises
    ------
    SceneError
        It is not within `LEAST` and `MOST`.
    """
    given, own = scene.block.restitution, momentum_restitution(scene)
    if given is None:
        return None
    if not reached(scene):
        raise SceneError(
            "block.restitution",
            given,
            f"{'above' if given > MOST * own else 'below'} what a couple before each landing reaches, {LEAST:g} to "
            f"{MOST:g} times the {own:.6g} of eq. (7)",
            f"give one between, leave it out, {ALONE}",
        )
    return given / own


def holding(scene: Scene) -> Scene:
    """The scene; where it gives the restitution, with as much friction as the strongest couple asks of the pivot.

    That is (1 - mt) h/b, mt the block's share of the moving mass, 0 on the ground. With less the pivot slips: on the
    ground with friction .6, e is up to .3 off.
    """
    if scene.block.restitution is None:
        return scene
    asked = (1 - scene.mass_share) / math.tan(scene.block.slenderness)
    return scene if asked <= (scene.friction or FRICTION) else scene.with_(friction=asked)


def unkept_friction(scene: Scene) -> str:
    """That a script does not keep the friction of a scene, a sentence: a couple needs more; "" where it does.

    Raises
    ------
    SceneError
        As `share_of`.
    """
    held = holding(scene).friction
    if None in (scene.friction, share_of(scene)) or held == scene.friction or share_of(scene) == MOST:
        return ""
    return (
        f"The scene's friction, {scene.friction:g}, is not kept, and the block does not slide: below {held:.3g} it "
        "slips under the couple that gives the restitution."
    )


@dataclass
class Couple:
    """The couple of a scene. kept: f; inertia: J' [kg m2]; acts: time before a landing [s]; gain: k, 0 outside it.

    Rates are half a step early, as in `stepping`; steps: the last two, rate: the last one.
    """

    kept: float
    inertia: float
    acts: float
    gain: float = field(default=0.0, init=False)
    rate: float = field(default=0.0, init=False)
    steps: tuple[float, float] = field(default=(0.0, 0.0), init=False)

    @classmethod
    def of(cls, scene: Scene, acts: float) -> Self | None:
        """That of a scene which gives the restitution, else None. acts [s].

        Raises
        ------
        SceneError
            As `share_of`.
        """
        share = share_of(scene)
        if share is None:
            return None
        model = RockingModel.of(scene)
        coupled = (model.m * model.R * math.cos(model.gamma)) ** 2 / model.M if model.on_base else 0.0
        return cls(share, model.J - coupled, acts)

    @property
    def longer(self) -> float:
        """T/T0: how much longer the block needs to the ground."""
        return -math.log(self.kept) / (1 - self.kept) if abs(1 - self.kept) > 1e-9 else 1.0

    @property
    def lasts(self) -> float:
        """Time from its begin to the landing [s]."""
        return self.acts * self.longer

    def moment(self, step: float, tilt: float, rate: float) -> float:
        """The couple [N m] in a step [s] from this state, implicit in the rate at its end; asked for at every step."""
        (last, before), change = self.steps, rate - self.rate
        self.steps, self.rate = (step, last), rate
        if tilt * rate >= 0:
            self.gain = 0.0
        elif self.gain == 0 and abs(tilt) < self.acts * abs(rate):
            alone = abs(tilt / rate)
            gathered = math.copysign(change, change * rate) / (0.5 * (last + before)) if before else 0.0
            self.gain = ((1 - self.kept) * abs(rate) + gathered * (self.longer - self.kept) * alone) / abs(tilt)
        if self.gain == 0:
            return 0.0
        travel = min(abs(rate) * step / (1 + self.gain * step), abs(tilt))  # no farther than to the ground
        return -self.inertia * self.gain * math.copysign(travel, rate) / step
