"""Leak rate of seals: exact cases, derivatives, tight and open contacts, what is refused."""

from dataclasses import replace

import numpy as np
import openmdao.api as om
import pytest
from foam_bulbs import BLOCK, foam_bulb
from quotients import quotients
from two_rubbers import pressed_block

import seal_mdao as sm
from seal_mdao.measures.contact_pressure import PointPressures
from seal_mdao.measures.leak_rate import LeakRate
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.roughness import Roughness

TIGHT = sm.NewtonOptions(tolerance=1e-12)
DOOR = LeakRate("door", 20.0, 500.0, 10.0, 30.0)
"""Roughness for which the soft door seal conducts about as an open slit of 20 um."""
TERMS = ("depth", "door_radius", "friction", "normal_penalty", "c10", "c01")
OWN = ("leak_rate_rms_roughness", "leak_rate_viscosity", "leak_rate_pressure")
SEALS = {
    "particles": sm.door_seal(n_steps=20, newton=TIGHT),
    "edges": sm.door_seal("engineering", n_steps=8, newton=TIGHT),
}
MATERIALS = """
[material.soft]
law = "yeoh"
c10 = 100.0
c20 = -1.0
c30 = 0.1
bulk_modulus = 2e3
[material.stiff]
law = "neo_hookean"
c10 = 400.0
bulk_modulus = 6e3
"""
LEAK = """\
[[measure]]
type = "leak_rate"
rms_roughness = 5.0
roll_off_wavelength = 100.0
shortest_wavelength = 1.0
longest_wavelength = 400.0
hurst_exponent = 0.7
viscosity = 2.0
pressure = 20.0
"""


@pytest.fixture(scope="module", params=SEALS)
def result(request):
    seal = SEALS[request.param]
    seal = replace(seal, standard=(*seal.standard, DOOR))
    offsets = np.random.default_rng(3).uniform(-0.05, 0.05, seal.n_offsets)
    return sm.analyze(seal, offsets, keep_factors=True)


def block(folder, travel=-0.65, *changes):
    text = MATERIALS + pressed_block(0.5, start=4.5, travel=travel) + LEAK
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "block.toml"
    path.write_text(text)
    return sm.build_seal(path)


def leak(result, measure="leak_rate"):
    return float(result.value(measure)[0])


def test_layer_of_two_rubbers_in_si_units(tmp_path):
    """The rubber in contact alone decides on the modulus, 4 G = 8 c10; all of the 6 mm conduct."""
    result = sm.analyze(block(tmp_path))
    rough = Roughness(5.0, 100.0, 1.0, 0.7, 400.0)
    points = PointPressures(result, "plate", nominal=False)
    length = 1e-3 * result.term("plate").where.lengths(result.deformed())
    assert length.sum() == pytest.approx(6e-3, rel=1e-8)

    def slit(pressure):
        """Conductance u^3 / (12 eta), m^3 / (Pa s)."""
        return (1e-6 * rough.constriction(pressure / 800.0)[0]) ** 3 / (12.0 * 2e-3)

    # m^2/s = 1e9 mm^3/s per m
    series = 1e9 * 20e3 / (length / slit(points.value)).sum()
    assert leak(result) == pytest.approx(series, rel=1e-12)
    # one slit under the mean pressure; that of the points scatters near the planes of symmetry
    mean = result.value(Reaction("plate", direction="travel")) / 6.0
    assert 0.2 < mean[0] / 800.0 / rough.percolation_ratio < 0.5
    assert leak(result) == pytest.approx(1e9 * 20e3 * slit(mean)[0] / 6e-3, rel=0.2)


def test_contact_points_are_in_series(result):
    """Pressure difference over the sum of l / sigma with the true pressures, c10 = 80, c01 = 20."""
    pressure = PointPressures(result, "door", nominal=False).value
    length = result.term("door").where.lengths(result.deformed())
    on = pressure > 0.0
    height = DOOR.roughness.constriction(pressure[on] / 800.0)[0]
    resistance = (12.0 * 1e-6 * length[on] / (1e-3 * height) ** 3).sum()
    assert leak(result) == pytest.approx(1e3 * 30.0 / resistance, rel=1e-12)
    assert on.sum() >= 4


