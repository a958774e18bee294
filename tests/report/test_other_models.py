"""Reports of models that users build around seals: the designs are those that the model used."""

import json
import re
from functools import partial

import numpy as np
import openmdao.api as om
import pytest
from openmdao.core.driver import Driver
from penalty_warnings import further_warnings

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.history_cases import case_lines, case_numbers
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.report.page import title
from seal_mdao.report.write import write_report

SEAL = sm.door_seal(depth=7.0, n_steps=21)


def bulge_shape():
    return np.r_[np.sin(np.linspace(0.0, np.pi, 14)), np.zeros(11)]


class Bulge(om.ExplicitComponent):
    """One length to all outer offsets, in metres."""

    def setup(self):
        self.add_input("bulge", 1e-4, units="m")
        self.add_output("offsets", shape=SEAL.n_offsets, units="m")
        self.shape = bulge_shape()
        self.declare_partials("offsets", "bulge", val=self.shape[:, None])

    def compute(self, inputs, outputs):
        outputs["offsets"] = inputs["bulge"] * self.shape


class MySeal(sm.SealGroup):
    """A subclass with its own parameters inside."""

    def setup(self):
        super().setup()
        self.add_subsystem("bulges", Bulge(), promotes_inputs=["bulge"])
        self.set_order(["bulges", "geometry", "section", "contact"])
        self.add_subsystem("cost", om.ExecComp("cost = 1e3 * gaps", gaps={"units": "mm**2"}))
        self.connect("gap_square_sum", "cost.gaps")


def upstream(group, limit=1.2, ref=None):
    """A length in metres before the seal, an inch for the door, and a cost behind it."""
    group.add_subsystem("bulges", Bulge(), promotes_inputs=["bulge"])
    group.add_subsystem("rubber", sm.SealGroup(seal=SEAL, parameters=("friction",)))
    group.connect("bulges.offsets", "rubber.boundary_offsets")
    group.add_subsystem("price", om.ExecComp("cost = 1e3 * gaps", gaps={"units": "mm**2"}))
    group.connect("rubber.gap_square_sum", "price.gaps")
    group.add_design_var("bulge", lower=-0.2, upper=0.2, units="mm")
    group.add_design_var("rubber.door_radius", lower=0.14, upper=0.18, units="inch")
    group.add_constraint("rubber.area", upper=limit, units="cm**2")
    group.add_objective("price.cost", ref=ref)


def ran(build, folder, recorder=sm.RestartRecorder, driver=None, values=()):
    """Recorder file of a problem, and the problem."""
    driver = driver or om.ScipyOptimizeDriver(maxiter=1, disp=False)
    problem = om.Problem(driver=driver, reports=None, work_dir=folder)
    build(problem.model)
    driver.add_recorder(recorder(folder / "cases.sql"))
    problem.setup()
    for name, value in values:
        problem.set_val(name, value)
    problem.run_driver()
    problem.cleanup()
    return folder / "cases.sql", problem


def shapes(path):
    """The page, and the pictures in it."""
    text = write_report(path).read_text(encoding="utf-8")
    return text, json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)[1])


def test_upstream_parameters_in_other_units(tmp_path):
    """Not one input of the seal is a design variable under its own name and unit."""
    path, problem = ran(upstream, tmp_path, values=[("rubber.friction", 0.3)])
    history = read_optimization(path)
    (seal,) = history.seals
    assert (seal.name, seal.assumed, seal.drawable) == ("rubber", (), True)
    last = len(history.objective) - 1
    offsets, parameters = seal.design(last)
    np.testing.assert_allclose(
        offsets, problem.get_val("rubber.boundary_offsets", units="mm"), rtol=1e-12
    )
    assert parameters["friction"] == 0.3
    assert parameters["door_radius"] == problem.get_val("rubber.door_radius", units="mm")[0]
    text, data = shapes(path)
    assert not further_warnings(text)
    radius = problem.get_val("rubber.door_radius", units="mm")[0]
    assert f"corner radius of the door</th><td>4</td><td>{radius:.4g}</td>" in text
    charts = {part["label"]: part for part in data["history"]["design"]}
    inch = charts["corner radius of the door"]
    # values, bounds and unit are those of the declaration
    assert (inch["unit"], inch["lower"], inch["upper"]) == ("inch", 0.14, 0.18)
    assert inch["values"][0][0] == pytest.approx(4.0 / 25.4, rel=1e-12)
    (area,) = (c for c in data["history"]["constraints"])
    assert area["unit"] == "cm²"
    assert area["use"][0] == pytest.approx(area["values"][0] / 1.2, rel=1e-12)
    assert area["values"][0] == pytest.approx(SEAL.area(0.1 * bulge_shape())[0] / 100, rel=1e-9)


