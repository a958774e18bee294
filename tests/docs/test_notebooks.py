"""The notebooks run as they stand, and are stored without outputs."""

import json
from io import BytesIO

import matplotlib.pyplot as plt
import pytest
from matplotlib.image import imread

from seal_mdao.plotting.style import subplots

NAMES = ("first_seal", "multipoint", "calibration")


@pytest.fixture(params=NAMES)
def cells(request, docs):
    text = (docs / "notebooks" / f"{request.param}.ipynb").read_text(encoding="utf-8")
    return request.param, json.loads(text)["cells"]


def test_every_notebook_is_run(docs):
    assert {path.stem for path in (docs / "notebooks").glob("*.ipynb")} == {*NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_figures_are_values_of_cells(docs, name):
    """A cell that only assigns a figure shows nothing."""
    text = (docs / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8")
    sources = ["".join(cell["source"]) for cell in json.loads(text)["cells"]]
    assert not [own for own in sources if "= plotting." in own.splitlines()[-1]]


def test_a_figure_shows_itself():
    figure, axes = subplots(width=3.0, height=2.0)
    axes.plot([0.0, 1.0])
    assert imread(BytesIO(figure._repr_png_())).shape == (200, 300, 4)


def test_a_notebook_runs(cells, tmp_path, monkeypatch):
    """What each one claims is true of the values that it leaves."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_REPORTS", "0")
    name, own = cells
    names = {}
    for cell in own:
        if cell["cell_type"] == "code":
            assert not cell["outputs"]
            assert cell["execution_count"] is None
            exec(compile("".join(cell["source"]), name, "exec"), names)
    plt.close("all")
    if name == "first_seal":
        assert names["rates"].parameters[-1] == "friction"
        assert names["rates"].gap_square_sum[-1] < 0.0
    elif name == "multipoint":
        assert names["prob"].driver.result.success
        lowest = names["prob"].get_val("reaction_scenarios")[:, 1].min()
        assert lowest == pytest.approx(names["least"], rel=1e-3)  # the limit is active
        assert names["prob"].get_val("area")[0] < names["start"].area
    else:
        assert names["solution"].x[0] == pytest.approx(92.0, rel=1e-6)
