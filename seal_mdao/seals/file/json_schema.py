"""JSON schema of seal files, for completion and checks in editors.

python -m seal_mdao.seals.file.json_schema seal_file.schema.json
"""

import json
import sys
from pathlib import Path

from pydantic.json_schema import GenerateJsonSchema

from seal_mdao.seals.file.file_tables import MOVING, Written


class _Schema(GenerateJsonSchema):
    """Schema of what TOML can write: it has no null; titles of keys are their forms."""

    schema_dialect = "http://json-schema.org/draft-07/schema#"

    def nullable_schema(self, schema):
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema):
        # a default that no file can write is left out
        made = super().default_schema(schema)
        if made.get("default") in (None, []):
            made.pop("default", None)
        return made

    def tuple_schema(self, schema):
        # draft 7 has a list of items where later drafts have prefixItems
        made = super().tuple_schema(schema)
        if "prefixItems" in made:
            made["items"] = made.pop("prefixItems")
        return made

    def field_title_should_be_set(self, schema):
        return False


def json_schema() -> dict:
    """Make the JSON schema (draft 7) of seal files from their tables.

    It checks tables, keys, forms and bounds; what tables say of each other is checked by
    ``read_seal_file`` alone.
    """
    # forms of keys are titles, their meanings descriptions
    made = Written.model_json_schema(schema_generator=_Schema)
    made |= {"title": "Seal file of seal_mdao"}
    # something has to move
    made["anyOf"] = [{"type": "object", "required": [name]} for name in MOVING]
    return {"$schema": _Schema.schema_dialect} | made


def main(arguments: list[str]) -> int:
    """Write the schema into the file that the arguments name."""
    if len(arguments) != 1:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    Path(arguments[0]).write_text(json.dumps(json_schema(), indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
