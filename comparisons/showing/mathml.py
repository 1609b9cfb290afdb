"""The small part of TeX that the pages use, as MathML: browsers draw that without a script."""

from __future__ import annotations

import re
from html import escape

SYMBOLS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "Delta": "Δ", "xi": "ξ", "pi": "π", "phi": "φ", "omega": "ω",
    "varphi": "φ", "lambda": "λ",
}  # fmt: skip
OPERATORS = {
    "cdot": "·", "times": "×", "le": "≤", "ge": "≥", "ne": "≠", "approx": "≈", "pm": "±", "to": "→", "int": "∫",
    "oint": "∮", "infty": "∞", "ll": "≪", "sum": "∑", "Rightarrow": "⇒", "propto": "∝", "lt": "<", "gt": ">",
}  # fmt: skip
FUNCTIONS = {"sin", "cos", "tan", "ln", "log", "exp", "sgn", "max", "min"}
ACCENTS = {
    "dot": ".",
    "ddot": "..",
    "tilde": "~",
}  # full stops: fonts without mathematics draw them clear of the letter
SPACES = {",": "0.17em", ";": "0.28em", "quad": "1em", "qquad": "2em", "!": "-0.1em"}
THIN = "<mspace width='0.17em'/>"
TOKEN = re.compile(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)


def mathml(tex: str, display: bool = False) -> str:
    """``<math>`` of a formula.

    Raises
    ------
    ValueError
        A command that is not known here, or braces that do not match.
    """
    tokens = [token for token in TOKEN.findall(tex) if not token.isspace()]
    body, _ = _row(tokens, None, tex)
    block = ' display="block"' if display else ""
    return f"<math{block}>{body}</math>"


def _row(tokens, closing, tex):
    """(MathML of the tokens up to `closing`, tokens after it)."""
    parts: list[str] = []
    function = False
    while tokens:
        if tokens[0] == closing:
            return "".join(parts), tokens[1:]
        if tokens[0] in "^_" and parts:
            scripts = {}
            base = parts.pop()
            while tokens and tokens[0] in "^_":
                kind = tokens[0]
                scripts[kind], tokens = _one(tokens[1:], tex)
            if len(scripts) == 2:
                parts.append(f"<msubsup>{base}{scripts['_']}{scripts['^']}</msubsup>")
            elif "_" in scripts:
                parts.append(f"<msub>{base}{scripts['_']}</msub>")
            else:
                parts.append(f"<msup>{base}{scripts['^']}</msup>")
            continue
        if function and tokens[0] not in ("(", "\\left"):
            parts.append(THIN)  # between a function, or its power, and its argument
        function = tokens[0][1:] in FUNCTIONS
        if function and parts and not parts[-1].startswith("<mo"):
            parts.append(THIN)
        part, tokens = _one(tokens, tex)
        parts.append(part)
    if closing:
        raise ValueError(f"{tex!r}: a brace is not closed")
    return "".join(parts), []


def _one(tokens, tex):
    """(MathML of the first token and its arguments, tokens after them)."""
    if not tokens:
        raise ValueError(f"{tex!r}: something is missing at the end")
    token, rest = tokens[0], tokens[1:]
    if token == "}":
        raise ValueError(f"{tex!r}: a brace too many")
    if token == "{":
        body, rest = _row(rest, "}", tex)
        return f"<mrow>{body}</mrow>", rest
    if not token.startswith("\\"):
        return _letter(token), rest
    name = token[1:]
    if name in SYMBOLS:
        return f"<mi>{SYMBOLS[name]}</mi>", rest
    if name in OPERATORS:
        return f"<mo>{escape(OPERATORS[name])}</mo>", rest
    if name in FUNCTIONS:
        return f"<mi>{name}</mi>", rest
    if name in SPACES:
        return f"<mspace width='{SPACES[name]}'/>", rest
    if name in ("left", "right"):
        return _letter(rest[0]), rest[1:]
    if name in ACCENTS:
        body, rest = _one(rest, tex)
        return f"<mover>{body}<mo>{ACCENTS[name]}</mo></mover>", rest
    if name == "sqrt":
        body, rest = _one(rest, tex)
        return f"<msqrt>{body}</msqrt>", rest
    if name == "frac":
        above, rest = _one(rest, tex)
        below, rest = _one(rest, tex)
        return f"<mfrac>{above}{below}</mfrac>", rest
    if name == "text" and rest[:1] == ["{"] and "}" in rest:
        end = rest.index("}")
        return f"<mi mathvariant='normal'>{escape(''.join(rest[1:end]))}</mi>", rest[end + 1 :]
    raise ValueError(f"{tex!r}: \\{name} is not among the commands that the pages use")


def _letter(token):
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token.isalpha():
        return f"<mi>{token}</mi>"
    if token in "|()[]":
        return f"<mo stretchy='false' lspace='0' rspace='0'>{token}</mo>"
    return f"<mo>{escape({'-': '−', chr(39): '′', '*': '·'}.get(token, token))}</mo>"


def prose(text: str) -> str:
    """HTML of a paragraph with ``$formulas$``, `code` and *emphasis*."""
    parts = []
    for i, part in enumerate(text.split("$")):
        if i % 2:
            parts.append(mathml(part))
            continue
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(part, quote=False))
        parts.append(re.sub(r"\*([^*]+)\*", r"<em>\1</em>", words))
    return "".join(parts)
