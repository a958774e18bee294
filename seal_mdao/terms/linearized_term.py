"""Base class of the sensitivities of a term: its rows B, and products with its linearisation L.

    direct    K d' = -B^T L [B' d, h', w', theta', X'] - B'^T s        Eq. (70)
    adjoint   the transposes of the same products, swept backwards

What needs no history is taken for many steps at once (``LinearizedBlock``).
"""

from typing import Protocol

import numpy as np


class Basis(Protocol):
    """Rows B of a term, and all other quantities that depend on the design: X, weights,
    parameters."""

    def rates(self, shape, rates):
        """Rates for the ``ParameterRates``; ``shape`` are the ``DiscretizationRates``."""

    def no_seeds(self, count: int, wanted: set):
        """Zero seeds of ``count`` measures in the form of ``rates``, to be added to: an object with
        ``parameters`` (n, M). ``wanted`` are names of scalar parameters."""

    def pull_back(self, seeds, particles_bar):
        """Transpose of ``rates``: add to the seeds on the particles (n, 2, M); returns those on the
        essential transformation, shape (c, u, M)."""


class LinearizedTerm:
    """Term at one converged step: products with rates and with seeds, in columns for P parameters
    or M measures. By default it has no history."""

    # ---- direct ----

    def rates(self, design, history, prescribed, load):
        """Compute the rates at fixed d of the results of the term, (s', h+', o').

        Parameters
        ----------
        design
            ``Basis.rates``.
        history
            h' of what the step before passed on.
        prescribed : ndarray, shape (2 n, P), or None
            d' of the imposed displacements.
        load : ndarray, shape (n_equations + 1, P)
            f' is added.
        """
        raise NotImplementedError

    def solved(self, found, solution: np.ndarray):
        """The rates ``found`` with those of d' (n_equations, P)."""
        raise NotImplementedError

    def history_rates(self, found):
        """h+' for the next step."""

    # ---- what the next step uses of d ----

    def passed_on(self, following):
        """Return ``PassedOn``, or None if the next step does not depend on the term."""

    def loads_of(self, passed) -> np.ndarray:
        """B^T G of what is passed on, (n_equations + 1, c)."""
        raise NotImplementedError

    def passed(self, found, passed, values: np.ndarray):
        """The rates ``found`` with those z (c, P) of the functions that are passed on."""
        raise NotImplementedError

    # ---- adjoint ----

    def seeds(self, history_bar, taken=None):
        """Return the seeds (s_bar = 0, h+_bar, o_bar) on the results of the term.

        Parameters
        ----------
        history_bar
            Of the next step, on the history.
        taken : object, optional
            Of measures, in the form of ``no_seeds``.
        """

    def history_loads(self, seeds) -> np.ndarray | None:
        """What the ``seeds`` on the history passed on come to on d, (n_equations + 1, M), of a term that
        passes on all of it; None where that is nothing."""

    def measured_loads(self, taken, which) -> np.ndarray:
        """What ``taken`` of the measures ``which`` comes to on d, (n_equations + 1, len(which))."""
        raise NotImplementedError

    def pull_back(self, seeds, adjoints, mix, design, prescribed_bar):
        """Add what the step does for the adjoints lambda = adjoints mix to the seeds ``design``.

        Parameters
        ----------
        adjoints, mix : ndarray, shapes (n_equations + 1, c), (c, M)
        prescribed_bar : ndarray, shape (2 n + 1, M), or None
            Added to: seeds on the displacements of all particles.

        Returns
        -------
        object
            Seeds on the history with which the step began.
        """
        raise NotImplementedError


class LinearizedBlock(Protocol):
    """A force without history at K converged steps."""

    def add_rates(self, design, loads) -> None:
        """Add f' at fixed d to ``loads`` (K, n_equations + 1, P)."""

    def pull_back(self, adjoints, mixes, design) -> None:
        """Add -f' for the adjoints and mixes of the steps to the seeds ``design``."""
