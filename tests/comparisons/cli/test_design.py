"""rocking design SCENE: what it names, draws and writes holds."""

import json

import numpy as np
import pytest
from own_scenes import BUST

from analytic import PulseMotion, load_scene, simulate
from analytic.advice import bearing_scan
from analytic.advice.bearing_scan import BearingScan
from analytic.rocking import BearingLaw, design_bearings, properties
from comparisons.plotting.margins import nothing_holds
from comparisons.schemas.columns import percent


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """What a design says holds on any grid; that of a user is fine (`test_roads`)."""
    monkeypatch.setattr(bearing_scan, "PERIOD_STEP", 0.2)
    monkeypatch.setattr(bearing_scan, "DAMPING_STEP", 0.05)


BEARINGS = '[bearings]\nlaw = "linear"\nka = 2e5\n'


GROUND = """\ufeff[block]
mass = 1551.83
radius = 0.989
slenderness = 0.2818
[motion]  # and these
synthetic = "duzce-like"
"""


@pytest.mark.parametrize(
    "text, name, added",
    [
        (BUST.format(bearings=""), "least-stroke", ()),
        (BUST.format(bearings=BEARINGS), "softest", ()),
        (GROUND, "least-stroke", ("--base-mass", "400.123456789")),  # put on a base, and both are written
    ],
)
def test_the_scene_it_writes_does_not_lift_and_stays_within_the_stroke(rocking, tmp_path, text, name, added):
    file, json_file = tmp_path / "a bust.toml", tmp_path / "found.json"
    file.write_text(text, encoding="utf-8")
    options = ("--write", name, "--json", json_file, "--plot", tmp_path / "b.svg")
    status, out, err = rocking("design", file, "--stroke", "0.2", *added, *options)
    assert status == 0 and f"written into {file}" in out and (tmp_path / "b.svg").stat().st_size > 1000, err
    scene, form = load_scene(file), json.loads(json_file.read_text())
    response, chosen = simulate(scene, history=False), form["chosen"][name]
    assert response.outcome == "stands" and chosen["lifts"] == 0
    assert chosen["stroke"] == response.peak_base_displacement <= scene.bearings.x_max == 0.2
    got = properties(scene.bearings, scene.total_mass, 0.2)
    assert (got.period, got.damping_equivalent) == pytest.approx((chosen["period"], chosen["damping"]), rel=1e-3)
    assert "[motion]  # and these" in file.read_text() and ("# my own words" in text) != bool(added)
    assert np.shape(form["holds"]) == (len(form["dampings"]), len(form["periods"]))
    if added:
        assert scene.base.mass == form["base_mass"] == 400.123 and "base: 400.123 kg" in out
        status, _, err = rocking("design", file, "--stroke", "0.2", *added)
        assert status == 2 and "has a base, of 400.123 kg; leave it out" in err


def test_pendula_are_found_for_a_scene_and_written(rocking, tmp_path):
    file, json_file = tmp_path / "bust.toml", tmp_path / "found.json"
    file.write_text(BUST.format(bearings=BEARINGS))
    options = ("--pendulum", "--write", "least-stroke", "--json", json_file)
    status, out, err = rocking("design", file, "--stroke", "0.2", *options)
    assert status == 0, err
    scene, chosen = load_scene(file), json.loads(json_file.read_text())["chosen"]["least-stroke"]
    response, law = simulate(scene, history=False), BearingLaw.of(scene.bearings)
    assert response.outcome == "stands" and chosen["stroke"] == response.peak_base_displacement <= 0.2
    weight = scene.total_mass * scene.gravity / scene.bearings.count
    sizes = chosen["sizes"]
    assert (sizes["kind"], sizes["reasons"], sizes["radius"], sizes["friction"]) == (
        "pendulum",
        [],  # of those that hold, one that is made
        pytest.approx(weight / law.kb),
        pytest.approx(law.f0 / weight),
    )
    got = properties(scene.bearings, scene.total_mass, 0.2)
    assert (got.period, got.damping_equivalent) == pytest.approx((chosen["period"], chosen["damping"]), rel=1e-3)
    words = " ".join(out.split())
    assert "radius of curvature [m]" in words and "friction of the bearings" in words and "alpha" not in words
    assert words.count("Not modelled: friction that depends on velocity") == 1
    assert "# Each pendulum bearing: radius of curvature" in file.read_text()


