"""First-order changes of an analysed path: derivatives of all pictures and numbers of the page.

Of every parameter p, in columns, from one direct sweep of Eq. (70) over the path:

    x' = X' + u',    sigma' = (d sigma/dF) F' + (d sigma/d theta) theta',
    p = w_n <-g> L / l,    p' = p (L'/L - l'/l) - w_n g' L / l   where g < 0,
    R' = sum over contact points of s'.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.parameters import parameter_rates
from seal_mdao.dsa.probe import Probe
from seal_mdao.dsa.sensitivity import Wanted, rates_by_sweep
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.plotting.field import FineGrid
from seal_mdao.seals.profiles import contacts, true_pressure
from seal_mdao.seals.result import SealResult
from seal_mdao.structure.particle_stress import deformation_gradients, point_stress


@dataclass(frozen=True, eq=False)
class PathRates:
    """Derivatives of a path with respect to P parameters.

    Attributes
    ----------
    sweep : DirectSweep
    solutions : list of ndarray, shape (n_equations, P)
        d' at every converged step.
    gaps : dict of str to list of ndarray, shape (k, P)
        Of the points of every contact, at every converged step.
    forces : dict of str to list of ndarray, shape (2, P)
        Of the seal on every profile, at every converged step.
    measures : dict of str to ndarray, shape (m, P)
    """

    sweep: DirectSweep
    solutions: list
    gaps: dict
    forces: dict
    measures: dict


@one_blas_thread
def path_rates(result: SealResult, names, measures, watch: Callable) -> PathRates:
    """Differentiate a converged path.

    Parameters
    ----------
    result : SealResult
        With cached factors.
    names : sequence of str
        Scalar parameters; the offsets of the design come before them.
    measures : sequence of Measure
        With selected points.
    watch : callable
        Called at every step; what it raises ends the sweep.
    """
    rates = parameter_rates(result.seal.design_velocity, names)
    sweep, wanted = DirectSweep(result.path, rates), Wanted(result, measures)
    labels = [own.label for own in contacts(result.seal)]
    solutions, kept = [], {}
    gaps = {label: [] for label in labels}
    forces = {label: [] for label in labels}
    for index, found in sweep.each(range(len(result.path.steps))):
        watch()
        solutions.append(found.solution)
        for label in labels:
            term = result.term(label)
            own = found.terms[term.index]
            gaps[label].append(own.outputs[:, term.output_names.index("gap")])
            forces[label].append(own.force.sum(axis=0))
        if index in wanted.stack.seeds:
            kept[index] = found
    rows = wanted.by_name(rates_by_sweep(result, wanted, sweep, kept))
    return PathRates(sweep, solutions, gaps, forces, rows)


@one_blas_thread
def field_rates(result: SealResult, rates: PathRates, fine: FineGrid, step: int):
    """Differentiate deformed coordinates and stress on a fine grid after a nominal step.

    Returns
    -------
    x : ndarray, shape (k, 2, P)
    stress : ndarray, shape (k, P)
        kPa; zero where the law gives no stress.
    """
    path, sweep = result.path, rates.sweep
    disc, velocity = path.discretization, sweep.rates.velocity
    table = disc.sloped_table(fine.points)
    shape, probe = table.rates(velocity, sweep.shape.matrix), Probe(disc, table)
    now, structure = path.nominal_steps[step], result.term("structure")
    # a body with history depends on all steps so far
    last = path.steps.index(now)
    first = 0 if structure.history_dependent else last
    steps = path.steps[first : last + 1]
    f = np.array([deformation_gradients(table.table, own.d) for own in steps])
    stress = point_stress(structure, f, fine.region, steps)
    # X' = sum_k w_k V_k of the anchors
    x = np.einsum("sk,pski->sip", fine.points.weights, velocity[:, fine.points.anchors])
    out = np.zeros((len(fine.region), sweep.rates.count))
    for index, (own, by_gradient) in enumerate(stress.by_gradient, first):
        moved, f_rate = probe.rates(shape, own, rates.solutions[index], sweep.prescribed(own))
        # sigma' += (d sigma/dF) F'
        out += np.einsum("sj,sjp->sp", by_gradient, f_rate)
    for name, by_constant in stress.by_constants.items():
        # sigma' += (d sigma/d theta) theta'
        out += np.outer(by_constant, sweep.rates.of((name,))[0])
    return x + moved, np.nan_to_num(out)


def pressure_rates(result: SealResult, rates: PathRates, contact, step: int) -> np.ndarray:
    """Differentiate the true pressure of the points of a contact after a nominal step, shape (k, P)."""
    path, where, velocity = result.path, contact.where, rates.sweep.rates.velocity
    now = path.nominal_steps[step]
    index = path.steps.index(now)
    gap = path.at_nominal(contact.label)[step].gap
    # u' of the particles, on which l depends
    every = path.discretization.everywhere
    shape = every.rates(velocity, rates.sweep.shape.matrix)
    moved, _ = Probe(path.discretization, every).rates(
        shape, now, rates.solutions[index], rates.sweep.prescribed(now)
    )
    deformed = np.moveaxis(moved, 2, 0) + velocity
    undeformed_length = where.measures(result.particles)
    length = where.measures(result.deformed(step))
    # L'/L - l'/l
    growth = where.measure_rates(result.particles, velocity) / undeformed_length[:, None]
    growth -= where.measure_rates(result.deformed(step), deformed) / length[:, None]
    pressure = true_pressure(result, contact, step)[:, None]
    # p' = p (L'/L - l'/l) - w_n g' L / l
    normal = contact.law.normal_penalty * (undeformed_length / length * (gap < 0.0))[:, None]
    return pressure * growth - normal * rates.gaps[contact.label][index]
