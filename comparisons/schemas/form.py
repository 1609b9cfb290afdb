"""What all that is written as JSON has in common."""

import json

from pydantic import BaseModel, ConfigDict


class Part(BaseModel):
    """A part of what is written; nothing else stands in it."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Form(Part):
    """What a command writes. schema_: its name and version, "schema" in the JSON."""

    schema_: str

    def text(self) -> str:
        """The JSON, its version first."""
        return json.dumps(self.model_dump(by_alias=True), indent=2, allow_nan=False) + "\n"
