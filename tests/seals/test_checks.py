"""A result checks itself: what equilibrium alone would let pass as a good answer."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import FIXED, LID, text

import seal_mdao as sm
from seal_mdao.rkpm.cells import sides_of
from seal_mdao.seals import checks
from seal_mdao.seals.checks import crosses_itself, findings
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.instabilities import instabilities
from seal_mdao.seals.local_states import stress_peak
from seal_mdao.seals.overlap import crossings

REFERENCES = Path(__file__).parents[1] / "verification" / "references"


@pytest.fixture(scope="module")
def deep():
    """Pressed 18 mm: lobes meet, cross, and come to lie in the door."""
    return sm.analyze(sm.door_seal(depth=18.0, n_steps=190))


def analysed(**changes):
    result = sm.analyze(sm.door_seal(**changes))
    assert result.converged
    return result


def impossible(result):
    return [found.text for found in findings(result.path) if found.impossible]


def test_example_under_a_flat_door_has_nothing_to_say():
    assert analysed(door="flat").warnings == ()


def test_example_says_nothing_but_what_its_penalties_do():
    result = analysed()
    assert findings(result.path) == ()
    (text,) = result.warnings
    assert "the contact penalties permit penetration, which makes " in text
    assert re.search(r"gap_square_sum [\d.]+ % too small", text)


@pytest.mark.parametrize(("depth", "overlap", "possible"), [(14.6, 2.7, True), (15.0, 22.0, False)])
def test_inner_boundary_that_crosses_itself_is_told(depth, overlap, possible):
    """With its overlap in percent of the wall; local values mean nothing in both states."""
    result = analysed(depth=depth)
    (found,) = (own for own in findings(result.path) if "crosses itself" in own.text)
    said = float(re.search(r"([\d.]+) % of the wall thickness", found.text)[1])
    assert said == pytest.approx(overlap, rel=0.05)
    assert (found.impossible, found.meaningless) == (not possible, True)
    assert not result.trustworthy
    assert found.text.endswith(
        "no self-contact is defined between parts of the edge 'cavity'; use [self_contact] edges = "
        '["cavity"] to define it, or less travel'
    )
    # the fault that explains others is first
    assert result.warnings[0] == found.text


def test_deep_crossing_is_no_result(deep):
    assert any("crosses itself" in text for text in impossible(deep))
    assert crosses_itself(deep.path)
    assert not crosses_itself(replace(deep.path, steps=deep.path.steps[:50]))


def test_a_crossing_despite_contact_does_not_ask_for_contact(deep, monkeypatch):
    """All walls in contact: a crossing deeper than the penetration is that of its penalty."""
    everywhere = lambda samples, sides: (np.zeros(len(sides)), np.ones(len(sides), bool))  # noqa: E731
    monkeypatch.setattr(checks, "_allowed_depth", everywhere)
    (text,) = [
        t for t in impossible(replace(deep, path=replace(deep.path))) if "crosses itself" in t
    ]
    assert "the self-contact between parts of the edge 'cavity' does not prevent it" in text
    assert "no self-contact" not in text


def test_a_crossing_of_neighbours_in_self_contact_does_not_ask_for_contact(deep, monkeypatch):
    """The wall is in contact with itself, but for points that are close along the boundary."""
    cavity = deep.path.discretization.body.edges["cavity"].particles

    def term(pair_of):
        return SimpleNamespace(
            where=SimpleNamespace(of_particles=cavity),
            label=deep.path.problem.terms[1].label,
            pair_of=pair_of,
            gaps=lambda x: (np.empty(0, int), np.empty(0)),
        )

    def said(pair_of):
        monkeypatch.setattr(checks, "_contacts_with_itself", lambda samples: [term(pair_of)])
        monkeypatch.setattr(
            checks, "_allowed_depth",
            lambda samples, sides: (np.zeros(len(sides)), np.zeros(len(sides), bool)),
        )  # fmt: skip
        path = replace(deep.path)
        (text,) = [t for t in impossible(replace(deep, path=path)) if "crosses itself" in t]
        return text

    assert "the self-contact between parts of the edge 'cavity' leaves out points" in said(None)
    assert "round the corner there" in said(None)
    # where pairs of edges are listed, this one may be missing
    assert "no self-contact is defined" in said(np.zeros((1, 1), int))


def test_no_energy_is_given_for_a_jump_into_a_crossing(deep):
    """The wall has no contact with itself where it lies after the jump."""
    jump = SimpleNamespace(
        fraction=deep.path.steps[-2].fraction, kind="limit", moved=1.0, released=5.0,
        mode=np.ones_like(deep.path.steps[-1].d),
    )  # fmt: skip
    path = replace(deep.path)
    vars(path)["critical_points"] = [jump]
    (found,) = instabilities(replace(deep, path=path))
    assert np.isnan(found.released)
    assert "where the boundary crosses itself, so that no energy is given" in found.text
    vars(path)["critical_points"] = [SimpleNamespace(**vars(jump) | {"fraction": 10.5})]
    (found,) = instabilities(replace(deep, path=path))
    assert found.released == 5.0
    assert "releases" in found.text


def test_inner_boundary_inside_the_door_is_no_result(deep):
    """Although no contact point is deeper than a penalty allows."""
    assert deep.max_penetration < 0.01
    assert any("inside the rigid profile 'door'" in text for text in impossible(deep))


def test_lobes_below_the_base_are_told(deep):
    assert any("below the plane of its base" in text for text in deep.warnings)
    assert not any("below the plane" in text for text in impossible(deep))


@pytest.mark.parametrize("inner", [6.0, 5.75])
def test_base_of_a_thick_wall_is_singular_at_its_ends(inner):
    """Twice as many particles invert more of it (-0.02 to -0.1 for 6 mm); the force changes by 1.3 %."""
    result = analysed(section=sm.Section(inner, 9.5))
    (found,) = (own for own in findings(result.path) if "det F" in own.text)
    assert "at the end of a fixed edge" in found.text
    assert not found.impossible
    assert not result.trustworthy


def test_inverted_material_elsewhere_is_no_result(bonded, monkeypatch):
    nowhere = lambda samples, points: np.full(len(points), "")  # noqa: E731
    monkeypatch.setattr(checks, "ends_of_bonds", nowhere)
    found = impossible(replace(bonded, path=replace(bonded.path)))
    assert any("material is inverted between the quadrature points" in text for text in found)


@pytest.mark.parametrize("radius", [1.0, 0.5, 0.1])
def test_sharp_corner_between_contact_points_is_told(radius):
    result = analysed(nominal_door_radius=radius)
    assert result.max_penetration < 0.005
    assert any("inside the rigid profile" in text for text in result.warnings)


def test_soft_penalty_is_told_and_softer_is_no_result():
    told, wrong = (analysed(normal_penalty=w_n, n_steps=40) for w_n in (100.0, 20.0))
    assert any("inside the rigid profile" in text for text in told.warnings)
    assert any("inside the rigid profile" in text for text in impossible(wrong))


def test_places_without_a_gap_are_no_result(nominal, monkeypatch):
    """NaN is not taken for a gap that is open."""
    path = replace(nominal.path)
    monkeypatch.setattr(
        type(path.problem.term("door")), "gaps", lambda self, x, _: np.full(len(x), np.nan)
    )
    found = [found for found in findings(path) if found.impossible]
    assert any("inside the rigid profile 'door'" in one.text for one in found)


def test_iterations_that_rounding_ended_are_no_result():
    """The constructors refuse such moduli; a law of one's own may have them."""
    seal = sm.door_seal(n_steps=20)
    (region,) = seal.definitions[0].regions
    object.__setattr__(region.material, "bulk_modulus", 1e30)
    result = sm.analyze(seal)
    assert result.converged
    assert any(
        "(number of the step): rounding errors or a large" in text for text in impossible(result)
    )


