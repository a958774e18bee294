"""VTU files (VTK XML format of unstructured grids, binary, compressed)."""

import base64
import sys
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

CELL_TYPES = {"triangle": 5, "quad": 9}
"""Numbers of VTK by the names of cell types."""


def write_vtu(
    path: Path,
    points: np.ndarray,
    cells: Sequence[tuple[str, np.ndarray]],
    point_data: Mapping[str, np.ndarray],
) -> None:
    """Write points and cells with data of the points.

    Parameters
    ----------
    path : Path
    points : ndarray, shape (n, 3)
    cells : sequence of (str, ndarray of int)
        Cell type of ``CELL_TYPES`` and corners of its cells, shape (m, k).
    point_data : mapping of str to ndarray
        By name; shape (n,) or (n, components).
    """
    corners = np.concatenate([own.ravel() for _, own in cells])
    # of every cell: the index behind its last corner, and its type
    ends = np.cumsum(np.concatenate([np.full(len(own), own.shape[1]) for _, own in cells]))
    types = np.concatenate([np.full(len(own), CELL_TYPES[kind], np.uint8) for kind, own in cells])
    of_points = [_array(name, values) for name, values in point_data.items()]
    text = "\n".join([
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" header_type="UInt64" '
        f'byte_order="{sys.byteorder.capitalize()}Endian" compressor="vtkZLibDataCompressor">',
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(types)}">',
        "<Points>", _array("Points", points), "</Points>",
        "<Cells>",
        _array("connectivity", corners.astype(np.int64)),
        _array("offsets", ends.astype(np.int64)),
        _array("types", types),
        "</Cells>",
        "<PointData>", *of_points, "</PointData>",
        "</Piece>", "</UnstructuredGrid>", "</VTKFile>", "",
    ])  # fmt: skip
    path.write_text(text, encoding="utf-8")


def _array(name: str, values: np.ndarray) -> str:
    """Write an array as an element: a header with sizes in bytes, then one compressed block."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.itemsize)
    components = "" if values.ndim == 1 else f' NumberOfComponents="{values.shape[1]}"'
    packed = zlib.compress(values.tobytes())
    # number of blocks, size of a block, size of the last one, size of the compressed one
    header = np.array([1, values.nbytes, values.nbytes, len(packed)], np.uint64)
    content = base64.b64encode(header.tobytes()) + base64.b64encode(packed)
    return (
        f'<DataArray type="{kind}" Name="{name}"{components} format="binary">'
        f"{content.decode()}</DataArray>"
    )