def test_direct_and_adjoint_agree(result):
    direct, adjoint = (
        sm.differentiate(result, (*TERMS, *OWN), [DOOR], way) for way in ("direct", "adjoint")
    )
    one, other = direct.leak_rate[0], adjoint.leak_rate[0]
    assert np.abs(one - other).max() <= 1e-9 * np.abs(one).max()
    assert one[-len(OWN) :] == pytest.approx(other[-len(OWN) :], rel=1e-14)
    assert (one[-len(TERMS) - len(OWN) :] != 0.0).all()


@pytest.mark.parametrize("name", ["boundary_offsets[5]", "boundary_offsets[18]", *TERMS, *OWN])
def test_central_differences(result, name):
    """Within their own bound of error, which is small beside the derivative."""
    names = () if name.startswith("boundary") else (name,)
    rates = sm.differentiate(result, names, [DOOR], "adjoint")
    own = rates.leak_rate[0, rates.parameters.index(name)]
    size = abs(result.seal.scalars[name].value) if names else 1.0
    found = quotients(
        result.seal, name, 1e-5 * max(size, 0.1), measures=[DOOR], start=result.boundary_offsets
    )
    quotient, bound = found["leak_rate"]
    assert abs(quotient[0] - own) <= bound[0] + 1e-9 * abs(own)
    assert bound[0] <= 1e-4 * (abs(own) + leak(result) / max(size, 0.1))


def test_step_study_of_the_squeeze(result):
    """Errors of central differences in the closing depth fall with the square of the step."""
    seal, offsets = result.seal, result.boundary_offsets
    rate = sm.differentiate(result, ("depth",), [DOOR]).leak_rate[0, -1]
    start, errors = seal.scalars["depth"].value, []
    for step in (4e-3, 2e-3, 1e-3):
        above, below = (
            leak(sm.analyze(seal, offsets, {"depth": start + sign * step}), DOOR)
            for sign in (1.0, -1.0)
        )
        errors.append(abs((above - below) / (2.0 * step) - rate))
    assert errors[1] == pytest.approx(errors[0] / 4.0, rel=0.05)
    assert errors[2] == pytest.approx(errors[1] / 4.0, rel=0.05)


def test_the_modulus_of_the_material_and_a_given_one(tmp_path):
    own = sm.analyze(block(tmp_path), keep_factors=True)
    given = sm.analyze(
        block(tmp_path, -0.65, ("viscosity = 2.0", "viscosity = 2.0\nmodulus = 800.0")),
        keep_factors=True,
    )
    assert leak(given) == leak(own)
    by_modulus = sm.differentiate(given, ("leak_rate_modulus",)).leak_rate[0, 0]
    names = ("soft_c10", "soft_c20", "stiff_c10")
    rates = [sm.differentiate(result, names).leak_rate[0] for result in (own, given)]
    # the rubber in contact: E / (1 - nu^2) = 8 c10, beside its pressure
    assert (rates[0] - rates[1])[:2] == pytest.approx([8.0 * by_modulus, 0.0], rel=1e-9)
    assert rates[0][2] == pytest.approx(rates[1][2], rel=1e-9)
    for name in (*names, "leak_rate_rms_roughness"):
        rate = sm.differentiate(own, (name,)).leak_rate[0, 0]
        quotient, bound = quotients(own.seal, name, 1e-4 * abs(own.seal.scalars[name].value))[
            "leak_rate"
        ]
        assert abs(quotient[0] - rate) <= bound[0] + 1e-9 * abs(rate), name


def test_tight_contact_does_not_leak(tmp_path):
    """Some point above the percolation pressure is enough; the derivatives vanish there, too."""
    result = sm.analyze(block(tmp_path, -1.6), keep_factors=True)
    pressure = PointPressures(result, "plate", nominal=False).value.max()
    assert pressure > 800.0 * Roughness(5.0, 100.0, 1.0, 0.7, 400.0).percolation_ratio
    assert leak(result) == 0.0
    assert not sm.differentiate(result, ("soft_c10", OWN[0])).leak_rate.any()


def test_without_contact_the_leak_rate_is_infinite(tmp_path):
    result = sm.analyze(block(tmp_path, -0.4), keep_factors=True)
    assert leak(result) == np.inf
    assert not sm.differentiate(result, ("soft_c10", OWN[0])).leak_rate.any()


def test_error_by_the_penalty_is_relative_to_the_leak_rate_itself(tmp_path):
    """Not to its values before, which are larger by orders of magnitude or infinite."""
    stiff, soft = (
        sm.analyze(block(tmp_path, -0.65, ("normal_penalty = 1e6", f"normal_penalty = {penalty}")))
        for penalty in ("1e6", "1e5")
    )
    found = soft.penalty_error["leak_rate"]
    assert found.scale == leak(soft)
    assert found.relative == pytest.approx((leak(soft) - leak(stiff)) / leak(soft) / 0.9, rel=0.2)
    assert found.relative > 1e-4


