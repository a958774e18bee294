"""Pressure of the air in cavities over travel: in the curves and below the forces in their figure."""

import csv

import numpy as np
import pytest
from seal_file.coarse_bulb import BULB, COARSE, changed

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.export.csv_tables import CURVE_HEADER, write_curves
from seal_mdao.seals.cavities import cavity_pressures

CHANGES = COARSE | {
    "[0.0, -6.0]": "[0.0, -2.4]", "steps = 60": "steps = 5", "[2.0, 0.0]": "[0.0, 0.6]",
}  # fmt: skip
VENTS = "vent_diameter = 1.0\nvent_spacing = 200.0\nclosing_speed = 500.0\n"


def analysed(tmp_path, cavity):
    text = changed(BULB.read_text(encoding="utf-8"), CHANGES)
    path = tmp_path / "bulb.toml"
    path.write_text(text.replace("[fixed]", f"{cavity}[fixed]", 1), encoding="utf-8")
    return sm.analyze(sm.build_seal(path))


@pytest.fixture(scope="module", params=["", VENTS])
def closed(request, tmp_path_factory):
    return analysed(tmp_path_factory.mktemp("bulb"), "[[cavity]]\nhole = 1\n" + request.param)


def test_pressure_of_every_step_is_that_of_the_path_up_to_it(closed):
    (pressure,) = cavity_pressures(closed).values()
    (air,) = cavity_pressures(closed)
    assert len(pressure) == 7
    assert pressure[4] > pressure[2] > 0.0
    # the last stage opens again
    assert pressure[4] > pressure[6]
    for part, own in zip(closed.up_to_each_step(), pressure, strict=True):
        assert part.response(air).outputs[0, 0] == own


def test_curves_have_a_column_for_every_cavity(closed, tmp_path):
    (path,) = write_curves(closed, tmp_path)
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == [*CURVE_HEADER, "air_excess_pressure_kPa"]
    (pressure,) = cavity_pressures(closed).values()
    assert [float(row[-1]) for row in rows] == pytest.approx(pressure, rel=1e-11)


def test_pressure_is_drawn_below_the_forces(closed):
    figure = plotting.load_deflection(closed)
    (panel,) = (own for own in figure.axes if "pressure of the air" in own.get_ylabel())
    (pressure,) = cavity_pressures(closed).values()
    lines = [line.get_ydata() for line in panel.get_lines()]
    assert any(np.array_equal(line, [0.0, *pressure]) for line in lines)
    # the forces are above it, and keep their legend
    assert figure.axes[0].get_legend() is not None
    assert "force on door" in figure.axes[0].get_ylabel()


def test_a_section_without_cavities_is_as_before(tmp_path):
    result = analysed(tmp_path, "")
    assert cavity_pressures(result) == {}
    (path,) = write_curves(result, tmp_path)
    assert path.read_text(encoding="utf-8").splitlines()[0] == ",".join(CURVE_HEADER)
    labels = [own.get_ylabel() for own in plotting.load_deflection(result).axes]
    assert not any("air" in label for label in labels)
