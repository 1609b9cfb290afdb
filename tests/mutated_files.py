"""What damage makes of small files: the same for the same seed."""

import random

SIGNS = 2 * "0123456789" + "+-..,,;:eEdD \t\n\r=()[]/^*_#%!\"'gGmMsScC²³٣\u00a0\ufeff\x00\x1a"
WORDS = (
    "nan|-inf|1E400|1e-400|1_000|0x1F|.|-|E-05|1.5.2|9999999999999999999999999999999999999999|*******|1,5|1;5|"
    ".1025061E-1022243E-01|-.10-100|1e-105|1e-012|²|G|CM/S|CM/S/S|cm/s2|m/s**2|gal|UNITS OF M/S2|units: g|"
    'VELOCITY|(ms)|ms|NPTS= 12|DT= .01|true|[]|{}|[block]|1979-05-27|\'a\'|"|"""|a.b = 1|seed = -1|1e41|-1.0|0|'
    "# 1 2|Hz|200Hz|sps|200 sps|muestras/s|200 samples per second|dt = 5|T|Sa|Period|Hz sampling|acc_cms2|"
    "(counts)|_foo2|spectrum|24|NO. OF POINTS: 24|samples: 24|step|0.005 s intervals|time_ms|dt = 0.005 s|dt:|"
    "# dt = .01|Abtastrate|Sampling rate: 200|fs|fs = 100 Hz|sampling interval of|1,000|0,005|(gal)|[gals]|"
    "gal(cm/s/s)|_gal|unidades|Zeit|DataSequence:|# gal|kHz|per second|is|=|:"
).split("|")


def damaged(text, chance):
    """The text as bytes after one to three kinds of damage drawn from `chance` (a `random.Random`)."""
    for _ in range(chance.choice((1, 1, 1, 1, 2, 3))):
        text = chance.choice(DAMAGE)(text, chance)
    content = text.encode("utf-8", errors="surrogatepass")
    if chance.random() < 0.05 and content:
        at = chance.randrange(len(content))
        content = content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :]
    return content


def damaged_bytes(content, chance):
    """Bytes after one to three of them were changed, lost, doubled or cut away."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        at, length = chance.randrange(len(content) + 1), chance.choice((1, 1, 4, 30))
        changes = (
            content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :],
            content[:at] + content[at + length :],
            content[: at + length] + content[at:],
            content[:at],
        )
        content = chance.choice(changes)
    return content


def _sign(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice(SIGNS) + text[at + chance.randrange(2) :]


def _lost(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] + text[at + chance.choice((1, 1, 1, 2, 5, 15, 40)) :]


def _doubled(text, chance):
    at, length = chance.randrange(len(text) + 1), chance.choice((1, 2, 15, 40))
    return text[: at + length] + text[at:]


def _cut(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] if chance.random() < 0.7 else text[at:]


def _line(text, chance):
    """A line lost, doubled elsewhere, exchanged with another, or joined to the next."""
    lines = text.split("\n")
    low, high = sorted(chance.choices(range(len(lines)), k=2))
    changes = (
        lines[:low] + lines[low + 1 :],
        lines[:high] + lines[low : low + 1] + lines[high:],
        lines[:low] + lines[high : high + 1] + lines[low + 1 : high] + lines[low : low + 1] + lines[high + 1 :],
        lines[:low] + ["".join(lines[low : low + 2])] + lines[low + 2 :],
    )
    return "\n".join(chance.choice(changes))


def _word(text, chance):
    words = text.split(" ")
    words[chance.randrange(len(words))] = chance.choice(WORDS)
    return " ".join(words)


def _field(text, chance):
    """One field of a line replaced, or a word put in."""
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    fields = lines[at].split()
    if fields and chance.random() < 0.7:
        place = chance.randrange(len(fields))
        lines[at] = lines[at].replace(fields[place], chance.choice(WORDS), 1)
    else:
        lines[at] += " " + chance.choice(WORDS)
    return "\n".join(lines)


def _everywhere(text, chance):
    """A sign replaced throughout, as a conversion does, or in one line."""
    old, new = chance.choice(
        (
            (".", ","),
            (",", "."),
            (",", ";"),
            (";", ","),
            (" ", ""),
            (" ", ","),
            ("\n", "\r\n"),
            ("\n", "\r"),
            ("\n", " "),
            ("E", "D"),
            ("E-0", "E-00"),
            ("-", ""),
            ("-", "−"),
            ("e", ""),
        )
    )
    if chance.random() < 0.4:
        return text.replace(old, new)
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    lines[at] = lines[at].replace(old, new)
    return "\n".join(lines)


def _case(text, chance):
    return text.upper() if chance.random() < 0.5 else text.lower()


DAMAGE = (
    _sign,
    _sign,
    _sign,
    _sign,
    _lost,
    _lost,
    _doubled,
    _cut,
    _line,
    _line,
    _word,
    _field,
    _field,
    _everywhere,
    _case,
)


def cases(undamaged, number, seed):
    """`number` times one of the files (name, text, ...), and the bytes that damage makes of its text."""
    chance = random.Random(seed)
    for _ in range(number):
        one = chance.choice(undamaged)
        yield one, damaged(one[1], chance)
