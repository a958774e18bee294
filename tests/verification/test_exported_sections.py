"""Exported input files: forces of CalculiX, which reads them, against those of the package."""

import shutil
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.export.abaqus import write_abaqus
from seal_mdao.seals.file.build import unchosen_seal
from verification.exported_sections import REFERENCES, reference, stage_forces
from verification.references import calculix

pytest.importorskip("netgen")
EXAMPLES = Path(__file__).parents[2] / "examples"
LARGEST = {
    "exported_foam": 0.001, "exported_pair": 0.01, "exported_ring": 0.006, "exported_half": 0.006,
    "exported_bulb": 0.032,
}  # fmt: skip
"""Largest difference of a force on the same mesh, over the largest force of the stage."""
FINER = {
    "exported_foam": 0.001, "exported_pair": 0.01, "exported_ring": 0.006, "exported_half": 0.006,
    "exported_bulb": 0.02,
}  # fmt: skip
"""The same on the finer mesh of CalculiX and particles at its spacing."""
UNCERTAIN = 0.011
"""Largest change of a force of CalculiX by the last refinement or by three times the contact penalty."""


@pytest.mark.parametrize("name", LARGEST)
def test_stored_forces(name, figure):
    known = reference(name)
    for change in ("change_by_last_refinement", "change_by_three_times_the_penalty"):
        # none where CalculiX did not converge with the larger penalty
        if known[change] is not None:
            figure(f"{name}: {change}", known[change], UNCERTAIN)
    error = calculix.change(stage_forces(name), known["stages_at_spacing_of_file"])
    figure(f"{name}: force", error, LARGEST[name])


@pytest.mark.release
@pytest.mark.parametrize("name", LARGEST)
def test_stored_forces_on_the_finer_mesh(name, figure):
    found = stage_forces(name, calculix.REFINEMENT)
    figure(f"{name}: force, finer", calculix.change(found, reference(name)["stages"]), FINER[name])


@pytest.mark.release
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("name", LARGEST)
def test_stored_forces_are_those_of_the_exported_file(name, figure):
    file = sm.read_seal_file(REFERENCES / f"{name}.toml")
    found = calculix.forces(calculix.exported(file))
    known = reference(name)["stages_at_spacing_of_file"]
    figure(f"{name}: force of CalculiX", calculix.change(found, known), 1e-4)


@pytest.mark.parametrize("name", ["d_bulb", "o_ring", "lip", "car_door_seal", "two_holes"])
def test_exported_examples_have_known_keywords(name, tmp_path):
    """The reader of the input files, which accepts no others, divides them into deck and steps."""
    file = sm.read_seal_file(EXAMPLES / f"{name}.toml")
    write_abaqus(file, unchosen_seal(file), tmp_path / "seal.inp")
    deck = calculix.Deck((tmp_path / "seal.inp").read_text(encoding="utf-8"))
    labels = {f"REFERENCE_{own.name.upper()}" for own in file.profiles}
    assert set(deck.forces) == labels
    assert len(deck.ends) == len(file.leading.stages)
