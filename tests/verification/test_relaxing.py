"""Reference solutions of relaxing blocks against each other, in limits, and their dissipation."""

import numpy as np
import pytest
from scipy.integrate import quad

from verification.relaxing import (
    EQUIBIAXIAL,
    PLANE_STRAIN,
    SHEAR,
    UNIAXIAL,
    History,
    Rubber,
    after_step,
    convolution,
    elastic,
    isochoric_stress,
    recursion,
    sheared,
    work,
)

RUBBER = Rubber(80.0, 20.0, 80_000.0, (0.2, 0.15), (0.5, 20.0))
STIFF = RUBBER._replace(bulk=np.inf)
CASES = [(UNIAXIAL, 1.6), (UNIAXIAL, 0.6), (PLANE_STRAIN, 1.5), (PLANE_STRAIN, 0.7),
         (EQUIBIAXIAL, 1.3), (EQUIBIAXIAL, 0.8), (SHEAR, 0.8)]  # fmt: skip
NAMES = [f"{state.name} {value:g}" for state, value in CASES]


def undeformed(state):
    return 0.0 if state is SHEAR else 1.0


def program(state, value):
    """Ramp in 1 s, hold to 10 s, release in 0.5 s, recovery to 30 s."""
    start = undeformed(state)
    return History((0.0, 1.0, 10.0, 10.5, 30.0), (start, value, value, start, start))


def between(history, parts):
    """Times that divide every segment equally, corners included."""
    edges = np.array(history.times)
    inner = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(parts) / parts
    return np.append(inner.ravel(), edges[-1])


@pytest.mark.parametrize(("state", "value"), CASES, ids=NAMES)
def test_without_terms_the_block_is_elastic(state, value):
    times = np.array([0.0, 1.0, 5.0])
    stretches = np.linspace(undeformed(state), value, 3)
    found = recursion(STIFF.long_term(), state, times, stretches)
    np.testing.assert_allclose(found, elastic(STIFF, state, stretches), rtol=1e-12, atol=1e-12)
    # volume changes by the shear modulus over K
    soft = recursion(RUBBER.long_term(), state, times, stretches)
    np.testing.assert_allclose(soft, found, rtol=2e-2, atol=1e-10)
    harder = RUBBER.long_term()._replace(bulk=8e6)
    away = recursion(harder, state, times, stretches) - found
    np.testing.assert_allclose(away, (soft - found) / 100.0, rtol=0.02, atol=1e-9)


@pytest.mark.parametrize(("state", "value"), CASES, ids=NAMES)
def test_step_strain(state, value):
    """The closed form to rounding, by the recursion and by the integral."""
    times = np.concatenate([[0.0], np.geomspace(0.01, 200.0, 12)])
    exact = after_step(STIFF, state, value, times)
    np.testing.assert_allclose(
        recursion(STIFF, state, times, np.full(13, value)), exact, rtol=1e-13
    )
    held = History((0.0, 200.0), (value, value))
    np.testing.assert_allclose(convolution(STIFF, state, held, times), exact, rtol=1e-11)
    # instantaneous and long-term modulus
    assert exact[0] == pytest.approx(elastic(STIFF.instantaneous(), state, value), rel=1e-13)
    np.testing.assert_allclose(exact[-1] / elastic(STIFF, state, value), 1.0, atol=3e-5)


@pytest.mark.parametrize(
    ("state", "value", "rubber"),
    [*((*own, STIFF) for own in CASES), (EQUIBIAXIAL, 0.8, RUBBER), (PLANE_STRAIN, 1.5, RUBBER)],
)
def test_the_recursion_is_of_order_two(state, value, rubber):
    """Over ramp, hold, release and recovery: a quarter of the error with half the step."""
    history, errors = program(state, value), []
    coarse = between(history, 4)
    exact = convolution(rubber, state, history, coarse)
    for parts in (16, 32, 64):
        times = between(history, parts)
        found = recursion(rubber, state, times, history.at(times))[:: parts // 4]
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders[-1] - 2.0) < 0.1)
    assert errors[-1] < 1e-3


