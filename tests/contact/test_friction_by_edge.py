"""Friction of every edge of a contact, and of pairs of edges in self-contact."""

from dataclasses import replace
from functools import reduce
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.friction import SLIP, STICK
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.friction_law import friction_law
from seal_mdao.seals.settings import seal_of

# the rod slides over two edges of the back, the body touches two of the lip
DIVIDED = {
    "line = [[0.5, 2.0], [0.5, 8.0]]": "line = [[0.5, 2.0], [0.5, 6.5]]\n"
    '[[section.outer]]\nedge = "upper"\nline = [[0.5, 6.5], [0.5, 8.0]]',
    "line = [[-0.7, 8.0], [-0.7, 2.0]]": "line = [[-0.7, 8.0], [-0.7, 5.4]]\n"
    '[[section.outer]]\nedge = "lower"\nline = [[-0.7, 5.4], [-0.7, 2.0]]',
    '["body", "lip", "tip"]': '["body", "lip", "upper"]',
    'contact = ["back", "tip"]': 'contact = ["back", "lower"]\ncontact_points = "particles"',
}
LIP = reduce(
    lambda text, pair: text.replace(*pair),
    DIVIDED.items(),
    (Path(__file__).parent / "folded_lip.toml").read_text(),
)
ALL_PAIRS = "".join(
    f'[[self_contact.pair]]\nedges = [{names}]\nfriction = {{}}\n'
    for names in (
        '"body", "upper"', '"lip", "body"', '"upper", "lip"', '"body"', '"lip"', '"upper"',
    )
)  # fmt: skip
OFFSETS = [0.02, 0.01, -0.01, 0.0, 0.01, 0.0]


def file_with(folder, on_rod, pairs, single="", lip=LIP):
    """The lip with friction by edge on the rod, and pairs of edges in self-contact."""
    text = lip.replace("friction = 0.3\n", single)
    text = text.replace("friction = 0.05\n", f"friction = {{ {on_rod} }}\n")
    path = folder / "lip.toml"
    path.write_text(text.replace("[fixed]", pairs + "[fixed]"))
    return path


def analyzed(path):
    seal = replace(sm.build_seal(path), newton=sm.NewtonOptions(tolerance=1e-11))
    result = sm.analyze(seal, OFFSETS)
    assert result.converged, result.failure
    return result


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    path = tmp_path_factory.mktemp("single") / "lip.toml"
    path.write_text(LIP)
    return analyzed(path)


@pytest.fixture(scope="module")
def equal(tmp_path_factory):
    """Equal coefficients of all edges and pairs."""
    pairs = ALL_PAIRS.format(*[0.3] * 6)
    return analyzed(file_with(tmp_path_factory.mktemp("equal"), "back = 0.05, lower = 0.05", pairs))


PAIRS = """[[self_contact.pair]]
edges = ["body", "upper"]
friction = 0.5
"""


@pytest.fixture(scope="module")
def different(tmp_path_factory):
    folder = tmp_path_factory.mktemp("different")
    return analyzed(file_with(folder, "back = 0.02, lower = 0.2", PAIRS, "friction = 0.3\n"))


def test_equal_coefficients_are_one_coefficient(single, equal):
    """Values to rounding; the derivative by one coefficient is the sum of those by all."""
    names = [n for n in equal.seal.scalars if "friction" in n]
    assert len(names) == 8
    ahead = sm.differentiate(equal, names, equal.seal.standard)
    whole = ("rod_friction", "self_contact_friction")
    expected = sm.differentiate(single, whole, single.seal.standard)
    for measure in single.seal.standard:
        assert equal.value(measure)[0] == pytest.approx(single.value(measure)[0], rel=1e-9)
        rows = np.ravel(ahead[measure.name])[6:]
        of_rod = [name.startswith("rod") for name in names]
        found = [rows[of_rod].sum(), rows[np.invert(of_rod)].sum()]
        exact = np.ravel(expected[measure.name])[6:]
        assert np.abs(exact).min() > 0.0
        np.testing.assert_allclose(found, exact, rtol=1e-7)


def test_every_point_slips_at_the_limit_of_its_edge(different):
    """|f_t| = mu v |f_n| with v = R / (R + g_n) on a circle; the corner belongs to the first edge."""
    term, ratios = different.term("rod"), {"back": [], "lower": []}
    edges = different.seal.body.edges
    for step in different.path.steps:
        response = step.responses[different.path.index_of("rod")]
        arms = response.x - term.pose(step.fraction).position
        normal = arms / np.hypot(*arms.T)[:, None]
        along = (response.force * normal).sum(axis=1)
        across = response.force @ [[0.0, 1.0], [-1.0, 0.0]]
        limit = np.abs((across * normal).sum(axis=1)) * (1.0 + response.gap / 1.5)
        for i in np.flatnonzero(response.branch == SLIP):
            on_back = np.isin(term.where.at_particles[i], edges["back"].particles)
            ratios["back" if on_back else "lower"].append(limit[i] / abs(along[i]))
    for name, friction in (("back", 0.02), ("lower", 0.2)):
        assert ratios[name]
        np.testing.assert_allclose(ratios[name], friction, rtol=1e-9)


OF_PAIR = "self_contact_friction_body_upper"
NAMES = ("rod_friction_back", "rod_friction_lower", "self_contact_friction", OF_PAIR)


