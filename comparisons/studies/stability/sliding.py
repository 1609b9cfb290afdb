"""Hard cases with friction: the block slides, or nearly so."""

import math

from analytic import PulseMotion, Scene, Start
from analytic.caryatid import MASS, caryatid_block
from analytic.sliding.run import slipping_friction
from analytic.solver import parameters

from .basis import BLOCK, GAMMA, ISOLATED, THRESHOLD, HardCase

G = 9.81
# One cosine of 4.6 THRESHOLD at 3.2 rad/s on BLOCK: the friction from which the corner that lands slips on, and the
# slips [m] of a block that slides to and fro, from its equations of motion (the tests find both again).
SLIPS_FROM = 0.2633756360465358
TO_AND_FRO = {"peak slip": 0.29498304635961, "end slip": 0.27196034003751}


def sliding() -> list[HardCase]:
    return [*_level(), *_near_slenderness(), *_impacts(), *_swings(), *_isolated()]


def _case(title, name, mu, *, expected=None, quick=False, scene=None, **parts):
    scene = Scene(block=BLOCK, duration=6.0) if scene is None else scene
    return HardCase(title, scene.with_(name=name, friction=mu, **parts), expected=expected or {}, quick=quick)


def _slides(slip):
    return {"outcome": "slides", "peak slip": slip, "end slip": -slip}


def _level():
    a, mu, T = 4.0, 0.2, 0.5
    v = (a - mu * G) * T
    stops = v * T / 2 + v**2 / (2 * mu * G)
    hop, T_hop = PulseMotion("rectangular", -2 * G, math.pi / 0.1), 0.1
    # it flies until sqrt(2) T later, as its vertical velocity is g T at T; what it lands with takes mu of itself
    v = a * T_hop - mu * G * math.sqrt(2) * T_hop
    flies = a * T_hop**2 * (1.5 + math.sqrt(2)) + v**2 / (2 * mu * G)
    return [
        _case(
            "slides from rest to rest under a jump of the ground acceleration",
            "slides",
            mu,
            motion=PulseMotion("rectangular", a, math.pi / T),
            expected=_slides(stops),
            quick=True,
        ),
        _case(
            "turns round twice while it slides, without sticking",
            "slides to and fro",
            mu,
            motion=PulseMotion("one-cosine", 4 * mu * G, 6.0),
            expected={"outcome": "slides"} | TO_AND_FRO,
            quick=True,
        ),
        _case(
            "flies under a vertical motion of 2 g, and slides where it lands",
            "flies and slides",
            mu,
            motion=PulseMotion("rectangular", a, hop.frequency, vertical=hop),
            duration=2.0,
            expected=_slides(flies),
        ),
    ]


def _near_slenderness():
    """A half-sine of twice the acceleration that lifts the block if it does not slide before."""
    w, share = 3.0, 0.999
    pulse = PulseMotion("half-sine", 2 * THRESHOLD, w)
    begins = math.asin(share / 2)
    # of the ground under the block until the pulse ends, less what friction takes of it; then it stops
    v = 2 * THRESHOLD / w * (math.cos(begins) + 1) - share * THRESHOLD * (math.pi - begins) / w
    way = 2 * THRESHOLD * (math.cos(begins) * (math.pi - begins) + math.sin(begins)) / w**2
    way += v**2 / (2 * share * THRESHOLD) - share * THRESHOLD * ((math.pi - begins) / w) ** 2 / 2
    lifts = {"outcome": "rocks", "uplift time": math.asin(0.5) / w}
    return [
        _case(
            f"friction of {factor:g} tan(slenderness): {words}",
            f"friction {factor:g} of uplift",
            factor * math.tan(GAMMA),
            motion=pulse,
            expected=expected,
            quick=True,
        )
        for factor, words, expected in ((share, "it only slides", _slides(way)), (1.001, "it lifts, and slides", lifts))
    ]


def _impacts():
    released = Scene(block=BLOCK, start=Start(tilt=0.6 * GAMMA), friction=1.0, duration=6.0)
    cosine = PulseMotion("one-cosine", 4.6 * THRESHOLD, 3.2)
    return [
        _case(
            "friction 0.1 % above that at which the impacts slip",
            "impacts nearly slip",
            1.001 * slipping_friction(parameters(released)),
            scene=released,
            expected={"outcome": "rocks", "peak slip": 0.0, "end slip": 0.0},
        ),
        *(
            _case(
                f"slides into an impact after which the corner just {words}",
                f"impact just {words}",
                factor * SLIPS_FROM,
                motion=cosine,
                duration=2.5,
            )
            for factor, words in ((0.999, "sticks"), (1.001, "slips"))
        ),
    ]


def _swings():
    tall, broad = (
        Scene(block=BLOCK.model_copy(update={"mass": MASS, "radius": radius, "slenderness": slenderness}), duration=4.0)
        for radius, slenderness in ((1.86, 0.348), (1.044, 0.449))
    )
    return [
        _case(
            "slides and sticks within a swing; overturns without sliding",
            "saved by sliding",
            0.4,
            scene=tall,
            motion=PulseMotion("half-sine", 9.38, 6.34),
            duration=6.0,
            quick=True,
        ),
        _case(
            "slides through an impact; stays upright without sliding",
            "overturned by sliding",
            0.5,
            scene=broad,
            motion=PulseMotion("one-sine", 17.39, 10.13),
        ),
    ]


def _isolated():
    return [
        _case(
            "on bearings, slides and never lifts",
            "isolated, slides",
            0.25,
            scene=ISOLATED,
            motion=PulseMotion("one-sine", 5.0, 5.0),
            duration=5.0,
            expected={"outcome": "slides"},
        ),
        _case(
            "on bearings, slides while it lifts and overturns",
            "isolated, slides and rocks",
            0.25,
            scene=ISOLATED,
            block=caryatid_block(0.2),
            motion=PulseMotion("one-sine", 6.0, 4.0),
            duration=3.0,
        ),
    ]
