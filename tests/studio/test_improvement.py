"""Improve: the optimisation of the file from a design of the page."""

import pytest
from studio.small_seal import nothing, write

from seal_mdao.studio.improvement import improve
from seal_mdao.studio.workbench import StoppedError, Workbench


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Workbench(write(tmp_path_factory.mktemp("bulb")), nothing, nothing)


def test_every_analysis_is_sent_and_the_end_is_better(bench):
    states, design = [], bench.start()
    design[0] = 0.1
    area = bench.analyze(design)["measures"]["section_area"][0]
    improve(bench, design, states.append)
    assert len(states) >= 4
    assert [own["number"] for own in states[:-1]] == list(range(1, len(states)))
    # the run begins at the design
    assert states[0]["design"] == pytest.approx(design, abs=1e-9)
    end = states[-1]
    assert end["success"]
    assert end["measures"]["reaction"][0] >= 300.0 * (1.0 - 1e-6)
    assert end["measures"]["section_area"][0] < 0.99 * area
    # what the page shows at the end is the analysis of its design
    again = bench.analyze(end["design"])
    assert again["measures"] == end["measures"]


def test_other_parameters_of_the_page_are_those_of_the_run(bench):
    design = bench.start()
    design[[own.name for own in bench.numbers].index("c10")] = 300.0
    states = []
    improve(bench, design, states.append)
    assert {own["design"][-2] for own in states} == {300.0}
    assert states[-1]["measures"]["reaction"][0] >= 300.0 * (1.0 - 1e-6)


def test_a_run_can_be_stopped(bench):
    states = []

    def watch():
        if len(states) == 2:
            raise StoppedError

    bench.watch = watch
    try:
        with pytest.raises(StoppedError):
            improve(bench, bench.start(), states.append)
    finally:
        bench.watch = nothing
    assert len(states) == 2
    # the seal works afterwards
    assert bench.analyze(bench.start())["converged"]
