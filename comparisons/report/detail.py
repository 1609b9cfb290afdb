"""A page of its own: of one study's result, or of what else the report folds away."""

import hashlib
import re
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup, escape

from ..running.age import age, briefly
from ..running.files import write_all
from ..running.plan import Study
from ..running.provenance import ResultError
from ..running.readable import readable
from ..showing import diagrams
from ..showing.charts import STYLE, colour, key_of
from ..showing.mathml import mathml
from ..showing.parts import Section, number, signed, templates, unbroken
from ..showing.wording import indexed
from ..studies.rows import read_study
from . import equations
from .answer import origin_of

HERE = Path(__file__).parent


def write_study(
    study: Study, path: str | PathLike[str], folder: str | PathLike[str] | None = None
) -> tuple[Path, Section]:
    """Write the page of the result at `path` into `folder`, by default beside it: (its path, what it says).

    Raises
    ------
    ResultError
        The result is missing or damaged, or of another study.
    PlaceError
        The page cannot be written.
    """
    path = Path(path)
    if path.name in ("", ".."):  # the folder one is in, or the one above
        path = path.resolve()
    result = read_study(path, study.name)
    old, file = age(result), path.name
    try:
        page = study.page(result).whole()
    except Exception as error:
        if old is None:  # of the very code that fails
            raise
        words = (
            f"{file}: its page cannot be drawn ({readable(repr(error))}); it is {old}; run rocking study {study.name}"
        )
        raise ResultError(words) from error
    into = (path if folder is None else Path(folder) / file).with_suffix(".html")
    html = detail(page.title, [replace(page, age=old)], origin_of(result))
    write_all(into.parent, {into.name: html})
    return into, page


def detail(
    title: str,
    sections: Iterable[Section],
    origin: str,
    *,
    pages: Sequence[Mapping[str, str]] = (),
    home: str = "",
    file: str = "",
) -> str:
    """The HTML of a page that needs no other file; pages: {"file", "title"} of those beside it, it being one of them,
    and home, the report's own; none: it stands alone.
    """
    template = environment().get_template("detail.html")
    shown = {"title": title, "sections": sections, "origin": origin}
    return template.render(**shown, pages=pages, home=home, file=file, **assets())


@cache
def environment() -> Environment:
    """The templates, with what they write numbers, formulas and the glossary's words by."""
    found = templates(HERE)
    known = {re.sub(" [^ ]$", "", word): meaning for word, meaning in equations.GLOSSARY.items()}
    words = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(known, key=len, reverse=True)))

    def glossed(text):
        """The text, its first use of each word of the glossary explained."""
        seen = set()

        def explained(found):
            if found[0] in seen:
                return found[0]
            seen.add(found[0])
            return f'<abbr title="{escape(known[found[0]])}">{found[0]}</abbr>'

        return Markup(words.sub(explained, indexed(str(escape(unbroken(text))))))

    found.filters |= {
        "math": lambda tex: Markup(mathml(tex, display=True)),
        "indexed": lambda text: Markup(indexed(str(escape(unbroken(str(text)))))),
        "glossed": glossed,
        "unbroken": unbroken,
        "briefly": briefly,
        "number": number,
        "signed": signed,
        "key": lambda who: Markup(key_of(who)),
        "colour": colour,
    }
    return found


def assets() -> dict[str, Any]:
    """Style and scripts, to stand on the page itself, and a policy that lets no others run and nothing be loaded."""
    found = {
        "style": Markup(
            "".join(file.read_text(encoding="utf-8") for file in (STYLE, diagrams.STYLE, HERE / "style.css"))
        ),
        "script": Markup((HERE / "page.js").read_text(encoding="utf-8")),
        "animation": Markup((HERE / "animation.js").read_text(encoding="utf-8")),
    }
    digests = (hashlib.sha256(found[name].encode()).digest() for name in ("script", "animation"))
    scripts = " ".join(f"'sha256-{b64encode(digest).decode()}'" for digest in digests)
    return {**found, "policy": f"default-src 'none'; style-src 'unsafe-inline'; script-src {scripts}"}