def test_inputs_that_no_recorder_has_noted_are_said_to_be_unknown(tmp_path):
    """OpenMDAO's recorder leaves out what is no design variable: better no picture than a wrong one."""
    path, _ = ran(upstream, tmp_path, om.SqliteRecorder)
    text, data = shapes(path)
    assert data["shapes"] is None
    assert "The shapes of rubber are not shown: the file does not contain its inputs" in text
    advice = 'driver.recording_options["includes"] = ["*"]'
    with pytest.raises(ValueError, match=re.escape(advice)):
        read_optimization(path).design_at(0)
    # what the message advises is sufficient
    driver = om.ScipyOptimizeDriver(maxiter=1, disp=False)
    exec(advice)
    (tmp_path / "all").mkdir()
    path, problem = ran(upstream, tmp_path / "all", om.SqliteRecorder, driver)
    offsets, _ = read_optimization(path).design_at(-1)
    expected = problem.get_val("rubber.boundary_offsets", units="mm")
    np.testing.assert_allclose(offsets, expected, rtol=1e-12)


def test_promoted_design_variables_in_other_units_with_openmdaos_recorder(tmp_path):
    def build(model):
        model.add_subsystem(
            "seal", sm.SealGroup(seal=SEAL, parameters=("friction",)), promotes=["*"]
        )
        model.add_design_var("boundary_offsets", lower=-5e-4, upper=5e-4, units="m")
        model.add_design_var("door_radius", lower=0.14, upper=0.18, units="inch")
        model.add_objective("gap_square_sum", ref=0.1)

    path, problem = ran(build, tmp_path, om.SqliteRecorder)
    (seal,) = read_optimization(path).seals
    offsets, parameters = seal.design(len(seal.values) - 1)
    np.testing.assert_allclose(offsets, problem.get_val("boundary_offsets", units="mm"), rtol=1e-12)
    assert parameters == {"door_radius": problem.get_val("door_radius", units="mm")[0]}
    text, _ = shapes(path)
    assert "The file does not contain friction of seal" in text


def test_history_of_a_door_seal_without_its_radius(tmp_path, run_script):
    """OpenMDAO's recorder omits an input that is no design variable."""

    def build(model):
        model.add_subsystem("seal", sm.SealGroup(seal=SEAL), promotes=["*"])
        model.add_design_var("boundary_offsets", lower=-0.5, upper=0.5, units="mm")
        model.add_objective("gap_square_sum", ref=0.1)

    path, _ = ran(build, tmp_path, om.SqliteRecorder)
    code, summary = run_script("history", tmp_path / "out", path)
    assert (code, summary["door_radius"]) == (0, 4.0)


def two(model):
    for name in ("sharp", "blunt"):
        model.add_subsystem(name, sm.SealGroup(seal=SEAL), promotes_inputs=["boundary_offsets"])
    model.add_subsystem("sum", om.ExecComp("f = a + b", a={"units": "mm**2"}, b={"units": "mm**2"}))
    model.connect("sharp.gap_square_sum", "sum.a")
    model.connect("blunt.gap_square_sum", "sum.b")
    model.add_design_var("boundary_offsets", lower=-0.5, upper=0.5, units="mm")
    model.add_objective("sum.f", ref=0.1)


@pytest.fixture(scope="module")
def two_seals(tmp_path_factory):
    radii = [("sharp.door_radius", 3.5), ("blunt.door_radius", 4.5)]
    return ran(two, tmp_path_factory.mktemp("two"), values=radii)[0]


