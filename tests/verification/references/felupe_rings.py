"""Forces of bodies of revolution by axisymmetric finite elements of FElupe, which know nothing of
seal_mdao.

Not run by the tests. It writes the JSON files beside it, with the packages that ``felupe_contact``
names::

    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_rings.py ring_squeezed

Elements, rubber and contact are those of ``felupe_contact``, with ``felupe.FieldAxisymmetric`` in
place of plane strain. Meshes have the axial coordinate first, the radius second, as FElupe wants them;
sections are drawn with the radius x first. The upper half of a ring is computed; y = 0 is a plane of
symmetry. The lip is complete and fixed at its largest radius; its plate is a shaft whose radius grows.
Lengths in mm, stresses in kPa, forces of the complete ring in N.

Contact pressure is nominal, at the nodes between elements as in ``felupe_pressure``,

    p_i = sum_a H_i(X_a) f_a / int H_i 2 pi R ds.
"""

import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import felupe as fem
import felupe.constitution.tensortrax as mat
import numpy as np
from felupe_contact import (
    CODE,
    SOFT,
    Case,
    asked,
    mooney_rivlin,
    on_arc,
    save,
    three_fields,
    travels,
)
from felupe_pressure import ELASTIC_SLIP, chained, outer_sides, rounded
from felupe_sections import fine_disc, mesh_of, outlined
from pypardiso import spsolve

METHOD = (
    "biquadratic displacement, linear discontinuous pressure and volume ratio, axisymmetric; nodes "
    "against a rigid plane with stiff penalties, Coulomb friction by return mapping; upper half"
)
LIP_METHOD = METHOD.replace("upper half", "complete section")
FOAM_METHOD = "biquadratic displacement, axisymmetric; upper half"
FOAM_CODE = "FElupe 11.3.0 (SolidBody of Hyperelastic storakers), tensortrax 0.29.0"
AXIAL, RADIAL = 0, 1
"""Components of displacement."""
FLIPPED = [0, 3, 2, 1, 7, 6, 5, 4, 8]
"""Nodes of a mirrored element, counter-clockwise again."""
MILLI = 1e-3
"""kPa mm^2 in N."""


def half_disc(radius, middle):
    """Mesh of the upper half of a disc about (``middle``, 0), finest where it is highest."""

    def mesh(size):
        quarter = mesh_of(fine_disc(radius), size)
        x, y = quarter.points.T
        points = np.vstack([np.column_stack([middle + x, y]), np.column_stack([middle - x, y])])
        cells = np.vstack([quarter.cells, len(x) + quarter.cells[:, FLIPPED]])
        # nodes of both quarters, x = 0, are the same
        _, first, number = np.unique(
            points.round(9), axis=0, return_index=True, return_inverse=True
        )
        return fem.Mesh(points[first], number.ravel()[cells], "quad9")

    return mesh


def graded(t, strength):
    """Coordinates from 0 to 1 that are closer together at 1."""
    return 1.0 - (1.0 - t) ** strength


def rectangle(left, right, height, both_sides, strength=1.6):
    """Mesh of a rectangle, finer at its upper edge and at its right, or both, sides."""

    def mesh(size):
        n = [max(3, round(length / size)) for length in (right - left, height)]
        own = fem.Rectangle(a=(0.0, 0.0), b=(1.0, 1.0), n=[k + 1 for k in n])
        x, y = own.points.T
        x = 0.5 + 0.5 * np.sign(2 * x - 1) * graded(abs(2 * x - 1), strength) if both_sides else (
            graded(x, strength)
        )  # fmt: skip
        own.points[:] = np.column_stack([left + (right - left) * x, height * graded(y, strength)])
        return fem.mesh.convert(own, order=2, calc_points=True, calc_midfaces=True)

    return mesh


def ring(section, mesh, height, travel, touched, sizes, friction=0.2, **options):
    """Case of a ring between two plates that approach each other."""
    return Case(
        section=section, draw=mesh, rubber=SOFT, friction=friction, travel=travel, top=height,
        prescribed="y", touched=touched, sizes=sizes, travel_factor=0.5, normal_penalty=1e9,
        elastic_slip=ELASTIC_SLIP, **options,
    )  # fmt: skip


