"""Scenes of blocks that may slide, drawn at random."""

import math

from bearing_laws import NAMES, bearings_of

from analytic import Base, Block, PulseMotion, Scene, load_scene

CARYATID = load_scene("caryatid-isolated")
GRAVITY = 9.81


def scene_of(friction, slenderness=0.2, radius=1.0884, base=None, **parts):
    """The Caryatid's mass on rigid ground, or on its bearings and a base of the given mass."""
    block = Block(mass=3172.05, radius=radius, slenderness=slenderness)
    bearings = CARYATID.bearings if base else None
    return Scene(block=block, base=base and Base(mass=base), bearings=bearings, friction=friction, **parts)


# Reference cases 19, saved by sliding, and 21, overturned by it; and one that slides only.
SAVED = scene_of(0.4, 0.348, 1.86, motion=PulseMotion("half-sine", 9.38, 6.34), duration=4.0)
LOST = scene_of(0.5, 0.449, 1.044, motion=PulseMotion("one-sine", 17.39, 10.13), duration=3.0)
SLIDES = scene_of(0.2, 0.4, motion=PulseMotion("rectangular", 4.0, 6.0), duration=2.0)
# The first flies, and lands on the same side; the second, released, passes the upright in the air.
LANDS = scene_of(
    0.6,
    0.25,
    1.0,
    motion=PulseMotion("one-sine", 4.0, 12.0, vertical=PulseMotion("one-sine", 10.0, 12.0)),
    duration=4.0,
)
PASSES = scene_of(
    1.5,
    0.25,
    1.0,
    start={"tilt": 0.15},
    motion=PulseMotion("one-sine", 0.5, 12.0, start=0.4, vertical=PulseMotion("one-sine", -20.0, 12.0, start=0.4)),
    duration=4.0,
)


def random_slider(rng, number):
    """A statue at rest under a pulse above uplift, with friction; every second one on bearings, some with a_v."""
    radius, slenderness = float(10 ** rng.uniform(-0.5, 0.7)), float(rng.uniform(0.12, 0.45))
    omega = math.sqrt(0.75 * GRAVITY / radius)
    shape = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")[number % 5]
    a, w = GRAVITY * math.tan(slenderness) * rng.uniform(1.02, 4.0), omega * rng.uniform(1.5, 6.0)
    up = PulseMotion(shape, float(a * rng.choice([0.5, -1.0, 3.0])), float(w)) if number % 3 == 0 else None
    motion = PulseMotion(shape, float(a), float(w), vertical=up)
    duration = motion.end + 6 / omega
    scene = scene_of(float(rng.uniform(0.05, 1.0)), slenderness, radius, motion=motion, duration=duration)
    if number % 2:
        return scene
    mass = float(scene.block.mass * rng.uniform(0.1, 2.0))
    stiff = (scene.block.mass + mass) * (2 * math.pi / rng.uniform(1, 3)) ** 2 / 4
    keys = {"ka": 10 * stiff, "kb": stiff, "count": 4, "damping": float(rng.choice([0.0, 100.0]))}
    name = NAMES[number // 2 % len(NAMES)]
    return scene.with_(base=Base(mass=mass), bearings=bearings_of(name, **keys))


KINDS = ("vertical motion", "bilinear", "bouc-wen", "viscous", "ricker", "flight")


def slider_of(kind, rng):
    """A statue at rest under a pulse above uplift, with what `kind` says; every bearing law has its own kind."""
    radius, slenderness = float(10 ** rng.uniform(-0.5, 0.7)), float(rng.uniform(0.12, 0.45))
    omega = math.sqrt(0.75 * GRAVITY / radius)
    shape = "ricker" if kind == "ricker" else str(rng.choice(["one-sine", "one-cosine", "half-sine"]))
    a, w = GRAVITY * math.tan(slenderness) * rng.uniform(1.02, 4.0), omega * rng.uniform(1.5, 6.0)
    up = {"vertical motion": a * rng.uniform(0.2, 1.0), "flight": GRAVITY * rng.uniform(1.2, 2.5)}.get(kind)
    vertical = up and PulseMotion(shape, float(up * rng.choice([-1, 1])), float(w))
    motion = PulseMotion(shape, float(a), float(w), vertical=vertical)
    duration = motion.end + 4 / omega
    scene = scene_of(float(rng.uniform(0.05, 0.7)), slenderness, radius, motion=motion, duration=duration)
    law = {"bilinear": "bilinear", "bouc-wen": "bouc-wen", "viscous": "algebraic"}.get(kind)
    if law is None and rng.random() < 0.5:
        return scene
    mass = float(scene.block.mass * rng.uniform(0.1, 2.0))
    stiff = (scene.block.mass + mass) * (2 * math.pi / rng.uniform(1, 3)) ** 2 / 4
    share = rng.uniform(0.05, 0.3) if kind == "viscous" else 0.0
    damping = float(share * math.sqrt(4 * stiff * (scene.block.mass + mass)) / 2)
    bearings = bearings_of(law or "algebraic", ka=10 * stiff, kb=stiff, count=4, damping=damping)
    return scene.with_(base=Base(mass=mass), bearings=bearings)
