"""``check_partials`` with its own options finds a wrong entry anywhere in the partials."""

import numpy as np
import openmdao.api as om
import pytest
from openmdao.utils.assert_utils import assert_check_partials

import seal_mdao as sm
from seal_mdao.components.aggregate_comp import AggregateComp
from seal_mdao.components.random_directions import RandomDirectionsComp

RTOL = 1e-4
"""Of the page on OpenMDAO."""
WRONG, LEAST = 0.1, 1e-5
"""Error of an entry over the largest of its row, and its least: differences have an error as well."""
ENTRIES = 12
"""Of every component, chosen at random."""


class CountedPartials:
    """In place of ``compute_partials`` of a component: its partials, made once, with an error."""

    def __init__(self, comp):
        self.make, self.known, self.error = comp.compute_partials, {}, None

    def __call__(self, inputs, partials):
        key = b"".join(np.asarray(inputs[name]).tobytes() for name in inputs)
        if key not in self.known:
            self.known[key] = {}
            self.make(inputs, self.known[key])
        for block, table in self.known[key].items():
            partials[block] = table
        if self.error is not None:
            block, error = self.error
            partials[block] = self.known[key][block] + error


def set_up(system, **values):
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("seal", system, promotes=["*"])
    problem.setup(force_alloc_complex=True)
    for name, value in values.items():
        problem.set_val(name, value)
    problem.run_model()
    return problem


def check(problem, name):
    """Check one component along directions that are the same every time."""
    np.random.seed(3)
    data = problem.check_partials(out_stream=None, includes=[f"seal.{name}"])
    assert set(data) == {f"seal.{name}"}
    assert_check_partials(data, rtol=RTOL)


def check_finds_errors(problem, name, monkeypatch, rng):
    """The partials pass; with an error in one entry they do not."""
    comp = getattr(problem.model.seal, name)
    partials = CountedPartials(comp)
    monkeypatch.setattr(comp, "compute_partials", partials)
    check(problem, name)
    (tables,) = partials.known.values()
    blocks = list(tables)
    for number in range(ENTRIES):
        block = blocks[number % len(blocks)]
        table = np.asarray(tables[block], float)
        error = np.zeros_like(table)
        place = tuple(rng.integers(0, size) for size in table.shape)
        row = table[place[0]] if table.ndim == 2 else table
        error[place] = max(WRONG * np.abs(row).max(), LEAST)
        partials.error = block, error
        with pytest.raises(ValueError, match="assert_check_partials failed"):
            check(problem, name)


@pytest.fixture(scope="module")
def seal_problem(short):
    """With its analyses kept: a check along the same directions repeats none."""
    offsets = np.random.default_rng(1).uniform(-0.15, 0.15, 25)
    group = sm.SealGroup(seal=short, cache=sm.AnalysisCache(), parameters=("c10", "friction"))
    return set_up(group, boundary_offsets=offsets)


@pytest.mark.parametrize("name", ["contact", "section"])
def test_wrong_entry_of_a_seal(name, seal_problem, monkeypatch, rng):
    check_finds_errors(seal_problem, name, monkeypatch, rng)


@pytest.mark.parametrize(("first", "second"), [(0, 1), (1, 3), (100, 200), (-2, -1)])
def test_errors_that_cancel_along_a_translation(first, second, short, seal_problem, monkeypatch):
    """+50 and -50 in two columns of d reaction / d particles, in one direction and in two."""
    partials = CountedPartials(seal_problem.model.seal.contact)
    monkeypatch.setattr(seal_problem.model.seal.contact, "compute_partials", partials)
    error = np.zeros((2, 2 * len(short.nominal_particles)))
    error[1, [first, second]] = 50.0, -50.0
    partials.error = ("reaction", "particles"), error
    with pytest.raises(ValueError, match="reaction wrt particles"):
        check(seal_problem, "contact")


def test_wrong_entry_of_the_geometry(short, rng):
    """Its partials are declared once."""

    class Wrong(sm.SplineGeometryComp):
        def declare_partials(self, of, wrt, rows, cols, val):
            error = np.zeros(val.size)
            error[wrong] = 0.1
            return super().declare_partials(of, wrt, rows=rows, cols=cols, val=val + error)

    for wrong in ([], *rng.integers(0, 1646, ENTRIES)):
        group = om.Group()
        group.add_subsystem("geometry", Wrong(seal=short), promotes=["*"])
        problem = set_up(group)
        if isinstance(wrong, list):
            check(problem, "geometry")
        else:
            with pytest.raises(ValueError, match="assert_check_partials failed"):
                check(problem, "geometry")


