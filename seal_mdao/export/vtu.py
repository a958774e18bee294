"""The deformed section step by step for ParaView, with the library meshio (extra ``vtk``)."""

import json
from importlib import import_module
from pathlib import Path

import numpy as np

from seal_mdao.seals.profiles import contacts, pressure

MISSING = "VTU files need meshio, which is not installed: pip install seal_mdao[vtk]"


def library():
    """meshio.

    Raises
    ------
    ImportError
        Without it.
    """
    try:
        return import_module("meshio")
    except ImportError as error:
        raise ImportError(MISSING) from error


def write_vtu_series(result, folder) -> Path:
    """Write a VTU file for the undeformed section and for every nominal step of a result.

    Points are the undeformed particles (mm); ``displacement`` (mm), ``von_mises`` (kPa), ``det_F`` and,
    for every profile, its contact pressure (kPa) are data of the points. In ParaView open the series
    and warp by ``displacement``.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    folder : str or Path
        Made if need be.

    Returns
    -------
    Path
        ``steps.vtu.series``, which names all files with the number of the step.

    Raises
    ------
    ImportError
        Without meshio.
    """
    meshio, folder = library(), Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    points = np.column_stack([result.particles, np.zeros(len(result.particles))])
    cells = cell_blocks(result.seal.body.cells)
    files = []
    for number in range(len(result.path.nominal_steps) + 1):
        name = f"step_{number:04d}.vtu"
        data = _no_data(result) if number == 0 else point_data(result, number - 1)
        meshio.Mesh(points, cells, point_data=data).write(folder / name)
        files.append({"name": name, "time": number})
    series = folder / "steps.vtu.series"
    text = json.dumps({"file-series-version": "1.0", "files": files}, indent=1)
    series.write_text(text + "\n", encoding="utf-8")
    return series


def cell_blocks(cells: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Quadrilaterals and triangles of cells (m, 4), in which a triangle repeats a corner."""
    repeated = cells == np.roll(cells, 1, axis=1)
    triangular = repeated.any(axis=1)
    triangles = cells[triangular][~repeated[triangular]].reshape(-1, 3)
    blocks = [("quad", cells[~triangular]), ("triangle", triangles)]
    return [(kind, found) for kind, found in blocks if len(found)]


def point_data(result, step: int) -> dict[str, np.ndarray]:
    """Fields at the particles after a nominal step, by name."""
    f = result.gradient(step)
    data = {
        "displacement": np.column_stack([result.displacement(step), np.zeros(len(f))]),
        "von_mises": result.stress_field(step),
        "det_F": f[:, 0] * f[:, 3] - f[:, 1] * f[:, 2],
    }
    for contact in contacts(result.seal):
        values = np.zeros(len(f))
        response = result.path.at_nominal(contact.label)[step]
        values[contact.where.at_particles] = pressure(contact, response)
        data[f"pressure_{contact.label}"] = values
    return data


def _no_data(result) -> dict[str, np.ndarray]:
    """The same before the first step."""
    n = len(result.particles)
    data = {"displacement": np.zeros((n, 3)), "von_mises": np.zeros(n), "det_F": np.ones(n)}
    return data | {f"pressure_{c.label}": np.zeros(n) for c in contacts(result.seal)}
