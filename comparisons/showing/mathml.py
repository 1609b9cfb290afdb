"""The small part of TeX that the pages use, as MathML: browsers draw that without a script."""

import re
from html import escape

SYMBOLS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "Delta": "Δ", "xi": "ξ", "pi": "π", "phi": "φ", "omega": "ω",
    "varphi": "φ", "lambda": "λ", "mu": "μ", "eta": "η", "sigma": "σ",
}  # fmt: skip
OPERATORS = {
    "cdot": "·", "times": "×", "le": "≤", "ge": "≥", "ne": "≠", "approx": "≈", "pm": "±", "to": "→", "int": "∫",
    "oint": "∮", "infty": "∞", "ll": "≪", "sum": "∑", "Rightarrow": "⇒", "propto": "∝", "lt": "<", "gt": ">",
}  # fmt: skip
FUNCTIONS = {"sin", "cos", "tan", "ln", "log", "exp", "sgn", "max", "min"}
SPACES = {",": "0.17em", ";": "0.28em", "quad": "1em", "qquad": "2em", "!": "-0.1em"}
THIN = "<mspace width='0.17em'/>"
# {command: (number of its arguments, MathML)}. Accents are full stops: fonts without mathematics draw them clear of the
# letter.
COMMANDS = {
    **{name: (0, f"<mi>{letter}</mi>") for name, letter in SYMBOLS.items()},
    **{name: (0, f"<mo>{escape(sign)}</mo>") for name, sign in OPERATORS.items()},
    **{name: (0, f"<mi>{name}</mi>") for name in FUNCTIONS},
    **{name: (0, f"<mspace width='{width}'/>") for name, width in SPACES.items()},
    **{
        name: (1, f"<mover>{{}}<mo>{sign}</mo></mover>")
        for name, sign in (("dot", "."), ("ddot", ".."), ("tilde", "~"))
    },
    "left": (1, "{}"),
    "right": (1, "{}"),
    "sqrt": (1, "<msqrt>{}</msqrt>"),
    "frac": (2, "<mfrac>{}{}</mfrac>"),
}
NAMES = {"_": "sub", "^": "sup"}  # of scripts: msub, msup, msubsup
TOKEN = re.compile(r"\\text\{[^}]*\}|\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)


def mathml(tex: str, display: bool = False) -> str:
    """``<math>`` of a formula.

    Raises
    ------
    ValueError
        A command that is not known here, or braces that do not match.
    """
    tokens = [token for token in TOKEN.findall(tex) if not token.isspace()]
    try:
        body = _row(tokens)
    except IndexError:
        raise ValueError(f"{tex!r}: something is missing at the end") from None
    except ValueError as error:
        raise ValueError(f"{tex!r}: {error}") from None
    block = ' display="block"' if display else ""
    return f"<math{block}>{body}</math>"


def _row(tokens: list[str], closing: str | None = None) -> str:
    """MathML of the tokens up to `closing`, which are taken off the list."""
    parts: list[str] = []
    function = False
    while tokens and tokens[0] != closing:
        if tokens[0] in "^_" and parts:
            base, scripts = parts.pop(), {}
            while tokens and tokens[0] in "^_":
                kind = tokens.pop(0)
                scripts[kind] = _one(tokens)
            name = "".join(NAMES[kind] for kind in "_^" if kind in scripts)
            parts.append(f"<m{name}>{base}{scripts.get('_', '')}{scripts.get('^', '')}</m{name}>")
            continue
        if function and tokens[0] not in ("(", "\\left"):
            parts.append(THIN)  # between a function, or its power, and its argument
        function = tokens[0][1:] in FUNCTIONS
        if function and parts and not parts[-1].startswith("<mo"):
            parts.append(THIN)
        parts.append(_one(tokens))
    if closing and not tokens:
        raise ValueError("a brace is not closed")
    return "".join(parts)


def _one(tokens: list[str]) -> str:
    """MathML of the first token and its arguments, which are taken off the list."""
    token = tokens.pop(0)
    if token == "{":
        body = _row(tokens, "}")
        tokens.pop(0)
        return f"<mrow>{body}</mrow>"
    if token.startswith("\\text{"):
        return f"<mi mathvariant='normal'>{escape(token[6:-1])}</mi>"
    if token.startswith("\\"):
        if token[1:] not in COMMANDS:
            raise ValueError(f"{token} is not among the commands that the pages use")
        count, form = COMMANDS[token[1:]]
        return form.format(*(_one(tokens) for _ in range(count)))
    if token == "}":
        raise ValueError("a brace too many")
    return _letter(token)


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
    parts = text.split("$")
    parts[1::2] = map(mathml, parts[1::2])
    for i in range(0, len(parts), 2):
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(parts[i], quote=False))
        parts[i] = re.sub(r"\*([^*]+)\*", r"<em>\1</em>", words)
    return "".join(parts)
