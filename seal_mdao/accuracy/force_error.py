"""Estimate the error of the forces due to the particle spacing, in the time of one analysis or less.

    e = 4/3 max |F_h - F_(h/2)| / max |F_(h/2)|

for the force F on every profile, or on moved edges, h the particle spacing. As in ``error_estimate``,
F_(h/2) is the force on a cloud with all cells divided into four, and both paths have the same load
steps, whose error drops out of the difference. The first pair of paths has load steps only to the ends
of the stages and to the largest forces; where iterations fail, or the path leaves that of the result,
as where a profile passes a lip in one step, a second pair has about ``FEW`` more, which may be halved,
and a third one, as where a ring rolls, ``MORE`` times as many.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seal_mdao.accuracy.error_estimate import (
    MOST_CUTS,
    ORDER,
    ComparedPaths,
    few_ends,
    some_ends,
)
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.profiles import moving_parts
from seal_mdao.seals.refined_steps import force_difference
from seal_mdao.seals.result import SealResult

LARGEST = 0.025
"""Relative error of a force above which there is a warning."""
WANTED = 0.02
"""Relative error from which the recommended spacing is computed."""
MARGIN = 0.9
"""Factor on the spacing that the order of the error gives."""
APART = 0.25
"""Largest relative difference of the forces in few load steps and those of the result; a path that
misses a contact is farther away."""


class ForceError(NamedTuple):
    """Estimated error of the forces due to the particle spacing.

    Attributes
    ----------
    relative : float or None
        Over the largest force on the same profile; None where it is not known.
    unknown : str
        Why it is not known; empty where it is.
    filling : tuple of (float, int)
        Where it is above ``LARGEST``: spacing (mm) and layers with which an error of second order is
        ``WANTED``.
    """

    relative: float | None
    unknown: str = ""
    filling: tuple[float, int] | None = None

    @property
    def warning(self) -> str:
        """Warning about an error above ``LARGEST``, with a remedy; empty for a smaller one."""
        if self.filling is None:
            return ""
        spacing, layers = self.filling
        return (
            "the estimated error of the forces due to the particle spacing is "
            f"{100.0 * self.relative:.2g} %; use a smaller spacing, such as spacing = {spacing:g} and "
            f"layers = {layers} in [section], or let the program choose it with accuracy = "
            f'"{100.0 * WANTED:g} %"'
        )


def force_error(file: SealFile, result: SealResult, callback: Callable | None = None) -> ForceError:
    """Estimate the error of the forces on the profiles of a seal due to the particle spacing.

    Parameters
    ----------
    file, result, callback
        As of ``error_estimate.estimate_errors``; the file gives a spacing, or leaves it to its default.

    Raises
    ------
    LoadPathError
        For a path that was not completed.
    """
    result.require_converged()
    forces = [result.path.reaction(part.label) for part in moving_parts(result.seal)]
    if all(np.abs(force).max() <= result.path.least_force for force in forces):
        return ForceError(None, "no force acts on a profile or on moved edges")
    first = _compared_ends(result)
    more = [(np.union1d(first, ends), MOST_CUTS) for ends in few_ends(result.seal)]
    paths = ComparedPaths(file, result, callback, [(first, 0), *more], APART)
    if paths.fine is None:
        return ForceError(None, paths.failure)
    # |F_h - F_(h/2)| / (1 - 2^-p) / max |F_(h/2)|
    difference = force_difference(paths.coarse, paths.fine, np.arange(len(paths.ends)))
    return _with_remedy(file, difference / (1.0 - 0.5**ORDER))


def _with_remedy(file: SealFile, error: float) -> ForceError:
    """Add the spacing and layers that reduce an error to ``WANTED``, where it is above ``LARGEST``."""
    if error <= LARGEST:
        return ForceError(error)
    # e = C h^2, with a margin; two digits, and as many more cells across the walls
    spacing, section = MARGIN * math.sqrt(WANTED / error) * file.section.spacing, file.section
    spacing = float(f"{spacing:.2g}")
    return ForceError(
        error, "", (spacing, 1 + math.ceil((section.layers - 1) * section.spacing / spacing))
    )


def _compared_ends(result: SealResult) -> np.ndarray:
    """Select the ends of the stages and the load steps at which the force on a profile is largest."""
    forces = [result.path.reaction(part.label) for part in moving_parts(result.seal)]
    largest = [1.0 + np.linalg.norm(force, axis=1).argmax() for force in forces]
    return np.union1d(some_ends(result.seal, 1), largest)
