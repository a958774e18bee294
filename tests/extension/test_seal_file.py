"""Friction laws, a material, a term, a profile and a measure of a user's own, named in a seal file."""

import importlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from agreement import assert_methods_agree, assert_quotients_agree
from quotients import quotients

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP, STICK

HERE = Path(__file__).parent
BLOCK = (HERE / "block.toml").read_text(encoding="utf-8")
GIVEN = '{ law = "pressure_dependent", friction = 0.5, reference = 60.0 }'
LAWS = {
    "pressure_dependent": (GIVEN, ("roll_friction", "roll_reference")),
    "directional": ('{ law = "directional", forward = 0.4, backward = 0.15 }',
                    ("roll_forward", "roll_backward")),
}  # fmt: skip
EXTENSIONS = ("arruda_boyce", "elastic_foundation", "ellipse", "highest_point", *LAWS)
LIP = HERE.parent / "contact" / "folded_lip.toml"
STEP = 5e-5


@pytest.fixture(scope="module", autouse=True)
def extensions():
    """The files of the extensions, each imported once."""
    return [importlib.import_module(name) for name in EXTENSIONS]


def built(tmp_path, text, *changes):
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "seal.toml"
    path.write_text(text)
    return replace(sm.build_seal(path), newton=sm.NewtonOptions(tolerance=1e-11))


@pytest.fixture(scope="module", params=LAWS)
def case(request, tmp_path_factory):
    """The result of the block with one of the laws, and the names of its constants."""
    given, names = LAWS[request.param]
    seal = built(tmp_path_factory.mktemp("block"), BLOCK, (GIVEN, given))
    return sm.analyze(seal, keep_factors=True), names


