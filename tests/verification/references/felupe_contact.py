"""Forces of pressed rubber sections by finite elements of FElupe, which know nothing of seal_mdao.

Not run by the tests. It writes the JSON files beside it::

    python -m venv fe && fe/bin/pip install felupe==11.3.0 tensortrax==0.29.0 gmsh==4.15.2 \
        scipy==1.17.1 pypardiso==0.4.7
    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_contact.py o_ring

Elements: biquadratic quadrilaterals with linear discontinuous pressure and volume ratio (three fields),
plane strain. Rubber: Mooney-Rivlin in I1 J^(-2/3) and I2 J^(-4/3), volumetric energy K/2 (J - 1)^2.
Contact: nodes of the outer edges against a rigid plane, Coulomb friction by return mapping
(``felupe.ContactRigidPlane``), penalties so large that ten times larger ones change nothing.
One half (quarter) of a section stands for the whole one. Lengths in mm, stresses in kPa, forces in N/m.
"""

import json
import sys
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from time import perf_counter

import felupe as fem
import felupe.constitution.tensortrax as mat
import numpy as np
from felupe_sections import half_ring, mesh_of, quarter_disc, rounded_block
from pypardiso import spsolve

SOFT = {"c10": 80.0, "c01": 20.0, "bulk_modulus": 80000.0}
HARD = {"c10": 400.0, "c01": 100.0, "bulk_modulus": 400000.0}


METHOD = (
    "biquadratic displacement, linear discontinuous pressure and volume ratio, plane strain; nodes "
    "against a rigid plane with stiff penalties, Coulomb friction by return mapping; one half or "
    "quarter by symmetry"
)
CODE = (
    "FElupe 11.3.0 (SolidBody of NearlyIncompressible, ContactRigidPlane), tensortrax 0.29.0, "
    "gmsh 4.15.2"
)


@dataclass(frozen=True)
class Case:
    """A section, its rubber and its plate.

    Attributes
    ----------
    section : str
        In words.
    draw : callable
        ``draw(size)`` makes the half or quarter that is computed, of blocks of elements, in gmsh.
    rubber : dict
    friction : float
    travel : list of float
        Of the plate, mm, at which the force is asked.
    top : float
        Height of the plate at the start, mm.
    prescribed : str
        ``"xy"`` or ``"y"``: directions in which the lower edge, y = 0, is held.
    touched : callable
        ``touched(x, y)``: mask of the nodes of the outer edges that may touch the plate.
    sizes : list of float
        Element sizes of the meshes, mm, from coarse to fine.
    n_steps : int
        Load steps of the path, besides ten for the first touch.
    travel_factor : float
        Travel of the plate of the part that is computed over that of the whole section.
    normal_penalty, tangent_penalty : float
        Of a node, N/m over mm.
    graded : callable or None
        Another ``draw``, with smaller elements where the stress is singular.
    elastic_slip : float or None
        Slip of a sticking point at the limit of friction, mm, in place of the tangential penalty.
    pressure_modes : int
        3 for linear pressures, 4 for bilinear ones, which are stiffer than stable elements may be.
    """

    section: str
    draw: object
    rubber: dict
    friction: float
    travel: list
    top: float
    prescribed: str
    touched: object
    sizes: list
    n_steps: int = 40
    travel_factor: float = 1.0
    normal_penalty: float = 1e7
    tangent_penalty: float = 1e6
    graded: object = None
    elastic_slip: float | None = None
    pressure_modes: int = 3


class Pressure(fem.Element):
    """1, r and s on a quadrilateral, discontinuous from one to the next; with a fourth one, r s."""

    def __init__(self, modes):
        self.points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])[:modes]

    def function(self, rs):
        return np.array([1.0, rs[0], rs[1], rs[0] * rs[1]])[: len(self.points)]

    def gradient(self, rs):
        return np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], rs[::-1]])[: len(self.points)]


def on_arc(x, y, radius):
    return np.abs(np.hypot(x, y) - radius) < 1e-6


