"""Warnings of the optimum of a seal file: limits that it violates with new particles, and limits of a
stress that is meaningless."""

import numpy as np

from seal_mdao import values
from seal_mdao.measures.stress import LargestVonMises, StressNorm, VonMises
from seal_mdao.recording.recorded_optimization import label
from seal_mdao.seals.checks import findings
from seal_mdao.seals.local_states import NEAR
from seal_mdao.structure.particle_stress import particle_stress

VIOLATED = 0.01
"""Violation of a limit with new particles, over the limit, above which it is reported: less is the usual
change of a measure by other particles, as an active limit is met exactly with those of the
optimisation."""
CURE = (
    "the particle spacing is too coarse for these limits: optimise with a smaller spacing "
    "(seal-mdao refine FILE --to 1 chooses one), or tighten the limits by this difference; exclude "
    "singular points from a limit on the stress (away_from_singular of von_mises)"
)


def violated_anew(constraints: dict, anew: dict | None) -> list[str]:
    """Describe the limits that the optimum satisfies with its own particles and violates with new ones,
    in one line.

    Parameters
    ----------
    constraints : dict
        Limits by the name of the measure, as of ``history_figures.limit_numbers``.
    anew : dict of str to ndarray, or None
        Values of the measures with new particles; those of several values are left out.

    Returns
    -------
    list of str
        One text, or none.
    """
    found = []
    for name, row in constraints.items():
        value = np.ravel((anew or {}).get(name, []))
        if value.size != 1:
            continue
        for side, sign, word in (("lower", -1.0, "below"), ("upper", 1.0, "above")):
            limit = row.get(side)
            if limit is None or np.size(limit) != 1 or not np.isfinite(limit):
                continue
            # sign (m - limit) > VIOLATED |limit|; |m| of the optimum in place of a limit of zero
            size = abs(limit) or abs(row["end"])
            # a limit that the optimum violates with its own particles is no matter of new ones
            own, new = (sign * (number - limit) for number in (row["end"], value[0]))
            if own <= VIOLATED * size < new:
                far = abs(value[0] - limit)
                relative = f" by {far / abs(limit):.1%}" if limit else ""
                text = f"{label(name)} {value[0]:.4g} {row['unit']}".rstrip()
                found.append(f"{text} is {word} its limit {limit:.4g}{relative}")
    if not found:
        return []
    return [
        "analysed with newly generated particles, the optimum violates its limits: "
        f"{', '.join(found)}; {CURE}"
    ]


def meaningless_limits(result, measures) -> list[str]:
    """Describe limits of stresses whose largest stress is at a point where it is meaningless.

    Parameters
    ----------
    result : SealResult
        Of the optimum, completed.
    measures : sequence of Measure
        Those that the optimisation minimises or limits.

    Returns
    -------
    list of str
    """
    if not result.converged:
        return []
    points = [own.place for own in findings(result.path) if own.place is not None]
    found = []
    for measure in measures:
        place = _largest_at(result, measure)
        if place is None:
            continue
        # distance of two neighbouring particles there
        near = np.sort(np.hypot(*(result.particles - place).T))[:2]
        if any(np.hypot(*(place - own)) <= NEAR * near.sum() for own in points):
            found.append(
                f"{label(measure.name)} of the optimisation is largest at "
                f"{values.place(place)} (undeformed coordinates), a point at which the "
                "stress is meaningless (see the other warnings), so the optimum depends on a "
                "limit without physical meaning; exclude this point from the measure "
                "(away_from_singular of von_mises)"
            )
    return found


def _largest_at(result, measure) -> np.ndarray | None:
    """Find the undeformed point of the largest stress of a measure, mm; None for other measures."""
    seal = result.seal
    if isinstance(measure, LargestVonMises):
        points = measure.points(seal)
    elif isinstance(measure, StressNorm | VonMises):
        points = np.arange(len(result.particles)) if measure.points is None else measure.points
    else:
        return None
    points = np.array(points, int)
    stress = particle_stress(result.path, points).value
    # NaN counts as the largest
    worst = points[int(np.argmax(np.where(np.isnan(stress), np.inf, stress)))]
    return seal.body.samples.at(result.particles)[worst]
