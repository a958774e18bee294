"""Clouds in files of their own (VTU and every other format of meshio, extra ``vtk``)."""

import io
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.input_files import read_bytes, reason_of, require_ordinary
from seal_mdao.mesh_files import cell_blocks, flat, library
from seal_mdao.rkpm.basis import BASIS_SIZE
from seal_mdao.rkpm.cells import GAUSS_POINTS, in_both_directions
from seal_mdao.seals.outline.cloud import OutlineCloud
from seal_mdao.seals.outline.kernels import Kernels
from seal_mdao.seals.outline.located import located
from seal_mdao.seals.outline.section import Outline

FIRST, SUPPORT, AXES = "first_place", "support_radius", "support_axes"
"""Names of the data of points."""
PART, BASIS, COLUMN, GAUSS = "part", "basis_order", "column", "n_gauss"
"""Names of the data of cells; those of one ``column`` have one pressure through them."""

XDMF, ABAQUS = (".xdmf", ".xmf"), ".inp"
"""Endings of meshes that name further files, or may do so."""

KINDS = {"quad": 4, "triangle": 3}
"""Cells that bodies are made of; lines and points beside them are passed over."""


@dataclass(frozen=True, eq=False)
class GivenCloud:
    """A cloud that was not made here, or not for this section.

    Attributes
    ----------
    cloud : OutlineCloud
    boundaries : tuple of Boundary
        Its points along the contours of the section.
    kernels : Kernels
        Their basis, pressure and integration; supports are those of the cloud, if it has them.
    """

    cloud: OutlineCloud
    boundaries: tuple
    kernels: Kernels = field(default_factory=Kernels)


