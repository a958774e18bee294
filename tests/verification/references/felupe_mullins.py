"""Softening of a pressed disc by finite elements of FElupe, which know nothing of seal_mdao.

Not run by the tests. It writes ``softening_disc.json`` beside it, with the packages that
``felupe_contact`` names::

    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_mullins.py

The half disc of ``felupe_relaxation`` is pressed without friction, released and pressed further. The
isochoric energy W of its Mooney-Rivlin rubber softens after R. W. Ogden and D. G. Roxburgh, Proc. R.
Soc. Lond. A 455 (1999) 2861, with the largest energy W_max that a point has had
(``felupe.OgdenRoxburgh``):

    P = eta dW/dF,    eta = 1 - (1/r) erf((W_max - W) / (m + beta W_max)).

Lengths in mm, stresses in kPa, forces in N/m. Peak pressure is nominal, as in ``felupe_pressure``.
"""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from time import perf_counter

import felupe as fem
import felupe.constitution.tensortrax as mat
import numpy as np
from felupe.math import det, dya
from felupe_contact import CODE, METHOD, model_of, save
from felupe_pressure import rounded
from felupe_relaxation import DISC, DiscEdge, apart
from felupe_sections import mesh_of
from pypardiso import spsolve
from scipy.special import erf

SOFTENING = {"r": 2.0, "m": 10.0, "beta": 0.1}
"""m in kPa, the others without unit."""
CORNERS = [0.0, 1.0, 0.0, 1.5, 0.0]
"""Travels between which the plate moves, mm."""
ASKED = 0.25
"""Force and pressure are stored at multiples of it, mm."""
SIZES = [0.28, 0.2, 0.14]
PER_MM = 40
"""Increments of a millimetre of travel."""


class WithEnergy(mat.Hyperelastic):
    """Mooney-Rivlin's law that also gives its energy, which ``felupe.OgdenRoxburgh`` asks for."""

    def function(self, x):
        F = x[0]
        C = np.einsum("ki...,kj...->ij...", F, F)
        square = det(F) ** (-2.0 / 3.0)
        one = np.einsum("ii...", C)
        two = 0.5 * (one**2 - np.einsum("ij...,ij...->...", C, C))
        own = self.kwargs
        return [own["C10"] * (square * one - 3.0) + own["C01"] * (square**2 * two - 3.0)]


class Softening(fem.OgdenRoxburgh):
    """FElupe's law; its own tangent lacks d eta/dW of points that have softened by less than 1e-5."""

    def _hessian(self, x):
        W, P, A = (
            getattr(self.material, name)(x)[0] for name in ("function", "gradient", "hessian")
        )
        largest = np.maximum(W, x[-1][0])
        width = self.m + self.beta * largest
        z = (largest - W) / width
        eta = 1.0 - erf(z) / self.r
        # d eta/dW = 2 exp(-z^2) / (sqrt(pi) r width) below the largest energy, else 0
        slope = np.where(z > 0.0, 2.0 / (np.sqrt(np.pi) * self.r) * np.exp(-z * z) / width, 0.0)
        return [eta * A + slope * dya(P, P)]


def softening(rubber):
    """Isochoric law that softens."""
    own = mat.models.hyperelastic.mooney_rivlin
    law = WithEnergy(own, C10=rubber["c10"], C01=rubber["c01"])
    return Softening(law, **SOFTENING)


def path(per_mm):
    """Travels, mm: the first one of every press is finer."""
    found = []
    for start, end in pairwise(CORNERS):
        count = round(abs(end - start) * per_mm)
        even = np.linspace(start, end, count + 1)
        if end > start:
            touch = start + (even[4] - start) * np.linspace(0.0, 1.0, 9) ** 2
            even = np.concatenate([touch, even[5:]])
        found.append(even[1:])
    return np.concatenate(found)


def press(case, size, per_mm=PER_MM):
    """Travel, force, nominal peak pressure and height of the crown along the path, (4, n)."""
    began = perf_counter()
    mesh = mesh_of(case.draw, size)
    edge = DiscEdge(case, mesh)
    fields, solid, plate, bounds = model_of(case, mesh, softening(case.rubber))
    travel, found = path(per_mm), []
    step = fem.Step([solid, plate], ramp={bounds["move"]: -travel}, boundaries=bounds)

    def keep(context, state):
        found.append((-fields[0].values[-1, 1], *edge.state(fields, plate)))

    fem.Job([step], plugins=[fem.CutbackPlugin(max_cutbacks=6), keep]).evaluate(
        x0=fields, verbose=0, solver=spsolve, tol=1e-7, maxiter=14
    )
    asked = np.abs(travel / ASKED - np.round(travel / ASKED)) < 1e-9
    result = np.array(found)[asked].T
    print(f"  size {size}: {mesh.ncells} elements, {len(travel)} increments,",
          f"{perf_counter() - began:.0f} s", rounded(result[1]), flush=True)  # fmt: skip
    return result


def main():
    runs = {size: press(DISC, size) for size in SIZES}
    coarse, before, finest = (runs[SIZES[i]][1:] for i in (0, -2, -1))
    stiff = replace(DISC, normal_penalty=5.0 * DISC.normal_penalty)
    name = "softening_disc"
    Path(__file__).with_name(f"{name}.json").unlink(missing_ok=True)
    found = {
        "travel_mm": runs[SIZES[-1]][0],
        "force_N_per_m": finest[0],
        "peak_kPa": finest[1],
        "change_of_force_peak_and_height": {
            "mesh": apart(finest, before),
            "increments": apart(coarse, press(DISC, SIZES[0], 2 * PER_MM)[1:]),
            "penalty": apart(coarse, press(stiff, SIZES[0])[1:]),
        },
        "meshes_N_per_m": {f"elements of {size} mm": run[1] for size, run in runs.items()},
    }
    about = {
        "section": DISC.section,
        "rubber": {"law": "mooney_rivlin", **DISC.rubber},
        "ogden_roxburgh": SOFTENING,
        "friction": DISC.friction,
        "program_travel_mm": CORNERS,
        "method": METHOD,
        "code": CODE,
    }
    save(name, about | rounded(found))


if __name__ == "__main__":
    main()
