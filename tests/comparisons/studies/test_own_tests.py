"""A shake table's tests of one's own: what the study cannot use is refused before anything is run, by file, row or
field, value and remedy; what it can use, however little it says, goes all the way to a page."""

import pytest
from answered import answered, by_model, stored
from record_files import write
from table_tests import NAMES, SCENE, book, fell, labview, own, published, pulse

from analytic import SceneError, SettingError
from comparisons.running.plan import Request
from comparisons.studies import get_study
from comparisons.studies.shake_table import campaign, study
from comparisons.studies.shake_table.campaign import FEWEST, PADDED, read_campaign
from engines import ENGINES

TESTS, ALL = 8, "motion,overturned,record\n"
ENGINE = next(iter(ENGINES))


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """A grid that is quickly run."""
    monkeypatch.setattr(campaign, "GRID", 5)
    monkeypatch.setattr(study, "KINDS", ({}, {"restitution": 0.9}, {"friction": 0.5}))


@pytest.fixture
def folder(tmp_path):
    """Sound tests of one's own."""
    place = tmp_path / "own"
    place.mkdir()
    return own(place, range(TESTS), rate=50)


def table(text):
    return {"tests.csv": text}


def scene(more, top=""):
    return {"scene.toml": f"{top}{SCENE}{more}"}


def motion(values, dt=0.02):
    return {"2.csv": f"# acceleration in m/s2, dt = {dt} s\n" + "".join(f"{value}\n" for value in values)}


def listed(*rows, head=ALL):
    return table(head + "".join(f"{row}\n" for row in rows))


