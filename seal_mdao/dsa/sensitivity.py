"""Sensitivities of the seal's measures: one table, direct or adjoint."""

from dataclasses import dataclass, field

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.design.area import section_area
from seal_mdao.dsa.adjoint import AdjointGradient, AdjointSweep
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.linearization import point_table_rates
from seal_mdao.dsa.parameters import ParameterRates, parameter_rates
from seal_mdao.dsa.point_rates import gradient_rates
from seal_mdao.measures.catalogue import FURTHER_MEASURES, check_measures, end_functional
from seal_mdao.measures.functional import Functional, stacked
from seal_mdao.rkpm.tables import PointTable
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
    further : dict of str to ndarray, shape (m, P)
        Of the optional measures asked for.
    """

    parameters: tuple
    von_mises: np.ndarray
    gap: np.ndarray
    gap_square_sum: np.ndarray
    reaction: np.ndarray
    area: np.ndarray | None
    further: dict = field(default_factory=dict)


def path_problem(result: SealResult) -> PathProblem:
    """The problem that a result solved."""
    model = result.model
    return PathProblem(
        result.path.discretization, model.material, model.profile(result.door_radius), model.law
    )


@one_blas_thread
def differentiate(
    result: SealResult, scalars=("door_radius",), method: str = "auto", measures=()
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
    measures : sequence of str
        Names out of ``FURTHER_MEASURES``.

    Returns
    -------
    Sensitivities
        Columns: the boundary offsets, then the scalars.

    Raises
    ------
    ValueError
        Unknown method, parameter or measure.
    LoadPathError
        For a path that was not completed.
    """
    if method not in METHODS:
        raise ValueError(f"method must be one of {METHODS}, got {method!r}")
    check_measures("measures", measures)
    result.require_converged()
    rates = parameter_rates(result.model, scalars)
    wanted = _Wanted.of(result, measures)
    if method == "auto":
        method = "adjoint" if wanted.functional.count < rates.count else "direct"
    if method == "direct":
        table = direct_rates(result, wanted, rates)
    else:
        table = _contracted(adjoint_gradient(result, wanted), rates)
    area = None
    if result.boundary_offsets is not None:
        area = np.zeros(rates.count)
        gradient = section_area(result.model.splines, result.boundary_offsets)[1]
        area[: gradient.size] = gradient
    rows = wanted.by_name(table)
    square = 2.0 * result.gap @ rows["gap"]
    return Sensitivities(
        rates.names, rows["von_mises"], rows["gap"], square, rows["reaction"], area,
        {name: rows[name] for name in measures},
    )  # fmt: skip


def measure_count(result: SealResult) -> int:
    """Right-hand sides of the adjoint method: stresses, gaps and the two reactions."""
    return len(result.points.stress) + len(result.points.gap) + 2


def measured(result: SealResult, name: str) -> np.ndarray:
    """Value of one of the ``FURTHER_MEASURES``."""
    return FURTHER_MEASURES[name].of(result, result.path.discretization.everywhere).values


@one_blas_thread
def particle_gradient(
    result: SealResult, scalars=("door_radius",), method: str = "auto", measures=()
) -> dict:
    """Derivatives of the end measures with respect to every particle and scalar parameters.

    Parameters
    ----------
    result : SealResult
    scalars : sequence of str
        As for ``differentiate``.
    method : {"auto", "direct", "adjoint"}
        "auto" takes the method with fewer right-hand sides.
    measures : sequence of str
        Names out of ``FURTHER_MEASURES``.

    Returns
    -------
    dict of str to dict of str to ndarray
        By input ("particles" and the scalars), then by measure (von_mises, gap, gap_square_sum,
        reaction, and those asked for): shape (m, n, 2) for the particles, (m, 1) for a scalar.
    """
    n, wanted = len(result.particles), _Wanted.of(result, measures)
    if method == "auto":
        method = "adjoint" if wanted.functional.count < 2 * n + len(scalars) else "direct"
    if method == "adjoint":
        gradient = adjoint_gradient(result, wanted)
        rows = gradient.particles
        columns = scalar_columns(gradient, parameter_rates(result.model, scalars))
    else:
        unit = np.eye(2 * n).reshape(2 * n, n, 2)
        table = direct_rates(result, wanted, parameter_rates(result.model, scalars, unit))
        rows, columns = table[:, : 2 * n].reshape(-1, n, 2), table[:, 2 * n :]
    by_input = {"particles": wanted.by_name(rows)}
    for place, name in enumerate(scalars):
        by_input[name] = wanted.by_name(columns[:, place : place + 1])
    for table in by_input.values():
        table["gap_square_sum"] = 2.0 * np.tensordot(result.gap, table["gap"], 1)[None]
    return by_input


