"""The live section in headless Chromium: a drag, the exact analysis, undo, comparison, saving."""

import math
import os
import signal
import time

import numpy as np
import psutil
import pytest
from relaxing_files import relaxing_block
from studio.conftest import Page, Server
from studio.small_seal import write

import seal_mdao as sm

STATE = "return document.getElementById('state').className"
FORCE = "return studio.exact.curves[0].force.at(-1)[1]"


def handle(page, number):
    return page.browser.find_elements("css selector", "#made-handles circle.handle")[number]


def drag(page, number, pixels, release=True):
    """Drag a handle towards its line by some pixels, one at a time."""
    from selenium.webdriver.common.action_chains import ActionChains

    chain = ActionChains(page.browser, duration=10).click_and_hold(handle(page, number))
    for _ in range(abs(pixels)):
        chain.move_by_offset(int(math.copysign(1, pixels)), 0)
    if release:
        chain.release()
    chain.perform()


def test_drag_shows_a_preview_and_then_the_exact_analysis(page):
    assert page.run(STATE) == "state exact"
    before, force = page.design(), page.run(FORCE)
    # the worker is stopped, so that the preview stays
    (worker,) = workers(page)
    worker.suspend()
    drag(page, 0, 6, release=False)
    page.wait("return document.getElementById('state').className === 'state preview'")
    assert "preview" in page.run("return document.getElementById('state-text').textContent")
    after = page.design()
    assert after[0] != before[0]
    assert after[1:] == before[1:]
    preview = page.run("return present().curves[0].force.at(-1)")
    assert preview != pytest.approx(force, rel=1e-4)
    from selenium.webdriver.common.action_chains import ActionChains

    ActionChains(page.browser).release().perform()
    worker.resume()
    page.ready()
    assert page.run(STATE) == "state exact"
    assert page.design() == after
    assert page.run(FORCE) == pytest.approx(preview, rel=0.02)


def test_finger_drags_a_handle_and_does_not_scroll(page):
    before = page.design()
    box = page.run(
        "const box = arguments[0].getBoundingClientRect();"
        "return [box.x + box.width / 2, box.y + box.height / 2]", handle(page, 0),
    )  # fmt: skip
    scrolled = page.run("return window.scrollY")

    def finger(kind, *points):
        given = [{"x": x, "y": y} for x, y in points]
        page.browser.execute_cdp_cmd(
            "Input.dispatchTouchEvent", {"type": kind, "touchPoints": given}
        )

    x, y = box
    # beside the drawn handle, but within the area for fingers
    finger("touchStart", (x + 12, y))
    for k in range(1, 7):
        finger("touchMove", (x + 12 + k, y + 3 * k))
    finger("touchEnd")
    page.ready()
    after = page.design()
    assert after[0] != before[0]
    assert after[1:] == before[1:]
    assert page.run("return window.scrollY") == scrolled
    page.wait("return !document.getElementById('undo').disabled")


def workers(page):
    """The worker process of the only server."""
    server = psutil.Process(int(page.server.process.pid))
    return [own for own in server.children() if "spawn_main" in " ".join(own.cmdline())]


def test_undo_redo_and_keyboard(page):
    before = page.design()
    handle(page, 1).send_keys("\ue014")  # arrow right
    page.ready()
    after = page.design()
    assert after != before
    page.wait("return !document.getElementById('undo').disabled")
    page.browser.find_element("tag name", "body").send_keys("\ue009z")  # Ctrl+Z
    page.wait(f"return studio.design[1] === {before[1]}")
    page.ready()
    page.click("redo")
    page.wait(f"return studio.design[1] === {after[1]}")
    page.ready()
    assert page.design() == after


def test_saved_file_repeats_the_page(page, server):
    page.number(0, 0.2)
    page.number(4, 0.5)
    page.ready()
    force = page.run(FORCE)
    name, *_ = page.saved("save")
    result = sm.analyze(sm.build_seal(server.folder / name))
    # Newton stops at residuals of 1e-9 of the forces
    assert result.reaction[-1, 1] == pytest.approx(force, rel=1e-8)


def test_compared_designs(page):
    page.click("keep")
    page.wait("return studio.kept.length === 1")
    page.number(4, 0.6)
    page.ready()
    page.click("keep")
    page.wait("return studio.kept.length === 2")
    # drawn with the next frame of the browser
    page.wait("return document.querySelectorAll('#curve path.line').length === 3")
    page.wait("return document.getElementById('compared').innerText.includes('friction on plate')")
    page.browser.find_element("css selector", "[data-take='A']").click()
    page.wait("return studio.design[4] === 0.3")
    page.browser.find_element("css selector", "[data-drop='B']").click()
    page.wait("return studio.kept.length === 1")


