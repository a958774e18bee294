"""``[model]``: kinematics of the section and its environment; what a body of revolution forbids."""

from typing import Annotated

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.materials.hoop_stretch import is_known
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.seals.conditions import HOTTEST
from seal_mdao.seals.file.clearance import LOOK, ROUNDING, TYPED, nearest_of
from seal_mdao.seals.file.forms import Form, many, number, one_of
from seal_mdao.seals.file.prescribed_edges import held
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.seals.outline.contours import Outline
from seal_mdao.seals.outline.sampling import MATCH

PLANE_STRAIN, AXISYMMETRIC = "plane_strain", "axisymmetric"
GENERALISED = "generalised_plane_strain"
ENTROPIC = "entropic"
RADIAL, AXIAL = 0, 1
"""Components of displacement: across the axis, where it is zero on it, and along it."""


def per_stage(one, allowed: str):
    """Make the form of a value at the ends of all stages, or of a list with one for every stage."""
    return Annotated[
        one | many(one, "a list"), Form(f"{allowed}, or a list with one for the end of every stage")
    ]


def at_stage_ends(file, where: str, given) -> tuple:
    """Return the values of a ``SealFile`` at the ends of its stages, of one number or of a list.

    Raises
    ------
    SealFileError
        For a list with another number of values.
    """
    count = len(file.stages)
    values = given if isinstance(given, tuple) else (given,) * count
    if len(values) != count:
        raise SealFileError(
            f"{where} has {len(values)} numbers, but the motion of {file.leading.name!r} has "
            f"{count} {'stage' if count == 1 else 'stages'}; give one number for the end of every "
            "stage, or a single number for all"
        )
    return values


@table
class ModelTable(Table):
    """Kinematics of the section, and temperature and axial stretch over the stages."""

    kinematics: one_of(PLANE_STRAIN, GENERALISED, AXISYMMETRIC) = key(
        "long seal of this section, results per metre; the same stretched along its axis, results per "
        "metre of the stretched seal; or the ring that the section makes when it is turned about the "
        "axis x = 0, results of the complete ring",
        PLANE_STRAIN,
    )
    axial_stretch: (
        per_stage(number(least=0.5, most=2.0), "a number of at least 0.5 and at most 2") | None
    ) = key(
        "length of the seal in use divided by its length as made; it changes from 1 in the "
        "first stage",
        None,
    )
    temperature: (
        per_stage(
            number(above=ABSOLUTE_ZERO, most=HOTTEST),
            "a number above -273.15 and at most 1000 (degC)",
        )
        | None
    ) = key(
        "temperature of the seal; it changes from reference_temperature in the first stage", None
    )
    reference_temperature: number("degC", above=ABSOLUTE_ZERO, most=HOTTEST) = key(
        "temperature for which the shape of the section and the constants of the materials are "
        "given",
        23.0,
    )


def axis_edges(outline: Outline) -> tuple[str, ...]:
    """Find the edges that lie on the axis x = 0."""
    return tuple(name for name in outline.edge_names if _radii(outline, name).max() <= _on(outline))


def _radii(outline: Outline, name: str) -> np.ndarray:
    """Distances from the axis along an edge, negative beyond it, mm."""
    # x of points along the chords of every segment
    around = [s.points(s.chords(LOOK * outline.size))[:, 0] for s in outline.edge(name)]
    return np.concatenate(around)


def _on(outline: Outline) -> float:
    """Distance from the axis that counts as zero, mm."""
    return max(ROUNDING * outline.size, MATCH)


def check_axisymmetric(file) -> None:
    """Refuse a ``SealFile`` of a body of revolution that has what such a body cannot have."""
    if not file.axisymmetric:
        return
    _check_section(file.section.outline)
    _check_edges_on_axis(file)
    _check_planes(file)
    _check_motions(file)
    _check_radial_motions(file)
    for name, material in file.materials.items():
        if not is_known(material):
            raise SealFileError(
                f"[material.{name}]: the compressible law {type(material).__name__} supports plane "
                "strain only; use another law, or define its method volumetric for kinematics = "
                f'"{AXISYMMETRIC}"'
            )
    for where, measure in file.located_measures:
        if getattr(measure, "length", None) is not None:
            raise SealFileError(
                f'{where}: length needs kinematics = "{PLANE_STRAIN}"; leave out '
                "length, because the forces of a body of revolution are already in N"
            )