SQUEEZED = {
    "ring_squeezed": ring(
        "O-ring of mean radius 10 mm and section radius 1.75 mm between two flat plates",
        half_disc(1.75, 10.0), 1.75, [0.35, 0.7],
        lambda x, y: on_arc(x - 10.0, y, 1.75) & (y > 0.6), [0.16, 0.11, 0.08],
    ),
    "ring_sleeve": ring(
        "sleeve of radii 6 and 10 mm, 12 mm high, between two flat plates",
        rectangle(6.0, 10.0, 6.0, True), 6.0, [1.2, 3.0],
        lambda x, y: (y > 6.0 - 1e-9) | ((y > 3.0) & ((x < 6.0 + 1e-9) | (x > 10.0 - 1e-9))),
        [0.6, 0.4, 0.28], friction=0.5, n_steps=30,
    ),
}  # fmt: skip
EXAMPLES = Path(__file__).parents[3] / "examples"
SHORE_70 = {"c10": 920.0844636429829, "c01": 0.0, "bulk_modulus": 1e6}
"""kPa: C10 = E / 6 of Gent's E = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)) MPa."""
CORNERS = [(30.0, 0.0), (30.0, 2.5), (27.5, 2.5), (27.4, 0.6), (24.2, 6.0), (23.0, 5.2)]
"""Where the stress of the lip is singular, or high."""


def lip(name, centre, radius, start, travel, sizes):
    """Case of the lip of an example on a shaft of radius ``start``; its arc touches."""
    file = tomllib.loads((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))
    mesh = outlined(file["section"]["outer"], CORNERS)
    return Case(
        section="radial lip seal on a shaft that grows along the radius",
        draw=lambda size: mesh_of(mesh, size), rubber=SHORE_70, friction=0.2, travel=travel,
        top=start, prescribed="xy", touched=lambda x, y: on_arc(x - centre[0], y - centre[1], radius),
        sizes=sizes, travel_factor=-1.0, normal_penalty=1e9, elastic_slip=ELASTIC_SLIP, n_steps=60,
    )  # fmt: skip


SQUEEZED["shaft_lip"] = lip(
    "shaft_lip",
    (19.996363011, 6.718787671),
    0.269819141,
    19.72,
    [0.61],
    [0.012, 0.008, 0.0055, 0.004],
)
BONDED = {
    f"ring_disc_{thickness}": (
        thickness,
        Case(
            section=f"disc of radius 10 mm and thickness {thickness} mm bonded to two flat plates",
            draw=rectangle(0.0, 10.0, 0.5 * thickness, False, 1.0), rubber=SOFT, friction=0.0,
            travel=[1e-3 * thickness, 0.1 * thickness, 0.2 * thickness], top=1e3, prescribed="y",
            touched=lambda x, y: y > 1e6, travel_factor=0.5,
            sizes=[0.1 * thickness, 0.0715 * thickness, 0.05 * thickness],
        ),
    )
    for thickness in (2, 5)
}  # fmt: skip
FOAM = {"mu": [40.0, 15.0], "alpha": [6.0, -3.0], "nu": [0.3, 0.2]}
BONDED["ring_foam"] = (
    5,
    replace(
        BONDED["ring_disc_5"][1], rubber=FOAM, travel=[0.5, 1.0],
        section="foam disc of radius 10 mm and thickness 5 mm bonded to two flat plates",
    ),
)  # fmt: skip


def motion(case):
    """Component in which the plate moves: a shaft's is the radius."""
    return RADIAL if case.prescribed == "xy" else AXIAL


