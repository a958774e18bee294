"""A check of values against a JSON schema, as far as that of seal files goes (draft 7)."""

import re
from math import inf
from numbers import Real

TYPES = {"object": dict, "array": list, "string": str, "number": Real, "integer": int}
KNOWN = {
    "$defs", "$ref", "$schema", "additionalProperties", "anyOf", "const", "default", "description",
    "enum", "exclusiveMinimum", "items", "maxItems", "maximum", "minItems", "minimum", "oneOf",
    "pattern", "properties", "required", "title", "type",
}  # fmt: skip


def fits(value, schema, root) -> bool:
    """Whether a value is what a schema asks for; ``root`` has its definitions."""
    assert not set(schema) - KNOWN
    if "$ref" in schema:
        return fits(value, root["$defs"][schema["$ref"].removeprefix("#/$defs/")], root)
    if "oneOf" in schema:
        return sum(fits(value, own, root) for own in schema["oneOf"]) == 1
    if "anyOf" in schema:
        rest = {key: own for key, own in schema.items() if key != "anyOf"}
        some = any(fits(value, own, root) for own in schema["anyOf"])
        return some and ("type" not in rest or fits(value, rest, root))
    if "const" in schema or "enum" in schema:
        return value in schema.get("enum", [schema.get("const")])
    kind = schema["type"]
    if isinstance(value, bool) or not isinstance(value, TYPES[kind]):
        return False
    return {"object": _table, "array": _list, "string": _text}.get(kind, _number)(
        value, schema, root
    )


def _table(value, schema, root):
    known, further = schema.get("properties", {}), schema.get("additionalProperties", True)
    if any(name not in value for name in schema.get("required", ())):
        return False
    for name, own in value.items():
        form = known.get(name, further)
        if form is False or (isinstance(form, dict) and not fits(own, form, root)):
            return False
    return True


def _list(value, schema, root):
    few, many = schema.get("minItems", 0), schema.get("maxItems", len(value))
    forms = schema["items"]
    # one form of every item, or one of each
    forms = forms if isinstance(forms, list) else [forms] * len(value)
    return few <= len(value) <= many and all(
        fits(own, form, root) for own, form in zip(value, forms, strict=False)
    )


def _text(value, schema, root):
    return re.search(schema.get("pattern", ""), value) is not None


def _number(value, schema, root):
    least, most = schema.get("minimum", -inf), schema.get("maximum", inf)
    return least <= value <= most and value > schema.get("exclusiveMinimum", -inf)
