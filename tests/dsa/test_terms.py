"""Every term by itself: rates against central differences, and transposes of all products."""

from dataclasses import replace

import numpy as np
import pytest
from block import block_seal

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.parameters import ParameterRates, parameter_rates
from seal_mdao.dsa.probe import Probe
from seal_mdao.dsa.shape_rates import discretization_rates
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.equilibrium.matrix_seeds import add_matrix_seeds
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.measures.measure import Seeds
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.structure.energy_gradient import BodySeeds
from seal_mdao.terms.linearized_points import PointSeeds

LABELS = "structure", "roll", "pull"


@pytest.fixture(scope="module")
def pressed():
    result = sm.analyze(block_seal())
    states = {int(s) for response in result.path.responses("roll") for s in response.state}
    assert result.converged
    assert states == {OPEN, STICK, SLIP}
    return result


@pytest.fixture(params=[7, 12], ids=["straight down", "turning"])
def step(request, pressed):
    """A step before which and after which points are in contact."""
    return pressed.path.steps[request.param]


@pytest.fixture(scope="module", params=["roll", "door"])
def where(request, pressed, nominal):
    """Contact points with their lengths, and the particles of their body."""
    result = pressed if request.param == "roll" else nominal
    return result.term(request.param).where, result.particles


def test_imposed_displacements_of_free_components_are_not_used(pressed, rng):
    """Neither by the analysis nor by either method of the derivatives."""
    seal = pressed.seal
    own = seal.imposed_displacements
    free = pressed.path.discretization.layout.equations >= 0
    anywhere = own.rates + free * rng.standard_normal(own.rates.shape)
    fields = ImposedDisplacements(0.5 * anywhere[0] + anywhere[1], own.names, anywhere)
    other = sm.analyze(replace(seal, imposed_displacements=fields))
    np.testing.assert_array_equal(other.path.steps[-1].d, pressed.path.steps[-1].d)
    for method in ("direct", "adjoint"):
        found, exact = (
            sm.differentiate(result, own.names, (Reaction("roll"),), method).reaction
            for result in (other, pressed)
        )
        np.testing.assert_array_equal(found, exact)


def test_lengths_add_up_to_the_free_boundary(nominal):
    """Half edges: the two edges at the base corners count half."""
    outer = nominal.particles[options_of(nominal.seal).grid.particle(np.arange(3, 56), 2)]
    edges = np.linalg.norm(np.diff(outer, axis=0), axis=1)
    total = edges.sum() - 0.5 * (edges[0] + edges[-1])
    assert nominal.term("door").length.sum() == pytest.approx(total, rel=1e-13)


def test_length_rates_against_central_differences(where, rng):
    points, x = where
    velocity = rng.standard_normal((3, *x.shape))
    exact = points.measure_rates(x, velocity)
    for p, v in enumerate(velocity):
        plus, minus = (points.lengths(x + s * 1e-5 * v) for s in (1, -1))
        np.testing.assert_allclose((plus - minus) / 2e-5, exact[:, p], atol=1e-8)


def test_length_seeds_are_the_transpose_of_their_rates(where, rng):
    points, x = where
    velocity, seed = rng.standard_normal((3, *x.shape)), rng.standard_normal((len(points), 2))
    x_bar = np.zeros((*x.shape, 2))
    points.add_length_seeds(x, seed, x_bar)
    exact = seed.T @ points.measure_rates(x, velocity)
    np.testing.assert_allclose(np.einsum("aim,pai->mp", x_bar, velocity), exact, atol=1e-12)


def random_rates(seal, rng, count):
    """Rates in random directions: particles, and every scalar by a share of its size."""
    scalars = {name: scalar.value or 1.0 for name, scalar in seal.scalars.items()}
    share = np.array(list(scalars.values()))[:, None] * rng.uniform(
        -0.1, 0.1, (len(scalars), count)
    )
    velocity = rng.uniform(-0.1, 0.1, (count, *seal.nominal_particles.shape))
    return ParameterRates(velocity, tuple(scalars), share)


def history_rates(term, rng, count):
    """Rates of what points carry, or None for the body, which carries nothing."""
    none = term.no_rates(count)
    return None if none is None else 0.1 * rng.standard_normal(none.shape)


def rates_at(term, step, rates, carried, prescribed):
    """A step linearised, the rates of what the term gives at fixed d, and those of its force."""
    disc = term.discretization
    design = term.basis.rates(discretization_rates(disc, rates.velocity), rates)
    load = np.zeros((disc.layout.n_equations + 1, rates.count))
    block, linearized = term.linearization_of_block([step]), term.linearization(step)
    if block is not None:
        block.add_rates(design, load[None])
    prescribed = np.ascontiguousarray(prescribed.reshape(-1, rates.count))
    return linearized, linearized.rates(design, carried, prescribed, load), load


