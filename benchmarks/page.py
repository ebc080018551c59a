"""Time from opening a report page to the first picture of its 3D view, in headless Chromium.

    python benchmarks/page.py [design ...] [--starts 9]

Each start has a new profile, as the first opening on a machine does. The browser renders in
software, so a machine with a graphics processor is faster. The project aims at two seconds.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import tempfile
from pathlib import Path

from fingertip import Design, make
from tests.browser import drawn_ms, open_browser, wait

PAGE = "index.html"


def measure_ms(page: Path) -> float:
    """Measure one start of the browser with a page [ms]."""
    with tempfile.TemporaryDirectory() as folder, open_browser(Path(folder)) as driver:
        driver.get(page.as_uri())
        return float(wait(lambda: drawn_ms(driver)))


def main() -> None:
    """Print median, 90th percentile and worst of each design, with the size of its page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="*", default=["fsr400", "adult_thumb"])
    parser.add_argument("--starts", type=int, default=9)
    arguments = parser.parse_args()
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, software "
        "rendering"
    )
    print(f"{'design':16}{'MB':>6}{'median ms':>11}{'p90 ms':>9}{'worst ms':>10}")

    for name in arguments.designs:
        with tempfile.TemporaryDirectory() as folder:
            make(Design.load(name), folder, formats=["stl"])
            page = Path(folder) / PAGE
            times = sorted(measure_ms(page) for _ in range(arguments.starts))
            high = times[int(0.9 * (len(times) - 1))]
            size = page.stat().st_size / 1e6
            print(
                f"{name:16}{size:6.1f}{statistics.median(times):11.0f}{high:9.0f}{times[-1]:10.0f}"
            )


if __name__ == "__main__":
    main()
