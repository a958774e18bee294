"""Every numbered equation of the paper has a line, every function in it exists."""

import re
import sys
from pathlib import Path

import pytest

# the paper numbers its equations (1) to (71) without a gap
PAPER = list(range(1, 72))


@pytest.fixture(scope="module")
def index(docs_module):
    return docs_module("equation_index")


@pytest.fixture(scope="module")
def equations(index):
    return index.read()


def test_every_equation_of_the_paper_has_one_line(equations):
    assert [equation.number for equation in equations] == PAPER


def test_every_function_exists(index, equations):
    for equation in equations:
        for name in equation.functions:
            assert callable(index.resolve(name)), f"({equation.number}): {name}"


def test_every_computed_equation_is_cited_by_its_number_in_a_file_that_computes_it(
    index, equations
):
    """As (12), which no call has before it, and not inside of a range such as (10)-(13)."""
    for equation in equations:
        files = {
            sys.modules[index.resolve(name).__module__].__file__ for name in equation.functions
        }
        number = re.compile(rf"(?<![\w\])-])\({equation.number}\)(?!-)")
        texts = [Path(file).read_text(encoding="utf-8") for file in files]
        assert not texts or any(map(number.search, texts)), f"({equation.number}): {files}"


@pytest.mark.parametrize(
    "name",
    [
        "seal_mdao.rkpm.kernel.no_such_function",
        "seal_mdao.rkpm.no_such_module.cubic_b_spline",
        "seal_mdao.dsa.direct.DirectSweep.no_such_method",
    ],
)
def test_a_function_that_is_gone_is_found_out(index, name):
    with pytest.raises((AttributeError, ModuleNotFoundError)):
        index.resolve(name)


def test_what_is_not_computed_as_printed_says_why(index, equations):
    for equation in equations:
        assert equation.state in index.STATES, equation
        assert bool(equation.functions) == (equation.state != "not computed"), equation
        if equation.state in ("corrected", "replaced", "not computed"):
            assert equation.note, equation


def test_every_equation_is_shown_once_in_the_theory(pages):
    theory = [text for path, text in pages.items() if path.parent.name == "theory"]
    labels = re.findall(r"^\$\$ \(eq-(\d+)\)$", "\n".join(theory), re.MULTILINE)
    assert sorted(map(int, labels)) == PAPER


def test_references_to_equations_lead_somewhere(pages):
    text = "\n".join(pages.values())
    labels = set(re.findall(r"^\$\$ \((eq-[\w-]+)\)$", text, re.MULTILINE))
    assert set(re.findall(r"\{eq\}`(eq-[\w-]+)`", text)) <= labels


def test_the_table_holds_every_line(index, equations):
    table = index.table(equations)
    assert table.count("\n* - {eq}`eq-") == len(PAPER)
    assert "{py:obj}`rkpm.kernel.cubic_b_spline <seal_mdao.rkpm.kernel.cubic_b_spline>`" in table
