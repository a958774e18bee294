"""Extensions in a seal file: found by name, and their keys from their own definitions."""

from dataclasses import MISSING, fields
from types import UnionType
from typing import Union, get_args, get_origin, get_type_hints

from seal_mdao import registry
from seal_mdao.contact.friction_law import (
    FrictionLaw,
    constant_defaults,
    constant_names,
    friction_law,
)
from seal_mdao.errors import SealFileError
from seal_mdao.geometry.shape import Shape
from seal_mdao.seals.file.checks import (
    NAME,
    NAMES,
    NUMBERS,
    POINTS,
    TEXT,
    Check,
    Key,
    many,
    number,
    one_of,
    table,
    whole,
)
from seal_mdao.seals.file.tables import TermTable

COULOMB = "coulomb"
"""The friction law of the package itself."""

MOST_FRICTION = 10.0
COEFFICIENT = number(least=0.0, most=MOST_FRICTION)


def _truth(value) -> bool:
    if not isinstance(value, bool):
        raise TypeError
    return value


TRUTH = Check("true or false", _truth)
CHECKS = {float: number(), int: whole(-(10**9), 10**9), str: TEXT, bool: TRUTH}
LISTS = {
    float: NUMBERS,
    str: NAMES,
    tuple: POINTS,
    int: many(CHECKS[int], "a list of whole numbers"),
}


def extension(where: str, kind: str, name, shipped=()):
    """The extension of a name in a table; None where the package itself has it, or nobody.

    Raises
    ------
    SealFileError
        As of ``registry.find``.
    """
    if not isinstance(name, str):
        return None
    try:
        return registry.find(kind, name, shipped)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


def keys_of(made: type, left_out=()) -> dict:
    """Keys of a table that becomes a dataclass: its fields by their types and defaults.

    Fields of other types than numbers, texts and lists of these must have a default.

    Raises
    ------
    SealFileError
        For a field that a table cannot give.
    """
    hints, keys = get_type_hints(made), {}
    for field in fields(made):
        if not field.init or field.name in left_out:
            continue
        check = _check_of(hints[field.name])
        default = field.default if field.default_factory is MISSING else field.default_factory()
        if check is None and default is MISSING:
            raise SealFileError(
                f"{made.__name__}: no key can give {field.name!r}; its type must be float, int, str, "
                "bool, a tuple of these, or it must have a default"
            )
        if check is not None:
            keys[field.name] = Key(check) if default is MISSING else Key(check, default)
    return keys


def _check_of(hint) -> Check | None:
    if get_origin(hint) in (Union, UnionType):
        others = [own for own in get_args(hint) if own is not type(None)]
        return _check_of(others[0]) if len(others) == 1 else None
    if hint is tuple or get_origin(hint) is tuple:
        entry = (*get_args(hint), float)[0]
        return LISTS.get(get_origin(entry) or entry)
    return CHECKS.get(hint)


def _friction(given) -> float | FrictionLaw:
    """A coefficient, or a law with its constants."""
    if not isinstance(given, dict):
        return COEFFICIENT.convert(given)
    name = given.get("law")
    law = extension("friction", "friction_laws", name, (COULOMB,))
    if law is None:
        keys = {"friction": Key(COEFFICIENT)}
    else:
        keys = {constant: Key(number()) for constant in constant_names(law)}
        keys |= {key: Key(number(), own) for key, own in constant_defaults(law).items()}
    known = {"law": Key(one_of(COULOMB, *registry.names("friction_laws")))}
    if law is None and name != COULOMB:
        # the name of the law is what is wrong, whatever else there is
        given, keys = {key: given[key] for key in given if key == "law"}, {}
    values = table("friction", given, known | keys)
    values.pop("law")
    if law is None:
        return values["friction"]
    try:
        return friction_law(law, **values)
    except ValueError as error:
        raise SealFileError(f"friction: {error}") from None


FRICTION = Check(COEFFICIENT.allowed + ", or a table { law, and its constants }", _friction)


def _shape(given) -> Shape:
    """The shape of a profile of an extension."""
    made = _made("shape", "profiles", given)
    values = table("shape", given, {"type": Key(TEXT)} | keys_of(made))
    values.pop("type")
    try:
        return made(**values)
    except ValueError as error:
        raise SealFileError(f"shape: {error}") from None


def read_term(where: str, given: dict) -> TermTable:
    """A term of an extension.

    Raises
    ------
    SealFileError
    """
    made = _made(where, "terms", given)
    keys = {"type": Key(TEXT), "name": Key(NAME, given["type"]), "edges": Key(NAMES)}
    values = table(where, given, keys | keys_of(made, ("label", "where")))
    head = [values.pop(key) for key in keys]
    return TermTable(*head, made, values)


def _made(where: str, kind: str, given) -> type:
    """The extension that ``type`` of a table names."""
    made = extension(where, kind, given.get("type") if isinstance(given, dict) else None)
    if made is None:
        # the type is what is wrong, whatever else there is
        given = {k: given[k] for k in given if k == "type"} if isinstance(given, dict) else given
        installed = registry.names(kind)
        what = one_of(*installed) if installed else NONE_INSTALLED
        table(where, given, {"type": Key(what)})
    return made


def _refused(value):
    raise ValueError


NONE_INSTALLED = Check("the name of an installed or registered extension; there is none", _refused)
SHAPE = Check("a table { type, and its keys }", _shape)
