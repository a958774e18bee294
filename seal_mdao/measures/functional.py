"""Measures of a path with their first derivatives in what the path delivers."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Seeds:
    """What M measures take from one converged step.

    Attributes
    ----------
    gap : ndarray, shape (M, k)
    force : ndarray, shape (M, k, 2)
    gradient : ndarray, shape (M, s, 4)
        On F at the points of a table.
    """

    gap: np.ndarray
    force: np.ndarray
    gradient: np.ndarray


def no_seeds(n_measures: int, n_contact: int, n_points: int) -> Seeds:
    """Zero seeds, to be filled in."""
    return Seeds(
        np.zeros((n_measures, n_contact)), np.zeros((n_measures, n_contact, 2)),
        np.zeros((n_measures, n_points, 4)),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Functional:
    """M measures and their partial derivatives.

    Attributes
    ----------
    values : ndarray, shape (M,)
    seeds : dict of int to Seeds
        By place in ``path.steps``.
    particles : ndarray, shape (M, n, 2)
        Explicit dependence on the undeformed particles, at fixed gaps, forces and F.
    contact : ndarray, shape (M, 4)
        Explicit dependence on door radius, w_n, w_t and mu.
    constants : ndarray, shape (M, 3)
        Explicit dependence on C10, C01 and the bulk modulus.
    """

    values: np.ndarray
    seeds: dict
    particles: np.ndarray
    contact: np.ndarray
    constants: np.ndarray

    @property
    def count(self) -> int:
        return len(self.values)


def functional(values, seeds, n_particles, particles=None, contact=None, constants=None):
    """A ``Functional`` whose explicit parts are zero where left out."""
    values = np.atleast_1d(np.asarray(values, float))
    m = len(values)
    return Functional(
        values, seeds,
        np.zeros((m, n_particles, 2)) if particles is None else particles,
        np.zeros((m, 4)) if contact is None else contact,
        np.zeros((m, 3)) if constants is None else constants,
    )  # fmt: skip


def stacked(parts) -> Functional:
    """All measures of several functionals one after the other."""
    total = sum(part.count for part in parts)
    seeds, first = {}, 0
    for part in parts:
        rows = slice(first, first + part.count)
        for place, own in part.seeds.items():
            if place not in seeds:
                seeds[place] = no_seeds(total, own.gap.shape[1], own.gradient.shape[1])
            for name in ("gap", "force", "gradient"):
                getattr(seeds[place], name)[rows] = getattr(own, name)
        first += part.count
    return Functional(
        np.concatenate([part.values for part in parts]), seeds,
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("particles", "contact", "constants")
        ),
    )  # fmt: skip
