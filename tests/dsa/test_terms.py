"""Every term by itself: rates against central differences, the reverse against the forward pass."""

import numpy as np
import pytest
from block import block_seal

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.dsa.direct import DirectSweep
from seal_mdao.dsa.parameters import ParameterRates, parameter_rates
from seal_mdao.dsa.probe import ProbeReverse, probe_rates
from seal_mdao.dsa.shape_rates import add_matrix_seeds, discretization_rates
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.measures.measure import Seeds
from seal_mdao.terms.point_forward import PointSeeds

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
def where(request, pressed, drawn):
    """Contact points with their lengths, and the particles of their body."""
    result = pressed if request.param == "roll" else drawn
    return result.term(request.param).where, result.particles


def test_lengths_add_up_to_the_free_boundary(drawn):
    """Half edges: the two edges at the base corners count half."""
    outer = drawn.particles[drawn.seal.grid.particle(np.arange(3, 56), 2)]
    edges = np.linalg.norm(np.diff(outer, axis=0), axis=1)
    total = edges.sum() - 0.5 * (edges[0] + edges[-1])
    assert drawn.term("door").length.sum() == pytest.approx(total, rel=1e-13)


def test_length_rates_against_central_differences(where, rng):
    points, x = where
    velocity = rng.standard_normal((3, *x.shape))
    exact = points.length_rates(x, velocity)
    for p, v in enumerate(velocity):
        plus, minus = (points.lengths(x + s * 1e-5 * v) for s in (1, -1))
        np.testing.assert_allclose((plus - minus) / 2e-5, exact[:, p], atol=1e-8)


def test_length_seeds_are_the_transpose_of_their_rates(where, rng):
    points, x = where
    velocity, seed = rng.standard_normal((3, *x.shape)), rng.standard_normal((len(points), 2))
    x_bar = np.zeros((*x.shape, 2))
    points.add_length_seeds(x, seed, x_bar)
    exact = seed.T @ points.length_rates(x, velocity)
    np.testing.assert_allclose(np.einsum("aim,pai->mp", x_bar, velocity), exact, atol=1e-12)


def random_rates(seal, rng, count):
    """Rates in random directions: particles, and every scalar by a share of its size."""
    scalars = {name: scalar.value or 1.0 for name, scalar in seal.scalars.items()}
    share = np.array(list(scalars.values()))[:, None] * rng.uniform(
        -0.1, 0.1, (len(scalars), count)
    )
    velocity = rng.uniform(-0.1, 0.1, (count, *seal.drawn_particles.shape))
    return ParameterRates(velocity, tuple(scalars), share)


def history_rates(term, rng, count):
    """Rates of what points carry, or None for a term that carries nothing."""
    size = getattr(term, "history_size", 0)
    return 0.1 * rng.standard_normal((len(term.where), size, count)) if size else None