def model_of(case, mesh, law=None):
    """Fields, body, boundaries and the plate of a mesh (R, y); the plate is the last point.

    ``law``: isochoric law in place of Mooney-Rivlin's.
    """
    points = mesh.points
    touched = np.flatnonzero(case.touched(*points.T))
    turned = fem.Mesh(points[:, ::-1], mesh.cells[:, FLIPPED], "quad9")
    # beside the axis, where the radius is not zero, and away from the section
    shaft = motion(case) == RADIAL
    turned.add_points([1.0, case.top] if shaft else [case.top, 1.0])
    if case.rubber is FOAM:
        # beta = nu / (1 - 2 nu); one field
        mu, alpha, nu = (np.array(own) for own in FOAM.values())
        u = fem.FieldAxisymmetric(fem.RegionBiQuadraticQuad(turned), dim=2)
        fields, storakers = fem.FieldContainer([u]), mat.models.hyperelastic.storakers
        law = mat.Hyperelastic(storakers, mu=mu, alpha=alpha, beta=nu / (1.0 - 2.0 * nu))
        solid = fem.SolidBody(law, fields)
    else:
        fields = three_fields(turned, fem.FieldAxisymmetric, case.pressure_modes)
        law, bulk = law or mooney_rivlin(case.rubber), case.rubber["bulk_modulus"]
        solid = fem.SolidBody(fem.NearlyIncompressible(law, bulk=bulk), fields)
    u = fields[0]
    plate = fem.ContactRigidPlane(
        fields, touched, -1, normal=[0.0, 1.0] if shaft else [-1.0, 0.0], friction=case.friction,
        multiplier=case.normal_penalty, multiplier_tangential=case.tangent_penalty,
        elastic_slip=case.elastic_slip,
    ) if touched.size else None  # fmt: skip
    x, y = points.T
    if shaft:
        masks = {f"case {axis}": (x > x.max() - 1e-9, axis) for axis in (AXIAL, RADIAL)}
    else:
        masks = {"axis": (x < 1e-9, RADIAL), "middle": (y < 1e-9, AXIAL)}
    masks = {name: (np.append(own, False), axis) for name, (own, axis) in masks.items()}
    last = np.append(np.zeros(len(x), bool), True)
    masks |= {"side": (last, 1 - motion(case)), "move": (last, motion(case))}
    bounds = {
        name: fem.Boundary(u, mask=mask, skip=(axis != AXIAL, axis != RADIAL))
        for name, (mask, axis) in masks.items()
        if mask.any()
    }
    return fields, solid, plate, bounds


def follow(case, items, fields, bounds, moved, path, keep):
    """Ramp the boundary ``moved``; ``keep(travel)`` sees every equilibrium."""
    step = fem.Step(items, ramp={bounds[moved]: -case.travel_factor * path}, boundaries=bounds)
    node = bounds[moved].points[0]

    def after(context, state):
        keep(-fields[0].values[node, motion(case)] / case.travel_factor)

    try:
        fem.Job([step], plugins=[fem.CutbackPlugin(max_cutbacks=6), after]).evaluate(
            x0=fields, verbose=0, solver=spsolve, tol=1e-7, maxiter=14
        )
    except fem.NewtonConvergenceError:
        print("  no equilibrium found beyond this travel")


def edge_of(mesh, touched):
    """Nodes of the touching edge from its inner end, the sides' lengths of arc, int H_i 2 pi R ds."""
    sides = outer_sides(mesh.cells, np.flatnonzero(touched))
    ends, count = np.unique(sides[:, ::2], return_counts=True)
    loose = ends[count == 1]
    nodes = chained(sides, mesh.points, loose[mesh.points[loose, 0].argmin()])
    points = mesh.points[nodes]
    g, w = np.polynomial.legendre.leggauss(4)
    first, middle, last = points[:-2:2], points[1:-1:2], points[2::2]
    # X = sum_a N_a(r) X_a and dX/dr of the quadratic map at Gauss points r
    values = np.array([0.5 * g * (g - 1.0), 1.0 - g * g, 0.5 * g * (g + 1.0)])
    slopes = np.array([g - 0.5, -2.0 * g, g + 0.5])
    own = np.stack([first, middle, last])
    radius = np.einsum("ag,am->gm", values, own[..., 0])
    speed = np.linalg.norm(np.einsum("ag,ami->gmi", slopes, own), axis=2)
    area = 2.0 * np.pi * radius * speed
    weight = np.append((w * 0.5 * (1.0 - g)) @ area, 0.0)
    weight[1:] += (w * 0.5 * (1.0 + g)) @ area
    return nodes, np.append(0.0, np.cumsum(w @ speed)), weight


def squeezed(case, size):
    """Stages of a ring between plates: force, N, and nominal pressure along the edge, kPa."""
    began, mesh, stages = perf_counter(), case.draw(size), []
    nodes, length, weight = edge_of(mesh, case.touched(*mesh.points.T))
    places = mesh.points[nodes[::2]]

    fields, solid, plate, bounds = model_of(case, mesh)

    def keep(travel):
        if not asked(case, travel):
            return
        force = np.abs(plate.results.force.toarray()[2 * nodes + motion(case), 0])
        # H_i is 1/2 at the middles of the elements
        by_hats = force[::2].copy()
        by_hats[:-1] += 0.5 * force[1::2]
        by_hats[1:] += 0.5 * force[1::2]
        pressure = by_hats / weight
        total = MILLI * force.sum()
        stages.append({"force_N": total, "peak_kPa": pressure.max(), "pressure_kPa": pressure})
        print(f"    {travel:.3f} mm: {total:.4f} N, {pressure.max():.2f} kPa", flush=True)

    follow(case, [solid, plate], fields, bounds, "move", travels(case), keep)
    print(f"  size {size}: {mesh.ncells} elements, {perf_counter() - began:.0f} s", flush=True)
    return length, places, stages