def test_a_pendulum_by_targets_gives_its_closed_forms(rocking):
    targets = "--pendulum-radius 2 --pendulum-friction 0.05 --mass 1951.83 --xmax 0.2 --count 1"
    status, out, _ = rocking("design", *targets.split())
    force = 1951.83 * 9.81 * (0.05 + 0.2 / 2)
    assert status == 0 and f"secant period {2 * np.pi * np.sqrt(1951.83 * 0.2 / force):.5g} s" in out
    assert f"{2 * np.pi * np.sqrt(2 / 9.81):.4g} s with kb alone" in out and "sliding begins at 1 mm" in out


@pytest.mark.parametrize(
    "options, message",
    [
        ("--pendulum-radius 2 --mass 1000 --xmax 0.2", "--pendulum-friction is missing"),
        ("--pendulum-radius 2 --pendulum-friction 0.05 --xmax 0.2", "--mass is missing"),
        ("--pendulum-radius 2 --pendulum-friction 0.05 --mass 1000 --xmax 0.2 --period 2", "--period: belongs to lead"),
        ("--pendulum-radius 0 --pendulum-friction 0.05 --mass 1000 --xmax 0.2", "--pendulum-radius = 0.0: give"),
        ("--pendulum --period 2 --damping 0.1 --mass 1000 --xmax 0.2", "--period: belongs to lead-rubber"),
        ("--pendulum --mass 1000", "--pendulum: belongs to a scene"),
        ("caryatid-isolated --stroke 0.3 --pendulum-radius 2", "--pendulum-radius: a target"),
        ("caryatid-isolated --stroke 0.3 --pendulum --ratio 20", "--ratio: belongs to lead-rubber"),
        ("caryatid-isolated --stroke 0.001 --pendulum", "--stroke = 0.001: a pendulum slides from 0.001 m on"),
    ],
)
def test_options_that_do_not_go_with_pendula_are_refused(rocking, options, message):
    status, _, err = rocking("design", *options.split())
    assert status == 2 and message in err


def test_where_nothing_holds_it_says_what_comes_nearest_and_writes_nothing(rocking, tmp_path):
    file = tmp_path / "bust.toml"
    file.write_text(BUST.format(bearings=""))
    status, out, _ = rocking("design", file, "--stroke", "0.01")
    assert status == 0 and "Nearest" in out
    status, _, err = rocking("design", file, "--stroke", "0.01", "--write", "softest")
    assert status == 2 and "--write" in err and file.read_text() == BUST.format(bearings="")


LIMITS = {  # {what is said to be exceeded: how far, of a run}
    "the stroke is exceeded": lambda scene, run, stroke, tilt: run.peak_base_displacement / stroke,
    "the tilt limit is exceeded": lambda scene, run, stroke, tilt: run.peak_tilt_ratio / (tilt or np.inf),
    "the block slides, the friction exceeded": lambda scene, run, stroke, tilt: (
        run.friction_demand / (scene.friction or np.inf)
    ),
    "the block lifts, the acceleration of uplift exceeded": lambda scene, run, stroke, tilt: (
        run.friction_demand / np.tan(scene.block.slenderness) if not tilt else 0.0
    ),
}


