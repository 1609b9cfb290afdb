"""Mistakes are data that fit the scripts: their texts occur once, and one that does not says so."""

import ast

import pytest

from analytic import load_scene
from comparisons.measuring.scripts import with_mistake
from comparisons.studies.mistakes.study import scenes
from engines import ENGINES
from engines.mistakes import GROUPS, NO_MATTER, Mistake

ABLE = [name for name, engine in ENGINES.items() if engine.mistakes]


@pytest.mark.parametrize("name", ABLE)
def test_every_mistake_can_be_made_in_every_scene_that_has_what_it_concerns(name):
    engine = ENGINES[name]
    for place, scene in scenes().items():
        plain = with_mistake(engine, scene, None)
        for mistake in engine.known_mistakes().values():
            if mistake.fits(scene):
                files = with_mistake(engine, scene, mistake)
                assert files.keys() == plain.keys() and files != plain, (place, mistake.key)
                ast.parse(files["script.py"])


@pytest.mark.parametrize("name", ABLE)
def test_mistakes_differ_concern_all_there_is_and_are_made_somewhere(name):
    known = ENGINES[name].known_mistakes()
    assert len({tuple(one.replacements.items()) for one in known.values()}) == len(known)
    assert {one.group for one in known.values()} == set(GROUPS)
    assert all(any(one.fits(scene) for scene in scenes().values()) for one in known.values())
    assert all(len(one.key) <= 20 and one.done[0].isupper() or one.done[0].isdigit() for one in known.values())


def test_a_text_that_is_not_there_once_is_named_with_the_mistake_and_the_remedy():
    mistake = Mistake("twice", "Something", "body", {"a = 1": "a = 2"})
    assert mistake.made("a = 1\n") == "a = 2\n"
    for script, count in (("b = 1\n", 0), ("a = 1\na = 1\n", 2)):
        words = rf"^mistake twice: its text 'a = 1' occurs {count} times .* take the text from the engine's template"
        with pytest.raises(ValueError, match=words):
            mistake.made(script)


def test_a_group_that_is_unknown_is_an_error():
    with pytest.raises(ValueError, match="group 'colour'; choose one of body, "):
        Mistake("odd", "Something", "colour", {})


@pytest.mark.parametrize(
    "needs, fitting",
    [
        ("", {"free-rocking-rigid", "free-rocking-isolated", "caryatid-rigid", "caryatid-isolated"}),
        ("bearings", {"free-rocking-isolated", "caryatid-isolated"}),
        ("record", {"caryatid-rigid", "caryatid-isolated"}),
        ("base motion", {"caryatid-isolated"}),
    ],
)
def test_a_mistake_fits_scenes_that_have_what_it_concerns(needs, fitting):
    mistake = Mistake("one", "Something", NO_MATTER, {}, needs)
    names = ("free-rocking-rigid", "free-rocking-isolated", "caryatid-rigid", "caryatid-isolated")
    assert {name for name in names if mistake.fits(load_scene(name))} == fitting


def test_an_engine_without_mistakes_has_none():
    assert ENGINES["mujoco"].known_mistakes() == {}
