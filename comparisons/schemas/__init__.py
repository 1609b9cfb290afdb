"""Types of all that the commands write as JSON; README.md tells how their schemas are written."""

import json
from typing import Any

from pydantic import BaseModel, ConfigDict
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue


class Part(BaseModel):
    """A part of a form, with these fields and no others."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Form(Part):
    """What a command writes. schema_: name and version, called "schema" in the JSON."""

    schema_: str

    def text(self) -> str:
        """Return the JSON, the version first. A number that is not finite becomes null."""
        return json.dumps(json.loads(self.model_dump_json(by_alias=True)), indent=2, allow_nan=False) + "\n"


class _Numbers(GenerateJsonSchema):
    """Lets any number be null, because `Form.text` writes a number that is not finite as null."""

    def float_schema(self, schema: Any) -> JsonSchemaValue:
        return {"anyOf": [super().float_schema(schema), {"type": "null"}]}


def schema_of(form: type[Form]) -> JsonSchemaValue:
    """Return the JSON schema of what `Form.text` writes."""
    return form.model_json_schema(mode="serialization", by_alias=True, schema_generator=_Numbers)
