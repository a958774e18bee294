"""Trapped air, fluid pressure, swelling, axial stretch and contact of two bodies by finite elements that
know nothing of seal_mdao.

Not run by the tests. It reads a seal file beside it and writes the JSON file of the same name::

    python -m venv fe && fe/bin/pip install jax==0.10.2 gmsh==4.15.2 scipy==1.17.1 pypardiso==0.4.7
    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python jax_sections.py air_ring

Elements: biquadratic quadrilaterals. The change of volume of rubber is projected onto linear functions
of each element (discontinuous pressure). All forces and tangents are derivatives by JAX of

- the strain energy, with the stretches F/theta of a material that has grown by theta,
- the penalty energy eps/2 int g^2 ds of the contact, with the gap g < 0 at the nodes (rigid line, no
  friction) or at four Gauss points of every side of the first body (second body, no friction),
- the volume of the trapped air, whose pressure is an additional unknown.

The force p int N n ds of a fluid acts on the deformed sides of its edges. A fluid that comes from one
end presses on all sides up to the middle of the edges, which must be in contact. Where the seal touches
a profile there, the contact force of the penalty is what exceeds the pressure p, and the profile takes
the force of the fluid, too. The fluid thus ends where the contact pressure is p.

Lengths in mm, stresses in kPa, forces in N/m, of a complete ring in N; energies in mJ/m and mJ.
"""

import json
import sys
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import gmsh
import jax
import jax.numpy as jnp
import numpy as np
from pypardiso import PyPardisoSolver
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

jax.config.update("jax_enable_x64", True)

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)
LINE_POINTS, LINE_WEIGHTS = np.polynomial.legendre.leggauss(4)
CORNERS = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (1, 2), (2, 1), (0, 2), (2, 2)]
"""One-dimensional functions of the nine nodes, of the ends -1 and 1 and the middle."""
SIDES = [(0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0)]
TOLERANCE = 1e-6
"""Largest residual over the largest force at a node."""
REACH = 0.5
"""Deepest penetration of a body that is a contact, mm: farther away is another side of the body."""
FREEZE = 6
"""Iterations after which points keep their opposite sides: some alternate between two of them."""


class Case(NamedTuple):
    """Element sizes (mm) and their factor along touched edges, load steps a stage, penalty (kPa/mm)."""

    sizes: tuple
    finer: float
    steps: int
    penalty: float
    pair: tuple = ()


CASES = {
    "air_ring": Case((0.8, 0.5, 0.35), 0.5, 16, 1e6),
    "swollen_ring": Case((0.8, 0.5, 0.35), 0.5, 20, 3e6),
    "stretched_bulb": Case((0.8, 0.5, 0.35), 0.5, 12, 1e6),
    "pressed_dome": Case((0.8, 0.5), 0.15, 14, 2e6),
    "pressed_face_seal": Case((0.8, 0.5), 0.08, 8, 2e6),
    "inflated_seal": Case((0.8, 0.5, 0.35), 0.35, 14, 1e6),
    "two_humps": Case((0.8, 0.6, 0.45), 0.5, 12, 2e5, ("lower", "upper")),
}


def line_functions(r):
    """Quadratic functions of the ends -1 and 1 and the middle, and their slopes, (3,) each."""
    return np.array([r * (r - 1) / 2, r * (r + 1) / 2, 1 - r * r]), np.array(
        [r - 0.5, r + 0.5, -2 * r]
    )


class Segment:
    """Line, arc or circle of a seal file: ``points`` in turn, about the ``centre`` if there is one."""

    def __init__(self, table):
        self.edge, self.body, self.centre = table["edge"], table.get("body", 1), None
        if "line" in table:
            self.points = np.array(table["line"], float)
            return
        if "circle" in table:
            self.centre = np.array(table["circle"]["centre"], float)
            angle, radius = np.linspace(0.0, 2.0 * np.pi, 4), table["circle"]["radius"]
        else:
            a, b, c = (np.array(table["arc"][key], float) for key in ("start", "through", "end"))
            # (p - a) . (centre - a) = |p - a|^2 / 2 for p = b, c
            sides = np.array([b - a, c - a])
            self.centre = a + np.linalg.solve(sides, 0.5 * (sides**2).sum(axis=1))
            one, two, three = (np.arctan2(*(p - self.centre)[::-1]) for p in (a, b, c))
            turn, through = (three - one) % (2.0 * np.pi), (two - one) % (2.0 * np.pi)
            turn -= 2.0 * np.pi * (through > turn)
            angle, radius = one + turn * np.linspace(0.0, 1.0, 4), np.hypot(*(a - self.centre))
        self.points = self.centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        if "arc" in table:
            self.points[0], self.points[-1] = a, c


