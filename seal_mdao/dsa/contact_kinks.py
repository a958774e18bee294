"""Warning where derivatives are taken at a kink: a contact point just touches or begins to slip.

At a step that is not measured a kink matters by what the step passes to the next one. A touching point
adds the force f w_n l dg on one side only, which moves what the next step uses by Lambda_n^T f
(``dsa.direct``). That is zero where a symmetric section meets a symmetric profile.
"""

import warnings
from collections.abc import Collection

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactHistory
from seal_mdao.contact.kinks import SLIGHT, Kinks
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.dsa.factors import solve_transposed
from seal_mdao.errors import KinkWarning
from seal_mdao.terms.point_rates import add_field

STATES = {OPEN: "open", STICK: "stick", SLIP: "slip"}

NAMED = 3
"""Contact states and points that a message names; it counts the others."""
AT_START = 1e-8
"""Gap at the start that is zero, over the size of the body: a profile that touches in a seal file starts
2e-9 above it (``seals.file.clearance``)."""


def warn_of_kinks(
    path: PathResult, measured: Collection[int], velocity=None, from_start: bool = False
) -> None:
    """Issue one ``KinkWarning`` where contact is at a kink at a step that measures depend on.

    Parameters
    ----------
    path : PathResult
    measured : collection of int
        Indices in ``path.steps`` at which something is measured. Where the path is history
        dependent, the steps before them count as well.
    velocity : ndarray, shape (P, n, 2), optional
        Of the particles, for the designs with respect to which measures are differentiated.
    from_start : bool
        Whether a measure depends on the force at the start of the path.
    """
    # without history only the measured steps matter
    steps = sorted(measured)
    if path.problem.history_dependent:
        steps = range(max(measured, default=-1) + 1)
    found = [text for index in steps for text in _kinks_at(path, index, index in measured)]
    if velocity is not None and measured and (from_start or path.problem.history_dependent):
        found = [*_kinks_at_start(path, velocity, from_start), *found]
    if not found:
        return
    more = f"; and {len(found) - NAMED} more" if len(found) > NAMED else ""
    warnings.warn(
        "the derivatives at this design are one-sided, because a contact point just begins to "
        f"touch, stick or slip: {'; '.join(found[:NAMED])}{more}. They differ from central finite "
        "differences; change the start or the load steps of the profile so that no point changes "
        "its contact state exactly at the end of a step, or change the design slightly",
        KinkWarning,
        stacklevel=2,
    )


def contact_states(path: PathResult) -> dict[str, str]:
    """Name the contact state of every point of every contact at every nominal load step.

    Returns
    -------
    dict of str to str
        "open", "stick" or "slip" by point, contact and load step.
    """
    found = {}
    for step in path.nominal_steps:
        for term, response in zip(path.problem.terms, step.responses, strict=True):
            if not isinstance(response.history, ContactHistory):
                continue
            at = f"of {term.label!r} at load step {step.fraction:.6g}"
            for point, state in enumerate(response.branch):
                found[f"{_named(term, np.array([point]))} {at}"] = STATES[state]
    return found


def _kinks_at(path: PathResult, index: int, measured: bool) -> list[str]:
    """Describe the points of every term that are at a kink at a step."""
    step, found = path.steps[index], []
    following = None if measured else path.steps[index + 1]
    for number, term in enumerate(path.problem.terms):
        after = None if measured else following.responses[number]
        kinks = term.kinks(step.responses[number], step.fraction, step.before[number], after)
        if kinks is None:
            continue
        touching = kinks.touching
        if touching.size and not measured:
            # a touching point matters by what the step passes on
            touching = touching[kinks.slips | _passes_on(path, term, kinks, step, following)]
        for what, points in (("zero gap", touching), ("zero slip margin", kinks.slipping)):
            if points.size:
                at = f"{term.label!r} at load step {step.fraction:.6g}"
                found.append(f"{at}: {what} at {_named(term, points)}")
    return found


def _kinks_at_start(path: PathResult, velocity: np.ndarray, measured: bool) -> list[str]:
    """Describe the points that touch a profile at the start and that a design moves towards it.

    A design that moves them into the profile has a preliminary increment (``seals.clear_start``): its
    force at the start is w_n l |dg|, and points stick or slip from there on.
    """
    start, found = path.start, []
    if path.preliminary:
        return found
    size = float(np.ptp(path.discretization.particles, axis=0).max())
    for number, term in enumerate(path.problem.terms):
        response, following = start.responses[number], path.steps[0].responses[number]
        if not isinstance(term, ContactTerm):
            continue
        zero = np.abs(response.outputs) <= AT_START * size
        if not zero.any():
            continue
        near = response._replace(outputs=np.where(zero, 0.0, response.outputs))
        kinks = term.kinks(near, start.fraction, start.before[number], following)
        # dg/db = n . dx/db, n along the force w_n l n
        rates = term.where.moving.rates(path.discretization.particles, velocity)[kinks.touching]
        forces = kinks.forces[np.arange(kinks.touching.size), kinks.touching]
        by_design = np.abs(np.einsum("ti,tip->tp", forces, rates)).max(axis=1, initial=0.0)
        least = SLIGHT * np.hypot(*forces.T) * np.abs(velocity).max(initial=0.0)
        moved = by_design > least
        if not measured:
            moved &= kinks.slips | _passes_on(path, term, kinks, start, path.steps[0])
        if moved.any():
            found.append(
                f"{term.label!r} at the start: zero gap at {_named(term, kinks.touching[moved])}"
            )
    return found


def _passes_on(path: PathResult, term, kinks: Kinks, step, following) -> np.ndarray:
    """Find the touching points whose forces move what the next step uses, shape (t,)."""
    layout, columns = path.discretization.layout, []
    for other in path.problem.terms:
        linearized = other.linearization(step, following, False)
        passed = linearized.passed_on(following)
        if passed is not None:
            # B^T G of what the step passes on
            columns.append(linearized.loads_of(passed))
    if not columns:
        return np.zeros(len(kinks.touching), bool)
    # Lambda = K^-T B^T G
    adjoints = solve_transposed(path.problem, step, np.hstack(columns))
    every = np.arange(len(term.where))
    at_points = np.zeros((every.size, 2, adjoints.shape[1]))
    # B Lambda at the points of the term
    add_field(term.table.table, every, layout.equations, adjoints, at_points)
    # |Lambda^T B^T df/dg_n| of every touching point
    moved = np.abs(np.tensordot(kinks.forces, at_points, 2))
    return (moved > SLIGHT).any(axis=1)


def _named(term, points) -> str:
    """Points with their undeformed coordinates."""
    first = points[:NAMED]
    texts = [
        f"point {point} (x = {x:.4g}, y = {y:.4g})"
        for point, (x, y) in zip(first, term.reference[first].round(6) + 0.0, strict=True)
    ]
    more = points.size - first.size
    return ", ".join(texts) + (f" and {more} more" if more else "")