def test_component_raises_an_analysis_error_that_names_it():
    problem = om.Problem(reports=None)
    seal = sm.door_seal(depth=18.0, n_steps=190)
    problem.model = sm.SealGroup(seal=seal, measures=("reaction",))
    problem.setup()
    with pytest.raises(om.AnalysisError, match="crosses itself"):
        problem.run_model()


def test_walls_that_do_not_touch_each_other_have_no_crossing(tmp_path):
    """Self-contact that nothing has reached at the end of the path."""
    path = tmp_path / "block.toml"
    apart = '[self_contact]\nedges = ["left", "right"]\nfriction = 0.5\n'
    penalties = "normal_penalty = 1e4\ntangent_penalty = 1e3\n"
    path.write_text(text(FIXED, LID, apart + penalties), encoding="utf-8")
    found = sm.analyze(sm.build_seal(path)).warnings
    assert not [own for own in found if "crosses itself" in own]


def test_path_that_failed_has_a_failure_and_no_warnings(buckled):
    assert not buckled.converged
    assert buckled.warnings == ()


def test_sides_of_cells():
    """Two cells side by side share one side."""
    outer, inner = sides_of(np.array([[0, 1, 4, 3], [1, 2, 5, 4]]))
    assert sorted(map(tuple, np.sort(inner))) == [(1, 4)]
    assert sorted(map(tuple, outer)) == [(0, 1), (1, 2), (2, 5), (3, 0), (4, 3), (5, 4)]


