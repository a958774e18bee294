"""Force on a foam bulb on rubber, beside a notch of 24 degrees or not, by finite elements of FElupe and
gmsh.

Not run by the tests. It writes ``notched_bulb.json`` and ``bulb_on_block.json`` beside it::

    python -m venv fe && fe/bin/pip install felupe==11.3.0 gmsh==4.15.2 scipy==1.17.1
    OMP_NUM_THREADS=1 fe/bin/python felupe_foam_bulbs.py

Elements: triangles with quadratic displacement, plane strain, smaller at the corner between bulb and
rubber and below the door. Foam and rubber: W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2; the outside
of a clip is fixed, so that its rubber hardly moves, of a block the base. Contact: Simpson's rule of a
linear penalty along the arc, without friction. The right half stands for the whole section. Lengths in
mm, stresses in kPa, forces in N/m.
"""

import json
from pathlib import Path

import felupe as fem
import gmsh
import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import spsolve

FOAM = {"mu": 130.0154, "lmbda": 0.0}
CLIP = {"mu": 2350.95, "lmbda": 998432.7}
FOOT, TOP, PENALTY, TRAVEL, STEPS = 2.39791576, 14.0, 1e3, 1.0, 8
CLIP_CORNERS = [(0, 0), (1.5, 0), (1.5, -3), (4, -3), (4, 2.5), (FOOT, 2.5), (0, 2.5)]
BLOCK_CORNERS = [(0, 0), (FOOT, 0), (FOOT, 2.5), (0, 2.5)]
CLIP_MESHES = {0.5: 0.05, 0.3: 0.03, 0.2: 0.01, 0.15: 0.004}
BLOCK_MESHES = {0.5: 0.05, 0.3: 0.03, 0.2: 0.015, 0.15: 0.01}
"""Element sizes, and those at the corner between bulb and rubber, mm."""


