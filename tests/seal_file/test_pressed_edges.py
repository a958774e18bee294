"""Pressure on complete edges, ``[[fluid]]`` without ``from``: thick tubes and inflatable seals."""

import numpy as np
import pytest
from exact_gradients import require_exact
from square_bodies import AROUND, HEIGHT, SHEAR_MODULUS, inverse_tangent, rubber, section
from verification.cylinder import inflation_pressure

import seal_mdao as sm
from seal_mdao.cli.force_table import force_lines
from seal_mdao.errors import SealFileError
from seal_mdao.seals.profiles import caption, profile_histories

TUBE = """
[material.rubber]
law = "neo_hookean"
c10 = 500.0
bulk_modulus = 500000.0
[section]
material = "rubber"
spacing = SPACING
outer = [
  { edge = "bottom", line = [[1.0, 0.0], [2.0, 0.0]] },
  { edge = "outside", arc = { start = [2.0, 0.0], through = [1.2, 1.6], end = [0.0, 2.0] } },
  { edge = "left", line = [[0.0, 2.0], [0.0, 1.0]] },
  { edge = "bore", arc = { start = [0.0, 1.0], through = [0.6, 0.8], end = [1.0, 0.0] } },
]
[[symmetry]]
edges = ["bottom"]
normal = "y"
[[moved]]
edges = ["left"]
directions = ["x"]
stage = [{ steps = 4 }]
[[fluid]]
edge = "bore"
pressure = 400.0
[[measure]]
type = "displacement"
at = [1.0, 0.0]
[[design]]
edges = ["outside"]
parameters = 4
bound = 0.1
"""
MOVED = 'type = "displacement"\nat = [1.0, 0.0]'
INFLATED = """
[material.rubber]
shore_a = 60
[section]
material = "rubber"
spacing = 0.8
layers = 5
outer = [
  { edge = "back", line = [[-6.0, 0.0], [6.0, 0.0]] },
  { edge = "face", line = [[6.0, 0.0], [6.0, 4.0]] },
  { edge = "face", arc = { start = [6.0, 4.0], through = [0.0, 5.5], end = [-6.0, 4.0] } },
  { edge = "face", line = [[-6.0, 4.0], [-6.0, 0.0]] },
]
hole = [
  { edge = "inside", line = [[-4.5, 1.5], [4.5, 1.5], [4.5, 2.5], [0.0, 3.5]] },
  { edge = "SECOND", line = [[0.0, 3.5], [-4.5, 2.5], [-4.5, 1.5]] },
]
[fixed]
edges = ["back"]
[[profile]]
name = "door"
friction = 0.2
contact = ["face"]
line = [[-15.0, 6.3], [15.0, 6.3]]
normal_penalty = 1e6
tangent_penalty = 3e4
stage = [{ steps = 6 }]
[[fluid]]
name = "gas"
edge = EDGE
pressure = 200.0
[[measure]]
type = "reaction"
"""


def read(tmp_path, text, **changed):
    path = tmp_path / "seal.toml"
    for name, value in changed.items():
        text = text.replace(name, value)
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def analyzed(file):
    result = sm.analyze(sm.build_seal(file))
    result.require_converged()
    return result


def bore_error(file) -> float:
    """Relative error of the pressure that widens the bore as far, for incompressible rubber."""
    bore = 1.0 + analyzed(file).value("displacement")[0]
    # mu = 2 C_10 = 1000 kPa
    return 1000.0 * inflation_pressure(bore) / 400.0 - 1.0


def test_an_inflated_tube_has_the_pressure_of_the_closed_form(tmp_path):
    """It converges with the square of the spacing, up to the compression p / K = 0.1 %."""
    errors = np.array([bore_error(read(tmp_path, TUBE, SPACING=h)) for h in ("0.2", "0.1")])
    assert (np.abs(errors) < [2e-2, 5e-3]).all(), errors
    assert abs(errors[1]) < 0.5 * abs(errors[0]), errors


def test_the_tube_is_pulled_apart_by_the_pressure_on_its_deformed_bore(tmp_path):
    result = analyzed(read(tmp_path, TUBE, SPACING="0.2"))
    force = result.path.reaction("left")[-1]
    bore = result.deformed()[result.seal.body.edge("bore").particles]
    # p a, with the radius a of the bore at the moved edge
    assert force[0] == pytest.approx(400.0 * bore[:, 1].max(), rel=1e-6)


def test_gradients_of_an_inflated_tube(tmp_path):
    result = analyzed(
        read(
            tmp_path,
            TUBE.replace('type = "displacement"\nat = [1.0, 0.0]', 'type = "strain_energy"'),
            SPACING="0.2",
        )
    )
    require_exact(result, ["strain_energy"], 1e-3)


