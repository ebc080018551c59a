"""Time of the studio from a change of one slider to the word of the rules and to new meshes, in
headless Chromium.

    python -m benchmarks.studio [design ...] [--changes 10]

The first numbers of the form that shape parts, ten main parameters first, are taken in hand and
moved in the page by a hundredth of their slider's range, and back where the design is refused
there. The page measures from the event of the slider to the verdict of the rules, which may be a
refusal, and to the frame that shows the new meshes; the browser renders in software, so a machine
with a graphics processor is faster. The project aims at 0.3 s and at 1.5 s.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from fingertip import Design
from fingertip.studio.server import StudioServer
from tests.browser import drawn_ms, open_browser, wait

_MOVE = """
const field = document.getElementById(`p-${arguments[0]}`);
const slider = field.querySelector('[type=range]');
const share = (Number(slider.max) - Number(slider.min)) / 100;
slider.value = Number(slider.value) + (arguments[1] ? share : -share);
delete document.documentElement.dataset.changeMs;
slider.dispatchEvent(new Event('input', {bubbles: true}));
"""
_TAKE = """
const field = document.getElementById(`p-${arguments[0]}`);
field.closest('details').open = true;
field.querySelector('[type=range]').focus();
"""
_UNDO = """
const button = document.getElementById(`p-${arguments[0]}`).querySelector('.reset');
if (!button.hidden) button.click();
"""
_LIST = """
return [...document.querySelectorAll('.field')]
  .filter((field) => field.querySelector('[type=range]'))
  .filter((field) => !field.querySelector('[data-named]').hidden)
  .map((field) => field.dataset.path);
"""


def measure(
    driver: Any, design: Design, count: int
) -> tuple[list[float], list[float], list[float]]:
    """Measure the times of bands, of the rules' word and of new
    meshes, for a number of parameters [ms].
    """
    bands = list[float]()
    rules = list[float]()
    views = list[float]()

    with StudioServer(design, 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        driver.get(server.url)
        wait(lambda: drawn_ms(driver))
        wait_until_idle(driver)

        for path in driver.execute_script(_LIST)[:count]:
            begun = time.perf_counter()
            driver.execute_script(_TAKE, path)
            wait(lambda path=path: driver.find_element("id", f"b-{path}").text)
            bands.append(1e3 * (time.perf_counter() - begun))

            for is_up in (True, False):
                driver.execute_script(_MOVE, path, is_up)
                wait_until_idle(driver)
                word, view = driver.execute_script(
                    "const { rulesMs, changeMs } = document.documentElement.dataset; return "
                    "[rulesMs, changeMs]"
                )
                driver.execute_script(_UNDO, path)
                wait_until_idle(driver)
                rules.append(float(word))

                if view:
                    views.append(float(view))
                    break

        server.shutdown()

    return bands, rules, views


def wait_until_idle(driver: Any) -> None:
    """Wait for parts and checks, and a moment more: somebody who
    slides looks before the next change.
    """
    wait(lambda: not driver.execute_script("return document.documentElement.dataset.busy"), 120)
    time.sleep(0.05)


def main() -> None:
    """Print median and slowest time of each kind, in a table of the designs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="*", default=["fsr400", "adult_finger", "adult_thumb"])
    parser.add_argument("--changes", type=int, default=10)
    arguments = parser.parse_args()
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, software "
        "rendering"
    )
    print(f"{'median, slowest [ms]':22}{'band':>14}{'rules':>14}{'view':>14}")

    with tempfile.TemporaryDirectory() as folder, open_browser(Path(folder)) as driver:
        for name in arguments.designs:
            kinds = measure(driver, Design.load(name), arguments.changes)
            cells = (f"{statistics.median(times):6.0f}, {max(times):6.0f}" for times in kinds)
            print(f"{name:22}{''.join(f'{cell:>14}' for cell in cells)}")


if __name__ == "__main__":
    main()