CASES = {
    "half_disc": Case(
        section="half disc of radius 5 mm on a fixed foot, dome pressed by a plate",
        draw=quarter_disc(5.0),
        rubber=SOFT,
        friction=0.2,
        travel=[0.511, 0.991, 1.501],
        top=5.0,
        prescribed="xy",
        touched=lambda x, y: on_arc(x, y, 5.0),
        sizes=[0.6, 0.4, 0.3, 0.22],
        n_steps=27,
    ),
    "o_ring": Case(
        section="disc of diameter 5.33 mm squeezed between two flat plates",
        draw=quarter_disc(2.665),
        rubber=HARD,
        friction=0.2,
        travel=[0.533, 1.066, 1.3325],
        top=2.665,
        prescribed="y",
        touched=lambda x, y: on_arc(x, y, 2.665),
        sizes=[0.3, 0.2, 0.14],
        travel_factor=0.5,
        normal_penalty=5e7,
        tangent_penalty=5e6,
    ),
    "bonded_gasket": Case(
        section="block 10 mm wide and 4 mm high, upper corners rounded with 0.5 mm, bonded below, "
        "compressed by a plate on top",
        draw=rounded_block(10.0, 4.0, 0.5),
        graded=rounded_block(10.0, 4.0, 0.5, graded=True),
        rubber=SOFT,
        friction=0.3,
        travel=[0.2, 0.4, 0.6, 0.8],
        top=4.0,
        prescribed="xy",
        touched=lambda x, y: (
            (y > 1.0) & ((y > 4.0 - 1e-6) | (x > 5.0 - 1e-6) | on_arc(x - 4.5, y - 3.5, 0.5))
        ),
        sizes=[0.6, 0.4, 0.28, 0.2],
        n_steps=30,
    ),
    "rounded_punch": Case(
        section="block 8 mm wide and 6 mm high with corners rounded with 1 mm, bonded on one side and "
        "pressed on a plane with the other",
        draw=rounded_block(8.0, 6.0, 1.0),
        rubber=SOFT,
        friction=0.2,
        travel=[0.3, 0.6, 0.9],
        top=6.0,
        prescribed="xy",
        touched=lambda x, y: (
            (y > 1.5) & ((y > 6.0 - 1e-6) | (x > 4.0 - 1e-6) | on_arc(x - 3.0, y - 5.0, 1.0))
        ),
        sizes=[0.6, 0.4, 0.28],
        n_steps=20,
    ),
    "half_ring": Case(
        section="upper half of a ring of outer radius 6 mm and wall 1.7 mm, both feet fixed, "
        "pressed by a plate from above",
        draw=half_ring(6.0, 4.3),
        rubber=SOFT,
        friction=0.2,
        travel=[1.0, 1.5, 2.0],
        top=6.0,
        prescribed="xy",
        touched=lambda x, y: on_arc(x, y, 6.0),
        sizes=[0.43, 0.3, 0.2],
        normal_penalty=1e6,
        tangent_penalty=1e5,
    ),
}


def three_fields(mesh, displacement, modes=3):
    """Displacement, a ``felupe`` field class, with discontinuous pressure and volume ratio."""
    region = fem.RegionBiQuadraticQuad(mesh)
    n = mesh.ncells
    of_pressure = fem.Mesh(
        np.zeros((modes * n, 2)), np.arange(modes * n).reshape(n, modes), "pressure"
    )
    dual = fem.Region(of_pressure, Pressure(modes), region.quadrature, grad=False)
    one = np.tile(np.eye(modes)[0], n)[:, None]
    return fem.FieldContainer(
        [
            displacement(region, dim=2),
            fem.Field(dual, dim=1),
            fem.Field(dual, dim=1, values=one),
        ]
    )


def mooney_rivlin(rubber):
    """Isochoric law of a rubber."""
    own = mat.models.hyperelastic.mooney_rivlin
    return mat.Hyperelastic(own, C10=rubber["c10"], C01=rubber["c01"])


def model_of(case, mesh, law=None):
    """Fields, items, boundaries and the plate, whose point is the last one of the mesh.

    ``law``: isochoric law in place of Mooney-Rivlin's.
    """
    x, y = mesh.points.T
    touched = np.where(case.touched(x, y))[0]
    mesh.add_points([0.0, case.top])
    fields = three_fields(mesh, fem.FieldPlaneStrain, case.pressure_modes)
    law = law or mooney_rivlin(case.rubber)
    solid = fem.SolidBody(fem.NearlyIncompressible(law, bulk=case.rubber["bulk_modulus"]), fields)
    plate = fem.ContactRigidPlane(
        fields,
        touched,
        -1,
        normal=[0.0, -1.0],
        friction=case.friction,
        multiplier=case.normal_penalty,
        multiplier_tangential=case.tangent_penalty,
        elastic_slip=case.elastic_slip,
    )
    body = np.append(np.ones(len(x), dtype=bool), False)
    flat = np.append(np.abs(y) < 1e-9, False)
    middle = np.append(np.abs(x) < 1e-9, False) & body
    last = ~body
    u = fields[0]
    bounds = {
        "middle": fem.Boundary(u, mask=middle, skip=(False, True)),
        "foot": fem.Boundary(u, mask=flat, skip=("x" not in case.prescribed, False)),
        "side": fem.Boundary(u, mask=last, skip=(False, True)),
        "move": fem.Boundary(u, mask=last, skip=(True, False)),
    }
    return fields, solid, plate, bounds


