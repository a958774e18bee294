"""Piecewise linear ramps of loads, temperatures and stretches along the path, and its time."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.geometry.motion import step_fractions


def at_fraction(values: np.ndarray, fraction: float) -> np.ndarray:
    """Interpolate values (n_steps + 1, ...) given after every nominal step at a path parameter; the
    first one in preliminary increments."""
    fraction = max(fraction, 0.0)
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

    def with_value(self, value: float) -> "Ramp":
        """Return the ramp with another q."""
        return replace(self, value=value)

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


@dataclass(frozen=True, eq=False)
class StageTimes:
    """Time along the path, t(s), with one parameter for all durations and one for each.

    Where something moves, time is linear in the completed part c of the stage. In a dwell, where
    nothing moves, rubber relaxes over decades of time; equal parts of it are even in the logarithm,

        t(c) = t_0 ((1 + D / t_0)^c - 1),   D = d T / T_0,

    with the duration d, and the parameter T that is T_0 until it is changed.

    Attributes
    ----------
    given : ndarray, shape (n_stages,)
        d of every stage, s.
    first : ndarray, shape (n_stages,)
        t_0 of dwells, s; infinite where something moves.
    stages : ndarray, shape (n_steps + 1,)
        Stages completed at the start and after every nominal step; linear between.
    reference : float
        T_0, the sum of the durations before any of them is changed, s.
    value : float
        T, s.
    """

    given: np.ndarray
    first: np.ndarray
    stages: np.ndarray
    reference: float
    value: float

    @property
    def durations(self) -> np.ndarray:
        """D of every stage, shape (n_stages,), s."""
        return np.asarray(self.given, float) * (self.value / self.reference)

    @property
    def total(self) -> float:
        """Time of the complete path, s."""
        return float(np.sum(self.durations))

    def at(self, fractions) -> np.ndarray:
        """Evaluate t at path parameters (K,), s."""
        return self._evaluated(fractions)[0]

    def rates(self, fractions) -> np.ndarray:
        """Evaluate dt/dT at path parameters (K,), all durations growing by the same factor."""
        # dt/dT = sum_i D_i / T dt/dD_i
        return self.durations @ self._evaluated(fractions)[1] / self.value

    def rates_of_durations(self, fractions) -> np.ndarray:
        """Evaluate dt/dd of every stage at path parameters (K,), shape (n_stages, K)."""
        # dt/dd = T / T_0 dt/dD
        return self._evaluated(fractions)[1] * (self.value / self.reference)

    def _evaluated(self, fractions) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate t (K,) and dt/dD (n_stages, K)."""
        durations, first = self.durations, np.asarray(self.first, float)
        done = np.array([at_fraction(self.stages, fraction) for fraction in fractions], float)
        stage = np.minimum(done.astype(int), len(durations) - 1)
        part, own = done - stage, durations[stage]
        before = np.concatenate([[0.0], np.cumsum(durations)])[stage]
        # t = c D, dt/dD = c; with r = D / t_0: t = D expm1(c ln(1 + r)) / r, dt/dD = c (1 + r)^(c - 1)
        ratio = own / first[stage]
        log = np.log1p(ratio)
        dwells = ratio > 0.0
        within = np.where(
            dwells, own * np.expm1(part * log) / np.where(dwells, ratio, 1.0), part * own
        )
        # exactly D at the end
        within = np.where(part == 1.0, own, within)
        slope = np.where(dwells, part * np.exp((part - 1.0) * log), part)
        # 1 for the stages before, dt/dD for that of s
        number = np.arange(len(durations))[:, None]
        rates = np.where(number == stage, slope, np.where(number < stage, 1.0, 0.0))
        return before + within, rates

    def slope_at(self, fraction: float) -> float:
        """Evaluate dt/ds at a path parameter, s; at the end of a load step that of the next one."""
        step = min(int(fraction), len(self.stages) - 2)
        done = at_fraction(self.stages, fraction)
        # the stage is that of the middle of the load step
        stage = int(0.5 * (self.stages[step] + self.stages[step + 1]))
        own, first = float(self.durations[stage]), float(self.first[stage])
        log, slope = np.log1p(own / first), own
        if log > 0.0:
            # dt/dc = t_0 ln(1 + D / t_0) (1 + D / t_0)^c
            slope = first * log * np.exp((done - stage) * log)
        return float(slope * (self.stages[step + 1] - self.stages[step]))

    def fraction_at(self, time: float) -> float:
        """Find the path parameter at a time (s)."""
        durations, first = self.durations, np.asarray(self.first, float)
        ends = np.cumsum(durations)
        stage = min(int(np.searchsorted(ends, time)), len(ends) - 1)
        own, begin = durations[stage], ends[stage] - durations[stage]
        # c = t / D, or ln(1 + t / t_0) / ln(1 + D / t_0)
        ratio, within = own / first[stage], min(time - begin, own)
        part = np.log1p(within / first[stage]) / np.log1p(ratio) if ratio > 0.0 else within / own
        stages = np.asarray(self.stages, float)
        return float(np.interp(stage + part, stages, np.arange(len(stages))))

    def with_value(self, value: float) -> "StageTimes":
        """Return times whose durations are multiplied by ``value`` over T."""
        return replace(self, value=value)

    def with_durations(self, given) -> "StageTimes":
        """Return times with other d (n_stages,), s."""
        return replace(self, given=np.array(given, float))

    def with_ends(self, ends) -> "StageTimes":
        """Return the times in other load steps, whose ``ends`` are in nominal steps."""
        return replace(self, stages=at_ends(np.asarray(self.stages, float), ends))


def times_of_stages(durations, first, steps) -> StageTimes:
    """Make the times of stages with their load ``steps``, as those of ``ramp_of_stages``."""
    stages = [0.0]
    for number, own in enumerate(steps):
        stages += [number + part for part in step_fractions(own)]
    given, total = np.array(durations, float), float(np.sum(durations))
    return StageTimes(given, np.array(first, float), np.array(stages), total, total)
