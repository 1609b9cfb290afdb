"""Result files: what went in comes out, says where it comes from, names no machine, and notices its age."""

import importlib
import json
import platform
import subprocess
from pathlib import Path

import numpy as np
import pytest

from analytic.scene_file import SHIPPED
from comparisons.running import provenance as module
from comparisons.running import sources
from comparisons.running.age import age, briefly, origins_of
from comparisons.running.by_solver import read, results_in
from comparisons.running.provenance import (
    RESULTS,
    ResultError,
    json_ready,
    provenance,
    read_result,
    scrub,
    write_result,
)
from comparisons.running.sources import source_digests, version_of

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


def test_no_rows_and_numbers_that_are_not_finite_are_valid_json(tmp_path):
    write_result(tmp_path / "r.json", "k", {"limit": np.inf}, [], modules=["analytic"])
    content = json.loads((tmp_path / "r.json").read_text(), parse_constant=lambda name: pytest.fail(name))
    assert content["rows"] == [] and content["settings"] == {"limit": None}
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
    def git(*words):
        subprocess.run(
            ["git", "-C", tmp_path, "-c", "user.name=n", "-c", "user.email=e", *words], check=True, capture_output=True
        )

    monkeypatch.setattr(module, "PROJECT_FOLDER", tmp_path)
    assert module.checkout() == {"commit": None, "dirty": None}
    (tmp_path / "a.py").write_text("x = 1\n")
    for words in (["init"], ["add", "a.py"], ["commit", "-m", "a"]):
        git(*words)
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
    def digest():
        return sources.source_digests(["comparisons.studies.caryatid.study:plan"])["analytic.scenes.caryatid-rigid"]

    first = digest()
    assert first in sources.digests_of_all(["analytic"])
    monkeypatch.setattr(sources, "SHIPPED", tmp_path)
    text = (SHIPPED / "caryatid-rigid.toml").read_text()
    for name in SHIPPED.glob("*.toml"):
        (tmp_path / name.name).write_text(name.read_text())
    (tmp_path / "caryatid-rigid.toml").write_text("# another comment\n" + text)
    assert digest() == first
    (tmp_path / "caryatid-rigid.toml").write_text(text.replace("slenderness = 0.28", "slenderness = 0.29"))
    assert digest() != first


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


def test_content_that_names_a_folder_of_this_machine_is_refused(tmp_path):
    with pytest.raises(ResultError, match="names a folder of this machine"):
        write_result(tmp_path / "r.json", "k", {"record": str(tmp_path / "a.AT2")}, [], modules=["analytic"])
    assert not (tmp_path / "r.json").exists()


def test_scrub_keeps_project_files_readable(tmp_path):
    here = Path(__file__)
    text = scrub(f'File "{here}", line 3\nFile "/opt/x/y.py", line 1\n{tmp_path}/z at 0x7f00aa11bb22')
    assert 'File "./tests/comparisons/running/test_provenance.py", line 3' in text and 'File "y.py", line 1' in text
    assert str(tmp_path) not in text and "0x7f" not in text


def replaced(folder, old, new):
    text = (folder / "r.json").read_text()
    assert old in text
    (folder / "r.json").write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    "spoil, words",
    [
        (lambda folder: (folder / "r.json").unlink(), "no such result file; run the study"),
        (lambda folder: (folder / "r.json").write_text("{"), "not JSON"),
        (lambda folder: (folder / "r.json").write_text("[]"), "schema None"),
        (lambda folder: replaced(folder, "1.25e-05", "1.26e-05"), "r.json: damaged, .* or run the study again"),
        (lambda folder: replaced(folder, '"rocks"', '"falls"'), "r.json: damaged"),
        (lambda folder: replaced(folder, "true", "1"), "r.json: damaged"),
        (lambda folder: replaced(folder, "1.25e-05", "1e999"), "r.json: damaged"),  # infinite
        (lambda folder: replaced(folder, '"digest"', '"dogest"'), "no result file of a study, digest"),
        (lambda folder: (folder / "r.npz").unlink(), "r.npz: missing"),
        (lambda folder: np.savez(folder / "r.npz", a=np.arange(4)), "r.npz: missing or not the one r.json was"),
    ],
)
def test_files_that_cannot_be_used_are_errors_with_a_remedy(tmp_path, spoil, words):
    path = written(tmp_path, arrays={"a": np.arange(3)})
    spoil(tmp_path)
    with pytest.raises(ResultError, match=words):
        read_result(path)


def test_another_layout_is_refused_with_the_one_that_is_read_and_who_reads_it(tmp_path):
    path = written(tmp_path)
    content = json.loads(path.read_text())

    def changed(**parts):
        path.write_text(json.dumps(content | parts))
        return path

    for schema in (1, 99, "rocking study 1"):  # that of before results had a digest
        with pytest.raises(ResultError, match=f"schema {schema!r}, this version reads 'rocking study 3', the version"):
            read_result(changed(schema=schema, provenance=content["provenance"] | {"commit": "0" * 40}))
    for origin in (None, {"commit": 7}):
        with pytest.raises(ResultError, match="schema 1, this version reads 'rocking study 3'; run"):
            read_result(changed(schema=1, provenance=origin))
    for wrong in ({"rows": [1]}, {"settings": None}, {"provenance": {}}, {"more": 1}):
        with pytest.raises(ResultError, match=f"no result file of a study, {next(iter(wrong))}"):
            read_result(changed(**wrong))
    with pytest.raises(ResultError, match=r"no result file of a study, rows\.0"):  # refused when it is written, too
        write_result(tmp_path / "r.json", "k", {}, [3], modules=["analytic"])


def test_every_committed_result_can_be_read_and_says_where_it_comes_from():
    for path in results_in(RESULTS):
        result = read(path)
        assert all(origin["commit"] for origin in origins_of(result).values()), path.name
        assert f"{path.name}-".startswith(f"{result.kind}-")  # <study>-<part> where a study has several


def test_version_by_the_name_that_is_imported(monkeypatch):
    monkeypatch.setattr("comparisons.running.sources.packages_distributions", lambda: {"imported": ["numpy"]})
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
