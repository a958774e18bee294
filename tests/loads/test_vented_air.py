"""Air in a hole with vents: limits, closed forms, convergence in time, tangent and derivatives."""

import numpy as np
import pytest
from air_ring import WEIGHTS, air_ring, change_of_residual, ring_particles
from scipy.integrate import solve_ivp

import seal_mdao as sm
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.orifice import orifice_flow
from seal_mdao.loads.vented_air import AirHistory, VentedAir, density, outflow_velocity
from seal_mdao.measures.reaction import Reaction

VENTS = {"vent_diameter": 2.0, "vent_spacing": 100.0, "closing_speed": 300.0}


@pytest.fixture(scope="module")
def squeezed():
    result = sm.analyze(air_ring(**VENTS), keep_factors=True)
    assert result.converged, result.failure
    return result


@pytest.fixture(scope="module")
def tables(squeezed):
    names = tuple(squeezed.seal.scalars)
    return [sm.differentiate(squeezed, names, method=method) for method in ("direct", "adjoint")]


def pressures(result):
    return np.array([response.outputs[0, 0] for response in result.path.at_nominal("air")])


def rigid(travel=(0.0, 1e9), **changed):
    """The term of a hole whose shape is given, and its undeformed places."""
    seal = air_ring(**VENTS)
    own = seal.definitions[-1]
    given = VENTS | {"travel": np.asarray(travel, float), "gamma": own.gamma} | changed
    air = VentedAir("air", own.ring, **given)
    terms = (*seal.definitions[:-1], air)
    other = sm.Seal(
        seal.nominal_particles, seal.design_velocity, seal.body, terms, 1, seal.standard
    )  # fmt: skip
    discretization = sm.analyze(air_ring(depth=0.01, shear=0.0, **VENTS)).path.discretization
    term = other.terms()[-1].on(discretization, len(terms) - 1)
    return term, ring_particles()[own.ring]


# ---- limits ----


def test_without_vents_the_air_is_sealed_to_rounding():
    sealed, closed = (
        sm.analyze(air_ring(**own)) for own in ({}, VENTS | {"vent_diameter": 0.0})
    )  # fmt: skip
    np.testing.assert_allclose(pressures(closed), pressures(sealed), rtol=1e-12)
    assert closed.response("air").history.mass == 1.0


def test_with_large_vents_there_is_no_air():
    opened, vented = (
        sm.analyze(air_ring(**own)) for own in ({"sealed": False}, VENTS | {"vent_diameter": 500.0})
    )  # fmt: skip
    forces = [result.value(Reaction("plate"))[1] for result in (opened, vented)]
    assert abs(forces[1] / forces[0] - 1.0) <= 1e-7
    assert np.abs(pressures(vented)).max() <= 1e-6


def test_a_faster_plate_loses_less_air(squeezed):
    slow, fast = (
        sm.analyze(air_ring(**VENTS | {"closing_speed": speed})) for speed in (30.0, 3e5)
    )  # fmt: skip
    sealed = sm.analyze(air_ring())
    assert pressures(slow)[-1] < 0.1 * pressures(squeezed)[-1]
    assert pressures(squeezed)[-1] < 0.5 * pressures(fast)[-1] < 0.5 * pressures(sealed)[-1]


# ---- closed forms ----


def test_a_piston_reaches_its_stationary_pressure():
    """Volume rate q: density times q leaves through the vents; 1/2 rho (q / (C_d a))^2 where small."""
    speed = 1500.0
    term, x = rigid(travel=np.arange(0.0, 201.0), closing_speed=speed)
    # area falls by the same part in every step of 1 mm
    part, history = 4e-3, AirHistory(1.0, 0.0)
    for step in range(1, 201):
        response = term.respond(x * np.sqrt(1.0 - part * step), float(step), history)
        history = response.history
    rate = part * term.nominal_volume * speed
    pressure = response.outputs[0, 0]
    y = np.log1p(pressure / term.outside) / term.gamma
    assert np.exp(y) * rate == pytest.approx(
        term.conductance * orifice_flow(y, 1.4).value, rel=1e-8
    )
    # rho = 2 p_a / c^2
    velocity = outflow_velocity(23.0)
    small = 0.5 * (2.0 * term.outside / velocity**2) * (rate * velocity / term.conductance) ** 2
    assert 0.05 < pressure == pytest.approx(small, rel=0.01)