def write_cloud(seal, offsets, path) -> Path:
    """Write the cloud of a design: particles and cells, where the particles were when kernels were
    chosen, their supports, and of every cell the part of the section, the basis, the column and the
    Gauss points in its two directions.

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
    of_points = {FIRST: flat(body.drawn), SUPPORT: body.support_radius}
    if body.support_axes is not None:
        of_points[AXES] = body.support_axes.reshape(-1, 4)
    columns = np.arange(len(body.cells)) // body.column
    of_cells = {
        PART: seal.parts, BASIS: np.full(len(columns), body.basis_order), COLUMN: columns,
        GAUSS: np.tile(in_both_directions(body.n_gauss), (len(columns), 1)),
    }  # fmt: skip
    blocks = {name: cell_blocks(body.cells, values) for name, values in of_cells.items()}
    mesh = library().Mesh(
        flat(seal.particles(offsets)), [(kind, corners) for kind, corners, _ in blocks[PART]],
        point_data=of_points,
        cell_data={name: [own for _, _, own in found] for name, found in blocks.items()},
    )  # fmt: skip
    mesh.write(Path(path))
    return Path(path)


def read_cloud(path, outline: Outline) -> GivenCloud:
    """A cloud whose boundary is that of a section, to 1e-6 mm.

    Quadrilaterals and triangles of any mesh. The data of points ``first_place``, ``support_radius``,
    ``support_axes`` and those of cells ``basis_order``, ``column``, ``n_gauss`` give the kernels, which
    otherwise are chosen for the cloud as it is; the data of cells ``part`` tells the parts of a section
    of several materials apart.

    Raises
    ------
    ImportError
        Without meshio.
    GeometryError
        For a file that is no mesh, or is that of another section.
    """
    path = Path(path)
    try:
        mesh = _mesh(path)
        particles, cells, used = _cells(mesh)
        loops, boundaries = _matched(outline, particles, _loops(cells))
        first, support, axes = (
            None if data is None else np.asarray(data, float)[used]
            for data in map(mesh.point_data.get, (FIRST, SUPPORT, AXES))
        )
        cloud = OutlineCloud(
            particles, cells, loops, _of_cells(mesh, PART, 0),
            None if first is None else np.ascontiguousarray(first[:, :2]),
            None if support is None else support.ravel(),
            None if axes is None else axes.reshape(-1, 2, 2),
        )  # fmt: skip
        return GivenCloud(cloud, boundaries, _kernels(mesh))
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
        raise GeometryError(f"not a mesh that can be read ({reason_of(error)})") from None


def _require_one_file(path) -> None:
    """Refuse meshes that name further files, which may be any of the machine."""
    content = read_bytes(path) if path.suffix.lower() == ABAQUS else b""
    if path.suffix.lower() in XDMF or b"include" in content.lower().replace(b"*", b""):
        raise GeometryError("names further files of its mesh; write it as one file, such as VTU")
    require_ordinary(path)


def _cells(mesh):
    """Particles that cells have, the cells counter-clockwise, and which points of the file they are."""
    found = []
    for block in mesh.cells:
        if block.type in KINDS:
            data = np.asarray(block.data, int)
            found.append(np.column_stack([data, data[:, -1]]) if data.shape[1] == 3 else data)
        elif block.type not in ("line", "vertex"):
            raise GeometryError(f"has cells of the kind {block.type!r}; use quad and triangle")
    if not found:
        raise GeometryError("has no quadrilaterals and no triangles")
    cells, points = np.concatenate(found), np.asarray(mesh.points, float)[:, :2]
    used, cells = np.unique(cells, return_inverse=True)
    cells, points = cells.reshape(-1, 4), np.ascontiguousarray(points[used])
    return points, _counter_clockwise(cells, points), used


def _counter_clockwise(cells, points):
    x, y = np.moveaxis(points[cells], -1, 0)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    # a triangle repeats its last corner, also the other way round
    turned = np.where(cells[:, 2:3] == cells[:, 3:], cells[:, [2, 1, 0, 0]], cells[:, ::-1])
    return np.where((area > 0.0)[:, None], cells, turned)


def _loops(cells) -> list[np.ndarray]:
    """Particles along every boundary of the cells, the material on the left."""
    following = {}
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    every = {(a, b) for a, b in sides.tolist() if a != b}
    for a, b in every:
        if (b, a) not in every and following.setdefault(a, b) != b:
            raise GeometryError("parts of the boundary of its cells touch in a point")
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
    """Loops and boundaries in the order of the contours."""
    if len(loops) != len(outline.contours):
        raise GeometryError(
            f"closed boundaries: {len(loops)} in the cells, {len(outline.contours)} in the section"
        )
    found, boundaries = [], []
    for contour in outline.contours:
        start = contour.segments[0].start
        away = [np.hypot(*(particles[loop] - start).T).min() for loop in loops]
        loop = loops.pop(int(np.argmin(away)))
        boundary, order = located(contour, particles[loop])
        found.append(loop[order])
        boundaries.append(boundary)
    if polygon_area(particles[found[0]])[0] <= 0.0:
        raise GeometryError("its outside is not that of the section")
    return tuple(found), tuple(boundaries)


def _kernels(mesh) -> Kernels:
    """Basis, pressure and integration of the cells."""
    order, column = _of_cells(mesh, BASIS, 1), _of_cells(mesh, COLUMN, None)
    if order.min() != order.max() or order[0] not in BASIS_SIZE:
        raise GeometryError(f"{BASIS} of its cells must be 1 or 2, the same for all")
    size = np.count_nonzero(column == column[0])
    if len(column) % size or np.any(column != np.repeat(column[::size], size)):
        raise GeometryError(f"its cells of one {COLUMN} must follow each other, as many in each")
    gauss = _of_cells(mesh, GAUSS, 2).reshape(len(order), -1)
    low, high = GAUSS_POINTS
    if gauss.shape[1] > 2 or np.any((gauss != gauss[0]) | (gauss < low) | (gauss > high)):
        raise GeometryError(
            f"{GAUSS} of its cells must be one number or two from {low} to {high}, the same for all"
        )
    return Kernels(
        basis_order=int(order[0]), column=int(size), n_gauss=in_both_directions(gauss[0])
    )


def _of_cells(mesh, name: str, default) -> np.ndarray:
    """Integers of every cell; without a default their own numbers where the file does not tell."""
    blocks = [i for i, block in enumerate(mesh.cells) if block.type in KINDS]
    data = mesh.cell_data.get(name)
    if data is None:
        numbers = np.arange(sum(len(mesh.cells[i].data) for i in blocks))
        return numbers if default is None else np.full(numbers.shape, default)
    return np.concatenate([np.asarray(data[i]).ravel() for i in blocks]).astype(int)
