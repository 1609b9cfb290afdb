"""One word for one thing, in all that users read and in comments: an engine choice is a variant, of a kind (defaults,
tuned, assisted), run at a level. A setting is a number of a variant. `BETTER` lists what is not written, and what is.
"""

import ast
import io
import re
import tokenize
from pathlib import Path

PROJECT = Path(__file__).parents[1]
FLOORS = ("analytic", "engines", "comparisons")
PAGES = (".html", ".jinja", ".js")
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "comparisons/results/README.md")
# {pattern that is not written: the better word}, in any case, over line breaks.
BETTER = {
    r"tiers?": "kind",
    r"rungs?|ladders?|refinement levels?": "level",
    r"set-?ups?": "variant",
    r"default variants?": "main variant (taken where none is named)",
    r"at (its|their) best": "tuned",
    r"(default|tuned) settings?": "defaults, tuned variant, or default level",
    r"(finer|coarser|coarsest|cheapest|lucky|accuracy) settings?": "level",
    r"engines?(’s|'s|s'|s’)? settings?( that|,| is| are)|which settings?|settings? of which": "variant, or level",
    r"no settings? (pass|is)|in no setting|a setting (whose|each|passes)": "variant, or level",
    r"keep restitution within": "reproduce restitution to within",
    r"miss(es)? (it|them) by": "is off by",
    r"(lost|losing|lose|loses) (an )?impacts?|impacts? (is |are |was |were |that are )?lost": "missed impact",
    r"\d+ lost": "boundaries not found, or impacts missed",
    r"direction turned by": "motion rotated by",
    r"not excluded": "95 % upper bound",
    r"too few to say": "inconclusive (too few runs)",
    r"what moves much": "large effects are reported, not tuned away",
    r"(hang|hangs|hung) on": "is sensitive to",
    r"depends? on (less than|little|such little)": "is sensitive to small changes of",
    r"(let|lets|letting) go": "released",
    r"(on|such) an edge": "near an outcome boundary",
    r"the smaller, the more": "smaller is more informative",
    r"costs? (one|its|its own|their|that|only its|only that) (row|run)": "only that row is lost",
    r"none is known; a guard": "never seen",
    r"(by|from) (sheer )?luck|lucky|unlucky": "by chance",
    r"from nowhere|in silence|next to nothing|without a word|in good order": "a plain statement",
    r"greets?|greeted": "print on import",
    r"hopeful": "that can still pass",
    r"nobody (sees|reads|asked)|no one (sees|reads|asked)": "not visible, closed, not requested",
    r"gives? way|gave way": "penetrates, or is soft",
}
FORBIDDEN = re.compile(rf"\b(?:{'|'.join(BETTER)})(?!\w)", re.IGNORECASE)
# Stored values and keys, which are not renamed in stored results.
STORED = (
    "tier",
    "on an edge",
    "default settings",
    "finer settings",
    "let go",
    "direction turned by 30°",
    "impacts lost",
)
FIELDS = ("tier", "impacts lost")  # stored, which studies list as `PARTS`
MAKERS = ("number_of", "whole_of", "word_of", "flag_of", "list_of", "table_of")
CODE = re.compile(r"``.*?``|`[^`]*`|\"(?:" + "|".join(STORED) + r")\"", re.DOTALL)
NO_TEXT = re.compile(r"^```.*?^```|\{[{%].*?[%}]\}|<style.*?</style>|<[^>]*>", re.DOTALL | re.MULTILINE)


def texts(file):
    """What is read in a file: of Python the comments, sentences and heads of columns; of a page all but its code."""
    source = file.read_text(encoding="utf-8")
    if file.suffix != ".py":
        return [NO_TEXT.sub(" ", source)]
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    comments = " ".join(token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT)
    nodes = list(ast.walk(ast.parse(source)))
    columns = (node.args for node in nodes if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Column")
    heads = [given[0] for given in columns if given]
    makers = (node.args for node in nodes if isinstance(node, ast.Call) and getattr(node.func, "id", "") in MAKERS)
    heads += [given[1] for given in makers if len(given) > 1]  # of declared columns
    words = [node for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    read = [node.value for node in words if " " in node.value or node in heads]
    return [comments, *(text for text in read if text not in STORED)]


def test_one_word_for_one_thing():
    files = [file for floor in FLOORS for file in (PROJECT / floor).rglob("*") if file.suffix in (".py", *PAGES)]
    files += [PROJECT / name for name in DOCUMENTS]
    found = [
        f"{file.relative_to(PROJECT)}: {match[0]!r}; BETTER says what is written instead"
        for file in files
        if "results" not in file.parts or file.suffix == ".md"
        for text in texts(file)
        for match in FORBIDDEN.finditer(" ".join(CODE.sub("`", text).split()))
        if match[0] not in FIELDS or "studies" not in file.parts or file.name not in ("study.py", "rows.py")
    ]
    assert len(files) > 150 and not found, "\n".join(found)
