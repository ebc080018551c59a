"""Page of a design in a browser: drawn, used, printed and checked for
accessibility, without a request or an error.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.cad.files import stl
from fingertip.catalogues.output_files import PAGE
from fingertip.models.parts import PARTS
from tests.browser import HOW, click, drawn_ms, find_barriers, open_browser, picture, wait, watch
from tests.conftest import ROOT
from tests.tools import require_tool


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with open_browser(tmp_path_factory.mktemp("browser")) as browser:
        yield browser


@pytest.fixture
def opened(driver: Any, folder: Path) -> Any:
    """Page as a double click opens it: from its file, far from the files beside it."""
    alone = driver.downloads.parent / "alone.html"
    shutil.copyfile(folder / PAGE, alone)
    with watch(driver, alone.as_uri()):
        driver.get(alone.as_uri())
        wait(lambda: drawn_ms(driver))
        yield driver


def put(driver: Any, name: str, value: object) -> None:
    script = "const e = document.getElementById(arguments[0]); e.value = arguments[1];"
    driver.execute_script(
        f"{script} e.dispatchEvent(new Event('input', {{bubbles: true}}))", name, str(value)
    )


def drawn_share(driver: Any) -> float:
    """Share of the 3D view that parts fill."""
    return float((picture(driver)[..., 3] > 0).mean())


def count_pixels(driver: Any, rgb: tuple[int, int, int]) -> int:
    """Number of opaque pixels of one colour."""
    pixels = picture(driver)
    return int(((np.abs(pixels[..., :3] - rgb).max(axis=-1) <= 1) & (pixels[..., 3] == 255)).sum())


@pytest.mark.full
def test_is_taken_apart_and_put_together(opened: Any) -> None:
    seen = {}
    for preset in ("finger", "closed", "opened", "apart"):
        click(opened, f"[data-preset={preset}]")
        seen[preset] = picture(opened)
    names = list(seen)
    for i, name in enumerate(names):
        for other in names[i + 1 :]:
            assert np.abs(seen[name] - seen[other]).max() > 100
    click(opened, "[data-preset=closed]")
    assert np.array_equal(picture(opened), seen["closed"])
    put(opened, "apart", 100)
    assert opened.find_element("id", "apart-value").text == "100 %"
    assert not np.array_equal(picture(opened), seen["closed"])


@pytest.mark.full
def test_section_shows_the_inside(opened: Any) -> None:
    """In the closed mold only a section shows the skin.

    Its cut is filled with one colour, darker than the skin's.
    """
    click(opened, "[data-preset=closed]")
    click(opened, "[data-from=side]")
    flat = find_cut_colour(PARTS["skin"].colour)
    assert count_pixels(opened, flat) == 0
    click(opened, "#cut")
    cut = picture(opened)
    assert count_pixels(opened, flat) > 0.01 * cut.shape[0] * cut.shape[1]
    put(opened, "cut-place", 0)  # before the skin begins
    assert count_pixels(opened, flat) == 0
    put(opened, "cut-place", 50)
    assert np.array_equal(picture(opened), cut)


def find_cut_colour(colour: tuple[float, float, float]) -> tuple[int, int, int]:
    """Colour of a cut: 0.72 of the part's light, which is not 0.72 of its number."""
    red, green, blue = (round(255 * encode_srgb(0.72 * decode_srgb(part))) for part in colour)
    return red, green, blue


def decode_srgb(value: float) -> float:
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def encode_srgb(light: float) -> float:
    return 12.92 * light if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055


@pytest.mark.full
def test_parts_are_hidden_and_shown(opened: Any) -> None:
    click(opened, "[data-preset=apart]")  # which shows all
    before = drawn_share(opened)
    for box in opened.find_elements("css selector", "fieldset input"):
        opened.execute_script("arguments[0].click()", box)
    assert drawn_share(opened) == 0.0
    for box in opened.find_elements("css selector", "fieldset input"):
        opened.execute_script("arguments[0].click()", box)
    assert drawn_share(opened) == before


@pytest.mark.full
def test_a_parameter_highlights_its_parts(opened: Any) -> None:
    click(opened, "[data-preset=opened]")
    before = picture(opened)
    button = opened.find_element("id", "p-mold.wall_mm")
    opened.execute_script("arguments[0].closest('details').open = true", button)
    opened.execute_script("arguments[0].click()", button)
    said = opened.find_element("id", "view-status").text
    assert said.startswith("mold.wall_mm shapes: mold palmar")
    assert button.get_attribute("aria-pressed") == "true"
    assert not np.array_equal(picture(opened), before)
    opened.execute_script("arguments[0].click()", button)
    assert np.array_equal(picture(opened), before)


