"""Vented air of seals that are heated, stretched or relax: limits, balance of mass, derivatives."""

import numpy as np
import pytest
from block_files import exact_seal, read
from quotients import quotients
from test_environment import AIR

import seal_mdao as sm
from seal_mdao.geometry.polygon import polygon_area

VENTS = "vent_diameter = {}\nvent_spacing = 60.0\nclosing_speed = 400.0\n"
LONG = (
    AIR.replace("hole = 1\n", f"hole = 1\n{VENTS}").replace(
        'type = "strain_energy"', 'type = "cavity_pressure"'
    )
    + '[[design]]\nedges = ["inside"]\nparameters = 4\nbound = 0.3\n'
)
# a ring with its middle 20 mm away from the axis
AROUND = (
    LONG.replace("generalised_plane_strain", "axisymmetric").replace("axial_stretch = 1.05\n", "")
    .replace("[[-4, 0], [4, 0]]", "[[16, 0], [24, 0]]").replace("centre = [0, 5]", "centre = [20, 5]")
    .replace("start = [4, 0], through = [0, 10], end = [-4, 0]",
             "start = [24, 0], through = [20, 10], end = [16, 0]")
    .replace("[[-9, 10.1], [9, 10.1]]", "[[11, 10.1], [29, 10.1]]")
)  # fmt: skip
# the lid dwells, in the logarithm of time, after it has closed within 4 ms
STAGES = """stage = [
  { translate = [0, -1.5], steps = 2, duration = 0.004 }, { steps = 2, duration = 0.02 },
]"""
RELAXING = (
    LONG.replace('kinematics = "generalised_plane_strain"\naxial_stretch = 1.05\n', "")
    .replace("temperature = 70", "temperature = [70, 70]").replace("closing_speed = 400.0\n", "")
    .replace("stage = [{ translate = [0, -1.5], steps = 2 }]", STAGES)
    .replace("[section]", "[material.rubber.viscoelastic]\ng = [0.3]\ntau = [0.01]\n[section]")
)  # fmt: skip
CASES = {"long": LONG, "ring": AROUND, "relaxing": RELAXING}
STEPS = {
    "temperature": 1e-2, "axial_stretch": 1e-4, "air_vent_diameter": 1e-4, "air_gamma": 1e-4,
    "air_closing_speed": 1e-1, "time": 2e-6, "duration_1": 2e-6, "boundary_offsets[1]": 2e-5,
}  # fmt: skip


def seal_of(folder, given, diameter=1.2):
    return exact_seal(folder, given.replace("vent_diameter = {}", f"vent_diameter = {diameter}"))


@pytest.fixture(scope="module", params=CASES.values(), ids=CASES)
def found(request, tmp_path_factory):
    seal = seal_of(tmp_path_factory.mktemp("vented"), request.param)
    result = sm.analyze(seal, keep_factors=True)
    result.require_converged()
    names = tuple(n for n in seal.scalars if not n.endswith("penalty"))
    tables = [sm.differentiate(result, names, None, own) for own in ("direct", "adjoint")]
    return seal, result, tables


def test_direct_and_adjoint_agree(found):
    seal, _, (direct, adjoint) = found
    for measure in seal.standard:
        one, other = (np.atleast_2d(own[measure.name]) for own in (direct, adjoint))
        assert np.abs(one).max() > 0.0
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(one).max())


@pytest.mark.parametrize("name", STEPS)
def test_derivatives_are_those_of_the_path(found, name):
    seal, _, (direct, _) = found
    if name not in direct.parameters:
        pytest.skip("no parameter of this seal")
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, STEPS[name]).items():
        one = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-4 * np.abs(one).max(), measure


def test_mass_is_that_of_the_state_and_lost_in_the_time_of_the_path(found):
    """(p_a + p)(h V)^gamma / T gives the mass that is left, with any time; part of it has left."""
    _, result, _ = found
    term, steps = result.term("air"), range(1, len(result.path.nominal_steps) + 1)
    around, masses = term.environment, []
    for step, response in zip(steps, result.path.at_nominal("air"), strict=True):
        pressure, volume = response.outputs[0]
        hot = (around.temperature.at([step])[0] + 273.15) / 296.15
        h = 1.0 if around.axial_stretch is None else around.axial_stretch.at([step])[0]
        density = ((term.outside + pressure) / (term.outside * hot)) ** (1.0 / term.gamma)
        mass = density * h * volume / term.nominal_volume
        assert response.history.mass == pytest.approx(mass, rel=1e-10)
        masses.append(mass)
    assert np.all(np.diff([1.0, *masses]) < 0.0)
    assert masses[-1] < 0.99


