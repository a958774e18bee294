"""Load path computed during the choice of load steps and penalties, reused as the analysis of the
nominal design.

The same inputs give the same bits, so the next analysis of this seal takes the path and solves nothing.
One path is stored, until then or as long as its seal exists.
"""

import weakref
from dataclasses import replace

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.seals.seal import Seal

_stored: list[tuple] = []
"""At most one pair of a weak reference to a seal and its path."""


def store_path(seal: Seal, path: PathResult) -> None:
    """Store the load path of the nominal design of a seal, replacing the one stored before."""
    _stored[:] = [(weakref.ref(seal, _forget), path)]


def take_path(seal: Seal, particles: np.ndarray) -> PathResult | None:
    """Return the stored path if it is that of a seal with these particles, and forget it."""
    for reference, path in _stored:
        owner = reference()
        # the key has the scalar parameters, and an origin that every other change replaces
        same = owner is not None and owner.key == seal.key
        if same and np.array_equal(path.discretization.particles, particles):
            _stored.clear()
            return path
    return None


def without_factors(path: PathResult) -> PathResult:
    """Return a path without the factors of its tangents, which sensitivities compute again."""
    return replace(path, steps=[replace(step, factor=None) for step in path.steps])


def _forget(reference) -> None:
    """Free the path of a seal that no longer exists."""
    _stored[:] = [pair for pair in _stored if pair[0] is not reference]
