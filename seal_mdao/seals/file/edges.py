"""Edges that a seal file names, one by one or as a stretch of the boundary."""

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.schema import known
from seal_mdao.seals.outline.section import Contour, Outline


def check_edges(where: str, key: str, names, outline: Outline) -> None:
    """Refuse names that no edge has, or that are given twice.

    Raises
    ------
    SealFileError
    """
    for i, name in enumerate(names):
        known(where, key, name, outline.edge_names, "edge")
        if name in names[:i]:
            raise SealFileError(f"{where}: {key} has {name!r} twice")


def contour_of(names, outline: Outline) -> Contour | None:
    """The contour along which the edges follow one another, or None."""
    for contour in outline.contours:
        own = [name for name in contour.edge_names if name in names]
        if len(own) == len(names):
            every = contour.edge_names
            first = [
                name for i, name in enumerate(every) if name in own and every[i - 1] not in own
            ]
            return contour if len(first) <= 1 else None
    return None


def stretch_order(names, outline: Outline) -> tuple[tuple, bool]:
    """Edges of a stretch as they are walked, and whether they go all round."""
    every = contour_of(names, outline).edge_names
    starts = [i for i, name in enumerate(every) if name in names and every[i - 1] not in names]
    first = starts[0] if starts else 0
    return tuple(n for n in every[first:] + every[:first] if n in names), not starts
