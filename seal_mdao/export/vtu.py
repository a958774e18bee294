"""Export of the deformed section of every load step to ParaView, with meshio (extra ``vtk``)."""

import json
from pathlib import Path

import numpy as np

from seal_mdao.mesh_files import cell_blocks, flat, library
from seal_mdao.seals.profiles import contacts, nominal_pressure, true_pressure

PRESSURES = ("pressure", "nominal_pressure")
"""Prefixes of the fields of a profile: true and nominal contact pressure."""


def write_vtu_series(result, folder) -> Path:
    """Write a VTU file for the undeformed section and for every nominal step of a result.

    Points are the undeformed particles (mm); ``displacement`` (mm), ``von_mises`` (kPa), ``det_F``
    (volume ratio, with the stretch across the section) and, for every profile, its true and its nominal
    contact pressure (kPa; force over deformed and over undeformed length) are data of the points. In
    ParaView open the series and warp by ``displacement``.

    Parameters
    ----------
    result : SealResult
        Complete, or up to the step at which the path ended.
    folder : str or Path
        Created if missing.

    Returns
    -------
    Path
        ``steps.vtu.series``, which lists all files with their step number as time.

    Raises
    ------
    ImportError
        Without meshio.
    """
    meshio, folder = library(), Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    points = flat(result.particles)
    cells = [(kind, corners) for kind, corners, _ in cell_blocks(result.seal.body.cells)]
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


def point_data(result, step: int) -> dict[str, np.ndarray]:
    """Compute the fields at the particles after a nominal step, by name."""
    data = {
        "displacement": flat(result.displacement(step)),
        "von_mises": result.stress_field(step),
        "det_F": result.volume_ratio(step),
    }
    for contact in contacts(result.seal):
        response = result.path.at_nominal(contact.label)[step]
        # pressures at contact points, averaged to the particles for a point field
        values = true_pressure(result, contact, step), nominal_pressure(contact, response)
        for kind, own in zip(PRESSURES, values, strict=True):
            data[f"{kind}_{contact.label}"] = contact.where.mean_at_particles(
                own, len(result.particles)
            )
    return data


def _no_data(result) -> dict[str, np.ndarray]:
    """Return the fields before the first step: no displacement, F = 1, no pressure."""
    n = len(result.particles)
    data = {"displacement": np.zeros((n, 3)), "von_mises": np.zeros(n), "det_F": np.ones(n)}
    labels = [contact.label for contact in contacts(result.seal)]
    return data | {f"{kind}_{label}": np.zeros(n) for label in labels for kind in PRESSURES}
