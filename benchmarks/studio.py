"""Time of the studio from a change of one slider to new meshes on the screen, in headless Chromium.

    python -m benchmarks.studio [design ...]

Every number whose change shapes parts is moved in the page by a hundredth of its slider's range, and back where the
design is refused there. The page measures from the event of the slider to the frame that shows the new meshes; the
browser renders in software, so a machine with a graphics processor is faster. The project aims at one second.
"""

from __future__ import annotations

import os
import platform
import statistics
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from fingertip import Design
from fingertip.studio.server import StudioServer
from tests.browser import drawn_ms, open_browser, wait

LIMIT_MS = 1000
_MOVE = """
const field = document.getElementById(`p-${arguments[0]}`);
const slider = field.querySelector('[type=range]');
const share = (Number(slider.max) - Number(slider.min)) / 100;
slider.value = Number(slider.value) + (arguments[1] ? share : -share);
delete document.documentElement.dataset.changeMs;
slider.dispatchEvent(new Event('input', {bubbles: true}));
"""
_UNDO = """
const button = document.getElementById(`p-${arguments[0]}`).querySelector('.reset');
if (!button.hidden) button.click();
"""
_LIST = """
return [...document.querySelectorAll('.field')]
  .filter((field) => field.querySelector('[type=range]') && !field.querySelector('[data-named]').hidden)
  .map((field) => field.dataset.path);
"""


def measure(driver: Any, design: Design) -> tuple[dict[str, float], list[str]]:
    """Measure the time of each change [ms]; the second list names parameters that were refused both ways."""
    times, refused = {}, []
    with StudioServer(design, 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        driver.get(server.url)
        wait(lambda: drawn_ms(driver))
        wait_until_idle(driver)
        for path in driver.execute_script(_LIST):
            for is_up in (True, False):
                driver.execute_script(_MOVE, path, is_up)
                wait_until_idle(driver)
                taken = driver.execute_script("return document.documentElement.dataset.changeMs")
                driver.execute_script(_UNDO, path)
                wait_until_idle(driver)
                if taken:
                    times[path] = float(taken)
                    break
            else:
                refused.append(path)
        server.shutdown()
    return times, refused


def wait_until_idle(driver: Any) -> None:
    """Wait for parts and checks, and a moment more: somebody who slides looks before the next change."""
    wait(lambda: not driver.execute_script("return document.documentElement.dataset.busy"), 30)
    time.sleep(0.05)


def main() -> None:
    """Print a table of the designs, with the slowest parameter of each."""
    names = sys.argv[1:] or ["fsr400", "adult_finger", "adult_thumb"]
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, software rendering")
    print(f"{'design':16}{'changes':>8}{'median ms':>11}{'95 % ms':>9}{'slowest ms':>12}{'over 1 s':>10}  slowest")
    with tempfile.TemporaryDirectory() as folder, open_browser(Path(folder)) as driver:
        for name in names:
            times, refused = measure(driver, Design.load(name))
            ordered, slowest = sorted(times.values()), max(times, key=lambda path: times[path])
            high = ordered[int(0.95 * (len(ordered) - 1))]
            over = sum(taken > LIMIT_MS for taken in ordered)
            print(
                f"{name:16}{len(ordered):8}{statistics.median(ordered):11.0f}{high:9.0f}{ordered[-1]:12.0f}{over:10}"
                f"  {slowest}; {len(refused)} refused both ways"
            )


if __name__ == "__main__":
    main()
