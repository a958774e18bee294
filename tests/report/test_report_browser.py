"""The report in headless Chromium: no console errors, and the sliders move the pictures."""

import re
import shutil
import sqlite3
import zlib
from contextlib import closing

import numpy as np
import openmdao.api as om
import pytest
from restart.valley import record, valley_problem

from seal_mdao.report.write import write_report

PIXELS = """
const canvas = document.getElementById(arguments[0]), copy = document.createElement("canvas");
[copy.width, copy.height] = [canvas.width, canvas.height];
const context = copy.getContext("2d", {willReadFrequently: true});
context.drawImage(canvas, 0, 0);
const {data} = context.getImageData(0, 0, copy.width, copy.height);
const colours = new Set();
let hash = 0;
for (let i = 0; i < data.length; i += 4) {
  const value = (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
  if (data[i + 3]) colours.add(value);
  hash = (hash * 31 + value) | 0;
}
return [hash, colours.size, canvas.getAttribute("aria-label")];
"""
MOVE = """
const slider = document.getElementById(arguments[0]);
slider.value = arguments[1];
slider.dispatchEvent(new Event("input"));
"""


@pytest.fixture
def opened(browser, seal_page):
    """The seal's report, freshly loaded."""
    browser.get(seal_page.path.as_uri())
    yield browser
    assert browser.get_log("browser") == []


def picture(browser, name):
    """Fingerprint, number of colours, and description of a canvas."""
    return browser.execute_script(PIXELS, name)


def inner(browser, name):
    return browser.execute_script("return document.getElementById(arguments[0]).innerHTML", name)


def text_of(browser, name):
    return browser.find_element("id", name).text


def test_page_loads_without_a_word_in_the_console(opened):
    assert opened.execute_script("return document.documentElement.dataset.ready") == "true"
    assert opened.title == "Shape of a seal: report"
    assert "Not converged" in opened.find_element("class name", "status").text
    for name in ("start-shape", "end-shape", "design-shape"):
        _, colours, described = picture(opened, name)
        assert colours > 40  # stress, not a blank
        assert "von Mises" in described or "peak stress" in described
    for name in ("pressure", "gap", "reaction", "objective", "constraints"):
        assert inner(opened, name).count("<path") >= 2
    assert len(opened.find_elements("css selector", "#design svg")) >= 3


