"""Read and write clouds of particles (VTU and all formats of meshio, extra ``vtk``)."""

import io
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.input_files import read_bytes, reason_of, require_ordinary
from seal_mdao.mesh_files import cell_blocks, flat, library
from seal_mdao.rkpm.basis import BASIS_SIZE
from seal_mdao.rkpm.cells import GAUSS_POINTS, bodies, in_both_directions
from seal_mdao.seals.outline.contours import Outline
from seal_mdao.seals.outline.sampling import located
from seal_mdao.seals.outline.section_cloud import Kernels, OutlineCloud
from seal_mdao.seals.outline.segments import pair

FIRST, SUPPORT, AXES = "first_place", "support_radius", "support_axes"
"""Names of point data."""
PART, BASIS, COLUMN, GAUSS = "part", "basis_order", "column", "n_gauss"
"""Names of cell data; cells of one ``column`` share one continuous pressure."""

XDMF, ABAQUS = (".xdmf", ".xmf"), ".inp"
"""Suffixes of mesh formats that refer to further files, or may do so."""

KINDS = {"quad": 4, "triangle": 3}
"""Cell types of bodies; lines and points are ignored."""


def write_cloud(seal, offsets, path) -> Path:
    """Write the cloud of a design to a mesh file.

    Particles and cells; as point data the nominal particles, at which kernels were chosen, and their
    supports; as cell data the part of the section, basis, column and Gauss points in two directions.

    Parameters
    ----------
    seal : OutlineSeal
    offsets : ndarray, shape (seal.n_offsets,)
        mm.

    Raises
    ------
    ImportError
        Without meshio.
    """
    body = seal.body
    of_points = {FIRST: flat(body.nominal), SUPPORT: body.support_radius}
    if body.support_axes is not None:
        of_points[AXES] = body.support_axes.reshape(-1, 4)
    # cells of a column follow each other
    columns = np.arange(len(body.cells)) // body.column
    of_cells = {
        PART: seal.parts, BASIS: np.full(len(columns), body.basis_order), COLUMN: columns,
        GAUSS: np.tile(in_both_directions(body.n_gauss), (len(columns), 1)),
    }  # fmt: skip
    # meshio has one block a cell type: data are split as the cells are
    blocks = {name: cell_blocks(body.cells, values) for name, values in of_cells.items()}
    mesh = library().Mesh(
        flat(seal.particles(offsets)), [(kind, corners) for kind, corners, _ in blocks[PART]],
        point_data=of_points,
        cell_data={name: [own for _, _, own in found] for name, found in blocks.items()},
    )  # fmt: skip
    mesh.write(Path(path))
    return Path(path)


def read_cloud(path, outline: Outline) -> OutlineCloud:
    """Read a cloud whose boundary coincides with that of a section within 1e-6 mm.

    Accepts quadrilaterals and triangles of any mesh. The point data ``first_place``, ``support_radius``,
    ``support_axes`` and the cell data ``basis_order``, ``column``, ``n_gauss`` give the kernels, which
    otherwise are chosen for the cloud as it is; the cell data ``part`` distinguish the parts of a
    section of several materials.

    Raises
    ------
    ImportError
        Without meshio.
    GeometryError
        For a file that is no mesh, or the mesh of another section.
    """
    # cells, then their boundary along the section, then kernels at the nominal particles
    path = Path(path)
    try:
        mesh = _mesh(path)
        particles, cells, used = _cells(mesh)
        loops, boundaries = _matched(outline, particles, _loops(cells, particles))
        # data are stored for all points of the file: select those that cells use
        first, support, axes = (
            None if data is None else np.asarray(data, float)[used]
            for data in map(mesh.point_data.get, (FIRST, SUPPORT, AXES))
        )
        # bodies that no cell connects are parts of their own
        parts = _of_cells(mesh, PART, bodies(cells, len(particles))[cells[:, 0]])
        return OutlineCloud(
            particles, cells, loops, parts,
            None if first is None else np.ascontiguousarray(first[:, :2]),
            None if support is None else support.ravel(),
            None if axes is None else axes.reshape(-1, 2, 2), boundaries, _kernels(mesh),
        )  # fmt: skip
    except GeometryError as error:
        raise GeometryError(f"{path}: {error}") from None


def _mesh(path):
    meshio = library()
    if not path.is_file():
        raise GeometryError("there is no such file")
    quiet = io.StringIO()
    try:
        _require_one_file(path)
        with redirect_stdout(quiet), redirect_stderr(quiet):  # meshio prints what it reads
            return meshio.read(path)
    except GeometryError:
        raise
    except (Exception, SystemExit) as error:  # meshio leaves the program at some files
        raise GeometryError(
            f"the mesh file (cloud) cannot be read ({reason_of(error)}); check the format of the "
            "file"
        ) from None


def _require_one_file(path) -> None:
    """Refuse meshes that refer to further files, which could be any file of the machine."""
    # XDMF has its arrays beside it, Abaqus may include files
    content = read_bytes(path) if path.suffix.lower() == ABAQUS else b""
    if path.suffix.lower() in XDMF or b"include" in content.lower().replace(b"*", b""):
        raise GeometryError(
            "the mesh file (cloud) refers to other files, which are not read; save the mesh as a "
            "single file, such as VTU"
        )
    require_ordinary(path)


