"""Relaxation of pressed sections by finite elements of FElupe, which know nothing of seal_mdao.

Not run by the tests. It writes the JSON files beside it, with the packages that ``felupe_contact``
names::

    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_relaxation.py relaxing_disc

Elements and contact are those of ``felupe_contact`` and ``felupe_rings``; the rubber is that of
``felupe_viscoelastic``, with Mooney-Rivlin's law of the long term. The disc is pressed within 1 s,
stays pressed for 1e4 s, is released within 1 s and recovers for 1e4 s; its plate has no friction. The
O-ring is squeezed within 10 s and stays squeezed for 1e4 s, without and with friction. Lengths in mm,
times in s, stresses in kPa, forces of the disc in N/m and of the complete ring in N.

Peak pressure is nominal, at the nodes between elements as in ``felupe_pressure``.
"""

import sys
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from time import perf_counter

import felupe as fem
import felupe_contact as plane
import felupe_rings as rings
import numpy as np
from felupe_contact import CODE, save
from felupe_pressure import Edge, rounded
from felupe_sections import fine_disc, mesh_of
from felupe_viscoelastic import Viscoelastic, dwell
from pypardiso import spsolve

METHOD = (
    "finite linear viscoelasticity with internal variables at the quadrature points, midpoint rule of "
    "the convolution; biquadratic displacement, linear discontinuous pressure and volume ratio; nodes "
    "against a rigid plane with a stiff penalty; one half by symmetry"
)


@dataclass(frozen=True)
class Program:
    """Travel of the plate over the time.

    Attributes
    ----------
    corners : list of (float, float)
        Times, s, and travels, mm, between which the plate moves evenly.
    asked : list of float
        Times at which force and pressure are stored, s.
    per_move : int
        Increments of a move; those of a dwell grow by one over a quarter of it.
    """

    corners: list
    asked: list
    per_move: int = 32

    def times(self):
        """Increments that meet the corners and the asked times."""
        found = []
        for (start, at), (end, to) in pairwise(self.corners):
            if at != to:
                even = np.linspace(start, end, self.per_move + 1)[1:]
                # finer at the first touch
                found += [start + (even[3] - start) * np.linspace(0.0, 1.0, 9)[1:] ** 2, even[4:]]
                found += [own for own in self.asked if start < own < end]
                continue
            first = (self.corners[1][0] - self.corners[0][0]) / self.per_move
            parts = [start, *(own for own in self.asked if start < own < end), end]
            for a, b in pairwise(parts):
                found.append(dwell(a, b, max(first, (a - start) * 4.0 / self.per_move),
                                   1.0 + 4.0 / self.per_move))  # fmt: skip
        return np.unique(np.concatenate([np.atleast_1d(own) for own in found]).round(9))

    def travel(self, times):
        return np.interp(times, *zip(*self.corners, strict=True))


@dataclass(frozen=True)
class Relaxation:
    """A section, its rubber and its program.

    Attributes
    ----------
    case : felupe_contact.Case
    model : module
        ``felupe_contact`` for plane strain, ``felupe_rings`` for bodies of revolution.
    g, tau : list of float
        Prony terms with constants of the long term.
    program : Program
    sizes : dict
        Element sizes where the section touches, mm, from coarse to fine, by the friction.
    """

    case: object
    model: object
    g: list
    tau: list
    program: Program
    sizes: dict


DISC = replace(plane.CASES["half_disc"], draw=fine_disc(5.0), friction=0.0)
RELEASED = 10001.0
CASES = {
    "relaxing_disc": Relaxation(
        DISC, plane, [0.2, 0.2, 0.1], [0.5, 50.0, 5000.0],
        Program(
            [(0.0, 0.0), (1.0, 1.0), (RELEASED, 1.0), (RELEASED + 1.0, 0.0), (2.0 * RELEASED, 0.0)],
            [0.5, 1.0, 1.5, 2.0, 11.0, 101.0, 1001.0, RELEASED, RELEASED + 0.1, RELEASED + 0.2,
             RELEASED + 0.3, RELEASED + 2.0, RELEASED + 11.0, RELEASED + 101.0, RELEASED + 1001.0,
             2.0 * RELEASED],
        ),
        {0.0: [0.28, 0.2, 0.14]},
    ),
    "relaxing_ring": Relaxation(
        rings.SQUEEZED["ring_squeezed"], rings, [0.3, 0.2], [10.0, 1000.0],
        Program(
            [(0.0, 0.0), (10.0, 0.7), (10010.0, 0.7)],
            [5.0, 10.0, 11.0, 20.0, 110.0, 1010.0, 10010.0],
        ),
        {0.0: [0.16, 0.11, 0.08], 0.2: [0.16, 0.11, 0.08, 0.055]},
    ),
}  # fmt: skip


