"""Derivatives along a line of analyses by difference quotients that know their own error."""

import numpy as np
from verification.differences import same_sequence

ALWAYS = ("von_mises", "gap", "gap_square_sum", "reaction")
# a quotient of high order and one of second order, of values at seven equidistant places
CENTRAL = np.arange(-3, 4), np.array([[-1, 9, -45, 0, 45, -9, 1], [0, 0, -30, 0, 30, 0, 0]]) / 60
BACKWARD = np.arange(-6, 1), np.array([[0, 0, 0, 0, 1, -4, 3], [0, 0, 0.5, 0, -2, 0, 1.5]]) / 2
LEAST_CERTAINTY = 1e-4
"""A quotient that is less certain than this share of its measure's largest one shows nothing."""


def slopes(result, analysis, step, further=(), stencil=CENTRAL):
    """Derivatives at ``result`` of all measures by name, and their error bounds: pairs (m,).

    ``analysis(t)`` is the analysis at the place t of the line; all have to go through the contact
    sequence of ``result``, at whose places the measures are taken.

    Bound: truncation and rounding. The two quotients differ by the error of the second-order one,
    h^2 f'''/6, beside which that of the other is nothing where f is smooth; where its second
    derivative jumps (a knot of a kernel on a neighbour) the error of the better one is 3/2 of what
    they differ by. Noise of the values from their fourth differences, of variance 70: the better
    quotient passes on 1.1 of it over h; 10 covers few samples and many quotients.
    """
    places, weights = stencil
    results = [result if k == 0 else analysis(k * step) for k in places]
    assert all(same_sequence(other, result) for other in results), "the contact sequence changes"
    values = {
        measure.name: np.array([other.value(measure) for other in results])
        for measure in result.measures((*ALWAYS, *further))
    }
    # no point may be open
    values = {name: value for name, value in values.items() if value.any()}
    noise = noises(values)
    out = {}
    for name, value in values.items():
        fine, coarse = weights @ value / step
        out[name] = fine, 2.0 * np.abs(fine - coarse) + 10.0 * noise[name] / step
    return out


def noises(values):
    """Noise of every measure: that of its own entries, and no less than that of all, relative."""
    size = {name: np.abs(value).max() for name, value in values.items()}
    fourth = {name: np.diff(value, 4, axis=0) / np.sqrt(70.0) for name, value in values.items()}
    relative = np.concatenate([(fourth[name] / size[name]).ravel() for name in values])
    return {
        name: max(root_mean_square(fourth[name]), size[name] * root_mean_square(relative))
        for name in values
    }


def root_mean_square(x):
    return np.sqrt(np.mean(np.square(x)))


def check(found, sensitivities, way):
    """The analytic derivatives along ``way`` (P,) lie within the bounds, and the bounds are tight."""
    for name, (value, bound) in found.items():
        exact = np.atleast_2d(sensitivities[name]) @ way
        assert (np.abs(value - exact) <= bound).all(), name
        assert bound.max() <= LEAST_CERTAINTY * np.abs(exact).max(), name