@pytest.mark.parametrize("gamma", [1.0, 1.4])
def test_discharge_of_a_constant_volume_converges_to_the_solution_in_time(gamma):
    """From twice the density, choked first; the error of backward Euler is of first order."""
    end = 0.7
    term, x = rigid(travel=(0.0, end), gamma=gamma)
    x, left = x * np.sqrt(0.5), 0.5
    rate = term.conductance / (term.nominal_volume * VENTS["closing_speed"])

    def leaving(_, mass):
        return [-rate * orifice_flow(np.log(mass[0] / left), gamma).value]

    exact = solve_ivp(leaving, (0.0, end), [1.0], rtol=1e-11, atol=1e-13).y[0, -1]
    assert left + 0.1 < exact < 0.8
    errors = []
    for count in (20, 40, 80):
        history = AirHistory(1.0, 0.0)
        for step in range(1, count + 1):
            history = term.respond(x, step / count, history).history
        errors.append(abs(history.mass - exact))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 1.0, atol=0.05)


@pytest.mark.parametrize("moving", [1.0, 0.4, 0.0])
def test_the_root_of_a_small_pressure_falls_linearly_in_time(moving):
    """d sqrt(p) / dt = -gamma c C_d a sqrt(p_a) / (2 A), incompressible and without smoothing: in the
    time of a travel, in a duration, in both."""
    term, x = rigid(travel=(0.0, moving), time=(0.0, (1.0 - moving) / VENTS["closing_speed"]))
    x, start = x * np.sqrt(1.0 - 1e-3), 1e-3 * 1.4
    end, count, history = 0.06, 2000, AirHistory(1.0, 0.0)
    for step in range(1, count + 1):
        response = term.respond(x, end * step / count, history)
        history = response.history
    fall = 0.5 * 1.4 * term.conductance / term.nominal_volume * end / VENTS["closing_speed"]
    assert 0.1 < fall / np.sqrt(start) < 0.9
    left = np.sqrt(response.outputs[0, 0] / term.outside)
    assert left == pytest.approx(np.sqrt(start) - fall, rel=0.01)


def test_time_steps_of_the_path_converge():
    """The measure sees the error in time: it halves with the load steps."""
    vents = VENTS | {"vent_diameter": 1.0}
    results = [
        sm.analyze(air_ring(finer=finer, friction=0.0, **vents)) for finer in (1, 2, 4, 8)
    ]  # fmt: skip
    found = np.array([pressures(result)[-1] for result in results])
    changes = np.abs(np.diff(found))
    np.testing.assert_allclose(changes[:-1] / changes[1:], 2.0, rtol=0.06)


# ---- one load step ----


def test_the_density_solves_its_equation():
    for left, mass, kappa in ((0.7, 1.0, 0.3), (1.2, 0.9, 0.3), (0.7, 1.0, 1e4), (1.0, 1.0, 0.1)):
        y = density(left, mass, kappa, 1.4)
        terms = left * np.exp(y), mass, kappa * orifice_flow(y, 1.4).value
        assert abs(terms[0] - terms[1] + terms[2]) <= 4e-16 * max(np.abs(terms))
    assert density(0.7, 0.9, 0.0, 1.4) == np.log(0.9 / 0.7)


def test_the_force_of_a_step_derives_from_the_work_on_the_air(rng):
    """With the mass and the time of the step fixed: R = d/dx int p dA, K = dR/dx."""
    term, x = rigid(travel=(0.0, 0.5, 1.0))
    history, way = AirHistory(0.93, 0.7), rng.standard_normal(x.shape)
    x, h = 0.93 * x, 1e-4

    def response(size):
        return term.respond(x + size * h * way, 1.6, history)

    def work(size):
        # int p dA over a straight path from x
        nodes, weights = np.polynomial.legendre.leggauss(12)
        forces = [response(0.5 * size * (1.0 + node)).force for node in nodes]
        return (
            0.5 * size * h * sum(w * np.sum(f * way) for w, f in zip(weights, forces, strict=True))
        )

    now = response(0.0)
    assert WEIGHTS @ [work(s) for s in (-2, -1, 1, 2)] / h == pytest.approx(
        np.sum(now.force * way), rel=1e-8
    )
    quotient = WEIGHTS @ np.array([response(s).force.ravel() for s in (-2, -1, 1, 2)]) / h
    tangent = np.zeros((x.size, x.size))
    for (i, j), block in zip(now.pairs, now.tangent, strict=True):
        tangent[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] += block
    tangent += now.sizes[0] * np.outer(now.columns[0], now.columns[0])
    np.testing.assert_allclose(tangent, tangent.T, atol=1e-14 * np.abs(tangent).max())
    scale = np.abs(quotient).max()
    np.testing.assert_allclose(tangent @ way.ravel(), quotient, atol=1e-8 * scale)


