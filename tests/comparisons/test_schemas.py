"""The schemas written down are those of the values that become JSON, and all that a form takes becomes JSON."""

import json
import math
import types
import typing
from typing import Any, Literal

import jsonschema
import pytest
from pydantic import BaseModel

from comparisons.schemas import schema_of
from comparisons.schemas.__main__ import FOLDER, FORMS, schemas


def test_every_form_has_its_schema_written_down_under_its_version_and_every_schema_its_form():
    by_name = {file.stem: json.loads(file.read_text()) for file in FOLDER.glob("*.json")}
    assert by_name == schemas(), "python -m comparisons.schemas writes them"


def sample(kind, number):
    """A value of a type, in which every number that is no whole one is `number`, and every list has one entry."""
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin in (typing.Union, types.UnionType):
        kinds = [part for part in parts if part is not type(None)]
        return sample(float if float in kinds else kinds[0], number)
    if origin is typing.Annotated:
        return sample(parts[0], number)
    if origin is Literal:
        return parts[0]
    if origin is list:
        return [sample(parts[0], number)]
    if origin is tuple:
        return tuple(sample(part, number) for part in parts)
    if origin is dict:
        return {sample(parts[0], number): sample(parts[1], number)}
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        known = {info.alias or name: sample(info.annotation, number) for name, info in kind.model_fields.items()}
        return kind(**{name: value for name, value in known.items() if name != "schema_" and name != "schema"})
    return {float: number, int: 3, str: "0" * 64, bool: True, Any: [number, {"deeper": number}]}[kind]


@pytest.mark.parametrize("number", [1.5, math.nan])
@pytest.mark.parametrize("form", FORMS)
def test_each_number_of_each_form_may_be_none_and_the_json_is_valid(form, number):
    """A form that takes a number writes it: null where JSON has none."""
    text = sample(form, number).text()
    written = json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    jsonschema.validate(written, schema_of(form))
    assert "NaN" not in text and "Infinity" not in text
    assert ("null" in text) == (not math.isfinite(number))
    del written[next(name for name in written if name != "schema")]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(written, schema_of(form))