def _check_section(outline: Outline) -> None:
    """Refuse a section beyond the axis, or that touches it without an edge there."""
    tolerance, on_axis = _on(outline), axis_edges(outline)
    # ends of the segments on the axis: only there may other edges touch it
    ends = [(s.start, s.end) for name in on_axis for s in outline.edge(name)]
    known = np.array(ends).reshape(-1, 2)
    for name in outline.edge_names:
        radii = _radii(outline, name)
        if radii.min() < -tolerance:
            raise SealFileError(
                f"[section]: the edge {name!r} reaches x = {radii.min():.4g}, beyond the axis of "
                f'revolution x = 0 (kinematics = "{AXISYMMETRIC}"); x is the radius, so move the '
                "section to x >= 0"
            )
        if name in on_axis:
            continue
        for segment in outline.edge(name):
            # its ends, and its point nearest to the axis: an arc may touch the axis between its ends
            inner = nearest_of(segment, lambda x, _: x, LOOK * outline.size).place
            for point in np.array([segment.start, segment.end, inner], float):
                apart = np.hypot(*(known - point).T).min(initial=np.inf)
                if point[0] <= tolerance and apart > LOOK * outline.size:
                    y = point[1] if abs(point[1]) > TYPED * outline.size else 0.0
                    raise SealFileError(
                        f"[section]: the edge {name!r} touches the axis x = 0 in the single point "
                        f"y = {y:.4g}; end it at x > 0, or draw an edge along the axis"
                    )


def _check_edges_on_axis(file) -> None:
    """Refuse contact, fluids, designs, motions and axial supports of edges on the axis."""
    on_axis = set(axis_edges(file.section.outline))
    named = [(f"[[profile]] {i}: contact", own.contact) for i, own in enumerate(file.profiles, 1)]
    for i, own in enumerate(file.designs, 1):
        named.append((f"[[design]] {i}: edges", own.edges or ()))
        named.append((f"[[design]] {i}: opposite", () if own.opposite is None else (own.opposite,)))
    named += [(f"[[moved]] {i}: edges", own.edges) for i, own in enumerate(file.moved, 1)]
    named += [(f"[[fluid]] {i}: edge", own.edges) for i, own in enumerate(file.fluids, 1)]
    if file.self_contact is not None:
        named.append(("[self_contact]: edges", file.self_contact.edges))
    for where, names in named:
        for name in names:
            if name in on_axis:
                raise SealFileError(
                    f"{where} contains the edge {name!r}, which lies on the axis of revolution and is "
                    "not a surface; remove this edge"
                )
    for where, names, components, *_ in held(file):
        for name in names if AXIAL in components else ():
            if name in on_axis:
                raise SealFileError(
                    f"{where} prescribes displacements along y of the edge {name!r}, which lies on the "
                    "axis of revolution and is not a surface: the force of such a support depends on "
                    "the particle spacing; remove this edge from the table and prescribe another one "
                    "(edges on the axis stay there without a table)"
                )


def _check_planes(file) -> None:
    """Refuse mirror images across the radius, of which a body of revolution has none."""
    for i, plane in enumerate(file.symmetries, 1):
        if plane.normal == "x":
            raise SealFileError(
                f'[[symmetry]] {i}: normal = "x" is not possible for a body of revolution: x is the '
                "radius, the section is already turned about the axis x = 0, and edges on the axis stay "
                "there; leave out this table, or hold the edges in the radial direction by [fixed] with "
                'directions = ["x"]'
            )


def _check_motions(file) -> None:
    """Refuse stages that rotate: a ring has no such rigid motion."""
    for kind, rows in (("profile", file.profiles), ("moved", file.moved)):
        for i, own in enumerate(rows, 1):
            for k, stage in enumerate(own.stages, 1):
                if stage.rotate:
                    raise SealFileError(
                        f"[[{kind}]] {i} ({own.name!r}): [[{kind}.stage]] {k} rotates, which is "
                        "not possible for a body of revolution; use translate (y: axial, x: change "
                        "of radius)"
                    )


def _check_radial_motions(file) -> None:
    """Refuse moved or glued edges that touch the axis and move along x, or that move beyond it."""
    outline = file.section.outline
    for where, names, components, _, stages in held(file):
        travel = np.cumsum([0.0, *(stage.translate[RADIAL] for stage in stages)])
        if RADIAL not in components or not travel.any():
            continue
        for name in names:
            radius = _radii(outline, name).min()
            if radius <= _on(outline):
                raise SealFileError(
                    f"{where} moves the edge {name!r} along x, but the edge touches the axis of "
                    "revolution x = 0, where nothing moves along x; translate it along y only"
                )
            if radius + travel.min() <= _on(outline):
                raise SealFileError(
                    f"{where} moves the edge {name!r} to x = {radius + travel.min():.4g}, but a body "
                    "of revolution must stay at x > 0; use less travel along x"
                )
