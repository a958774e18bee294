"""Cyclic tests: detection of unloadings, and the response of a rubber with softening."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.calibration.loading_modes import Mode, ModeResponse, nominal_stress, response
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.ogden_roxburgh import PREFIX, OgdenRoxburgh, softened

NOISE = 0.02
"""Change of ln(lambda) that is no unloading, as a fraction of the largest one."""
STEPS = 2
"""Smallest number of readings of a loading, and of the unloading after it."""


def unloadings(stretch) -> int:
    """Count the unloadings in a series of stretches, in the order of the test.

    An unloading goes back towards the undeformed state by at least two readings, after a loading by at
    least two. A sorted series has none, nor has one that jumps back, as to a second specimen.
    """
    log = np.append(0.0, np.log(stretch))
    turns, count = _turns(log), 0
    for before, top, end in zip(turns, turns[1:], turns[2:], strict=False):
        # readings on the way back, up to the undeformed state
        back = np.count_nonzero(log[top + 1 : end + 1] * np.sign(log[top]) >= 0.0)
        # ln lambda falls in size
        toward = log[top] * (log[end] - log[top]) < 0.0
        count += bool(toward and top - before >= STEPS and back >= STEPS)
    return count


def _turns(log) -> list[int]:
    """Find the indices of the turning points of a series, its ends included; noise is none."""
    noise, turns, last, rising = NOISE * np.abs(log).max(), [0], 0, 0.0
    for i, value in enumerate(log):
        change = value - log[last]
        if rising * change > 0.0 or rising == 0.0:
            # the extreme of this segment so far
            rising = np.sign(change)
            last = i
        elif abs(change) > noise:
            turns.append(last)
            last, rising = i, -rising
    return [*turns, last]


@dataclass(frozen=True)
class SoftenedLaw:
    """A nearly incompressible law with its softening, for tests of materials.

    Attributes
    ----------
    law : Isotropic
    softening : OgdenRoxburgh
    """

    law: Isotropic
    softening: OgdenRoxburgh

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the constants of the law, then of the softening."""
        return tuple(self.constants)

    @property
    def constants(self) -> dict[str, float]:
        """Values by name, in the order of ``names``."""
        return {**self.law.constants, **self.softening.constants}

    def with_(self, **constants) -> "SoftenedLaw":
        """Return the same law with some of the ``constants`` changed."""
        own = {name: value for name, value in constants.items() if name.startswith(PREFIX)}
        others = {name: value for name, value in constants.items() if name not in own}
        return SoftenedLaw(self.law.with_(**others), self.softening.with_(**own))

    def energy(self, mode: Mode, stretch) -> np.ndarray:
        """Evaluate the isochoric energy W of stretches in one mode, kPa."""
        return self.law.energy(*_ratios(mode, stretch))

    def response(self, mode: Mode, data) -> ModeResponse:
        """Compute the stress in the order of the test with derivatives in all constants.

        A mode without unloadings is a first loading, and its stress that of the law.

        Parameters
        ----------
        mode : Mode
        data : ModeData
        """
        first = response(self.law, mode, data.stretch)
        if not data.unloadings:
            none = np.zeros((len(self.softening.constants), data.stretch.size))
            rates = np.concatenate([first.stress_rates, none])
            return ModeResponse(first.stress, first.lateral, rates, np.zeros_like(rates))
        energy = self.energy(mode, data.stretch)
        by_constant = self.law.constant_energies(*_ratios(mode, data.stretch))
        # reading with the largest energy so far
        top = energy >= np.maximum.accumulate(energy)
        at = np.maximum.accumulate(np.where(top, np.arange(top.size), 0))
        soft = softened(energy, energy[at], *self.softening.constants.values())
        # P = eta P_0,  dP/dc = eta dP_0/dc + P_0 (eta_W dW/dc + eta_Wmax dW_max/dc)
        moved = soft.by_energy * by_constant + soft.by_largest * by_constant[:, at]
        rates = soft.factor * first.stress_rates + first.stress * moved
        rates = np.concatenate([rates, first.stress * soft.by_constants])
        return ModeResponse(soft.factor * first.stress, first.lateral, rates, np.zeros_like(rates))


def _ratios(mode: Mode, stretch) -> tuple[np.ndarray, np.ndarray]:
    """Compute T and J of plane strain with the same ratios of stretches, at J = 1 in space."""
    stretch = np.asarray(stretch, float)
    # T = (l1^2 + l2^2) / l3^2, J = l1 l2 / l3^2 for F / l3, whose third stretch is 1
    first, second, third = mode.stretches(stretch, stretch**mode.incompressible_rate)
    return (first**2 + second**2) / third**2, first * second / third**2


def response_to(law: Isotropic | SoftenedLaw, mode: Mode, data) -> ModeResponse:
    """Compute the response to a test with derivatives in the constants."""
    if isinstance(law, SoftenedLaw):
        return law.response(mode, data)
    return response(law, mode, data.stretch)


def stress_in(law: Isotropic | SoftenedLaw, mode: Mode, data) -> np.ndarray:
    """Compute the nominal stress of all readings of a test, kPa."""
    if isinstance(law, SoftenedLaw):
        return law.response(mode, data).stress
    return nominal_stress(law, mode, data.stretch)