def test_wall_is_the_thickness(nominal):
    """Of a ring nearly that of its radii; the base is thicker."""
    assert EvaluationPoints(nominal.path).wall == pytest.approx(2.0, rel=0.02)


def test_crossings_of_a_bow_tie():
    x = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
    segments = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    pairs, depth = crossings(x, segments)
    assert pairs.tolist() == [[0, 2]]
    assert depth == pytest.approx([np.sqrt(0.5)])


@pytest.fixture(scope="module")
def bonded(tmp_path_factory):
    """A half disc on a fixed foot, whose ends are singular points, pressed by 1.5 of 5 mm."""
    norm = '[[measure]]\ntype = "stress_norm"\n'
    away = f'{norm}[[measure]]\ntype = "von_mises"\nname = "away"\naway_from_singular = 0.5\n'
    path = tmp_path_factory.mktemp("disc") / "half_disc.toml"
    path.write_text((REFERENCES / "half_disc.toml").read_text(encoding="utf-8") + away, "utf-8")
    return sm.analyze(sm.build_seal(path))


def test_inverted_end_of_a_fixed_edge_is_named_and_admissible(bonded):
    """It is singular, and the force is right within 1 % (``test_solid_sections``)."""
    (found,) = (own for own in findings(bonded.path) if "det F" in own.text)
    assert "inverted at the end of a fixed edge" in found.text
    assert re.search(r"x = -?5, y = 0 ", found.text)
    assert (found.impossible, found.meaningless) == (False, True)
    assert not any("nan" in text for text in bonded.warnings)
    bonded.require_possible()


def on_a_stiff_block(text: str) -> str:
    """The half disc on a block of 10 x 2 mm of a rubber 500 times as stiff."""
    rubber = text[text.index("[material.rubber]") : text.index("[section]")]
    stiff = rubber.replace("rubber", "stiff").replace("= 80.0", "= 4e4").replace("= 20.0", "= 1e4")
    below = '{ edge = "foot", line = [[-5, -2], [5, -2]] },'
    below = '{ edge = "side", line = [[-5, 0], [-5, -2]] }, ' + below
    region = (
        '[[section.region]]\nmaterial = "stiff"\nat = [0, -1]\nline = [[-5, 0], [5, 0]]\n[fixed]'
    )
    for old, new in (
        ("[section]", stiff.replace("= 80000.0", "= 4e7") + "[section]"),
        ('{ edge = "foot", line = [[-5.0, 0.0], [5.0, 0.0]] },', below),
        ('{ edge = "dome"', '{ edge = "other", line = [[5, -2], [5, 0]] }, { edge = "dome"'),
        ("[fixed]", region),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    return text


def test_inverted_end_of_an_interface_is_named_and_admissible(tmp_path):
    """As the end of a fixed edge: the more particles, the more of it is inverted."""
    path = tmp_path / "block.toml"
    path.write_text(on_a_stiff_block((REFERENCES / "half_disc.toml").read_text(encoding="utf-8")))
    result = sm.analyze(sm.build_seal(path))
    (found,) = (own for own in findings(result.path) if "det F" in own.text)
    assert (
        "material 'rubber' is inverted at the end of an interface between materials" in found.text
    )
    assert re.search(r"x = -?5, y = 0 ", found.text)
    assert "away_from_singular" in found.text
    assert (found.impossible, found.meaningless) == (False, True)
    peak = stress_peak(result)
    assert peak.singular == "the end of an interface between materials"
    assert np.hypot(np.abs(peak.elsewhere[1][0]) - 5.0, peak.elsewhere[1][1]) > 0.6


def test_inverted_material_is_beside_the_ends_of_the_fixed_edge_alone(bonded):
    samples = EvaluationPoints(bonded.path)
    inverted = samples.undeformed[samples.volume_change <= 0.0]
    assert len(inverted)
    assert np.all(np.hypot(np.abs(inverted[:, 0]) - 5.0, inverted[:, 1]) < 0.4)


def test_stress_of_an_inverted_end_is_refused_unless_it_is_left_out(bonded):
    force, norm, away = (bonded.measure(name) for name in ("reaction", "stress_norm", "away"))
    assert np.isfinite(bonded.admissible_values([force, away])["away"]).all()
    with pytest.raises(
        sm.LoadPathError, match="stress_norm cannot be evaluated: material is inverted"
    ):
        bonded.admissible_values([force, norm, away])