def test_nothing_is_loaded_from_elsewhere(opened, seal_page):
    loaded = opened.execute_script(
        "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    )
    assert loaded == []
    assert re.findall(r"(?:src|href)=", seal_page.text) == []
    assert not re.search(r"@import|url\(", seal_page.text.replace("url(#", ""))


def test_slider_moves_the_load_step(opened, seal_page):
    start, end = seal_page.data["shapes"]["paths"]
    seen = {}
    for step in (20, 10, 2):
        opened.execute_script(MOVE, "step", step)
        pictures = [picture(opened, name) for name in ("start-shape", "end-shape")]
        seen[step] = [p[0] for p in pictures]
        for path, (_, _, described), name in zip(
            (start, end), pictures, ("start", "end"), strict=True
        ):
            assert f"{path['frames'][step]['peak']:.3g} kPa" in described
            touching = sum(state in "12" for state in path["curves"][0]["state"][step])
            assert f"{touching} points in contact" in text_of(opened, f"{name}-text")
        assert start["captions"][step] == text_of(opened, "step-value").replace("−", "-")
    assert len({h for pair in seen.values() for h in pair}) == 6
    charts = [inner(opened, name) for name in ("pressure", "gap", "reaction")]
    opened.execute_script(MOVE, "step", 20)
    assert all(
        inner(opened, name) != before
        for name, before in zip(("pressure", "gap", "reaction"), charts, strict=True)
    )
    assert [picture(opened, name)[0] for name in ("start-shape", "end-shape")] == seen[20]


def test_slider_moves_the_iteration(opened, seal_page):
    count = len(seal_page.data["history"]["objective"]["values"])
    seen = []
    for iteration in range(count):
        opened.execute_script(MOVE, "iteration", iteration)
        seen.append(tuple(picture(opened, name)[0] for name in ("design-drawn", "design-shape")))
        assert text_of(opened, "iteration-value").startswith(f"{iteration} of {count - 1}")
        assert f"iteration {iteration}:" in picture(opened, "design-shape")[2]
    assert len({nominal for nominal, _ in seen}) == len({shape for _, shape in seen}) == count
    cursors = opened.find_elements("css selector", "#objective .cursor, #constraints .cursor")
    assert len(cursors) == 2


def test_play_runs_to_the_end_and_can_be_stopped(opened):
    opened.execute_script(MOVE, "step", 0)
    first = picture(opened, "start-shape")[0]
    # pressed again from inside the page: a test on a busy machine would be too late
    began, at, pressed = opened.execute_async_script("""
        const done = arguments[0], button = document.getElementById("step-play");
        const slider = document.getElementById("step");
        button.click();
        const began = button.textContent;
        const watch = setInterval(() => {
          if (Number(slider.value) < 3) return;
          clearInterval(watch);
          button.click();
          done([began, Number(slider.value), button.getAttribute("aria-pressed")]);
        }, 1);
    """)
    assert began == "Pause"
    assert 3 <= at < 20
    assert pressed == "false"
    assert picture(opened, "start-shape")[0] != first
    opened.find_element("id", "step-play").click()
    wait_for(opened, "return document.getElementById('step').value === '20'")
    assert text_of(opened, "step-play") == "Play"


def wait_until(browser, condition):
    from selenium.webdriver.support.wait import WebDriverWait

    WebDriverWait(browser, 20).until(lambda _: condition())


def wait_for(browser, script):
    wait_until(browser, lambda: browser.execute_script(script))


def test_keyboard_moves_the_slider(opened):
    slider = opened.find_element("id", "iteration")
    before = text_of(opened, "iteration-value")
    slider.send_keys("\ue012")  # arrow left
    assert text_of(opened, "iteration-value") != before


def test_values_under_the_pointer(opened):
    from selenium.webdriver.common.action_chains import ActionChains

    chart = opened.find_element("css selector", "#constraints svg")
    opened.execute_script("arguments[0].scrollIntoView({block: 'center'})", chart)
    ActionChains(opened).move_to_element(chart).perform()
    tip = opened.find_element("css selector", "#constraints .tip")
    assert tip.is_displayed()
    assert "area of the section: " in tip.text
    assert "mm²" in tip.text


def test_dark_and_print(opened):
    light = picture(opened, "start-shape")[0]
    dark = {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    opened.execute_cdp_cmd("Emulation.setEmulatedMedia", dark)
    wait_until(opened, lambda: picture(opened, "start-shape")[0] != light)
    opened.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    pdf = opened.execute_cdp_cmd("Page.printToPDF", {})["data"]
    assert len(pdf) > 50_000


def test_narrow_screen_does_not_scroll_sideways(opened):
    size = opened.get_window_size()
    opened.set_window_size(520, 900)
    try:
        overflow = opened.execute_script(
            "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )
        assert overflow <= 0
    finally:
        opened.set_window_size(size["width"], size["height"])


def test_problem_that_is_no_seal(browser, other_page):
    browser.get(other_page.path.as_uri())
    assert browser.find_element("tag name", "h1").text == "Optimisation of f"
    assert not browser.find_element("id", "closing").is_displayed()
    browser.execute_script(MOVE, "iteration", 0)
    assert text_of(browser, "iteration-value").startswith("0 of")
    assert "</script><b>&" in browser.find_element("css selector", "table").text
    assert browser.get_log("browser") == []


@pytest.fixture
def markup_page(seal_page, tmp_path):
    """The seal's report with a name after which a browser takes all that follows for data."""
    cases = shutil.copy(seal_page.cases, tmp_path / "cases.sql")
    with closing(sqlite3.connect(cases)) as connection, connection:
        (packed,) = connection.execute("SELECT var_settings FROM metadata").fetchone()
        named = zlib.decompress(packed).replace(b'"area": {', b'"<!--<script>": {')
        connection.execute("UPDATE metadata SET var_settings=?", (zlib.compress(named),))
    return write_report(cases)


def test_markup_as_a_name_does_not_disable_the_page(browser, markup_page):
    browser.get(markup_page.as_uri())
    assert "\\u003c!--\\u003cscript>" in markup_page.read_text(encoding="utf-8")
    assert browser.execute_script("return document.documentElement.dataset.ready") == "true"
    assert "<!--<script>" in browser.find_element("tag name", "body").text
    assert browser.get_log("browser") == []


def test_no_mark_hides_a_violated_constraint(browser, tmp_path):
    """|x|^2 <= 2 at designs so close that their points overlap."""
    sizes = np.repeat([0.9, 0.5], 50)
    designs = om.ListGenerator([[("x", np.full(3, size))] for size in sizes])
    problem = record(valley_problem(om.DOEDriver(designs)), tmp_path / "cases.sql")
    problem.run_driver()
    problem.cleanup()
    browser.get(write_report(tmp_path / "cases.sql").as_uri())
    fills = (
        "return [...document.querySelectorAll(`#objective svg > g${arguments[0]} circle`)]"
        ".map((own) => own.style.fill)"
    )
    paper = ["var(--paper)"]
    # violated ones are drawn last
    shown = browser.execute_script(fills, "[clip-path]")
    assert shown == ["var(--c0)"] * 50 + paper * 50
    # the mark of the slider
    for number, expected in ((0, paper), (99, ["var(--c0)"])):
        browser.execute_script(MOVE, "iteration", number)
        assert browser.execute_script(fills, ":not([clip-path])") == expected
