"""Temperature, swelling and axial stretch of seal files: derivatives, equal steps, refusals."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from block_files import DESIGN, FIXED, LID, exact_seal, foam, read, text, with_model
from quotients import quotients
from ring_files import ring
from two_rubbers import pressed_block

import seal_mdao as sm
from seal_mdao.export.vtu import point_data
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.materials.stretch_and_growth import Conditions, derivatives
from seal_mdao.measures.contact_modulus import ContactModulus
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.structure.deformation import lowest_jacobian

HEATED = '"entropic"\nexpansion = 5e-4\nswelling = 1.06'
MEASURES = """\
[[measure]]
type = "strain_energy"
[[measure]]
type = "von_mises"
[[measure]]
type = "leak_rate"
rms_roughness = 150.0
roll_off_wavelength = 500.0
shortest_wavelength = 10.0
pressure = 30.0
"""
NAMES = ("axial_stretch", "temperature", "expansion", "swelling", "c10", "bulk_modulus")


def heated(given: str, model: str) -> str:
    """A seal file with keys of its only rubber and of its model."""
    given = given.replace("[material.rubber]\n", f"[material.rubber]\n{HEATED_KEYS}\n")
    return with_model(given, model)


HEATED_KEYS = f"modulus_over_temperature = {HEATED}"
LONG = heated(
    text(FIXED, LID, DESIGN, MEASURES),
    'kinematics = "generalised_plane_strain"\naxial_stretch = 1.04\ntemperature = 90.0',
)
AROUND = heated(
    ring() + '[[design]]\nedges = ["side"]\nparameters = 3\nbound = 0.3\n'
    '[[measure]]\ntype = "reaction"\n' + MEASURES,
    "temperature = [60.0]",
)


AIR = """\
[model]
kinematics = "generalised_plane_strain"
axial_stretch = 1.05
temperature = 70
[material.rubber]
shore_a = 50
expansion = 2e-4
[section]
spacing = 1.0
outer = [
  { edge = "base", line = [[-4, 0], [4, 0]] },
  { edge = "out", arc = { start = [4, 0], through = [0, 10], end = [-4, 0] } },
]
hole = [{ edge = "inside", circle = { centre = [0, 5], radius = 3 } }]
[fixed]
edges = ["base"]
[[cavity]]
hole = 1
[[profile]]
name = "lid"
friction = 0.3
contact = ["out"]
line = [[-9, 10.1], [9, 10.1]]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{ translate = [0, -1.5], steps = 2 }]
[[measure]]
type = "reaction"
profile = "lid"
component = "y"
[[measure]]
type = "strain_energy"
"""


@pytest.fixture(scope="module", params=[LONG, AROUND, foam(LONG)], ids=["long", "ring", "foam"])
def seal(request, tmp_path_factory):
    return exact_seal(tmp_path_factory.mktemp("heated"), request.param)


@pytest.fixture(scope="module")
def result(seal):
    found = sm.analyze(seal, keep_factors=True)
    found.require_converged()
    return found


def known(seal):
    return tuple(name for name in NAMES if name in seal.scalars)


def test_direct_and_adjoint_agree(seal, result):
    direct, adjoint = (
        sm.differentiate(result, known(seal), None, method) for method in ("direct", "adjoint")
    )
    for measure in seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        assert np.all(np.abs(one).max(axis=1) > 0.0)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(one).max())


@pytest.mark.parametrize(
    ("name", "step"),
    [("axial_stretch", 1e-4), ("temperature", 1e-2), ("expansion", 1e-6), ("swelling", 1e-4),
     ("boundary_offsets[1]", 2e-5)],
)  # fmt: skip
def test_derivatives_are_those_of_the_path(seal, result, name, step):
    if name == "axial_stretch" and name not in seal.scalars:
        assert seal.body.axisymmetric
        return
    direct = sm.differentiate(result, known(seal), None, "direct")
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, step).items():
        one = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-5 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-4), measure


@pytest.mark.parametrize("points", ["[[0, 1.3], [60, 1.0], [120, 0.9]]", "[[0, 1.3], [120, 0.7]]"])
def test_derivatives_at_a_point_of_a_table_are_those_of_higher_temperatures(tmp_path, points):
    given = with_model(
        text(FIXED, LID).replace(
            "[material.rubber]\n", f"[material.rubber]\nmodulus_over_temperature = {points}\n"
        ),
        "temperature = 60.0",
    )
    result = sm.analyze(exact_seal(tmp_path, given))
    corner = "60 degrees" if points.count("[") > 3 else None
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", sm.KinkWarning)
        # nothing else has a kink there
        sm.differentiate(result, ["c10"], ["reaction"])
        assert not found
        own = sm.differentiate(result, ["temperature"], ["reaction"])["reaction"][-1]
    assert [corner in str(one.message) for one in found] == ([True] if corner else [])

    def at(temperature):
        other = sm.analyze(result.seal, parameters={"temperature": temperature})
        return other.value("reaction")[0]

    h = 0.01
    # (4 f(h) - f(2 h) - 3 f(0)) / (2 h) on either side
    above, below = (
        side * (4.0 * at(60.0 + side * h) - at(60.0 + 2.0 * side * h) - 3.0 * at(60.0)) / (2.0 * h)
        for side in (1, -1)
    )
    assert own == pytest.approx(above, rel=1e-5)
    # slopes of the table -0.3 / 60 and -0.1 / 60
    assert below / above == pytest.approx(3.0 if corner else 1.0, rel=0.02)


def test_trapped_air_is_heated_and_stretched(tmp_path):
    """(p_a + p) (h A)^gamma / T is constant on the path; its derivatives are those of the path."""
    seal = exact_seal(tmp_path, AIR)
    result = sm.analyze(seal, keep_factors=True)
    result.require_converged()
    environment, steps = seal.terms()[0].environment, (1, 2)
    pressure, area = np.array([own.outputs[0] for own in result.path.at_nominal("air")]).T
    stretch, hot = environment.axial_stretch.at(steps), environment.temperature.at(steps) + 273.15
    constant = (101.325 + pressure) * (stretch * area) ** 1.4 / hot
    nominal = abs(polygon_area(result.particles[seal.body.edge("inside").particles])[0])
    np.testing.assert_allclose(constant, 101.325 * nominal**1.4 / 296.15, rtol=1e-12)
    names = ("temperature", "axial_stretch", "air_gamma", "air_pressure", "expansion")
    direct, adjoint = (
        sm.differentiate(result, names, None, method) for method in ("direct", "adjoint")
    )
    for name in names:
        column = direct.parameters.index(name)
        found = quotients(seal, name, 1e-4 * seal.scalars[name].value)
        for measure, (quotient, bound) in found.items():
            one, other = (np.atleast_2d(own[measure])[:, column] for own in (direct, adjoint))
            np.testing.assert_allclose(one, other, rtol=1e-10)
            assert np.all(np.abs(one - quotient) <= bound), (name, measure)
            assert bound.max() <= 1e-5 * np.abs(one).max(), (name, measure)


def test_air_is_heated_in_a_rubber_that_does_not_depend_on_temperature(tmp_path):
    """Its pressure lifts the lid more than that of cold air; a temperature alone is no error."""
    plane = AIR.replace('kinematics = "generalised_plane_strain"\naxial_stretch = 1.05\n', "")
    plane = plane.replace("expansion = 2e-4\n", "")
    results = []
    for given in (plane, plane.replace("temperature = 70\n", "")):
        result = sm.analyze(exact_seal(tmp_path, given))
        result.require_converged()
        nominal = abs(polygon_area(result.particles[result.seal.body.edge("inside").particles])[0])
        pressure, area = result.path.at_nominal("air")[-1].outputs[0]
        hot = 343.15 / 296.15 if "temperature" in given else 1.0
        assert pressure == pytest.approx(101.325 * (hot * (nominal / area) ** 1.4 - 1.0), rel=1e-10)
        results.append(result)
    hot, cold = (own.path.reaction("lid")[-1, 1] for own in results)
    assert hot > 1.01 * cold


def test_values_at_the_ends_of_stages(tmp_path):
    given = LONG.replace(
        "stage = [{ translate = [0, -0.5], steps = 3 }]",
        "stage = [{ translate = [0, -0.5], steps = 2 }, { translate = [0, 0.1], steps = 3 }]",
    ).replace("temperature = 90.0", "temperature = [90.0, -10.0]")
    environment = sm.build_seal(read(tmp_path, given)).terms()[0].environment
    np.testing.assert_allclose(
        environment.temperature.at(range(6)), [23.0, 56.5, 90.0, 170 / 3, 70 / 3, -10.0]
    )
    np.testing.assert_allclose(environment.axial_stretch.at(range(6)), [1, 1.02, *[1.04] * 4])
    # the parameter is the temperature that is farthest from 23 degrees: the other keeps its share
    hotter = environment.with_parameters({"temperature": 123.5})
    np.testing.assert_allclose(hotter.temperature.at([2, 5]), [123.5, 23 - 33 * 1.5])


def test_a_rubber_without_heat_has_the_results_of_plane_strain(tmp_path):
    """Stretch 1 and the temperature of reference, to the bit."""
    plain = text(FIXED, LID, DESIGN, MEASURES)
    still = heated(
        plain,
        'kinematics = "generalised_plane_strain"\naxial_stretch = 1.0\ntemperature = 23.0',
    ).replace("swelling = 1.06", "swelling = 1.0")
    results = [sm.analyze(sm.build_seal(read(tmp_path, own))) for own in (plain, still)]
    one, other = (result.path.steps[-1].d for result in results)
    np.testing.assert_array_equal(one, other)
    assert results[0].strain_energy == results[1].strain_energy


def test_checks_know_the_stretch_along_the_section(tmp_path):
    """Of a section that contracts freely: J = 1, and one of the principal stretches is the given one."""
    given = LONG.replace("1.04", "1.9").replace("swelling = 1.06", "swelling = 1.0")
    given = given.replace("temperature = 90.0", "temperature = 23.0")
    given = given.replace("start = [0, 4.02]", "start = [0, 4.5]").replace("-0.5]", "-0.1]")
    result = sm.analyze(sm.build_seal(read(tmp_path, given)))
    samples = EvaluationPoints(result.path)
    free = samples.undeformed[:, 1] > 2.0
    # J - 1 = p / K with stresses up to two shear moduli, K = 20 of them; det F is 0.53
    np.testing.assert_allclose(samples.volume_change[free], 1.0, atol=0.1)
    np.testing.assert_allclose(samples.stretches[free, 1], 1.9, rtol=1e-12)


@pytest.mark.parametrize("given", [LONG, AROUND], ids=["long", "ring"])
def test_volume_ratios_contain_the_stretch_across_the_section(tmp_path, given):
    """J = h det F: of exported fields and of the least one of a path."""
    result = sm.analyze(exact_seal(tmp_path, given))
    f = result.gradient()
    h = 1.04 if given is LONG else result.deformed()[:, 0] / result.particles[:, 0]
    expected = h * (f[:, 0] * f[:, 3] - f[:, 1] * f[:, 2])
    np.testing.assert_allclose(result.volume_ratio(), expected, rtol=1e-12)
    np.testing.assert_array_equal(point_data(result, -1)["det_F"], result.volume_ratio())
    # at the quadrature points after the last step: F_11 F_22 - F_12 F_21
    end = result.path.steps[-1]
    f11, f12, f21, f22, _, *hoop = np.moveaxis(
        result.term("structure").deformation_of(end.d[None], [end.fraction]).f[0], -1, 0
    )
    least = np.min((f11 * f22 - f12 * f21) * (hoop[0] if hoop else 1.04))
    assert lowest_jacobian(replace(result.path, steps=(end,))) == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("axial_stretch = 1.04\n", "", "needs axial_stretch, such as 1.03"),
        ('kinematics = "generalised_plane_strain"\n', "", "axial_stretch = 1.04 needs kinematics"),
        (
            "axial_stretch = 1.04",
            "axial_stretch = [1.0, 1.04]",
            "has 2 numbers, but the motion of 'lid' has 1 stage; give one",
        ),
        ("temperature = 90.0", "temperature = -300.0", "above -273.15 and at most 1000"),
        (
            '"entropic"',
            "[[0.0, 1.0], [50.0, 0.8]]",
            "goes from 0 to 50 degrees Celsius, but .* from 23 to 90",
        ),
        ('"entropic"', "[[50.0, 1.0], [0.0, 0.8]]", "with increasing temperatures"),
        (
            'type = "von_mises"',
            'type = "friction_work"',
            r"\[\[measure\]\] 3: friction_work is not available with",
        ),
        (
            "[fixed]",
            '[optimize]\nminimize = "friction_work"\n[fixed]',
            r"\[optimize\]: minimize = 'friction_work': friction_work is not available with",
        ),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, old, new, words):
    assert old in LONG
    with pytest.raises(sm.SealFileError, match=words):
        read(tmp_path, LONG.replace(old, new))


def test_conditions_of_file_and_seal_are_those_of_the_path(tmp_path):
    """At the end from the file, after any load step from the seal, with its changed parameters."""
    given = LONG.replace("temperature = 90.0", "temperature = [90.0]")
    file = read(tmp_path, given)
    end = {"axial_stretch": 1.04, "temperature_degC": 90.0}
    assert file.conditions() == end | {"swelling": 1.06}
    seal = sm.build_seal(file)
    assert seal.conditions() == file.conditions()
    assert seal.conditions(0) == {
        "axial_stretch": 1.0, "temperature_degC": 23.0, "swelling": 1.0,
    }  # fmt: skip
    cold = seal.with_parameters({"temperature": -20.0, "swelling": 1.2})
    assert cold.conditions()["temperature_degC"] == -20.0
    assert cold.conditions()["swelling"] == 1.2
    assert sm.build_seal(read(tmp_path, text(FIXED, LID))).conditions() == {}


TABLE = LONG.replace('"entropic"', "[[0.0, 1.1], [23.0, 1.0], [100.0, 0.8]]")


@pytest.mark.parametrize(
    ("given", "changes", "words"),
    [
        (
            TABLE,
            {"temperature": -10.0},
            "goes from 0 to 100 degrees Celsius, but the temperature varies from -10 to 23",
        ),
        (
            TABLE,
            {"temperature": 100.5},
            "goes from 0 to 100 degrees Celsius, but the temperature varies from 23 to 100.5",
        ),
        (LONG, {"temperature": -274.0}, "temperature must be a number above -273.15"),
        (LONG, {"swelling": 0.0}, "swelling must be a number above 0 and at most 10"),
        (LONG, {"axial_stretch": 0.4}, "axial_stretch must be a number of at least 0.5"),
    ],
)
def test_parameters_are_refused_where_the_file_would_be(tmp_path, given, changes, words):
    seal = sm.build_seal(read(tmp_path, given))
    with pytest.raises(ValueError, match=words):
        seal.with_parameters(changes)


def test_ideal_rubber_has_a_modulus_at_every_temperature(tmp_path):
    """m = T / T_0, to rounding: a line of few points from absolute zero on."""
    (region,) = sm.build_seal(read(tmp_path, LONG)).definitions[0].regions
    at = np.array([-273.0, -20.0, 22.0, 23.0, 90.0, 1000.0])
    factors, slopes = region.growth.factor(at)
    np.testing.assert_allclose(factors, (at + 273.15) / 296.15, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(slopes, 1.0 / 296.15, rtol=1e-12)
    assert factors[3] == 1.0


def test_a_ring_has_no_axial_stretch(tmp_path):
    given = AROUND.replace("temperature = [60.0]", "axial_stretch = 1.05")
    with pytest.raises(
        sm.SealFileError, match="a ring is stretched by a profile that moves along x"
    ):
        read(tmp_path, given)


def test_a_temperature_that_changes_nothing_is_refused(tmp_path):
    given = LONG.replace(f"{HEATED_KEYS}\n", "")
    with pytest.raises(
        sm.SealFileError, match="no material depends on temperature, and there is no"
    ):
        read(tmp_path, given)


@pytest.mark.parametrize(
    ("key", "value"), [("modulus_over_temperature", '"entropic"'), ("expansion", "0.0005")]
)
def test_keys_that_need_a_temperature_are_refused_without_one(tmp_path, key, value):
    keys = f"{key} = {value}\nswelling = 1.1"
    given = LONG.replace("temperature = 90.0\n", "").replace(HEATED_KEYS, keys)
    said = f"{key} = {value}".replace('"', "'")
    words = re.escape(
        f"[material.rubber]: {said}, which has no effect, because [model] has no temperature"
    )
    with pytest.raises(sm.SealFileError, match=f"{words}.*; add temperature = 60"):
        read(tmp_path, given)


def test_without_a_temperature_the_expansion_is_no_parameter(tmp_path):
    """Nor has it derivatives; the swelling has."""
    given = LONG.replace("temperature = 90.0\n", "").replace(HEATED_KEYS, "swelling = 1.1")
    cold, hot = (sm.build_seal(read(tmp_path, own)) for own in (given, LONG))
    assert "expansion" in hot.scalars
    assert "expansion" not in cold.scalars
    assert "swelling" in cold.scalars
    found = sm.analyze(cold)
    gradients = sm.differentiate(found, ("swelling",), method="direct")
    assert np.abs(gradients["strain_energy"][..., -1]).max() > 0.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("c10 = 80.0\nc01 = 20.0", "c10 = 0.4\nc01 = 0.1", "shear modulus of 1 kPa, smaller than"),
        (
            "c10 = 80.0\nc01 = 20.0\nbulk_modulus = 4000.0",
            "c10 = 1e4\nc01 = 2e3\nbulk_modulus = 1e6",
            "shear modulus of 2.4e+04 kPa, larger",
        ),
        ("bulk_modulus = 4000.0", "bulk_modulus = 2e9", "bulk modulus of 2e+09 kPa, larger than"),
        ("expansion = 5e-4", "expansion = 1e-3", "expansion of 0.001 1/K, outside of"),
        (
            "swelling = 1.06",
            "swelling = 0.15",
            "swelling of 0.15, outside of 0.8 to 3; swelling is",
        ),
        ("temperature = 90.0", "temperature = 363.15", "temperature of 363.1 degrees Celsius is"),
    ],
)
def test_values_that_no_rubber_has_are_warned_about(tmp_path, old, new, words):
    assert old in LONG
    seal = sm.build_seal(read(tmp_path, LONG.replace(old, new)))
    (text,) = seal.warnings
    assert words in text


def test_values_of_rubber_are_not_warned_about(tmp_path):
    seal = sm.build_seal(read(tmp_path, LONG))
    assert not seal.warnings
    # parameters that are changed later are looked at, too
    assert "shear modulus of 0.8 kPa" in seal.with_parameters({"c10": 0.3, "c01": 0.1}).warnings[0]


def test_a_stiff_part_beside_rubber_may_be_an_insert(tmp_path):
    """One line for both moduli of steel, and none that compares it with rubber alone."""
    path = tmp_path / "seal.toml"
    rows = 'law = "neo_hookean"\nc10 = {}\nbulk_modulus = {}\n'
    materials = ("soft", 400.0, 1e6), ("stiff", 4e7, 1.6e8)
    text = "".join(f"[material.{name}]\n{rows.format(*own)}" for name, *own in materials)
    path.write_text(text + pressed_block(1.0), encoding="utf-8")
    (found,) = (own for own in sm.build_seal(path).warnings if "modulus" in own)
    assert "'stiff' has an initial shear modulus of 8e+07 kPa" in found
    assert "it is an insert of plastic" in found


@pytest.mark.parametrize("kind", ["rubber", "foam"])
def test_modulus_in_contact_is_that_of_the_heated_and_swollen_material(tmp_path, kind):
    """4 G with the shear modulus 2 W_T theta^2 / theta^3 of the law at the stretches of free growth."""
    result = sm.analyze(exact_seal(tmp_path, LONG if kind == "rubber" else foam(LONG)))
    (region,) = result.term("structure").definition.regions
    theta, factor = (1.0 + 5e-4 * 67.0) * np.cbrt(1.06), (90.0 + 273.15) / 296.15
    grown = Conditions(*np.full((3, 1), [[theta], [theta], [factor]]))
    # long section: W per length theta of the stretched section, so P = theta W_T F per unit of its own
    square, ratio = np.array([2.0 * theta**2]), np.array([theta**2])
    w_t = theta * derivatives(region.material, (square, ratio), grown)[0]
    modulus = (4.0 * 2.0 * w_t * theta**2 / theta**3).item()
    np.testing.assert_allclose(ContactModulus(result, "lid").values, modulus, rtol=1e-12)
    if kind == "rubber":
        given = LONG.replace('"leak_rate"\n', f'"leak_rate"\nmodulus = {modulus!r}\n')
        assert 0.0 < result.leak_rate < np.inf
        assert sm.analyze(exact_seal(tmp_path, given)).leak_rate == pytest.approx(
            result.leak_rate, rel=1e-9
        )
