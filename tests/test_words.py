"""One word for one thing, in all that users read and in comments: an engine choice is a variant, of a kind (defaults,
tuned, assisted), run at a level. A setting is a number of a variant. `BETTER` lists what is not written, and what is.
"""

import ast
import io
import re
import tokenize
from pathlib import Path

import pytest

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
FORBIDDEN = [(re.compile(rf"\b(?:{pattern})(?!\w)", re.IGNORECASE), better) for pattern, better in BETTER.items()]
# Stored values and keys, which are not renamed in stored results: strings that are these alone, or name one in quotes.
STORED = ("tier", "on an edge", "default settings", "finer settings", "let go", "direction turned by 30°")
NAMES = {  # {file: words} that are names there
    "comparisons/studies/rows.py": {"tier", "impacts lost"},  # lists of columns of stored rows
    "comparisons/studies/stability/study.py": {"tier"},  # a field that becomes such a column
}
CODE = re.compile(r"``.*?``|`[^`]*`|\"(?:" + "|".join(STORED) + r")\"", re.DOTALL)
FENCED = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
SCRIPT = re.compile(r"\{[{%].*?[%}]\}|<style.*?</style>|<[^>]*>|class=\"[^\"]*\"", re.DOTALL)


def files():
    for floor in FLOORS:
        for file in sorted((PROJECT / floor).rglob("*")):
            inside = file.relative_to(PROJECT).parts
            if file.suffix in (".py", *PAGES) and "results" not in inside and "__pycache__" not in inside:
                yield file
    yield from (PROJECT / name for name in DOCUMENTS)


FILES = {str(file.relative_to(PROJECT)): file for file in files()}


def plain(node):
    """The text of a string, its computed parts left out."""
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in parts)


def strings(source):
    """(line, text) of the strings of a Python file that are sentences or heads of columns; of one word are keys."""
    tree = ast.parse(source)
    heads = {node.args[0] for node in ast.walk(tree) if _makes_a_column(node)}
    inside = {part for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr) or isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = plain(node)
            if node not in inside and text not in STORED and (" " in text or node in heads):
                yield node.lineno, text


def _makes_a_column(node):
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Column" and node.args


def comments(source):
    """(line, text) of the comments of a Python file, those of neighbouring lines as one."""
    block, begin, last = [], 0, -1
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            if token.start[0] != last + 1 and block:
                yield begin, " ".join(block)
                block = []
            begin = begin if block else token.start[0]
            block.append(token.string.lstrip("# "))
            last = token.start[0]
    if block:
        yield begin, " ".join(block)


def texts(name):
    """(line, text) of all that is read in a file."""
    source = FILES[name].read_text(encoding="utf-8")
    if name.endswith(".py"):
        yield from strings(source)
        yield from comments(source)
    else:
        left_out = FENCED if name.endswith(".md") else SCRIPT
        text = left_out.sub(lambda match: " " + "\n" * match[0].count("\n"), source)
        for paragraph in re.finditer(r"(?:.*\S.*\n?)+", text):
            yield text.count("\n", 0, paragraph.start()) + 1, paragraph[0]


def found(text):
    """[(what stands in a text, the better word)] of the words that are not written."""
    text = " ".join(CODE.sub("`", text).split())
    return [(match[0], better) for pattern, better in FORBIDDEN for match in pattern.finditer(text)]


@pytest.mark.parametrize("name", FILES)
def test_one_word_for_one_thing(name):
    wrong = [
        f"{name}:{line}: {words!r}; better: {better}"
        for line, text in texts(name)
        for words, better in found(text)
        if words not in NAMES.get(name, ())
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    "text",
    [
        "The engine at its\n    best, and with default settings.",
        "Tiers of a variant",
        "which setting of which engine suffices",
        "an engine that fails costs its own row",
        "the outcome is on an edge",
    ],
)
def test_such_words_are_found(text):
    assert found(text)


@pytest.mark.parametrize(
    "text",
    [
        "A setting of the solver; may be repeated.",
        'The key "tier" in JSON is the variant\'s kind.',
        "`Variant.tier` is now `Variant.kind`",
        "settings of compliant-corners",
        'comparable is "on an edge" near an outcome boundary',
    ],
)
def test_numbers_of_a_variant_and_stored_values_keep_their_names(text):
    assert not found(text)


def test_what_is_read_is_more_than_a_little():
    assert len(FILES) > 250 and sum(len(text) for name in FILES for _, text in texts(name)) > 500_000
