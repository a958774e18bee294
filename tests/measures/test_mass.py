"""Mass of a long seal of two rubbers, its gradient, and rubbers without a density."""

import numpy as np
import pytest
import shapely
from quotients import quotients
from studio.small_seal import TEXT
from two_rubbers import pressed_block

import seal_mdao as sm

FILE = """\
[material.soft]
shore_a = 40
density = 1100.0
[material.stiff]
shore_a = 60
density = 1300.0
"""
DESIGN = """
[[design]]
edges = ["top"]
parameters = 4
bound = 0.2
"""


def built(folder, old="", new="", measured='[[measure]]\ntype = "mass"\n'):
    path = folder / "block.toml"
    block = pressed_block(1.0, start=4.5, travel=-0.6)
    block = block.replace('contact = ["top"]', 'contact = ["top"]\ncontact_points = "particles"')
    path.write_text((FILE + block + DESIGN + measured).replace(old, new))
    return sm.build_seal(path)


def test_every_rubber_has_its_density(tmp_path):
    seal = built(tmp_path)
    offsets = np.array([0.1, -0.05, 0.0, 0.08])
    result = sm.analyze(seal, offsets, keep_factors=True)
    # g/m of 1e-3 (kg/m^3) mm^2; the design moves the line between both, too
    regions = result.term("structure").definition.regions
    soft, stiff = (
        shapely.area(shapely.polygons(result.particles[seal.body.cells[own.cells]])).sum()
        for own in regions
    )
    assert soft + stiff == pytest.approx(seal.area(offsets)[0], rel=1e-12)
    assert abs(stiff - 12.0) > 1e-3
    assert result.value("mass")[0] == pytest.approx(1.1 * soft + 1.3 * stiff, rel=1e-12)
    assert seal.units.of(result.measure("mass").units) == "g/m"
    direct, adjoint = (
        sm.differentiate(result, (), None, way).mass[0] for way in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=1e-12)
    for i, own in enumerate(direct):
        quotient, bound = quotients(seal, f"boundary_offsets[{i}]", 1e-5, start=offsets)["mass"]
        assert abs(quotient[0] - own) <= bound[0] + 1e-12 * abs(own)
        assert bound[0] <= 1e-6 * np.abs(direct).max()
    # a change of a constant leaves the density
    other = sm.analyze(seal, offsets, {"soft_shore_a": 50.0})
    assert other.value("mass")[0] == result.value("mass")[0]


def test_a_rubber_without_a_density_is_named_with_the_cure(tmp_path):
    words = (
        r"\[\[measure\]\] 1 \('mass'\): the material 'stiff' has no density; add density = 1200 "
        r"\(kg/m3\), or its own value, to \[material.stiff\]"
    )
    with pytest.raises(sm.SealFileError, match=words):
        built(tmp_path, "density = 1300.0\n")


def test_the_key_of_the_objective_is_named_where_it_lacks_a_density(tmp_path):
    words = r"block.toml: \[optimize\]: minimize = 'mass': the material 'stiff' has no density"
    with pytest.raises(sm.SealFileError, match=words):
        built(tmp_path, "density = 1300.0\n", measured='[optimize]\nminimize = "mass"\n')


def test_the_only_rubber_of_a_seal_is_not_given_another_name(tmp_path):
    one = TEXT.replace('"contact_width"', '"mass"')
    path = tmp_path / "bulb.toml"
    path.write_text(one)
    with pytest.raises(sm.SealFileError, match=r"the material has no density.*\[material\.NAME\]"):
        sm.build_seal(path)


def test_a_density_in_g_per_cm3_is_warned_about(tmp_path):
    seal = built(tmp_path, "density = 1300.0", "density = 1.3")
    assert any(
        "the material 'stiff' has a density of 1.3 kg/m3" in text and "1 g/cm3 is 1000" in text
        for text in seal.warnings
    )
    assert not any("density" in text for text in built(tmp_path).warnings)


def test_a_density_is_positive(tmp_path):
    with pytest.raises(sm.SealFileError, match=r"density = -1\.0, but it must be a number above 0"):
        built(tmp_path, "density = 1300.0", "density = -1.0")
