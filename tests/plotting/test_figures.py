"""What is drawn is what was computed."""

import sys
from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
import shapely
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.analysis.path_result import Status
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting import style
from seal_mdao.recording.recorded_optimization import Constraint, RecordedOptimization
from seal_mdao.seals.profiles import arc_length, contacts


def lines(axes):
    return [np.column_stack(line.get_data()) for line in axes.get_lines()]


def drawn_somewhere(axes, points):
    """Whether one line of the axes goes through exactly these points."""
    return any(line.shape == points.shape and np.allclose(line, points) for line in lines(axes))


@pytest.mark.parametrize("name", plotting.__all__)
def test_a_figure_is_a_function_at_every_use(name):
    """A module of the same name would take its place once it is imported."""
    for _ in range(2):
        assert callable(getattr(plotting, name))


def test_no_window_system_is_touched(nominal, tmp_path):
    path = plotting.save(
        plotting.load_deflection(nominal), tmp_path / "new" / "reaction.png", dpi=50
    )
    assert matplotlib.image.imread(path).std() > 0.01
    pyplot = sys.modules.get("matplotlib.pyplot")
    assert pyplot is None or pyplot.get_fignums() == []


def test_a_figure_is_drawn_once(nominal, tmp_path, monkeypatch):
    """``savefig`` draws those with a layout engine twice."""
    drawn, real = [], Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda *given: (drawn.append(1), real(*given)))
    plotting.save(plotting.load_deflection(nominal), tmp_path / "reaction.png", dpi=50)
    assert drawn == [1]


def test_figures_of_a_path_that_stopped_say_where(nominal):
    done = len(nominal.path.steps) // 2
    part = replace(nominal.path, steps=nominal.path.steps[:done], status=Status.NOT_CONVERGED)
    stopped = replace(nominal, path=part)
    last = len(stopped.path.nominal_steps) - 1
    for figure in (plotting.deformed_shapes, plotting.load_deflection):
        title = figure(stopped).get_suptitle()
        assert title == f"path stopped at {nominal.caption(last)}"
        assert figure(nominal).get_suptitle() == ""


@pytest.mark.parametrize("tall", [8.0, 14.0, 30.0])
def test_titles_and_legend_of_panels_of_equal_aspect_are_clear_of_their_labels(tall):
    """After one run of the layout, whether width or height limits the size of the panels."""
    figure, panels = style.subplots(1, 3, width=9.9, height=5.85, sharex=True, sharey=True)
    for axes in panels:
        axes.plot([0.0, 1.0], [0.0, 1.0], "o", label="in contact")
        section.frame(axes, (-4.0, -1.0), (4.0, tall - 1.0))
        axes.set_title("stage 1")
    title = figure.suptitle("path stopped at stage 2")
    (handle,), (text,) = panels[0].get_legend_handles_labels()
    legend = figure.legend([handle], [text], loc="outside lower center")
    figure.canvas.draw()
    for axes in panels:
        assert axes.get_aspect() == 1.0
        shape = axes.get_window_extent()
        assert shape.height / shape.width == pytest.approx(tall / 8.0)
        assert not axes.title.get_window_extent().overlaps(title.get_window_extent())
        assert not axes.xaxis.label.get_window_extent().overlaps(legend.get_window_extent())
    before = [axes.get_position().bounds for axes in panels]
    figure.canvas.draw()
    np.testing.assert_allclose(before, [axes.get_position().bounds for axes in panels], atol=2e-3)


def test_deformed_shapes_share_one_scale_and_equal_aspect(nominal):
    figure = plotting.deformed_shapes(nominal, nominal.steps_at([5.0, 10.0]))
    panels = [axes for axes in figure.axes if axes.get_title()]
    assert [axes.get_title() for axes in panels] == ["travel 5 mm", "travel 10 mm"]
    contours = [
        child for axes in panels for child in axes.get_children() if isinstance(child, ContourSet)
    ]
    assert len(contours) == 2
    assert contours[0].get_clim() == contours[1].get_clim()
    assert contours[0].get_clim()[1] >= nominal.stress_field().max()
    for axes in panels:
        assert axes.get_aspect() == 1.0
        low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
        assert np.all(nominal.deformed() >= low)
        assert np.all(nominal.deformed() <= high)


