"""Derivatives by both methods against each other, and against difference quotients."""

import numpy as np
from quotients import quotients


def assert_methods_agree(seal, tables):
    """Assert that the direct and the adjoint method give the same derivatives of all measures."""
    for measure in seal.standard:
        direct, adjoint = (table[measure.name] for table in tables)
        size = np.abs(direct).max(axis=1, keepdims=True)
        assert (np.abs(direct - adjoint) <= 1e-9 * size).all()


def assert_quotients_agree(seal, tables, step, certainty):
    """Assert that both agree with central differences, which err by at most ``certainty``; ``step`` is
    relative for scalar parameters."""
    for column, name in enumerate(tables[0].parameters):
        size = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
        found = quotients(seal, name, step * (size or 1.0))
        for measure, (quotient, bound) in found.items():
            for table in tables:
                exact = table[measure][:, column]
                assert np.abs(exact).max() > 0.0, (name, measure)
                assert (np.abs(quotient - exact) <= bound).all(), (name, measure)
                assert bound.max() <= certainty * np.abs(exact).max(), (name, measure)
