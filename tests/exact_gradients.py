"""Gradients of a design by both methods, against each other and against central differences."""

import numpy as np
import pytest

import seal_mdao as sm


def require_exact(result, names, step):
    """Direct against adjoint of the named measures, and five-point quotients along a random direction of
    the design."""
    seal, offsets = result.seal, result.boundary_offsets
    direct, adjoint = (sm.differentiate(result, method=m) for m in ("direct", "adjoint"))
    way = np.random.default_rng(3).uniform(-1.0, 1.0, seal.n_offsets)
    sides = [sm.analyze(seal, offsets + k * step * way) for k in (-2, -1, 1, 2)]
    for name in names:
        size = np.abs(direct[name]).max()
        np.testing.assert_allclose(direct[name], adjoint[name], rtol=0.0, atol=1e-9 * size)
        values = [side.value(result.measure(name))[0] for side in sides]
        quotient = np.array([1.0, -8.0, 8.0, -1.0]) @ values / (12.0 * step)
        exact = (np.atleast_2d(direct[name])[:, : seal.n_offsets] @ way).item()
        assert quotient == pytest.approx(exact, rel=1e-5), name