@pytest.fixture(scope="module")
def tables(case):
    """Derivatives with respect to everything, by both methods."""
    result, _ = case
    names = tuple(result.seal.scalars)
    return [sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")]


@pytest.mark.parametrize("name", EXTENSIONS)
def test_an_extension_is_one_short_file(name):
    lines = (HERE / f"{name}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= (20 if name in LAWS else 65)


def test_the_problem_has_something_to_show(case):
    """Open, sticking and slipping points; constants under the names of the extensions."""
    result, names = case
    assert result.converged
    branches = [set(own.branch.tolist()) for own in result.path.at_nominal("roll")]
    assert {OPEN, STICK, SLIP} <= set().union(*branches)
    own = {"modulus", "links", "springs_stiffness", "roll_a", "roll_b", *names}
    assert own <= set(result.seal.scalars)
    assert [measure.name for measure in result.seal.standard] == ["highest_point", "reaction"]


def test_slipping_points_are_at_the_limit_of_the_law(case):
    """tau = +-limit(p) at p = w_n |g_n|, by the formula as it stands in the user's file."""
    result, names = case
    seal, roll = result.seal, result.term("roll")
    function, constants = roll.law.friction.limits, [seal.scalars[name].value for name in names]
    found = 0
    for own in result.path.at_nominal("roll"):
        for i in np.flatnonzero(own.branch == SLIP):
            limits = np.broadcast_to(function(-1e4 * own.gap[i], *constants), 2)
            tau = 1e3 * own.history.variables[i, 2]
            assert abs(tau) == pytest.approx(limits[0 if tau > 0.0 else 1], rel=1e-12)
            found += 1
    assert found > 10


def test_direct_and_adjoint_agree(case, tables):
    assert_methods_agree(case[0].seal, tables)


def test_both_agree_with_central_differences(case, tables):
    assert_quotients_agree(case[0].seal, tables, STEP, certainty=1e-4)


def test_constants_of_a_law_are_inputs_of_openmdao(case, tables):
    om = pytest.importorskip("openmdao.api")
    result, names = case
    problem = om.Problem(reports=False)
    group = sm.SealGroup(seal=result.seal, parameters=names)
    problem.model.add_subsystem("seal", group, promotes=["*"])
    problem.setup()
    problem.run_model()
    totals = problem.compute_totals(["reaction"], list(names))
    for name in names:
        exact = tables[0].reaction[0, tables[0].parameters.index(name)]
        assert totals["reaction", name][0, 0] == pytest.approx(exact, rel=1e-9)


def lip(tmp_path, friction):
    """The lip that folds on its body, with a friction law for the profile and for the self-contact."""
    text = LIP.read_text(encoding="utf-8")
    return built(tmp_path, text, ("friction = 0.3\n", f"friction = {friction(0.3)}\n"),
                 ("friction = 0.05\n", f"friction = {friction(0.05)}\n"))  # fmt: skip


@pytest.fixture(scope="module")
def lips(tmp_path_factory):
    """Results with Coulomb's law, with the same as a user's law, and with a nonlinear one."""
    forms = {
        "coulomb": "{{ law = 'coulomb', friction = {0} }}",
        "own": "{{ law = 'directional', forward = {0}, backward = {0} }}",
        "nonlinear": "{{ law = 'pressure_dependent', friction = {0}, reference = 40.0 }}",
    }
    folder = tmp_path_factory.mktemp("lip")
    return {name: sm.analyze(lip(folder, form.format), keep_factors=True)
            for name, form in forms.items()}  # fmt: skip


def test_coulombs_law_as_a_users_own_gives_the_same_path(lips):
    """Rigid contact and self-contact."""
    shipped, own = lips["coulomb"], lips["own"]
    branch = own.path.at_nominal("self_contact")[-1].branch
    assert {STICK, SLIP} & set(branch.tolist())
    size = np.abs(shipped.displacement(-1)).max()
    assert np.abs(own.displacement(-1) - shipped.displacement(-1)).max() <= 1e-11 * size
    for contact in (
        "self_contact",
        *[p.label for p in shipped.seal.terms() if hasattr(p, "motion")],
    ):
        by_own = [sm.differentiate(own, (f"{contact}_{n}",)).rows for n in ("forward", "backward")]
        exact = sm.differentiate(shipped, (f"{contact}_friction",)).rows
        for name, rates in exact.items():
            found = by_own[0][name][:, -1] + by_own[1][name][:, -1]
            size = np.abs(rates).max()
            assert np.abs(found - rates[:, -1]).max() <= 1e-8 * size


def test_self_contact_with_a_nonlinear_law(lips):
    """Either side has half of the limit at the complete pressure; all derivatives by both methods, and
    that in a constant by differences."""
    result = lips["nonlinear"]
    term, response = result.term("self_contact"), result.path.at_nominal("self_contact")[-1]
    points, gap = term.gaps(response.x)
    pressure = -2.0 * term.law.normal_penalty * gap
    closed = gap < 0.0
    constants = result.seal.scalars
    mu, p_0 = (constants[f"self_contact_{n}"].value for n in ("friction", "reference"))
    limit = 0.5 * mu * pressure[closed] * (1.0 + pressure[closed] / p_0) ** (-1.0 / 3.0)
    tau = term.law.tangent_penalty * np.abs(response.history.variables[points[closed], 2])
    slips = response.branch[points[closed]] == SLIP
    assert slips.any()
    np.testing.assert_allclose(tau[slips], limit[slips], rtol=1e-12)
    assert (tau[~slips] < limit[~slips]).all()
    name = "self_contact_reference"
    direct, adjoint = (
        sm.differentiate(result, (name,), method=method) for method in ("direct", "adjoint")
    )
    found = quotients(result.seal, name, 3e-5 * constants[name].value)
    for measure, (quotient, bound) in found.items():
        exact = direct[measure]
        assert np.abs(exact - adjoint[measure]).max() <= 1e-9 * np.abs(exact).max()
        assert (np.abs(quotient - exact[:, -1]) <= bound).all(), measure
        assert bound.max() <= 1e-4 * np.abs(exact[:, -1]).max(), measure
