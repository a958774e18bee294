"""From an empty folder and a drawing to a saved, feasible optimum, on the page alone."""

import pytest
from studio.conftest import Page
from studio.small_seal import write

import seal_mdao as sm
from seal_mdao.seals.file.from_drawing import from_drawing
from seal_mdao.seals.outline.dxf import write_dxf

DROP = """
const [name, text] = arguments, data = new DataTransfer();
data.items.add(new File([text], name));
document.body.dispatchEvent(new DragEvent("drop", {dataTransfer: data, bubbles: true}));
"""


@pytest.fixture
def drawing(tmp_path):
    """The section of the coarse bulb as a drawing."""
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    file = sm.read_seal_file(write(folder))
    write_dxf(file.section.outline, folder / "strip.dxf")
    return (folder / "strip.dxf").read_text()


@pytest.mark.release
def test_drawing_to_optimum(browser, empty, drawing):
    page = Page(browser, empty.address)
    page.wait("return !document.getElementById('empty').hidden")
    page.run(DROP, "strip.dxf", drawing)
    page.ready()
    assert page.run("return studio.scene.handles.length") == 0
    # the form: the inside may move; the least area with a force of at least 90 % of the present one
    force = page.run("return studio.exact.curves[0].force.at(-1)[1]")
    page.click("problem")
    for group, name in (("moving", "inside"),):
        box = f"[data-group='{group}'][value='{name}']"
        page.browser.find_element("css selector", box).click()
    page.run("document.getElementById('aim').value = 'section_area'")
    page.click("add-limit")
    page.run("document.querySelector('#limits .lower').value = arguments[0]", round(0.9 * force))
    page.browser.find_element("css selector", "#problem-panel [type=submit]").click()
    page.wait("return studio.status.file === 'strip_problem.toml' && studio.scene !== null")
    page.ready()
    area = page.run("return studio.exact.measures.section_area[0]")
    page.click("improve")
    # ten minutes are what the complete way may take
    page.wait("return studio.exact.number >= 2 && studio.status.job === null", 600.0)
    page.ready()
    assert "violated" not in page.run("return document.getElementById('lights').innerText")
    assert page.run("return studio.exact.measures.section_area[0]") < area
    (name, *_) = page.saved("save")
    result = sm.analyze(sm.build_seal(empty.folder / name))
    assert result.reaction[-1, 1] >= round(0.9 * force) * (1.0 - 1e-6)
    assert result.section_area < area
    assert browser.get_log("browser") == []


def test_drawing_that_is_no_section_is_refused(browser, empty):
    page = Page(browser, empty.address)
    page.wait("return !document.getElementById('empty').hidden")
    page.run(DROP, "strip.dxf", "nothing")
    page.wait("return document.getElementById('message').textContent.startsWith('strip.dxf')")
    page.run(DROP, "strip.toml", "nothing")
    page.wait(
        "return document.getElementById('message').textContent.includes('with the ending .dxf')"
    )
    assert list(empty.folder.iterdir()) == []
    browser.get_log("browser")


def test_another_drawing_of_the_same_name_replaces_none(tmp_path):
    from seal_mdao.studio.problem_form import write_drawing
    from seal_mdao.studio.project import Project

    folder = tmp_path / "elsewhere"
    folder.mkdir()
    file = sm.read_seal_file(write(folder))
    write_dxf(file.section.outline, folder / "strip.dxf")
    content = (folder / "strip.dxf").read_bytes()
    project = Project(tmp_path)
    (tmp_path / "strip.dxf").write_text("another")
    (tmp_path / "strip.toml").write_text("mine")
    assert write_drawing(project, "strip.dxf", content) == ("strip_2.toml", "")
    assert (tmp_path / "strip.dxf").read_text() == "another"
    assert (tmp_path / "strip.toml").read_text() == "mine"
    assert (tmp_path / "strip_2.dxf").read_bytes() == content
    text = from_drawing("strip_2", tmp_path / "strip_2.dxf", tmp_path)
    assert (tmp_path / "strip_2.toml").read_text() == text
