"""``rocking lessons``: listed, opened, and written as pages that lead to nothing outside them."""

import re
from pathlib import Path

import pytest

from comparisons.lessons import export, notebook
from comparisons.lessons.topics import lesson, lessons


def test_without_a_command_they_are_listed(rocking):
    status, out, _ = rocking("lessons")
    assert status == 0
    assert all(lesson.name in out for lesson in lessons())


def test_a_notebook_opens_as_a_copy(rocking, monkeypatch):
    pytest.importorskip("marimo", reason="needs marimo: pip install marimo")

    def call(command):
        copy = Path(command[-1])
        assert command[1:4] == ["-m", "marimo", "edit"] and copy.read_text() == notebook.notebook_of(lessons()[5])
        assert "auto_instantiate = true" in copy.with_name("pyproject.toml").read_text()
        return 7

    monkeypatch.setattr(notebook.subprocess, "call", call)
    assert rocking("lessons", "open", "chaos")[0] == 7


def test_a_folder_called_as_an_option_is_a_folder(rocking, monkeypatch, tmp_path):
    pytest.importorskip("marimo", reason="needs marimo: pip install marimo")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(notebook.subprocess, "call", lambda command: command[-1] != str(tmp_path / "-" / "chaos.py"))
    assert rocking("lessons", "open", "chaos", "--to=-")[0] == 0


def test_without_marimo_it_says_what_to_install(rocking, monkeypatch):
    monkeypatch.setattr(notebook.importlib.util, "find_spec", lambda name: None)
    status, _, err = rocking("lessons", "open", "chaos")
    assert status == 2 and "pip install marimo" in err


def test_pages_lead_to_nothing_outside(rocking, tmp_path, monkeypatch):
    monkeypatch.setattr(export, "lessons", lambda: [lesson("bearing")])
    monkeypatch.setattr(export, "_lesson_page", lambda *parts: "<!DOCTYPE html><title>left out</title>")
    status, out, err = rocking("lessons", "export", "--output", tmp_path / "pages")
    assert status == 0 and out.strip() == str(tmp_path / "pages" / "index.html")
    assert err.startswith("8 lessons\n")  # said as it begins, as it takes long
    pages = list((tmp_path / "pages").glob("*.html"))
    assert len(pages) == 5
    for file in pages:
        leads = re.findall(r"""(?:src|href)=["']([^"']+)""", file.read_text(encoding="utf-8"))
        beside = [lead.split("#")[0] for lead in leads if not lead.startswith(("data:", "#"))]
        assert [lead for lead in beside if not (tmp_path / "pages" / lead).exists()] == []
