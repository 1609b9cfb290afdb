"""The Caryatid of the studies is the one of the shipped scenes."""

from analytic import load_scene
from analytic.caryatid import BASE, BEARINGS, caryatid_block


def test_the_studies_and_the_shipped_scene_have_the_same_caryatid():
    scene = load_scene("caryatid-isolated")
    assert caryatid_block(scene.block.slenderness) == scene.block
    # the studies count displacements beyond x_max themselves, and their runs do not speak of it
    assert (BASE, BEARINGS) == (scene.base, scene.bearings.model_copy(update={"x_max": None}))
