"""Contact pressure of the sections of ``felupe_contact`` on meshes that are fine where they touch.

Not run by the tests. It adds the entry ``pressure`` to the JSON files beside it, with the packages that
``felupe_contact`` names::

    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_pressure.py o_ring

Nominal pressure, force over undeformed length, from the normal forces f_a of the contact nodes: at the
node i between two elements

    p_i = int H_i p ds / int H_i ds = sum_a H_i(X_a) f_a / int H_i ds,

with H_i linear from 1 at i to 0 at the next nodes between elements. It is exact in the nodal forces,
since H_i is a sum of the elements' quadratic functions N_a, and f_a = int N_a p ds; and it is a mean of
the pressure over two elements, free of the alternation of the forces of middle and end nodes.

Contact ends where the gap is zero: outside it grows with the 3/2 power of the distance from the end, so
g^(2/3) of the nearest open nodes is extrapolated linearly. Lengths are undeformed ones, from the middle
of the contact; the other half mirrors it.
"""

import sys
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from felupe_contact import CASES, asked, follow, save
from felupe_sections import fine_disc, fine_ring, mesh_of, rounded_block

OPEN_NODES = slice(1, 5)
"""Open nodes, from the first one beside the contact, that the end of the contact is found from."""
ELASTIC_SLIP = 3e-4
"""Of sticking points, mm: with a tangential penalty points with little pressure find no equilibrium."""
MEAN = 0.1
"""Two paths are compared in means of the pressure over pieces of so much of the edge, mm."""


@dataclass(frozen=True)
class Fine:
    """Meshes of a case for its pressure.

    Attributes
    ----------
    draw : callable
    sizes : list of float
        Element sizes where the section touches, mm: a coarse and a fine mesh.
    n_steps : int
        Load steps. Contact grows by about an element in one of them: with fewer, the pressure has
        waves of the length by which it grows, from the friction of points that have just touched.
    place : callable
        ``place(x, y)``: undeformed coordinates in the seal file of those of the elements.
    """

    draw: object
    sizes: list
    n_steps: int
    place: object = lambda x, y: (x, y)


FINE = {
    "half_disc": Fine(fine_disc(5.0), [0.2, 0.14], 30),
    "o_ring": Fine(fine_disc(2.665), [0.1, 0.07], 40, lambda x, y: (x, y + 2.665)),
    "bonded_gasket": Fine(rounded_block(10.0, 4.0, 0.5, corner=0.1), [0.4, 0.28], 20),
    "half_ring": Fine(fine_ring(6.0, 4.3), [0.14, 0.1], 30),
    "rounded_punch": Fine(
        rounded_block(8.0, 6.0, 1.0, corner=0.1), [0.6, 0.4], 20, lambda x, y: (x, 6.0 - y)
    ),
}


class Edge:
    """Nodes of the outer edge in succession, from the middle of the contact.

    Attributes
    ----------
    nodes : ndarray of int, shape (2 m + 1,)
        Ends and middles of m elements in turn.
    length : ndarray, shape (2 m + 1,)
        Arc length from the middle of the contact, mm.
    """

    def __init__(self, mesh, touched):
        sides = outer_sides(mesh.cells, touched)
        self.nodes = chained(sides, mesh.points)
        points = mesh.points[self.nodes]
        g, w = np.polynomial.legendre.leggauss(4)
        first, middle, last = points[:-2:2], points[1:-1:2], points[2::2]
        # speed |dX/dr| of the quadratic map X = sum_a N_a(r) X_a, at Gauss points of r in [-1, 1]
        slope = np.einsum("g,mi->gmi", g - 0.5, first) + np.einsum("g,mi->gmi", g + 0.5, last)
        speed = np.linalg.norm(slope - 2.0 * np.einsum("g,mi->gmi", g, middle), axis=2)
        # length, int (1 - r)/2 ds and int (1 + r)/2 ds of the elements
        self.element = w @ speed
        before, after = (w * 0.5 * (1.0 - g)) @ speed, (w * 0.5 * (1.0 + g)) @ speed
        ends = np.concatenate([[0.0], np.cumsum(self.element)])
        self.length = np.interp(np.arange(len(self.nodes)) / 2.0, np.arange(len(ends)), ends)
        # int H_i ds of the nodes between elements
        self.weight = np.append(before, 0.0) + np.append(0.0, after)

    def pressure(self, force):
        """p_i at the nodes between elements, from the normal forces (2 m + 1,) of all nodes."""
        # H_i is 1/2 at the middles of the elements
        by_hats = force[::2].copy()
        by_hats[:-1] += 0.5 * force[1::2]
        by_hats[1:] += 0.5 * force[1::2]
        return by_hats / self.weight

    def contact_end(self, force, gap):
        """Arc length at which contact ends, from the gaps (2 m + 1,) of the nodes outside it."""
        last = np.flatnonzero(force > 0.0)[-1]
        near = np.arange(len(gap))[last:][OPEN_NODES]
        # g^(2/3) = c (s - s_end)
        slope, value = np.polyfit(self.length[near], gap[near] ** (2.0 / 3.0), 1)
        return -value / slope


