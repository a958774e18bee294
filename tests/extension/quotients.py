"""Difference quotients of measures of any seal, which know their own error."""

import numpy as np

import seal_mdao as sm

PLACES = np.arange(-3, 4)
FINE = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
COARSE = np.array([0, 0, -1, 0, 1, 0, 0]) / 2


def quotients(seal, name, step, parameters=None, measures=None, start=None):
    """Derivatives of measures, the seal's standard ones unless given, and their error bounds: pairs
    (m,) by name.

    ``name`` is a scalar parameter or ``boundary_offsets[i]``. All analyses have to go through the same
    contact sequence. Bound: truncation and rounding. The quotients of second and sixth order differ by
    the error of the former, beside which that of the latter is nothing. Noise of the values from their
    fourth differences, of variance 70; they are three, so it is taken as no less than that of all values
    of the measure together, and no less than their last digit. The quotient passes on 1.1 of it over
    the step; 10 covers few samples and many quotients.
    """
    results = [_moved(seal, name, place * step, parameters or {}, start) for place in PLACES]
    sequences = [_sequence(result) for result in results]
    assert all(own == sequences[3] for own in sequences), (
        f"the contact sequence changes with {name}"
    )
    out = {}
    for measure in results[3].measures(measures):
        values = np.array([result.value(measure) for result in results])
        fine, coarse = FINE @ values / step, COARSE @ values / step
        square = np.diff(values, 4, axis=0) ** 2 / 70.0
        noise = np.sqrt(np.maximum(square.mean(axis=0), square.mean()))
        noise = np.maximum(noise, np.finfo(float).eps * np.abs(values).max(axis=0))
        out[measure.name] = fine, np.abs(fine - coarse) + 10.0 * noise / step
    return out


def _moved(seal, name, change, parameters, start):
    offsets, moved = np.zeros(seal.n_offsets), dict(parameters)
    offsets += 0.0 if start is None else start
    if name.startswith("boundary_offsets["):
        offsets[int(name[17:-1])] += change
    else:
        moved[name] = moved.get(name, seal.scalars[name].value) + change
    result = sm.analyze(seal, offsets, moved)
    result.require_converged()
    return result


def _sequence(result):
    """Branches of all terms at all steps."""
    return [[own.branch.tolist() for own in step.responses] for step in result.path.steps]