@dataclass(frozen=True, eq=False)
class _Wanted:
    """The measures to differentiate.

    Attributes
    ----------
    functional : Functional
    table : PointTable
        Particles whose F it takes.
    sizes : dict of str to int
        Rows of every measure, in order.
    """

    functional: Functional
    table: PointTable
    sizes: dict

    @classmethod
    def of(cls, result: SealResult, measures):
        disc, points = result.path.discretization, result.points
        sizes = {"von_mises": len(points.stress), "gap": len(points.gap), "reaction": 2}
        if not measures:
            table = disc.table_at(points.stress)
            return cls(end_functional(result, table, np.arange(len(points.stress))), table, sizes)
        table = disc.everywhere
        further = [FURTHER_MEASURES[name].of(result, table) for name in measures]
        sizes |= {name: part.count for name, part in zip(measures, further, strict=True)}
        return cls(stacked([end_functional(result, table, points.stress), *further]), table, sizes)

    def by_name(self, rows) -> dict:
        """Rows of all measures as pieces by name."""
        ends = np.cumsum(list(self.sizes.values()))[:-1]
        return dict(zip(self.sizes, np.split(rows, ends), strict=True))


def direct_rates(result: SealResult, wanted: _Wanted, rates: ParameterRates) -> np.ndarray:
    """Rates of all wanted measures, (M, P), by the direct method."""
    disc, functional, table = result.path.discretization, wanted.functional, wanted.table
    sweep = DirectSweep(result.path, path_problem(result), rates)
    by_place = sweep.run(functional.seeds)
    table_rate = point_table_rates(disc, table, rates.velocity, sweep.shape.matrix)
    out = np.einsum("mni,pni->mp", functional.particles, rates.velocity, optimize=True)
    out += functional.contact @ rates.contact.T + functional.constants @ rates.constants.T
    for place, seeds in functional.seeds.items():
        here = by_place[place]
        out += seeds.gap @ here.gap + np.tensordot(seeds.force, here.force, 2)
        if seeds.gradient.any():
            f_rate = np.empty((table.table.n_groups, 4, rates.count))
            gradient_rates(
                table.table, table_rate, result.path.steps[place].d, disc.layout.equations,
                here.solution, f_rate,
            )  # fmt: skip
            out += np.tensordot(seeds.gradient, f_rate, 2)
    return out


def adjoint_gradient(result: SealResult, wanted: _Wanted) -> AdjointGradient:
    """Gradients of all wanted measures by the adjoint method."""
    functional = wanted.functional
    sweep = AdjointSweep(result.path, path_problem(result), wanted.table, functional.count)
    gradient = sweep.run(functional.seeds)
    return AdjointGradient(
        gradient.particles + functional.particles, gradient.contact + functional.contact,
        gradient.constants + functional.constants, gradient.motion,
    )  # fmt: skip


def scalar_columns(gradient: AdjointGradient, rates: ParameterRates) -> np.ndarray:
    """Derivatives of the adjoint measures with respect to the scalars at the end of ``rates``."""
    first = sum(name.endswith("]") for name in rates.names)
    return (
        gradient.contact @ rates.contact[first:].T
        + gradient.constants @ rates.constants[first:].T
        + gradient.motion @ rates.motion[first:].T
    )


def _contracted(gradient: AdjointGradient, rates: ParameterRates) -> np.ndarray:
    """Adjoint gradients contracted with the parameters' rates, (M, P)."""
    columns = scalar_columns(gradient, rates)
    shape = rates.count - columns.shape[1]
    by_shape = np.tensordot(gradient.particles, rates.velocity[:shape], ((1, 2), (1, 2)))
    return np.hstack([by_shape, columns])