@pytest.fixture(scope="module")
def inflated(tmp_path_factory):
    """The inflated seal whose hole is one edge."""
    folder = tmp_path_factory.mktemp("inflated")
    return analyzed(read(folder, INFLATED, SECOND="inside", EDGE='"inside"'))


def test_a_closed_edge_has_the_same_pressure_as_its_parts(tmp_path, inflated):
    parts = (
        INFLATED
        + """
[[fluid]]
name = "more"
edge = "second"
pressure = 200.0
"""
    )
    found = analyzed(read(tmp_path, parts, SECOND="second", EDGE='"inside"'))
    assert found.value("reaction")[0] > 100.0
    assert found.value("reaction") == pytest.approx(inflated.value("reaction"), rel=1e-9)


def test_contact_of_an_inflated_seal_is_at_averages(inflated):
    """Only a fluid that contact stops needs particles there."""
    (contact,) = (own for own in inflated.seal.terms() if own.label == "door")
    assert contact.where.edges.shape[1:] == (2, 2)


def test_forces_are_tabulated_over_the_pressure(inflated):
    (history,) = profile_histories(inflated)
    (course,) = history.load_segments
    assert course.axis == "pressure of gas (kPa)"
    assert course.along == pytest.approx(200.0 * np.arange(1, 7) / 6.0)
    head, *rows = force_lines(inflated)
    assert head == "door, stage 1: pressure of gas (kPa), horizontal and vertical force (N/m)"
    assert rows[-1].split()[0] == "200.000"
    assert caption(inflated, 2) == "at rest, gas 100 kPa"


def test_gradients_with_the_pressure(inflated):
    """Both methods, against quotients of analyses with other pressures."""
    exact, same = (
        sm.differentiate(inflated, ["gas_pressure"], method=m)["reaction"].item()
        for m in ("direct", "adjoint")
    )
    assert same == pytest.approx(exact, rel=1e-9)
    seal, step = inflated.seal, 0.02
    sides = [
        sm.analyze(seal.with_parameters({"gas_pressure": 200.0 + k * step})) for k in (-2, -1, 1, 2)
    ]
    values = [side.value("reaction")[0] for side in sides]
    quotient = np.array([1.0, -8.0, 8.0, -1.0]) @ values / (12.0 * step)
    assert quotient == pytest.approx(exact, rel=1e-5)


def test_no_blow_off_without_an_end(tmp_path):
    text = INFLATED + '[[measure]]\ntype = "blow_off_pressure"\n'
    with pytest.raises(SealFileError, match=r"no such \[\[fluid\]\] with the key from"):
        read(tmp_path, text, SECOND="inside", EDGE='"inside"')


def test_a_seal_at_rest_without_a_stage_is_told_how(tmp_path):
    with pytest.raises(
        SealFileError, match=r"without translate if only a fluid presses: stage = \[\{\}\]"
    ):
        read(
            tmp_path,
            INFLATED.replace("stage = [{ steps = 6 }]\n", ""),
            SECOND="inside",
            EDGE='"inside"',
        )


PRESSED = """\
[[moved]]
edges = ["base"]
directions = ["y"]
stage = [{{ translate = [0.0, 0.0], steps = 1 }}]
[[fluid]]
edge = {edges}
pressure = {pressure}
steps = 1
"""
HALF = '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'


@pytest.mark.parametrize(("table", "inner", "ratio"), [
    (HALF, 0.0, 30.0), (AROUND, 1.0, 20.0), (AROUND, 0.0, 10.0),
])  # fmt: skip
def test_a_body_under_a_uniform_pressure_is_stable(tmp_path, table, inner, ratio):
    """Equal stretches to rounding, and eigenvalues of the tangent above zero, at a pressure of ``ratio``
    shear moduli; least where the body contains the axis.

    The stiffness of the stress and that of the load cancel.
    """
    wet = ["right", "top", "left"] if inner else ["right", "top"]
    body = rubber("rubber") + section(inner, inner + HEIGHT, 0.35)
    pressed = PRESSED.format(edges=wet, pressure=ratio * SHEAR_MODULUS)
    path = tmp_path / "pressed.toml"
    path.write_text(table + body + pressed, encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    particles, deformed = result.seal.nominal_particles, result.deformed()
    stretch = deformed[:, 1].max() / HEIGHT
    assert 0.8 < stretch < 0.99
    np.testing.assert_allclose(deformed, stretch * particles, rtol=0.0, atol=1e-11)
    assert np.linalg.eigvals(inverse_tangent(result)).real.min() > 0.0