def outer_sides(cells, touched):
    """Nodes (first, middle, last) of the sides of elements whose nodes may all touch."""
    corners = [(0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0)]
    sides = np.concatenate([cells[:, own] for own in corners])
    sides = sides[np.isin(sides, touched).all(axis=1)]
    # sides of two elements lie inside
    _, first, count = np.unique(
        np.sort(sides[:, ::2], axis=1), axis=0, return_index=True, return_counts=True
    )
    return sides[first[count == 1]]


def chained(sides, points, start=None):
    """Nodes of sides head to tail, from ``start`` or the one in the middle of the section, x = 0."""
    ends = sides[:, ::2]
    if start is None:
        (start,) = (node for node in np.unique(ends) if abs(points[node, 0]) < 1e-9)
    chain = [start]
    left = list(range(len(sides)))
    while left:
        own = next((i for i in left if chain[-1] in ends[i]), None)
        if own is None:
            break
        left.remove(own)
        first, middle, last = sides[own]
        chain += [middle, last if chain[-1] == first else first]
    return np.array(chain)


def profiles(case, fine, size):
    """Arc lengths, places and the stages of one mesh."""
    began = perf_counter()
    case = replace(case, n_steps=fine.n_steps, elastic_slip=ELASTIC_SLIP)
    mesh = mesh_of(fine.draw, size)
    edge = Edge(mesh, np.flatnonzero(case.touched(*mesh.points.T)))
    places, stages = mesh.points[edge.nodes], []

    def keep(travel, fields, plate):
        if not asked(case, travel):
            return
        force = np.abs(plate.results.force.toarray()[2 * edge.nodes + 1, 0])
        top = case.top - case.travel_factor * travel
        gap = top - (places + fields[0].values[edge.nodes])[:, 1]
        pressure = edge.pressure(force)
        stages.append(
            {
                "force_N_per_m": 2.0 * force.sum(),
                "peak_kPa": pressure.max(),
                "width_mm": 2.0 * edge.contact_end(force, gap),
                "pressure_kPa": pressure,
            }
        )
        print(
            f"    {travel:.4f} mm, {perf_counter() - began:.0f} s",
            stages[-1]["peak_kPa"],
            stages[-1]["width_mm"],
            flush=True,
        )

    follow(case, mesh, keep)
    print(f"  size {size}: {mesh.ncells} elements, {perf_counter() - began:.0f} s", flush=True)
    return edge.length[::2], np.column_stack(fine.place(*places[::2].T)), stages


def means(length, pressure, end):
    """Means of the pressure over pieces of the edge up to ``end``, shape (k,)."""
    at = np.linspace(0.0, end, 1 + max(1, round(end / MEAN)))
    fine = np.linspace(0.0, end, 100 * (len(at) - 1) + 1)
    value = np.interp(fine, length, pressure)
    # int p ds over the pieces
    total = np.append(0.0, np.cumsum(0.5 * np.diff(fine) * (value[1:] + value[:-1])))
    return np.diff(total[::100]) / np.diff(at)


def difference(one, other):
    """Of the stages that two paths reach: rms over the peak, and relative in peak, width, force."""
    (s, _, stages), (other_s, _, others) = one, other
    found = []
    for own, its in zip(stages, others, strict=False):
        # rms over the union of both contacts
        end = 0.5 * max(own["width_mm"], its["width_mm"])
        apart = means(other_s, its["pressure_kPa"], end) - means(s, own["pressure_kPa"], end)
        peak, width, force = (
            its[name] / own[name] - 1.0 for name in ("peak_kPa", "width_mm", "force_N_per_m")
        )
        rms = np.sqrt(np.mean(apart**2)) / own["peak_kPa"]
        found.append({"rms_over_peak": rms, "peak": peak, "width": width, "force": force})
    return found


def rounded(value, digits=6):
    """As JSON holds it."""
    if isinstance(value, dict):
        return {name: rounded(own, digits) for name, own in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [rounded(own, digits) for own in value]
    return float(f"{value:.{digits}g}")


def main(name):
    case, fine = CASES[name], FINE[name]
    coarse, finest = (profiles(case, fine, size) for size in fine.sizes)
    half = profiles(case, replace(fine, n_steps=fine.n_steps // 2), fine.sizes[0])
    length, place, stages = finest
    # stages that all three paths reach
    reached = min(len(own[2]) for own in (finest, coarse, half))
    stages = stages[:reached]
    # what never touches is left out
    near = np.flatnonzero(length < max(stage["width_mm"] for stage in stages))
    changes = difference(finest, coarse), difference(coarse, half)
    for stage in stages:
        stage["pressure_kPa"] = stage["pressure_kPa"][near]
    pressure = {
        "element_sizes_mm": fine.sizes,
        "change_on_coarse_mesh": changes[0][:reached],
        "change_with_half_the_load_steps": changes[1][:reached],
        "arc_length_mm": length[near],
        "place_mm": place[near],
        "stages": stages,
    }
    save(name, {"pressure": rounded(pressure)})


if __name__ == "__main__":
    main(sys.argv[1])
