"""Drucker's postulate: does more strain always take more stress?

A law is stable in a state when d(tau) : d(ln lambda) > 0 for every small change of the stretches: when
its tangent d tau_i / d ln lambda_j is positive definite, for a nearly incompressible law on the changes
that keep the volume. (D. C. Drucker, J. Appl. Mech. 26 (1959) 101; R. Hill, Proc. R. Soc. Lond. A 314
(1970) 457.) Changes across the direction of a test count as well: a strip may be stable in its own test
and yet fail by thinning.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from seal_mdao.calibration.modes import MODES, Mode, is_compressible, lateral_stretch
from seal_mdao.materials.isotropic import Isotropic

MARGIN = 0.1
"""By how much of its logarithm a range of stretches is widened at both ends."""
WIDEST = (0.2, 5.0)
"""Stretches up to which the beginning of an instability is looked for, or the data's if wider."""
POINTS = 300
"""Of a scan from the undeformed state to an end."""

_KEEPING_VOLUME = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])


class UnstableMaterialError(ValueError):
    """Constants that are not stable where they are needed."""


def smallest_stiffness(law: Isotropic, mode: Mode, stretch) -> np.ndarray:
    """Smallest eigenvalue of the tangent over that of the undeformed state, shape of ``stretch``.

    Positive where the law is stable; -inf where it has no value.
    """
    stretch = np.asarray(stretch, float)
    return _smallest(law, mode, stretch) / abs(_smallest(law, mode, np.ones(1))[0])


def _smallest(law, mode, stretch):
    with np.errstate(all="ignore"):
        state = mode.stretches(stretch, lateral_stretch(law, mode, stretch))
        tangent = np.moveaxis(law.principal_tangent(state), (0, 1), (-2, -1))
    if not is_compressible(law):
        tangent = _KEEPING_VOLUME @ tangent @ _KEEPING_VOLUME.T
    value = np.full(stretch.shape, -np.inf)
    there = np.isfinite(tangent).all(axis=(-2, -1))
    value[there] = np.linalg.eigvalsh(tangent[there])[..., 0]
    return value


@dataclass(frozen=True)
class ModeStability:
    """Stability in one mode.

    Attributes
    ----------
    mode : str
    lower, upper : float
        Range of stretches that was asked for, margin included.
    begins_below, begins_above : float or None
        Stretch at which an instability begins in compression and in tension; None where there is none
        up to the ends of ``scanned``.
    scanned : tuple of float
        Least and largest stretch looked at.
    """

    mode: str
    lower: float
    upper: float
    begins_below: float | None
    begins_above: float | None
    scanned: tuple

    @property
    def stable(self) -> bool:
        """Whether there is no instability within the range that was asked for."""
        return (self.begins_below is None or self.begins_below < self.lower) and (
            self.begins_above is None or self.begins_above > self.upper
        )

    @property
    def text(self) -> str:
        """One line."""
        found = [begin for begin in (self.begins_below, self.begins_above) if begin is not None]
        if not found:
            return f"{self.mode}: stable from {self.scanned[0]:.3g} to {self.scanned[1]:.3g}"
        begins = " and ".join(f"{begin:.4g}" for begin in found)
        if self.lower == self.upper:
            return f"{self.mode}: not tested; instability begins at a stretch of {begins}"
        asked = f"{self.lower:.3g} to {self.upper:.3g}"
        word = "stable over" if self.stable else "NOT stable over"
        return f"{self.mode}: {word} {asked}; instability begins at a stretch of {begins}"


def widened(lower: float, upper: float, margin: float = MARGIN) -> tuple[float, float]:
    """A range of stretches around 1 with a margin, a share of the logarithms of its ends."""
    return min(lower, 1.0) ** (1.0 + margin), max(upper, 1.0) ** (1.0 + margin)


def check_mode(law: Isotropic, mode: Mode, lower: float, upper: float) -> ModeStability:
    """Stability of a law in one mode; ``lower`` and ``upper`` as in ``ModeStability``."""
    scanned = min(lower, WIDEST[0]), max(upper, WIDEST[1])
    below, above = (_begin(law, mode, end) for end in scanned)
    return ModeStability(mode.name, lower, upper, below, above, scanned)


def _begin(law, mode, end: float) -> float | None:
    """Where the first instability on the way from the undeformed state to ``end`` begins."""
    logs = np.linspace(0.0, np.log(end), POINTS)
    stiffness = smallest_stiffness(law, mode, np.exp(logs))
    bad = np.flatnonzero(~(stiffness > 0.0))
    if not bad.size:
        return None
    if bad[0] == 0:
        return 1.0
    low, high = logs[bad[0] - 1], logs[bad[0]]
    if not np.isfinite(stiffness[bad[0]]):  # the law ends there
        return float(np.exp(low))

    def value(log):
        return smallest_stiffness(law, mode, np.exp([log]))[0]

    return float(np.exp(brentq(value, low, high)))


def check_stability(law: Isotropic, ranges: dict, margin: float = MARGIN) -> dict:
    """Stability in all modes.

    Parameters
    ----------
    law : Isotropic
    ranges : dict of str to (float, float)
        Least and largest stretch by mode, as tested; modes that are left out are only looked at.
    margin : float

    Returns
    -------
    dict of str to ModeStability
    """
    asked = {name: widened(*ranges.get(name, (1.0, 1.0)), margin) for name in MODES}
    return {name: check_mode(law, MODES[name], *asked[name]) for name in MODES}


def require_stable(stability: dict, where: str = "the law") -> None:
    """Refuse constants that are unstable over the range asked for.

    Raises
    ------
    UnstableMaterialError
        With mode, range and the stretch at which it begins.
    """
    bad = [found.text for found in stability.values() if not found.stable]
    if bad:
        raise UnstableMaterialError(f"{where} is not stable: {'; '.join(bad)}")
