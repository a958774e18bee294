"""Results in an interpreter: measures by name, and one line for a seal and its result."""

from dataclasses import replace

import numpy as np
import pytest
from seal_file.block_files import FIXED, GLUED, MOVED, seal_of
from two_rubbers import pressed_block

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.work import ProfileWork, StrainEnergy


@pytest.fixture(scope="module")
def pressed():
    return sm.analyze(sm.door_seal("engineering", n_steps=4, depth=1.0))


def test_value_takes_the_name_of_a_measure(pressed):
    for name in ("reaction", "von_mises", "gap_square_integral"):
        found = pressed.value(name)
        assert found.tobytes() == pressed.value(pressed.measure(name)).tobytes()
    assert pressed.value("reaction").tolist() == pressed.reaction[-1].tolist()


def test_value_of_an_unknown_name_reports_the_known_ones(pressed):
    with pytest.raises(
        ValueError, match="the seal has no measure 'force'; it has von_mises, gap, "
    ):
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


def test_a_path_that_ended_early_has_no_values_at_its_end(pressed):
    """Not those of its last converged load step, nor an extrapolation of the force to later ones."""
    path = replace(pressed.path, steps=pressed.path.steps[:-1], status=Status.DIVERGED)
    early = replace(pressed, path=path)
    measures = (
        Reaction("door", name="closed", stages=(1,)),
        Reaction("door", name="later", travels=(0.95,)),
        ProfileWork("door"), pressed.measure("von_mises"), StrainEnergy(),
    )  # fmt: skip
    for measure in measures:
        assert np.isfinite(pressed.value(measure)).all()
        with pytest.raises(sm.LoadPathError, match="3 of 4 load steps converged"):
            early.value(measure)
    with pytest.raises(sm.LoadPathError, match="3 of 4 load steps converged"):
        early.value("von_mises")


def test_outline_seals_print_as_one_line(tmp_path):
    glued, moved = (seal_of(tmp_path, FIXED, own) for own in (GLUED, MOVED))
    count = len(glued.nominal_particles)
    assert repr(glued) == f"<OutlineSeal: {count} particles, profiles: plate, 8 load steps>"
    assert repr(moved) == f"<OutlineSeal: {count} particles, profiles: none, 4 load steps>"


def test_gap_profile_under_a_flat_plate(tmp_path):
    """The plate begins 0.5 mm above a flat top of 6 mm and travels 0.65 mm in four steps."""
    rubbers = "".join(
        f'[material.{name}]\nlaw = "neo_hookean"\nc10 = 100.0\nbulk_modulus = 2e3\n'
        for name in ("soft", "stiff")
    )
    path = tmp_path / "block.toml"
    path.write_text(rubbers + pressed_block(1.0, start=4.5, travel=-0.65))
    result = sm.analyze(sm.build_seal(path))
    arc, gap = result.gap_profile("plate", 0)
    assert arc[[0, -1]] == pytest.approx([0.0, 6.0])
    assert (np.diff(arc) > 0.0).all()
    assert gap == pytest.approx(np.full(arc.size, 0.5 - 0.65 / 4.0))
    # in contact at the end
    arc, gap = result.gap_profile("plate")
    assert gap.tolist() == result.contact.gap.tolist()
    assert np.interp(2.2, arc, gap) < 0.0