@pytest.fixture(scope="module")
def scenario_problem():
    """Two scenarios, whose values are kept."""
    seal = sm.door_seal(
        depth=8.0, n_steps=18, start=10.03, newton=sm.NewtonOptions(tolerance=1e-11)
    )
    friction = sm.Scenarios((sm.Variation("friction"),), np.array([[0.22], [0.31]]))
    group = sm.ScenarioGroup(
        seal=seal, scenarios=friction, measures=("gap_square_integral", "reaction"), workers=0,
        parameters=("c10",), quantiles=(0.9,),
    )  # fmt: skip
    problem = set_up(group, boundary_offsets=0.05 * np.cos(np.arange(25)))
    comp = problem.model.seal.scenarios
    evaluate, known = comp._evaluated, {}

    def kept(inputs):
        key = b"".join(np.asarray(inputs[name]).tobytes() for name in inputs)
        if key not in known:
            known[key] = evaluate(inputs)
        return known[key]

    comp._evaluated = kept
    return problem


@pytest.mark.parametrize("name", ["scenarios", "aggregates", "section"])
def test_wrong_entry_of_scenarios(name, scenario_problem, monkeypatch, rng):
    check_finds_errors(scenario_problem, name, monkeypatch, rng)


def test_wrong_entry_of_aggregates_with_a_scenario_that_failed(monkeypatch, rng):
    group = om.Group()
    aggregates = AggregateComp(shapes={"force": (5, 2)}, units={"force": "N/m"}, quantiles=(0.9,))
    group.add_subsystem("aggregates", aggregates, promotes=["*"])
    values = rng.uniform(50.0, 80.0, (5, 2))
    values[3] = np.nan
    problem = set_up(group, force_scenarios=values)
    check_finds_errors(problem, "aggregates", monkeypatch, rng)


class Sums(RandomDirectionsComp):
    """Two sums of four inputs and a number."""

    def setup(self):
        self.add_input("x", np.arange(4.0))
        self.add_input("t", 2.0)
        self.add_output("sums", shape=2)
        self.declare_partials("*", "*")
        self.set_check_partial_options("x", "fd", "central", 1e-4)
        self.set_check_partial_options("t", method="fd", form="central", step=1e-4)

    def compute(self, inputs, outputs):
        outputs["sums"] = [inputs["x"].sum() * inputs["t"][0], inputs["x"][0]]

    def compute_partials(self, inputs, partials):
        partials["sums", "x"] = [[inputs["t"][0]] * 4, [1.0, 0.0, 0.0, 0.0]]
        partials["sums", "t"] = [[inputs["x"].sum()], [0.0]]


@pytest.fixture(scope="module")
def sums():
    group = om.Group()
    group.add_subsystem("sums", Sums(), promotes=["*"])
    return set_up(group)


def test_checked_products_are_those_of_the_jacobian(sums):
    """Along a number in every input that is not small, forward and reverse; else an assembled matrix."""
    for seed in range(20):
        np.random.seed(seed)
        (data,) = sums.check_partials(out_stream=None).values()
        by_t = data["sums", "t"]
        assert 0.3 * 6.0 <= abs(by_t["J_fwd"][0, 0]) <= 6.0
        forward, reverse = by_t["directional_fwd_rev"]
        assert forward == pytest.approx(reverse, rel=1e-12)
    assert not sums.model.seal.sums.matrix_free
    differences = data["sums", "x"]["J_fd"].copy()
    sums.compute_totals(["sums"], ["x"])
    np.testing.assert_array_equal(data["sums", "x"]["J_fd"], differences)


@pytest.mark.filterwarnings("ignore:.*nonlinear solver that computes gradients")
@pytest.mark.parametrize("mode", ["fwd", "rev"])
def test_partials_may_be_assembled(mode):
    problem = om.Problem(reports=None)
    group = problem.model.add_subsystem("group", om.Group(), promotes=["*"])
    group.add_subsystem("sums", Sums(), promotes=["*"])
    group.linear_solver = om.DirectSolver()
    problem.setup(mode=mode)
    problem.run_model()
    problem.check_partials(out_stream=None)
    totals = problem.compute_totals(["sums"], ["x", "t"])
    np.testing.assert_allclose(totals["sums", "x"], [[2.0] * 4, [1.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(totals["sums", "t"], [[6.0], [0.0]])
