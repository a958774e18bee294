"""Extensions in a seal file: tables found by name, with the fields of their definitions as keys."""

from collections.abc import Callable, Collection
from dataclasses import MISSING, fields
from difflib import get_close_matches
from types import UnionType
from typing import Annotated, Union, get_args, get_origin, get_type_hints

from pydantic import Strict, WrapValidator
from pydantic_core import PydanticCustomError, core_schema

from seal_mdao import registry
from seal_mdao.seals.file.forms import (
    Form,
    Names,
    Number,
    Points,
    Text,
    many,
    number,
    one_of,
    whole,
)
from seal_mdao.seals.file.schema import CHOICE, Table, key, suggestion, table_of, validated

CLOSE, MOST_LISTED = 4, 20
"""Names that a message gives, the nearest to what was written, in place of more than so many."""
WHOLE = whole(-(10**9), 10**9)
FORMS = {
    float: number(), int: WHOLE, str: Text, bool: Annotated[bool, Strict(), Form("true or false")],
}  # fmt: skip
"""Of the types of fields."""
LISTS = {
    float: many(Number, "a list of numbers"), int: many(WHOLE, "a list of whole numbers"), str: Names,
    tuple: Points,
}  # fmt: skip
"""By the types of their entries."""


class Extensible(Form):
    """Annotation of tables with a key that may name an extension, whose keys the table then has.

    Names are looked up when a file is read, so all that is installed or registered by then is known.

    Attributes
    ----------
    kind, key : str
        Kind of extension in ``registry``; key of the table that has the name.
    table : callable
        Makes the class of the table from the name and the extension.
    shipped : collection of str
        Names of the package itself, to which the annotation belongs.
    """

    def __init__(self, kind: str, key: str, table: Callable, shipped: Collection[str] = ()):
        super().__init__(f"a table {{ {key}, and its keys }}")
        self.kind, self.key, self.table, self.shipped = kind, key, table, shipped

    def found(self, name) -> type[Table] | None:
        """Find the class of the table of an extension; None where no extension has the name.

        Raises
        ------
        ValueError
            As of ``registry.find``; for a field that no key can give.
        """
        own = registry.find(self.kind, name, self.shipped) if isinstance(name, str) else None
        return None if own is None else self.table(name, own)

    def __get_pydantic_core_schema__(self, source, handler):
        return core_schema.no_info_wrap_validator_function(self._read, handler(source))

    def _read(self, given, shipped):
        if not isinstance(given, dict):
            return shipped(given)
        # an extension first, then what the package ships
        name = given.get(self.key)
        own = self.found(name)
        if own is not None:
            return validated(own, given)
        if not isinstance(name, str) or name not in self.shipped:
            # the name is what is wrong, whatever else there is
            raise PydanticCustomError(
                CHOICE, "{allowed}", {"key": self.key, "allowed": self._names(name)}
            )
        return shipped(given)

    def _names(self, name) -> str:
        every = [*self.shipped, *registry.names(self.kind)]
        if len(every) > MOST_LISTED:
            # the nearest ones of many, or the first ones
            some = get_close_matches(str(name), every, CLOSE) or every[:CLOSE]
            others = f"one of {len(every) - len(some)} others, which seal-mdao keys lists"
            return f"one of {', '.join(some)}, or {others}"
        none = "the name of an installed or registered extension; there is none"
        return f"one of {', '.join(every)}{suggestion(name, every)}" if every else none

    def __get_pydantic_json_schema__(self, schema, handler):
        # installed extensions by name; what is registered in a session is not of the schema
        names = registry.installed(self.kind)
        return {"anyOf": [handler(schema), named(self.key, names)]} if names else handler(schema)


def named(key_: str, names: Collection[str]) -> dict:
    """Make the JSON schema of tables with one of some names; their further keys are open."""
    return {"type": "object", "properties": {key_: {"enum": list(names)}}, "required": [key_]}


def keys_of(made: type, base: type[Table], left_out=()) -> dict:
    """Make the keys of a table from the fields of the dataclass ``made``, by type and default.

    Fields of other types than numbers, texts and lists of these must have a default.

    Raises
    ------
    ValueError
        For a field that a table cannot give, or that has the name of something that ``base`` has.
    """
    hints, keys = get_type_hints(made), {}
    for field in fields(made):
        if not field.init or field.name in left_out:
            continue
        # required without a default; a type without a form is left to its default
        form = _form_of(hints[field.name])
        default = field.default if field.default_factory is MISSING else field.default_factory()
        # a required field must have a form, and no field the name of a key or attribute of the base
        if form is None and default is MISSING:
            raise ValueError(
                f"the class {made.__name__} cannot be used in seal files, because its field "
                f"{field.name!r} has a type that cannot be read; give this field the type float, "
                "int, str, bool or a tuple of these, or a default"
            )
        if form is None:
            continue
        if field.name in base.entries() or hasattr(base, field.name):
            raise ValueError(
                f"the class {made.__name__} cannot be used in seal files, because the name of its "
                f"field {field.name!r} is reserved for a key of its table; rename the field"
            )
        text = f"field of {made.__name__}"
        if default is MISSING:
            keys[field.name] = form, key(text)
        else:
            keys[field.name] = Annotated[form, _or_default(default)], key(text, default)
    return keys


def _or_default(default) -> WrapValidator:
    """Accept the default whatever its form: ``dataclasses.replace`` passes it again."""
    return WrapValidator(lambda given, read: given if given is default else read(given))


def _form_of(hint):
    """Find the form of the values of a field; None for a type that tables do not have."""
    if get_origin(hint) in (Union, UnionType):
        # optional: the form of the other type
        others = [own for own in get_args(hint) if own is not type(None)]
        return _form_of(others[0]) if len(others) == 1 else None
    if hint is tuple or get_origin(hint) is tuple:
        # a list: by the type of its entries, numbers unless it says
        entry = (*get_args(hint), float)[0]
        return LISTS.get(get_origin(entry) or entry)
    return FORMS.get(hint)


def extension_table(
    base: type[Table], key_: str, name: str, made, keys: dict, **more
) -> type[Table]:
    """Make the class of the tables of an extension: ``makes`` of the class is ``made``.

    ``key_`` of ``base`` names the extension by ``name``; ``keys`` and ``more`` attributes are as of
    ``table_of``.
    """
    keys = {key_: (one_of(name), key(base.entries()[key_].description))} | keys
    own = {"makes": staticmethod(made), "__module__": made.__module__}
    return table_of(base, f"{made.__name__}Table", keys, **own, **more)


def arguments(own: Table, base: type[Table]) -> dict:
    """Return the values of the keys of an extension beside those of all such tables."""
    # all fields but those that every table of the kind has
    taken = base.entries()
    return {f.name: getattr(own, f.name) for f in fields(own) if f.name not in taken}
