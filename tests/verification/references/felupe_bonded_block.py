"""Forces of ``bonded_block.json``: ``python felupe_bonded_block.py 24`` for 48 x 24 elements."""

import sys

import felupe as fem
import numpy as np
import tensortrax.math as tm

C10, C01, K = 80.0, 20.0, 2000.0


def energy(c):
    """Mooney-Rivlin of isochoric invariants, K/2 (J - 1)^2."""
    square = tm.linalg.det(c)
    first = tm.trace(c)
    second = (first**2 - tm.trace(c @ c)) / 2
    isochoric = C10 * (first * square ** (-1 / 3) - 3) + C01 * (second * square ** (-2 / 3) - 3)
    return isochoric + K / 2 * (tm.sqrt(square) - 1) ** 2


def graded(u):
    """Places from -1 to 1, closer together at both ends."""
    return np.sign(u) * (1 - (1 - abs(u)) ** 1.8)


def grid(n):
    """Biquadratic quadrilaterals with straight sides."""
    mesh = fem.Rectangle(a=(-4, 0), b=(4, 4), n=(2 * n + 1, n + 1))
    mesh = fem.mesh.convert(mesh, order=2, calc_points=True, calc_midfaces=True)
    points, cells = mesh.points, mesh.cells
    points[:] = np.column_stack(
        [4 * graded(points[:, 0] / 4), 2 + 2 * graded(points[:, 1] / 2 - 1)]
    )
    for first, last, middle in ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)):
        points[cells[:, middle]] = (points[cells[:, first]] + points[cells[:, last]]) / 2
    points[cells[:, 8]] = points[cells[:, :4]].mean(axis=1)
    return mesh


mesh = grid(int(sys.argv[1]))
field = fem.FieldContainer([fem.FieldPlaneStrain(fem.RegionBiQuadraticQuad(mesh), dim=2)])
body, top = fem.SolidBody(fem.Hyperelastic(energy), field), np.isclose(mesh.points[:, 1], 4)
for begin, end in (((0, 0), (0, -0.2)), ((0, -0.2), (0.6, -0.2))):
    for t in np.linspace(0, 1, 11)[1:]:
        x, y = np.array(begin) + t * np.subtract(end, begin)
        bounds = {
            "base": fem.Boundary(field[0], fy=0),
            "x": fem.Boundary(field[0], fy=4, skip=(0, 1), value=x),
            "y": fem.Boundary(field[0], fy=4, skip=(1, 0), value=y),
        }
        free = fem.dof.partition(field, bounds)
        given = fem.dof.apply(field, bounds, free[0])
        fem.newtonraphson([body], dof0=free[0], dof1=free[1], ext0=given, verbose=0)
    print(end, body.assemble.vector(field).toarray().reshape(-1, 2)[top].sum(axis=0))
