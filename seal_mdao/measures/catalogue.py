"""The measures of a seal by name: values, seeds for the sensitivities, units."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.measures.aggregates import lehmer_mean, opened_square_integral, p_norm
from seal_mdao.measures.functional import Functional, functional, no_seeds, stacked
from seal_mdao.measures.stress import constants_gradient, von_mises_at
from seal_mdao.rkpm.tables import PointTable


@dataclass(frozen=True)
class FurtherMeasure:
    """An optional output.

    Attributes
    ----------
    units, text : str
    of : callable
        ``of(result, table)`` gives the ``Functional``; ``table`` holds all particles.
    """

    units: str
    text: str
    of: object


def end_functional(result, table: PointTable, rows) -> Functional:
    """Von Mises stresses, gaps and the two reactions at the end of the path.

    Parameters
    ----------
    table : PointTable
        Particles, one a group.
    rows : ndarray of int
        Places of the stress particles in it.
    """
    gaps = _of_end(result, table, len(result.points.gap))
    seeds = gaps[1]
    seeds.gap[np.arange(len(result.points.gap)), result.points.gap] = 1.0
    forces, force_seeds = result.end.reaction, _of_end(result, table, 2)[1]
    for c in range(2):
        force_seeds.force[c, :, c] = 1.0
    n, last = len(result.particles), _last(result)
    return stacked([
        _stresses(result, table, rows),
        functional(result.gap, {last: seeds}, n),
        functional(forces, {last: force_seeds}, n),
    ])  # fmt: skip


def _last(result) -> int:
    return len(result.path.steps) - 1


def _of_end(result, table, count):
    """The last place in the path, and zero seeds there."""
    return _last(result), no_seeds(count, len(result.end.gap), table.table.n_groups)


def _stresses(result, table, rows) -> Functional:
    """Von Mises stress at ``rows`` of a table."""
    last, seeds = _of_end(result, table, len(rows))
    stress, by_gradient = von_mises_at(table.table, result.end.d, result.model.material)
    seeds.gradient[np.arange(len(rows)), rows] = by_gradient[rows]
    constants = constants_gradient(table.table, result.end.d, result.model.material)[rows]
    return functional(stress[rows], {last: seeds}, len(result.particles), constants=constants)


def _stress_norm(result, table) -> Functional:
    """p-norm of the von Mises stress of all particles."""
    material, d = result.model.material, result.end.d
    stress, by_gradient = von_mises_at(table.table, d, material)
    value, weight = p_norm(stress)
    last, seeds = _of_end(result, table, 1)
    seeds.gradient[0] = weight[:, None] * by_gradient
    constants = weight @ constants_gradient(table.table, d, material)
    return functional(value, {last: seeds}, len(result.particles), constants=constants[None])


def _patch_pressure(result, table) -> Functional:
    """Mean of high order of the contact pressure w_n |g_n| of each patch."""
    patches, gap = result.points.patches, result.end.gap
    last, seeds = _of_end(result, table, len(patches))
    penalty, values = result.model.normal_penalty, np.empty(len(patches))
    for m, patch in enumerate(patches):
        values[m], weight = lehmer_mean(penalty * np.maximum(-gap[patch], 0.0))
        seeds.gap[m, patch] = -penalty * weight * (gap[patch] < 0.0)
    contact = np.zeros((len(patches), 4))
    contact[:, 1] = values / penalty
    return functional(values, {last: seeds}, len(result.particles), contact=contact)


def _gap_square_integral(result, table) -> Functional:
    """Integral of g^2 over the undeformed boundary that stands open in the frozen stretch."""
    stretch = result.points.stretch
    particle = result.model.body.contact[stretch]
    edges = np.diff(result.particles[particle], axis=0)
    length = np.hypot(*edges.T)
    value, by_gap, by_length = opened_square_integral(result.end.gap[stretch], length)
    last, seeds = _of_end(result, table, 1)
    seeds.gap[0, stretch] = by_gap
    pull = (by_length / length)[:, None] * edges
    particles = np.zeros((1, *result.particles.shape))
    particles[0, particle[1:]] += pull
    particles[0, particle[:-1]] -= pull
    return functional(value, {last: seeds}, len(result.particles), particles=particles)


def _reaction_curve(result, table) -> Functional:
    """Vertical reaction after the nominal steps of the frozen points."""
    nominal = result.points.curve
    place = {s.nominal: i for i, s in enumerate(result.path.steps) if s.nominal >= 0}
    seeds = {}
    for m, step in enumerate(nominal):
        seeds[place[step]] = _of_end(result, table, len(nominal))[1]
        seeds[place[step]].force[m, :, 1] = 1.0
    return functional(result.reaction[nominal, 1], seeds, len(result.particles))


FURTHER_MEASURES = {
    "gap_square_integral": FurtherMeasure(
        "mm**3",
        "Integral of the squared gap over the opened stretch, hardly dependent on the refinement.",
        _gap_square_integral,
    ),
    "stress_norm": FurtherMeasure(
        "kPa", "p-norm of the von Mises stress of all particles, an upper bound.", _stress_norm
    ),
    "patch_pressure": FurtherMeasure(
        "kPa",
        "Contact pressure of each patch, a mean of high order below the peak.",
        _patch_pressure,
    ),
    "reaction_curve": FurtherMeasure(
        "N/m", "Vertical reaction at 2, 4, 6, 8 and 10 mm of travel.", _reaction_curve
    ),
}
"""Optional measures by name."""


def check_measures(name: str, value) -> None:
    """Option check: a sequence of different known names.

    Raises
    ------
    ValueError
        For an unknown or repeated name.
    """
    if isinstance(value, str):
        raise ValueError(f"option {name!r} must be a sequence of names, got the string {value!r}")
    unknown = [item for item in value if item not in FURTHER_MEASURES]
    if unknown:
        raise ValueError(
            f"option {name!r}: unknown measure {unknown[0]!r}; known are "
            f"{', '.join(FURTHER_MEASURES)}"
        )
    if len(set(value)) < len(value):
        raise ValueError(f"option {name!r} names a measure twice: {tuple(value)}")
