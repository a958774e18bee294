"""Finite elements of FElupe beside the rungs: biquadratic, with discontinuous linear pressure.

Needs the packages that ``tests/verification/references/felupe_contact.py`` names. Elements, rubber and
contact are those of the scripts there; the load steps are those of the seal file.
"""

import sys
from dataclasses import replace
from time import process_time

import numpy as np

from .rungs import REFERENCES, RUNGS, load_path

if str(REFERENCES) not in sys.path:
    sys.path.insert(0, str(REFERENCES))

import felupe as fem
import felupe.constitution.tensortrax as mat
import felupe_contact
import felupe_rings
from felupe_contact import CASES, Case, on_arc, three_fields
from felupe_sections import Grid, mesh_of, quarter
from pypardiso import spsolve

MU, ALPHA, BULK = np.array([630.0, 1.2, -10.0]), np.array([1.3, 5.0, -2.0]), 1e6
"""Ogden's constants of the rubber sealing and of the AS568 O-ring, kPa."""
STIFFER = 2744.0 / 630.0
"""Moduli of the O-ring over those of the sealing, as in the seal files."""


def ogden(factor=1.0):
    """Isochoric Ogden law; FElupe's energy is sum 2 mu / alpha^2 (...), the package's mu / alpha."""
    own = mat.models.hyperelastic.ogden
    return mat.Hyperelastic(own, mu=list(factor * 0.5 * MU * ALPHA), alpha=list(ALPHA))


def sealing_section(size):
    """Right half of the rubber sealing: five blocks."""
    grid = Grid()
    points = {
        "a": (0, 0), "b": (6.5, 0), "c": (5.5, 2), "d": (0, 2), "e": (8.735, 0), "f": (7.735, 2),
        "g": (3, 7), "h": (5.235, 7), "i": (2, 9), "j": (4.235, 9), "k": (0, 7), "l": (0, 9),
    }  # fmt: skip
    tags, lines = {name: grid.point(*xy) for name, xy in points.items()}, {}

    def line(start, end, length):
        if (end, start) in lines:
            return -lines[end, start]
        if (start, end) not in lines:
            count = max(2, round(length / size))
            lines[start, end] = grid.line(tags[start], tags[end], count)
        return lines[start, end]

    for (p, q, r, s), along, up in (
        ("abcd", 6.0, 2.0), ("befc", 2.0, 2.0), ("cfhg", 2.0, 5.6), ("kgil", 2.6, 2.0),
        ("ghji", 2.0, 2.0),
    ):  # fmt: skip
        grid.block(line(p, q, along), line(q, r, up), line(r, s, along), line(s, p, up))


def rubber_sealing(size, path, keep):
    """Force at every travel of the top, which is bonded to a plate."""
    mesh = mesh_of(sealing_section, size)
    fields = three_fields(mesh, fem.FieldPlaneStrain)
    solid = fem.SolidBody(fem.NearlyIncompressible(ogden(), bulk=BULK), fields)
    (x, y), u = mesh.points.T, fields[0]
    top = np.isclose(y, 9.0)
    bounds = {
        "base": fem.Boundary(u, fy=0.0),
        "middle": fem.Boundary(u, mask=np.isclose(x, 0.0), skip=(False, True)),
        "bond": fem.Boundary(u, mask=top, skip=(False, True)),
        "move": fem.Boundary(u, mask=top, skip=(True, False)),
    }

    def after(context, state):
        own = solid.results.force.toarray()[: u.values.size].reshape(-1, 2)
        keep(-u.values[top, 1].mean(), abs(own[top, 1].sum()))

    step = fem.Step([solid], ramp={bounds["move"]: -path}, boundaries=bounds)
    followed([step], fields, after)
    return mesh.ncells


def followed(steps, fields, after):
    """Follow load steps, halved where Newton's method fails; the path ends where that does not help."""
    job = fem.Job(steps, plugins=[fem.CutbackPlugin(max_cutbacks=6), after])
    try:
        job.evaluate(x0=fields, verbose=0, solver=spsolve, tol=1e-7, maxiter=14)
    except fem.NewtonConvergenceError:
        print("  no equilibrium found beyond this travel", flush=True)


def quarter_ring(outer, inner):
    """Quarter of a ring in x, y > 0."""

    def draw(size):
        grid = Grid()
        layers, around, (o, a, b, c, d) = quarter(grid, outer, inner, size)
        grid.block(
            grid.line(a, b, layers), grid.arc(b, o, c, around), grid.line(c, d, layers),
            grid.arc(d, o, a, around),
        )  # fmt: skip

    return draw


