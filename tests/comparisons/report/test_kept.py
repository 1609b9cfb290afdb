"""What was drawn is found again, unless anything that it is made from has changed; damage costs a drawing, no more."""

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from drawn import ROWS, made

from comparisons.execution.plan import Study
from comparisons.execution.results import RESULTS
from comparisons.execution.writing import PlaceError
from comparisons.report import answer, kept, write

NAME = "tolerances"  # the smallest result
PACKAGE = {"code.py": "X = 1\n", "page.html": "<p>", "style.css": "p {}", "inner/script.js": "f()"}


@pytest.fixture
def drawing(tmp_path, monkeypatch):
    """Pages of one stored result and of a made-up package's code: folders, and a function that counts what is drawn."""
    monkeypatch.setattr(kept, "FOLDER", tmp_path / "cache" / "pages")
    monkeypatch.setattr(kept, "PROJECT", ("drawing_package",))
    monkeypatch.syspath_prepend(str(tmp_path))
    package = tmp_path / "drawing_package"
    studies = package / "results"  # as the shipped ones, in a package
    monkeypatch.setattr(kept, "RESULTS", studies)
    for name, text in PACKAGE.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text)
    shutil.copytree(RESULTS / NAME, studies / NAME)
    monkeypatch.setattr(write, "read_result", made)
    report = shutil.copytree(ROWS / "own", tmp_path / "report")
    done, drawn, detail = [], Study.page, write.detail
    monkeypatch.setattr(Study, "page", lambda study, result: done.append("page") or drawn(study, result))
    monkeypatch.setattr(write, "detail", lambda *words, **more: done.append(more["file"]) or detail(*words, **more))

    def draw():
        done.clear()
        write.write_page(report, studies)
        files = sorted(report.rglob("*.html"))
        own = done.count("pages/runs.html")  # the report's own runs are new each time
        return len(done) - own, {file.name: file.read_text(encoding="utf-8") for file in files}

    return SimpleNamespace(draw=draw, package=package, result=studies / NAME / "analytic.json")


def entries():
    return sorted(kept.FOLDER.glob("*"))


def test_a_second_report_is_the_same_and_draws_nothing(drawing):
    first, second = drawing.draw(), drawing.draw()
    assert (first[0], second[0]) == (2, 0) and first[1] == second[1] and len(entries()) == 2


@pytest.mark.parametrize("name", PACKAGE)
def test_a_change_of_code_template_style_or_script_draws_anew(drawing, name):
    drawing.draw()
    (drawing.package / name).write_text(PACKAGE[name] + " ")
    assert [drawing.draw()[0], drawing.draw()[0]] == [2, 0]


def test_a_new_or_renamed_file_of_code_draws_anew(drawing):
    drawing.draw()
    (drawing.package / "code.py").rename(drawing.package / "other.py")
    assert drawing.draw()[0] == 2
    (drawing.package / "more.py").write_text("")
    assert drawing.draw()[0] == 2
    (drawing.package / "__pycache__").mkdir()
    (drawing.package / "__pycache__" / "more.pyc").write_text("compiled")
    assert drawing.draw()[0] == 0


def test_a_change_of_a_result_draws_that_one_anew(drawing):
    drawing.draw()
    drawing.result.write_bytes(drawing.result.read_bytes() + b"\n")
    assert drawing.draw()[0] == 2
    other = shutil.copytree(RESULTS / "mistakes", drawing.package / "results" / "mistakes")
    assert drawing.draw()[0] == 3  # itself, and both pages with a new entry in their lists
    (other / "more").write_text("")
    assert drawing.draw()[0] == 2
    assert drawing.draw()[0] == 0


@pytest.mark.parametrize(
    "name, value",
    [
        ("version_of", lambda package: "0.0"),
        ("ENGINES", {}),
        ("BROKEN", {"crude": ValueError()}),
        ("study_names", lambda: ("swings",)),
        ("platform", SimpleNamespace(python_version=lambda: "3.0")),
    ],
)
def test_a_change_of_versions_engines_or_studies_draws_anew(drawing, monkeypatch, name, value):
    drawing.draw()
    monkeypatch.setattr(kept, name, value)
    assert drawing.draw()[0] == 2


def test_the_code_of_another_packages_engine_counts(drawing, monkeypatch):
    monkeypatch.setattr(kept, "PROJECT", ())
    monkeypatch.setattr(kept, "entry_points", lambda group: [SimpleNamespace(value="drawing_package.code:ENGINE")])
    drawing.draw()
    (drawing.package / "code.py").write_text("X = 2\n")
    assert drawing.draw()[0] == 2


@pytest.mark.parametrize("damage", [lambda stored: b"", lambda stored: stored[:-1], lambda stored: stored[:-1] + b"?"])
def test_what_is_damaged_is_drawn_anew_and_mended(drawing, damage):
    _, pages = drawing.draw()
    sound = [entry.read_bytes() for entry in entries()]
    for entry in entries():
        entry.write_bytes(damage(entry.read_bytes()))
    assert drawing.draw() == (2, pages)
    assert [entry.read_bytes() for entry in entries()] == sound and drawing.draw()[0] == 0


def test_where_nothing_can_be_written_nothing_is_kept(drawing, monkeypatch):
    kept.FOLDER.parent.write_text("a file where the folder should be")
    assert [drawing.draw()[0], drawing.draw()[0]] == [2, 2]
    kept.FOLDER.parent.unlink()

    def full(*_):
        raise PlaceError("no room")

    with monkeypatch.context() as patch:
        patch.setattr(kept, "write", full)
        assert [drawing.draw()[0], drawing.draw()[0]] == [2, 2] and not entries()
    drawing.draw()

    def read_only(*_):
        raise PermissionError(1, "read-only")

    monkeypatch.setattr(os, "utime", read_only)
    assert drawing.draw()[0] == 0  # what was kept before is used


def test_what_cannot_be_shown_is_not_kept(drawing, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(Study, "page", lambda study, result: 1 / 0)
        assert "its page fails" in drawing.draw()[1]["report.html"] and not entries()
    assert drawing.draw()[0] == 2


def test_no_study_of_another_package_is_kept(drawing, monkeypatch):
    monkeypatch.setattr(answer, "STUDIES", ())
    assert [drawing.draw()[0], drawing.draw()[0]] == [2, 2] and not entries()


def test_those_not_used_for_longest_go_first(tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    monkeypatch.setattr(kept, "MOST", 3)
    for age, key in enumerate("abc"):
        assert kept.kept(key, key.upper) == key.upper()
        os.utime(tmp_path / f"{key}.pickle", (1000.0 + age, 1000.0 + age))
    assert kept.kept("a", lambda: "made anew") == "A"
    kept.kept("d", lambda: "d")
    assert [entry.stem for entry in entries()] == ["a", "c", "d"]


def test_many_writers_and_readers_find_whole_values(tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    monkeypatch.setattr(kept, "MOST", 2)  # so that entries are removed meanwhile, too
    values = {key: key * 200_000 for key in "abc"}

    def use(number):
        key = "abc"[number % 3]
        return kept.kept(key, lambda: values[key]) == values[key]

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(use, range(240)))
    assert {entry.suffix for entry in entries()} == {".pickle"} and 2 <= len(entries()) <= 3
