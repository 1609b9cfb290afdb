"""Result files damaged at random, and by one who makes the digest anew; each as (what was done, JSON, arrays)."""

import copy
import json
import random
import re

from comparisons.running.provenance import digest_of

OTHERS = (None, True, False, 0, -1, 3.5, 1e308, "", "x", "1.5", [], [None], {}, {"a": 1})


def damaged(path, seed, count):
    """`count` mutations of the result file at `path` and of the arrays beside it, all different by their seed."""
    generator = random.Random(seed)
    text, beside = path.read_bytes(), path.with_suffix(".npz").read_bytes()
    for number in range(count):
        how = (_bytes, _digit, _structure, _value, _arrays)[number % 5]
        yield f"{how.__name__} {number}", *how(generator, text, beside)


def resealed(path, seed, count):
    """`count` mutations of the content of the result file at `path`, its digest made anew."""
    generator = random.Random(seed)
    text, beside = path.read_bytes(), path.with_suffix(".npz").read_bytes()
    for number in range(count):
        how = (_digit, _structure, _value, _row)[number % 4]
        changed = json.loads(how(generator, text, beside)[0])
        if isinstance(changed, dict):
            changed["digest"] = digest_of(changed)
        yield f"{how.__name__} {number}", json.dumps(changed).encode(), beside


def _bytes(generator, text, beside):
    """Bytes changed, cut out, doubled or put in anywhere; or the file cut short."""
    place, length = generator.randrange(len(text)), generator.choice((1, 1, 2, 20, 500))
    cut = text[:place], text[place : place + length], text[place + length :]
    middle = generator.choice(
        (b"", cut[1] * 2, bytes(len(cut[1])), generator.randbytes(len(cut[1])), bytes([cut[1][0] ^ 1]) + cut[1][1:])
    )
    return (text[:place] if generator.random() < 0.2 else cut[0] + middle + cut[2]), beside


def _digit(generator, text, beside):
    """One digit of a number in a row, settings or provenance."""
    found = generator.choice(list(re.finditer(rb"(?<=[\d.-])\d(?=[\d.e,\]}])", text)))
    other = generator.choice([digit for digit in b"0123456789" if digit != found[0][0]])
    return text[: found.start()] + bytes([other]) + text[found.end() :], beside


def _structure(generator, text, beside):
    """A part of the content left out, put elsewhere, called otherwise or doubled."""
    content = json.loads(text)
    place, key = _place(generator, content)
    how = generator.choice(("left out", "moved", "renamed", "doubled"))
    value = copy.deepcopy(place[key])
    if how != "doubled":
        del place[key]
    if how != "left out":
        into, other = (place, key) if how != "moved" else _place(generator, content)
        if isinstance(into, dict):
            into[f"{other}2"] = value
        else:
            into.insert(other, value)
    return json.dumps(content).encode(), beside


def _value(generator, text, beside):
    """A value, or a whole part, of another type, or the same in another one."""
    content = json.loads(text)
    place, key = _place(generator, content)
    value = place[key]
    same = [kind(value) for kind in (str, float, int, bool) if type(value) in (int, float) and type(value) is not kind]
    place[key] = generator.choice([one for one in (*OTHERS, *same) if one != value or type(one) is not type(value)])
    return json.dumps(content).encode(), beside


def _row(generator, text, beside):
    """A column of a row left out, called otherwise, put in, or of another type."""
    content = json.loads(text)
    row = generator.choice(content["rows"])
    name = generator.choice(list(row))
    how = generator.choice(("left out", "renamed", "put in", "other"))
    if how == "other":
        row[name] = generator.choice([one for one in OTHERS if type(one) is not type(row[name])])
    elif how == "put in":
        row[f"{name}2"] = row[name]
    else:
        value = row.pop(name)
        row |= {f"{name}2": value} if how == "renamed" else {}
    return json.dumps(content).encode(), beside


def _arrays(generator, text, beside):
    """The arrays missing, cut, changed or another's."""
    place = generator.randrange(len(beside))
    changed = beside[:place] + bytes([beside[place] ^ (1 << generator.randrange(8))]) + beside[place + 1 :]
    return text, generator.choice((None, b"", beside[:place], changed, text))


def _place(generator, content):
    """A random place: (its dict or list, key or index), inner ones as often as outer ones."""
    place, key = content, generator.choice(list(content))
    while isinstance(place[key], dict | list) and place[key] and generator.random() < 0.8:
        place = place[key]
        key = generator.choice(list(place)) if isinstance(place, dict) else generator.randrange(len(place))
    return place, key
