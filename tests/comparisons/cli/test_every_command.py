"""What `rocking new` writes is run; a restitution that is given is kept by an engine, and by each command."""

import json

import numpy as np
import pytest

ENGINE = "exudyn"
BUST = ("--height", 1.9, "--width", 0.55, "--material", "marble")
DESIGN = ("--base-mass", 400, "--period", 2.5, "--xmax", 0.2)
CONSTANTS = ("--base-mass", 400, "--ka", 3e4, "--kb", 3e3, "--alpha", 50)
RECORD = ("--record", "own.csv")
NEW = {
    "rigid, synthetic": BUST,
    "rigid, record": (*BUST, *RECORD),
    "rigid, tilted": (*BUST, "--tilt", 0.15),
    "by design, synthetic": (*BUST, *DESIGN),
    "by design, record": (*BUST, *DESIGN, *RECORD),
    "by constants, synthetic": (*BUST, *CONSTANTS, "--friction", 0.6),
    "by constants, record": (*BUST, *CONSTANTS, *RECORD),
    "by constants, tilted": (*BUST, *CONSTANTS, "--xmax", 0.3, "--tilt", 0.15),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Holds a record: a second and a half of noise at 50 Hz, 0.4 g."""
    made = tmp_path_factory.mktemp("scenes")
    noise = np.random.default_rng(7).normal(size=75)
    rows = [f"{0.02 * k:.2f},{4.0 * value / np.abs(noise).max():.5f}" for k, value in enumerate(noise)]
    (made / "own.csv").write_text("time [s],acc [m/s2]\n" + "\n".join(rows) + "\n")
    return made


@pytest.mark.parametrize("words", NEW.values(), ids=NEW)
def test_what_new_writes_is_run(rocking, folder, monkeypatch, words):
    monkeypatch.chdir(folder)
    assert rocking("new", "own.toml", *words)[0] == 0
    status, out, err = rocking("run", "own.toml", "--json", "-")
    (folder / "own.toml").unlink()
    assert status == 0 and json.loads(out)["outcome"] in ("stands", "rocks", "overturns"), err


BEARINGS = "[base]\nmass = 50.0\n[bearings]\nlaw = 'linear'\nka = 2000.0\n"  # (7): .81906; on the ground .90819


@pytest.mark.parametrize(
    "command, ground, given",
    [
        ("compare", "", 0.9),
        ("compare", BEARINGS, 0.75),
        pytest.param("choose", "", 0.9, marks=pytest.mark.slow),
        pytest.param("report", "", 0.9, marks=pytest.mark.long),
        pytest.param("report", BEARINGS, 0.75, marks=pytest.mark.long),
        pytest.param("choose", BEARINGS, 0.75, marks=pytest.mark.long),
    ],
)
def test_a_restitution_that_is_given_is_kept_by_the_engine(rocking, folder, monkeypatch, command, ground, given):
    monkeypatch.chdir(folder)
    file = folder / "given.toml"
    block = f"[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\nrestitution = {given}\n"
    file.write_text(block + ground + "[start]\ntilt = 0.1\n[run]\nduration = 2.0\n")
    more = ("--output", "given") if command == "report" else ()
    status, out, err = rocking(command, file, "--engine", ENGINE, *more, "--json", "-")
    answer = json.loads(out)
    assert status == int(command == "choose" and answer["chosen"] is None) and "Traceback" not in err
    if command == "compare":
        model, engine = answer["responses"]
        assert model["outcome"] == engine["outcome"] == "rocks"
        ratios = [impact["rate_after"] / impact["rate_before"] for impact in engine["impacts"][:2]]
        assert ratios == pytest.approx([given] * 2, rel=1e-3)
        assert not engine["differences"] and "restitution given" in engine["warnings"][-1]["text"]
    if command == "choose":
        assert answer["criterion"] == "tilt"
    if command == "report":
        assert "is given; here it is left out" in (folder / "given/pages/runs.html").read_text()
        rows = json.loads((folder / "given/restitution.json").read_text())["rows"]
        assert all(row["rms"] < 1e-3 for row in rows if row["tier"] == "tuned")  # of (7): none is of the given one


def test_a_variant_that_takes_no_restitution_costs_its_row_and_not_the_answer(rocking, folder, monkeypatch):
    monkeypatch.chdir(folder)
    file = folder / "given-to-defaults.toml"
    block = "[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\nrestitution = 0.9\n"
    file.write_text(block + "[start]\ntilt = 0.1\n[run]\nduration = 2.0\n")
    pytest.importorskip("pymunk")
    _, out, err = rocking("compare", file, "--engine", "pymunk", "--json", "-")
    model, engine = json.loads(out)["responses"]
    assert model["outcome"] == "rocks" and engine["outcome"] == "failed"
    assert "block.restitution = 0.9" in engine["failure"]["message"] and "pymunk failed" in err


@pytest.mark.parametrize("start, said", [("", []), ("base_velocity = 0.2\n", ["model"])])
def test_a_base_that_nothing_moves_slides_nowhere(rocking, tmp_path, start, said):
    """Review A12: it was said to slide on at -4e-15 m/s."""
    block = "[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n[base]\nmass = 50.0\n[start]\ntilt = 0.1\n"
    (tmp_path / "base.toml").write_text(block + start)
    base, *warnings = json.loads(rocking("run", tmp_path / "base.toml", "--json", "-")[1])["warnings"]
    assert base["text"].startswith("No friction is modelled under the base")
    assert [one["kind"] for one in warnings] == said and all("slides on at" in one["text"] for one in warnings)
