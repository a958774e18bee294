"""Rubber sealing by NGSolve: triangles with cubic displacements and discontinuous linear pressure.

A second, compiled finite element code beside the ladder: ``pip install ngsolve``. Lengths in mm,
stresses in kPa.
"""

from time import process_time

import ngsolve as ng
import numpy as np
from netgen.geom2d import SplineGeometry

MU, ALPHA, BULK = (630.0, 1.2, -10.0), (1.3, 5.0, -2.0), 1e6
CORNERS = (
    ((0.0, 0.0), "base"), ((8.735, 0.0), "side"), ((4.235, 9.0), "top"), ((0.0, 9.0), "middle"),
    ((0.0, 7.0), "cavity"), ((3.0, 7.0), "cavity"), ((5.5, 2.0), "cavity"), ((0.0, 2.0), "middle"),
)  # fmt: skip
"""Corners of the right half, and the edges that begin there."""
EQUAL = 1e-6
"""Added to (lambda_1^2 - lambda_2^2)^2, whose root has no derivative where the stretches are equal."""
TOLERANCE = 1e-9
"""Of the work of the residual in a correction, over force times travel."""


def energy(u, p):
    """Ogden energy with a pressure: sum mu/alpha (lb_1^alpha + lb_2^alpha + lb_3^alpha - 3) + p (J - 1)
    - p^2 / 2K, where the stretches lb_i = J^(-1/3) lambda_i and lambda_3 = 1."""
    deformation = ng.Id(2) + ng.Grad(u)
    volume = ng.Det(deformation)
    # lambda_1,2^2 = (tr C +- sqrt(tr^2 C - 4 J^2)) / 2
    trace = ng.Trace(deformation.trans * deformation)
    root = ng.sqrt(trace * trace - 4.0 * volume * volume + EQUAL)
    squares = 0.5 * (trace + root), 0.5 * (trace - root), 1.0
    total = p * (volume - 1.0) - p * p / (2.0 * BULK)
    for m, a in zip(MU, ALPHA, strict=True):
        powers = sum(square ** (0.5 * a) for square in squares[:2]) + 1.0
        total += m / a * (volume ** (-a / 3.0) * powers - 3.0)
    return total


def rubber_sealing(size: float, path: np.ndarray) -> tuple[int, list, float]:
    """Number of triangles, force on the top at every travel (N/m), and processor time (s)."""
    start = process_time()
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*xy) for xy, _ in CORNERS]
    for k, (_, name) in enumerate(CORNERS):
        geometry.Append(["line", points[k], points[(k + 1) % len(points)]], bc=name)
    mesh = ng.Mesh(geometry.GenerateMesh(maxh=size))
    moved = ng.VectorH1(mesh, order=3, dirichletx="base|top|middle", dirichlety="base|top")
    space = moved * ng.L2(mesh, order=1)
    u, p = space.TrialFunction()
    form = ng.BilinearForm(space, symmetric=True, condense=True)
    form += ng.Variation(energy(u, p).Compile() * ng.dx)
    state, unit = ng.GridFunction(space), ng.GridFunction(space)
    unit.components[0].Set((0.0, 1.0), definedon=mesh.Boundaries("top"))
    residual, change = state.vec.CreateVector(), state.vec.CreateVector()
    free, forces = space.FreeDofs(coupling=True), []
    before = 0.0
    for travel in path:
        state.vec.data -= (travel - before) * unit.vec
        before = travel
        for _ in range(20):
            form.Apply(state.vec, residual)
            force = abs(ng.InnerProduct(residual, unit.vec))
            form.AssembleLinearization(state.vec)
            inverse = form.mat.Inverse(free, inverse="sparsecholesky")
            # elimination of the pressures in every triangle
            residual.data += form.harmonic_extension_trans * residual
            change.data = inverse * residual
            change.data += form.harmonic_extension * change
            change.data += form.inner_solve * residual
            state.vec.data -= change
            if abs(ng.InnerProduct(change, residual)) < TOLERANCE * force * travel:
                break
        else:
            raise RuntimeError(f"no equilibrium at {travel:.3f} mm")
        form.Apply(state.vec, residual)
        forces.append(float(abs(ng.InnerProduct(residual, unit.vec))))
    return mesh.ne, forces, process_time() - start
