"""Studio in a browser: sliders, refusals, downloads and
accessibility, without an error or a request elsewhere.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from fingertip import Design
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design.design_file import to_toml
from fingertip.studio.server import StudioServer
from tests.browser import click, drawn_ms, find_barriers, open_browser, picture, wait, watch
from tests.studio.conftest import serve


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    with open_browser(tmp_path_factory.mktemp("browser")) as browser:
        yield browser


PASSED = "✓ All {all} checks of the shape passed"
"""Verdict of a design without a fault."""


@pytest.fixture
def opened(driver: Any, server: StudioServer) -> Iterator[Any]:
    with watch(driver, f"http://{server.hosts[0]}/"):
        driver.get(server.url)
        wait(lambda: drawn_ms(driver))
        wait_for_checks(driver)
        yield driver


def wait_for_checks(driver: Any) -> str:
    """Verdict, once the studio is idle."""
    is_idle = "const d = document.documentElement.dataset; return !d.busy && !!d.checked"
    wait(lambda: driver.execute_script(is_idle))
    verdict: str = driver.find_element("id", "verdict").text
    return verdict


def put(driver: Any, path: str, value: object, *, by_slider: bool = False) -> str:
    """Change a field as somebody types or slides, and wait for what follows; return the verdict."""
    script = """
    const input = document.getElementById(`f-${arguments[0]}`);
    const used = arguments[2] ? input.closest('.field').querySelector('[type=range]') : input;
    used.value = arguments[1];
    used.dispatchEvent(new Event('input', {bubbles: true}));
    """
    driver.execute_script(script, path, str(value), by_slider)
    return wait_for_checks(driver)


def value_of(driver: Any, path: str) -> str:
    found: str = driver.execute_script(
        "return document.getElementById(arguments[0]).value", f"f-{path}"
    )
    return found


def find_refusals(driver: Any) -> dict[str, str]:
    """Refusals in sight, by the field that they stand in."""
    script = """
    return [...document.querySelectorAll('.field .refusal')].filter((text) => text.offsetHeight > 0)
      .map((text) => [text.closest('.field').dataset.path, text.textContent]);
    """
    return dict(driver.execute_script(script))


@pytest.mark.full
def test_parts_follow_a_slider(opened: Any, design: Design) -> None:
    before = picture(opened)
    assert put(opened, "skin.width_mm", 19, by_slider=True) == PASSED.format(all=47)
    assert value_of(opened, "skin.width_mm") == "19"
    wider = picture(opened)
    assert (np.abs(wider - before).max(axis=-1) > 50).mean() > 0.01
    field = opened.find_element("id", "p-skin.width_mm")
    assert "changed" in field.get_attribute("class")
    field.find_element("css selector", ".reset").click()
    wait_for_checks(opened)
    assert float(value_of(opened, "skin.width_mm")) == design.skin.width_mm
    assert np.array_equal(picture(opened), before)
    assert "changed" not in field.get_attribute("class")


@pytest.mark.full
def test_the_picture_of_the_pad_follows_a_change(opened: Any) -> None:
    def read_picture() -> str:
        drawn = opened.find_element("css selector", "#pad svg")
        assert drawn.size["width"] > 400
        shown: str = drawn.get_attribute("innerHTML")
        return shown

    before = read_picture()
    put(opened, "skin.crown_radius_mm", 14)
    assert read_picture() != before
    put(opened, "skin.crown_radius_mm", 10)
    assert read_picture() == before


def take_in_hand(driver: Any, path: str) -> str:
    """Give a slider the focus in the middle of the screen; return
    what is said of the values that pass.
    """
    script = """
    const field = document.getElementById(`p-${arguments[0]}`);
    field.closest('details').open = true;
    field.scrollIntoView({block: 'center'});
    field.querySelector('[type=range]').focus({preventScroll: true});
    """
    driver.execute_script(script, path)
    said: str = wait(lambda: driver.find_element("id", f"b-{path}").text)
    return said


def measure(driver: Any, path: str) -> tuple[float, int, str]:
    """Place of a field on the screen, number of open groups, and the colours on its
    slider's track.
    """
    script = """
    const field = document.getElementById(`p-${arguments[0]}`);
    return [field.getBoundingClientRect().top, document.querySelectorAll('.group[open]').length,
      field.querySelector('[type=range]').style.getPropertyValue('--bands')];
    """
    top, count, colours = driver.execute_script(script, path)
    return top, count, colours


@pytest.mark.full
def test_a_slider_shows_what_passes_and_refuses_the_rest_where_it_stands(opened: Any) -> None:
    """Bands are shares of the bounds of 6 to 60 mm."""
    assert take_in_hand(opened, "skin.width_mm") == "not refused: 16.9 to 23.1 mm"
    top, count, colours = measure(opened, "skin.width_mm")
    assert re.findall(r"var\(--good\) (?:max\()?([\d.]+)%", colours) == ["20.19", "31.67"]
    slider = opened.find_element("css selector", "[id='p-skin.width_mm'] [type=range]")
    assert "b-skin.width_mm" in slider.get_attribute("aria-describedby").split()
    put(opened, "skin.width_mm", 15, by_slider=True)
    refusals = find_refusals(opened)
    assert list(refusals) == ["skin.width_mm"]
    assert measure(opened, "skin.width_mm") == (pytest.approx(top, abs=1), count, colours)
    click(opened, "[id='e-skin.width_mm'] button")
    assert wait_for_checks(opened).startswith("✓")
    assert (value_of(opened, "skin.width_mm"), find_refusals(opened)) == ("16.9", {})
    # With this width others pass than before; the slider that is left shows none.
    assert take_in_hand(opened, "skin.thickness_side_mm").startswith("not refused: ")
    assert measure(opened, "skin.width_mm")[2] == colours
    put(opened, "skin.thickness_side_mm", 1.91)
    assert measure(opened, "skin.width_mm")[2] == ""


@pytest.mark.full
def test_a_design_is_chosen_by_its_picture_and_its_figures_follow(opened: Any) -> None:
    before = opened.find_element("id", "figures").text
    assert re.search(r"17 x 15 x 68 mm.* g.*days.*US dollars", " ".join(before.split()))
    shown = (
        "return [...document.querySelectorAll('.presets img')].filter((i) => i.naturalWidth > "
        "100).length"
    )
    wait(lambda: opened.execute_script(shown) == len(list_bundled_files(DESIGN)))
    click(opened, "[data-design=adult_thumb]")
    assert wait_for_checks(opened).startswith("✓")
    assert value_of(opened, "skin.width_mm") == "22"
    assert "22 x 18 x 49 mm" in opened.find_element("id", "figures").text


@pytest.mark.full
def test_a_refusal_stands_beside_its_field(opened: Any) -> None:
    before = picture(opened)
    verdict = put(opened, "skin.width_mm", 8)
    assert "refused" in verdict
    assert "skin.width_mm" in verdict
    refusals = find_refusals(opened)
    assert refusals["skin.width_mm"].endswith("16.9 to 23.1 mm pass. set 16.9")
    field = opened.find_element("id", "f-skin.width_mm")
    assert field.get_attribute("aria-invalid") == "true"
    assert "e-skin.width_mm" in field.get_attribute("aria-describedby")
    assert np.array_equal(picture(opened), before)
    put(opened, "skin.width_mm", "")
    assert "is not a number" in find_refusals(opened)["skin.width_mm"]
    assert put(opened, "skin.width_mm", 17) == PASSED.format(all=47)
    assert find_refusals(opened) == {}


@pytest.mark.full
def test_a_fit_moves_the_other_values_and_marks_them(opened: Any) -> None:
    assert "refused" in put(opened, "skin.width_mm", 16)
    click(opened, "#fit")
    assert "refused" not in wait_for_checks(opened)
    assert value_of(opened, "skin.width_mm") == "16"
    listed = opened.find_elements("css selector", "#fitted a")
    marked = opened.find_elements("css selector", ".field.fitted.changed")
    assert (
        {each.text for each in listed}
        == {each.get_attribute("data-path") for each in marked}
        != set()
    )


@pytest.mark.full
def test_a_parameter_is_found_and_highlighted(opened: Any) -> None:
    find = opened.find_element("id", "find")
    find.send_keys("sides of the cavity")
    fields = [one for one in opened.find_elements("css selector", ".field") if one.is_displayed()]
    assert [one.get_attribute("data-path") for one in fields] == ["mold.wall_mm"]
    before = picture(opened)
    click(opened, "[data-named='mold.wall_mm']")
    assert opened.find_element("id", "view-status").text.startswith(
        "mold.wall_mm shapes: mold palmar"
    )
    assert not np.array_equal(picture(opened), before)


@pytest.mark.full
def test_files_of_the_changed_design_are_downloaded(opened: Any, design: Design) -> None:
    put(opened, "skin.width_mm", 18.5)
    put(opened, "name", "mine")
    toml = opened.downloads / "mine.toml"
    click(opened, "[data-download=design]")
    wait(toml.is_file)
    saved = Design.load(toml)
    assert to_toml(saved) == to_toml(design.with_values({"skin.width_mm": 18.5, "name": "mine"}))
    click(opened, "[data-download=stl]")
    packed = opened.downloads / "mine_stl.zip"
    wait(packed.is_file, 30)
    with zipfile.ZipFile(packed) as archive:
        assert archive.testzip() is None
        assert "bone.stl" in archive.namelist()


@pytest.mark.full
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1400, 800, 390])
def test_is_accessible(opened: Any, scheme: str, width: int) -> None:
    take_in_hand(opened, "skin.width_mm")
    put(opened, "skin.width_mm", 8)
    assert find_refusals(opened)
    assert find_barriers(opened, scheme, width) == []


@pytest.mark.full
def test_a_server_that_ended_is_one_sentence(driver: Any, design: Design) -> None:
    with serve(design) as short:
        driver.get(short.url)
        wait_for_checks(driver)
    driver.execute_cdp_cmd("Network.enable", {})
    network = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
    driver.execute_cdp_cmd("Network.emulateNetworkConditions", {**network, "offline": True})
    try:
        assert "The studio does not answer" in put(driver, "skin.width_mm", 20)
    finally:
        driver.execute_cdp_cmd("Network.emulateNetworkConditions", {**network, "offline": False})