@pytest.mark.parametrize("label", LABELS)
def test_rates_of_a_term_against_central_differences(pressed, step, rng, label):
    """Particles, scalars, history, imposed displacements and solution move together.

    Of the force at the old solution, Eqs. (46), (57), (63), (66), and of what is handed on and measured.
    """
    seal, term, place = pressed.seal, pressed.term(label), pressed.path.place(label)
    layout, rates = term.discretization.layout, random_rates(seal, rng, 1)
    carried = history_rates(term, rng, 1)
    held = 0.1 * rng.standard_normal((*step.d.shape, 1)) * (layout.equations < 0)[..., None]
    solution = 0.1 * rng.standard_normal((layout.n_equations, 1))
    forward = term.forward(discretization_rates(term.discretization, rates.velocity), rates)
    loads = np.zeros((1, layout.n_equations + 1, 1))
    forward.add_explicit([step], loads)
    kept = forward.linearize(step, None, carried, held, loads[0])
    forward.follow_solution(kept, solution)

    def moved(h, spread):
        """Force in the equations, and the answer, a distance ``h`` along all rates."""
        values = {
            name: seal.scalars[name].value + h * rate[0]
            for name, rate in zip(rates.names, rates.scalars, strict=True)
        }
        terms = seal.with_parameters(values).terms()
        disc = discretize(seal.body, pressed.particles + h * rates.velocity[0], terms)
        own, history = terms[place].on(disc, place), step.before[place]
        if history is not None:
            history = history._replace(variables=history.variables + h * carried[..., 0])
        d, force = step.d + h * (held[..., 0] + spread), np.zeros(disc.layout.force_size)
        raw = disc.transformation.coefficients(d)
        answer = own.add(d, raw, step.fraction, history, force, np.empty(0)).kept()
        np.testing.assert_array_equal(answer.branch, step.responses[place].branch)
        disc.layout.condense_force(force)
        nodal = np.where(disc.layout.equations < 0, 0.0, force[disc.layout.equations])
        return nodal, answer

    h, free = 1e-6, layout.equations >= 0
    plus, minus = (moved(s * h, 0.0)[0] for s in (1, -1))
    check_slope((plus - minus)[free] / (2 * h), loads[0, layout.equations[free], 0])
    plus, minus = (moved(s * h, layout.gather(solution)[..., 0])[1] for s in (1, -1))
    if label != "structure":
        outputs = forward.outputs(kept)[..., 0]
        check_slope((plus.force - minus.force) / (2 * h), outputs[:, :2])
        check_slope((plus.outputs - minus.outputs) / (2 * h), outputs[:, 2:])
    if carried is not None:
        found = (plus.history.variables - minus.history.variables) / (2 * h)
        check_slope(found, forward.history(kept)[..., 0])


def check_slope(found, exact):
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-6 * np.abs(exact).max(initial=0.0))


def random_seeds(term, rng, count):
    """Seeds on forces and outputs of a term's points."""
    k, o = len(term.where), len(term.output_names)
    return PointSeeds(rng.standard_normal((count, k, 2)), rng.standard_normal((count, k, o)))


@pytest.mark.parametrize("label", LABELS)
def test_reverse_is_the_transpose_of_forward(pressed, step, rng, label):
    """Seeds on force, outputs, history and on the load's work with three adjoints mixed into two."""
    path, term, count, m = pressed.path, pressed.term(label), 4, 2
    disc, layout = term.discretization, term.discretization.layout
    rates, carried = random_rates(pressed.seal, rng, count), history_rates(term, rng, count)
    held = rng.standard_normal((*step.d.shape, count))
    adjoints, mix = rng.standard_normal((layout.n_equations + 1, 3)), rng.standard_normal((3, m))
    adjoints[-1] = 0.0
    at_points = label != "structure"
    seeds = random_seeds(term, rng, m) if at_points else None
    reverse = term.reverse(m, set(term.names))
    after, first = reverse.no_history(), reverse.no_history()
    if carried is not None:
        after, first = history_rates(term, rng, m), history_rates(term, rng, m)

    forward = term.forward(discretization_rates(disc, rates.velocity), rates)
    loads = np.zeros((1, layout.n_equations + 1, count))
    began = forward.start(path.start)
    forward.add_explicit([step], loads)
    kept = forward.linearize(step, None, carried, held, loads[0])
    ahead = -(adjoints[:-1] @ mix).T @ loads[0, :-1]
    size = np.abs(adjoints[:-1] @ mix).T @ np.abs(loads[0, :-1])
    if at_points:
        ahead += forward.contract(seeds, forward.outputs(kept))
    if carried is not None:
        ahead += np.einsum("khm,khp->mp", after, forward.history(kept))
        ahead += np.einsum("khm,khp->mp", first, began)

    plan = reverse.prepare(step, None, at_points, after)
    if at_points:
        measured = np.zeros((layout.n_equations + 1, m))
        reverse.add_measured(plan, seeds, np.arange(m), measured)
    held_bar, x_bar = np.zeros((held[..., 0].size + 1, m)), np.zeros((*step.d.shape, m))
    on_history = reverse.collect(plan, step, adjoints, mix, held_bar)
    parameters, on_matrix = reverse.finish(path.start, first, x_bar)
    add_matrix_seeds(disc, on_matrix + np.zeros((*disc.transformation.matrix.shape, m)), x_bar)
    back = np.einsum("nim,pni->mp", x_bar, rates.velocity) + parameters.T @ rates.of(term.names)
    back += held_bar[:-1].T @ held.reshape(-1, count)
    if carried is not None:
        back += np.einsum("khm,khp->mp", on_history, carried)
    scale = size.max() + np.abs(ahead).max()
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-12 * scale)
    if at_points:
        solution = rng.standard_normal((layout.n_equations, count))
        before = forward.contract(seeds, forward.outputs(kept))
        forward.follow_solution(kept, solution)
        change = forward.contract(seeds, forward.outputs(kept)) - before
        np.testing.assert_allclose(
            measured[:-1].T @ solution, change, rtol=0.0, atol=1e-12 * np.abs(change).max()
        )


