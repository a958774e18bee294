"""Work of the door against stored and dissipated energy, along whole paths."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.seals.door.door_seal import options_of, with_options


def work(result):
    """Work of the door by the trapezoidal rule, at every nominal step."""
    force = np.concatenate([[0.0], result.reaction[:, 1]])
    down = np.diff(result.travel, prepend=-result.seal.before_touch)
    return np.cumsum(0.5 * (force[1:] + force[:-1]) * down)


def stored(result):
    """Strain energy, normal penalty energy and elastic slip energy at every nominal step."""
    seal, structure, length = result.seal, result.term("structure"), result.term("door").length
    out = []
    for step in result.path.nominal_steps:
        door = result.response("door", step)
        closed = door.gap < 0.0
        normal = 0.5 * options_of(seal).normal_penalty * np.sum((length * door.gap**2)[closed])
        slip = door.history.variables[closed, 2]
        tangential = 0.5 * options_of(seal).tangent_penalty * np.sum(length[closed] * slip**2)
        out.append(structure.energy(step.d, step.fraction) + normal + tangential)
    return np.array(out)


def test_without_friction_the_work_is_stored(frictionless):
    """Error of the trapezoidal rule only: it falls with the square of the step."""
    coarse = frictionless
    fine = sm.analyze(with_options(coarse.seal, n_steps=140))
    errors = [abs(work(r)[-1] - stored(r)[-1]) / stored(r)[-1] for r in (coarse, fine)]
    assert errors[0] < 2e-3
    assert errors[1] < errors[0] / 8


def dissipated(result):
    """Work of the friction traction on the inelastic slip, straight door (v = 1), per step."""
    length, place, out = result.term("door").length, result.path.index_of("door"), []
    for step in result.path.nominal_steps:
        began, door = step.before[place], step.responses[place]
        before, after = began.variables, door.history.variables
        slid = after[:, 0] - before[:, 0]
        was_open = began.state == OPEN
        share = np.where(was_open, door.gap / (door.gap - before[:, 2]), 1.0)
        inelastic = slid * share - (after[:, 2] - np.where(was_open, 0.0, before[:, 2]))
        slips = door.state == SLIP
        penalty = options_of(result.seal).tangent_penalty
        out.append(np.sum((penalty * after[:, 2] * inelastic * length)[slips]))
    return np.array(out)


def test_with_friction_the_rest_of_the_work_is_dissipated(flat):
    """Sliding takes energy at every step, and the balance closes as the steps are refined."""
    errors = []
    for result in (flat, sm.analyze(with_options(flat.seal, n_steps=420))):
        lost = dissipated(result)
        assert np.all(lost >= 0.0)
        balance = work(result) - stored(result) - np.cumsum(lost)
        errors.append(np.abs(balance).max() / work(result)[-1])
        assert lost.sum() > 1e-3 * work(result)[-1]
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 3


def test_reaction_is_the_slope_of_the_stored_energy(frictionless):
    """d(energy)/d(depth) at mid-steps by central differences."""
    energy = stored(frictionless)
    step = 3.5 / 35
    slope = (energy[2:] - energy[:-2]) / (2 * step)
    force = frictionless.reaction[1:-1, 1]
    np.testing.assert_allclose(slope[-15:], force[-15:], rtol=5e-3)
    assert force[-1] == pytest.approx(slope[-1], rel=1e-3)