def meshed(file, size, finer, touched):
    """Nodes (n, 2), elements (m, 9), sides (k, 3) of every edge and the material of every element."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo, section, curves, loops = gmsh.model.geo, file["section"], {}, {}

    def drawn(segments):
        known, tags = {}, []

        def tag(point):
            key = tuple(np.round(point, 8))
            if key not in known:
                known[key] = geo.addPoint(*point, 0.0)
            return known[key]

        for own in segments:
            ends = [tag(point) for point in own.points]
            for a, b in pairwise(ends):
                middle = () if own.centre is None else (geo.addPoint(*own.centre, 0.0),)
                tags.append(geo.addCircleArc(a, *middle, b) if middle else geo.addLine(a, b))
                curves.setdefault(own.edge, []).append(tags[-1])
        return geo.addCurveLoop(tags)

    for key in ("outer", "hole"):
        for own in map(Segment, section.get(key, [])):
            loops.setdefault(own.body, {}).setdefault(key, []).append(own)
    for own in loops.values():
        geo.addPlaneSurface([drawn(segments) for segments in own.values()])
    geo.synchronize()
    field = gmsh.model.mesh.field
    field.add("Distance", 1)
    field.setNumbers(1, "CurvesList", [tag for edge in touched for tag in curves[edge]])
    field.setNumber(1, "Sampling", 300)
    field.add("MathEval", 2)
    # quadrilaterals are made by halving those of twice the size
    field.setString(2, "F", f"2 * ({finer * size} + 0.3 * F1)")
    for option, value in (
        ("RecombineAll", 1), ("RecombinationAlgorithm", 2), ("SubdivisionAlgorithm", 1),
        ("Algorithm", 8), ("MeshSizeFromPoints", 0), ("MeshSizeFromCurvature", 0),
        ("MeshSizeExtendFromBoundary", 0), ("MeshSizeMax", 2.0 * size),
    ):  # fmt: skip
        gmsh.option.setNumber(f"Mesh.{option}", value)
    field.setAsBackgroundMesh(2)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    tags, place, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=int)
    number[tags.astype(int)] = np.arange(len(tags))
    cells = number[gmsh.model.mesh.getElements(2)[2][0].astype(int)].reshape(-1, 9)
    on = {
        edge: {tuple(sorted(pair)) for tag in own for pair in
               number[gmsh.model.mesh.getElements(1, tag)[2][0].astype(int)].reshape(-1, 3)[:, :2]}
        for edge, own in curves.items()
    }  # fmt: skip
    gmsh.finalize()
    used, cells = np.unique(cells, return_inverse=True)
    cells, points = cells.reshape(-1, 9), place.reshape(-1, 3)[used, :2]
    sides = np.concatenate([cells[:, own] for own in SIDES])
    ends = [tuple(sorted(pair)) for pair in used[sides[:, ::2]]]
    edges = {
        edge: sides[[pair in known for pair in ends]][:, [0, 2, 1]] for edge, known in on.items()
    }
    return points, cells, edges, materials(file, points, cells)


def materials(file, points, cells):
    """Names of the materials of the elements: of the section, or of the complete body of a region."""
    names = np.full(
        len(cells), file["section"].get("material", next(iter(file["material"]))), object
    )
    pairs = np.repeat(cells[:, 0], 8), cells[:, 1:].ravel()
    graph = csr_matrix((np.ones(len(pairs[0])), pairs), (len(points), len(points)))
    body = connected_components(graph, directed=False)[1][cells[:, 0]]
    for region in file["section"].get("region", []):
        near = np.hypot(*(points[cells[:, 8]] - region["at"]).T).argmin()
        names[body == body[near]] = region["material"]
    return names


def deviatoric(material):
    """Energy W(F, h) without the volumetric one, and whether the law is nearly incompressible."""
    law = material["law"]

    def energy(gradient, h):
        total = (gradient**2).sum(axis=(1, 2))
        flat = jnp.linalg.det(gradient)
        first, second, volume = total + h * h, flat**2 + total * h * h, flat * h
        if law == "hyperfoam":
            (mu,), (alpha,), (nu,) = material["mu"], material["alpha"], material["nu"]
            assert alpha == 2.0
            beta = nu / (1.0 - 2.0 * nu)
            return mu / 2.0 * (first - 3.0 + (volume ** (-2.0 * beta) - 1.0) / beta)
        own = material["c10"] * (first * volume ** (-2 / 3) - 3.0)
        return own + material.get("c01", 0.0) * (second * volume ** (-4 / 3) - 3.0)

    return energy, law != "hyperfoam"


class Elements:
    """Elements of one material: energy of displacements (9, 2) under h, theta; derivatives."""

    def __init__(self, material, points, cells, ring):
        pairs = [(a, b) for a in range(3) for b in range(3)]
        weight = np.array([WEIGHTS[a] * WEIGHTS[b] for a, b in pairs])
        along = [[line_functions(POINTS[i]) for i in pair] for pair in pairs]
        shape = np.array([[a[0][i] * b[0][j] for i, j in CORNERS] for a, b in along])
        slope = np.array(
            [[(a[1][i] * b[0][j], a[0][i] * b[1][j]) for i, j in CORNERS] for a, b in along]
        )
        jacobian = np.einsum("mai,qaj->mqij", points[cells], slope)
        gradient = np.einsum("qaj,mqji->mqai", slope, np.linalg.inv(jacobian))
        radius = np.einsum("qa,ma->mq", shape, points[cells][..., 0])
        volume = np.linalg.det(jacobian) * weight * (2.0 * np.pi * radius if ring else 1.0)
        modes = np.array([[1.0, POINTS[a], POINTS[b]] for a, b in pairs])
        inverse = np.linalg.inv(np.einsum("mq,qi,qj->mij", volume, modes, modes))
        isochoric, rubber = deviatoric(material)
        bulk = material.get("bulk_modulus", 0.0)

        def energy(u, gradient, radius, volume, inverse, h, theta, factor):
            deformation = jnp.eye(2) + jnp.einsum("ai,qaj->qij", u, gradient)
            out = 1.0 + (shape @ u[:, 0]) / radius if ring else h * jnp.ones(len(weight))
            if not rubber:
                own = isochoric(deformation / theta, out / theta)
                return factor * theta**3 * (volume @ own)
            # theta^3 K/2 int (Pi J / theta^3 - 1)^2 dV with the projection Pi onto the modes
            change = modes.T @ (volume * (out * jnp.linalg.det(deformation) / theta**3 - 1.0))
            own = factor * (volume @ isochoric(deformation, out))
            return own + 0.5 * theta**3 * bulk * (change @ inverse @ change)

        self.dofs = numbers(cells)
        self.data = [jnp.array(own) for own in (gradient, radius, volume, inverse)]
        self.energy, self.force, self.tangent = (
            jax.jit(jax.vmap(own, (0, 0, 0, 0, 0, None, None, None)))
            for own in (energy, jax.grad(energy), jax.hessian(energy))
        )

    def call(self, what, u, state):
        return np.asarray(getattr(self, what)(u[self.dofs].reshape(-1, 9, 2), *self.data, *state))


def numbers(nodes):
    """Unknowns (m, 2 k) of the nodes (m, k)."""
    return (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), 2 * nodes.shape[1])


def side_weights(points, sides, ring):
    """Shape functions (g, 3) and weights (k, g) of the Gauss points of undeformed sides."""
    value, slope = (np.array(own) for own in zip(*map(line_functions, LINE_POINTS), strict=True))
    speed = np.linalg.norm(np.einsum("ga,kai->kgi", slope, points[sides]), axis=2) * LINE_WEIGHTS
    if ring:
        speed = speed * 2.0 * np.pi * np.einsum("ga,ka->kg", value, points[sides][..., 0])
    return value, speed


class Air:
    """Trapped air of a [[cavity]]: p = p_a (tau/tau_0 (V_0 / (h V))^gamma - 1)."""

    def __init__(self, table, sides, points, ring):
        value, slope = (
            np.array(own) for own in zip(*map(line_functions, LINE_POINTS), strict=True)
        )

        def volume(x):
            y, dy = value @ x, slope @ x
            # sides have the body on the left, so they run clockwise around the hole
            if ring:
                return -np.pi * (LINE_WEIGHTS @ (y[:, 0] ** 2 * dy[:, 1]))
            return -0.5 * (LINE_WEIGHTS @ (y[:, 0] * dy[:, 1] - y[:, 1] * dy[:, 0]))

        self.sides, self.dofs = sides, numbers(sides)
        self.volume, self.slope, self.second = (
            jax.jit(jax.vmap(own)) for own in (volume, jax.grad(volume), jax.hessian(volume))
        )
        self.outside, self.gamma = table.get("pressure", 101.325), table.get("gamma", 1.4)
        self.first = float(self.volume(points[sides]).sum())

    def pressure(self, x, h, heat):
        """Gauge pressure and its derivative with respect to the volume."""
        now = float(self.volume(x[self.sides]).sum())
        whole = self.outside * heat * (self.first / (h * now)) ** self.gamma
        return whole - self.outside, -self.gamma * whole / now


class Fluid:
    """Pressure of a [[fluid]], which grows in the last stage."""

    def __init__(self, table, edges, points, ring):
        self.pressure, start = table["pressure"], table.get("from")
        names = table["edge"] if isinstance(table["edge"], list) else [table["edge"]]
        sides = np.concatenate([edges[name] for name in names])
        if start:
            sides = chained(sides)[:: 1 if start == "start" else -1][: len(sides) // 2]
        self.sides, self.dofs = sides, numbers(sides)
        value, slope = (
            np.array(own) for own in zip(*map(line_functions, LINE_POINTS), strict=True)
        )

        def force(x):
            # int N n ds of the normal n to the right of a side, which has the body on its left
            y, dy = value @ x, slope @ x
            weight = LINE_WEIGHTS * (2.0 * jnp.pi * y[:, 0] if ring else 1.0)
            normal = jnp.stack([dy[:, 1], -dy[:, 0]], axis=1)
            return jnp.einsum("g,ga,gi->ai", weight, value, normal)

        self.force, self.tangent = (jax.jit(jax.vmap(own)) for own in (force, jax.jacfwd(force)))

    def contributions(self, x, t, n_stages):
        """Unknowns (k, 6), forces and tangents of the sides at the time t."""
        pressure, x = self.pressure * np.clip(t - n_stages + 1.0, 0.0, 1.0), x[self.sides]
        force, tangent = (pressure * np.asarray(own(x)) for own in (self.force, self.tangent))
        return self.dofs, force.reshape(-1, 6), tangent.reshape(-1, 6, 6)


def chained(sides):
    """Connected sides (k, 3) in their order along the boundary."""
    following = {side[0]: i for i, side in enumerate(sides)}
    (first,) = set(sides[:, 0]) - set(sides[:, 1])
    order = []
    while first in following:
        order.append(following[first])
        first = sides[order[-1], 1]
    return sides[order]


class Pair:
    """Contact of the sides of one body with those of another, without friction."""

    def __init__(self, points, sides, opposite, ring, penalty):
        value, speed = side_weights(points, sides, ring)
        self.nodes, self.weight = np.repeat(sides, len(value), axis=0), speed.ravel()
        self.value, self.opposite, self.kept = np.tile(value, (len(sides), 1)), opposite, None

        def gap(x, value, xi):
            point, other = value @ x[:3], x[3:]

            def at(xi):
                own = jnp.array([xi * (xi - 1) / 2, xi * (xi + 1) / 2, 1 - xi * xi])
                return own @ other, jnp.array([xi - 0.5, xi + 0.5, -2 * xi]) @ other

            for _ in range(2):  # (y(xi) - x) . y'(xi) = 0 by Newton's method
                y, dy = at(xi)
                ddy = jnp.array([1.0, 1.0, -2.0]) @ other
                xi = xi - (y - point) @ dy / (dy @ dy + (y - point) @ ddy)
            y, dy = at(xi)
            return (point - y) @ jnp.array([dy[1], -dy[0]]) / jnp.linalg.norm(dy)

        def energy(x, value, xi, weight):
            return 0.5 * penalty * weight * jnp.minimum(gap(x, value, xi), 0.0) ** 2

        self.gap, self.force, self.tangent = (
            jax.jit(jax.vmap(own)) for own in (gap, jax.grad(energy), jax.hessian(energy))
        )

    def nearest(self, x):
        """Opposite side of every point and the coordinate of the nearest point on it."""
        value, slope = (np.array(own) for own in zip(*map(line_functions, np.linspace(-1, 1, 9)),
                                                     strict=True))  # fmt: skip
        point, other = np.einsum("ka,kai->ki", self.value, x[self.nodes]), x[self.opposite]
        tree = cKDTree(np.einsum("ga,mai->mgi", value, other).reshape(-1, 2))
        side, k = np.divmod(tree.query(point)[1], 9)
        xi = np.linspace(-1, 1, 9)[k]
        for _ in range(30):
            value, slope = line_functions(xi)
            y, dy = (np.einsum("ak,kai->ki", own, other[side]) for own in (value, slope))
            xi = np.clip(xi - ((y - point) * dy).sum(axis=1) / (dy**2).sum(axis=1), -1.0, 1.0)
        return side, xi

    def contributions(self, x, frozen):
        """Unknowns (k, 12), forces and tangents of the points in contact."""
        if self.kept is None or not frozen:
            self.kept = self.nearest(x)
        side, xi = self.kept
        nodes = np.concatenate([self.nodes, self.opposite[side]], axis=1)
        own = x[nodes], self.value, xi
        gap = np.asarray(self.gap(*own))
        # points that are far away are not in contact whatever the sign of their gap
        weight = np.where(np.abs(gap) < REACH, self.weight, 0.0)
        hit = (gap < 0.0) & (weight > 0.0)
        force, tangent = (np.asarray(f(*own, weight))[hit] for f in (self.force, self.tangent))
        return numbers(nodes[hit]), force.reshape(-1, 12), tangent.reshape(-1, 12, 12)


class Line:
    """Rigid line of a [[profile]], without friction, against nodes."""

    def __init__(self, table, points, sides, ring):
        a, b = np.array(table["line"], float)
        along = (b - a) / np.hypot(*(b - a))
        self.point, self.normal = (
            a + table.get("start", [0.0, 0.0]),
            np.array([along[1], -along[0]]),
        )
        self.stages = [own.get("translate", [0.0, 0.0]) for own in table.get("stage", [])]
        value, speed = side_weights(points, sides, ring)
        weight = np.zeros(len(points))
        np.add.at(weight, sides, speed @ value)
        self.nodes = np.unique(sides)
        self.weight = weight[self.nodes]


def travelled(stages, t):
    """Displacement at the time t, which grows by 1 in every stage."""
    return sum(
        (np.clip(t - i, 0.0, 1.0) * np.array(s, float) for i, s in enumerate(stages)), np.zeros(2)
    )


class Model:
    """Section of a seal file in elements of a size."""

    def __init__(self, name, size, penalty):
        case = CASES[name]
        self.file = file = tomllib.loads(
            Path(__file__).with_name(f"{name}.toml").read_text("utf-8")
        )
        self.ring = ring = file.get("model", {}).get("kinematics") == "axisymmetric"
        touched = [
            *case.pair,
            *(edge for own in file.get("profile", []) for edge in own["contact"]),
        ]
        self.points, cells, edges, names = meshed(file, size, case.finer, touched)
        points, self.n, self.penalty = self.points, 2 * len(self.points), penalty
        self.parts = [
            (
                file["material"][own],
                Elements(file["material"][own], points, cells[names == own], ring),
            )
            for own in sorted(set(names))
        ]

        def joined(own):
            return np.concatenate([edges[edge] for edge in own])

        self.lines = {
            own["name"]: Line(own, points, joined(own["contact"]), ring)
            for own in file.get("profile", [])
        }
        holes = {own.get("hole", 1): own["edge"] for own in file["section"].get("hole", [])}
        self.air = [
            Air(own, edges[holes[own["hole"]]], points, ring) for own in file.get("cavity", [])
        ]
        self.fluids = [Fluid(own, edges, points, ring) for own in file.get("fluid", [])]
        self.pairs = []
        if case.pair:
            self.pairs = [Pair(points, *(edges[own] for own in case.pair), ring, penalty)]
        fixed = numbers(np.unique(joined(file["fixed"]["edges"]))[:, None])
        directions = file["fixed"].get("directions", ["x", "y"])
        self.fixed = fixed[:, ["xy".index(own) for own in directions]].ravel()
        self.moved, self.stages = np.zeros(0, dtype=int), []
        for own in file.get("moved", []):
            self.moved = numbers(np.unique(joined(own["edges"]))[:, None]).ravel()
            self.stages = [stage["translate"] for stage in own["stage"]]
        self.held = np.concatenate([self.fixed, self.moved])
        free = np.setdiff1d(np.arange(self.n), self.held)
        self.unknown = np.concatenate([free, self.n + np.arange(len(self.air))])
        self.solver = PyPardisoSolver(mtype=11)

    @property
    def n_stages(self):
        return max(len(self.stages), *(len(own.stages) for own in self.lines.values()), 0)

    def state(self, t):
        """Axial stretch, absolute temperature over the initial one, and h, theta, m of the materials."""
        own = self.file.get("model", {})
        start = own.get("reference_temperature", 23.0)

        def at(value, first):
            known = value if isinstance(value, list) else [value] * self.n_stages
            return np.interp(t, np.arange(len(known) + 1), [first, *known])

        h, heat = at(own.get("axial_stretch", 1.0), 1.0), at(own.get("temperature", start), start)
        found = []
        for material, _ in self.parts:
            theta = 1.0 + material.get("expansion", 0.0) * (heat - start)
            theta *= at(material.get("swelling", 1.0), 1.0) ** (1 / 3)
            table = np.array(material.get("modulus_over_temperature", [[start, 1.0]])).T
            found.append((h, theta, np.interp(heat, *table)))
        return h, (heat + 273.15) / (start + 273.15), found

    def system(self, z, t, frozen=False):
        """Residual, tangent and forces on the lines; z: displacements, then pressures of the air."""
        h, heat, states = self.state(t)
        u, pressure = z[: self.n], z[self.n :]
        x, rest, entries, forces = self.points + u.reshape(-1, 2), np.zeros(len(z)), [], {}

        def add(dofs, force, tangent):
            np.add.at(rest, dofs, force.reshape(dofs.shape))
            k = dofs.shape[1]
            entries.append(
                (
                    np.repeat(dofs, k, axis=1),
                    np.tile(dofs, (1, k)),
                    tangent.reshape(len(dofs), k * k),
                )
            )

        for (_, part), state in zip(self.parts, states, strict=True):
            k = part.dofs.shape[1]
            tangent = part.call("tangent", u, state).reshape(-1, k, k)
            add(part.dofs, part.call("force", u, state), tangent)
        fluid_force = np.zeros(self.n)
        for fluid in self.fluids:
            own = fluid.contributions(x, t, self.n_stages)
            add(*own)
            np.add.at(fluid_force, *own[:2])
        for name, line in self.lines.items():
            where = line.point + travelled(line.stages, t)
            # loads act on the length h of the stretched strip
            weight = h * self.penalty * line.weight
            gap = np.minimum((x[line.nodes] - where) @ line.normal, 0.0)
            force = (weight * gap)[:, None] * line.normal
            tangent = (weight * (gap < 0.0))[:, None, None] * np.outer(line.normal, line.normal)
            add(numbers(line.nodes[:, None]), force, tangent)
            # nodes in contact transmit the force of the fluid
            closed = (gap < 0.0) * (fluid_force.reshape(-1, 2)[line.nodes] @ line.normal)
            force += closed[:, None] * line.normal
            forces[name] = force.sum(axis=0) / h
        for pair in self.pairs:
            add(*pair.contributions(x, frozen))
        for i, air in enumerate(self.air):
            row, p = self.n + i, pressure[i]
            slope = np.asarray(air.slope(x[air.sides])).reshape(len(air.sides), -1)
            add(air.dofs, -p * h * slope, -p * h * np.asarray(air.second(x[air.sides])))
            law, change = air.pressure(x, h, heat)
            rest[row] = p - law
            dofs, values = air.dofs.reshape(1, -1), slope.reshape(1, -1)
            same = np.full_like(dofs, row)
            entries += [(dofs, same, -h * values), (same, dofs, -change * values)]
            entries.append((np.array([[row]]), np.array([[row]]), np.array([[1.0]])))
        rows, columns, values = (
            np.concatenate([own.ravel() for own in e]) for e in zip(*entries, strict=True)
        )
        return rest, csr_matrix((values, (rows, columns)), (len(z), len(z))), forces

    def equilibrium(self, z, t):
        """Unknowns in equilibrium at the time t from a guess, or None."""
        goal = np.zeros(len(z))
        goal[self.moved] = np.tile(travelled(self.stages, t), len(self.moved) // 2)
        rest, tangent, _ = self.system(z, t)
        for i in range(20):
            apart = (goal - z)[self.held]
            size = np.linalg.norm(rest[self.unknown])
            load = -rest[self.unknown] - tangent[self.unknown][:, self.held] @ apart
            step = np.zeros(len(z))
            step[self.unknown] = self.solver.solve(tangent[self.unknown][:, self.unknown], load)
            step[self.held] = apart
            if not np.isfinite(step).all():
                return None
            # the first step carries the prescribed displacements; later ones are halved if forces grow
            for halved in range(5):
                new = z + step / 2.0**halved
                rest, tangent, _ = self.system(new, t, i >= FREEZE)
                if i == 0 or np.linalg.norm(rest[self.unknown]) < 1.5 * size:
                    break
            z = new
            z[self.held] = goal[self.held]
            largest = np.abs(rest[self.unknown]).max()
            if largest < TOLERANCE * max(np.abs(rest).max(), 1e-3):
                return z
        return None

    def results(self, z, t):
        """Forces on profiles or moved edges, pressures of the air, and energy (per stretched length)."""
        h, _, states = self.state(t)
        rest, _, forces = self.system(z, t)
        if len(self.moved):
            forces["moved"] = -rest[self.moved].reshape(-1, 2).sum(axis=0)
        energy = sum(
            part.call("energy", z[: self.n], own).sum()
            for (_, part), own in zip(self.parts, states, strict=True)
        )
        unit = 1e-3 if self.ring else 1.0
        found = {f"force_{name}": rounded(unit * own) for name, own in forces.items()}
        found["air_pressure"] = rounded(z[self.n :])
        return found | {"strain_energy": rounded([unit * energy / h])[0]}

    def follow(self, steps):
        """Results at the ends of the stages."""
        z, before, t, found = np.zeros(self.n + len(self.air)), None, 0.0, []
        todo = [i + k / steps for i in range(self.n_stages) for k in range(1, steps + 1)]
        while todo:
            guess = z if before is None else z + (z - before[0]) * (todo[0] - t) / (t - before[1])
            new = self.equilibrium(guess, todo[0])
            if new is None and before is not None:
                before = None
                continue
            if new is None:
                todo.insert(0, 0.5 * (t + todo[0]))
                if todo[0] - t < 1e-4:
                    raise RuntimeError(f"no equilibrium beyond {t}")
                continue
            end = abs(todo[0] - round(todo[0])) < 1e-9
            before, z, t = (None if end else (z, t)), new, todo.pop(0)
            if end:
                found.append(self.results(z, t))
                print(f"  stage {t:.0f}: {found[-1]}", flush=True)
        return found


def rounded(values):
    """Values with six digits, those below 1e-6 as zero."""
    return [float(f"{value:.6g}") if abs(value) > 1e-6 else 0.0 for value in values]


def flat(stage):
    """Numbers of a stage in a fixed order."""
    return np.concatenate([np.atleast_1d(own) for own in stage.values()])


def main(name):
    case, meshes = CASES[name], {}
    for size in case.sizes:
        print(f"{name}, elements of {size} mm", flush=True)
        meshes[size] = Model(name, size, case.penalty).follow(case.steps)
    coarse = case.sizes[0]
    stiff = Model(name, coarse, 3.0 * case.penalty).follow(case.steps)

    def apart(one, two):
        """Largest change of a stage over the largest force, of the other numbers over themselves."""
        forces = np.array([key.startswith("force") for key in one for _ in np.atleast_1d(one[key])])
        change, whole = np.abs(flat(one) - flat(two)), np.abs(flat(two))
        whole[forces] = whole[forces].max()
        return round(float((change / np.maximum(whole, 1e-12)).max()), 5)

    best, before = (meshes[size] for size in case.sizes[:-3:-1])
    found = {
        "stages": best,
        "element_sizes_mm": case.sizes,
        "change_by_last_refinement": [apart(*own) for own in zip(before, best, strict=True)],
        "change_by_three_times_the_penalty": [
            apart(*own) for own in zip(meshes[coarse], stiff, strict=True)
        ],
        "method": "biquadratic displacement, linear discontinuous pressure; penalty contact",
        "code": "JAX 0.10.2, gmsh 4.15.2 (jax_sections.py)",
    }
    Path(__file__).with_name(f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
