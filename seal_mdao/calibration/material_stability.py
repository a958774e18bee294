"""Material stability: Drucker's postulate in uniaxial, planar and equibiaxial tests.

A law is stable in a state when d(tau) : d(ln lambda) > 0 for every small change of the stretches: when
its tangent d tau_i / d ln lambda_j is positive definite, for a nearly incompressible law on the
isochoric changes. (D. C. Drucker, J. Appl. Mech. 26 (1959) 101; R. Hill, Proc. R. Soc. Lond. A 314
(1970) 457.) Changes across the direction of a test are included: a strip may be stable in its own test
and yet fail by necking.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from seal_mdao.calibration.loading_modes import MODES, Mode, is_compressible, lateral_stretch
from seal_mdao.materials.isotropic import Isotropic

MARGIN = 0.1
"""Relative widening of a range of ln(lambda) at both ends."""
WIDEST = (0.2, 5.0)
"""Range of stretches searched for an instability, or that of the data if wider."""
POINTS = 300
"""Number of stretches of a scan from the undeformed state to an end."""

_ISOCHORIC = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])


class UnstableMaterialError(ValueError):
    """Error for constants that are unstable in the required range."""


def smallest_stiffness(law: Isotropic, mode: Mode, stretch) -> np.ndarray:
    """Compute the smallest eigenvalue of the tangent relative to the undeformed state, shape of
    ``stretch``; positive where the law is stable, -inf where it is not defined."""
    stretch = np.asarray(stretch, float)
    return _smallest(law, mode, stretch) / abs(_smallest(law, mode, np.ones(1))[0])


def _smallest(law, mode, stretch):
    with np.errstate(all="ignore"):
        state = mode.stretches(stretch, lateral_stretch(law, mode, stretch))
        # A_ij = d tau_i / d ln lambda_j;  isochoric: B A B^T, rows of B normal to (1, 1, 1)
        tangent = np.moveaxis(law.principal_tangent(state), (0, 1), (-2, -1))
    if not is_compressible(law):
        tangent = _ISOCHORIC @ tangent @ _ISOCHORIC.T
    # smallest eigenvalue
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
        Required range of stretches, margin included.
    begins_below, begins_above : float or None
        Stretch at which an instability begins in compression and in tension; None if there is none
        within ``scanned``.
    scanned : tuple of float
        Smallest and largest stretch of the scan.
    """

    mode: str
    lower: float
    upper: float
    begins_below: float | None
    begins_above: float | None
    scanned: tuple

    @property
    def stable(self) -> bool:
        """Whether there is no instability within the required range."""
        return (self.begins_below is None or self.begins_below < self.lower) and (
            self.begins_above is None or self.begins_above > self.upper
        )

    @property
    def text(self) -> str:
        """One line of the report."""
        found = [begin for begin in (self.begins_below, self.begins_above) if begin is not None]
        if not found:
            return f"{self.mode}: stable from {self.scanned[0]:.3g} to {self.scanned[1]:.3g}"
        begins = " and ".join(f"{begin:.4g}" for begin in found)
        if self.lower == self.upper:
            return f"{self.mode}: not tested; instability begins at a stretch of {begins}"
        required = f"{self.lower:.3g} to {self.upper:.3g}"
        word = "stable over" if self.stable else "NOT stable over"
        return f"{self.mode}: {word} {required}; instability begins at a stretch of {begins}"


def widened(lower: float, upper: float, margin: float = MARGIN) -> tuple[float, float]:
    """Widen a range of stretches around 1 by a margin, a fraction of the logarithms of its ends."""
    # (1 + margin) ln lambda
    return min(lower, 1.0) ** (1.0 + margin), max(upper, 1.0) ** (1.0 + margin)


def check_mode(law: Isotropic, mode: Mode, lower: float, upper: float) -> ModeStability:
    """Check the stability of a law in one mode; ``lower`` and ``upper`` as in ``ModeStability``."""
    # beyond the required range too: the report states where an instability begins
    scanned = min(lower, WIDEST[0]), max(upper, WIDEST[1])
    below, above = (_begin(law, mode, end) for end in scanned)
    return ModeStability(mode.name, lower, upper, below, above, scanned)


def _begin(law, mode, end: float) -> float | None:
    """Find the stretch of the first instability between the undeformed state and ``end``."""
    # scan in ln lambda, then bracket the zero of the smallest eigenvalue
    logs = np.linspace(0.0, np.log(end), POINTS)
    stiffness = smallest_stiffness(law, mode, np.exp(logs))
    unstable = np.flatnonzero(~(stiffness > 0.0))
    if not unstable.size:
        return None
    if unstable[0] == 0:
        return 1.0
    low, high = logs[unstable[0] - 1], logs[unstable[0]]
    # limiting extension: the law is not defined beyond
    if not np.isfinite(stiffness[unstable[0]]):
        return float(np.exp(low))

    def value(log):
        return smallest_stiffness(law, mode, np.exp([log]))[0]

    return float(np.exp(scipy.optimize.brentq(value, low, high)))


def check_stability(law: Isotropic, ranges: dict, margin: float = MARGIN) -> dict:
    """Check the stability in all modes; return ``ModeStability`` by mode.

    Parameters
    ----------
    law : Isotropic
    ranges : dict of str to (float, float)
        Smallest and largest tested stretch by mode; other modes are reported, but need not be stable.
    margin : float
    """
    required = {name: widened(*ranges.get(name, (1.0, 1.0)), margin) for name in MODES}
    return {name: check_mode(law, MODES[name], *required[name]) for name in MODES}


def require_stable(stability: dict, where: str = "the law") -> None:
    """Raise an error for constants that are unstable in the required range.

    Raises
    ------
    UnstableMaterialError
        With mode, range and the stretch at which the instability begins.
    """
    unstable = [found.text for found in stability.values() if not found.stable]
    if unstable:
        raise UnstableMaterialError(
            f"{where} describes a material that is not stable: {'; '.join(unstable)}; use other "
            "constants or another law"
        )