def test_own_parameters_of_the_seal(tmp_path):
    seal = block(tmp_path)
    assert [seal.scalars[name][:2] for name in OWN] == [(5.0, "um"), (2.0, "mPa*s"), (20.0, "kPa")]
    assert "leak_rate_modulus" not in seal.scalars
    start = leak(sm.analyze(seal))
    doubled = sm.analyze(seal, parameters={OWN[1]: 4.0, OWN[2]: 60.0})
    assert leak(doubled) == pytest.approx(1.5 * start, rel=1e-12)
    # another measure of the same name has its own numbers
    other = replace(seal.standard[0], pressure=40.0)
    assert leak(sm.analyze(seal), other) == pytest.approx(2.0 * start, rel=1e-12)
    with pytest.raises(ValueError, match="viscosity of 'leak_rate' must be a number above 0"):
        seal.with_parameters({OWN[1]: -1.0})
    with pytest.raises(ValueError, match="rms_roughness must be a number above 0"):
        sm.analyze(seal, parameters={OWN[0]: 0.0})


def test_component_has_them_as_inputs(tmp_path):
    moved = 'pressure = 20.0\n[[design]]\nedges = ["top"]\nparameters = 4\nbound = 0.1'
    seal, names = block(tmp_path, -0.65, ("pressure = 20.0", moved)), (OWN[0], "soft_c10")
    prob = om.Problem()
    prob.model = sm.SealGroup(seal=seal, parameters=names)
    prob.setup()
    prob.run_model()
    totals = prob.compute_totals(["leak_rate"], ["boundary_offsets", *names])
    result = sm.analyze(seal, keep_factors=True)
    rates = sm.differentiate(result, names).leak_rate[0]
    found = [totals["leak_rate", name].ravel() for name in ("boundary_offsets", *names)]
    assert np.concatenate(found) == pytest.approx(rates, rel=1e-12)
    assert prob.get_val("leak_rate", units="mL/h/m") == pytest.approx(3.6 * leak(result), rel=1e-12)


SPONGE = (
    'law = "yeoh"\nc10 = 100.0\nc20 = -1.0\nc30 = 0.1\nbulk_modulus = 2e3', 'sponge = "2A3"',
)  # fmt: skip


def test_foam_below_the_edge_in_contact_is_not_in_contact(tmp_path):
    """A bulb of rubber on a block of foam: its edge ends at the interface, far from the contact."""
    text = foam_bulb(BLOCK, 0.8)
    for old, new in (('sponge = "2A3"', "shore_a = 50"), ("shore_a = 75", 'sponge = "2A3"')):
        text = text.replace(old, new)
    text += '[[measure]]\ntype = "leak_rate"\nrms_roughness = 5.0\nroll_off_wavelength = 500.0\n'
    path = tmp_path / "bulb.toml"
    path.write_text(text + "shortest_wavelength = 1.0\npressure = 10.0\n")
    result = sm.analyze(sm.build_seal(path))
    assert result.value("leak_rate")[0] > 0.0


def test_compressible_rubber_needs_its_modulus(tmp_path):
    with pytest.raises(
        sm.SealFileError,
        match=r"measure\]\] 1 .* the material in contact is compressible .* modulus",
    ):
        block(tmp_path, -0.65, SPONGE)
    seal = block(tmp_path, -0.65, SPONGE, ("viscosity = 2.0", "viscosity = 2.0\nmodulus = 90.0"))
    assert seal.scalars["leak_rate_modulus"].value == 90.0
    with pytest.raises(ValueError, match="compressible"):
        leak(sm.analyze(seal), LeakRate("plate", 5.0, 100.0, 1.0, 20.0))


@pytest.mark.parametrize(("wrong", "words"), [
    ({"pressure": 0.0}, "pressure of 'leak_rate' must be a number above 0, got 0.0"),
    ({"viscosity": -1.0}, "viscosity of 'leak_rate' must be a number above 0"),
    ({"modulus": float("inf")}, "modulus of 'leak_rate' must be a number above 0"),
    ({"shortest_wavelength": 600.0}, "got 600, 500, 500 um"),
])  # fmt: skip
def test_wrong_numbers(wrong, words):
    with pytest.raises(ValueError, match=words):
        replace(DOOR, **wrong)
