"""A viscoelastic rubber for FElupe, and a block of it in homogeneous states.

Not run by the tests. It writes ``viscoelastic_block.json`` beside it, with the packages that
``felupe_contact`` names::

    OMP_NUM_THREADS=1 MKL_NUM_THREADS=1 fe/bin/python felupe_viscoelastic.py

Finite linear viscoelasticity of the isochoric part (Simo 1987; Holzapfel 2000, Sec. 6.10), with the
long-term law W, one internal variable Q_i for each Prony term and step, and S_iso = F^-1 dW/dF:

    Q_i+ = exp(-dt/tau_i) Q_i + beta_i exp(-dt/(2 tau_i)) (S_iso+ - S_iso),  beta_i = g_i / (1 - sum g)
    P_iso = dW/dF + F sum_i Q_i+.

The block is compressed to 0.8 of its height within 1 s, stays so for 100 s and is stretched back to its
height within 1 s, with free sides, in plane strain and in uniaxial compression. Its bulk modulus is so
high that it is incompressible to 1e-6. Stresses in kPa, times in s.
"""

import json
from itertools import pairwise
from pathlib import Path

import felupe as fem
import numpy as np
from felupe.math import inv
from felupe_contact import CODE, SOFT, mooney_rivlin, three_fields
from felupe_pressure import rounded

G, TAU = [0.3, 0.2], [1.0, 50.0]
"""Prony terms of the block."""
BULK = 1e8
TIME, STRETCH = [0.0, 1.0, 101.0, 102.0], [1.0, 0.8, 0.8, 1.0]
"""Corners of the program of the block."""
ASKED = [0.5, 1.0, 2.0, 11.0, 101.0, 101.5, 102.0]
STEPS = [20, 40, 80]
"""Increments of a second in which the block moves."""
GROWTH = 1.25
"""Of the increments of a dwell."""


class Viscoelastic(fem.ConstitutiveMaterial):
    """Isochoric law that relaxes; its state variables are the time, S_iso and Q_i of the last step.

    Parameters
    ----------
    law : felupe.ConstitutiveMaterial
        Isochoric law of the long term.
    g, tau : list of float
        Prony terms: ratios of the instantaneous modulus and times, s.
    """

    def __init__(self, law, g, tau):
        self.law, self.tau = law, np.array(tau)
        self.beta = np.array(g) / (1.0 - sum(g))
        self.time = 0.0
        self.x = [np.eye(3), np.zeros(1 + 9 * (1 + len(tau)))]

    def update(self, time):
        """Set the time of the next equilibrium: the material is an item of a ramp."""
        self.time = time

    def _parts(self, statevars):
        """exp(-dt/tau_i) Q_i - beta_i exp(-dt/(2 tau_i)) S_iso, and beta_i exp(-dt/(2 tau_i))."""
        before = statevars[1:].reshape(-1, 3, 3, *statevars.shape[1:])
        tau, beta = (own[:, None, None] for own in (self.tau, self.beta))
        dt = self.time - statevars[0]
        factor = beta * np.exp(-0.5 * dt / tau)
        factor = factor[:, None, None]
        decay = np.exp(-dt / tau)[:, None, None]
        return decay * before[1:] - factor * before[0], factor

    def _gradient(self, x):
        F, statevars = x[0], x[-1]
        P = self.law.gradient([F, statevars])[0]
        S = np.einsum("ik...,kj...->ij...", inv(F), P)
        carried, factor = self._parts(statevars)
        Q = carried + factor * S
        new = np.concatenate([S[None], Q]).reshape(-1, *statevars.shape[1:])
        time = np.full_like(new[:1], self.time)
        total = P + np.einsum("ik...,kj...->ij...", F, Q.sum(axis=0))
        return [total, np.concatenate([time, new])]

    def _hessian(self, x):
        F, statevars = x[0], x[-1]
        carried, factor = self._parts(statevars)
        # P = (1 + sum factor) dW/dF + F H,   d(F_im H_mj)/dF_kl = delta_ik H_lj
        A = (1.0 + factor.sum(axis=0)) * self.law.hessian([F, statevars])[0]
        return [A + np.einsum("ik,lj...->ijkl...", np.eye(3), carried.sum(axis=0))]


def dwell(start, end, first, growth):
    """Times after ``start`` up to ``end``; the first increment is ``first``, the others grow."""
    count = max(1, round(np.log(1.0 + (end - start) * (growth - 1.0) / first) / np.log(growth)))
    grown = growth ** np.arange(1, count + 1) - 1.0
    return start + (end - start) * grown / grown[-1]


def block(kind, per_second):
    """Axial nominal stress of one element at the asked times, kPa."""
    mesh = fem.mesh.convert(fem.Rectangle(n=2), order=2, calc_points=True, calc_midfaces=True)
    fields = three_fields(mesh, getattr(fem, kind))
    law = Viscoelastic(mooney_rivlin(SOFT), G, TAU)
    solid = fem.SolidBody(fem.NearlyIncompressible(law, bulk=BULK), fields)
    u = fields[0]
    bounds = {
        "left": fem.Boundary(u, fx=0.0, skip=(False, True)),
        "low": fem.Boundary(u, fy=0.0, skip=(True, False)),
        "move": fem.Boundary(u, fx=1.0, skip=(False, True)),
    }
    ramp = np.arange(1, per_second + 1) / per_second
    first = 1.0 / per_second
    corners, times = sorted({1.0, *(t for t in ASKED if 1.0 < t < 101.0), 101.0}), [ramp]
    for start, end in pairwise(corners):
        # the increments of a dwell are in proportion to the time since 1 s
        times.append(dwell(start, end, max(first, 0.1 * (start - 1.0)), 1.0 + first))
    times = np.concatenate([*times, 101.0 + ramp])
    path = np.interp(times, TIME, STRETCH) - 1.0
    found = {}
    high = mesh.points[:, 0] > 1.0 - 1e-9
    # the face of the block, or of the cylinder of radius one
    area = np.pi if kind == "FieldAxisymmetric" else 1.0

    def keep(context, state):
        force = solid.results.force.toarray()[: u.values.size].reshape(-1, 2)[high, 0].sum()
        found[round(law.time, 9)] = force / area

    step = fem.Step([solid], ramp={bounds["move"]: path, law: times}, boundaries=bounds)
    fem.Job([step], plugins=[keep]).evaluate(x0=fields, verbose=0, tol=1e-8)
    return [found[t] for t in ASKED]


def main():
    kinds = {"plane": "FieldPlaneStrain", "uniaxial": "FieldAxisymmetric"}
    found = {
        "section": "block with free sides, compressed, held and stretched back",
        "rubber": {"law": "mooney_rivlin", **SOFT, "bulk_modulus": BULK, "g": G, "tau": TAU},
        "program_time_s": TIME,
        "program_stretch": STRETCH,
        "time_s": ASKED,
        "nominal_stress_kPa": {
            kind: {f"{n} increments a second": rounded(block(field, n), 10) for n in STEPS}
            for kind, field in kinds.items()
        },
        "code": CODE,
    }
    file = Path(__file__).with_name("viscoelastic_block.json")
    file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