def _cells(mesh):
    """Extract particles, cells (counter-clockwise) and the indices of the particles in the file."""
    # a triangle repeats its last corner; lines and points are ignored
    found = []
    for block in mesh.cells:
        if block.type in KINDS:
            data = np.asarray(block.data, int)
            found.append(np.column_stack([data, data[:, -1]]) if data.shape[1] == 3 else data)
        elif block.type not in ("line", "vertex"):
            raise GeometryError(
                f"the mesh has cells of the type {block.type!r}, but only quad and triangle are "
                "supported"
            )
    if not found:
        raise GeometryError("the mesh has neither quadrilaterals nor triangles")
    cells, points = np.concatenate(found), np.asarray(mesh.points, float)[:, :2]
    # points without a cell are dropped, the others renumbered in their order
    used, cells = np.unique(cells, return_inverse=True)
    cells, points = cells.reshape(-1, 4), np.ascontiguousarray(points[used])
    return points, _counter_clockwise(cells, points), used


def _counter_clockwise(cells, points):
    # shoelace formula, twice the signed area; the repeated corner of a triangle adds nothing
    x, y = np.moveaxis(points[cells], -1, 0)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    # reversed triangles must repeat their last corner again: (c, b, a, a)
    turned = np.where(cells[:, 2:3] == cells[:, 3:], cells[:, [2, 1, 0, 0]], cells[:, ::-1])
    return np.where((area > 0.0)[:, None], cells, turned)


def _loops(cells, particles) -> list[np.ndarray]:
    """Trace the boundaries of the cells as loops of particles, the material on the left."""
    following = {}
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    sides, count = np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)
    # of counter-clockwise cells each has a side in its direction alone, unless they overlap
    if (count > 1).any():
        middle = particles[sides[count.argmax()]].mean(axis=0)
        raise GeometryError(
            f"cells of the mesh overlap or occur twice beside {pair(middle)}; write every cell once "
            "(Gmsh writes a cell once for each physical group that contains it)"
        )
    every = set(map(tuple, sides.tolist()))
    for a, b in every:
        # a directed side without its opposite is on the boundary; two from one particle: touching parts
        if (b, a) not in every and following.setdefault(a, b) != b:
            raise GeometryError(
                "two parts of the boundary of the mesh touch in a single point; separate these "
                "parts or connect them along the side of a cell"
            )
    # follow the sides from the least particle until the loop closes
    loops = []
    while following:
        start = min(following)
        loop, at = [start], following.pop(start)
        while at != start:
            loop.append(at)
            at = following.pop(at)
        loops.append(np.array(loop))
    return loops


def _matched(outline, particles, loops) -> tuple[tuple, tuple]:
    """Match loops to the contours of the section; return loops and boundaries in their order."""
    if len(loops) != len(outline.contours):
        raise GeometryError(
            f"the mesh has {len(loops)} closed boundaries, but the section has "
            f"{len(outline.contours)}; mesh and section must have the same outline and holes"
        )
    found, boundaries = [], []
    for contour in outline.contours:
        start = contour.segments[0].start
        # the loop nearest to the start of the contour; ``located`` then checks all its particles
        away = [np.hypot(*(particles[loop] - start).T).min() for loop in loops]
        loop = loops.pop(int(np.argmin(away)))
        boundary, order = located(contour, particles[loop])
        found.append(loop[order])
        boundaries.append(boundary)
    if polygon_area(particles[found[0]])[0] <= 0.0:
        raise GeometryError(
            "the outer boundary of the mesh does not match the outer contour of the section; use "
            "the mesh of this section"
        )
    return tuple(found), tuple(boundaries)


def _kernels(mesh) -> Kernels:
    """Read basis, pressure and integration of the cells."""
    # one basis, one size of columns and one rule for all cells
    order, column = _of_cells(mesh, BASIS, 1), _of_cells(mesh, COLUMN, None)
    if order.min() != order.max() or order[0] not in BASIS_SIZE:
        raise GeometryError(
            f"the cell data {BASIS} of the mesh must be 1 or 2, the same for all cells"
        )
    size = np.count_nonzero(column == column[0])
    # equal columns of consecutive cells, as ``Body.column`` needs them
    if len(column) % size or np.any(column != np.repeat(column[::size], size)):
        raise GeometryError(
            f"the cells of the mesh with the same value of the cell data {COLUMN} must be "
            "consecutive, with the same number of cells in every column"
        )
    gauss = _of_cells(mesh, GAUSS, 2).reshape(len(order), -1)
    low, high = GAUSS_POINTS
    if gauss.shape[1] > 2 or np.any((gauss != gauss[0]) | (gauss < low) | (gauss > high)):
        raise GeometryError(
            f"the cell data {GAUSS} of the mesh must be one or two numbers from {low} to {high}, "
            "the same for all cells"
        )
    return Kernels(
        basis_order=int(order[0]), column=int(size), n_gauss=in_both_directions(gauss[0])
    )


def _of_cells(mesh, name: str, default) -> np.ndarray:
    """Read integer cell data; where missing the default, one number or one of every cell, or the cell
    indices if that is None."""
    blocks = [i for i, block in enumerate(mesh.cells) if block.type in KINDS]
    data = mesh.cell_data.get(name)
    if data is None:
        numbers = np.arange(sum(len(mesh.cells[i].data) for i in blocks))
        return numbers if default is None else np.full(numbers.shape, default)
    return np.concatenate([np.asarray(data[i]).ravel() for i in blocks]).astype(int)
