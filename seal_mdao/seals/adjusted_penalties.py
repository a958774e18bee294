"""Rule of the contact penalties: adjust them so that their estimated errors are within a tolerance.

Called by ``steps_and_penalties``; initial values are those of ``contact.default_penalties``. The
estimate (``penalty_error``) falls with the inverse of a penalty. Penalties are therefore raised by the
ratio of error to tolerance, unless the iterations then converge badly, or rounding bounds them.
Penalties with which the iterations converge badly, and whose error is far below the tolerance, as those
of thin walls of foam, are lowered by the same ratio.
"""

from dataclasses import replace

import numpy as np

from seal_mdao.seals.penalty_error import compliance, penalties_of
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.seal import Seal

CORRECTIONS = 4
"""Largest number of times that the penalties are changed."""
COSTLY = 2.0
"""Largest ratio of iterations per load step of a path with other penalties to that before."""
BADLY = 10.0
"""Mean iterations per load step above which penalties may be lowered; 3 to 7 are usual."""
EXACT = 0.1
"""Largest ratio of error to tolerance of penalties that are lowered."""
LOWEST = 1.0 / 30.0
"""Smallest factor by which penalties are lowered: of the first ones, ten times E/h remain."""
SURPLUS = 1.5
"""Factor on the ratio of error to tolerance by which a penalty is changed."""
RELATIVE_ROUNDING = 1e-10
"""Largest rounding error of the contact pressure over the shear modulus; it bounds the penalties."""


def penalty_values(seal: Seal, names) -> dict[str, float]:
    """Return the values of some penalties."""
    return {p.name: p.value for p in penalties_of(seal) if p.name in names}


def _groups(seal: Seal, names) -> list[frozenset]:
    """Group penalties that are changed by a common factor: those of rigid contacts, then those of
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


def with_adjusted_penalties(seal: Seal, result: SealResult, names, tolerance: float | None, run):
    """Adjust ``names`` to the tolerance; return the seal, in its own steps, and its path.

    ``result`` is a coarse path. Ends early where other penalties cost too much (``is_too_costly``) or
    are bounded by rounding. Groups that were changed together are then changed one after the other.
    """
    for _ in range(CORRECTIONS):
        changed = adjusted_penalties(result, names, tolerance)
        if not changed:
            break
        other = with_own_parameters(seal.with_parameters(changed))
        again = run(other, None, 0)
        if is_too_costly(again, result):
            # the penalties before remain, of one group alone where that is enough
            groups = [group for group in _groups(seal, names) if group & changed.keys()]
            for group in groups if len(groups) > 1 else ():
                seal, result = with_adjusted_penalties(seal, result, group, tolerance, run)
            break
        seal, result = other, again
    return seal, result


def is_too_costly(result: SealResult, before: SealResult) -> bool:
    """Whether a path with other penalties fails, or takes ``COSTLY`` times the iterations for each
    load step."""
    iterations, others = (path.newton_iterations.mean() for path in (result, before))
    return not result.converged or iterations > COSTLY * others


def adjusted_penalties(result: SealResult, names, tolerance: float) -> dict[str, float]:
    """Compute other values of the penalties whose error exceeds the tolerance, or is far below it while
    the iterations converge badly.

    All of a group by one factor: the ratio of tangential to normal penalty decides over the first
    increment of a point that comes into contact, which is an error of the load steps.
    """
    found, highest = {}, most_penalty(result.seal)
    slow = result.newton_iterations.mean() > BADLY
    for group in _groups(result.seal, names):
        excess, before = (
            relative_error(result, group) / tolerance,
            penalty_values(result.seal, group),
        )
        # error ~ 1/w: w_new = w (1.5 error / tolerance), bounded by rounding
        factor = min(max(SURPLUS * excess, LOWEST), highest / max(before.values()))
        # two significant digits, for whoever reads them
        other = {name: float(f"{value * factor:.2g}") for name, value in before.items()}
        raises = excess > 1.0 and all(other[name] > before[name] for name in before)
        if raises or (slow and excess < EXACT and _presses(result, group)):
            found |= other
    return found


def _presses(result: SealResult, group) -> bool:
    """Whether all contacts of a group press at the end of the path, where errors are estimated."""
    end = result.path.nominal_steps[-1]
    labels = {penalty.contact for penalty in penalties_of(result.seal) if penalty.name in group}
    return all(np.any(end.responses[result.path.index_of(label)].force) for label in labels)


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
