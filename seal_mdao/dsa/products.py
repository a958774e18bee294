"""Products of the Jacobian of measures with vectors, without the Jacobian: J v and J^T w."""

from dataclasses import fields, replace

import numpy as np

from seal_mdao.dsa.adjoint import AdjointGradient
from seal_mdao.dsa.parameters import ParameterRates
from seal_mdao.dsa.sensitivity import Wanted, adjoint_gradient, direct_rates
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.measures.measure import Derived, Stack


@one_blas_thread
def jvp(result, measures, rates: ParameterRates) -> dict:
    """Multiply the Jacobian of measures with directions of the design: one direct sweep.

    Parameters
    ----------
    result : SealResult
        A converged analysis.
    measures : sequence of Measure or str
        As ``differentiate`` takes them.
    rates : ParameterRates
        P directions: velocities of the particles (P, n, 2) and rates of scalar parameters.

    Returns
    -------
    dict of str to ndarray, shape (m, P)
        By the names of the measures.
    """
    wanted = Wanted(result, result.measures(measures))
    return wanted.by_name(direct_rates(result, wanted, rates))


@one_blas_thread
def vjp(result, weights: dict, names=()) -> AdjointGradient:
    """Multiply the transposed Jacobian with weights of measures: one adjoint sweep with R
    right-hand sides, independent of the number of values of the measures.

    Parameters
    ----------
    result : SealResult
        A converged analysis.
    weights : dict of Measure or str to ndarray, shape (R, m)
        Of the values of every measure.
    names : sequence of str
        Scalar parameters.

    Returns
    -------
    AdjointGradient
        Of the R sums, in all particles and the parameters.
    """
    wanted = Wanted(result, result.measures(tuple(weights)))
    of_bases = [0.0] * len(wanted.bases)
    for measure, own in zip(wanted.measures, weights.values(), strict=True):
        base = measure.base if isinstance(measure, Derived) else measure
        index, own = wanted.bases.index(base), np.atleast_2d(own)
        # m = g(values): w dg/dvalues on the independent values
        if isinstance(measure, Derived):
            own = own * measure.value(wanted.values[index])[1]
        of_bases[index] = of_bases[index] + own
    wanted.stack = _mixed(wanted.stack, np.hstack(of_bases))
    return adjoint_gradient(result, wanted, names)


def _mixed(stack: Stack, weights: np.ndarray) -> Stack:
    """The measures of a stack mixed by ``weights`` (R, M)."""

    def mixed(part):
        """Of an array (M, ...), or of all of them in a dictionary or a dataclass."""
        if isinstance(part, dict):
            return {key: mixed(own) for key, own in part.items()}
        if isinstance(part, np.ndarray):
            # sum_m w_rm part_m
            return np.tensordot(weights, part, 1)
        return type(part)(*(mixed(getattr(part, field.name)) for field in fields(part)))

    return replace(
        stack, count=len(weights), seeds=mixed(stack.seeds), particles=mixed(stack.particles),
        parameters=mixed(stack.parameters),
    )  # fmt: skip
