"""Starting points of the fit of a Prony series: relaxation times, and shifts of temperatures.

For given relaxation times and shifts the force is linear in the parts e_0 and e_i >= 0, so that
non-negative least squares on a dense grid of times gives a spectrum without a starting point.
"""

import numpy as np
import scipy

from seal_mdao.calibration.relaxation_model import PronyModel, decay

PER_DECADE = 3
"""Relaxation times of the dense grid per decade."""
BEYOND = np.log(3.0)
"""Extension of the range of relaxation times below the first reading, in ln tau."""
FASTEST = 0.01
"""Shortest time after a ramp, as a part of the time of the reading."""
STEPS = 20
"""Steps per decade of the search for a shift."""
OVERLAP = 0.3
"""Smallest part of a curve, in ln t, that lies over the master curve during this search."""


def time_range(model: PronyModel, log_a: np.ndarray) -> tuple[float, float]:
    """Compute the range of ln of reduced times t/a that readings resolve, for ln a (c,) of the curves.

    It ends with the last reading, and begins with the shortest time after the loading.
    """
    # the term of a hundredth of the ramp has relaxed to a hundredth by its end
    held = np.maximum(model.time - model.tests.ramp, FASTEST * model.time)
    # ln(t/a) = ln t - ln a
    low, high = np.log(held) - log_a[model.curve], np.log(model.time) - log_a[model.curve]
    return float(low.min()), float(high.max())


def dense_grid(low: float, high: float) -> np.ndarray:
    """Make ln tau of the dense grid for reduced times from exp(low) to exp(high)."""
    count = int(np.ceil((high - low + BEYOND) / np.log(10.0) * PER_DECADE)) + 1
    return np.linspace(low - BEYOND, high, max(count, 2))


def parts(model: PronyModel, log_tau, log_a, size, use=None) -> np.ndarray:
    """Solve for e_0 and e_i >= 0 by non-negative least squares, shape (n + 1,).

    Parameters
    ----------
    model : PronyModel
    log_tau : ndarray, shape (n,)
    log_a, size : ndarray, shape (c,)
        ln a and q m of every curve.
    use : ndarray of bool, shape (c,), optional
        Curves to use; all when left out.
    """
    chosen = np.ones(model.time.size, bool) if use is None else use[model.curve]
    curve, root = model.curve[chosen], np.sqrt(model.weight[chosen])
    psi = _decays(model, log_tau, model.time[chosen], log_a[curve])
    # A = sqrt(w) q m (1, psi_1, ..., psi_n),  y = sqrt(w) f
    matrix = (root * size[curve])[:, None] * psi
    # |A e - y|^2 = |R e - Q^T y|^2 + const with A = Q R
    q, r = np.linalg.qr(matrix)
    return scipy.optimize.nnls(r, q.T @ (root * model.force[chosen]))[0]


def _decays(model, log_tau, time, log_a) -> np.ndarray:
    """Evaluate 1 and psi_i at readings, shape (m, n + 1)."""
    psi, _ = decay(time[:, None], np.exp(log_tau + log_a[:, None]), model.tests.ramp)
    return np.column_stack([np.ones(time.size), psi])


# ---- relaxation times ----


def starting_times(model: PronyModel, log_a, size, before=None) -> list[np.ndarray]:
    """Make starting points of ln tau, each of shape (n,): evenly spaced ones, clusters of the dense
    spectrum, and the terms ``before`` of a smaller fit with one more in their largest gap."""
    low, high = time_range(model, log_a)
    n = model.terms
    if n == 0:
        return [np.empty(0)]
    starts = [low + (high - low) * (np.arange(n) + 0.5) / n]
    grid = dense_grid(low, high)
    found = clusters(grid, parts(model, grid, log_a, size)[1:], n)
    if found is not None:
        starts.append(np.clip(found, low - BEYOND, high))
    if before is not None and before.size == n - 1:
        # one more term in the middle of the largest gap of ln tau
        edges = np.concatenate([[low], np.sort(before), [high]])
        gap = int(np.argmax(np.diff(edges)))
        starts.append(np.sort(np.append(before, 0.5 * (edges[gap] + edges[gap + 1]))))
    return starts