@pytest.mark.parametrize("time", [None, (0.0, 0.0, 0.003)])
@pytest.mark.parametrize("row", ["force", "mass", "pressure", "volume"])
def test_every_derivative_of_a_step(row, time, rng):
    """With respect to places, the mass before, parameters and undeformed places; in a step that takes
    the time of a travel, or of a travel and a duration."""
    term, x = rigid(travel=(0.0, 0.5, 1.0), time=time)
    history, x = AirHistory(0.93, 0.7), 0.93 * x + 0.02 * rng.standard_normal(x.shape)
    definition = air_ring(**VENTS).definitions[-1]
    names = [name.removeprefix("air_") for name in term.names]
    base = {name: getattr(definition, name) for name in names}
    ways = {"x": x.shape, "mass": (), "parameters": (len(names),), "X": x.shape}
    ways = {name: rng.standard_normal(shape) for name, shape in ways.items()}
    h = 1e-4

    def moved(size, which):
        given = {
            name: base[name] * (1.0 + size * h * by * (which == "parameters"))
            for name, by in zip(names, ways["parameters"], strict=True)
        }
        other, _ = rigid(travel=(0.0, 0.5, 1.0), time=time, **given)
        if which == "X":
            area, _ = polygon_area(other.reference + size * h * ways["X"])
            other.nominal_volume = other.nominal_area = other.orientation * area
        before = history._replace(mass=history.mass + size * h * ways["mass"] * (which == "mass"))
        found = other.respond(x + size * h * ways["x"] * (which == "x"), 1.6, before)
        rows = {
            "force": found.force.ravel(), "mass": [found.history.mass],
            "pressure": [found.outputs[0, 0]], "volume": [found.outputs[0, 1]],
        }  # fmt: skip
        return np.asarray(rows[row], float)

    at_x, at_history, _, at_parameters, at_reference = term.inputs
    force, passed, outputs = term.rows
    rows = {
        "force": force, "mass": slice(passed.start, passed.start + 1),
        "pressure": slice(outputs.start, outputs.start + 1),
        "volume": slice(outputs.start + 1, outputs.stop),
    }  # fmt: skip
    local = term.linearize(term.respond(x, 1.6, history), 1.6, history)
    for which, columns in (
        ("x", at_x), ("mass", at_history), ("parameters", at_parameters), ("X", at_reference)
    ):  # fmt: skip
        rates = np.zeros(at_reference.stop)
        if which == "mass":
            rates[at_history.start] = ways["mass"]
        elif which == "parameters":
            rates[columns] = ways["parameters"] * list(base.values())
        else:
            rates[columns] = ways[which].ravel()
        quotient = WEIGHTS @ np.array([moved(s, which) for s in (-2, -1, 1, 2)]) / h
        exact = (local @ rates[:, None])[rows[row], 0]
        # the volume depends on places alone
        assert (np.abs(exact).max() > 1e-6) == (row != "volume" or which == "x")
        np.testing.assert_allclose(
            exact, quotient, atol=1e-8 * max(np.abs(quotient).max(), 1e-2), err_msg=which
        )


def test_the_change_at_fixed_places_is_that_of_the_residual(squeezed):
    """What the predictor takes for the air that leaves in the next step."""
    term, step = squeezed.term("air"), squeezed.path.steps[3]
    response = step.responses[squeezed.path.index_of("air")]
    later = term.respond(response.x, 5.0, response.history)
    (change,) = term.changes(step, response, 5.0)
    own = term.point_loads(later.force - response.force, np.ones(len(response.x), np.int64))
    assert later.outputs[0, 0] < 0.5 * response.outputs[0, 0]
    np.testing.assert_allclose(change, own, atol=1e-12 * np.abs(own).max())
    assert term.changes(step, response, step.fraction) == []


def test_the_tangent_is_the_derivative_of_the_residual(squeezed, rng):
    factor, along, quotient = change_of_residual(squeezed, rng)
    np.testing.assert_allclose(factor.solve(quotient), along, rtol=0.0, atol=1e-6)


# ---- the path ----


def test_the_mass_of_the_air_is_balanced(squeezed):
    """What is left is pressure and area; what is gone has flowed in the time of the steps."""
    term, mass = squeezed.term("air"), 1.0
    for step, response in enumerate(squeezed.path.at_nominal("air")):
        pressure, area = response.outputs[0]
        y = np.log1p(pressure / term.outside) / term.gamma
        time = np.diff(term.travel)[step] / VENTS["closing_speed"]
        mass -= term.conductance * time / term.nominal_volume * orifice_flow(y, term.gamma).value
        assert mass == pytest.approx(area * np.exp(y) / term.nominal_volume, rel=1e-12)
        assert mass == pytest.approx(response.history.mass, rel=1e-12)
    assert mass < 0.99


