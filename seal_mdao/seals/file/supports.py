"""``[fixed]`` and ``[[symmetry]]``: edges that are held, and whether every body is."""

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.edges import check_edges
from seal_mdao.seals.file.forms import Names, many, one_of
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.seals.file.start import LOOK, ROUNDING

TOUCHING = 1e-9
"""Gap of a profile that touches the section at the start, over its size."""


@table
class FixedTable(Table):
    """Edges that are fixed, and in which directions."""

    edges: Names = key("edges that are held")
    directions: many(one_of("x", "y"), 'a list of "x", "y" or both') = key(
        "in which they are held", ("x", "y")
    )


@table
class SymmetryTable(Table):
    """Edges in a plane beyond which the section continues as its mirror image."""

    edges: Names = key("straight edges in the plane; in a design they stay in it")
    normal: one_of("x", "y") = key("the axis across the plane")


def check_supports(file) -> None:
    """Refuse edges that there are not, that are held twice, or that lie in no plane of symmetry.

    Raises
    ------
    SealFileError
    """
    outline, own = file.section.outline, file.fixed_edges
    check_edges("[fixed]", "edges", own, outline)
    seen = dict.fromkeys(own, "[fixed]")
    for number, plane in enumerate(file.symmetries, 1):
        where = f"[[symmetry]] {number}"
        check_edges(where, "edges", plane.edges, outline)
        for name in plane.edges:
            if name in seen:
                raise SealFileError(f"{where}: edges has {name!r}, which {seen[name]} has already")
            seen[name] = where
            axis = "xy".index(plane.normal)
            spread = [s.points(s.chords(LOOK * outline.size))[:, axis] for s in outline.edge(name)]
            if np.ptp(np.concatenate(spread)) > ROUNDING * outline.size:
                raise SealFileError(
                    f"{where}: edges has {name!r}, which does not lie in one plane of constant "
                    f"{plane.normal}"
                )


def check_bodies_held(file, gaps) -> None:
    """Refuse a body without a fixed edge that no profile touches at the start.

    Parameters
    ----------
    file : SealFile
    gaps : list of float
        Least gap of every profile at the start, mm.

    Raises
    ------
    SealFileError
    """
    outline, fixed = file.section.outline, file.fixed_edges
    for number, contours in enumerate(outline.bodies, 1):
        names = {name for contour in contours for name in contour.edge_names}
        if names & set(fixed):
            continue
        own = [
            gap
            for gap, profile in zip(gaps, file.profiles, strict=True)
            if names & set(profile.contact) and profile.contact_points == "particles"
        ]
        if min(own, default=np.inf) <= TOUCHING * outline.size:
            continue
        first = contours[0].edge_names[0]
        what = f"body {number} (edge {first!r})" if outline.others else "the section"
        missing = "[fixed] has no edge of it" if fixed else "[fixed] is missing"
        nearest = (
            f"the nearest one is {min(own):.3g} mm away "
            if own
            else "no profile may touch it at a particle "
        )
        raise SealFileError(
            f"{missing}, so profiles have to hold {what}, but none touches it at the start: {nearest}"
            "(let a segment of the boundary end where it touches, so that a particle is there)"
        )
