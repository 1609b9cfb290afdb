"""Result files: what went in comes out, says where it comes from, names no machine, and notices its age."""

import importlib
import json
import platform
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from analytic.scene_file import SHIPPED
from comparisons.execution import code_digests
from comparisons.execution import results as module
from comparisons.execution.by_solver import age, briefly, origins_of, read, results_in
from comparisons.execution.code_digests import source_digests, version_of
from comparisons.execution.results import RESULTS, ResultError, json_ready, provenance, read_result, scrub, write_result

ROWS = [{"engine": "exudyn", "error": 1.25e-5, "outcome": "rocks"}, {"engine": "analytic", "error": 0.1 + 0.2}]


def written(folder, **options):
    return write_result(folder / "r.json", "restitution", {"quick": True}, ROWS, modules=["analytic"], **options)


def test_a_result_comes_back_as_it_was(tmp_path):
    arrays = {"map": np.linspace(0, 1, 12).reshape(3, 4), "empty": np.empty((0, 2))}
    result = read_result(written(tmp_path, arrays=arrays, seed=7))
    assert (result.kind, result.settings, result.rows) == ("restitution", {"quick": True}, ROWS)
    assert result.provenance["seed"] == 7
    np.testing.assert_equal(result.arrays, arrays)
    assert read_result(written(tmp_path)).arrays == {}
    assert (tmp_path / "r.json").read_text().count("\n  {") == len(ROWS)  # a row a line
    assert json_ready((np.float64(1.5), np.arange(2), float("nan"), True)) == [1.5, [0, 1], None, True]


def test_provenance_names_machine_versions_and_sources_but_neither_paths_nor_host():
    here = provenance(["engines", "analytic"], seed=[1, 2])
    assert here["machine"]["logical_cores"] >= 1 and here["machine"]["memory_gib"] > 0
    assert here["packages"]["numpy"] == np.__version__ and here["python"] == platform.python_version()
    assert [*here["sources"]] == ["engines", "analytic"] and all(here["sources"].values())
    text = json.dumps(here)
    assert str(Path.home()) + "/" not in text and str(Path(__file__).parents[3]) not in text
    assert platform.node() not in text.split('"')


def test_commit_and_dirty_flag_are_those_of_the_checkout_and_none_outside(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "PROJECT_FOLDER", tmp_path)
    assert module.checkout() == {"commit": None, "dirty": None}
    (tmp_path / "a.py").write_text("x = 1\n")
    for words in (["init"], ["add", "a.py"], ["commit", "-m", "a"]):
        git = ["git", "-C", tmp_path, "-c", "user.name=n", "-c", "user.email=e"]
        subprocess.run([*git, *words], check=True, capture_output=True)
    first = module.checkout()
    assert len(first["commit"]) == 40 and first["dirty"] is False
    (tmp_path / "a.py").write_text("x = 2\n")
    assert module.checkout() == {"commit": first["commit"], "dirty": True}
    (tmp_path / "inner").mkdir()
    monkeypatch.setattr(module, "PROJECT_FOLDER", tmp_path / "inner")
    assert module.checkout()["commit"] is None  # installed inside some other checkout


def test_age_names_the_definitions_and_packages_that_changed(tmp_path):
    result = read_result(written(tmp_path))
    result.provenance["packages"]["absent"] = "1.0"
    assert age(result) is None
    result.provenance["packages"]["numpy"] = "1.0"
    assert age(result) == f"computed with other versions than those here: numpy 1.0 (here {np.__version__})"
    scene = source_digests(["analytic"])["analytic.scene.Scene"]
    result.provenance["sources"]["analytic"] = result.provenance["sources"]["analytic"].replace(scene, "")
    result.provenance["sources"]["analytic.gone"] = ""
    assert age(result).startswith("older than the code: computed on 2")
    assert "since then changed: analytic.gone, analytic.scene.Scene; computed with" in age(result)
    result.provenance["commit"] = None
    assert "outside a checkout" in age(result)


def test_a_shipped_scene_counts_where_a_module_names_it_but_its_comments_do_not(tmp_path, monkeypatch):
    shutil.copytree(SHIPPED, tmp_path / "scenes")
    file, digests = tmp_path / "scenes" / "caryatid-rigid.toml", []
    text = file.read_text()
    monkeypatch.setattr(code_digests, "SHIPPED", file.parent)
    for words in (text, "# another comment\n" + text, text.replace("slenderness = 0.28", "slenderness = 0.29")):
        file.write_text(words)
        result = code_digests.source_digests(["comparisons.studies.caryatid.study:plan"])
        digests.append(result["analytic.scenes.caryatid-rigid"])
    assert digests[0] == digests[1] != digests[2] and digests[2] in code_digests.digests_of_all(["analytic"])


