"""The live section of a folder in headless Chromium."""

import os
import re
import subprocess
import sys
import time

import pytest
from headless_browser import browser as browser
from studio.small_seal import TEXT, write

READY = (
    "return Boolean(studio.rates && studio.exact.trustworthy !== undefined"
    " && studio.exact.design.every((v, i) => v === studio.design[i]))"
)
PATIENCE = 90.0
"""Seconds until a page is given up: kernels may have to be compiled."""


class Server:
    """``seal-mdao studio`` in a process of its own."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        self.process = subprocess.Popen(
            [sys.executable, "-m", "seal_mdao", "studio", *arguments, "--no-browser"],
            cwd=folder, stdout=subprocess.PIPE, text=True, env=dict(os.environ),
        )  # fmt: skip
        self.address = self.process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{32}/", self.address)

    def end(self):
        self.process.terminate()
        self.process.wait()
        self.process.stdout.close()


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """The coarse bulb, open."""
    folder = tmp_path_factory.mktemp("project")
    write(folder)
    found = Server(folder, "bulb.toml")
    yield found
    found.end()


@pytest.fixture
def folded(tmp_path):
    """The coarse bulb, pressed so far that its walls cross."""
    write(tmp_path, text=TEXT.replace("-1.7", "-5.0").replace("steps = 6", "steps = 12"))
    found = Server(tmp_path, "bulb.toml")
    yield found
    found.end()


@pytest.fixture
def empty(tmp_path):
    """A folder without a seal file."""
    found = Server(tmp_path)
    yield found
    found.end()


class Page:
    """A page of the live section in a window of the browser."""

    def __init__(self, browser, address):
        self.browser = browser
        browser.get(address)

    def run(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def wait(self, script, patience=PATIENCE):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            found = self.run(script)
            if found:
                return found
            time.sleep(0.05)
        text = self.run("return document.body.innerText")
        raise AssertionError(f"in vain: {script}\n{text[:2000]}")

    def ready(self):
        """Wait for the exact analysis of the design that is shown, and its first-order changes."""
        self.wait(READY)

    def click(self, name):
        self.browser.find_element("id", name).click()

    def saved(self, button):
        """Save by a button; return the names of the files."""
        self.run("document.getElementById('message').textContent = ''")
        self.click(button)
        text = self.wait(
            "const text = document.getElementById('message').textContent;"
            "return text.startsWith('Saved') && text"
        )
        return re.findall(r"[\w.]+\.(?:toml|dxf|vtu|html)", text.partition("Download")[0])

    def design(self):
        return self.run("return studio.design")

    def number(self, p, value):
        """Type a number."""
        self.run(
            "const input = document.getElementById(`number-${arguments[0]}`);"
            "input.value = arguments[1]; input.dispatchEvent(new Event('change'));", p, value,
        )  # fmt: skip


@pytest.fixture
def page(browser, server):
    """The page of the coarse bulb, with the design of the file, analysed."""
    # messages of pages of other tests, whose servers have ended
    browser.get("about:blank")
    browser.get_log("browser")
    found = Page(browser, server.address)
    found.server = server
    found.wait("return Boolean(studio.exact)")
    found.run("studio.kept.forEach(({name}) => send({do: 'drop', name}))")
    found.run("send({do: 'view', step: studio.scene.steps - 1})")
    found.run("change(studio.scene.numbers.map((own) => own.value), 'commit')")
    found.wait("return studio.scene.numbers.every((own, p) => own.value === studio.design[p])")
    found.wait("return studio.kept.length === 0 && studio.status.job === null")
    found.ready()
    yield found
    assert browser.get_log("browser") == []
    browser.get("about:blank")