def test_every_seal_is_shown(two_seals):
    text, data = shapes(two_seals)
    assert data["seals"] == ["sharp", "blunt"]
    assert len(data["others"]) == 1
    doors = [part["paths"][0]["profiles"] for part in (data["shapes"], data["others"][0])]
    assert doors[0] != doors[1]
    for name, radius in (("sharp", "3.5"), ("blunt", "4.5")):
        table = text.partition(f"First and last design of {name}, from")[2].partition("</table>")[0]
        assert f"corner radius of the door</th><td>{radius}</td><td>{radius}</td>" in table
    assert not further_warnings(text)


def test_address_of_the_page_chooses_the_seal(two_seals, browser):
    from selenium.common.exceptions import StaleElementReferenceException
    from selenium.webdriver.support.wait import WebDriverWait

    page = write_report(two_seals, two_seals.with_name("two.html"))
    chosen, found = ("css selector", "nav.choice a[aria-current]"), []
    for name in ("sharp", "blunt"):
        browser.get("about:blank")
        browser.get(f"{page.as_uri()}#{name}")
        assert browser.find_element(*chosen).text == name
        found.append(browser.find_element("id", "start-text").text)
    assert found[0] != found[1]
    browser.find_element("link text", "sharp").click()
    WebDriverWait(browser, 60.0, ignored_exceptions=[StaleElementReferenceException]).until(
        lambda driver: driver.find_element(*chosen).text == "sharp"
    )
    assert browser.get_log("browser") == []


def test_doe_is_no_optimisation(tmp_path):
    """A failed case is counted, not drawn."""
    cases = [[("bulge", size)] for size in (0.1, 1.0, 0.05)]  # the second one reaches the door
    driver = om.DOEDriver(om.ListGenerator(cases))
    path, _ = ran(upstream, tmp_path, driver=driver)
    history = read_optimization(path)
    assert (history.kind, len(history.objective), history.failed) == ("doe", 2, 1)
    # the points are the first and the third design
    assert history.analyses.tolist() == [1, 3]
    text, _ = shapes(path)
    assert "<h1>Design of experiments with cost</h1>" in text
    assert "2 points with values, 1 failed." in text
    head = ("recorded quantity", "lowest", "highest", "limit", "satisfied by")
    assert "".join(f'<th scope="col">{own}</th>' for own in head) in text
    (area,) = history.constraints
    lowest, highest = np.sort(area.values)
    assert f"<td>{lowest:.4g}</td><td>{highest:.4g}</td><td>≤ 1.2</td><td>2 of 2</td>" in text
    assert "of its start" not in text.partition("<section")[0]
    # tables and pictures of its ends, too
    assert '<th scope="col">first point</th><th scope="col">last point</th>' in text
    assert '"ends":["first point","last point"]' in text
    assert '<th scope="col">start</th>' not in text


def bulges(folder, sizes, **settings):
    """Recorder file of a design of experiments with bulges of some sizes, mm."""
    driver = om.DOEDriver(om.ListGenerator([[("bulge", size)] for size in sizes]))
    return ran(partial(upstream, **settings), folder, driver=driver)[0]


def test_history_of_a_doe_gives_ranges_and_the_best_case(tmp_path, run_script, capsys):
    path = bulges(tmp_path, [0.1, 1.0, -0.1, 0.0])
    history = read_optimization(path)
    area = history.constraints[0].values
    code, summary = run_script("history", tmp_path / "out", path)
    assert (code, summary["cases"], summary["failed"], summary["feasible"]) == (0, 3, 1, 3)
    best = int(history.objective.argmin())
    case, value = [1, 3, 4][best], history.objective[best]
    assert (summary["best"]["case"], summary["best"]["objective"]) == (case, value)
    np.testing.assert_allclose(summary["boundary_offsets"], history.design_at(best)[0])
    said = capsys.readouterr().out
    assert "design of experiments: 3 cases with values, 1 failed" in said
    assert "->" not in said
    assert "bulge: -0.1 to 0.1 mm\n" in said
    assert f"area of the section: {area.min():.6g} to {area.max():.6g} cm², ≤ 1.2: " in said
    assert "satisfied by 3 of 3" in said
    lowest = (
        f"case {case} has the lowest cost of the 3 that satisfy all constraints: cost {value:.6g}"
    )
    assert lowest in said
    drawn = {own.stem for own in (tmp_path / "out").glob("*.png")}
    assert drawn == {"objective_cases", "constraint_cases", "best"}
    axes = plotting.objective_history(history).axes[0]
    assert [line.get_linestyle() for line in axes.lines] == ["None"]
    assert axes.lines[0].get_xdata().tolist() == [1, 3, 4]