def test_compared_designs_without_measures_or_on_another_axis(page):
    page.click("keep")
    page.wait("return studio.kept.length === 1")
    page.wait("return document.querySelectorAll('#curve path.line').length === 2")
    # a path that was not completed, and a curve over load steps
    page.run(
        "const [own] = studio.kept, curves = own.curves.map((c) => ({...c, words: 'load step'}));"
        "studio.kept = [{...own, name: 'B', measures: {}, curves}, own]; showKept(); draw()"
    )
    text = page.run("return document.getElementById('compared').innerText")
    assert "reaction" in text
    assert "–" in text
    assert len(page.browser.find_elements("css selector", "#curve path.line")) == 2


def test_improve_is_drawn_and_taken_back(page):
    before = page.design()
    page.click("improve")
    page.wait("return studio.exact.number >= 2")
    page.wait("return studio.status.job === null")
    page.ready()
    page.wait("return document.getElementById('lights').innerText.includes('satisfied')")
    assert page.design() != before
    # how it ended, until the next analysis
    ended = page.run("return studio.exact.message")
    box = "document.getElementById('message')"
    assert ended in page.run(f"return {box}.innerText")
    assert page.run(f"return {box}.innerText").startswith("Optimisation ")
    page.click("undo")
    page.wait(f"return studio.design[0] === {before[0]}")
    page.ready()
    assert page.run(f"return {box}.hidden")


def test_error_bars_are_those_of_the_file(page):
    page.click("errors")
    page.wait("return Boolean(studio.errors)")
    found = page.run("return studio.errors")
    assert found["reaction"][0] > 0.0
    text = page.wait(
        "const text = document.getElementById('lights').innerText;return text.includes('±') && text"
    )
    assert "reaction" in text
    # the force at the end of the curve has its bar, plus and minus the same
    bar, force = page.wait(
        "const own = charts.curve.chart.spec.series.find((s) => s.name.includes('numerical error'));"
        "return own && [own.values, present().curves[0].force.at(-1)]"
    )
    half = found["force_on_plate"][1]
    assert bar == pytest.approx([force - half, force + half], rel=1e-9)


def test_a_change_is_not_lost_to_an_older_answer(page):
    # the undo is on its way while the page changes the design again
    page.number(0, 0.1)
    page.ready()
    page.run(
        "send({do: 'undo'}); const design = [...studio.design]; design[0] = 0.2;"
        "change(design, 'commit');"
    )
    page.wait("return studio.status.job === null")
    page.ready()
    assert page.design()[0] == 0.2
    # the answer to the undo, if it comes after the change
    page.run("receive.design({design: arguments[0], change: studio.change - 1})", [0.0] * 12)
    assert page.design()[0] == 0.2


def test_killed_worker_is_replaced(page):
    (worker,) = workers(page)
    os.kill(worker.pid, signal.SIGKILL)
    page.wait("return document.getElementById('message').textContent.includes('is restarted')")
    page.number(0, 0.1)
    page.ready()
    assert page.run(STATE) == "state exact"
    assert [own.pid for own in workers(page)] != [worker.pid]


def test_typed_number_outside_its_range_is_reported(page):
    own = page.run("return studio.scene.numbers[4]")
    slider = page.browser.find_element("id", "number-4")
    field = slider.find_element("xpath", "preceding-sibling::input")

    def type_number(text):
        # Ctrl+A, Delete, the text, Enter
        field.send_keys("\ue009a\ue000", "\ue017", text, "\ue007")

    def shown():
        return field.get_property("value"), slider.find_element("xpath", "..").text

    type_number("7.5")
    page.wait(f"return studio.design[4] === {own['high']}")
    value, text = shown()
    assert float(value) == own["high"]
    assert f"7.5 is outside the range of this page, {own['low']:g} to {own['high']:g}; " in text
    assert f"; {own['high']:g} is used" in text
    page.ready()
    assert "outside" in shown()[1]
    # no number: the value remains
    type_number("")
    assert shown()[0] == value
    type_number("0.5")
    page.wait("return studio.design[4] === 0.5")
    assert "outside" not in shown()[1]
    # another change of the number removes the message
    type_number("-1")
    page.wait(f"return studio.design[4] === {own['low']}")
    assert "outside" in shown()[1]
    page.number(4, 0.6)
    page.wait("return studio.design[4] === 0.6")
    page.wait("return !document.getElementById('sliders').innerText.includes('outside')")


def test_two_pages_show_one_design(page, server):
    first = page.browser.current_window_handle
    page.browser.switch_to.new_window("window")
    try:
        second = Page(page.browser, server.address)
        second.ready()
        second.number(0, 0.25)
        second.ready()
        page.browser.switch_to.window(first)
        page.wait("return studio.design[0] === 0.25")
        page.ready()
    finally:
        page.browser.switch_to.window(page.browser.window_handles[-1])
        page.browser.close()
        page.browser.switch_to.window(first)


