"""Local states that mean nothing are reported, and singular points of stress are named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli.examples import examples_folder
from seal_mdao.measures.singular_points import singular_points
from seal_mdao.seals import local_states
from seal_mdao.seals.checks import findings
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.local_states import meaningless_states, stress_peak
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.particle_stress import particle_stress
from seal_mdao.structure.region import Region

RUBBER, STIFF = sm.MooneyRivlin(80.0, 20.0, 2e4), sm.MooneyRivlin(320.0, 80.0, 8e4)
# the shear modulus of the rubber, and a Poisson's ratio of 0.36
FOAM = sm.MooneyRivlin(80.0, 20.0, 600.0)


@pytest.fixture(scope="module")
def pressed():
    return sm.analyze(sm.door_seal(door="flat", depth=2.0, n_steps=8))


def l_shape():
    """Nine particles of three square cells around a re-entrant corner; the lowest side is fixed."""
    particles = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [0, 2], [1, 2]], float)
    cells = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6]])
    fixed = np.zeros((8, 2), bool)
    fixed[:3] = True
    return SimpleNamespace(cells=cells, fixed=fixed), particles


def test_an_ordinary_state_is_trustworthy(pressed):
    assert not list(meaningless_states(EvaluationPoints(pressed.path)))
    assert pressed.trustworthy


@pytest.mark.parametrize(
    ("limit", "text"),
    [("LARGEST_STRETCH", "principal stretch is"), ("LARGEST_STRESS", "von Mises stress is")],
)
def test_a_state_beyond_any_rubber_is_named_with_its_cure(pressed, monkeypatch, limit, text):
    monkeypatch.setattr(local_states, limit, 1e-3)
    monkeypatch.setattr(local_states, "ABOVE_NEIGHBOURS", 1e-3)
    again = replace(pressed, path=replace(pressed.path))
    (found,) = [line for line in again.warnings if text in line]
    assert "undeformed" in found
    assert local_states.CURE in found
    assert again.converged
    assert not again.trustworthy


def test_a_stress_that_is_no_number_is_that_of_inverted_material(pressed, monkeypatch):
    disc = pressed.path.discretization
    places = disc.body.samples.at(disc.particles)
    stress = particle_stress(pressed.path, np.arange(len(places)))
    worst = int(stress.value.argmax())
    unknown = np.where(np.arange(len(places)) == worst, np.nan, stress.value)
    monkeypatch.setattr(local_states, "particle_stress", lambda *_: stress._replace(value=unknown))
    ((text, point),) = meaningless_states(EvaluationPoints(replace(pressed.path)))
    assert "stress cannot be computed at x = " in text
    assert "inverted" in text
    assert np.array_equal(point, places[worst])


def test_a_high_stress_all_around_is_not_that_of_a_point(pressed, monkeypatch):
    monkeypatch.setattr(local_states, "LARGEST_STRESS", 1e-3)
    monkeypatch.setattr(local_states, "ABOVE_NEIGHBOURS", 1e3)
    assert not list(meaningless_states(EvaluationPoints(pressed.path)))


def test_ends_of_fixed_edges_and_reentrant_corners_are_singular():
    found = singular_points(*l_shape(), ElasticBody((Region(RUBBER),)))
    assert sorted((*point.place, point.kind) for point in found) == [
        (0.0, 0.0, "the end of a fixed edge"), (1.0, 1.0, "a re-entrant corner"),
        (2.0, 0.0, "the end of a fixed edge"),
    ]  # fmt: skip
    assert all(point.spacing == 1.0 for point in found)


def inserts(numbers, materials, fixed=()):
    """Points and kinds of a square grid of 3 x 3 cells of side 1, with the regions ``numbers`` (3, 3) of
    the cells from below, the rows of particles ``fixed`` as (row, component)."""
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    particles = np.column_stack([x.ravel(), y.ravel()])
    lower = (np.arange(3)[:, None] * 4 + np.arange(3)).ravel()
    cells = lower[:, None] + [0, 1, 5, 4]
    prescribed = np.zeros((16, 2), bool)
    for row, component in fixed:
        prescribed[4 * row : 4 * row + 4, component] = True
    numbers = np.ravel(numbers)
    regions = [Region(own, np.flatnonzero(numbers == k)) for k, own in enumerate(materials)]
    body = SimpleNamespace(cells=cells, fixed=prescribed)
    found = singular_points(body, particles, ElasticBody(tuple(regions)))
    return sorted((*point.place.tolist(), point.kind) for point in found)


END, CORNER = (
    "the end of an interface between materials",
    "a corner of an interface between materials",
)


def test_ends_and_corners_of_interfaces_are_singular():
    """A layer, and an insert at the left side; order and material of the regions do not matter."""
    layer = [[0] * 3, [1] * 3, [1] * 3]
    assert inserts(layer, (RUBBER, STIFF)) == [(0.0, 1.0, END), (3.0, 1.0, END)]
    insert = [[0, 0, 0], [1, 0, 0], [0, 0, 0]]
    expected = [(0.0, 1.0, END), (0.0, 2.0, END), (1.0, 1.0, CORNER), (1.0, 2.0, CORNER)]
    assert inserts(insert, (RUBBER, STIFF)) == expected
    assert inserts(insert, (STIFF, RUBBER)) == expected
    assert inserts(insert, (RUBBER, FOAM)) == expected
    # three materials: a junction
    junction = [[0, 0, 0], [1, 2, 2], [1, 2, 2]]
    both = inserts(junction, (RUBBER, STIFF, FOAM))
    assert (1.0, 1.0, CORNER) in both
    assert len(both) == 4


def test_interfaces_of_one_stiffness_are_not_singular():
    layer = [[0] * 3, [1] * 3, [1] * 3]
    for factor in (1.0, 1.2, 1.3, 1.0 / 1.2, 1.0 / 1.3):
        other = RUBBER.with_(c10=80.0 * factor, c01=20.0 * factor)
        assert bool(inserts(layer, (RUBBER, other))) == (not 0.8 <= factor <= 1.25)


def test_interfaces_across_planes_of_symmetry_are_not_singular():
    """Square to them; they end as singular points at edges that are fixed in both directions."""
    layer = [[0, 1, 1]] * 3
    planes = ((0, 1), (3, 1))
    assert inserts(layer, (RUBBER, STIFF), planes) == []
    kinds = [kind for *_, kind in inserts(layer, (RUBBER, STIFF), (*planes, (0, 0)))]
    assert kinds.count(END) == 1
    assert kinds.count("the end of a fixed edge") == 2


def test_largest_stress_at_a_singular_point_is_named_with_that_elsewhere():
    body, particles = l_shape()
    particles = 3.0 * particles
    places = np.vstack([particles, [[3.1, 3.1], [6.0, 100.0]]])
    stress = np.append(np.linspace(1.0, 2.0, len(particles)), [9.0, 5.0])
    disc = SimpleNamespace(body=body, particles=particles)
    elastic = SimpleNamespace(definition=ElasticBody((Region(RUBBER),)))
    path = SimpleNamespace(discretization=disc, problem=SimpleNamespace(term=lambda _: elastic))
    result = SimpleNamespace(path=path, section_stress=lambda: (places, stress))
    peak = stress_peak(result)
    assert (peak.stress, peak.singular) == (9.0, "a re-entrant corner")
    assert peak.elsewhere[0] == 5.0
    assert peak.elsewhere[1].tolist() == [6.0, 100.0]
    stress[-1] = 10.0
    peak = stress_peak(result)
    assert (peak.stress, peak.singular) == (10.0, "")


def sponge_bulb():
    """A bulb of sponge with its air, pressed by 6.5 of 14 mm: its lowest corners are squeezed flat."""
    text = (examples_folder() / "sealed_bulb.toml").read_text(encoding="utf-8")
    rest = text.split("[section]")[1]
    tail = rest[: rest.index("[[design]]")]
    tail = tail.replace("[0.0, -4.05]", "[0.0, -6.5]").replace("steps = 40", "steps = 60")
    penalties = "friction = 0.25\nnormal_penalty = 2e4\ntangent_penalty = 1e3"
    penalties += '\ncontact_points = "particles"'
    tail = tail.replace("friction = 0.25", penalties)
    return f'[material.rubber]\nsponge = "2A3"\n[section]{tail}'


def test_sponge_below_a_fifth_of_its_volume_is_not_trustworthy(tmp_path):
    """There the largest stress grows to many times that of all but one point in 200, in 1.5 mm."""
    path = tmp_path / "bulb.toml"
    path.write_text(sponge_bulb(), encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    states = []
    for part in list(result.up_to_each_step())[-16:]:
        least = EvaluationPoints(part.path).volume_change.min()
        stress = part.section_stress()[1]
        flagged = [own for own in findings(part.path) if "det F" in own.text]
        assert bool(flagged) == (least < 0.2)
        assert all(own.meaningless for own in flagged)
        assert not (flagged and part.trustworthy)
        states.append((least, stress.max() / np.quantile(stress, 0.995)))
    assert max(least for least, _ in states) > 0.3
    assert all(ratio < 2.5 for least, ratio in states if least > 0.2)
    assert max(ratio for _, ratio in states) > 10.0
