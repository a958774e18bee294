"""The estimated error by contact penalties is the true one, and penalties by tolerance are within it."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.adjusted_penalties import most_penalty, relative_error
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.export import write_design
from seal_mdao.seals.penalty_error import VALID, PenaltyError, penalties_of, penalty_errors
from seal_mdao.seals.steps_and_penalties import PENALTY_TOLERANCE, choose

FOLDED_LIP = Path(__file__).parents[1] / "contact" / "folded_lip.toml"
"""Its self-contact has penalties of 2000 and 500 kPa/mm."""
HALF_DISC = """
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 80000.0
[section]
material = "rubber"
spacing = 0.7
outer = [
  { edge = "foot", line = [[-5.0, 0.0], [5.0, 0.0]] },
  { edge = "dome", arc = { start = [5.0, 0.0], through = [0.0, 5.0], end = [-5.0, 0.0] } },
]
[fixed]
edges = ["foot"]
[[profile]]
name = "plate"
friction = 0.2
contact = ["dome"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 5.0]
PENALTIES
stage = [{ translate = [0.0, -1.0], steps = 12 }]
[[measure]]
type = "reaction"
[[measure]]
type = "contact_width"
"""


def half_disc(folder, penalties=""):
    path = folder / "half_disc.toml"
    path.write_text(HALF_DISC.replace("PENALTIES", penalties))
    return sm.read_seal_file(path)


@pytest.fixture(scope="module")
def solid(tmp_path_factory):
    return sm.build_seal(half_disc(tmp_path_factory.mktemp("solid")))


def pressed(seal, normal, tangent):
    values = {"plate_normal_penalty": normal, "plate_tangent_penalty": tangent}
    return sm.analyze(seal.with_parameters(values), keep_factors=True)


@pytest.mark.parametrize(("normal", "tangent"), [(1e5, 1e3), (1e5, 1e4), (3e4, 3e4)])
def test_estimate_is_the_true_error_within_a_factor_of_two(solid, normal, tangent):
    """Against penalties a hundred times as large, whose own error is a hundredth."""
    result, exact = pressed(solid, normal, tangent), pressed(solid, 100 * normal, 100 * tangent)
    for measure in solid.standard:
        found = result.penalty_error[measure.name]
        true = result.value(measure) - exact.value(measure)
        assert 0.5 * np.abs(true).max() <= np.abs(found.error).max() <= 2.0 * np.abs(true).max()
        assert np.sign(found.error) == np.sign(true)
        assert sum(found.by_penalty.values()) == pytest.approx(found.error)


@pytest.mark.parametrize(("friction", "normal"), [(0.0, 1e4), (0.3, 1e4), (0.3, 1e5)])
def test_estimate_of_self_contact_is_the_true_error_within_a_factor_of_two(friction, normal):
    """A lip that slides on its body, against penalties ten and a hundred times as large.

    With the stiff ones of these a step that stays in parts is another path: its measures differ by more
    than what the penalty does.
    """
    seal = sm.build_seal(sm.read_seal_file(FOLDED_LIP))

    def with_penalties(factor):
        own = {
            "self_contact_normal_penalty": factor * normal,
            "self_contact_tangent_penalty": 0.1 * factor * normal,
        }
        result = sm.analyze(seal.with_parameters(own | {"self_contact_friction": friction}))
        assert len(result.path.steps) == seal.n_steps
        return result

    result, *stiffer = (with_penalties(factor) for factor in (1.0, 10.0, 100.0))
    for measure in seal.standard:
        parts = result.penalty_error[measure.name].by_penalty
        error = sum(part for name, part in parts.items() if name.startswith("self_contact"))
        for exact in stiffer:
            true = result.value(measure) - exact.value(measure)
            assert 0.5 * abs(true) <= abs(error) <= 2.0 * abs(true)
            assert np.sign(error) == np.sign(true)


def test_penalties_of_self_contact_are_chosen_too(tmp_path):
    path, text = tmp_path / "lip.toml", FOLDED_LIP.read_text()
    path.write_text(
        text.replace("normal_penalty = 2000.0\ntangent_penalty = 500.0\n[fixed]", "[fixed]")
    )
    file = sm.read_seal_file(path)
    names = {"self_contact_normal_penalty", "self_contact_tangent_penalty"}
    assert set(file.open_penalties) == names
    seal = sm.build_seal(file)
    softer = seal.with_parameters({name: 0.2 * seal.scalars[name].value for name in names})
    errors = [relative_error(sm.analyze(own), names) for own in (seal, softer)]
    # on the coarse path it was below; with more steps it is a little different
    assert errors[0] < 1.5 * PENALTY_TOLERANCE < errors[1]
    again = sm.build_seal(file, **chosen_for(file, seal))
    assert {name: again.scalars[name].value for name in names} == {
        name: seal.scalars[name].value for name in names
    }


def test_estimate_is_from_the_exact_derivative(solid):
    """- w dm/dw of both penalties, as ``differentiate`` gives it by the other method."""
    result = pressed(solid, 1e5, 1e4)
    names = tuple(penalty.name for penalty in penalties_of(result.seal))
    slopes = sm.differentiate(result, names, method="adjoint")
    values = np.array([result.seal.scalars[name].value for name in names])
    for measure in solid.standard:
        expected = -(np.atleast_2d(slopes[measure.name])[:, solid.n_offsets :] @ values)
        assert result.penalty_error[measure.name].error == pytest.approx(expected, rel=1e-9)


def test_chosen_penalties_are_within_the_tolerance(solid):
    names = {"plate_normal_penalty", "plate_tangent_penalty"}
    result = sm.analyze(solid, keep_factors=True)
    # on the coarse path it was below; with more steps it is a little different
    assert 0.1 * PENALTY_TOLERANCE < relative_error(result, names) < 1.2 * PENALTY_TOLERANCE
    assert not any("permit penetration" in text for text in result.warnings)
    stiff = pressed(solid, *(30 * solid.scalars[name].value for name in sorted(names)))
    force = Reaction("plate", components=(1,))
    assert result.value(force) == pytest.approx(stiff.value(force), rel=1.5 * PENALTY_TOLERANCE)


def test_soft_penalties_are_reported_with_direction_and_cure(tmp_path):
    file = half_disc(tmp_path, "normal_penalty = 1e4\ntangent_penalty = 1e2")
    assert file.open_penalties == ()
    seal = sm.build_seal(file)
    assert seal.scalars["plate_normal_penalty"].value == 1e4
    result = sm.analyze(seal, keep_factors=True)
    (text,) = (text for text in result.warnings if "permit penetration" in text)
    assert "reaction " in text
    assert "% too small" in text
    assert "plate_normal_penalty = 1e+04 (at least " in text
    assert "plate_tangent_penalty = 1e+02 (at least " in text


def test_the_error_of_a_negative_value_is_that_of_its_magnitude(tmp_path):
    """One force, positive along +y and negative along -y: it is too small both times."""
    penalties = "normal_penalty = 1e4\ntangent_penalty = 1e2"
    path = half_disc(tmp_path, penalties).path
    down = '[[measure]]\ntype = "reaction"\nname = "down"\ndirection = [0, -1]\n'
    path.write_text(f"{path.read_text()}\n{down}")
    result = sm.analyze(sm.build_seal(path), keep_factors=True)
    assert result.value("down")[0] == pytest.approx(-result.reaction[-1, 1])
    (text,) = (text for text in result.warnings if "permit penetration" in text)
    up, down = (re.search(rf"\b{name} ([^,]*),", text)[1] for name in ("reaction", "down"))
    assert up.endswith("% too small")
    assert down == f"{up} in magnitude"


def test_an_error_that_a_linear_estimate_does_not_give_is_not_estimable(solid):
    """Pressed by a hair: a width that hardly begins; a force beside it has its estimate still."""
    result = sm.analyze(solid, keep_factors=True)
    width = result.penalty_error["contact_width"]
    parting = replace(width, error=np.full(1, 2.0 * width.scale))
    result.penalty_error["contact_width"] = parting
    assert not parting.estimable
    (text,) = (text for text in result.warnings if "penalties" in text)
    assert "contact_width not estimable: contact is about to separate" in text
    assert "200" not in text
    force = result.penalty_error["reaction"]
    assert force.estimable
    assert PenaltyError(np.array([-VALID]), {}, 1.0).estimable
    assert not PenaltyError(np.array([-1.01 * VALID]), {}, 1.0).estimable


def test_measures_without_an_estimate_do_not_raise_penalties(solid):
    """Whatever the penalty, the width of a contact that is about to part changes with it."""
    names = {"plate_normal_penalty", "plate_tangent_penalty"}
    result = sm.analyze(solid, keep_factors=True)
    before = relative_error(result, names)

    width = result.penalty_error["contact_width"]
    parts = dict.fromkeys(names, np.full(1, width.scale))
    parting = replace(width, error=sum(parts.values()), by_penalty=parts)
    assert not parting.estimable
    result.penalty_error["contact_width"] = parting
    assert relative_error(result, names) <= before


def test_one_penalty_that_is_given_stays(tmp_path):
    seal = sm.build_seal(half_disc(tmp_path, "tangent_penalty = 5e4"))
    assert seal.scalars["plate_tangent_penalty"].value == 5e4
    assert seal.scalars["plate_normal_penalty"].value > 1e5


def test_a_smaller_tolerance_takes_larger_penalties(tmp_path, solid):
    path = tmp_path / "tight.toml"
    path.write_text(HALF_DISC.replace("PENALTIES", "") + "[penalties]\ntolerance = 2e-4\n")
    tight = sm.build_seal(sm.read_seal_file(path))
    ratio = {
        name: tight.scalars[name].value / solid.scalars[name].value
        for name in ("plate_normal_penalty", "plate_tangent_penalty")
    }
    assert all(1.5 < value < 20.0 for value in ratio.values())


def test_rounding_bounds_them(solid, monkeypatch):
    monkeypatch.setattr("seal_mdao.seals.adjusted_penalties.RELATIVE_ROUNDING", 1e-12)
    highest = most_penalty(solid)
    soft = solid.with_parameters({"plate_normal_penalty": 2e4, "plate_tangent_penalty": 2e3})
    names = [penalty.name for penalty in penalties_of(solid)]
    choice = choose(soft, None, 1e-6, names, coarse=6)
    assert max(choice.penalties.values()) <= highest * 1.05  # two significant digits
    assert choice.penalty_error > 1e-6


def test_contacts_outside_files_have_penalties_that_follow_from_the_body(solid):
    contact = next(term for term in solid.definitions if term.label == "plate")
    law = ContactLaw(friction=0.2)
    assert law.open_penalties == ("normal_penalty", "tangent_penalty")
    seal = replace(solid, definitions=(solid.definitions[0], replace(contact, law=law)), changed={})
    own = {penalty.kind: penalty.value for penalty in penalties_of(seal)}
    spacing = contact.where.lengths(solid.nominal_particles).mean()
    stiffness = 3.0 * 200.0 / spacing  # E/h, the shear modulus is 2 (c10 + c01)
    assert own["normal_penalty"] == pytest.approx(300.0 * stiffness, rel=0.05)
    assert own["tangent_penalty"] == pytest.approx(10.0 * stiffness, rel=0.05)
    with pytest.raises(ValueError, match="normal_penalty of the contact 'plate' has no value"):
        replace(contact, law=law).on(None, 0)


def test_a_seal_without_contact_has_no_such_error():
    seal = sm.door_seal(n_steps=2, depth=0.6)
    result = sm.analyze(seal)
    assert set(penalty_errors(result)) >= {"reaction", "force_on_door"}
    bare = replace(result, seal=_NoContact(seal))
    assert penalty_errors(bare) == {}


class _NoContact:
    """A seal without terms."""

    def __init__(self, seal):
        self.seal = seal

    def terms(self):
        return ()


def test_designs_of_other_files_keep_them(tmp_path):
    """In a design as a file they are numbers: nothing is chosen again."""
    pytest.importorskip("tomli_w")
    file = half_disc(tmp_path)
    seal = sm.build_seal(file)
    path = write_design(file, seal, np.zeros(0), (), tmp_path, "again")[0]
    again = sm.read_seal_file(Path(path))
    assert again.open_penalties == ()
    chosen = chosen_for(file, seal)["penalties"]
    other = sm.build_seal(again)
    assert {name: other.scalars[name].value for name in chosen} == chosen
    with pytest.raises(sm.SealFileError, match="the argument penalties must contain the contacts"):
        sm.build_seal(file, penalties={"plate_normal_penalty": 1e5})


def test_larger_penalties_are_not_asked_for_where_they_were_chosen():
    seal = sm.door_seal(n_steps=8, depth=2.0, normal_penalty=100.0)
    (asked,) = [line for line in sm.analyze(seal).warnings if "permit penetration" in line]
    assert "use larger penalties" in asked
    (term,) = [penalty.name for penalty in penalties_of(seal) if penalty.kind == "normal_penalty"]
    result = sm.analyze(seal)
    result.seal.__dict__["description"] = {"chosen": {"penalties": {term: 100.0}}}
    (told,) = [line for line in result.warnings if "permit penetration" in line]
    assert "larger penalties" not in told
    assert "than those chosen" in told


def test_given_penalties_are_asked_for_beside_chosen_ones(tmp_path):
    """Larger penalties of the plate, which are given, cure the error; those of the other are chosen."""
    other = """[[profile]]
