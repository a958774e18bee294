"""A user's material, term, profile and measure, each one short file outside of the package."""

from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from agreement import assert_methods_agree, assert_quotients_agree
from highest_point import HighestPoint
from pressed_block import pressed_block

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.measures.reaction import Reaction

EXTENSIONS = ("arruda_boyce", "elastic_foundation", "ellipse", "highest_point")
# of the parameter: truncation h^2 / 6 and noise / h are both below 1e-6 of the derivative there
RELATIVE_STEP = 1e-4
INPUTS = ("modulus", "links", "springs_stiffness", "roll_friction", "roll_a", "roll_b", "depth")


@pytest.fixture(scope="module")
def seal():
    return pressed_block()


@pytest.fixture(scope="module")
def result(seal):
    return sm.analyze(seal, keep_factors=True)


@pytest.fixture(scope="module")
def tables(seal, result):
    """Derivatives with respect to everything, by both methods."""
    names = tuple(seal.scalars)
    return [sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")]


@pytest.mark.parametrize("name", EXTENSIONS)
def test_an_extension_is_one_short_file(name):
    lines = Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 60


def test_the_problem_has_something_to_show(seal, result):
    """Stick, slip and open points; every parameter but the ellipse's far one matters."""
    assert result.converged
    assert {OPEN, STICK, SLIP} == set(result.response("roll").branch)
    assert {"modulus", "links", "springs_stiffness", "roll_a", "roll_b"} <= set(seal.scalars)


def test_direct_and_adjoint_agree(seal, tables):
    assert_methods_agree(seal, tables)


def test_both_agree_with_central_differences(seal, tables):
    assert_quotients_agree(seal, tables, RELATIVE_STEP, certainty=1e-6)


@pytest.fixture(scope="module")
def problem(seal):
    """The same in OpenMDAO."""
    built = om.Problem(reports=False)
    built.model.add_subsystem(
        "seal",
        sm.SealGroup(
            seal=seal,
            measures=(HighestPoint(), Reaction("roll")),
            parameters=INPUTS,
        ),
        promotes=["*"],
    )
    built.setup()
    built.run_model()
    return built


def test_openmdao_computes_the_same_totals(problem, tables):
    inputs = ("boundary_offsets", *INPUTS)
    totals = problem.compute_totals(["highest_point", "reaction"], list(inputs))
    columns = [i for i, name in enumerate(tables[0].parameters) if name.split("[")[0] in inputs]
    for measure in ("highest_point", "reaction"):
        found = np.hstack([totals[measure, name] for name in inputs])
        exact = tables[0][measure][:, columns]
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-9 * np.abs(exact).max())


def test_openmdao_checks_the_partials(seal, problem):
    """Along random directions; the truncation of its quotients is below 1e-7 of them."""
    contact = problem.model._get_subsystem("seal.contact")
    for name in ("particles", *INPUTS):
        size = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
        contact.set_check_partial_options(
            wrt=name,
            method="fd",
            form="central",
            step_calc="abs",
            step=1e-5 * (size or 1.0),
            directional=True,
        )
    data = problem.check_partials(out_stream=None, includes=["seal.contact"])
    for (of, wrt), pair in data["seal.contact"].items():
        analytic, quotient = np.ravel(pair["J_fwd"]), np.ravel(pair["J_fd"])
        size = np.abs(analytic).max()
        assert size > 0.0, (of, wrt)
        assert np.abs(analytic - quotient).max() <= 1e-6 * size, (of, wrt)