def pressed(case):
    """Half or quarter of a section under a plate, as in ``felupe_contact``."""

    def run(size, path, keep):
        mesh = mesh_of(case.draw, size)
        fields, solid, plate, bounds = felupe_contact.model_of(case, mesh)
        factor = case.travel_factor

        def after(context, state):
            total = 2.0 * plate.results.force.toarray()[2 * mesh.npoints - 1, 0]
            keep(-fields[0].values[-1, 1] / factor, abs(float(total)))

        step = fem.Step([solid, plate], ramp={bounds["move"]: -factor * path}, boundaries=bounds)
        followed([step], fields, after)
        return mesh.ncells

    return run


def ring(case, law=None):
    """Upper half of a ring, under a plate or bonded to it, as in ``felupe_rings``; force in N."""

    def run(size, path, keep):
        mesh = case.draw(size)
        fields, solid, plate, bounds = felupe_rings.model_of(case, mesh, law)
        u, axial = fields[0], felupe_rings.AXIAL
        high = np.append(np.isclose(mesh.points[:, 1], mesh.points[:, 1].max()), False)
        items, moved = ([solid], "press") if plate is None else ([solid, plate], "move")
        if plate is None:
            bounds["bond"] = fem.Boundary(u, mask=high, skip=(True, False))
            bounds["press"] = fem.Boundary(u, mask=high, skip=(False, True))

        def force():
            if plate is None:
                return solid.results.force.toarray()[: u.values.size].reshape(-1, 2)[high, axial]
            nodes = np.arange(len(mesh.points))
            return plate.results.force.toarray()[2 * nodes + axial, 0]

        node = bounds[moved].points[0]
        factor = case.travel_factor

        def after(context, state):
            total = felupe_rings.MILLI * abs(float(force().sum()))
            keep(-u.values[node, axial] / factor, total)

        step = fem.Step(items, ramp={bounds[moved]: -factor * path}, boundaries=bounds)
        followed([step], fields, after)
        return mesh.ncells

    return run


URETHANE = Case(
    section="", draw=quarter_ring(6.35, 4.15), friction=0.4, travel=[2.0, 4.0], top=6.35,
    rubber={"c10": 800.0, "c01": 200.0, "bulk_modulus": 8e5}, prescribed="y", sizes=[],
    touched=lambda x, y: on_arc(x, y, 6.35) & (y > 1.0), travel_factor=0.5,
)  # fmt: skip
AS568 = replace(
    felupe_rings.SQUEEZED["ring_squeezed"],
    draw=felupe_rings.half_disc(1.765, 14.26),
    rubber={"bulk_modulus": BULK},
    top=1.765,
    touched=lambda x, y: on_arc(x - 14.26, y, 1.765) & (y > 0.6),
)
SYMMETRIC = {"urethane_ring": 2.0, "as568_214": 2.0, "bonded_disc": 2.0}
"""Travel of the complete body over that of a seal file which has half of it."""
SOLVERS = {
    "rubber_sealing": rubber_sealing,
    "urethane_ring": pressed(URETHANE),
    "half_ring": pressed(CASES["half_ring"]),
    "o_ring": pressed(CASES["o_ring"]),
    "as568_214": ring(AS568, ogden(STIFFER)),
    "bonded_disc": ring(felupe_rings.BONDED["ring_disc_5"][1]),
}
"""``solver(size, path, keep)``: follow the travels ``path`` and report them with their forces."""


def solve(name: str, size: float, seal, ends) -> tuple[int, list, float]:
    """Solve a rung with elements of a size, with the load steps of a seal.

    Parameters
    ----------
    ends : sequence of int
        Load steps at which the stages end.

    Returns
    -------
    cells : int
    forces : list of float
        At the ends of the stages, NaN where the path ended before.
    seconds : float
        Processor time with the mesh.
    """
    path = SYMMETRIC.get(name, 1.0) * load_path(seal)
    found = {}
    start = process_time()
    cells = SOLVERS[name](size, path, lambda travel, own: found.update({round(travel, 9): own}))
    seconds = process_time() - start
    return cells, [found.get(round(float(path[k]), 9), np.nan) for k in ends], seconds


if set(SOLVERS) - set(RUNGS):
    raise ValueError(f"no rung has the name of {sorted(set(SOLVERS) - set(RUNGS))}")
