"""Reports of a few recorder files, and a browser to look at them."""

import json
import re

import numpy as np
import openmdao.api as om
import pytest
from headless_browser import browser as browser

import seal_mdao as sm
from seal_mdao.door_optimization import DoorProblem, door_task
from seal_mdao.optimization import OPTIMIZERS, RunOptions, optimization_problem
from seal_mdao.report.write import write_report


class Page:
    """A report and what is in it."""

    def __init__(self, path, cases):
        self.path, self.cases = path, cases
        self.text = path.read_text(encoding="utf-8")
        embedded = re.search(r'id="report-data">(.*?)</script>', self.text, re.DOTALL)
        self.data = json.loads(embedded[1])


@pytest.fixture(scope="session")
def seal_page(tmp_path_factory):
    """Report of three iterations of the seal problem with few load steps."""
    folder = tmp_path_factory.mktemp("seal")
    driver = next(iter(OPTIMIZERS.values()))(3)
    run = RunOptions(driver, folder / "cases.sql", work_dir=folder)
    task = door_task(run.analyze(sm.door_seal(n_steps=21)), DoorProblem(keep_force=True))
    problem = optimization_problem(task, run)
    problem.run_driver()
    problem.cleanup()
    return Page(write_report(folder / "cases.sql"), folder / "cases.sql")


@pytest.fixture(scope="session")
def other_page(tmp_path_factory):
    """Report of a problem that has nothing to do with seals, with a name that is markup."""
    folder = tmp_path_factory.mktemp("other")
    problem = om.Problem(driver=om.ScipyOptimizeDriver(disp=False), reports=None, work_dir=folder)
    expressions = ["f = sum((x - 1)**2) - 3", "g = x[0] + x[1]"]
    paraboloid = om.ExecComp(expressions, x=np.zeros(2), do_coloring=False)
    problem.model.add_subsystem("c", paraboloid, promotes=["*"])
    problem.model.add_design_var("x", lower=-5.0, upper=5.0)
    problem.model.add_objective("f")
    problem.model.add_constraint("g", upper=1.5, lower=0.0, alias="</script><b>&")
    problem.driver.add_recorder(sm.RestartRecorder(folder / "cases.sql"))
    problem.setup()
    problem.run_driver()
    problem.cleanup()
    return Page(write_report(folder / "cases.sql", folder / "new" / "page.html"), folder)
