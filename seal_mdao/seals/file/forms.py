"""Forms of values in a seal file: pydantic types, each with the words that say what is allowed."""

from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    Strict,
    StringConstraints,
    ValidationError,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError, core_schema

from seal_mdao.errors import GeometryError
from seal_mdao.values import fraction

FORM = "form"
"""Type of the error of a value that has another form than its key allows."""
MOST_POINTS = 20_000
"""Of a line or spline."""


class Form:
    """Admissible values of a key, described in words (``allowed``) that form the error message."""

    def __init__(self, allowed: str):
        self.allowed = allowed

    def __get_pydantic_core_schema__(self, source, handler):
        # whatever pydantic finds inside the value becomes one error with the words
        def checked(value, inner):
            try:
                return inner(value)
            except ValidationError:
                raise PydanticCustomError(FORM, "{allowed}", {"allowed": self.allowed}) from None

        return core_schema.no_info_wrap_validator_function(checked, handler(source))

    def __get_pydantic_json_schema__(self, schema, handler):
        return handler(schema) | {"title": self.allowed}


# numbers are no text and no booleans, and finite
Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]


def number(unit: str = "", above=None, least=None, most=None):
    """Define finite numbers with a lower bound, which may be excluded, and an upper bound."""
    words = [] if above is None else [f"above {above:g}"]
    words += [] if least is None else [f"of at least {least:g}"]
    words += [] if most is None else [f"at most {most:g}"]
    # "a number above 0 and at most 1 (mm)"
    allowed = " ".join(["a number", " and ".join(words), f"({unit})" * bool(unit)])
    return Annotated[Number, Field(gt=above, ge=least, le=most), Form(" ".join(allowed.split()))]


def whole(least: int, most: int):
    """Define integers between two bounds; booleans are not admissible."""
    allowed = Form(f"a whole number from {least} to {most}")
    return Annotated[int, Strict(), Field(ge=least, le=most), allowed]


def one_of(*names: str):
    """Define a text from a list."""
    return Annotated[Literal[names], Form(f"one of {', '.join(names)}")]


def many(one, allowed: str, least: int = 1, most: int | None = None):
    """Define a list of values of one form."""
    return Annotated[tuple[one, ...], Field(min_length=least, max_length=most), Form(allowed)]


def point(most: float | None = None):
    """Define a point with coordinates of magnitude up to ``most``."""
    bounds = {} if most is None else {"minimum": -most, "maximum": most}
    # two coordinates, each within the bounds
    own = Annotated[Number, Field(ge=bounds.get("minimum"), le=most)]
    size = "" if most is None else f", at most {most:g} in size"
    # JSON schema of draft 7 has no tuples of fixed length as pydantic writes them
    form = {"type": "array", "items": {"type": "number"} | bounds, "minItems": 2, "maxItems": 2}
    allowed = Form(f"a point [x, y] of two numbers{size} (mm)")
    return Annotated[tuple[own, own], WithJsonSchema(form), allowed]


def _not_too_many(value):
    # before every point is checked
    if isinstance(value, list) and len(value) > MOST_POINTS:
        raise GeometryError(
            f"{len(value)} points are more than the limit of {MOST_POINTS}; use fewer points"
        )
    return value


Text = Annotated[
    str, Strict(), StringConstraints(pattern=r"\S"), Form("a text that is not empty")
]  # fmt: skip


IDENTIFIER = "a name of letters, digits and _ that does not begin with a digit"


def _identifier(value: str) -> str:
    if not value.isidentifier():
        raise ValueError
    return value


Name = Annotated[
    str,
    Strict(),
    AfterValidator(_identifier),
    Form(IDENTIFIER),
]


def unfit_edge_name(edge: str) -> str:
    """Describe why parameters cannot be named after an edge; empty if they can."""
    if edge.isidentifier():
        return ""
    return (
        f"parameters are named after the edge {edge!r}, which therefore needs {IDENTIFIER}; rename "
        "the edge"
    )


# names of edges; points in mm; penalties of contact
Names = many(Text, 'a list of names, such as ["base"]')
Point = point()
Points = Annotated[
    many(Point, "a list of at least two points [[x, y], [x, y], ...] (mm)", 2, MOST_POINTS),
    BeforeValidator(_not_too_many),
]
Distances = Annotated[
    dict[str, number("mm", above=0.0)],
    Form("names with numbers above 0 (mm), such as { lip = 0.03 }"),
]
Penalty = number("kPa/mm", above=0.0, most=1e12)


_PERCENTAGE = 'a percentage above 0 and at most 50, such as "1 %"'
_Percentage = Annotated[
    str, Strict(), StringConstraints(pattern=r"^\s*(\d+\.?\d*|\.\d+)\s*%\s*$"),
    AfterValidator(fraction), Form(_PERCENTAGE),
]  # fmt: skip
Percentages = Annotated[
    _Percentage | Annotated[dict[str, _Percentage], Field(min_length=1)],
    Form(f'{_PERCENTAGE}, or a table of such percentages, such as {{ reaction = "1 %" }}'),
]
"""A fraction in (0, 0.5], or fractions by names."""
