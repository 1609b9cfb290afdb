"""What is drawn: repeatable, within the promised range, and of every kind."""

import math

from analytic import synthetic_motion
from comparisons.ensembles import FRICTION, MOTIONS, PEAKS, PULSE, RECORDED, SYNTHETIC, random_scene, random_slider
from engines.simulating import RANGE

RECORDS = (synthetic_motion(seed=1).scaled(0.5), synthetic_motion(seed=2))


def test_scenes_are_repeatable_and_within_the_range():
    assert random_scene(3, 7).digest() == random_scene(3, 7).digest() != random_scene(4, 7).digest()
    scenes = [random_scene(1, index) for index in range(100)]
    drawn = {
        "slenderness": [scene.block.slenderness for scene in scenes],
        "radius": [scene.block.radius for scene in scenes],
        "inertia": [scene.block.inertia / (scene.block.mass * scene.block.radius**2) for scene in scenes],
        "base_mass": [scene.base.mass / scene.block.mass for scene in scenes if scene.base],
    }
    for name, values in drawn.items():
        assert RANGE[name][0] * (1 - 1e-12) <= min(values) < max(values) <= RANGE[name][1] * (1 + 1e-12), name


def test_scenes_with_a_friction_are_repeatable_within_the_range_and_of_every_kind():
    drawn = [random_slider(RECORDS, 1, index) for index in range(120)]
    again, other = random_slider(RECORDS, 1, 7)[0], random_slider(RECORDS, 2, 7)[0]
    assert drawn[7][0].digest() == again.digest() != other.digest()
    scenes, kinds = zip(*drawn, strict=True)
    assert set(kinds) == set(MOTIONS) and 0 < sum(scene.base is not None for scene in scenes) < 120
    assert all((scene.base is None) == (scene.bearings is None) for scene in scenes)
    assert 0 < sum(scene.motion.vertical is not None for scene in scenes) < 60
    for low, high, values in (
        (*FRICTION, [scene.friction for scene in scenes]),
        (*RANGE["slenderness"][:2], [scene.block.slenderness for scene in scenes]),
        (*PEAKS, [scene.motion.peak / (9.81 * math.tan(scene.block.slenderness)) for scene in scenes]),
    ):
        assert low <= min(values) < low + 0.2 * (high - low) and high - 0.2 * (high - low) < max(values) <= high


def test_without_records_pulses_stay_as_they_are_and_synthetic_motions_take_their_place():
    with_them, without = ([random_slider(records, 1, k) for k in range(40)] for records in (RECORDS, ()))
    assert {kind for _, kind in without} == {PULSE, SYNTHETIC}
    same = [a.digest() == b.digest() for (a, _), (b, _) in zip(with_them, without, strict=True)]
    assert same == [kind != RECORDED for _, kind in with_them] and not all(same)