def bonded(case, size):
    """Forces of a bonded disc at the asked travels, N."""
    mesh, force = case.draw(size), []
    fields, solid, _, bounds = model_of(case, mesh)
    high = np.append(np.isclose(mesh.points[:, 1], mesh.points[:, 1].max()), False)
    u = fields[0]
    bounds["bond"] = fem.Boundary(u, mask=high, skip=(True, False))
    bounds["press"] = fem.Boundary(u, mask=high, skip=(False, True))

    def keep(travel):
        if asked(case, travel):
            own = solid.results.force.toarray()[: u.values.size].reshape(-1, 2)
            force.append(float(MILLI * abs(own[high, AXIAL].sum())))

    path = np.unique(np.round([*case.travel, *np.linspace(0.0, case.travel[-1], 41)[1:]], 12))
    follow(case, [solid], fields, bounds, "press", path, keep)
    print(f"  size {size}: {mesh.ncells} elements, {force} N", flush=True)
    return force


def refined(forces, i):
    """Twice the change of a force by the last refinement of those meshes that got there."""
    last, before = [own[i] for _, own in sorted(forces.items()) if len(own) > i][:2]
    return 2.0 * abs(before / last - 1.0)


def change(one, other, key):
    """Relative difference of the stages of two paths."""
    return [b[key] / a[key] - 1.0 for a, b in zip(one, other, strict=False)]


def written(case, found):
    """Entries that say what was computed, with those ``found``."""
    foam = case.rubber is FOAM
    method = LIP_METHOD if motion(case) == RADIAL else METHOD
    about = {"section": case.section}
    about["rubber"] = {"law": "hyperfoam" if foam else "mooney_rivlin", **case.rubber}
    about |= {"friction": case.friction, "travel_mm": case.travel}
    about |= (
        {"method": FOAM_METHOD, "code": FOAM_CODE} if foam else {"method": method, "code": CODE}
    )
    return about | rounded(found)


def main(name):
    if name in BONDED:
        case = BONDED[name][1]
        forces = {size: bonded(case, size) for size in case.sizes}
        finest = forces[case.sizes[-1]]
        found = {
            "force_N": finest,
            "relative_uncertainty": [refined(forces, i) for i in range(len(finest))],
            "meshes_N": {f"elements of {size} mm": own for size, own in forces.items()},
        }
        Path(__file__).with_name(f"{name}.json").unlink(missing_ok=True)
        save(name, written(case, found))
        return
    case = SQUEEZED[name]
    runs = {size: squeezed(case, size) for size in case.sizes}
    coarse = case.sizes[0]
    twice = squeezed(replace(case, n_steps=2 * case.n_steps), coarse)[2]
    stiff = squeezed(replace(case, normal_penalty=5 * case.normal_penalty), coarse)[2]
    length, places, stages = runs[case.sizes[-1]]
    before, first = runs[case.sizes[-2]][2], runs[coarse][2]
    changes = {
        f"{kind}_{key}": change(one, other, key)
        for kind, one, other in (
            ("mesh", stages, before), ("steps", first, twice), ("penalty", first, stiff),
        )
        for key in ("force_N", "peak_kPa")
    }  # fmt: skip
    found = {
        "force_N": [own["force_N"] for own in stages],
        "peak_kPa": [own["peak_kPa"] for own in stages],
        # twice the change by the last refinement, or that by steps or penalties
        "relative_uncertainty": [
            max(2.0 * abs(a), abs(b), abs(c))
            for a, b, c in zip(
                *(changes[f"{k}_force_N"] for k in ("mesh", "steps", "penalty")), strict=True
            )
        ],
        "changes": changes,
        "meshes_N": {
            f"elements of {size} mm": [own["force_N"] for own in run[2]]
            for size, run in runs.items()
        },
        "arc_length_mm": length,
        "place_mm": places,
        "pressure_kPa": [own["pressure_kPa"] for own in stages],
    }
    save(name, written(case, found))


if __name__ == "__main__":
    main(sys.argv[1])