def mesh_of(outline, size, least):
    """Points (n, 2), triangles (m, 6) and the mask of those of the rubber below the bulb."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo, field = gmsh.model.geo, gmsh.model.mesh.field
    *_, foot, parting = corners = [geo.addPoint(*xy, 0) for xy in outline]
    around = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    below, top, above, centre, side, hole = (
        geo.addPoint(*xy, 0) for xy in ((0, 3.5), (0, TOP), (0, 12.5), (0, 8), (6, 8), (4.5, 8))
    )
    bulb = [geo.addCircleArc(foot, centre, side), geo.addCircleArc(side, centre, top)]
    bulb += [geo.addLine(top, above), geo.addCircleArc(above, centre, hole)]
    bulb += [geo.addCircleArc(hole, centre, below), geo.addLine(below, parting), -around[-2]]
    parts = [geo.addPlaneSurface([geo.addCurveLoop(curves)]) for curves in (around, bulb)]
    geo.synchronize()
    sizes = []
    for point, start, slope in ((foot, least, 0.2), (top, size / 4, 0.15)):
        away, grown = field.add("Distance"), field.add("MathEval")
        field.setNumbers(away, "PointsList", [point])
        field.setString(grown, "F", f"min({size}, {start} + {slope} * F{away})")
        sizes.append(grown)
    least_of = field.add("Min")
    field.setNumbers(least_of, "FieldsList", sizes)
    field.setAsBackgroundMesh(least_of)
    for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
        gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    tags, points, _ = gmsh.model.mesh.getNodes()
    cells = [np.reshape(gmsh.model.mesh.getElementsByType(9, part)[1], (-1, 6)) for part in parts]
    gmsh.finalize()
    # nodes of the elements alone, without the centre of the arcs
    used, flat = np.unique(np.vstack(cells), return_inverse=True)
    points = points.reshape(-1, 3)[np.argsort(tags)][np.searchsorted(np.sort(tags), used), :2]
    stiff = np.repeat([True, False], [len(cells[0]), len(cells[1])])
    return points, flat.reshape(-1, 6), stiff


def force(outline, size, least):
    """Force on the door after its travel, of the whole section, N/m."""
    points, cells, stiff = mesh_of(outline, size, least)
    region = fem.RegionQuadraticTriangle(fem.Mesh(points, cells, "triangle6"))
    fields = fem.FieldContainer([fem.FieldPlaneStrain(region, dim=2)])
    law = fem.NeoHookeCompressible(
        *(np.where(stiff, CLIP[name], FOAM[name])[None] for name in ("mu", "lmbda"))
    )
    law.chunksize = 10**9
    solid, u = fem.SolidBody(law, fields), fields[0].values
    x, y = points.T
    fixed = np.zeros(points.shape, bool)
    fixed[x < 1e-9, 0] = True
    if outline is CLIP_CORNERS:
        shoulder = (np.abs(y - 2.5) < 1e-9) & (x > FOOT - 1e-9)
        slot = (np.abs(y) < 1e-9) | ((np.abs(x - 1.5) < 1e-9) & (y < 0.0)) | (y < 1e-9 - 3.0)
        fixed[shoulder | slot | ((x > 4.0 - 1e-9) & (y < 2.5))] = True
    else:
        fixed[y < 1e-9] = True
    free = np.flatnonzero(~fixed.ravel())
    # Simpson's rule on the sides of the arc: corner, middle, corner
    arc = np.flatnonzero((np.abs(np.hypot(x, y - 8.0) - 6.0) < 1e-6) & (y > 8.0 - 1e-6))
    arc = arc[np.argsort(x[arc])]
    length = np.hypot(*np.diff(points[arc], axis=0).T)
    sides, weight = length[::2] + length[1::2], np.zeros(len(arc))
    weight[:-2:2] += sides / 6.0
    weight[2::2] += sides / 6.0
    weight[1::2] += 4.0 * sides / 6.0
    down = 2 * arc + 1
    for step in range(1, STEPS + 1):
        for _ in range(30):
            residual = solid.assemble.vector(fields).toarray().ravel()
            tangent = solid.assemble.matrix(fields).tocsr()
            gap = TOP - TRAVEL * step / STEPS - y[arc] - u[arc, 1]
            push, slope = PENALTY * weight * np.maximum(-gap, 0.0), np.zeros(len(residual))
            slope[down] = PENALTY * weight * (gap < 0.0)
            residual[down] += push
            if np.abs(residual[free]).max() < 1e-7 * max(push.sum(), 1.0) and push.any():
                break
            change = np.zeros(len(residual))
            matrix = (tangent + diags(slope)).tocsr()[free][:, free]
            change[free] = spsolve(matrix.tocsc(), -residual[free])
            u += change.reshape(-1, 2)
        else:
            raise RuntimeError("no equilibrium found")
    print(f"size {size}: {len(cells)} elements, {2.0 * push.sum():.4f} N/m", flush=True)
    return round(2.0 * float(push.sum()), 4)


def write(name, section, outline, meshes):
    found = {
        f"elements of {size} mm": force(outline, size, least) for size, least in meshes.items()
    }
    record = {
        "section": section,
        "foam": FOAM,
        "rubber": CLIP,
        "normal_penalty": PENALTY,
        "travel_mm": TRAVEL,
        "force_N_per_m": list(found.values())[-1],
        "method": "quadratic triangles, plane strain; linear penalty without friction by Simpson's "
        "rule; right half by symmetry",
        "code": "FElupe 11.3.0 (SolidBody of NeoHookeCompressible), gmsh 4.15.2",
        "meshes_N_per_m": found,
    }
    (Path(__file__).parent / f"{name}.json").write_text(json.dumps(record, indent=1) + "\n")


def main():
    bulb = "foam bulb of radius 6 mm and wall 1.5 mm, its foot cut off at y = 2.5 and bonded to "
    write(
        "notched_bulb",
        f"{bulb}a clip of rubber with shoulders, notches of 24 degrees between bulb and shoulders, "
        "pressed by a flat door",
        CLIP_CORNERS,
        CLIP_MESHES,
    )
    write(
        "bulb_on_block",
        f"{bulb}a block of rubber as wide as the foot, pressed by a flat door",
        BLOCK_CORNERS,
        BLOCK_MESHES,
    )


if __name__ == "__main__":
    main()