def test_best_case_of_a_doe_satisfies_the_constraints(tmp_path):
    areas = np.sort([SEAL.area(size * bulge_shape())[0] / 100.0 for size in (-0.1, 0.0, 0.1)])
    # a larger cost is better
    sizes = [0.1, -0.1, 0.0]
    history = read_optimization(bulges(tmp_path, sizes, limit=areas[:2].mean(), ref=-1.0))
    assert history.maximized
    assert history.best == history.constraints[0].values.argmin()
    history = read_optimization(bulges(tmp_path, sizes, limit=0.9 * areas[0]))
    assert history.best == history.constraints[0].values.argmin()
    last = case_lines(history, case_numbers(history))[-1]
    assert last.startswith("no case satisfies all constraints; case 2 has the smallest violation")


def test_run_of_a_model_is_no_optimisation(tmp_path):
    path, _ = ran(upstream, tmp_path, driver=Driver())
    assert "<h1>Runs of a model with cost</h1>" in shapes(path)[0]


def test_optimisation_without_a_recorded_objective_is_refused_in_a_line(tmp_path):
    driver = om.ScipyOptimizeDriver(maxiter=1, disp=False)
    driver.recording_options["record_objectives"] = False
    path, _ = ran(upstream, tmp_path, driver=driver)
    with pytest.raises(ValueError, match="contains no objective"):
        write_report(path)


def without_objective(group, constrained=True):
    """Radii of the door in a design of experiments that minimises nothing."""
    group.add_subsystem("seal", sm.SealGroup(seal=SEAL), promotes=["*"])
    group.add_design_var("door_radius", lower=3.5, upper=4.5)
    if constrained:
        group.add_constraint("gap_square_sum", upper=1.0)
        group.add_constraint("area", lower=50.0)


def radii(folder, *found, **settings):
    driver = om.DOEDriver(om.ListGenerator([[("door_radius", radius)] for radius in found]))
    return ran(partial(without_objective, **settings), folder, driver=driver)[0]


def test_history_of_a_doe_without_an_objective(tmp_path, run_script, capsys):
    path = radii(tmp_path, 3.8, 4.1)
    gaps = read_optimization(path).constraints[0].values
    assert np.ptp(gaps) > 0.0
    code, summary = run_script("history", tmp_path / "out", path)
    assert (code, summary["cases"], summary["feasible_cases"]) == (0, 2, [1, 2])
    assert "best" not in summary
    said = capsys.readouterr().out
    limit = (
        f"sum of squared gaps: {gaps.min():.6g} to {gaps.max():.6g} mm², ≤ 1: satisfied by 2 of 2"
    )
    assert limit in said
    assert "corner radius of the door: 3.8 to 4.1 mm\n" in said
    assert "2 of 2 satisfy all constraints: cases 1, 2\n" in said
    assert {own.stem for own in (tmp_path / "out").glob("*.png")} == {"constraint_cases"}


def test_report_of_a_doe_without_an_objective(tmp_path, browser):
    path = radii(tmp_path, 3.8, 4.1)
    text, data = shapes(path)
    assert "<h1>Design of experiments</h1>" in text
    assert '<th scope="col">evaluation number</th><th scope="col">largest violation</th>' in text
    assert data["history"]["objective"] is None
    browser.get(path.with_name("report.html").as_uri())
    assert browser.execute_script("return document.documentElement.dataset.ready") == "true"
    assert not browser.find_element("id", "objective").is_displayed()
    assert browser.find_element("id", "constraints").is_displayed()
    assert browser.find_element("id", "iteration-value").text == "1 of 1: violation 0 %"
    assert browser.get_log("browser") == []


