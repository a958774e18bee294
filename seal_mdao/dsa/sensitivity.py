"""Sensitivities of the seal's measures: one table, direct or adjoint."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.dsa.adjoint import AdjointSweep, Seeds
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.linearization import point_table_rates
from seal_mdao.dsa.parameters import ParameterRates, parameter_rates
from seal_mdao.dsa.point_rates import gradient_rates
from seal_mdao.geometry.area import section_area
from seal_mdao.measures.stress import constants_gradient, von_mises_at
from seal_mdao.seal import SealResult

METHODS = ("auto", "direct", "adjoint")


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of the end measures with respect to P parameters.

    Attributes
    ----------
    parameters : tuple of str
    von_mises : ndarray, shape (7, P)
    gap : ndarray, shape (n_gap, P)
    gap_square_sum : ndarray, shape (P,)
    reaction : ndarray, shape (2, P)
        At the end of the path.
    area : ndarray, shape (P,), or None
        None when the parameters are not the boundary offsets.
    """

    parameters: tuple
    von_mises: np.ndarray
    gap: np.ndarray
    gap_square_sum: np.ndarray
    reaction: np.ndarray
    area: np.ndarray | None


def path_problem(result: SealResult) -> PathProblem:
    """The problem that a result solved."""
    model = result.model
    return PathProblem(
        result.path.discretization, model.material, model.profile(result.door_radius), model.law
    )


def differentiate(
    result: SealResult, scalars=("door_radius",), method: str = "auto"
) -> Sensitivities:
    """Exact derivatives of the end measures with respect to boundary offsets and scalars.

    Parameters
    ----------
    result : SealResult
        A converged analysis; with ``keep_factors`` its factors are used again.
    scalars : sequence of str
        Further parameters: door_radius, normal_penalty, tangent_penalty, friction, c10, c01,
        bulk_modulus, depth.
    method : {"auto", "direct", "adjoint"}
        "auto" takes the method with fewer right-hand sides.

    Returns
    -------
    Sensitivities
        Columns: the boundary offsets, then the scalars.

    Raises
    ------
    ValueError
        Unknown method or parameter.
    LoadPathError
        For a path that was not completed.
    """
    if method not in METHODS:
        raise ValueError(f"method must be one of {METHODS}, got {method!r}")
    result.require_converged()
    rates = parameter_rates(result.model, scalars)
    if method == "auto":
        method = "adjoint" if measure_count(result) < rates.count else "direct"
    if method == "direct":
        stress, gap, reaction = direct_rates(result, rates)
    else:
        stress, gap, reaction = _contracted(result, rates)
    area = None
    if result.boundary_offsets is not None:
        area = np.zeros(rates.count)
        gradient = section_area(result.model.splines, result.boundary_offsets)[1]
        area[: gradient.size] = gradient
    square = 2.0 * result.gap @ gap
    return Sensitivities(rates.names, stress, gap, square, reaction, area)


def measure_count(result: SealResult) -> int:
    """Right-hand sides of the adjoint method: stresses, gaps and the two reactions."""
    return len(result.points.stress) + len(result.points.gap) + 2


def particle_gradient(result: SealResult, scalars=("door_radius",), method: str = "auto") -> dict:
    """Derivatives of the end measures with respect to every particle and scalar parameters.

    Parameters
    ----------
    result : SealResult
    scalars : sequence of str
        As for ``differentiate``.
    method : {"auto", "direct", "adjoint"}
        "auto" takes the method with fewer right-hand sides.

    Returns
    -------
    dict of str to dict of str to ndarray
        By input ("particles" and the scalars), then by measure (von_mises, gap, gap_square_sum,
        reaction): shape (m, n, 2) for the particles, (m, 1) for a scalar.
    """
    n = len(result.particles)
    if method == "auto":
        method = "adjoint" if measure_count(result) < 2 * n + len(scalars) else "direct"
    if method == "adjoint":
        gradient = adjoint_gradient(result)
        rows = gradient.particles
        columns = scalar_columns(gradient, parameter_rates(result.model, scalars))
    else:
        unit = np.eye(2 * n).reshape(2 * n, n, 2)
        table = np.concatenate(direct_rates(result, parameter_rates(result.model, scalars, unit)))
        rows, columns = table[:, : 2 * n].reshape(-1, n, 2), table[:, 2 * n :]
    by_input = {"particles": _by_measure(result, rows)}
    for place, name in enumerate(scalars):
        by_input[name] = _by_measure(result, columns[:, place : place + 1])
    for table in by_input.values():
        table["gap_square_sum"] = 2.0 * np.tensordot(result.gap, table["gap"], 1)[None]
    return by_input