@pytest.mark.parametrize("reference", [23.0, 60.0])
@pytest.mark.parametrize("case", ["long", "ring"])
def test_air_leaves_as_through_a_nozzle_at_its_temperature(tmp_path, case, reference):
    """Every load step loses C_d a dt sqrt(2 p rho psi), in SI units, with the density of the state,
    which is at the start that of air at the reference temperature.

    psi = k / (k - 1) (r^(2/k) - r^((k+1)/k)), r = p_a / p (de Saint-Venant and Wantzel 1839).
    """
    given = CASES[case].replace("[model]", f"[model]\nreference_temperature = {reference}")
    result = sm.analyze(seal_of(tmp_path, given))
    result.require_converged()
    seal = result.seal
    term, k, before, done = result.term("air"), 1.4, 1.0, 0.0
    hole = polygon_area(result.particles[seal.body.edge("inside").particles])[0]
    zero = reference + 273.15
    start = 101325.0 / (287.05 * zero)
    for step in result.path.steps:
        air = result.response("air", step)
        hot = (term.environment.temperature.at([step.fraction])[0] + 273.15) / zero
        pressure = 101325.0 + 1e3 * air.outputs[0, 0]
        ratio = 101325.0 / pressure
        assert 0.6 < ratio < 1.0  # out of the hole, slower than sound
        density = start * (1.0 / ratio / hot) ** (1.0 / term.gamma)
        psi = k / (k - 1.0) * (ratio ** (2.0 / k) - ratio ** ((k + 1.0) / k))
        # 0.75 mm at 400 mm/s in each of the two steps; area per length, m
        time, area = (step.fraction - done) * 0.75 / 400.0, 0.25 * np.pi * 1.2e-3**2 / 60e-3
        lost = 0.61 * area * time * np.sqrt(2.0 * pressure * density * psi)
        assert before - air.history.mass == pytest.approx(
            lost / (start * abs(hole) * 1e-6), rel=1e-6
        )
        before, done = air.history.mass, step.fraction


@pytest.mark.parametrize("case", CASES)
def test_narrow_vents_are_none(tmp_path, case):
    """The pressure tends to that of trapped air."""
    sealed = (
        CASES[case].replace(VENTS, "").replace(VENTS.replace("closing_speed = 400.0\n", ""), "")
    )
    assert "vent" not in sealed
    one, other = (
        sm.analyze(own) for own in (seal_of(tmp_path, CASES[case], 1e-7), seal_of(tmp_path, sealed))
    )
    for result in (one, other):
        result.require_converged()
    pressures = [
        [own.outputs[0, 0] for own in result.path.at_nominal("air")] for result in (one, other)
    ]
    np.testing.assert_allclose(*pressures, rtol=1e-9)


def test_an_environment_that_changes_nothing_has_the_bits_of_none(tmp_path):
    plain = LONG.replace('kinematics = "generalised_plane_strain"\naxial_stretch = 1.05\n', "")
    plain = plain.replace("temperature = 70\n", "").replace("expansion = 2e-4\n", "")
    still = LONG.replace("axial_stretch = 1.05", "axial_stretch = 1.0")
    still = still.replace("temperature = 70", "temperature = 23")
    one, other = (sm.analyze(seal_of(tmp_path, own)) for own in (plain, still))
    np.testing.assert_array_equal(one.path.steps[-1].d, other.path.steps[-1].d)
    assert one.response("air").history.mass == other.response("air").history.mass


def test_a_speed_of_relaxing_seals_is_refused(tmp_path):
    given = RELAXING.replace("vent_diameter = {}", "vent_diameter = 1.2\nclosing_speed = 400.0")
    with pytest.raises(sm.SealFileError, match="closing_speed = 400 has no effect"):
        read(tmp_path, given)
