"""Times of the live section in headless Chromium.

Prints the delay of first-order previews while five handles are dragged, from
the move of the pointer to the end of drawing; the times of the exact analysis after design parameters
were changed by 0.1 mm; and the largest difference of the force between preview and exact analysis. Run
it on an idle machine.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))
from studio.conftest import READY, Page, Server  # noqa: E402

MOVES, HANDLES, CHANGES = 60, 5, 12
STEP = 0.1
"""Change of a number, mm."""
IS_EXACT = "return studio.exact.design.every((v, i) => v === studio.design[i])"
FORCE = "return present().curves[0].force.at(-1)"


def drag(page: Page, number: int) -> list:
    """Drag a handle to and fro; return the delays of the previews, ms."""
    page.run("studio.latencies.length = 0")
    handle = page.browser.find_elements("css selector", "#made-handles circle.handle")[number]
    chain = ActionChains(page.browser, duration=16).click_and_hold(handle)
    for move in range(MOVES):
        chain.move_by_offset(1 if (move // 6) % 2 == 0 else -1, 0)
    chain.release().perform()
    delays = page.run("return studio.latencies")
    page.wait(READY)
    return delays


def change(page: Page, number: int, by: float) -> tuple[float, float]:
    """Change a number of the design of the file; return the seconds until the exact analysis, and the
    relative difference of the force of preview and exact analysis."""
    page.run("change(studio.scene.numbers.map((own) => own.value), 'commit')")
    page.wait(READY)
    begun = time.perf_counter()
    page.run(
        "const design = [...studio.design]; design[arguments[0]] += arguments[1];"
        "change(design, 'commit')", number, by,
    )  # fmt: skip
    preview = page.run(FORCE)
    while not page.run(IS_EXACT):
        time.sleep(0.005)
    seconds = time.perf_counter() - begun
    exact = page.run(FORCE)
    page.wait(READY)
    return seconds, abs(preview / exact - 1.0)


def main() -> None:
    made = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    example = TESTS.parent / "examples" / "d_bulb.toml"
    made.add_argument("file", nargs="?", type=Path, default=example, help="seal file")
    given = made.parse_args().file
    options = webdriver.ChromeOptions()
    for flag in ("--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000"):
        options.add_argument(flag)
    with tempfile.TemporaryDirectory() as folder, webdriver.Chrome(options=options) as browser:
        shutil.copy(given, folder)
        server = Server(Path(folder), given.name)
        try:
            page = Page(browser, server.address)
            page.wait(READY)
            numbers = page.run("return studio.scene.numbers.map((own) => own.name)")
            offsets = [i for i, own in enumerate(numbers) if own.startswith("boundary_offsets")]
            handles = np.linspace(0, len(offsets) - 1, HANDLES).astype(int)
            delays = np.concatenate([drag(page, int(handle)) for handle in handles])
            low, high = np.quantile(delays, [0.5, 0.95])
            print(f"preview, {len(delays)} moves: median {low:.1f} ms, 95 % within {high:.1f} ms")
            wanted = [offsets[k % len(offsets)] for k in range(CHANGES)]
            signs = [STEP if k % 2 else -STEP for k in range(CHANGES)]
            found = np.array([change(page, *own) for own in zip(wanted, signs, strict=True)])
            times, apart = found.T
            print(
                f"exact analysis, {CHANGES} changes: median {np.median(times):.2f} s, largest "
                f"{times.max():.2f} s; force of the preview within {apart.max():.2%}"
            )
        finally:
            server.end()


if __name__ == "__main__":
    main()
