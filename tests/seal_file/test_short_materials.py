"""Materials by hardness or grade in a seal file: law, parameter, tolerance, messages, warning."""

from types import SimpleNamespace

import numpy as np
import pytest
from ring_files import cylinder, made_of

import seal_mdao as sm
from seal_mdao.materials.hardness import ShoreRubber, shore_modulus
from seal_mdao.materials.sponge import graded_sponge
from seal_mdao.seals.checks import _strains
from seal_mdao.tolerances.file import read_tolerances

pytest.importorskip("netgen")

FILE = """
[material.rubber]
{material}
[section]
material = "rubber"
spacing = 1.2
outer = [
  {{ edge = "base", line = [[0.0, 0.0], [8.0, 0.0]] }},
  {{ edge = "right", line = [[8.0, 0.0], [8.0, 4.0]] }},
  {{ edge = "top", line = [[8.0, 4.0], [0.0, 4.0]] }},
  {{ edge = "left", line = [[0.0, 4.0], [0.0, 0.0]] }},
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
normal_penalty = 1e5
tangent_penalty = 1e4
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 4.0]
stage = [{{ translate = [0.0, -{travel}], steps = 3 }}]
[[measure]]
type = "reaction"
"""


def read(folder, material, travel=0.4):
    path = folder / "block.toml"
    path.write_text(FILE.format(material=material, travel=travel), encoding="utf-8")
    return sm.read_seal_file(path)


def force(seal, **parameters):
    result = sm.analyze(seal, parameters=parameters)
    assert result.converged, result.failure
    return float(result.value(result.measures()[0])[0])


def test_a_hardness_is_a_parameter_with_an_exact_derivative(tmp_path):
    file = read(tmp_path, "shore_a = 60")
    assert file.materials["rubber"] == ShoreRubber(60.0, 1e6)
    seal = sm.build_seal(file)
    assert seal.scalars["shore_a"].value == 60.0
    result = sm.analyze(seal)
    (exact,) = np.ravel(
        sm.differentiate(result, ("shore_a",), result.measures(), "adjoint")["reaction"]
    )
    (direct,) = np.ravel(
        sm.differentiate(result, ("shore_a",), result.measures(), "direct")["reaction"]
    )
    assert direct == pytest.approx(exact, rel=1e-9)
    h = 0.01
    quotient = (force(seal, shore_a=60.0 + h) - force(seal, shore_a=60.0 - h)) / (2.0 * h)
    assert exact == pytest.approx(quotient, rel=1e-5)
    # as the law with the constants themselves
    c10 = shore_modulus(60.0) / 6.0
    same = read(tmp_path, f'law = "neo_hookean"\nc10 = {c10!r}\nbulk_modulus = 1e6')
    assert force(sm.build_seal(same)) == pytest.approx(force(seal), rel=1e-12)


def test_a_tolerance_of_the_hardness(tmp_path):
    seal = sm.build_seal(read(tmp_path, "shore_a = 60"))
    limits = tmp_path / "limits.toml"
    limits.write_text('[vary.shore_a]\ndistribution = "normal"\nmean = 60.0\nstd = 1.7\n')
    samples = read_tolerances(limits).samples(seal, 8)
    chosen = [samples.values(i, {"shore_a": 60.0}) for i in range(8)]
    assert chosen == [{"shore_a": float(number)} for number in samples.numbers[:, 0]]
    # harder is stiffer
    forces = [force(seal, **own) for own in sorted(chosen, key=lambda own: own["shore_a"])]
    assert np.all(np.diff(np.abs(forces)) > 0.0)


def test_a_sponge_by_its_grade(tmp_path):
    file = read(tmp_path, 'sponge = "2A3"')
    assert file.materials["rubber"] == graded_sponge("2A3")
    assert set(sm.build_seal(file).scalars) >= {"mu_1", "alpha_1", "nu_1"}


@pytest.mark.parametrize(("material", "words"), [
    ("shore_a = 12", "shore_a = 12, but it must be a number of at least 20 and at most 95 (Shore A)"),
    ('sponge = "2A9"', "sponge = '2A9', but it must be one of 2A1, 2A2, 2A3, 2A4, 2A5"),
    ('shore_a = 60\nlaw = "yeoh"', "unknown key 'law'; the keys are shore_a, density"),
    ("shore_a = 60\nbulk_modulus = 1.0", "bulk_modulus = 1 of ShoreRubber gives a Poisson's ratio"),
])  # fmt: skip
def test_wrong_materials_are_refused_in_one_line(tmp_path, material, words):
    with pytest.raises(sm.SealFileError) as caught:
        read(tmp_path, material)
    assert f"[material.rubber]: {words}" in str(caught.value)


def test_strains_beyond_the_range_of_the_constants_are_reported(tmp_path):
    """A block pressed to less than half of its height; not before."""
    for travel, beyond in ((0.8, False), (2.4, True)):
        result = sm.analyze(sm.build_seal(read(tmp_path, 'sponge = "2A3"', travel)))
        assert result.converged, result.failure
        told = [text for text in result.warnings if "beyond the range of its constants" in text]
        assert bool(told) == beyond
    assert "of the cells of the material are strained" in told[0]
    assert "(stretches 0.5 to 1.5)" in told[0]
    # laws with constants of one's own have no range
    law = 'law = "hyperfoam"\nmu = [130.0]\nalpha = [2.0]\nnu = [0.0]'
    result = sm.analyze(sm.build_seal(read(tmp_path, law, 2.4)))
    assert not [text for text in result.warnings if "range" in text]


def test_the_strain_that_is_reported_is_the_one_beyond_the_range():
    """Not the largest one, which may be within it: 0.51 is, 1.6 is not."""
    cells = np.arange(12).reshape(3, 4)
    region = SimpleNamespace(material=graded_sponge("2A3"), cells=None, name="")
    path = SimpleNamespace(discretization=SimpleNamespace(body=SimpleNamespace(cells=cells)))
    samples = SimpleNamespace(
        path=path,
        material_regions=[region],
        cell_stretches=np.array([[0.51, 0.9], [0.9, 1.6], [1.0, 1.0]]),
        undeformed=np.ones((12, 2)),
        growth=lambda _: 1.0,
    )
    (found,) = _strains(samples)
    assert "0.9 to 1.6 near" in found.text


def test_swelling_is_no_strain(tmp_path):
    """A swollen cylinder between plates has the elastic stretches 1 and 1 / theta = 0.63."""
    path = tmp_path / "swollen.toml"
    path.write_text(made_of('sponge = "2A3"\nswelling = 4.0\n', cylinder(travel=0.01)))
    result = sm.analyze(sm.build_seal(path))
    assert result.converged, result.failure
    radius = result.deformed()[:, 0].max() / result.particles[:, 0].max()
    assert radius == pytest.approx(np.cbrt(4.0), rel=1e-3)
    assert not [text for text in result.warnings if "beyond the range of its constants" in text]