@pytest.mark.full
def test_placed_parts_are_counted(opened: Any) -> None:
    click(opened, "#tab-board")
    box = opened.find_element("css selector", "#bom tr[data-parts^='C1 C2 C3'] input")
    assert opened.find_element("id", "bom-placed").text.startswith("0 of ")
    opened.execute_script("arguments[0].click()", box)
    assert opened.find_element("id", "bom-placed").text.startswith("3 of ")
    opened.refresh()
    wait(lambda: drawn_ms(opened))
    assert opened.find_element(
        "css selector", "#bom tr[data-parts^='C1 C2 C3'] input"
    ).is_selected()
    opened.execute_script("localStorage.clear()")


@pytest.mark.full
def test_is_used_with_keys_alone(opened: Any) -> None:
    from selenium.webdriver.common.keys import Keys

    canvas = opened.find_element("id", "canvas")
    before = picture(opened)
    canvas.send_keys(Keys.ARROW_LEFT)
    turned = picture(opened)
    assert not np.array_equal(turned, before)
    canvas.send_keys("+")
    assert not np.array_equal(picture(opened), turned)
    canvas.send_keys("0")
    assert np.abs(picture(opened) - before).mean() < 0.5
    # The tabulator reaches the view and every control below it, in the order in which they stand.
    opened.execute_script("document.body.focus()")
    opened.execute_script("document.getElementById('canvas').focus()")
    reached = []
    for _ in range(30):
        opened.switch_to.active_element.send_keys(Keys.TAB)
        reached.append(opened.switch_to.active_element.get_attribute("outerHTML")[:60])
    order = (
        "data-preset",
        'id="apart"',
        'id="cut"',
        'id="show-0"',
        "data-from",
        'id="clear"',
        'id="save-picture"',
    )
    places = [next(i for i, html in enumerate(reached) if mark in html) for mark in order]
    assert places == sorted(places)


@pytest.mark.full
def test_saves_the_mesh_that_was_exported(opened: Any, folder: Path) -> None:
    click(opened, "[data-stl=bone]")
    path = opened.downloads / "bone.stl"
    wait(lambda: path.is_file() and path.stat().st_size == (folder / "bone.stl").stat().st_size)
    saved = stl.from_bytes(path.read_bytes())
    exported = stl.from_bytes((folder / "bone.stl").read_bytes())
    assert np.array_equal(saved.vertices, exported.vertices)
    assert np.array_equal(saved.triangles, exported.triangles)


@pytest.mark.full
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 800, 390])
def test_is_accessible(opened: Any, scheme: str, width: int) -> None:
    for tab in list_tabs(opened):
        click(opened, f"#tab-{tab}")
        assert find_barriers(opened, scheme, width) == [], tab


def list_tabs(driver: Any) -> list[str]:
    found: list[str] = driver.execute_script(
        "return [...document.querySelectorAll('[role=tab]')].map((t) => t.hash)"
    )
    assert len(found) in (6, 7)
    return [name.removeprefix("#") for name in found]


@contextmanager
def sized(driver: Any, width: int, height: int) -> Iterator[None]:
    """Give the browser's window another size, and load the page anew in it."""
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    driver.refresh()
    wait(lambda: drawn_ms(driver))
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


SHOWN = (
    "return [...document.querySelectorAll('.panel')].filter((p) => "
    "p.getClientRects().length).map((p) => p.id)"
)


@pytest.mark.full
def test_first_screen_says_what_it_takes_and_links_to_the_files(opened: Any, folder: Path) -> None:
    """Figures are those of the sheets: masses and days of the casting sheet."""
    with sized(opened, 1400, 900):
        first = "return [...document.querySelectorAll('#start .hero, #start .next')]"
        assert opened.execute_script(
            f"{first}.every((e) => e.getBoundingClientRect().bottom <= innerHeight)"
        )
        text = " ".join(opened.find_element("id", "start").text.split())
    casting = json.loads((folder / "report.json").read_bytes())["casting"]
    for words in (
        "Nobody has made one yet",
        f"{casting['batch']['total_g']:g} g to mix",
        "2 days with 4 h",
        "US dollars to order",
        f"{len(casting['things'])} things",
        "12 steps with pictures",
    ):
        assert words in text, words
    script = "return [...document.querySelectorAll('a[href]')].map((a) => a.getAttribute('href'))"
    links = {link for link in opened.execute_script(script) if not link.startswith(("#", "https:"))}
    assert {
        "print/plate_fdm.3mf",
        "casting.md",
        "acceptance.md",
        "board/README.md",
        "board/wiring.svg",
    } <= links
    assert [link for link in links if not (folder / link).is_file()] == []


CUT = """
    const seen = [...document.querySelectorAll('.panel *')].filter((e) => e.getClientRects().length);
    return seen.filter((e) => !e.closest('thead') && !(e.closest('svg') && e.tagName !== 'svg')).filter((e) => {
      const { right } = e.getBoundingClientRect();
      const scrolls = e.scrollWidth > e.clientWidth + 1 && e.clientWidth && getComputedStyle(e).display !== 'inline';
      return right > innerWidth + 1 || (scrolls && !['svg', 'SELECT', 'INPUT'].includes(e.tagName));
    }).map((e) => e.outerHTML.slice(0, 100))"""  # noqa: E501
