"""Piecewise linear ramps of loads, temperatures and stretches along the path."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.geometry.motion import step_fractions


def at_fraction(values: np.ndarray, fraction: float) -> np.ndarray:
    """Interpolate values (n_steps + 1, ...) given after every nominal step at a path parameter."""
    first = min(int(fraction), len(values) - 2)
    # v = v_k + (s - k)(v_(k+1) - v_k),  k <= s <= k + 1
    within = fraction - first
    return values[first] + within * (values[first + 1] - values[first])


def at_ends(values: np.ndarray, ends) -> np.ndarray:
    """Interpolate values (len(ends) + 1, ...) at new ends of load steps, given in nominal steps."""
    return np.stack([values[0], *(at_fraction(values, end) for end in ends)])


@dataclass(frozen=True, eq=False)
class Ramp:
    """A quantity along the path, q(s) = q_0 + r(s) (q - q_0), with one parameter q.

    Attributes
    ----------
    start : float
        q_0, before the path begins.
    value : float
        q, where r = 1.
    shape : ndarray, shape (n_steps + 1,)
        r at the start and after every nominal step; linear between.
    """

    start: float
    value: float
    shape: np.ndarray

    def at(self, fractions) -> np.ndarray:
        """Evaluate q at path parameters (K,)."""
        return self.start + self.rates(fractions) * (self.value - self.start)

    def rates(self, fractions) -> np.ndarray:
        """Evaluate dq(s)/dq = r(s) at path parameters (K,)."""
        return np.array([at_fraction(self.shape, fraction) for fraction in fractions], float)

    @property
    def extremes(self) -> tuple[float, float]:
        """Least and largest q of the path."""
        every = self.start + np.asarray(self.shape) * (self.value - self.start)
        return float(every.min()), float(every.max())

    def with_ends(self, ends) -> "Ramp":
        """Return the ramp in other load steps, whose ``ends`` are in nominal steps."""
        return replace(self, shape=at_ends(np.asarray(self.shape, float), ends))


def ramp_of_stages(start: float, values, steps) -> Ramp:
    """Make the ramp of a quantity with the parameter that is its value farthest from ``start``.

    Parameters
    ----------
    values : sequence of float, shape (n_stages,)
        At the ends of the stages.
    steps : sequence of int or tuple of float, shape (n_stages,)
        Load steps of every stage: their number, or the fractions of the stage at their ends.
    """
    values = np.asarray(values, float)
    value = float(values[np.abs(values - start).argmax()])
    # r at the ends of the stages; 1 from the first on where nothing changes
    r = (values - start) / (value - start) if value != start else np.ones(len(values))
    shape = [0.0]
    for end, own in zip(r, steps, strict=True):
        first = shape[-1]
        shape += [first + part * (end - first) for part in step_fractions(own)]
    return Ramp(start, value, np.array(shape))
