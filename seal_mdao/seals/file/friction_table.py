"""``friction`` of a contact: Coulomb's coefficient, or the name of a law with its constants."""

from functools import cache
from typing import Annotated

from pydantic import Field, TypeAdapter
from pydantic_core import core_schema

from seal_mdao import registry
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.friction_law import (
    FrictionLaw,
    constant_defaults,
    constant_names,
    friction_law,
)
from seal_mdao.seals.file.extensions import Extensible, arguments, extension_table, named
from seal_mdao.seals.file.forms import Form, Number, Text, number, one_of
from seal_mdao.seals.file.schema import Table, key, table

COULOMB = "coulomb"
"""The law of the package itself."""
MOST_FRICTION = 10.0
Coefficient = number(least=0.0, most=MOST_FRICTION)


@table(kw_only=True)
class FrictionTable(Table):
    """Friction by Coulomb's law."""

    law: one_of(COULOMB) = key(
        "name of the friction law; laws other than coulomb have their own constants instead of "
        "friction"
    )
    friction: Coefficient = key("Coulomb coefficient")

    def made(self) -> float:
        """Return the coefficient."""
        return self.friction


@table(kw_only=True)
class ExtensionTable(Table):
    """Friction law of another package."""

    law: Text = key("name of the law")

    def made(self) -> FrictionLaw:
        """Return the law with its constants."""
        return friction_law(self.makes, **arguments(self, ExtensionTable))


@cache
def _extension(name: str, law) -> type[Table]:
    """Make the table of a law of another package: constants by the names of its arguments."""
    # arguments without a default are required
    text = "constant of the law"
    keys = {own: (number(), key(text)) for own in constant_names(law)}
    keys |= {own: (number(), key(text, default)) for own, default in constant_defaults(law).items()}
    return extension_table(ExtensionTable, "law", name, law, keys)


_LAW = TypeAdapter(
    Annotated[FrictionTable, Extensible("friction_laws", "law", _extension, (COULOMB,))]
)


class _OrLaw:
    """Annotation of a coefficient that may also be a table with the name of a law."""

    def __get_pydantic_core_schema__(self, source, handler):
        return core_schema.no_info_wrap_validator_function(self._read, handler(source))

    @staticmethod
    def _read(given, coefficient):
        # ``dataclasses.replace`` of a table that has been read gives the law itself
        if isinstance(given, FrictionLaw | FrictionByGroup):
            return given
        return _LAW.validate_python(given).made() if isinstance(given, dict) else coefficient(given)

    def __get_pydantic_json_schema__(self, schema, handler):
        # a number, or a table with the name of a law
        names = (COULOMB, *registry.installed("friction_laws"))
        return {"anyOf": [handler(schema), named("law", names)]}


class _OrByEdge(_OrLaw):
    """Annotation of a coefficient or law that may also be a table of these by the names of edges."""

    @staticmethod
    def _read(given, coefficient):
        if not isinstance(given, dict) or "law" in given:
            return _OrLaw._read(given, coefficient)
        # every entry is a coefficient or a law
        laws = tuple(_OrLaw._read(own, coefficient) for own in given.values())
        return FrictionByGroup(tuple(given), laws)

    def __get_pydantic_json_schema__(self, schema, handler):
        one = super().__get_pydantic_json_schema__(schema, handler)
        return {"anyOf": [*one["anyOf"], {"type": "object", "additionalProperties": one}]}


FrictionByEdge = Annotated[
    Number,
    Field(ge=0.0, le=MOST_FRICTION),
    Form(
        f"a number of at least 0 and at most {MOST_FRICTION:g}, a table {{ law, and its constants }}, "
        "or a table of these by edge"
    ),
    _OrByEdge(),
]

# Coulomb's coefficient by itself, or a table: ``{ law = "coulomb", friction = 0.3 }``
Friction = Annotated[
    Number,
    Field(ge=0.0, le=MOST_FRICTION),
    Form(
        f"a number of at least 0 and at most {MOST_FRICTION:g}, or a table {{ law, and its constants }}"
    ),
    _OrLaw(),
]