@pytest.mark.parametrize(
    "friction, stroke, tilt, limit",
    [
        (None, 0.02, 0.0, "the stroke is exceeded"),
        (None, 2.0, 0.0, "the block lifts, the acceleration of uplift exceeded"),
        (0.1, 2.0, 0.0, "the block slides, the friction exceeded"),
        (None, 2.0, 0.001, "the tilt limit is exceeded"),
    ],
)
def test_of_the_nearest_bearings_it_says_which_limit_is_exceeded_and_under_which_motion(friction, stroke, tilt, limit):
    scene = load_scene("caryatid-isolated").with_(friction=friction)
    motions = [PulseMotion("one-sine", amplitude, 8.0) for amplitude in (1.0, 6.0, 3.0)]
    periods, dampings = np.array([1.0, 2.0]), np.array([0.1, 0.2])
    designs = [design_bearings(scene.total_mass, 1.0, float(damping), 0.25) for damping in dampings]
    scan = BearingScan(periods, dampings, np.array([[3.0, 3.0], [3.0, 2.0]]), np.full((2, 2), 0.1), designs)
    words = nothing_holds(scene, scan, stroke, tilt, motions)
    held = scene.with_(bearings=scan.bearings(2.0, 0.2), duration=None, friction=None)  # it does not slide
    by_name = {
        (name, motion.label): over(scene, simulate(held.with_(motion=motion), history=False), stroke, tilt)
        for motion in motions
        for name, over in LIMITS.items()
    }
    (name, label), most = max(by_name.items(), key=lambda pair: pair[1])
    assert name == limit and f"Nearest: 2 s with 0.2 of critical damping: {limit} by {percent(most - 1)} " in words
    assert f" under {label}. The base moves by up to 0.1 m of {stroke:g}." in words


def test_where_the_block_jumps_or_overturns_on_all_bearings_the_motion_is_named(rocking, tmp_path):
    (tmp_path / "calm.csv").write_text("t [s],a [m/s2]\n" + "".join(f"{0.1 * k:.1f},{(-1) ** k}\n" for k in range(9)))
    motion = '[motion]\npulse = "one-sine"\namplitude = 40.0\nfrequency = 4.0\n'
    (tmp_path / "s.toml").write_text(f"[block]\nmass = 1.0\nradius = 1.0\nslenderness = 0.2\n{motion}")
    options = ("--stroke", 0.01, "--base-mass", 1, "--tilt", 0.5, "--records", tmp_path)
    status, out, _ = rocking("design", tmp_path / "s.toml", *options)
    words = " ".join(out.split())
    assert status == 0 and "overturns on all of them, under one-sine pulse, 40 m/s2, 4 rad/s on those of 0.3 s" in words


@pytest.mark.parametrize("mass, made", [(400.0, False), (1.6e6, True)])
def test_bearings_that_are_made_are_preferred_and_otherwise_the_first_line_warns(
    rocking, tmp_path, monkeypatch, mass, made
):
    monkeypatch.setattr(bearing_scan, "DAMPING_STEP", 0.01)
    block = f"[block]\nmass = {mass}\nradius = 8.0\nslenderness = 0.28\n[base]\nmass = {mass}\n"
    (tmp_path / "s.toml").write_text(f'{block}[motion]\nsynthetic = "duzce-like"\n')
    status, out, _ = rocking("design", tmp_path / "s.toml", "--stroke", 0.35, "--json", tmp_path / "s.json")
    words = " ".join(out.split())
    assert status == 0 and ("Warning: no such bearings are made: least-stroke" in words) != made
    assert ("meet this aim and are made." in words) == made and "under 0 of 1 motion," in words
    chosen = json.loads((tmp_path / "s.json").read_text())["chosen"]
    assert [not design["sizes"]["reasons"] for design in chosen.values()] == [made, made]


def test_a_folder_of_records_adds_motions(rocking, tmp_path):
    for name, sign in (("A000.csv", 1), ("A090.csv", -1)):
        lines = ["t [s],a [m/s2]", *(f"{0.01 * k:.2f},{sign * 2.0 * ((k // 40) % 2 - 0.5)}" for k in range(400))]
        (tmp_path / name).write_text("\n".join(lines))
    options = ("--stroke", "0.3", "--records", tmp_path, "--directions", "2", "--both-signs")
    status, out, err = rocking("design", "caryatid-isolated", *options)
    assert status == 0 and "motions: 3" in out and "mirrored the same" in err, err


def test_a_design_by_targets_is_the_papers_bearing(rocking):
    targets = "--period 2 --damping 0.3 --definition paper --xmax 0.3 --mass 3384.05"
    design = json.loads(rocking("design", *targets.split(), "--json", "-")[1])
    assert design["bearings"]["alpha"] == pytest.approx(44.69, abs=0.01)
    assert design["properties"]["period"] == pytest.approx(2.0, rel=1e-9)