def test_doe_without_objective_and_constraints(tmp_path, run_script, capsys):
    path = radii(tmp_path, 4.1, constrained=False)
    assert "<h1>Design of experiments</h1>" in shapes(path)[0]
    code, summary = run_script("history", tmp_path / "out", path)
    assert (code, list(summary["ranges"])) == (0, ["door_radius"])
    assert "satisf" not in capsys.readouterr().out


def test_subclass_of_the_group(tmp_path):
    def build(model):
        model.add_subsystem("mine", MySeal(seal=SEAL))
        model.connect("mine.bulges.offsets", "mine.boundary_offsets")
        model.add_design_var("mine.bulge", lower=-2e-4, upper=2e-4, ref=1e-4)
        model.add_objective("mine.cost.cost")

    path, problem = ran(build, tmp_path)
    history = read_optimization(path)
    (seal,) = history.seals
    offsets, _ = seal.design(len(history.objective) - 1)
    np.testing.assert_array_equal(offsets, problem.get_val("mine.boundary_offsets", units="mm"))
    assert title(history) == "Optimisation of cost"
    assert not further_warnings(shapes(path)[0])


def test_design_whose_result_is_not_right_is_pointed_out(tmp_path):
    """Equilibrium is met, and the section lies in itself."""
    seal = sm.door_seal(depth=14.6, n_steps=150)

    def build(model):
        model.add_subsystem("deep", sm.SealGroup(seal=seal))
        model.add_design_var("deep.door_radius", lower=3.5, upper=4.5)
        model.add_objective("deep.gap_square_sum")

    with pytest.warns(sm.UntrustworthyResultWarning, match="the boundary crosses itself"):
        path, _ = ran(build, tmp_path, driver=Driver())
    warned = re.findall(r'<p class="warning">(.*?)</p>', shapes(path)[0])
    for design in ("First", "Last"):
        text = f"{design} design of deep: the boundary crosses itself"
        assert any(line.startswith(text) for line in warned)


@pytest.mark.parametrize("part", [False, True])
def test_designs_of_a_seal_on_which_no_response_depends(tmp_path, part):
    """OpenMDAO runs it once, at the end: its inputs have values of another design until then. Of an
    output of which it takes a part, the file does not tell which."""
    prob = om.Problem(driver=sm.UnoDriver(maxiter=2, disp=False), reports=None)
    count = SEAL.n_offsets + (5 if part else 0)
    taken = {"src_indices": np.arange(SEAL.n_offsets)} if part else {}
    prob.model.add_subsystem("x", om.IndepVarComp("offsets", np.zeros(count), units="mm"))
    for name in ("main", "other"):
        seal = sm.SealGroup(seal=SEAL, measures=("gap_square_sum",))
        prob.model.add_subsystem(name, seal)
        prob.model.connect("x.offsets", f"{name}.boundary_offsets", **taken)
    prob.model.add_design_var(
        "x.offsets", lower=-0.3, upper=0.3, units="mm", indices=np.arange(SEAL.n_offsets)
    )
    prob.model.add_objective("main.gap_square_sum", ref=0.1)
    prob.driver.add_recorder(sm.RestartRecorder(tmp_path / "cases.sql"))
    prob.driver.recording_options["includes"] = ["*"]
    prob.setup()
    prob.run_driver()
    prob.cleanup()
    main, other = read_optimization(tmp_path / "cases.sql").seals
    assert main.drawable
    assert np.abs(main.values[-1]["boundary_offsets"]).max() > 0.01
    assert other.drawable is not part
    for of_main, of_other in zip(main.values, other.values, strict=True):
        if part:
            assert not {"boundary_offsets", "particles"} & of_other.keys()
        else:
            assert np.array_equal(of_main["boundary_offsets"], of_other["boundary_offsets"])