@pytest.mark.parametrize("label", LABELS)
def test_rates_of_a_term_against_central_differences(pressed, step, rng, label):
    """Particles, scalars, history, imposed displacements and solution move together.

    Of the force at the old solution, Eqs. (46), (57), (63), (66), and of what is carried and measured.
    """
    seal, term, place = pressed.seal, pressed.term(label), pressed.path.index_of(label)
    layout, rates = term.discretization.layout, random_rates(seal, rng, 1)
    carried = history_rates(term, rng, 1)
    prescribed = 0.1 * rng.standard_normal((*step.d.shape, 1)) * (layout.equations < 0)[..., None]
    solution = 0.1 * rng.standard_normal((layout.n_equations, 1))
    linearized, found, load = rates_at(term, step, rates, carried, prescribed)
    found = linearized.solved(found, solution)

    def moved(h, spread):
        """Force in the equations, and the answer, a distance ``h`` along all rates."""
        values = {
            name: seal.scalars[name].value + h * rate[0]
            for name, rate in zip(rates.names, rates.scalars, strict=True)
        }
        terms = seal.with_parameters(values).terms()
        disc = discretize(seal.body, pressed.particles + h * rates.velocity[0], terms)
        own, history = terms[place].on(disc, place), step.before[place]
        if carried is not None and carried.size:
            history = history._replace(variables=history.variables + h * carried[..., 0])
        d, force = step.d + h * (prescribed[..., 0] + spread), np.zeros(disc.layout.force_size)
        raw = disc.transformation.coefficients(d)
        answer = own.add(d, raw, step.fraction, history, force, np.empty(0)).copied()
        np.testing.assert_array_equal(answer.branch, step.responses[place].branch)
        disc.layout.condense_force(force)
        nodal = np.where(disc.layout.equations < 0, 0.0, force[disc.layout.equations])
        return nodal, answer

    h, free = 1e-6, layout.equations >= 0
    plus, minus = (moved(s * h, 0.0)[0] for s in (1, -1))
    check_slope((plus - minus)[free] / (2 * h), load[layout.equations[free], 0])
    plus, minus = (moved(s * h, layout.gather(solution)[..., 0])[1] for s in (1, -1))
    if label != "structure":
        check_slope((plus.force - minus.force) / (2 * h), found.force[..., 0])
        check_slope((plus.outputs - minus.outputs) / (2 * h), found.outputs[..., 0])
    if carried is not None and carried.size:
        slope = (plus.history.variables - minus.history.variables) / (2 * h)
        check_slope(slope, linearized.history_rates(found)[..., 0])


def check_slope(found, exact):
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-6 * np.abs(exact).max(initial=0.0))


def random_seeds(term, rng, count):
    """Seeds on forces and outputs of a term's points."""
    k, o = len(term.where), len(term.output_names)
    return PointSeeds(rng.standard_normal((count, k, 2)), rng.standard_normal((count, k, o)))


@pytest.mark.parametrize("label", LABELS)
def test_products_with_seeds_are_the_transpose_of_those_with_rates(pressed, step, rng, label):
    """Seeds on force, outputs, history and on the load's work with three adjoints mixed into two."""
    term, count, m = pressed.term(label), 4, 2
    disc, layout = term.discretization, term.discretization.layout
    rates, carried = random_rates(pressed.seal, rng, count), history_rates(term, rng, count)
    prescribed = rng.standard_normal((*step.d.shape, count))
    adjoints, mix = rng.standard_normal((layout.n_equations + 1, 3)), rng.standard_normal((3, m))
    adjoints[-1] = 0.0
    after, which = history_rates(term, rng, m), np.arange(m)
    taken = (
        random_seeds(term, rng, m)
        if carried is not None
        else BodySeeds(rng.standard_normal(m), rng.standard_normal((m, *disc.particles.shape)))
    )

    linearized, found, load = rates_at(term, step, rates, carried, prescribed)
    solution = rng.standard_normal((layout.n_equations, count))
    at_rest = linearized.solved(found, 0.0 * solution)
    ahead = -(adjoints[:-1] @ mix).T @ load[:-1] + taken.times(at_rest)
    size = np.abs(adjoints[:-1] @ mix).T @ np.abs(load[:-1])
    if carried is not None:
        ahead += np.einsum("khm,khp->mp", after, linearized.history_rates(found))

    design = term.basis.no_seeds(m, set(term.names))
    bars = linearized.seeds(after, taken)
    prescribed_bar, x_bar = np.zeros((prescribed[..., 0].size + 1, m)), np.zeros((*step.d.shape, m))
    on_history = linearized.pull_back(bars, adjoints, mix, design, prescribed_bar)
    block = term.linearization_of_block([step])
    if block is not None:
        block.pull_back([adjoints], [mix], design)
    on_matrix = term.basis.pull_back(design, x_bar)
    add_matrix_seeds(disc, on_matrix + np.zeros((*disc.transformation.matrix.shape, m)), x_bar)
    back = np.einsum("nim,pni->mp", x_bar, rates.velocity)
    back += design.parameters.T @ rates.of(term.names)
    back += prescribed_bar[:-1].T @ prescribed.reshape(-1, count)
    if carried is not None:
        back += np.einsum("khm,khp->mp", on_history, carried)
    scale = size.max() + np.abs(ahead).max()
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-12 * scale)
    measured = linearized.measured_loads(taken, which)
    change = taken.times(linearized.solved(found, solution)) - taken.times(at_rest)
    np.testing.assert_allclose(
        measured[:-1].T @ solution, change, rtol=0.0, atol=1e-12 * np.abs(ahead).max()
    )


