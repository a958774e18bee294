"""Tables of a seal file: pydantic dataclasses with their keys, and error messages of one line.

A table is a class with ``@table``. Its annotations are the forms of its keys (``forms``), ``key`` gives
the description and what holds unless the key is given, validators are its cross checks. From it come the
error messages, the JSON schema for editors and the reference tables of the documentation.
"""

from difflib import get_close_matches
from functools import cache, partial, reduce
from operator import or_
from types import UnionType
from typing import Annotated, Union, get_args, get_origin, get_type_hints

from pydantic import (
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.dataclasses import dataclass
from pydantic_core import ArgsKwargs, PydanticCustomError, PydanticUndefined, core_schema

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.forms import FORM, Form
from seal_mdao.values import formatted

MOST_ROWS = 10_000
"""Tables of one list."""
ROWS = "rows"
"""Type of the error of what is no list of tables."""
CHOICE = "choice"
"""Type of the error of a table whose class is not found by the text of a key."""
LINE = "line"
"""Type of an error that is a complete line."""
LABELS = {
    "profile": ("name", ""), "moved": ("name", ""),
    "section.outer": ("edge", "edge "), "section.hole": ("edge", "edge "),
}  # fmt: skip
"""What rows are called beside their number: the key that says it, and a word before its text."""
NAMED = (["material"], ["vary"], ["tolerance", "vary"])
"""Tables that hold tables with names of their own."""
TAG = "\0"
"""Before the name of a class that one of the keys of a table chooses."""

# one schema for all tables of a file, not another one for every class
_CONFIG = ConfigDict(extra="forbid", populate_by_name=True, defer_build=True)
table = partial(dataclass, frozen=True, config=_CONFIG)
"""Decorator of the classes of tables."""


def key(text: str, default=PydanticUndefined, alias: str | None = None):
    """Declare a key of a table: its meaning, its default, and its name in the file if another."""
    return Field(default, description=text, alias=alias)


@table
class Table:
    """A table of a seal file."""

    @classmethod
    def entries(cls) -> dict:
        """Return the fields of pydantic by their names in the file, required ones first."""
        fields = cls.__pydantic_fields__.items()
        own = sorted(fields, key=lambda field: not field[1].is_required())
        return {field.alias or name: field for name, field in own}

    @classmethod
    def allowed(cls, name: str) -> str:
        """Describe the admissible values of a key."""
        hints = get_type_hints(cls, include_extras=True)
        own = {field.alias or n: n for n, field in cls.__pydantic_fields__.items()}
        return form_of(hints[own[name]])

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, given):
        """Refuse what is no table, a key that is unknown, or one that is missing."""
        # made in Python, or checked already
        if isinstance(given, ArgsKwargs | cls):
            return given
        if not isinstance(given, dict):
            raise PydanticCustomError("table", "no table")
        keys = cls.entries()
        # an unknown key before a missing one: it may be that one, misspelt
        for name in given:
            if name not in keys:
                close = suggestion(name, keys)
                raise ValueError(f"unknown key {name!r}{close}; the keys are {', '.join(keys)}")
        for name, own in keys.items():
            if name not in given and own.is_required():
                raise ValueError(f"the key {name!r} is missing; it must be {cls.allowed(name)}")
        return given


def table_of(base: type[Table], name: str, keys: dict, **attributes) -> type[Table]:
    """Make a class of tables with further keys.

    ``keys`` has the annotation and the ``key`` of each; ``attributes`` are others of the class.
    """
    # a class body as Python would make it, then pydantic's dataclass of it
    hints = {own: hint for own, (hint, _) in keys.items()}
    body = {own: field for own, (_, field) in keys.items()}
    body |= {"__annotations__": hints, "__module__": base.__module__, "__doc__": base.__doc__}
    return table(kw_only=True)(type(name, (base,), body | attributes))


def form_of(hint) -> str:
    """Describe the admissible values of an annotation in words."""
    if get_origin(hint) is Annotated:
        # the outermost form, or that of the type inside
        forms = [own for own in hint.__metadata__ if isinstance(own, Form)]
        return forms[-1].allowed if forms else form_of(get_args(hint)[0])
    # of an optional value: that of the value
    if get_origin(hint) in (Union, UnionType):
        return form_of(next(own for own in get_args(hint) if own is not type(None)))
    if isinstance(hint, type) and issubclass(hint, Table):
        return f"a table {{ {', '.join(hint.entries())} }}"
    return {tuple: "a list of tables", dict: "tables with names"}[get_origin(hint)]


class _Rows:
    """What a list of tables must be."""

    def __get_pydantic_core_schema__(self, source, handler):
        return core_schema.no_info_before_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(self, schema, handler):
        return handler(schema) | {"minItems": 1, "maxItems": MOST_ROWS}

    @staticmethod
    def _checked(given):
        if isinstance(given, tuple):  # of a table that has been read
            return given
        # a list of tables, not empty and of bounded length
        no_list = not isinstance(given, list) or not given
        if no_list or not all(isinstance(own, dict) for own in given) or len(given) > MOST_ROWS:
            raise PydanticCustomError(ROWS, "no list of tables")
        return given


def rows(one):
    """Make the annotation of a list of tables."""
    return Annotated[tuple[one, ...], _Rows()]


@cache
def _adapter(own) -> TypeAdapter:
    return TypeAdapter(own)


def validated(own: type[Table], given) -> Table:
    """Validate a table by its class, whose schema is built when it is first used."""
    return _adapter(own).validate_python(given)