def test_depths_are_taken_from_the_nearest_step(nominal):
    assert nominal.steps_at([9.96, 10.0, 10.04]) == [104]


def test_result_without_steps_cannot_be_drawn(nominal):
    from dataclasses import replace

    empty = replace(nominal, path=replace(nominal.path, steps=[]))
    with pytest.raises(ValueError, match="no converged load step"):
        plotting.deformed_shapes(empty)


def test_door_is_a_body_outside_the_seal(nominal):
    (door,) = contacts(nominal.seal)
    body = section.profile_body(nominal, door, nominal.seal.n_steps)
    inside = shapely.contains_xy(body.buffer(-5e-3), nominal.deformed())  # beyond the penetration
    assert not inside.any()
    assert shapely.contains_xy(body, 0.0, 9.5 - nominal.travel[-1] + 1.0)


def test_reaction_is_drawn_against_travel(nominal):
    axes = plotting.load_deflection(nominal).axes[0]
    for component in (0, 1):
        force = np.append(0.0, nominal.reaction[:, component])
        assert drawn_somewhere(axes, np.column_stack([np.append(-0.5, nominal.travel), force]))


def test_gap_profile_shows_the_open_points(nominal):
    axes = plotting.gap_profile(nominal, (5.0,)).axes[0]
    s = arc_length(nominal, "door")
    opened = np.column_stack([s, nominal.contact.gap])[list(nominal.measure("gap").points)]
    markers = [line for line in axes.get_lines() if line.get_label() == "open"]
    shown = np.column_stack(markers[0].get_data())
    assert all(np.any(np.all(np.isclose(shown, point), axis=1)) for point in opened)
    assert axes.get_ylim()[1] > nominal.gap.max()


def history():
    stress = np.array([[170.0, 150.0, 130.0, 136.1], [150.0, 119.0, 120.0, 121.0]])
    constraints = [
        Constraint("area", np.array([109.0, 108.0, 110.5, 110.0]), -np.inf, 110.0),
        Constraint("von_mises[0]", stress[0], -np.inf, 136.0),
        Constraint("von_mises[1]", stress[1], -np.inf, 121.0),
        Constraint("reaction", np.array([56.0, 49.0, 50.0, 52.0]), 50.4, 61.6),
    ]
    return RecordedOptimization(
        "gap_square_sum", np.array([0.05, 0.01, 4e-4, 0.0]), constraints, {}, True, 9, None
    )


def test_violation_is_relative_to_the_limit():
    recorded = history()
    assert recorded.max_violation == pytest.approx(
        [170 / 136 - 1, 150 / 136 - 1, 1 - 50 / 50.4, 136.1 / 136 - 1]
    )


def test_cost_history_is_logarithmic_and_survives_zero():
    axes = plotting.cost_history(history()).axes[0]
    assert axes.get_yscale() == "log"
    values = np.array([1.0, 0.2, 0.008, 1e-8])
    assert drawn_somewhere(axes, np.column_stack([np.arange(4), values]))


def test_use_of_limits():
    values = np.array([50.0, 110.0, 120.0])
    assert Constraint("c", values, -np.inf, 110.0).use() == pytest.approx(values / 110.0)
    assert Constraint("c", values, 100.0, np.inf).use() == pytest.approx([1.5, 0.9, 0.8])
    both = Constraint("c", values, 100.0, 110.0).use()
    assert both == pytest.approx([1.5, 1.0, 12.0 / 11.0])
    zero = Constraint("c", np.array([-0.5, 0.25]), -np.inf, 0.0).use()
    assert zero == pytest.approx([0.5, 1.25])
    assert np.array_equal(Constraint("c", values, -np.inf, np.inf).use(), [-np.inf] * 3)


def test_constraints_are_drawn_over_their_limits():
    recorded = history()
    axes = plotting.constraint_history(recorded, particles=[132, 45]).axes[0]
    texts = ("area of the section", "stress 1, particle 132", "stress 2, particle 45",
             "reaction")  # fmt: skip
    curves = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
    for text, constraint in zip(texts, recorded.constraints, strict=True):
        assert np.array_equal(curves[text], constraint.use())