def test_shared_page_needs_no_server(page, server):
    force = page.run("return document.getElementById('figures').innerText")
    (name,) = page.saved("share")
    shared = server.folder / name
    text = shared.read_text(encoding="utf-8")
    assert "src=" not in text.replace("\\u003c", "")
    page.browser.get(shared.as_uri())
    page.wait("return studio.drawn > 0")
    assert page.run("return document.getElementById('figures').innerText") == force
    assert page.run("return performance.getEntriesByType('resource').length") == 0
    assert page.browser.find_elements("css selector", ".handle") == []
    assert not page.browser.find_element("id", "save").is_displayed()


def test_warnings_of_an_analysis_and_a_result_that_cannot_be_used_are_shown(browser, folded):
    page = Page(browser, folded.address)
    page.ready()
    shown = "return document.getElementById('warnings').innerText"
    result = sm.analyze(sm.build_seal(folded.folder / "bulb.toml"))
    assert not result.trustworthy
    text = page.run(shown)
    assert "the boundary crosses itself" in text
    assert all(" ".join(own.split()) in " ".join(text.split()) for own in result.warnings)
    page.wait(f"{STATE} === 'state failed'")
    assert "not trustworthy" in page.run("return document.getElementById('state-text').textContent")
    # they are of the design, whatever load step is shown
    page.run("send({do: 'view', step: 3})")
    page.wait("return studio.exact.frame.step === 3")
    page.ready()
    assert page.run(shown) == text
    (name,) = page.saved("share")
    page.browser.get((folded.folder / name).as_uri())
    page.wait("return studio.drawn > 0")
    assert page.run(shown) == text
    assert page.run(STATE) == "state failed"


def test_values_at_several_stages_and_long_durations_are_shown(browser, tmp_path, request):
    text = relaxing_block().replace("duration = 20.0", "duration = 3.156e8")
    stages = '[[measure]]\ntype = "reaction"\nname = "both"\nstage = [1, 2]\n'
    write(tmp_path, text=text.replace("[[measure]]", stages + "[[measure]]", 1))
    server = Server(tmp_path, "bulb.toml")
    request.addfinalizer(server.end)
    page = Page(browser, server.address)
    page.ready()
    values = page.run("return studio.exact.measures.both")
    assert len(values) == 2
    texts = page.run("return present().measures.both.map((value) => readable(value, 4))")
    assert f"both {', '.join(texts)} N/m" in " ".join(
        page.run("return document.getElementById('figures').innerText").split()
    )
    # the duration fits into its field
    shown, wide, width = page.run(
        "const p = studio.scene.numbers.findIndex((own) => own.name === 'duration_2');"
        "const field = document.getElementById(`number-${p}`).previousElementSibling;"
        "return [field.value, field.scrollWidth, field.clientWidth]"
    )
    assert float(shown) == 3.156e8
    assert wide <= width


@pytest.mark.parametrize("width", [420, 900, 1400])
def test_no_page_scrolls_sideways(page, width):
    size = page.browser.get_window_size()
    page.browser.set_window_size(width, 900)
    try:
        time.sleep(0.3)
        overflow = page.run("return document.documentElement.scrollWidth - innerWidth")
        assert overflow <= 0
    finally:
        page.browser.set_window_size(size["width"], size["height"])


@pytest.mark.long
def test_a_hundred_random_actions(page, server):
    rng = np.random.default_rng(41)
    numbers = page.run("return studio.scene.numbers")
    (worker,) = workers(page)
    # compiled kernels and caches first
    memory = None
    for k in range(100):
        action = rng.choice(
            ["drag", "undo", "redo", "improve", "view"], p=[0.6, 0.15, 0.1, 0.05, 0.1]
        )
        if action == "drag":
            p = int(rng.integers(4))
            page.number(p, float(rng.uniform(numbers[p]["low"], numbers[p]["high"])))
        elif action == "improve":
            page.wait("return !document.getElementById('improve').hidden")
            page.click("improve")
            time.sleep(float(rng.uniform(0.0, 0.5)))
            page.run("send({do: 'stop'})")
        elif action == "view":
            page.run("send({do: 'view', step: arguments[0]})", int(rng.integers(6)))
        else:
            page.run("send({do: arguments[0]})", action)
        if k % 10 == 9:
            page.wait("return studio.status.job === null")
            page.ready()
        if k == 29:
            memory = worker.memory_info().rss
    page.wait("return studio.status.job === null")
    page.run("send({do: 'view', step: 5})")
    page.ready()
    assert page.run("return document.getElementById('message').hidden")
    # no leak: as much as one analysis needs
    assert worker.memory_info().rss - memory < 60 * 2**20
    design, force = page.design(), page.run("return studio.exact.curves[0].force")
    name, *_ = page.saved("save")
    result = sm.analyze(sm.build_seal(server.folder / name))
    largest = np.abs(result.reaction).max()
    assert np.abs(result.reaction - np.array(force)).max() <= 1e-8 * largest, design
