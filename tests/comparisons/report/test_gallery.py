"""The README's figures: made of the stored results, and each shown."""

from xml.etree import ElementTree

from comparisons.report.gallery import GALLERY, README, gallery, headlines, stored, with_findings


def test_the_shipped_figures_are_those_of_the_stored_results_and_stand_in_the_readme():
    made = gallery(stored())
    assert {file.name: file.read_text(encoding="utf-8") for file in GALLERY.iterdir()} == made and len(made) == 4
    readme = README.read_text(encoding="utf-8")
    for name, svg in made.items():
        assert f"comparisons/report/gallery/{name}" in readme
        root = ElementTree.fromstring(svg)
        assert root.tag == "{http://www.w3.org/2000/svg}svg" and root.get("aria-label")
        assert "prefers-color-scheme" in svg and "http://" not in svg.replace("http://www.w3.org", "")


def test_the_readme_says_what_the_stored_results_say():
    readme, words = README.read_text(encoding="utf-8"), headlines()
    assert words in readme and "| exudyn, tuned |" in words.splitlines()[0]
    assert with_findings(readme, words) == readme
    assert with_findings(readme, "- something else") != readme