@pytest.mark.parametrize(
    ("values", "lower", "upper", "said"),
    [
        ([56.0, 49.0, 52.0], 50.4, 61.6, [(1, "too soft: force below its limit")]),
        ([63.0, 49.0, 66.0], 50.4, 61.6, [(2, "too stiff: force above its limit")]),
        ([-63.0, -70.0, -40.0], -61.6, -50.4, [(2, "too soft: force below its limit")]),
        ([56.0, 50.39, 52.0], 50.4, 61.6, []),
    ],
)
def test_a_force_outside_its_limits_is_named(values, lower, upper, said):
    """At the last design outside; an excess below 0.1 % is none, nor is that of another measure."""
    area = Constraint("area", np.array([120.0, 120.0, 120.0]), -np.inf, 110.0)
    force = Constraint("reaction[1]", np.array(values), lower, upper)
    recorded = replace(history(), constraints=[area, force], units={"reaction": "N/m"})
    axes = plotting.constraint_history(recorded).axes[0]
    found = [(own.xy[0], own.get_text()) for own in axes.texts if hasattr(own, "xy")]
    assert found == said


def test_comparison_of_two_designs(nominal, random_design, tmp_path):
    figure = plotting.design_comparison(nominal, random_design)
    panels = [axes for axes in figure.axes if axes.get_title()]
    assert len(panels) == 3
    picture = matplotlib.image.imread(plotting.save(figure, tmp_path / "designs.png", dpi=60))
    assert picture.std() > 0.01


def test_error_map_and_step_study(tmp_path):
    errors = 10.0 ** np.random.default_rng(1).uniform(-12, -4, (6, 4))
    errors[2, 3] = np.nan
    names = [f"measure {i}" for i in range(6)]
    judged, one_sided = np.array([True, True, True, False]), np.array([False, True, False, False])
    figure = plotting.sensitivity_errors(errors, names, list("abcd"), judged, one_sided)
    shown = figure.axes[0].images[0].get_array()
    assert shown.shape == errors.shape
    assert np.ma.getmaskarray(shown)[2, 3]
    steps = np.logspace(-3, -7, 5)
    one = np.tile(steps**2, (3, 1))
    other = np.array([1e-13 / steps, np.full(5, np.nan)])
    other[0, 0] = np.nan
    study = plotting.step_study(steps, {"area": one, "stress": other})
    assert drawn_somewhere(study.axes[0], np.column_stack([steps, np.maximum(steps**2, 1e-12)]))
    assert drawn_somewhere(study.axes[0], np.column_stack([steps, 1e-13 / steps])[1:])
    for number, each in enumerate((figure, study)):
        picture = matplotlib.image.imread(plotting.save(each, tmp_path / f"{number}.png", dpi=60))
        assert picture.std() > 0.01


def test_number_that_rounds_to_zero_has_no_sign():
    assert [style.signed(value) for value in (-0.04, 0.0, -4.9, 12.0)] == [
        "0.0",
        "0.0",
        "−4.9",
        "12.0",
    ]


def test_rest_of_the_last_row_of_panels_is_hidden():
    figure, shown = style.panels(4, 3, lambda rows, columns: (2.0 * columns, 3.0 * rows))
    assert figure.get_size_inches().tolist() == [6.0, 6.0]
    assert [axes.get_visible() for axes in figure.axes] == [True] * 4 + [False] * 2
    assert shown == figure.axes[:4]


def test_stress_levels_are_round_and_cover_the_peak():
    for peak in (0.37, 42.0, 181.0, 1234.0):
        levels = section.stress_levels(peak)
        assert levels[0] == 0.0
        assert peak <= levels[-1] < 1.2 * peak
        assert 8 <= len(levels) <= section.LEVELS + 1


def test_flat_door_is_drawn_up_to_the_end_of_its_path():
    result = sm.analyze(sm.door_seal(door="flat", depth=2.0, n_steps=5))
    figure = plotting.deformed_shapes(result, result.steps_at([2.0]))
    assert figure.axes[0].get_title() == "travel 2 mm"
