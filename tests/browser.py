"""Headless Chromium for tests of pages: started, used with a script, and checked for
accessibility.
"""

from __future__ import annotations

import base64
import importlib.util
import io
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tests.conftest import ROOT
from tests.tools import require_tool

HOW = "as root on Debian, sh .ci/install-chromium"
AXE = ROOT / "tools/page_libraries/node_modules/axe-core/axe.min.js"
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--force-device-scale-factor=1",
    "--window-size=1300,1000",
)


@contextmanager
def open_browser(folder: Path) -> Iterator[Any]:
    """Start Chromium with an empty profile in a folder; its `downloads` go to another one in it."""
    chromium = require_tool("chromium", HOW)
    chromedriver = require_tool("chromedriver", HOW)
    if importlib.util.find_spec("selenium") is None:
        require_tool("selenium", 'pip install "fingertip-kit[test]"')
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = str(chromium)
    downloads = folder / "downloads"
    downloads.mkdir()
    for flag in (*FLAGS, f"--user-data-dir={folder / 'profile'}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    # Without the second setting, Chromium asks before the second file that a script saves long
    # after a click.
    saving = {
        "download.default_directory": str(downloads),
        "profile.default_content_setting_values.automatic_downloads": 1,
    }
    options.add_experimental_option("prefs", saving)
    browser: Any = webdriver.Chrome(options=options, service=Service(str(chromedriver)))
    browser.downloads = downloads
    try:
        yield browser
    finally:
        browser.quit()


@contextmanager
def watch(driver: Any, address: str) -> Iterator[None]:
    """Fail if what is opened meanwhile complains, or asks for anything
    beyond addresses that begin with this one.
    """
    driver.get("about:blank")  # the browser's own first page is no concern of the tests
    driver.get_log("performance")
    driver.get_log("browser")
    yield
    assert [entry for entry in driver.get_log("browser") if entry["level"] != "INFO"] == []
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    asked = [
        one["params"]["request"]["url"]
        for one in messages
        if one["method"] == "Network.requestWillBeSent"
    ]
    assert any(url.startswith(address) for url in asked)
    assert [
        url for url in asked if not url.startswith((address, "data:", "blob:", "chrome:"))
    ] == []


def wait(condition: Any, seconds: float = 60.0) -> Any:
    """Wait until a condition gives something, and return it."""
    until = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.05)
    return found


def drawn_ms(driver: Any) -> str | None:
    """Time of the first picture of the 3D view [ms], as text; None before it."""
    found: str | None = driver.execute_script("return document.documentElement.dataset.drawnMs")
    return found


def click(driver: Any, selector: str) -> None:
    driver.execute_script("document.querySelector(arguments[0]).click()", selector)


def picture(driver: Any) -> Any:
    """Pixels of the 3D view, red, green, blue and opacity."""
    from PIL import Image

    script = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => "
    data = driver.execute_async_script(
        f"{script}done(document.getElementById('canvas').toDataURL())))"
    )
    return np.asarray(
        Image.open(io.BytesIO(base64.b64decode(data.partition(",")[2]))).convert("RGBA")
    ).astype(int)


def find_barriers(driver: Any, scheme: str, width: int) -> list[list[str]]:
    """Find what axe-core objects to, in one colour scheme at one width, at which the page
    must fit.
    """
    axe = require_tool(str(AXE), HOW).read_text(encoding="utf-8")
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        driver.execute_script(
            "document.querySelectorAll('details').forEach((d) => { d.open = true; })"
        )
        time.sleep(0.3)
        assert driver.execute_script("return document.documentElement.scrollWidth <= innerWidth")
        # The page's policy would refuse a script.
        driver.execute_cdp_cmd("Runtime.evaluate", {"expression": axe})
        script = (
            "const done = arguments[0]; axe.run(document).then((r) => done(r.violations.map((v) => "
        )
        found: list[list[str]] = driver.execute_async_script(
            f"{script}[v.id, v.impact, v.nodes[0].html])))"
        )
        background = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
        assert (background == "rgb(255, 255, 255)") == (scheme == "light")
        return found
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
