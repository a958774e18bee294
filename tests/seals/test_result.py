"""Results in an interpreter: measures by name."""

import pytest

import seal_mdao as sm


@pytest.fixture(scope="module")
def pressed():
    return sm.analyze(sm.door_seal("engineering", n_steps=4, depth=1.0))


def test_value_takes_the_name_of_a_measure(pressed):
    for name in ("reaction", "von_mises", "gap_square_integral"):
        found = pressed.value(name)
        assert found.tobytes() == pressed.value(pressed.measure(name)).tobytes()
    assert pressed.value("reaction").tolist() == pressed.reaction[-1].tolist()


def test_value_of_an_unknown_name_reports_the_known_ones(pressed):
    with pytest.raises(ValueError, match="unknown measure 'force'; known are von_mises, gap, "):
        pressed.value("force")
