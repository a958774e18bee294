"""``[[design]]``: what may change about the shape of a section."""

import re
from typing import Annotated

from pydantic import AfterValidator, StringConstraints, WithJsonSchema, model_validator

from seal_mdao.seals.file.forms import Form, Names, Point, Text, many, number, one_of, whole
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.seals.outline.boundary_path import MirrorPlane
from seal_mdao.seals.outline.offset_fields import OffsetDesign
from seal_mdao.seals.outline.vertices_and_arcs import RadiusDesign, VertexDesign

MOST_PARAMETERS = 1000
KINDS = ("edges", "vertex", "arc")
"""Keys of which a design has one."""
BESIDE = {"parameters": "edges", "between": "edges", "opposite": "edges", "directions": "vertex"}
"""Keys that belong to one of them."""
_PLANE = r"^\s*([xy])\s*=\s*([-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*$"


def _plane(text: str) -> MirrorPlane:
    # "x = 0": the plane of this abscissa
    axis, at = re.match(_PLANE, text).group(1, 2)
    return MirrorPlane("xy".index(axis), float(at))


Plane = Annotated[
    str,
    StringConstraints(strict=True, pattern=_PLANE, max_length=100),
    AfterValidator(_plane),
    WithJsonSchema({"type": "string"}),
    Form('a plane of symmetry, such as "x = 0" (mm)'),
]


@table
class DesignTable(Table):
    """Design parameters: offsets of edges along their normals, a vertex, the radius of an arc."""

    bound: number("mm", above=0.0) = key("largest offset, displacement or change of the radius")
    edges: Names | None = key(
        "edges that move along their normals, a positive parameter out of the rubber; an end at an edge "
        "that does not move stays fixed",
        None,
    )
    parameters: whole(1, MOST_PARAMETERS) | None = key(
        "with edges: number n of parameters of each edge; of an edge that is its own image under "
        "mirror, (n + 1) / 2 remain, of a closed edge n / 2 + 1, rounded down",
        None,
    )
    between: many(Point, "two points [[x, y], [x, y]] (mm)", 2, 2) | None = key(
        "with one edge: the part of it that moves, from the first point to the second, "
        "counter-clockwise on the outer contour, clockwise on holes",
        None,
    )
    opposite: Text | None = key(
        "with edges: the edge on the other side of a wall; every point of it has the outward offset of "
        "the nearest point of the edges, so the thickness changes by twice the offset",
        None,
    )
    vertex: Point | None = key(
        "instead of edges: an end of a segment that moves, a positive parameter along +x or +y; the "
        "adjacent segments follow linearly",
        None,
    )
    directions: many(one_of("x", "y"), 'a list of "x", "y" or both') | None = key(
        "with vertex: directions in which it moves, one parameter each; default: both, or along a plane "
        "of symmetry",
        None,
    )
    arc: Point | None = key(
        "instead of edges: a point of an arc or circle whose radius changes; a positive parameter "
        "enlarges the radius, which moves the circle of a hole into the rubber; an arc tangent to its "
        "neighbouring lines remains tangent, otherwise its centre does not move",
        None,
    )
    mirror: Plane | None = key(
        "plane of symmetry of the change: mirror images move too, with the same parameters",
        None,
    )

    @model_validator(mode="after")
    def _one_kind(self):
        given = [name for name in KINDS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                "a [[design]] needs exactly one of the keys edges, vertex and arc, but this one "
                "has " + (" and ".join(given) or "none of them")
            )
        for name, owner in BESIDE.items():
            if getattr(self, name) is not None and given != [owner]:
                raise ValueError(
                    f"the key {name} can only be combined with {owner}, not with {given[0]}; leave "
                    f"out {name}"
                )
        if self.edges is not None and self.parameters is None:
            raise ValueError(
                f"the key 'parameters' is missing; it must be {self.allowed('parameters')}"
            )
        if self.opposite is not None and self.opposite in self.edges:
            raise ValueError(
                f"opposite = {self.opposite!r} is also in the list edges; opposite must be the edge on "
                "the other side of the wall"
            )
        if self.directions is not None and len(set(self.directions)) < len(self.directions):
            raise ValueError(
                f"directions contains {self.directions[0]!r} twice; remove one of the two"
            )
        if self.between is not None and len(self.edges) > 1:
            raise ValueError(
                "the key between cannot be combined with several edges; write a separate "
                "[[design]] for every part of the boundary"
            )
        return self

    @property
    def moving(self) -> tuple:
        """Edges that the design moves."""
        opposite = () if self.opposite is None else (self.opposite,)
        return (*(self.edges or ()), *opposite)

    def made(self) -> OffsetDesign | VertexDesign | RadiusDesign:
        """Make the design."""
        if self.vertex is not None:
            axes = None if self.directions is None else tuple(map("xy".index, self.directions))
            return VertexDesign(self.vertex, axes, self.mirror)
        if self.arc is not None:
            return RadiusDesign(self.arc, self.mirror)
        return OffsetDesign(self.edges, self.parameters, self.between, self.opposite, self.mirror)
