"""The Caryatid of the studies is the one of the shipped scenes."""

from analytic import load_scene
from analytic.caryatid import BASE, BEARINGS, caryatid_block


def test_the_studies_and_the_shipped_scene_have_the_same_caryatid():
    scene = load_scene("caryatid-isolated")
    assert caryatid_block(scene.block.slenderness) == scene.block
    assert (BASE, BEARINGS) == (scene.base, scene.bearings)