def test_a_result_survives_a_rename_but_no_change(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    folder = tmp_path / "renamed_package"
    (folder / "inner").mkdir(parents=True)
    (folder / "__init__.py").touch()
    (folder / "one.py").write_text("from .two import f\n\ndef g():\n    return f() + 1\n")
    (folder / "two.py").write_text("def f():\n    return 1\n")
    importlib.invalidate_caches()
    result = read_result(write_result(tmp_path / "r.json", "k", {}, [], modules=["renamed_package.one:g"]))
    (folder / "two.py").rename(folder / "inner" / "second.py")
    (folder / "one.py").write_text('"""Moved."""\nfrom .inner.second import f\n\ndef g():\n    return f() + 1\n')
    assert age(result) is None
    (folder / "inner" / "second.py").write_text("def f():\n    return 2\n")
    assert age(result).endswith("since then changed: renamed_package.inner.second.f")


def test_scrub_keeps_project_files_readable(tmp_path):
    here = Path(__file__)
    text = scrub(f'File "{here}", line 3\nFile "/opt/x/y.py", line 1\n{tmp_path}/z at 0x7f00aa11bb22')
    assert 'File "./tests/comparisons/execution/test_results.py", line 3' in text and 'File "y.py", line 1' in text
    assert str(tmp_path) not in text and "0x7f" not in text


@pytest.mark.parametrize(
    "file, old, new, words",
    [
        ("r.json", None, None, "no such result file; run the study"),
        ("r.json", None, "{", "not JSON"),
        ("r.json", None, "[]", "schema None"),
        ("r.json", "1.25e-05", "1.26e-05", "r.json: damaged, .* or run the study again"),
        ("r.json", "true", "1", "r.json: damaged"),
        ("r.json", "1.25e-05", "1e999", "r.json: damaged"),  # infinite
        ("r.json", '"digest"', '"dogest"', "no result file of a study, digest"),
        ("r.npz", None, None, "r.npz: missing"),
        ("r.npz", None, "another", "r.npz: missing or not the one r.json was"),
        ("r.json", '"rocking study 3"', "1", "schema 1, this version reads 'rocking study 3', the version"),
        ("r.json", '"rocking study 3"', '"rocking study 1"', "schema 'rocking study 1', this version"),
    ],
)
def test_files_that_cannot_be_used_are_errors_with_a_remedy(tmp_path, file, old, new, words):
    path = written(tmp_path, arrays={"a": np.arange(3)})
    text = new if old is None else path.read_text().replace(old, new, 1)
    assert old is None or text != path.read_text()
    (tmp_path / file).unlink()
    if text is not None:
        (tmp_path / file).write_text(text)
    with pytest.raises(ResultError, match=words):
        read_result(path)


@pytest.mark.parametrize("parts", [{"rows": [1]}, {"settings": None}, {"provenance": {}}, {"more": 1}])
def test_what_is_no_result_is_named(tmp_path, parts):
    path = written(tmp_path)
    path.write_text(json.dumps(json.loads(path.read_text()) | parts))
    with pytest.raises(ResultError, match=f"no result file of a study, {next(iter(parts))}"):
        read_result(path)


@pytest.mark.parametrize("origin", [None, {"commit": 7}])
def test_of_a_layout_without_a_commit_no_version_is_named(tmp_path, origin):
    path = written(tmp_path)
    path.write_text(json.dumps(json.loads(path.read_text()) | {"schema": 1, "provenance": origin}))
    with pytest.raises(ResultError, match="schema 1, this version reads 'rocking study 3'; run"):
        read_result(path)


def test_what_is_no_row_or_names_a_folder_of_this_machine_is_not_written(tmp_path):
    for settings, rows, words in (
        ({}, [3], r"no result file of a study, rows\.0"),
        ({"record": str(tmp_path / "a.AT2")}, [], "names a folder of this machine"),
    ):
        with pytest.raises(ResultError, match=words):
            write_result(tmp_path / "r.json", "k", settings, rows, modules=["analytic"])
    assert not (tmp_path / "r.json").exists()


def test_every_committed_result_can_be_read_and_says_where_it_comes_from():
    for path in results_in(RESULTS):
        result = read(path)
        assert all(origin["commit"] for origin in origins_of(result).values()), path.name
        assert f"{path.name}-".startswith(f"{result.kind}-")  # <study>-<part> where a study has several


def test_version_by_the_name_that_is_imported(monkeypatch):
    monkeypatch.setattr("comparisons.execution.code_digests.packages_distributions", lambda: {"imported": ["numpy"]})
    assert version_of("imported") == np.__version__ == version_of("numpy")
    assert version_of("not_there") is None


@pytest.mark.parametrize(
    "words, brief",
    [
        ("older than the code: computed on 2026-01-01 at commit abc; since then changed: a", "older than the code"),
        ("apart from the rows of b older than the code: computed on 2026-01-01", "in part older than the code"),
        ("in the rows of b older than the code: computed on 2026-01-01", "in part older than the code"),
        ("computed with other versions than those here: b 1 (here 2)", "computed with other versions"),
    ],
)
def test_a_heading_says_that_it_is_old_and_not_why(words, brief):
    assert briefly(words) == brief
