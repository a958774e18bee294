"""Results in an interpreter: measures by name, and one line for a seal and its result."""

from dataclasses import replace

import pytest
from seal_file.block_files import FIXED, GLUED, MOVED, seal_of

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status


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


def test_seal_and_result_print_as_one_line(pressed):
    particles = len(pressed.particles)
    seal = f"<Seal: {particles} particles, profiles: door, 4 load steps>"
    assert repr(pressed.seal) == seal
    assert repr(pressed) == f"<SealResult: converged, 4 of 4 load steps, {seal}>"
    # a path that ended early
    path = replace(pressed.path, steps=pressed.path.steps[:-1], status=Status.DIVERGED)
    early = replace(pressed, path=path)
    assert repr(early) == f"<SealResult: not converged, 3 of 4 load steps, {seal}>"


def test_outline_seals_print_as_one_line(tmp_path):
    glued, moved = (seal_of(tmp_path, FIXED, own) for own in (GLUED, MOVED))
    count = len(glued.nominal_particles)
    assert repr(glued) == f"<OutlineSeal: {count} particles, profiles: plate, 8 load steps>"
    assert repr(moved) == f"<OutlineSeal: {count} particles, profiles: none, 4 load steps>"