"""Elements that are cut or scroll sidewards, without the heads of
tables that became cards and parts of pictures.
"""


def check_tabs(driver: Any, height: int) -> None:
    """Check that only the chosen tab is laid out, in four screens
    at most, and that nothing in it is cut.
    """
    tabs = list_tabs(driver)
    for tab in tabs:
        click(driver, f"#tab-{tab}")
        wait(lambda tab=tab: driver.execute_script(SHOWN) == [tab])
        assert (
            driver.execute_script("return document.documentElement.scrollHeight") <= 4 * height
        ), tab
    driver.execute_script("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    for tab in tabs:
        click(driver, f"#tab-{tab}")
        wait(lambda tab=tab: driver.execute_script(SHOWN) == [tab])
        assert driver.execute_script("return document.documentElement.scrollWidth <= innerWidth"), (
            tab
        )
        assert (
            driver.execute_script("return innerWidth > 500") or driver.execute_script(CUT) == []
        ), tab


@pytest.mark.full
def test_one_tab_is_laid_out_and_nothing_is_cut(opened: Any) -> None:
    from selenium.webdriver.common.keys import Keys

    for width, height in ((1400, 900), (390, 844)):
        with sized(opened, width, height):
            check_tabs(opened, height)
    opened.find_element("id", "tab-more").send_keys(Keys.ARROW_RIGHT)
    wait(lambda: opened.execute_script(SHOWN) == ["start"])
    assert opened.switch_to.active_element.get_attribute("aria-selected") == "true"
    opened.switch_to.active_element.send_keys(Keys.END)
    wait(lambda: opened.execute_script(SHOWN) == ["more"])
    assert drawn_share(opened) > 0.1


@pytest.mark.full
def test_an_address_selects_the_tab_that_holds_it(opened: Any) -> None:
    tabs = {
        "checks": "more",
        "board": "board",
        "casting": "cast",
        "p-mold.wall_mm": "more",
        "model": "start",
    }
    for anchor, tab in tabs.items():
        opened.execute_script("location.hash = arguments[0]", anchor)
        wait(lambda tab=tab: opened.execute_script(SHOWN) == [tab])
        assert opened.find_element("id", anchor).is_displayed()
    # A parameter shapes parts that stand in another tab; going back leads to it again.
    opened.execute_script("location.hash = 'p-mold.wall_mm'")
    wait(lambda: opened.execute_script(SHOWN) == ["more"])
    click(opened, "[id='p-mold.wall_mm']")
    wait(lambda: opened.execute_script(SHOWN) == ["start"])
    opened.back()
    wait(lambda: opened.execute_script(SHOWN) == ["more"])


@pytest.mark.full
def test_ticks_survive_a_reload_and_are_taken_back(opened: Any) -> None:
    def count(name: str) -> str:
        return str(opened.find_element("id", f"ticks-{name}").get_attribute("textContent"))

    click(opened, "#step-3 summary")
    click(opened, "#step-3 input")
    click(opened, "#step-4 summary")
    for row in (1, 2):
        click(opened, f"#buy tbody tr:nth-child({row}) input")
    assert not opened.find_element("css selector", "#step-3 details").get_attribute("open")
    assert (count("steps"), count("shopping").partition(" of ")[0]) == ("1 of 12 steps", "2")
    opened.refresh()
    wait(lambda: drawn_ms(opened))
    assert (count("steps"), count("shopping").partition(" of ")[0]) == ("1 of 12 steps", "2")
    assert opened.find_element("css selector", "#step-3 input").is_selected()
    click(opened, "#cast .ticked button")
    assert (count("steps"), count("shopping").partition(" of ")[0]) == ("0 of 12 steps", "2")
    opened.execute_script("localStorage.clear()")


@pytest.mark.full
def test_the_bundle_is_made_again_with_the_same_bytes(tmp_path: Path) -> None:
    """Second making of the vendored library, from the packages that
    `package.json` states; no network is needed.
    """
    import subprocess

    npm = ROOT / "tools/page_libraries"
    esbuild = require_tool(str(npm / "node_modules/.bin/esbuild"), HOW)
    bundle = (
        (npm / "bundle")
        .read_text(encoding="utf-8")
        .partition("node_modules/.bin/esbuild")[2]
        .partition("\ncp ")[0]
    )
    options = (
        bundle.replace("\\\n", " ")
        .replace('"$assets/three.bundle.js"', str(tmp_path / "three.js"))
        .split()
    )
    subprocess.run([str(esbuild), *options], cwd=npm, check=True)
    assets = ROOT / "src/fingertip/page/assets"
    assert (tmp_path / "three.js").read_bytes() == (assets / "three.bundle.js").read_bytes()
    assert (npm / "node_modules/three/LICENSE").read_bytes() == (
        assets / "three.LICENSE"
    ).read_bytes()
