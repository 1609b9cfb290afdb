"""run and compare end with what little of the motion changes, and only where it is so."""

import json

import pytest
from own_scenes import BRONZE, CLIFF

from analytic import load_scene, simulate

CALM = 0.27  # scale at which it peaks at six tenths of uplift


def scene(tmp_path, scale):
    file = tmp_path / "bronze.toml"
    file.write_text(BRONZE.format(scale=scale))
    return file


@pytest.mark.parametrize("command", [("run",), ("run", "--engine", "exudyn"), ("compare", "--engine", "exudyn")])
def test_a_cliff_is_said_last_and_once(rocking, tmp_path, command):
    file = scene(tmp_path, CLIFF)
    own = load_scene(file)
    outcomes = {
        simulate(own.with_(motion=own.motion.scaled(1 + change)), history=False).outcome for change in (0, -0.009)
    }
    assert outcomes == {"overturns", "rocks"}
    status, out, err = rocking(command[0], file, *command[1:])
    assert status == 0, err
    last = [line for line in out.splitlines() if line.strip()][-1]
    assert (
        last == "The outcome depends on less than 5% of the motion: as it is the block overturns, at -0.90% it rocks."
    )
    assert out.count("depends on less than") == 1


@pytest.mark.parametrize("command", [("run",), ("compare", "--engine", "exudyn")])
def test_far_from_uplift_there_is_no_such_sentence(rocking, tmp_path, command):
    status, out, err = rocking(command[0], scene(tmp_path, CALM), *command[1:])
    assert status == 0, err
    assert "depends on" not in out


def test_the_json_holds_it_as_a_warning_of_its_own_kind(rocking, tmp_path):
    _, out, _ = rocking("run", scene(tmp_path, CLIFF), "--json", "-")
    (found,) = [warning for warning in json.loads(out)["warnings"] if warning["kind"] == "motion"]
    assert found["quantity"] == "outcome"
    assert found["value"] == pytest.approx(-0.009, abs=5e-4)
    assert found["limit"] == 0.05
