"""Central differences of whole load paths, on the same contact sequence, for several steps."""

from itertools import pairwise

import numpy as np

from seal_mdao.measures.stress import von_mises_at
from seal_mdao.verification.differences import perturbed, same_sequence

MEASURES = ("von_mises", "gap", "gap_square_sum", "reaction")


def measured(result, points):
    """The measures at the end of a path, taken at the frozen ``points``."""
    table = result.path.discretization.table_at(points.stress).table
    gap = result.end.gap[points.gap]
    return {
        "von_mises": von_mises_at(table, result.end.d, result.model.material)[0],
        "gap": gap,
        "gap_square_sum": np.array([gap @ gap]),
        "reaction": result.reaction[-1],
    }


def quotient(result, points, name, step, sides=(1, -1)):
    """Second-order difference quotient; central, or one-sided with sides (1, 2) or (-1, -2)."""
    near, far = (perturbed(result, name, s * step) for s in sides)
    if not (same_sequence(near, result) and same_sequence(far, result)):
        return None
    here, near, far = (measured(r, points) for r in (result, near, far))
    if sides == (1, -1):
        return {k: (near[k] - far[k]) / (2 * step) for k in MEASURES}
    return {k: (4 * near[k] - far[k] - 3 * here[k]) / (2 * sides[0] * step) for k in MEASURES}


def column(sensitivities, name):
    """The analytic derivatives with respect to one parameter."""
    p = sensitivities.parameters.index(name)
    return {k: np.atleast_2d(getattr(sensitivities, k))[:, p] for k in MEASURES}


def row_scale(sensitivities, name, count):
    """What errors are relative to: the entry, or its row's largest one where it is nearly zero.

    Rows run over the first ``count`` parameters, which have the same unit.
    """
    scale, exact = {}, column(sensitivities, name)
    for k in MEASURES:
        table = np.abs(np.atleast_2d(getattr(sensitivities, k))[:, :count])
        largest = table.max(axis=1) if table.size else np.zeros(len(table))
        scale[k] = np.where(np.abs(exact[k]) > 1e-2 * largest, np.abs(exact[k]), largest)
    return scale


def plateau(result, points, name, steps, sides=(1, -1)):
    """Quotients for falling steps; of the two neighbours that agree best, that of the smaller step.

    The choice does not look at the analytic value. All paths must keep the contact sequence.
    """
    found = [quotient(result, points, name, step, sides) for step in steps]
    kept = [q for q in found if q is not None]
    assert len(kept) >= 2, f"{name}: the contact sequence changes at steps {steps}"
    best = {}
    for k in MEASURES:
        change = [np.abs(b[k] - a[k]).max(initial=0.0) for a, b in pairwise(kept)]
        best[k] = kept[1 + int(np.argmin(change))][k]
    return best


def errors(found, exact, scale):
    """Worst relative error of every measure."""
    return {k: (np.abs(found[k] - exact[k]) / scale[k]).max(initial=0.0) for k in MEASURES}


def own_scale(exact):
    """Largest entry of each measure, for one parameter alone."""
    return {k: np.full(v.shape, np.abs(v).max(initial=1e-300)) for k, v in exact.items()}
