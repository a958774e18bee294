"""Air trapped in a hole: its law, its tangent, its derivatives, a cycle."""

from dataclasses import replace

import numpy as np
import pytest
from air_ring import RAYS, air_ring, change_of_residual, ring_body, ring_particles

import seal_mdao as sm
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.trapped_air import TrappedAir
from seal_mdao.measures.reaction import Reaction
from seal_mdao.structure.environment import Environment
from seal_mdao.terms.ramp import ramp_of_stages

PRESSURE, GAMMA = 101.325, 1.4


@pytest.fixture(scope="module")
def squeezed():
    result = sm.analyze(air_ring(), keep_factors=True)
    assert result.converged, result.failure
    return result


@pytest.fixture(scope="module")
def tables(squeezed):
    names = tuple(squeezed.seal.scalars)
    return [sm.differentiate(squeezed, names, method=method) for method in ("direct", "adjoint")]


def area(result, step):
    """Of the hole, from the deformed particles."""
    return abs(polygon_area(result.deformed(step)[result.seal.body.edge("cavity").particles])[0])


def test_the_law_holds_at_every_step(squeezed):
    """Pressure as the term gives it, area as the particles have it."""
    nominal = polygon_area(squeezed.particles[squeezed.seal.body.edge("cavity").particles])[0]
    constant = PRESSURE * abs(nominal) ** GAMMA
    pressures = [response.outputs[0, 0] for response in squeezed.path.at_nominal("air")]
    assert pressures[-1] > 3.0
    for step, pressure in enumerate(pressures):
        found = (PRESSURE + pressure) * area(squeezed, step) ** GAMMA
        assert abs(found / constant - 1.0) <= 1e-12


def test_a_sealed_ring_is_stiffer_than_an_open_one(squeezed):
    """By about what the pressure does on the width of the contact and the bulging of the sides."""
    vented = sm.analyze(air_ring(sealed=False))
    force = squeezed.value(Reaction("plate"))[1]
    assert vented.converged
    assert 1.05 < force / vented.value(Reaction("plate"))[1] < 2.0
    assert area(squeezed, -1) > area(vented, -1)


def test_the_tangent_is_the_derivative_of_the_residual(squeezed, rng):
    """With the part of rank one, which is in the factor alone."""
    factor, along, quotient = change_of_residual(squeezed, rng)
    np.testing.assert_allclose(factor.solve(quotient), along, rtol=0.0, atol=1e-6)
    transposed = factor.solve(quotient, True) @ quotient
    np.testing.assert_allclose(transposed, quotient @ factor.solve(quotient), rtol=1e-9)


def test_forces_derive_from_the_potential_of_heated_and_stretched_air(squeezed, rng):
    """At fixed temperature and stretch."""
    path, number = squeezed.path, squeezed.path.index_of("air")
    steps = [squeezed.seal.n_steps]
    around = Environment(ramp_of_stages(1.0, [1.1], steps), ramp_of_stages(23.0, [90.0], steps))
    (air,) = (own for own in squeezed.seal.terms() if own.label == "air")
    term = replace(air, environment=around).on(path.discretization, number)
    x, way, h = path.steps[-1].responses[number].x, rng.standard_normal((RAYS, 2)), 1e-3
    fraction = 0.7 * steps[0]

    def potential(share):
        return term.potential(None, term.respond(x + share * h * way, fraction, None))

    slope = np.array([1, -8, 8, -1]) @ [potential(s) for s in (-2, -1, 1, 2)] / (12.0 * h)
    response = term.respond(x, fraction, None)
    assert response.outputs[0, 0] > 5.0
    assert (response.force * way).sum() == pytest.approx(slope, rel=1e-8)


def test_newton_converges_quadratically():
    """Three iterations from the predictor to 1e-12; without the part of rank one there were more."""
    result = sm.analyze(air_ring())
    last = result.path.steps[-1].residuals
    assert len(last) <= 5
    assert last[-2] <= 1e2 * last[-3] ** 2 or last[-2] < 1e-10


def test_direct_and_adjoint_agree(squeezed, tables):
    direct, adjoint = tables
    for measure in squeezed.seal.standard:
        size = np.abs(direct[measure.name]).max(axis=1, keepdims=True)
        assert (np.abs(direct[measure.name] - adjoint[measure.name]) <= 1e-9 * size).all()


@pytest.mark.parametrize("place", range(12))
def test_derivatives_against_central_differences(squeezed, tables, place):
    """In every parameter, the pressure's among them, along the same contact sequence."""
    seal, name = squeezed.seal, tables[0].parameters[place]
    size = seal.scalars[name].value if name in seal.scalars else 1.0
    step = 1e-3 * (size or 1.0)
    branches = np.array([r.branch for r in squeezed.path.responses("plate")])

    def moved(share):
        if name in seal.scalars:
            found = sm.analyze(seal, None, {name: seal.scalars[name].value + share * step})
        else:
            found = sm.analyze(seal, share * step * np.eye(3)[place])
        assert np.array_equal(branches, [r.branch for r in found.path.responses("plate")])
        return np.concatenate([found.value(measure) for measure in seal.standard])

    quotient = np.array([1, -8, 8, -1]) @ [moved(s) for s in (-2, -1, 1, 2)] / (12 * step)
    exact = np.concatenate([tables[0][m.name][:, place] for m in seal.standard])
    # Newton's tolerance over the step is 1e-9 of a measure's size
    noise = 1e-9 * np.abs(moved(0)).max() / (size or 1.0)
    assert exact[0] != 0.0
    assert (np.abs(quotient - exact) <= 1e-6 * np.abs(exact).max() + noise).all()


def test_without_friction_a_cycle_returns_to_its_start():
    result = sm.analyze(air_ring(friction=0.0, back=True))
    assert result.converged, result.failure
    assert np.abs(result.displacement(6)).max() > 0.5
    assert np.abs(result.displacement()).max() <= 1e-8
    assert abs(result.response("air").outputs[0, 0]) <= 1e-8


def test_the_way_round_does_not_matter():
    ring = ring_body().edge("cavity").particles
    seal = air_ring()
    other = (*seal.definitions[:-1], TrappedAir("air", ring[::-1]))
    turned = sm.Seal(
        seal.nominal_particles, seal.design_velocity, seal.body, other, 3, seal.standard
    )  # fmt: skip
    one = sm.Seal(
        seal.nominal_particles, seal.design_velocity, seal.body, seal.definitions, 3, seal.standard
    )  # fmt: skip
    pressures = [sm.analyze(s).response("air").outputs[0] for s in (one, turned)]
    np.testing.assert_allclose(*pressures, rtol=1e-11)


@pytest.mark.parametrize(
    ("changed", "words"),
    [({"pressure": 0.0}, "pressure of 'air'"), ({"gamma": -1.0}, "gamma of 'air'")],
)
def test_bad_air_is_refused(changed, words):
    with pytest.raises(ValueError, match=words):
        TrappedAir("air", np.arange(RAYS), **changed)
    with pytest.raises(ValueError, match="at least three"):
        TrappedAir("air", np.arange(2))


def test_a_hole_that_is_squeezed_shut_has_no_answer():
    """No area, no pressure: the step is refused, not made with a complex number."""
    term_of = sm.analyze(air_ring(depth=0.05)).term("air")
    flat = ring_particles()[term_of.where.at_particles] * [1.0, -0.1]
    assert term_of.respond(flat, 1.0, None) is None