@pytest.mark.parametrize("shape", [(5, 5), (1, 25)], ids=["taken in another order", "a row"])
def test_offsets_from_an_output_of_another_shape(tmp_path, shape):
    """Without src_indices OpenMDAO connects only shapes of the same order, such as rows and columns."""
    prob = om.Problem(driver=om.DOEDriver(om.ListGenerator([[("x.offsets", np.full(shape, 0.1))]])))
    prob.model.add_subsystem("x", om.IndepVarComp("offsets", np.zeros(shape), units="cm"))
    prob.model.add_subsystem("seal", sm.SealGroup(seal=SEAL, measures=("gap_square_sum",)))
    taken = {"src_indices": np.arange(25)[::-1], "flat_src_indices": True} if shape[0] > 1 else {}
    prob.model.connect("x.offsets", "seal.boundary_offsets", **taken)
    prob.model.add_design_var("x.offsets", units="mm")
    prob.model.add_objective("seal.gap_square_sum")
    prob.driver.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    prob.setup()
    prob.run_driver()
    prob.cleanup()
    history = read_optimization(tmp_path / "cases.sql")
    assert history.seals[0].drawable is not bool(taken)
    if taken:
        with pytest.raises(ValueError, match="does not contain the design parameters"):
            history.design_at(0)
    else:
        assert history.design_at(0)[0] == pytest.approx(np.full(25, 0.1))
    write_report(tmp_path / "cases.sql", tmp_path / "report")


def test_failed_designs_whose_objective_is_computed_downstream(tmp_path):
    """It has the value of the design before, and OpenMDAO's DOEDriver writes that all succeeded."""
    folds = np.concatenate([-np.ones(14), np.ones(11)])
    cases = [[("seal.boundary_offsets", size * folds)] for size in (0.0, 1.3, 0.1)]
    prob = om.Problem(driver=om.DOEDriver(om.ListGenerator(cases)), reports=None)
    seal = sm.SealGroup(seal=SEAL, measures=("gap_square_sum",))
    prob.model.add_subsystem("seal", seal)
    cost = om.ExecComp("cost = 2 * gaps", gaps={"units": "mm**2"})
    prob.model.add_subsystem("price", cost, promotes_outputs=["cost"])
    prob.model.connect("seal.gap_square_sum", "price.gaps")
    prob.model.add_design_var("seal.boundary_offsets")
    prob.model.add_objective("cost")
    prob.driver.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    prob.driver.recording_options["includes"] = ["*"]
    prob.setup()
    prob.run_driver()
    prob.cleanup()
    history = read_optimization(tmp_path / "cases.sql")
    assert history.failed == 1
    assert history.objective[0] != history.objective[1]
    assert len(history.objective) == 2


def test_outputs_that_are_constraints_as_well(tmp_path):
    """Objective and constraint on entries of one output, and design variables with constraints."""
    prob = om.Problem(
        driver=om.DOEDriver(om.ListGenerator([[("x", 3.0), ("z", 2.0)]])), reports=None
    )
    comp = om.ExecComp("y = x * w", x={"units": "m"}, y={"shape": 3, "units": "m"}, w=np.arange(3))
    prob.model.add_subsystem("product", comp, promotes=["*"])
    prob.model.add_subsystem("other", om.ExecComp("a = 2 * z"), promotes=["*"])
    prob.model.add_design_var("x", lower=-5.0, upper=900.0, units="cm")
    prob.model.add_design_var("z", lower=-4.0)
    prob.model.add_objective("y", index=1, units="mm")
    prob.model.add_constraint("y", indices=[0, 2], upper=0.02, units="km", alias="limited")
    prob.model.add_constraint("x", lower=10.0, units="mm", alias="least")
    prob.model.add_constraint("z", upper=1.5)
    prob.driver.add_recorder(om.SqliteRecorder(tmp_path / "cases.sql"))
    prob.setup()
    prob.run_driver()
    prob.cleanup()
    history = read_optimization(tmp_path / "cases.sql")
    # x = 3 cm
    assert history.objective_name == "y"
    assert history.objective == pytest.approx([30.0])
    assert {name: own.item() for name, own in history.design.items()} == {"x": 3.0, "z": 2.0}
    assert history.bounds["x"] == ([-5.0], [900.0])
    found = {own.name: (own.values.item(), own.lower, own.upper) for own in history.constraints}
    expected = {
        "limited[0]": (0.0, -np.inf, 0.02),
        "limited[1]": (6e-5, -np.inf, 0.02),
        "least": (30.0, 10.0, np.inf),
        "z": (2.0, -np.inf, 1.5),
    }
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        assert found[name] == pytest.approx(values)
