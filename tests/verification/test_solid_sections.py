"""Forces of seal files that leave everything open, against independent finite elements (FElupe)."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.profiles import leading_motion

REFERENCES = Path(__file__).parent / "references"
LARGEST = 0.01
"""Relative error of a force at the particles of the files, beyond the uncertainty of the elements."""
LARGEST_BY_DEFAULT = 0.025
"""With the particles that a file without ``spacing`` gets."""
MOST_UNCERTAIN = 0.005
"""Of the finite elements where they are compared with."""
SECTIONS = ("half_disc", "o_ring", "bonded_gasket", "half_ring", "rounded_punch")


def force_errors(name, result):
    """Relative errors of the forces of the profile that moves at the ends of the stages, and the
    uncertainty of the finite elements."""
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
    sure = np.array(known["relative_uncertainty"]) <= MOST_UNCERTAIN
    assert sure.sum() >= 2
    seal, exact = result.seal, np.array(known["force_N_per_m"])
    ends = leading_motion(seal).ends
    steps = [int(np.abs(ends - stage).argmin()) for stage in range(1, len(exact) + 1)]
    label = next(term.label for term in seal.terms() if hasattr(term, "motion"))
    found = np.abs(result.path.reaction(label)[steps, 1])[sure]
    return found / exact[sure] - 1.0, np.array(known["relative_uncertainty"])[sure]


@pytest.mark.parametrize("name", SECTIONS)
def test_forces_at_defaults(name):
    result = sm.analyze(sm.build_seal(REFERENCES / f"{name}.toml"), keep_factors=True)
    errors, uncertain = force_errors(name, result)
    assert (np.abs(errors) - uncertain).max() <= LARGEST
    assert not any("permit penetration" in text for text in result.warnings)


@pytest.mark.parametrize("name", SECTIONS)
def test_forces_without_spacing(name, tmp_path):
    text = (REFERENCES / f"{name}.toml").read_text(encoding="utf-8")
    text, count = re.subn(r"(?m)^spacing = .*\n", "", text)
    assert count == 1
    (tmp_path / "seal.toml").write_text(text, encoding="utf-8")
    errors, uncertain = force_errors(name, sm.analyze(sm.build_seal(tmp_path / "seal.toml")))
    assert (np.abs(errors) - uncertain).max() <= LARGEST_BY_DEFAULT


@pytest.mark.parametrize("name", ["half_disc", "o_ring"])
def test_soft_penalties_of_a_solid_section_are_found_out(name):
    """With those of the door seal the force is a tenth too small or more, and the result says so."""
    seal = sm.build_seal(REFERENCES / f"{name}.toml", step_ends=None)
    soft = {
        key: 1e4 if key.endswith("normal_penalty") else 1e2
        for key in seal.scalars
        if key.endswith("penalty")
    }
    result = sm.analyze(seal.with_parameters(soft), keep_factors=True)
    errors, _ = force_errors(name, result)
    assert errors.max() < -0.03
    assert any("permit penetration" in text for text in result.warnings)
    stiff = sm.analyze(seal)
    label = next(term.label for term in seal.terms() if hasattr(term, "motion"))
    true = 1.0 - result.path.reaction(label)[-1, 1] / stiff.path.reaction(label)[-1, 1]
    estimate = -result.penalty_error["reaction"].relative
    assert 0.5 * true <= estimate <= 2.0 * true