def test_direct_and_adjoint_derivatives_agree(different):
    direct, adjoint = (
        sm.differentiate(different, NAMES, different.seal.standard, method)
        for method in ("direct", "adjoint")
    )
    for measure in different.seal.standard:
        one, other = direct[measure.name], adjoint[measure.name]
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize("name", ["rod_friction_back", OF_PAIR, "self_contact_friction"])
def test_derivatives_are_those_of_difference_quotients(different, name):
    touching = [r.branch for r in different.path.responses("self_contact")]
    assert np.isin(np.hstack(touching), (STICK, SLIP)).any()
    exact, errors = sm.differentiate(different, NAMES, different.seal.standard), []
    column, value = 6 + NAMES.index(name), different.seal.scalars[name].value
    for step in (1e-5, 1e-6):
        ends = [
            sm.analyze(different.seal, OFFSETS, {name: value + sign * step}) for sign in (1, -1)
        ]
        error = 0.0
        for measure in different.seal.standard:
            slopes = np.atleast_2d(exact[measure.name])
            quotient = (ends[0].value(measure) - ends[1].value(measure)) / (2.0 * step)
            error = max(error, abs(quotient[0] / slopes[0, column] - 1.0))
        errors.append(error)
    assert min(errors) < 1e-5


def test_parameters_change_and_settings_keep_them(tmp_path):
    path = file_with(tmp_path, "back = 0.02, lower = 0.2", PAIRS)
    seal = sm.build_seal(path).with_parameters({"rod_friction_lower": 0.4})
    assert seal.scalars["rod_friction_lower"].value == 0.4
    other = seal_of(seal.settings())
    assert other.scalars == seal.scalars
    with pytest.raises(ValueError, match="friction of 'lower'"):
        seal.with_parameters({"rod_friction_lower": -0.1})


def test_laws_and_coefficients_mix():
    """Limits of a law and of a coefficient at points of two groups, with their slopes."""

    def saturating(pressure, friction, reference):
        return friction * pressure / (1.0 + pressure / reference)

    law = friction_law(saturating, friction=0.5, reference=60.0)
    both = FrictionByGroup(("seal", "lip"), (law, 0.2)).among(np.array([1, 0, 1]))
    assert list(both.by_name) == ["friction_seal", "reference_seal", "friction_lip"]
    pressure = np.array([10.0, 20.0, 0.0])
    found = both.at(pressure)
    np.testing.assert_array_equal(found[1, :, :4], law.at(pressure[1:2])[0])
    np.testing.assert_array_equal(found[0], [[2.0, 0.2, 0.0, 0.0, 10.0]] * 2)
    changed = both.with_constants({"reference_seal": 30.0, "friction_lip": 0.1})
    assert changed.by_name == {"friction_seal": 0.5, "reference_seal": 30.0, "friction_lip": 0.1}


def test_only_pairs_that_are_named_touch(tmp_path, different):
    """Without a friction of all others."""
    path = file_with(tmp_path, "back = 0.02, lower = 0.2", PAIRS)
    own = sm.build_seal(path).terms()[2]
    edges = {name: different.seal.body.edge(name).particles for name in ("body", "lip", "upper")}
    particles, allowed = own.where.of_particles, own.may_touch()
    on_body = np.isin(particles, edges["body"])
    on_upper = np.isin(particles, edges["upper"][1:-1])
    assert allowed[np.ix_(on_body, on_upper)].any()
    assert not allowed[np.ix_(on_body, on_body)].any()
    assert different.seal.terms()[2].may_touch()[np.ix_(on_body, on_body)].any()


@pytest.mark.parametrize(("opposite", "friction"), [("upper", 0.5), ("lip", 0.3)])
def test_segment_that_begins_on_another_edge_has_the_friction_of_its_end(
    different, opposite, friction
):
    """Where the first end of the segment is on no edge that touches."""
    own, term = different.seal.terms()[2], different.term("self_contact")
    particles = own.where.of_particles
    point, touched = (
        int(np.flatnonzero(np.isin(particles, different.seal.body.edge(name).particles[1:-1]))[0])
        for name in ("body", opposite)
    )
    other = int(np.flatnonzero(~own.may)[0])
    assert term.pair_of[term.edge_of[point], term.edge_of[other]] < 0
    nodes = np.zeros((3, 6), int)
    nodes[:, 3:5] = [[touched, touched], [other, touched], [touched, other]]
    found = term.law_at(np.full(3, -1e-3), np.full(3, point), nodes).limits
    # half of the limit by the whole pressure: mu w 1e-3
    exact = 0.5 * friction * term.complete_law.normal_penalty * 1e-3
    np.testing.assert_allclose(found[:, 0, 0], exact, rtol=1e-12)


WRONG = {
    "unknown edge": (
        ("back = 0.1, lowr = 0.2", ""),
        "no such edge in contact (did you mean 'lower'?)",
    ),
    "no contact": (("back = 0.1, lip = 0.2", ""), "no such edge in contact"),
    "left out": (("back = 0.1", ""), "friction has no coefficient for the edge 'lower'"),
    "negative": (("back = 0.1, lower = -0.2", ""), "or a table of these by edge"),
    "no such pair": (
        ("back = 0.1, lower = 0.2", PAIRS.replace('"upper"', '"back"')),
        "no such edge in",
    ),
    "twice": (
        ("back = 0.1, lower = 0.2", PAIRS + PAIRS),
        "is already in [[self_contact.pair]] 1",
    ),
    "no friction": (
        ("back = 0.1, lower = 0.2", ""),
        "give it, or a [[self_contact.pair]]",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_contradictions_are_refused(tmp_path, wrong):
    (on_rod, pairs), message = WRONG[wrong]
    single = "" if wrong == "no friction" else "friction = 0.3\n"
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file(file_with(tmp_path, on_rod, pairs, single))
    assert message in str(caught.value)
