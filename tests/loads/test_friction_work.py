"""What friction takes from a cycle: a ring pressed, sheared, and let go."""

import numpy as np
import pytest
from air_ring import air_ring

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.measures.work import FrictionWork, StrainEnergy

LOST = FrictionWork()


def cycle(**options):
    result = sm.analyze(air_ring(sealed=False, back=True, **options))
    assert result.converged, result.failure
    assert not (result.response("plate").branch != OPEN).any()
    return result


def dissipated(result):
    """Work of the friction tractions on the inelastic slip against a straight plate."""
    length, place, taken = result.term("plate").length, result.path.index_of("plate"), 0.0
    penalty = result.seal.scalars["tangent_penalty"].value
    for step in result.path.nominal_steps:
        began, plate = step.before[place], step.responses[place]
        before, after = began.variables, plate.history.variables
        was_open = began.state == OPEN
        share = np.where(was_open, plate.gap / (plate.gap - before[:, 2]), 1.0)
        inelastic = (after[:, 0] - before[:, 0]) * share
        inelastic += np.where(was_open, 0.0, before[:, 2]) - after[:, 2]
        taken += ((penalty * after[:, 2] * inelastic * length)[plate.branch == SLIP]).sum()
    return taken


def sliding(finer):
    """Most points slide along most of the way."""
    return cycle(finer=finer, friction=0.05, shear=4.0)


@pytest.fixture(scope="module")
def rough():
    return sliding(2)


def test_without_friction_nothing_is_lost():
    """What closing takes opening gives back, to Newton's tolerance."""
    result = cycle(friction=0.0)
    most = sm.analyze(air_ring(sealed=False, friction=0.0)).value(StrainEnergy())[0]
    assert abs(result.value(LOST)[0]) <= 1e-8 * most


def test_what_is_lost_is_what_the_tractions_do_on_the_slip(rough):
    """Both are sums over steps; where points touch and slip anew they err by a step at the worst."""
    errors = [abs(r.value(LOST)[0] / dissipated(r) - 1.0) for r in (rough, sliding(8))]
    assert dissipated(rough) > 10.0
    assert errors[0] < 0.05
    assert errors[1] < errors[0] / 4


def test_derivatives_of_what_is_lost(rough):
    seal = rough.seal
    names = ("friction", "c10")
    direct, adjoint = (
        sm.differentiate(rough, names, (LOST,), method)["friction_work"][0]
        for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-9 * np.abs(direct).max())
    for name, exact in zip(names, direct[seal.n_offsets :], strict=True):
        value = seal.scalars[name].value
        h = 1e-4 * value
        moved = [sm.analyze(seal, None, {name: value + i * h}) for i in (-2, -1, 1, 2)]
        for other in moved:
            assert np.array_equal(*(
                [p.branch for p in r.path.responses("plate")] for r in (other, rough)
            ))  # fmt: skip
        quotient = np.array([1, -8, 8, -1]) @ [m.value(LOST)[0] for m in moved] / (12 * h)
        assert exact == pytest.approx(quotient, rel=1e-5)