def _by_measure(result, rows) -> dict:
    """Rows of stresses, gaps and reactions by name."""
    n_stress = len(result.points.stress)
    return {"von_mises": rows[:n_stress], "gap": rows[n_stress:-2], "reaction": rows[-2:]}


def direct_rates(result: SealResult, rates: ParameterRates):
    """Rates of von Mises stresses (s, P), gaps (g, P) and end reaction (2, P), direct method."""
    disc, step = result.path.discretization, result.end
    sweep = DirectSweep(result.path, path_problem(result), rates)
    end = sweep.run()[len(result.path.steps) - 1]
    table = disc.table_at(result.points.stress)
    table_rate = point_table_rates(disc, table, rates.velocity, sweep.shape.matrix)
    f_rate = np.empty((table.table.n_groups, 4, rates.count))
    gradient_rates(table.table, table_rate, step.d, disc.layout.equations, end.solution, f_rate)
    material = result.model.material
    by_gradient = von_mises_at(table.table, step.d, material)[1]
    stress = np.einsum("sr,srp->sp", by_gradient, f_rate)
    stress += constants_gradient(table.table, step.d, material) @ rates.constants.T
    return stress, end.gap[result.points.gap], end.reaction


def adjoint_gradient(result: SealResult):
    """Gradients of stresses, gaps and reactions (in this order) by the adjoint method."""
    step, points = result.end, result.points
    disc, m = result.path.discretization, measure_count(result)
    n_stress, n_gap = len(points.stress), len(points.gap)
    table = disc.table_at(points.stress)
    seeds = Seeds(
        np.zeros((m, len(step.gap))), np.zeros((m, len(step.gap), 2)), np.zeros((m, n_stress, 4))
    )
    by_gradient = von_mises_at(table.table, step.d, result.model.material)[1]
    seeds.gradient[np.arange(n_stress), np.arange(n_stress)] = by_gradient
    seeds.gap[n_stress + np.arange(n_gap), points.gap] = 1.0
    for c in range(2):
        seeds.force[m - 2 + c, :, c] = 1.0
    sweep = AdjointSweep(result.path, path_problem(result), table, m)
    gradient = sweep.run({len(result.path.steps) - 1: seeds})
    gradient.constants[:n_stress] += constants_gradient(table.table, step.d, result.model.material)
    return gradient


def scalar_columns(gradient, rates: ParameterRates) -> np.ndarray:
    """Derivatives of the adjoint measures with respect to the scalars at the end of ``rates``."""
    first = sum(name.endswith("]") for name in rates.names)
    return (
        gradient.contact @ rates.contact[first:].T
        + gradient.constants @ rates.constants[first:].T
        + gradient.motion @ rates.motion[first:].T
    )


def _contracted(result: SealResult, rates: ParameterRates):
    """Adjoint gradients contracted with the parameters' rates."""
    gradient = adjoint_gradient(result)
    columns = scalar_columns(gradient, rates)
    shape = rates.count - columns.shape[1]
    by_shape = np.einsum("mni,pni->mp", gradient.particles, rates.velocity[:shape])
    table = np.hstack([by_shape, columns])
    n_stress = len(result.points.stress)
    return table[:n_stress], table[n_stress:-2], table[-2:]
