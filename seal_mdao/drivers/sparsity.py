"""Which entries of the constraint Jacobian can be other than zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from seal_mdao.drivers.layout import approximates_derivatives

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from openmdao.core.driver import Driver

    from seal_mdao.drivers.layout import ProblemLayout


def jacobian_structure(
    driver: Driver, layout: ProblemLayout, linear_jacobian: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return rows (of the constraint vector) and columns of the possibly non-zero entries.

    OpenMDAO knows them from three sources: a total colouring gives single entries
    (``driver._con_subjacs``), the relevance graph gives the blocks in which a constraint depends
    on a design variable at all, and the Jacobian of linear constraints is constant.

    Parameters
    ----------
    driver : Driver
        The driver, after its colouring has been computed.
    layout : ProblemLayout
        Layout of the problem.
    linear_jacobian : ndarray, shape (linear rows, n)
        Jacobian of the linear constraints, in the row order of ``layout.linear_rows``.

    Returns
    -------
    rows, columns : ndarray of int
    """
    mask = np.zeros((layout.m, layout.n), dtype=bool)
    for name in layout.responses:
        if name in layout.constraint_slices:
            _mark_nonlinear(mask, driver, layout, name)
    mask[layout.linear_rows] = linear_jacobian != 0.0
    mask[~layout.active] = False
    return np.nonzero(mask)


def colored_entries(driver: Driver, by_source: bool, sparsity: dict) -> dict:
    """Return ``{constraint: {design variable: (rows, columns)}}`` from a total colouring.

    Parameters
    ----------
    driver : Driver
        The driver.
    by_source : bool
        Whether the colouring is keyed by source names, as it is for approximated models.
    sparsity : dict
        What ``Coloring.get_subjac_sparsity`` gives.
    """
    entries = {}
    for name, meta in driver._cons.items():
        if meta["linear"]:
            continue
        found = sparsity.get(meta["source"] if by_source else name)
        if found is None:
            continue
        entries[name] = {}
        for desvar, desvar_meta in driver._designvars.items():
            block = found.get(desvar_meta["source"] if by_source else desvar)
            if block is not None:
                entries[name][desvar] = (block[0], block[1])
    return entries


def _mark_nonlinear(mask, driver: Driver, layout: ProblemLayout, name: str) -> None:
    rows = layout.constraint_slices[name]
    known = driver._con_subjacs.get(name)
    relevant = _relevant_desvars(driver, name)
    for desvar, columns in layout.desvar_slices.items():
        if known is not None and desvar in known:
            block_rows, block_columns = known[desvar]
            mask[rows.start + block_rows, columns.start + block_columns] = True
        elif desvar in relevant:
            mask[rows, columns] = True


def _relevant_desvars(driver: Driver, name: str) -> set[str]:
    """Return design variables a constraint depends on; all where the graph is not reliable."""
    model = driver._problem().model
    if approximates_derivatives(model):
        return set(driver._designvars)
    relevance = model._relevance
    with relevance.seeds_active(rev_seeds=(driver._cons[name]["source"],)):
        return {
            desvar
            for desvar, meta in driver._designvars.items()
            if relevance.is_relevant(meta["source"])
        }