def clusters(grid: np.ndarray, amounts: np.ndarray, count: int) -> np.ndarray | None:
    """Merge the lines of a spectrum to ``count`` centres, nearest first; None with too few lines."""
    own = amounts > 0.0
    centres, amounts = grid[own], amounts[own]
    if centres.size < count:
        return None
    while centres.size > count:
        i = int(np.argmin(np.diff(centres)))
        # the two nearest: x = (m_i x_i + m_j x_j) / (m_i + m_j)
        total = amounts[i] + amounts[i + 1]
        centres[i] = (centres[i] * amounts[i] + centres[i + 1] * amounts[i + 1]) / total
        amounts[i] = total
        centres, amounts = np.delete(centres, i + 1), np.delete(amounts, i + 1)
    return centres


# ---- shifts ----


def starting_shifts(model: PronyModel) -> tuple[np.ndarray, np.ndarray]:
    """Place curve after curve on the master curve, from the reference temperature outwards.

    A hotter curve is shifted to longer reduced times, a colder one to shorter ones.

    Returns
    -------
    log_a : ndarray, shape (c,)
    ratios : ndarray, shape (number of tests - 1,)
        Forces of the tests over those of the first, after division by the largest of each.
    """
    curves, scale = model.tests.curves, np.array(model.tests.scales)
    log_a, q, known = np.zeros(len(curves)), np.ones(scale.max() + 1), set()
    if model.reference is None:
        return log_a, q[1:]
    degrees = np.array([own.temperature for own in curves])
    use = degrees == model.reference
    known |= set(scale[use])
    for side in (1.0, -1.0):
        last = 0.0
        # hotter temperatures in their order, then colder ones
        away = side * (np.array(model.shifted) - model.reference)
        for temperature in np.array(model.shifted)[np.argsort(away)][np.sort(away) > 0.0]:
            own = degrees == temperature
            last = _best_shift(model, own, use, log_a, q, known, side, last)
            log_a[own], use, known = last, use | own, known | set(scale[own])
    return log_a, q[1:] / q[0]


def _best_shift(model, own, use, log_a, q, known, side, last) -> float:
    """Find ln a of the curves ``own`` by a search; sets the ratios q of tests that are new."""
    scale = np.array(model.tests.scales)
    placed, m = use[model.curve], model.modulus_factors()
    log = np.log(model.time) - log_a[model.curve]
    low, high = log[placed].min(), log[placed].max()
    grid = dense_grid(low, high)
    # spectrum of the curves placed so far
    e = parts(model, grid, log_a, q[scale] * m, use)
    mine = np.flatnonzero(own[model.curve])
    t, curve = np.log(model.time[mine]), model.curve[mine]
    length, step, best = t.max() - t.min(), np.log(10.0) / STEPS, (np.inf, last, {})
    for k in range(int((high - low + length) / step) + 1):
        shift = last - side * k * step
        # readings over the master curve, ln t - ln a between its ends
        inside = (t - shift >= low) & (t - shift <= high)
        if inside.sum() < 2 or np.ptp(t[inside]) < OVERLAP * length:
            continue
        some = mine[inside]
        there = np.full(some.size, shift)
        curve_of, w = curve[inside], model.weight[some]
        # f of the spectrum at the shifted readings
        f = m[curve_of] * (_decays(model, grid, model.time[some], there) @ e)
        y, cost, new = model.force[some], 0.0, {}
        for number in np.unique(scale[curve_of]):
            rows = scale[curve_of] == number
            ratio = q[number]
            if number not in known:
                # min over q of sum w (q f - y)^2
                ratio = new[number] = (w * f * y)[rows].sum() / (w * f * f)[rows].sum()
            # mean square of f - y / q
            cost += (w * (ratio * f - y) ** 2)[rows].sum() / ratio**2
        best = min(best, (cost / w.sum(), shift, new), key=lambda found: found[0])
    for number, ratio in best[2].items():
        q[number] = ratio
    return best[1]