def test_the_exact_integral_of_shear():
    """The antiderivative against adaptive quadrature, and the differential equation against both."""
    history = program(SHEAR, 0.8)
    times = np.array([0.3, 1.0, 4.0, 10.2, 10.5, 17.0])

    def stress(k):
        S = isochoric_stress(STIFF, SHEAR.gradient(k, 1.0))
        return S[0, 1], S[1, 1]

    expected = []
    for time in times:
        k, total = history.at(time), np.array(stress(history.at(time)))
        for beta, tau in zip(STIFF.beta, STIFF.tau, strict=True):
            for row in (0, 1):
                # Q = beta (S(t) - 1/tau int exp(-(t - s)/tau) S(s) ds)
                memory = sum(
                    quad(lambda s: np.exp((s - time) / tau) * stress(history.at(s))[row] / tau,  # noqa: B023
                         begin, min(end, time), epsabs=1e-13, epsrel=1e-13)[0]
                    for begin, end in zip(history.times[:-1], history.times[1:], strict=True)
                    if begin < time
                )  # fmt: skip
                total[row] += beta * (stress(k)[row] - memory)
        expected.append(total[0] + k * total[1])
    exact = sheared(STIFF, history, times)
    np.testing.assert_allclose(exact, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(convolution(STIFF, SHEAR, history, times), exact, rtol=1e-11)
    # a step before the ramp
    stepped = History((0.0, 2.0), (0.3, 0.8))
    np.testing.assert_allclose(
        sheared(STIFF, stepped, [0.0, 1.0, 2.0]),
        convolution(STIFF, SHEAR, stepped, [0.0, 1.0, 2.0]), rtol=1e-11,
    )  # fmt: skip


@pytest.mark.parametrize(("state", "value"), CASES, ids=NAMES)
def test_slow_and_fast_ramps(state, value):
    """The long-term and the instantaneous law, to first order in time over tau."""
    start, ends = undeformed(state), np.linspace(0.0, 1.0, 5)
    stretches = start + (value - start) * ends
    for factor, law in ((1e8, STIFF), (1e-8, STIFF.instantaneous())):
        times = factor * np.linspace(0.0, 1.0, 401)
        found = recursion(STIFF, state, times, np.interp(times / factor, ends, stretches))[::100]
        np.testing.assert_allclose(found, elastic(law, state, stretches), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(("state", "value"), [(UNIAXIAL, 0.6), (EQUIBIAXIAL, 1.3), (SHEAR, 0.8)])
def test_the_compressible_block_against_the_incompressible_one(state, value):
    """The difference falls like 1/K, with time as without."""
    history = History((0.0, 1.0, 3.0), (undeformed(state), value, value))
    times = np.array([0.5, 1.0, 3.0])
    limit, found = convolution(STIFF, state, history, times), []
    for bulk in (8e4, 8e5):
        own = convolution(RUBBER._replace(bulk=bulk), state, history, times)
        found.append(np.abs(own - limit).max() / np.abs(limit).max())
    if state is SHEAR:
        # no volume changes
        assert max(found) < 1e-12
    else:
        assert 1e-5 < found[0] < 1e-2
        assert found[1] == pytest.approx(found[0] / 10.0, rel=0.05)


# ---- energy, objectivity ----


def random_gradients(rng, histories: int, corners: int, parts: int, size: float):
    """Isochoric histories (m, histories, 3, 3) with rotations, from rest to rest, and their times.

    F = R exp(H) with symmetric H of trace zero and rotations R, linear between the corners.
    """
    H = rng.normal(size=(corners, histories, 3, 3))
    H = 0.5 * (H + np.swapaxes(H, -1, -2))
    H -= np.trace(H, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) / 3.0
    H *= size / np.linalg.norm(H, axis=(-2, -1), keepdims=True)
    H *= rng.uniform(0.1, 1.0, (corners, histories, 1, 1))
    turn = rng.normal(size=(corners, histories, 3, 3))
    turn -= np.swapaxes(turn, -1, -2)
    H[[0, -1]] = 0.0
    grid = np.linspace(0.0, corners - 1.0, (corners - 1) * parts + 1)
    index = np.minimum(grid.astype(int), corners - 2)
    share = (grid - index)[:, None, None, None]
    H, turn = (own[index] * (1.0 - share) + own[index + 1] * share for own in (H, turn))
    # durations over six decades, then a long dwell
    seconds = np.repeat(10.0 ** rng.uniform(-3.0, 3.0, corners - 1), parts) / parts
    times = np.concatenate([[0.0], np.cumsum(seconds)])
    values, vectors = np.linalg.eigh(H)
    stretch = (vectors * np.exp(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    # Rodrigues: exp(W) = 1 + sin(a)/a W + (1 - cos(a))/a^2 W^2
    a = np.sqrt(0.5) * np.linalg.norm(turn, axis=(-2, -1), keepdims=True)
    rotation = np.eye(3) + np.sinc(a / np.pi) * turn
    rotation = rotation + 0.5 * np.sinc(0.5 * a / np.pi) ** 2 * turn @ turn
    return times, rotation @ stretch, stretch


def test_dissipation_of_random_histories():
    """The work of a closed cycle that ends at rest is dissipated, all of it: 1,000 histories.

    Principal stretches reach 2.2 and 0.45. No free energy is needed: at the beginning and at the end all
    overstresses are zero, as after the last stretch nothing more is done on the body.
    """
    rng, least = np.random.default_rng(11), []
    for _ in range(10):
        g = rng.uniform(0.02, 0.3, 3)
        rubber = Rubber(80.0, rng.uniform(0.0, 80.0), np.inf, tuple(g), (0.02, 1.0, 50.0))
        times, F, _ = random_gradients(rng, 100, 7, 40, 0.8)
        least.append(work(rubber, times, F).min())
    assert min(least) > 0.0


def test_rotations_do_no_work():
    """The same stretches with and without rotations; a rotation alone."""
    rng = np.random.default_rng(5)
    times, turned, plain = random_gradients(rng, 20, 5, 10, 0.6)
    one, two = work(STIFF, times, turned), work(STIFF, times, plain)
    np.testing.assert_allclose(one, two, rtol=1e-12)
    rotations = turned @ np.linalg.inv(plain)
    np.testing.assert_allclose(work(STIFF, times, rotations), 0.0, atol=1e-10)


def test_where_the_law_gives_energy():
    """Finite linear viscoelasticity of the second invariant may give energy.

    Small cycles of pure shear in the plane of a sheet that is stretched equibiaxially by m do a work in
    proportion to c10 I1/3 + c01 sum lambda_k^-2 (2 d_k^2 - D/3)/D with d = (1, -1, 0) and D = d.d. It is
    negative for m^2 > about 2 c10/c01: far beyond seals of c10 > c01.
    """

    def small_cycles(rubber, m):
        angle = np.linspace(0.0, 40.0 * np.pi, 8001)
        d = 0.01 * np.sin(angle)
        zero = 0.0 * d
        F = np.stack([m * np.exp(d), m * np.exp(-d), zero + m**-2.0], axis=-1)[..., None] * np.eye(
            3
        )
        # tau = 1 s and one radian per second: the last ten of twenty cycles
        half = angle.size // 2
        full, first = work(rubber, angle, F), work(rubber, angle[: half + 1], F[: half + 1])
        return full - first

    def predicted(rubber, m):
        stretches = np.array([m, m, m**-2.0])
        d2 = np.array([1.0, 1.0, 0.0])
        return (
            rubber.c10 * np.sum(stretches**2) / 3.0
            + rubber.c01 * np.sum(stretches**-2.0 * (2.0 * d2 - 2.0 / 3.0)) / 2.0
        )

    # the long dwell of the sheet has relaxed before the last ten cycles
    for c10, c01, m in ((80.0, 20.0, 1.5), (0.0, 100.0, 1.1), (0.0, 100.0, 1.6), (20.0, 80.0, 2.0)):
        rubber = Rubber(c10, c01, np.inf, (0.3,), (1.0,))
        found = small_cycles(rubber, m)
        # beta omega tau/(1 + (omega tau)^2) times pi d^2 for ten cycles, dS : dE = 8 c d^2
        expected = predicted(rubber, m) * rubber.beta[0] / 2.0 * 10.0 * np.pi * 0.01**2 * 8.0
        assert found == pytest.approx(expected, rel=0.01), (c10, c01, m)
    assert predicted(Rubber(20.0, 80.0, 1.0, (), ()), 2.0) < 0.0 < predicted(RUBBER, 2.5)