def test_what_is_handed_on_is_all_that_the_next_step_takes(pressed, rng):
    """Seeds that the next step puts on the history see d' in the columns handed on alone."""
    path, term, m, count = pressed.path, pressed.term("roll"), 2, 4
    layout, rates = term.discretization.layout, random_rates(pressed.seal, rng, count)
    forward = term.forward(discretization_rates(term.discretization, rates.velocity), rates)
    taken = []
    for step, following in zip(path.steps, path.steps[1:], strict=False):
        reverse = term.reverse(m, set(term.names))
        plan = reverse.prepare(following, None, True, reverse.no_history())
        adjoints = rng.standard_normal((layout.n_equations + 1, m))
        adjoints[-1] = 0.0
        on_history = reverse.collect(plan, following, adjoints, np.eye(m), None)
        load, solution = np.zeros((layout.n_equations + 1, count)), rng.standard_normal(
            (layout.n_equations, count)
        )  # fmt: skip
        kept = forward.linearize(step, None, history_rates(term, rng, count), None, load)
        before = forward.history(kept)
        forward.follow_solution(kept, solution)
        change = np.einsum("khm,khp->mp", on_history, forward.history(kept) - before)
        plan = reverse.prepare(step, following, False, on_history)
        columns, mix = np.zeros((layout.n_equations + 1, plan.count)), np.zeros((plan.count, m))
        reverse.add_handed(plan, columns, mix)
        found = (columns[:-1] @ mix).T @ solution
        scale = np.abs(columns[:-1] @ mix).T @ np.abs(solution)
        np.testing.assert_allclose(found, change, rtol=0.0, atol=1e-12 * scale.max(initial=0.0))
        taken.append(plan.count)
    assert max(taken) > 0


def test_reverse_of_the_probe_is_the_transpose_of_its_rates(pressed, step, rng):
    """Displacements and F at particles, through shape functions, solution and moving base."""
    path, disc, m = pressed.path, pressed.path.discretization, 2
    rates = parameter_rates(pressed.seal.design_velocity, ("shear", "tilt"))
    sweep, probe = DirectSweep(path, rates), disc.table_at(np.array([3, 20, 26]))
    solution = rng.standard_normal((disc.layout.n_equations, rates.count))
    moved, f_rate = probe_rates(disc, probe, sweep, step, solution)
    seeds = Seeds(rng.standard_normal((m, 3, 2)), rng.standard_normal((m, 3, 4)), {})
    ahead = np.tensordot(seeds.displacement, moved, 2) + np.tensordot(seeds.gradient, f_rate, 2)
    reverse, which = ProbeReverse(disc, probe, m), np.arange(m)
    loads, x_bar = np.zeros((disc.layout.n_equations + 1, m)), np.zeros((*step.d.shape, m))
    reverse.add_measured(step, seeds, which, loads)
    every = disc.layout.every_component.equations
    on_base = reverse.nodal_seeds(step, seeds, which, every, every.size + 1)[:-1]
    on_base = on_base.reshape(-1, 2, m) * (disc.layout.equations < 0)[..., None]
    add_matrix_seeds(disc, reverse.finish(x_bar), x_bar)
    back = loads[:-1].T @ solution + np.einsum("nim,pni->mp", x_bar, rates.velocity)
    back[:, 3:] += np.einsum("nim,sni->ms", on_base, sweep.problem.imposed.rates_at(step.fraction))
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-11 * np.abs(ahead).max())