def travels(case):
    """Load steps that meet the asked travels, finer at the first touch."""
    ends = [0.0, *case.travel]
    parts = [0.5 * case.travel[0] * np.linspace(0.0, 1.0, 11)[1:] ** 2]
    for i, (a, b) in enumerate(pairwise(ends)):
        a = parts[0][-1] if i == 0 else a
        parts.append(np.linspace(a, b, max(2, round(case.n_steps * (b - a) / ends[-1])) + 1)[1:])
    return np.concatenate(parts)


def follow(case, mesh, keep):
    """Press the section along its path; ``keep(travel, fields, plate)`` sees every equilibrium."""
    fields, solid, plate, bounds = model_of(case, mesh)
    path = travels(case)
    step = fem.Step(
        [solid, plate], ramp={bounds["move"]: -case.travel_factor * path}, boundaries=bounds
    )
    reached = [0.0]

    def after(context, state):
        reached.append(-fields[0].values[-1, 1] / case.travel_factor)
        keep(reached[-1], fields, plate)

    cutback = fem.CutbackPlugin(max_cutbacks=5)
    try:
        fem.Job([step], plugins=[cutback, after]).evaluate(
            x0=fields, verbose=0, solver=spsolve, tol=1e-7, maxiter=14
        )
    except fem.NewtonConvergenceError:
        print(f"  no equilibrium found beyond {reached[-1]:.3f} mm of travel")


def asked(case, travel):
    """Whether the force is asked at a travel, mm."""
    return np.abs(np.array(case.travel) - travel).min() < 1e-9


def press(case, size):
    """Force of the whole section on the plate at the asked travels, N/m."""
    began = perf_counter()
    mesh = mesh_of(case.draw, size)
    force = []

    def keep(travel, fields, plate):
        if asked(case, travel):
            total = 2.0 * plate.results.force.toarray()[2 * mesh.npoints - 1, 0]
            force.append(round(float(abs(total)), 2))

    follow(case, mesh, keep)
    print(
        f"  size {size}: {mesh.ncells} elements, {force} N/m, {perf_counter() - began:.0f} s",
        flush=True,
    )
    return force


def record(case, meshes, frictionless, checks, graded):
    """JSON of a case: forces by element size, of which the finest that got there is the value."""

    def finest(table):
        return [
            next(f[i] for size, f in sorted(table.items()) if len(f) > i)
            for i in range(len(case.travel))
        ]

    def uncertainty(i):
        """Twice the change by the last refinement, or that by grading; at least 0.1 %."""
        last, before = [f[i] for size, f in sorted(meshes.items()) if len(f) > i][:2]
        others = [f[i] for size, f in sorted(graded.items()) if len(f) > i][:1]
        changes = [2.0 * abs(before / last - 1.0), *(abs(other / last - 1.0) for other in others)]
        return round(max(1e-3, *changes), 4)

    def named(table):
        return {f"elements of {size} mm": force for size, force in table.items()}

    return {
        "section": case.section,
        "rubber": {"law": "mooney_rivlin", **case.rubber},
        "friction": case.friction,
        "travel_mm": case.travel,
        "force_N_per_m": finest(meshes),
        "relative_uncertainty": [uncertainty(i) for i in range(len(case.travel))],
        "frictionless_force_N_per_m": finest(frictionless),
        "method": METHOD,
        "code": CODE,
        "penalties_kPa": [case.normal_penalty, case.tangent_penalty],
        "meshes_N_per_m": named(meshes),
        "frictionless_meshes_N_per_m": named(frictionless),
        "graded_meshes_N_per_m": named(graded),
        "checks_N_per_m": checks,
    }


def main(name):
    case = CASES[name]
    free = replace(case, friction=0.0)
    twice = replace(case, n_steps=2 * case.n_steps)
    stiff = replace(
        case, normal_penalty=10 * case.normal_penalty, tangent_penalty=10 * case.tangent_penalty
    )
    coarse = case.sizes[0]
    checks = {
        f"elements of {coarse} mm, twice as many load steps": press(twice, coarse),
        f"elements of {coarse} mm, ten times the penalties": press(stiff, coarse),
        f"elements of {coarse} mm, bilinear pressure": press(
            replace(case, pressure_modes=4), coarse
        ),
    }
    meshes, frictionless = ({size: press(c, size) for size in case.sizes} for c in (case, free))
    fine = {}
    if case.graded:
        other = replace(case, draw=case.graded)
        fine = {size: press(other, size) for size in case.sizes[:3]}
    save(name, record(case, meshes, frictionless, checks, fine))


def save(name, found):
    """Put new entries into the JSON of a case; the others stay."""
    file = Path(__file__).with_name(f"{name}.json")
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    file.write_text(json.dumps(known | found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
