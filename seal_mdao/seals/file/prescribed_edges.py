"""Tables that prescribe displacements of edges: fixed, symmetry, moved, bonded to a profile."""

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.forms import unfit_edge_name
from seal_mdao.seals.file.schema import known
from seal_mdao.seals.outline.contours import JOIN, Outline


def check_edges(where: str, key: str, names, outline: Outline) -> None:
    """Raise SealFileError for names of edges that do not exist or are given twice."""
    for i, name in enumerate(names):
        known(where, key, name, outline.edge_names, "edge")
        if name in names[:i]:
            raise SealFileError(
                f"{where}: the list {key} contains the edge {name!r} twice; remove one of the two "
                "names"
            )


def held(file) -> list:
    """List the prescribed edges: position in the file, edges, components, pivot and stages."""
    none, both = (0.0, 0.0), (0, 1)
    found = [("[fixed]", file.fixed_edges, file.fixed_components, none, ())]
    for number, plane in enumerate(file.symmetries, 1):
        found.append((f"[[symmetry]] {number}", plane.edges, ("xy".index(plane.normal),), none, ()))
    for number, own in enumerate(file.moved, 1):
        where = f"[[moved]] {number} ({own.name!r})"
        found.append((where, own.edges, own.components, own.pivot, own.stages))
    for number, own in enumerate(file.profiles, 1):
        # the pivot moves with the profile: in fixed coordinates where it is at the start
        pivot = tuple(np.add(own.start, own.pivot).tolist())
        where = f"[[profile]] {number} ({own.name!r})"
        found.append((where, own.glued or (), both, pivot, own.stages))
    return found


def holder(file, name: str) -> str:
    """Return the table that prescribes an edge, as messages name it."""
    where = next(place for place, names, *_ in held(file) if name in names)
    return where.split(" ")[0] if where.startswith("[[symmetry") else where


def check_moved(file) -> None:
    """Raise SealFileError for moved or bonded edges that are prescribed already, or that meet edges
    with another motion."""
    outline, owners = file.section.outline, {}
    for where, names, components, pivot, stages in held(file):
        key = "glued" if where.startswith("[[profile") else "edges"
        check_edges(where, key, names, outline)
        for name in names:
            if name in owners:
                raise SealFileError(
                    f"{where}: the list {key} contains the edge {name!r}, which {owners[name][0]} "
                    "already constrains; remove this edge from one of the two tables"
                )
        for name in names:
            _check_corners(outline, name, (where, components, pivot, stages), owners)
        owners |= dict.fromkeys(names, (where, components, pivot, stages))


def _check_corners(outline: Outline, name: str, own: tuple, owners: dict) -> None:
    """Refuse a common corner of two edges that prescribe different displacements for it."""
    ends = _ends(outline, name)
    for other, its in owners.items():
        # distances of all ends of one edge from all of the other
        apart = np.hypot(*(ends[:, None] - _ends(outline, other)).T)
        if its[0] == own[0] or apart.min() > JOIN:
            continue
        for component in set(own[1]) & set(its[1]):
            if _program(own, component) != _program(its, component):
                raise SealFileError(
                    f"{own[0]}: the edge {name!r} meets {other!r} of {its[0]} at a corner, but "
                    f"they prescribe different displacements along {'xy'[component]}; leave a free "
                    "edge between them"
                )


def _ends(outline: Outline, name: str) -> np.ndarray:
    """Return the ends of all segments of an edge, shape (k, 2), mm."""
    return np.array([end for segment in outline.edge(name) for end in (segment.start, segment.end)])


def _program(own: tuple, component: int) -> tuple:
    """Return what a motion prescribes for one component, for comparison; empty at rest."""
    _, _, pivot, stages = own
    # a rotation moves the corner in both components, by its pivot
    if any(stage.rotate for stage in stages):
        return (pivot, *((stage.translate, stage.rotate, stage.steps) for stage in stages))
    moved = tuple((stage.translate[component], stage.steps) for stage in stages)
    return moved if any(travel for travel, _ in moved) else ()


def check_friction_by_edge(where: str, profile) -> None:
    """Raise SealFileError for friction of edges that the profile does not touch, or for a missing
    edge."""
    for name in profile.friction.names:
        known(where, "friction", name, profile.contact, "edge in contact")
        if unfit := unfit_edge_name(name):
            raise SealFileError(f"{where}: friction: {unfit}")
    missing = [name for name in profile.contact if name not in profile.friction.names]
    if missing:
        raise SealFileError(
            f"{where}: the key friction has no coefficient for the edge {missing[0]!r}; add a "
            "coefficient for this edge"
        )


def check_pairs(self_contact) -> None:
    """Raise SealFileError for pairs of edges outside of self-contact, and pairs that are given
    twice."""
    seen = {}
    for number, pair in enumerate(self_contact.pairs, 1):
        where = f"[[self_contact.pair]] {number}"
        for name in pair.edges:
            known(where, "edges", name, self_contact.edges, "edge in [self_contact]")
            if unfit := unfit_edge_name(name):
                raise SealFileError(f"{where}: edges: {unfit}")
        if frozenset(pair.edges) in seen:
            raise SealFileError(
                f"{where}: the pair of edges {' and '.join(pair.edges)} is already in "
                f"{seen[frozenset(pair.edges)]}; remove one of the two tables"
            )
        seen[frozenset(pair.edges)] = where