def test_what_is_passed_on_is_all_that_the_next_step_takes(pressed, rng):
    """Seeds that the next step puts on the history see d' in the functions passed on alone."""
    path, term, m, count = pressed.path, pressed.term("roll"), 2, 4
    layout, rates = term.discretization.layout, random_rates(pressed.seal, rng, count)
    design = term.basis.rates(discretization_rates(term.discretization, rates.velocity), rates)
    most = 0
    for step, following in zip(path.steps, path.steps[1:], strict=False):
        adjoints = rng.standard_normal((layout.n_equations + 1, m))
        adjoints[-1] = 0.0
        next_one = term.linearization(following)
        on_history = next_one.pull_back(
            next_one.seeds(term.no_rates(m)), adjoints, np.eye(m), term.basis.no_seeds(m), None
        )
        load, solution = np.zeros((layout.n_equations + 1, count)), rng.standard_normal(
            (layout.n_equations, count)
        )  # fmt: skip
        linearized = term.linearization(step, following, False)
        carried = history_rates(term, rng, count)
        before = linearized.rates(design, carried, None, load)
        after = linearized.solved(before, solution)
        change = np.einsum(
            "khm,khp->mp", on_history,
            linearized.history_rates(after) - linearized.history_rates(before),
        )  # fmt: skip
        passed = linearized.passed_on(following)
        if passed is None:
            np.testing.assert_allclose(
                change, 0.0, atol=1e-13 * np.abs(on_history).max(initial=1.0)
            )
            continue
        # adjoint: B^T G H^T h_bar
        columns = linearized.loads_of(passed)[:-1]
        mix = passed.seeds(linearized.seeds(on_history).history)
        scale = (np.abs(columns @ mix).T @ np.abs(solution)).max(initial=0.0)
        found = (columns @ mix).T @ solution
        np.testing.assert_allclose(found, change, rtol=0.0, atol=1e-12 * scale)
        # direct: H (B^T G)^T d'
        linearized = term.linearization(step, following, False)
        before = linearized.rates(design, carried, None, load)
        after = linearized.passed(before, passed, columns.T @ solution)
        moved = linearized.history_rates(after) - linearized.history_rates(before)
        found = np.einsum("khm,khp->mp", on_history, moved)
        np.testing.assert_allclose(found, change, rtol=0.0, atol=1e-12 * scale)
        most = max(most, passed.count)
    assert most > 0


def test_reverse_of_the_probe_is_the_transpose_of_its_rates(pressed, step, rng):
    """Displacements and F at particles, through shape functions, solution and moving base."""
    path, disc, m = pressed.path, pressed.path.discretization, 2
    rates = parameter_rates(pressed.seal.design_velocity, ("shear", "tilt"))
    sweep, probe = DirectSweep(path, rates), disc.table_at(np.array([3, 20, 26]))
    solution = rng.standard_normal((disc.layout.n_equations, rates.count))
    shape = probe.rates(rates.velocity, sweep.shape.matrix)
    moved, f_rate = Probe(disc, probe).rates(shape, step, solution, sweep.prescribed(step))
    seeds = Seeds(rng.standard_normal((m, 3, 2)), rng.standard_normal((m, 3, 4)), {})
    ahead = np.tensordot(seeds.displacement, moved, 2) + np.tensordot(seeds.gradient, f_rate, 2)
    reverse, which = Probe(disc, probe, m), np.arange(m)
    loads, x_bar = np.zeros((disc.layout.n_equations + 1, m)), np.zeros((*step.d.shape, m))
    reverse.add_measured(step, seeds, which, loads)
    every = disc.layout.every_component.equations
    on_base = reverse.nodal_seeds(step, seeds, which, every, every.size + 1)[:-1]
    on_base *= (disc.layout.equations < 0).reshape(-1, 1)
    add_matrix_seeds(disc, reverse.pull_back(x_bar), x_bar)
    back = loads[:-1].T @ solution + np.einsum("nim,pni->mp", x_bar, rates.velocity)
    back[:, 3:] += on_base.T @ sweep.problem.imposed.linearization(step.fraction)
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-11 * np.abs(ahead).max())