class DiscEdge:
    """Force and nominal pressure of the disc."""

    def __init__(self, case, mesh):
        self.edge = Edge(mesh, np.flatnonzero(case.touched(*mesh.points.T)))
        self.nodes, self.height = self.edge.nodes, mesh.points[self.edge.nodes[0], 1]

    def state(self, fields, plate):
        force = np.abs(plate.results.force.toarray()[2 * self.nodes + 1, 0])
        apex = self.height + fields[0].values[self.nodes[0], 1]
        return 2.0 * force.sum(), self.edge.pressure(force).max(), apex


class RingEdge:
    """Force and nominal pressure of the ring."""

    def __init__(self, case, mesh):
        self.nodes, _, self.weight = rings.edge_of(mesh, case.touched(*mesh.points.T))
        self.top = np.argmax(mesh.points[self.nodes, 1])
        self.height = mesh.points[self.nodes[self.top], 1]

    def state(self, fields, plate):
        force = np.abs(plate.results.force.toarray()[2 * self.nodes + rings.AXIAL, 0])
        # H_i is 1/2 at the middles of the elements
        by_hats = force[::2].copy()
        by_hats[:-1] += 0.5 * force[1::2]
        by_hats[1:] += 0.5 * force[1::2]
        apex = self.height + fields[0].values[self.nodes[self.top], rings.AXIAL]
        return rings.MILLI * force.sum(), (by_hats / self.weight).max(), apex


def relax(own, size, friction):
    """Force, nominal peak pressure and height of the crown at the asked times, (3, n)."""
    began, case = perf_counter(), replace(own.case, friction=friction)
    flat = own.model is plane
    mesh = mesh_of(case.draw, size) if flat else case.draw(size)
    edge = (DiscEdge if flat else RingEdge)(case, mesh)
    law = Viscoelastic(plane.mooney_rivlin(case.rubber), own.g, own.tau)
    fields, solid, plate, bounds = own.model.model_of(case, mesh, law)
    times, found = own.program.times(), {}
    path = -case.travel_factor * own.program.travel(times)
    step = fem.Step([solid, plate], ramp={bounds["move"]: path, law: times}, boundaries=bounds)

    def keep(context, state):
        if np.abs(np.array(own.program.asked) - law.time).min() < 1e-8:
            found[round(law.time, 6)] = edge.state(fields, plate)

    fem.Job([step], plugins=[fem.CutbackPlugin(max_cutbacks=6), keep]).evaluate(
        x0=fields, verbose=0, solver=spsolve, tol=1e-7, maxiter=14
    )
    result = np.array([found[round(t, 6)] for t in own.program.asked]).T
    print(f"  size {size}, friction {friction}: {mesh.ncells} elements, {len(times)} increments,",
          f"{perf_counter() - began:.0f} s", rounded(result[0]), flush=True)  # fmt: skip
    return result


def apart(one, other):
    """Largest changes of force and peak over their largest values, and of the height, mm."""
    change = np.abs(one - other).max(axis=1)
    return change / np.array([one[0].max(), one[1].max(), 1.0])


def studied(own, friction):
    """Finest result, its changes with mesh, increments and penalty, and those of all meshes."""
    sizes = own.sizes[friction]
    runs = {size: relax(own, size, friction) for size in sizes}
    coarse, before, finest = (runs[sizes[i]] for i in (0, -2, -1))
    twice = replace(own, program=replace(own.program, per_move=2 * own.program.per_move))
    stiff = replace(own, case=replace(own.case, normal_penalty=5.0 * own.case.normal_penalty))
    changes = {
        "mesh": apart(finest, before),
        "increments": apart(coarse, relax(twice, sizes[0], friction)),
        "penalty": apart(coarse, relax(stiff, sizes[0], friction)),
    }
    return finest, changes, {f"elements of {size} mm": run[:2] for size, run in runs.items()}


def main(name):
    own = CASES[name]
    unit = "N_per_m" if own.model is plane else "N"
    found = {
        "section": own.case.section,
        "rubber": {"law": "mooney_rivlin", **own.case.rubber},
        "g": own.g,
        "tau_s": own.tau,
        "program_time_s": [t for t, _ in own.program.corners],
        "program_travel_mm": [x for _, x in own.program.corners],
        "time_s": own.program.asked,
        "friction": list(own.sizes),
        "method": METHOD,
        "code": CODE,
    }
    for friction in own.sizes:
        result, changes, meshes = studied(own, friction)
        found[f"with_friction_{friction}"] = rounded({
            f"force_{unit}": result[0],
            "peak_kPa": result[1],
            "height_mm": result[2],
            "change_of_force_peak_and_height": changes,
            "meshes_force_and_peak": meshes,
        })  # fmt: skip
    Path(__file__).with_name(f"{name}.json").unlink(missing_ok=True)
    save(name, found)


if __name__ == "__main__":
    main(sys.argv[1])