name = "other"
friction = 0.2
contact = ["dome"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 5.5]
stage = [{ translate = [0.0, -0.5], steps = 12 }]
"""
    path = tmp_path / "two.toml"
    given = "normal_penalty = 1e4\ntangent_penalty = 1e2"
    path.write_text(HALF_DISC.replace("PENALTIES", given).split("[[measure]]")[0] + other)
    seal = sm.build_seal(path)
    assert "other_normal_penalty" in seal.description["chosen"]["penalties"]
    (text,) = (own for own in sm.analyze(seal).warnings if "permit penetration" in own)
    assert "use larger penalties, in kPa/mm: plate_normal_penalty = 1e+04 (at least " in text
    assert "other_normal_penalty" not in text
    assert "than those chosen" not in text


def test_gradients_contain_the_errors(solid, monkeypatch):
    """A result with gradients has the errors of the direct method without another sweep."""
    direct = pressed(solid, 1e5, 1e4)
    known = direct.with_gradients()
    expected = direct.penalty_error
    monkeypatch.setattr("seal_mdao.seals.penalty_error.direct_rates", None)
    assert known.penalty_error.keys() == expected.keys()
    for name, found in known.penalty_error.items():
        assert found.scale == expected[name].scale
        for penalty, part in found.by_penalty.items():
            assert part == pytest.approx(expected[name].by_penalty[penalty], rel=1e-9, abs=1e-12)
    # those at the end of the path are not those of its parts
    assert all(part.gradients is None for part in known.up_to_each_step())