# damage: (files written over the sound ones, None: removed; words of the refusal)
DAMAGE = {
    "no outcome": (listed("0.csv,maybe,a"), ("tests.csv, row 2", "overturned = 'maybe'", "write 1")),
    "an outcome that is not a number": (listed("0.csv,nan,a"), ("tests.csv, row 2", "overturned = 'nan'", "write 1")),
    "an infinite outcome": (listed("0.csv,inf,a"), ("tests.csv, row 2", "overturned = 'inf'", "write 1")),
    "a missing outcome": (listed("0.csv,0,a", "1.csv,,b"), ("tests.csv, row 3", "overturned = ''", "write 1")),
    "no column of outcomes": (listed("0.csv,1", head="motion,fell\n"), ("row 1", "no column 'overturned'")),
    "an unknown column": (listed("0.csv,1,2", head="motion,overturned,when\n"), ("row 1", "'when' is none of")),
    "a column twice": (
        listed("0.csv,1,0", head="motion,overturned,overturned\n"),
        ("row 1", "two columns are called 'overturned'", "remove one"),
    ),
    "too short a row": (listed("0.csv,1,a", "1.csv,1"), ("row 3", "holds 2 columns", "mend it")),
    "no such motion": (listed("0.csv,1,a", "9.csv,1,b"), ("row 3", "motion = '9.csv'", "cannot be read")),
    "a folder as motion": (listed(".,1,a"), ("row 2", "motion = '.'", "cannot be read")),
    "no motion": (listed(",1,a"), ("row 2", "motion = ''", "remove the row")),
    "a unit that is none": (listed("0.csv,1,m", head="motion,overturned,units\n"), ("row 2", "units = 'm'", "m/s2")),
    "a name twice": (
        listed("0.csv,1,a", "1.csv,0,a", head="motion,overturned,name\n"),
        ("two tests are called 'a'", "a name of its own"),
    ),
    "an empty list": (table(""), ("row 1", "no column 'motion'")),
    "no test": (table(ALL), ("no test has a motion",)),
    "no text": (table(b"\xff\xfe\x00"), ("tests.csv", "cannot be read")),
    "no list": ({"tests.csv": None}, (campaign.RESULTS, "tests.csv", campaign.REPOSITORY)),
    "one test": (listed("0.csv,1,a"), ("tests.csv, record = 'a'", "1 in all", "add tests under a second record")),
    "one record": (
        listed(*(f"{n}.csv,{fell(n, 0)},a" for n in range(TESTS))),
        ("tests.csv, record = 'a'", f"{TESTS} in all", "add tests under a second record"),
    ),
    "one motion under two records": (
        listed("0.csv,1,a", "1.csv,0,b", "0.csv,0,c"),
        ("tests.csv, row 4, record = 'c'", "row 2", "'a'", "one record"),
    ),
    "four tests": (
        listed(*(f"{n}.csv,{n % 2},{n}" for n in range(FEWEST - 1))),
        ("tests.csv: 4 tests", "fewer than 5 are not told", "add tests"),
    ),
    "at rest": (motion([0] * 50), ("tests.csv, row 4, motion = '2.csv'", "0 m/s2 throughout", "remove the test")),
    "constant": (motion([0.1] * 50), ("row 4, motion = '2.csv'", "0.1 m/s2 throughout", "remove the test")),
    "all but nothing": (motion(["0", "5e-324"] * 25), ("row 4, motion = '2.csv'", "no shaking", "remove the test")),
    "too short": (motion(range(PADDED)), ("row 4, motion = '2.csv'", f"holds {PADDED} samples", "the whole record")),
    "too coarse": (
        motion([0, 1, -1, 2, 0] * 5, dt=2.5),
        ("row 4, motion = '2.csv'", "sampled at 2.5 s", "less than 2.5 s", "mend its step"),
    ),
    "a sample that is no number": (motion([0, 1, "nan", 1] * 9), ("row 4, motion = '2.csv'", "2.csv", "line 4")),
    "an infinite sample": (motion([0, 1, "inf", 1] * 9), ("row 4, motion = '2.csv'", "2.csv", "line 4")),
    "an empty motion": ({"2.csv": ""}, ("row 4, motion = '2.csv'", "is empty")),
    "no scene": ({"scene.toml": None}, ("scene.toml", "cannot be read")),
    "a scene that is none": (scene("radius = 1\n"), ("scene.toml", "TOML")),
    "a mass below 0": ({"scene.toml": SCENE.replace("300.0", "-1")}, ("scene.toml", "block.mass = -1")),
    "a slenderness next to nothing": (
        {"scene.toml": SCENE.replace("0.11", "1.5e-20")},
        ("scene: a slenderness of 7.5e-21 rad", "which is tried", "1e-20 on"),
    ),
    "a restitution": (scene("restitution = 0.9\n"), ("scene.toml: block.restitution = 0.9", "leave it out")),
    "a tilt at the start": (scene("[start]\ntilt = 0.5\n"), ("scene.toml: start.tilt = 0.5", "leave it out")),
    "a rate at the start": (scene("[start]\ntilt_rate = 1\n"), ("scene.toml: start.tilt_rate = 1.0", "leave it out")),
    "a base displaced at the start": (
        scene("[base]\nmass = 9\n[start]\nbase_displacement = 0.1\n"),
        ("scene.toml: start.base_displacement = 0.1", "leave it out"),
    ),
    "a motion of the scene": (
        scene('[motion]\npulse = "one-sine"\namplitude = 4.0\nfrequency = 2.0\nvertical_ratio = 0.5\n'),
        ("scene.toml: motion = 'one-sine", "each test has its own", "leave it out"),
    ),
    "a duration": (scene("[run]\nduration = 3.0\n"), ("scene.toml: run.duration = 3.0", "leave it out")),
}


def damaged(folder, files):
    for name, text in files.items():
        if text is None:
            (folder / name).unlink()
        else:
            write(folder, text, name)
    return folder


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("files, words", DAMAGE.values(), ids=DAMAGE)
def test_what_cannot_be_used_is_refused_before_a_run(folder, files, words, quick):
    plan = study.plan(Request((), quick), data=str(damaged(folder, files)))
    with pytest.raises((SettingError, SceneError)) as caught:
        next(plan)
    said = str(caught.value)
    assert "\n" not in said and all(word in said for word in words), said


def test_the_command_ends_with_exit_code_2_and_writes_nothing(folder, rocking, tmp_path):
    damaged(folder, motion([0] * 50))
    out = tmp_path / "out"
    code, _, said = rocking("study", "shake-table", "--quick", "--data", folder, "--output", out)
    assert code == 2 and "motion = '2.csv': is 0 m/s2 throughout" in said and "Traceback" not in said
    assert not list(out.glob("*.json"))


