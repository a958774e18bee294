"""Error of every measure by the contact penalties, estimated from exact derivatives.

With a penalty w a measure m errs by m(w) - m(infinity) = c/w + O(1/w^2). Its derivative in w is
-c/w^2, so the error is -w dm/dw: one direct sweep with as many right-hand sides as there are penalties,
or none where the result has the ``gradients`` of its measures.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import STICK
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.contact.self_contact import SelfContact, SelfContactTerm
from seal_mdao.dsa.parameters import parameter_rates
from seal_mdao.dsa.sensitivity import Wanted, direct_rates
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.profiles import contacts, moved_edges

NORMAL, TANGENT = "normal_penalty", "tangent_penalty"
SMALL_LENGTH = 0.01
"""Fraction of the largest displacement below which a length (a gap, a width) counts as zero."""
SMALL = 0.01
"""Fraction of its largest value along the path below which a measure at the end counts as zero."""
WARNED, CURED = 0.01, 0.001
"""Relative error of a measure above which a warning is given, and that with the advised penalties."""
VALID = 0.5
"""Largest relative error for which the linear estimate is valid to about a factor of two."""


class Penalty(NamedTuple):
    """Penalty parameter of a contact.

    Attributes
    ----------
    name : str
        Of the parameter, in ``Seal.scalars``.
    kind : {"normal_penalty", "tangent_penalty"}
    contact : str
        Label of the contact.
    value : float
        kPa/mm.
    """

    name: str
    kind: str
    contact: str
    value: float


def penalties_of(seal) -> tuple[Penalty, ...]:
    """List all penalties of the contacts of a seal."""
    found = []
    for term in seal.terms():
        if isinstance(term, RigidContact | SelfContact):
            # names as in Seal.scalars
            prefix = term.prefix if isinstance(term, RigidContact) else f"{term.label}_"
            for kind in (NORMAL, TANGENT):
                found.append(Penalty(prefix + kind, kind, term.label, getattr(term.law, kind)))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class PenaltyError:
    """Estimated error of a measure by the contact penalties.

    Attributes
    ----------
    error : ndarray, shape (m,)
        Value minus that with infinite penalties, in the unit of the measure.
    by_penalty : dict of str to ndarray, shape (m,)
        The part of each penalty, by its parameter's name.
    scale : float
        Reference value of the relative error: the largest value, but no less than a length that counts
        as zero, the distance of the contact points for a width, a small fraction of the largest value
        along the path, or for a component of a force the complete force.
    """

    error: np.ndarray
    by_penalty: dict
    scale: float

    @property
    def estimable(self) -> bool:
        """Whether the error is small enough for a linear estimate, at most ``VALID`` of the scale.

        A contact that is about to open has almost no pressure, so its width changes with the penalty
        at an arbitrary rate.
        """
        return abs(self.relative) <= VALID

    @property
    def relative(self) -> float:
        """Relative error of the value with the largest error; negative where the measure is too small.
        Not valid where the error is not ``estimable``."""
        # max_i |error_i| / scale, with its sign
        if not self.error.size or not self.scale > 0.0:
            return 0.0
        return float(self.error[np.abs(self.error).argmax()] / self.scale)

    def part(self, names) -> float:
        """Compute the relative error caused by some of the penalties together."""
        # errors of several penalties add up before the largest is taken
        own = [self.by_penalty[name] for name in names if name in self.by_penalty]
        if not own or not self.scale > 0.0:
            return 0.0
        return float(np.abs(np.sum(own, axis=0)).max(initial=0.0) / self.scale)


def penalty_errors(result, measures=None, scales=None) -> dict[str, PenaltyError]:
    """Estimate the penalty errors of measures at the end of a completed path.

    Parameters
    ----------
    result : SealResult
        Completed; cached factors are reused.
    measures : sequence of Measure, optional
        With frozen evaluation points. When left out: the standard ones of the seal, with points
        selected on this result, and the force on every profile.
    scales : dict of str to float, optional
        Reference values of the measures by name; when left out, those of this result.

    Returns
    -------
    dict of str to PenaltyError
        Empty without contacts.
    """
    own = penalties_of(result.seal)
    if not own:
        return {}
    measures = standard_measures(result) if measures is None else tuple(measures)
    rows, found = _slopes(result, measures, tuple(penalty.name for penalty in own)), {}
    for measure in measures:
        slopes = rows[measure.name]
        # m(w) - m(infinity) = -w dm/dw
        parts = {p.name: -p.value * slopes[:, i] for i, p in enumerate(own)}
        scale = scale_of(measure, result) if scales is None else scales[measure.name]
        found[measure.name] = PenaltyError(np.sum(list(parts.values()), axis=0), parts, scale)
    return found


def _slopes(result, measures, names) -> dict:
    """Derivatives dm/dw in the penalties ``names``, shape (m, n), by the names of the measures."""
    known = result.gradients
    if known is not None:
        columns = [known.parameters.index(name) for name in names]
        return {own.name: np.atleast_2d(known[own.name])[:, columns] for own in measures}
    # direct method: one right-hand side per penalty, dm/dw for all measures
    wanted = Wanted(result, measures)
    none = np.zeros((0, *result.particles.shape))
    return wanted.by_name(direct_rates(result, wanted, parameter_rates(none, names)))


def standard_measures(result) -> tuple[Measure, ...]:
    """List the standard measures of a seal that have values, and the force on every profile, or without
    profiles on moved edges."""
    seal, found = result.seal, {}
    for measure in seal.measures():
        # points selected on this result
        measure = measure.frozen(result) if measure.selects_points else measure
        # measures without points have no value
        base = measure.base if isinstance(measure, Derived) else measure
        if base.size(seal):
            found[measure.name] = measure
    for part in contacts(seal) or moved_edges(seal):
        # force on it, unless the seal has that measure
        name = f"force_on_{part.label}"
        found.setdefault(name, Reaction(part.label, name=name))
    return tuple(found.values())


def scale_of(measure: Measure, result) -> float:
    """Compute the reference value for the relative error of a measure, in its unit
    (``PenaltyError.scale``)."""
    # max |m_i|, at least the size that counts as zero
    value = float(np.abs(result.value(measure)).max(initial=0.0))
    return max(value, least_scale(measure, result))


def least_scale(measure: Measure, result) -> float:
    """Compute the size below which a measure counts as zero, in its unit."""
    own = measure.least_scale(result)
    if own is not None:
        return own
    # lengths, areas and volumes from the largest displacement
    along = result.path.largest_displacement
    small = SMALL_LENGTH * along
    by_units = {"mm": small, "mm**2": small**2, "mm**3": small**2 * along}
    base = measure.base if isinstance(measure, Derived) else measure
    # a value that fell along the path: a fraction of its maximum
    before = SMALL * along_path(measure, result) if base.wants_end else 0.0
    return max(by_units.get(measure.units, 0.0), before)


def along_path(measure: Measure, result) -> float:
    """Compute the largest absolute value of a measure over the ends of the nominal steps."""
    sizes = [np.abs(part.value(measure)).max(initial=0.0) for part in result.up_to_each_step()]
    return float(max(sizes, default=0.0))


def compliance(result, names) -> float:
    """Compute the largest penetration or elastic slip in stick, over the largest displacement.

    Parameters
    ----------
    names : container of str
        Penalties to consider.
    """
    found, steps = 0.0, result.path.nominal_steps
    for penalty in penalties_of(result.seal):
        # normal: p / w_n is the penetration; tangential: tau / w_t the elastic slip
        if penalty.name in names:
            term, place = result.term(penalty.contact), result.path.index_of(penalty.contact)
            given = _penetration if penalty.kind == NORMAL else _elastic_slip
            found = max([found, *(given(term, step.responses[place]) for step in steps)])
    size = result.path.largest_displacement
    return found / size if size > 0.0 else 0.0


def _penetration(term, response) -> float:
    """Compute the largest penetration of the points, mm."""
    gaps = term.gaps(response.x)[1] if isinstance(term, SelfContactTerm) else response.gap
    return float(-gaps.min(initial=0.0))


def _elastic_slip(term, response) -> float:
    """Compute the largest elastic slip of the points in stick, mm."""
    # third history variable: elastic slip carried
    slips = response.history.variables[response.branch == STICK, 2]
    return float(np.abs(slips).max(initial=0.0))


def not_estimable(errors: dict[str, PenaltyError]) -> str:
    """Name the measures without an estimate in a message; empty where all have one."""
    names = ", ".join(name for name, found in errors.items() if not found.estimable)
    return f"{names} not estimable: contact is about to separate" if names else ""


def warnings_of(result) -> tuple[str, ...]:
    """Warn of measures with penalty errors above ``WARNED``, and of those without an estimate, one line
    each."""
    # errors that are estimable and too large
    large = {
        name: found
        for name, found in result.penalty_error.items()
        if abs(found.relative) > WARNED and found.estimable
    }
    lines = [] if not large else [_large_errors(result, large)]
    unknown = not_estimable(result.penalty_error)
    if unknown:
        lines.append(
            f"numerical error due to the contact penalties: {unknown}, or the penalties are far too "
            "small; repeat the analysis with ten times the penalties and compare"
        )
    return tuple(lines)


def _large_errors(result, large: dict[str, PenaltyError]) -> str:
    """Report size and sign of the errors of measures, and sufficient penalties."""
    values = {own.name: result.value(own) for own in standard_measures(result) if own.name in large}
    changes = ", ".join(
        f"{name} {100.0 * abs(found.relative):.2g} % {_sense(values[name], found.error)}"
        for name, found in large.items()
    )
    said = f"the contact penalties permit penetration, which makes {changes}, as estimated"
    chosen, cures = chosen_penalties(result.seal), []
    # error ~ 1/w: w_new = w (error / CURED)
    for penalty in penalties_of(result.seal):
        part = max(found.part([penalty.name]) for found in large.values())
        if part > CURED and penalty.name not in chosen:
            wanted = penalty.value * part / CURED
            cures.append(f"{penalty.name} = {penalty.value:.2g} (at least {wanted:.1g})")
    advice = [f"use larger penalties, in kPa/mm: {', '.join(cures)}"] if cures else []
    if not cures or max(found.part(chosen) for found in large.values()) > WARNED:
        advice.append(
            "with penalties larger than those chosen the iterations converge poorly; use less travel, "
            "smaller load steps or a finer spacing in the contact zone"
        )
    return "; ".join([said, *advice])


def _sense(values: np.ndarray, errors: np.ndarray) -> str:
    """Describe the sign of the largest error; of a negative value, that of its magnitude."""
    index = np.abs(errors).argmax()
    negative = values[index] < 0.0
    # an error above 0 brings a negative value nearer to 0
    sense = "large" if (errors[index] > 0.0) != negative else "small"
    return f"too {sense}{' in magnitude' if negative else ''}"


def chosen_penalties(seal) -> dict[str, float]:
    """Return the penalties that were chosen for the seal of a file, kPa/mm by name."""
    return (seal.description or {}).get("chosen", {}).get("penalties", {})
