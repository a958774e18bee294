"""Rule of the contact penalties: raise them until their estimated errors are within a tolerance.

Called by ``steps_and_penalties``; initial values are those of ``contact.default_penalties``. The
estimate (``penalty_error``) falls with the inverse of a penalty. Penalties are therefore raised by the
ratio of error to tolerance, unless the iterations then converge badly, or rounding bounds them.
"""

from dataclasses import replace

import numpy as np

from seal_mdao.seals.penalty_error import compliance, penalties_of
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.seal import Seal

CORRECTIONS = 4
"""Largest number of times that the penalties are raised."""
COSTLY = 2.0
"""Largest ratio of iterations per load step of a path with higher penalties to that before."""
SURPLUS = 1.5
"""Factor on the ratio of error to tolerance by which a penalty is raised."""
RELATIVE_ROUNDING = 1e-10
"""Largest rounding error of the contact pressure over the shear modulus; it bounds the penalties."""


def penalty_values(seal: Seal, names) -> dict[str, float]:
    """Return the values of some penalties."""
    return {p.name: p.value for p in penalties_of(seal) if p.name in names}


def _groups(seal: Seal, names) -> list[frozenset]:
    """Group penalties that are raised by a common factor: those of rigid contacts, then those of
    self-contact, whose ratios to the stiffness of the body differ."""
    rigid = {contact.label for contact in contacts(seal)}
    first = frozenset(p.name for p in penalties_of(seal) if p.name in names and p.contact in rigid)
    return [group for group in (first, frozenset(names) - first) if group]


def relative_error(result: SealResult, names) -> float:
    """Compute the largest relative error caused by the penalties ``names``: in a measure, or as
    penetration or elastic slip in stick relative to the largest displacement.

    Measures whose error is not estimable, because contact is about to open, are left out where there
    are others.
    """
    errors = result.penalty_error.values()
    # all of them where none is estimable
    errors = [error for error in errors if error.estimable] or errors
    return max(compliance(result, names), *(error.part(names) for error in errors))


def with_raised_penalties(seal: Seal, result: SealResult, names, tolerance: float | None, run):
    """Raise ``names`` until their error is within the tolerance; return the seal, in its own steps, and
    its path. ``result`` is a coarse path.

    Ends early where higher penalties cost too much (``is_too_costly``) or are bounded by rounding.
    Groups that were raised together are then raised one after the other.
    """
    for _ in range(CORRECTIONS):
        raised = raised_penalties(result, names, tolerance)
        if not raised:
            break
        stiffer = with_own_parameters(seal.with_parameters(raised))
        again = run(stiffer, None, 0)
        if is_too_costly(again, result):
            # the penalties before remain, of one group alone where that is enough
            groups = [group for group in _groups(seal, names) if group & raised.keys()]
            for group in groups if len(groups) > 1 else ():
                seal, result = with_raised_penalties(seal, result, group, tolerance, run)
            break
        seal, result = stiffer, again
    return seal, result


def is_too_costly(result: SealResult, before: SealResult) -> bool:
    """Whether a path with higher penalties fails, or takes ``COSTLY`` times the iterations for each
    load step."""
    iterations, others = (path.newton_iterations.mean() for path in (result, before))
    return not result.converged or iterations > COSTLY * others


def raised_penalties(result: SealResult, names, tolerance: float) -> dict[str, float]:
    """Compute higher values of the penalties whose error exceeds the tolerance.

    All of a group by one factor: the ratio of tangential to normal penalty decides over the first
    increment of a point that comes into contact, which is an error of the load steps.
    """
    found, highest = {}, most_penalty(result.seal)
    for group in _groups(result.seal, names):
        excess, before = (
            relative_error(result, group) / tolerance,
            penalty_values(result.seal, group),
        )
        # error ~ 1/w: w_new = w (1.5 error / tolerance), bounded by rounding
        factor = min(SURPLUS * excess, highest / max(before.values()))
        # two significant digits, for whoever reads them
        raised = {name: float(f"{value * factor:.2g}") for name, value in before.items()}
        if excess > 1.0 and all(raised[name] > before[name] for name in before):
            found |= raised
    return found


def most_penalty(seal: Seal) -> float:
    """Compute the highest penalty, kPa/mm, with pressures exact to ``RELATIVE_ROUNDING`` times G.

    A gap is a difference of coordinates, known to eps L, so the pressure is to w eps L.
    """
    # w eps L <= RELATIVE_ROUNDING G
    shear = max(region.material.shear_modulus for region in seal.terms()[0].regions)
    size = float(np.abs(seal.nominal_particles).max())
    return RELATIVE_ROUNDING * shear / (np.finfo(float).eps * size)


def with_own_parameters(seal: Seal) -> Seal:
    """Return the seal with changed parameters moved into its terms and measures."""
    standard, further = (
        tuple(measure.with_parameters(seal.changed) for measure in own)
        for own in (seal.standard, seal.further)
    )
    return replace(seal, definitions=seal.terms(), standard=standard, further=further, changed={})
