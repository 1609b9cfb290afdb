"""``rocking lessons``: the pages are written, and lead to nothing outside them."""

import re


def test_pages_lead_to_nothing_outside(rocking, tmp_path):
    status, out, _ = rocking("lessons", "export", "--output", tmp_path / "pages")
    assert status == 0
    written = out.split()
    assert len(written) == len(list((tmp_path / "pages").iterdir()))
    for file in (tmp_path / "pages").glob("*.html"):
        leads = re.findall(r"""(?:src|href)=["']?([^"'\s>]+)""", file.read_text(encoding="utf-8"))
        beside = [lead.split("#")[0] for lead in leads if not lead.startswith(("data:", "#"))]
        assert all((tmp_path / "pages" / lead).exists() for lead in beside)


def test_a_file_in_place_of_the_folder_is_refused(rocking, tmp_path):
    (tmp_path / "pages").write_text("")
    status, _, err = rocking("lessons", "export", "--output", tmp_path / "pages")
    assert status == 2 and "give a folder" in err
