"""What the commands write as JSON, as types; README.md says how their schemas are written down.

What all that is written as JSON has in common.
"""

import json
from typing import Any

from pydantic import BaseModel, ConfigDict
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue


class Part(BaseModel):
    """A part of what is written; nothing else stands in it."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Form(Part):
    """What a command writes. schema_: its name and version, "schema" in the JSON."""

    schema_: str

    def text(self) -> str:
        """The JSON, its version first; a number that is not finite is null."""
        return json.dumps(json.loads(self.model_dump_json(by_alias=True)), indent=2, allow_nan=False) + "\n"


class _Numbers(GenerateJsonSchema):
    """Any number may be null, as `Form.text` writes one that is not finite."""

    def float_schema(self, schema: Any) -> JsonSchemaValue:
        return {"anyOf": [super().float_schema(schema), {"type": "null"}]}


def schema_of(form: type[Form]) -> JsonSchemaValue:
    """The JSON schema of what `Form.text` writes."""
    return form.model_json_schema(mode="serialization", by_alias=True, schema_generator=_Numbers)