def read_back(folder, place):
    """The result as the study's reader reads it, after its page was written."""
    answer = answered(study.plan(Request((ENGINE,)), data=str(folder)), by_model())[-1]
    result = stored(place, "shake-table", answer)
    assert get_study("shake-table").page(result).whole().tables and result.rows == answer.rows
    return result


# sound tests that say little: {files written over the sound ones}; all but a few are of the second command
LITTLE = {
    "as they are": {},
    "none overturned": listed(*(f"{n}.csv,0,{NAMES[n % 3]}" for n in range(TESTS))),
    "all overturned": listed(*(f"{n}.csv,1,{NAMES[n % 3]}" for n in range(TESTS))),
    "the smaller ones overturned": listed(*(f"{n}.csv,{int(n < 4)},{n}" for n in range(TESTS))),
    "five tests": listed(*(f"{n}.csv,{int(n > 2)},{n}" for n in range(FEWEST))),
    "five tests that end alike": listed(*(f"{n}.csv,0,{n}" for n in range(FEWEST))),
    "two records": listed(*(f"{n}.csv,{int(n % 3 == 0)},{n // 4}" for n in range(TESTS))),
    "two records, each of one outcome": listed(*(f"{n}.csv,{int(n > 3)},{n // 4}" for n in range(TESTS))),
    "one peak, which is the last sample": {f"{n}.csv": motion([0.5] * (9 + n) + [2.0])["2.csv"] for n in range(TESTS)},
    "as short as may be": motion([0, 1, -1, 2, 0] * 2),
    "as coarse as may be": motion([0, 1, -1, 2, 0] * 2, dt=2.49),
    "a block that slides": scene("", "friction = 0.05\n"),
    "a block on bearings": scene('[base]\nmass = 100.0\n[bearings]\nlaw = "linear"\nka = 2e4\n'),
    "a start at rest": scene("[start]\ntilt = 0.0\n"),
}


OFTEN = ("none overturned", "two records, each of one outcome", "one peak, which is the last sample")


@pytest.mark.parametrize(
    "files",
    [pytest.param(files, id=name, marks=() if name in OFTEN else pytest.mark.slow) for name, files in LITTLE.items()],
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_sound_tests_go_all_the_way_and_are_read_back(folder, files, tmp_path):
    result = read_back(damaged(folder, files), tmp_path)
    assert len(result.settings["tests"]) == len((folder / "tests.csv").read_text().splitlines()) - 1


def test_no_restitution_is_changed_of_a_block_that_slides(folder, tmp_path):
    """The model knows none: with it, runs of the grid would fail, and count as standing."""
    kinds = read_back(damaged(folder, scene("", "friction = 0.05\n")), tmp_path).settings["kinds"]
    assert kinds == ["as it is", "friction 0.5"]


def test_a_quick_look_keeps_five_tests_and_two_records(tmp_path):
    place = own(tmp_path, range(12), rate=50)
    assert [test.name for test in read_campaign(place, every=20).tests] == ["1", "3", "5", "7", "9", "11"]
    damaged(place, listed(*(f"{n}.csv,{fell(n, 0)},{int(n == 3)}" for n in range(12))))
    assert len(read_campaign(place, every=20).tests) == 12


def test_published_tests_are_asked_the_same(tmp_path):
    place = published(tmp_path, range(11, 14), packed=False, without=(12, 13))
    with pytest.raises(SettingError, match=rf"{campaign.RECORDS}, record = 'RSN4': no test .* \(1 in all\)"):
        read_campaign(place)
    write(place, labview(*pulse(0.0, 200)), "Test011.txt")
    with pytest.raises(SettingError, match=r"Test011.txt: is 0 m/s2 throughout, .* its file is left out\)"):
        read_campaign(place)
    titles = ["Test No. ", "Ground Motion", "PGV/PGA", "Scaled PGA (g)"]
    book(place / campaign.RECORDS, {"Sheet1": [titles, *([n, f"RSN{n}", 0.1, int(n > 11)] for n in range(11, 14))]})
    with pytest.raises(SettingError, match=rf"{campaign.RECORDS}, row 2, Scaled PGA \(g\) = 0: not above 0; fetch"):
        read_campaign(place)