class _Chosen:
    """Type of a table whose class is found by the text of its key ``name``; see ``chosen_by``."""

    name: str
    classes: dict
    tag = None

    @classmethod
    def _texts(cls) -> tuple:
        # several classes may share a text of the key: "law" and "law: data"
        return tuple(dict.fromkeys(tag.partition(":")[0] for tag in cls.classes))

    @classmethod
    def _read(cls, given) -> Table:
        if not isinstance(given, dict):  # refused by any class
            return validated(next(iter(cls.classes.values())), given)
        text, texts = given.get(cls.name), cls._texts()
        if not isinstance(text, str) or text not in texts:
            context = {"key": cls.name, "allowed": f"one of {', '.join(texts)}"}
            raise PydanticCustomError(CHOICE, "{allowed}", context)
        return validated(cls.classes[text if cls.tag is None else cls.tag(given)], given)

    @classmethod
    def __get_pydantic_core_schema__(cls, source, handler):
        # not a union of pydantic, which builds the schemas of all classes for every file
        return core_schema.no_info_plain_validator_function(cls._read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema, handler):
        return handler(_adapter(reduce(or_, cls.classes.values())).core_schema)


def chosen_by(name: str, classes: dict, tag=None) -> type:
    """Make the type of a table whose class is found by the text of its key ``name``.

    ``classes`` are by tag: the text of the key, or what ``tag`` returns for a table, ``text: ...``.
    """
    how = None if tag is None else staticmethod(tag)
    return type("Chosen", (_Chosen,), {"name": name, "classes": classes, "tag": how})


def checked(adapter: TypeAdapter, given: dict):
    """Validate the content of a file by a pydantic type.

    Raises
    ------
    SealFileError
        One line with the table, the key, the value, and what is allowed.
    """
    try:
        return adapter.validate_python(given)
    except ValidationError as error:
        # one thing at a time: the first error
        first = error.errors(include_url=False)[0]
    raise SealFileError(_line(first, given)) from None


def _line(error: dict, given: dict) -> str:
    """Write the line for one of pydantic's errors."""
    # tags of unions are no part of the place in the file
    loc = tuple(own for own in error["loc"] if not str(own).startswith(TAG))
    value, context = error["input"], error.get("ctx", {})
    names = [own for own in loc if isinstance(own, str)]
    # one table where a list is written, or none at all
    if error["type"] == "table":
        written = f", written [{names[0]}]" if isinstance(value, list) and len(names) == 1 else ""
        return f"{_place(loc, given)} must be one table{written}, got {formatted(value)}"
    if error["type"] == CHOICE:
        # the error is that of the key that names the class
        loc, value = (*loc, context["key"]), value.get(context["key"], PydanticUndefined)
    # place of the table, and the key in it
    before = _place(loc[:-1], given)
    where, name = f"{before}: " if before else "", loc[-1] if loc else ""
    if value is PydanticUndefined:
        return f"{where}the key {name!r} is missing; it must be {context['allowed']}"
    if error["type"] == ROWS:
        return where + _no_rows(".".join(names), value)
    if error["type"] in (FORM, CHOICE):
        return f"{where}{name} = {formatted(value)}, but it must be {context['allowed']}"
    if error["type"] == LINE:
        return context["line"]
    # a cross check of a table: the place is that of the table itself
    if isinstance(value, dict):
        where, name = "", _place(loc, given)
    # what is wrong with the whole file has no place in it
    return f"{where}{name}: {context['error']}".removeprefix(": ")


def _no_rows(name: str, value) -> str:
    if isinstance(value, list) and len(value) > MOST_ROWS:
        return (
            f"[[{name}]]: {len(value)} tables are more than the limit of {MOST_ROWS}; leave some "
            "out"
        )
    return f"{name} must be a list of tables, each written [[{name}]], got {formatted(value)}"


def _place(loc: tuple, given) -> str:
    """Write the place of a table: ``[[profile]] 1 ('door'): [[profile.stage]] 2``."""
    words, names = [], []
    for step in loc:
        # follow the place into the content of the file, for the names of rows
        if isinstance(given, dict | list):
            given = given.get(step) if isinstance(given, dict) else given[step]
        if isinstance(step, int):
            words[-1] = _row_name(".".join(names), step + 1, given)
            if len(words) > 1 and not words[-2].startswith("[["):  # [section] of [[section.outer]]
                del words[-2]
        else:
            names.append(step)
            words.append(step if words else f"[{step}]")
            if names[:-1] in NAMED:
                words = [f"[{'.'.join(names)}]"]
    return ": ".join(words)


def _row_name(name: str, number: int, given) -> str:
    """Write the place of a row of a list of tables: ``[[profile]] 1 ('door')``."""
    key_, word = LABELS.get(name, ("", ""))
    own = given.get(key_) if isinstance(given, dict) else None
    return f"[[{name}]] {number}" + (f" ({word}{own!r})" if isinstance(own, str) else "")


def known(where: str, key: str, name: str, names, what: str) -> None:
    """Raise SealFileError for a name that is not among ``names``."""
    # with the nearest known name, and all of them
    if name not in names:
        raise SealFileError(
            f"{where}: {key} = {name!r}, but there is no such {what}{suggestion(name, names)}; "
            f"there {'are' if len(names) != 1 else 'is'} {', '.join(names) or 'none'}"
        )


def suggestion(name, names) -> str:
    """Write " (did you mean ...?)" where a known name is close."""
    close = get_close_matches(str(name), list(names), 1, 0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""