def test_a_cycle_loses_energy_and_ends_with_suction():
    """Without friction: the plate does work in the cycle, and the air comes back through the vents."""
    result = sm.analyze(air_ring(friction=0.0, back=True, **VENTS))
    assert result.converged, result.failure
    found = pressures(result)
    assert found[:4].min() > 0.0 > found[-4:].min()
    # int p dA over the path: the trapezoidal rule on every step
    area = [
        result.term("air").nominal_volume,
        *(r.outputs[0, 1] for r in result.path.at_nominal("air")),
    ]
    pressure = np.append(0.0, found)
    lost = -np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(area))
    assert lost > 0.1


def test_direct_and_adjoint_agree(squeezed, tables):
    direct, adjoint = tables
    for measure in squeezed.seal.standard:
        size = np.abs(direct[measure.name]).max(axis=1, keepdims=True)
        assert (np.abs(direct[measure.name] - adjoint[measure.name]) <= 1e-9 * size).all()


def test_air_leaves_while_the_plate_rests():
    """A longer dwell leaves less pressure, and direct and adjoint derivatives agree."""
    vents = VENTS | {"closing_speed": 3e5}
    ends = {}
    for rest in (1e-4, 1e-3, 1e-2):
        result = sm.analyze(air_ring(rest=rest, **vents), keep_factors=True)
        found = pressures(result)
        # closed, dwell of two load steps
        assert found[3] > found[4] > found[5]
        ends[rest] = found[5] / found[3]
        names = tuple(result.seal.scalars)
        direct, adjoint = (
            sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")
        )
        for measure in result.seal.standard:
            size = np.abs(direct[measure.name]).max(axis=1, keepdims=True)
            assert (np.abs(direct[measure.name] - adjoint[measure.name]) <= 1e-9 * size).all()
    assert ends[1e-4] > 0.7 > ends[1e-3] > 0.3 > ends[1e-2]


@pytest.mark.parametrize("place", range(16))
def test_derivatives_against_central_differences(squeezed, tables, place):
    """In every parameter, by quotients of second order: their error falls with the square of the step
    down to that of a quotient of fourth order, 1e-6."""
    seal, name = squeezed.seal, tables[0].parameters[place]
    value = seal.scalars[name].value if name in seal.scalars else 1.0
    size = value or 1.0
    branches = np.array([r.branch for r in squeezed.path.responses("plate")])

    def moved(step):
        if name in seal.scalars:
            found = sm.analyze(seal, None, {name: value + step})
        else:
            found = sm.analyze(seal, step * np.eye(3)[place])
        assert np.array_equal(branches, [r.branch for r in found.path.responses("plate")])
        return np.concatenate([found.value(measure) for measure in seal.standard])

    exact = np.concatenate([tables[0][m.name][:, place] for m in seal.standard])
    steps = 1e-3 * size * np.array([1.0, 2.0])
    coarse, fine = (
        (moved(step) - moved(-step)) / (2.0 * step) for step in (steps[1], steps[0])
    )  # fmt: skip
    # Newton's tolerance over the step is 1e-9 of a measure's size
    noise = 1e-9 * np.abs(moved(0.0)).max() / size
    limit = 1e-6 * np.abs(exact).max() + noise
    assert exact[0] != 0.0
    errors = [np.abs(quotient - exact).max() for quotient in (coarse, fine)]
    assert errors[1] <= 0.26 * errors[0] + limit
    assert (np.abs((4.0 * fine - coarse) / 3.0 - exact) <= limit).all()


def test_other_load_steps_take_the_same_time():
    air, ends = air_ring(rest=0.3, **VENTS).definitions[-1], (0.5, 1.0, 2.5, 4.0, 5.0, 6.0, 9.0)
    other = air.with_ends(ends)
    for name, last in (("travel", 1.2 + np.hypot(0.4, 0.2)), ("time", 0.3)):
        own = getattr(air, name)
        assert own[-1] == pytest.approx(last)
        expected = np.interp((0.0, *ends), range(10), own)
        np.testing.assert_allclose(getattr(other, name), expected)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"vent_diameter": -1.0}, "vent_diameter of 'air'"),
        ({"vent_spacing": 0.0}, "vent_spacing of 'air'"),
        ({"closing_speed": 0.0}, "closing_speed of 'air'"),
        ({"discharge_coefficient": -0.1}, "discharge_coefficient of 'air'"),
        ({"travel": np.array([1.0, 0.0])}, "travel of 'air'"),
        ({"time": np.array([1.0, 0.0, 2.0])}, "time of 'air'"),
        ({"time": np.array([1.0, 2.0])}, "travel and time of the vented air 'air'"),
        ({"pressure": 0.0}, "pressure of 'air'"),
    ],
)  # fmt: skip
def test_bad_vents_are_refused(changed, words):
    given = VENTS | {"travel": np.arange(3.0)} | changed
    with pytest.raises(ValueError, match=words):
        VentedAir("air", np.arange(8), **given)
