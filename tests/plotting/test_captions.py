"""Small print below figures: seal, materials and date."""

from typing import NamedTuple

import matplotlib.image
import numpy as np
import pytest

from seal_mdao import plotting
from seal_mdao.materials.hardness import ShoreRubber
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.sponge import graded_sponge
from seal_mdao.plotting.captions import (
    caption,
    captioned,
    materials_text,
    name_seal,
    name_varied,
    seal_text,
)
from seal_mdao.plotting.style import add_caption, subplots
from seal_mdao.report.embedded_figure import embedded


@pytest.fixture(autouse=True)
def _day(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")


class Described(NamedTuple):
    """What a caption takes of a seal."""

    materials: dict
    at_the_end: dict

    def conditions(self):
        return self.at_the_end


def small_print(figure):
    return [own.get_text() for own in figure.texts if own.get_gid() == "caption"]


def test_a_caption_has_name_materials_and_date():
    with captioned({"lip": "rubber (Yeoh)"}):
        name_seal("bulb", Described({"foot": MooneyRivlin()}, {}))
        assert caption() == "lip: rubber (Yeoh); bulb: foot (Mooney-Rivlin) | 2023-11-14"
        short = caption(30)
        assert len(short) == 30
        assert short.endswith("… | 2023-11-14")
    assert caption() == ""


def test_rubbers_by_hardness_and_sponges_by_grade_are_named_as_users_do():
    laws = {"lip": ShoreRubber(70.0), "bulb": graded_sponge("2A2")}
    assert materials_text(laws) == "lip (70 Shore A), bulb (foam of ASTM D1056)"


def test_environment_and_varied_parameters_are_named():
    given = {"axial_stretch": 1.05, "temperature_degC": -20.0, "foot_swelling": 1.1}
    with captioned():
        name_seal("bulb", Described({"foot": MooneyRivlin()}, given))
        named = "bulb: foot (Mooney-Rivlin), axial stretch 1.05, -20 °C, foot swelling 1.1"
        name_varied([])
        assert caption() == f"{named} | 2023-11-14"
        name_varied(["temperature", "c10"])
        without = named.replace(" -20 °C,", "")
        assert caption() == f"{without}, varied: temperature, c10 | 2023-11-14"


@pytest.mark.parametrize(
    ("varied", "left"),
    [
        (["friction"], "foot (60 Shore A), lip (70 Shore A), 40 °C, after 10 s, foot swelling 1.1"),
        (
            ["foot_shore_a"],
            "foot (Shore A), lip (70 Shore A), 40 °C, after 10 s, foot swelling 1.1",
        ),
        (
            ["material.lip.shore_a", "model.temperature"],
            "foot (60 Shore A), lip (Shore A), after 10 s, foot swelling 1.1",
        ),
        (
            ["duration_2", "material.foot.swelling"],
            "foot (60 Shore A), lip (70 Shore A), 40 °C",
        ),
        (
            ["profile.door.stage.2.duration", "temperature_2", "material.lip.swelling"],
            "foot (60 Shore A), lip (70 Shore A), foot swelling 1.1",
        ),
    ],
)
def test_nominal_values_of_varied_quantities_are_left_out(varied, left):
    laws = {"foot": ShoreRubber(60.0), "lip": ShoreRubber(70.0)}
    given = {"temperature_degC": 40.0, "time_s": 10.0, "foot_swelling": 1.1}
    with captioned():
        name_seal("bulb", Described(laws, given))
        name_varied(varied)
        assert caption() == f"bulb: {left}, varied: {', '.join(varied)} | 2023-11-14"
    laws = {"rubber": ShoreRubber(60.0)}
    for name in ("shore_a", "material.rubber.shore_a"):
        assert seal_text(Described(laws, {}), [name]) == f"rubber (Shore A), varied: {name}"


def test_stored_values_have_their_own_date():
    with captioned({"lip": "rubber (Yeoh)"}, "2022-02-28"):
        with captioned({"bulb": "rubber"}):
            assert caption() == "bulb: rubber | 2023-11-14"
        assert caption() == "lip: rubber (Yeoh) | 2022-02-28"


def test_without_a_seal_there_is_no_caption(nominal, tmp_path):
    name_seal("bulb", Described({}, {}))
    figure = plotting.load_deflection(nominal)
    with captioned():
        plotting.save(figure, tmp_path / "load.png", dpi=40)
    assert small_print(figure) == []


def test_saved_and_embedded_figures_have_one_caption(nominal, tmp_path):
    figure = plotting.load_deflection(nominal)
    with captioned({"cost $5": "rubber"}):
        plotting.save(figure, tmp_path / "load.png", dpi=40)
        embedded(figure, "load")
    assert small_print(figure) == ["cost $5: rubber | 2023-11-14"]


@pytest.mark.parametrize("draw", [plotting.load_deflection, plotting.deformed_shapes])
def test_axes_and_legends_stay_above_the_caption(nominal, draw):
    figure = draw(nominal)
    with captioned({"door seal": "rubber"}):
        add_caption(figure)
    figure.canvas.draw()
    own = next(text for text in figure.texts if text.get_gid() == "caption")
    lowest = min(axes.get_tightbbox().y0 for axes in figure.axes)
    legends = [legend.get_window_extent() for legend in figure.legends]
    assert own.get_window_extent().y1 <= min([lowest, *(box.y0 for box in legends)])
    assert all(box.y1 <= lowest + 1.0 for box in legends)


@pytest.mark.parametrize("width", [2.0, 4.1])
def test_a_long_caption_is_shortened_rather_than_cropped(width):
    figure, _ = subplots(width=width, height=3.0)
    with captioned({"WWWWWWWW MMMMMMMM": "WWWW (MMMM-WWWWWW), " * 20}):
        add_caption(figure)
    (text,) = (own for own in figure.texts if own.get_gid() == "caption")
    assert text.get_window_extent().x0 >= 0.0
    assert text.get_text().startswith("WWWW")
    assert "… | " in text.get_text()


def test_legends_above_the_axes_stay_there():
    figure, axes = subplots(width=4.0, height=3.0)
    axes.plot([0.0, 1.0], label="force")
    legend = figure.legend(loc="outside upper center")
    with captioned({"door seal": "rubber"}):
        add_caption(figure)
    figure.canvas.draw()
    assert legend.get_window_extent().y0 >= axes.get_tightbbox().y1 - 1.0


def test_the_same_inputs_give_the_same_bits(nominal, tmp_path):
    for name in ("first", "second"):
        with captioned({"door seal": "rubber"}):
            plotting.save(plotting.load_deflection(nominal), tmp_path / f"{name}.png", dpi=40)
    first, second = (tmp_path / f"{name}.png" for name in ("first", "second"))
    assert first.read_bytes() == second.read_bytes()
    np.testing.assert_array_equal(*map(matplotlib.image.imread, (first, second)))
