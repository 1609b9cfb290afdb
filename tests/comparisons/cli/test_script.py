"""``rocking script`` as a user calls it."""

import pytest


def test_the_script_and_its_record_are_written(rocking, tmp_path):
    status, out, err = rocking("script", "pybullet", "caryatid-isolated", "--output", tmp_path / "own.py")
    assert status == 0, err
    assert out.split() == [str(tmp_path / "own.py"), "written", str(tmp_path / "own-motion.txt"), "written"]
    assert "own-motion.txt" in (tmp_path / "own.py").read_text()
    assert (tmp_path / "own-motion.txt").read_text().startswith("# time [s], ground acceleration [m/s2]\n0 ")


def test_without_a_name_it_is_the_scenes_and_the_engines(rocking, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = rocking("script", "pybullet", "free-rocking-rigid")
    (file,) = tmp_path.iterdir()
    assert status == 0 and file.name.endswith("-pybullet.py") and out == f"{file.name} written\n"


@pytest.mark.parametrize(
    "arguments, message",
    [
        (("mujoco", "caryatid-rigid"), "mujoco: no engine with a script; choose one of"),
        (("bullet", "caryatid-rigid"), "bullet: no engine with a script; choose one of"),
        (("pybullet", "caryatid-rigid", "--output", "own.txt"), "--output own.txt: end the name in .py"),
        (("pybullet", "nowhere"), "nowhere"),
    ],
)
def test_mistakes_are_named(rocking, arguments, message):
    status, _, err = rocking("script", *arguments)
    assert status == 2 and message in err


def test_a_friction_that_the_script_does_not_keep_is_named(rocking, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        "friction = 0.6\n[block]\nmass = 300.0\nradius = 1.0\nslenderness = 0.2\nrestitution = 0.8\n"
        "[start]\ntilt = 0.12\n"
    )
    status, out, err = rocking("script", "pybullet", scene, "--output", tmp_path / "own.py")
    assert status == 0, err
    assert "The scene's friction, 0.6, is not kept, and the block does not slide: below 4.93 it slips" in out
