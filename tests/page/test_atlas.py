"""Atlas of the parameters: each on the part that it changes, where it changes, as one file."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip import Design
from fingertip.cad.shapes.parts import shapes_of_parameters
from fingertip.design.files import list_parameters
from fingertip.design.parameters import PARAMETERS
from fingertip.page.parameters_and_checks import render_atlas
from fingertip.pictures.parameter_changes import (
    _FARTHER,
    _NEARER,
    _RING,
    AtlasPicture,
    draw_atlas,
    draw_parameter,
    find_depth_changes,
    find_ring,
)
from tests.approved import check_figures
from tests.figures import sum_up
from tests.page.conftest import Page
from tests.view.describe import describe_pixels


def open_picture(png: bytes) -> Any:
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)


def find_tinted(png: bytes, colour: tuple[float, float, float]) -> Any:
    """Pixels of a hue, whatever their brightness."""
    pixels = open_picture(png)
    unit = pixels / np.maximum(np.linalg.norm(pixels, axis=2, keepdims=True), 1.0)
    return (unit @ (np.array(colour) / np.linalg.norm(colour))) > 0.995


@pytest.fixture(scope="module")
def picture(design: Design) -> AtlasPicture:
    drawn = draw_parameter(design, "bone.collar_length_mm", ("mold_palmar", "bone"))
    assert drawn
    return drawn


def describe_picture(drawn: AtlasPicture) -> str:
    """Caption, size, and of each colour of a change the pixels, their middle and their spread."""
    said = [f"{drawn.path} {drawn.caption}: {open_picture(drawn.png).shape[:2]}"]
    for name, colour in (("nearer", _NEARER), ("farther", _FARTHER), ("ring", _RING)):
        rows, columns = np.nonzero(find_tinted(drawn.png, colour))
        if len(rows):
            places = (len(rows), rows.mean(), columns.mean(), np.ptp(rows), np.ptp(columns))
            said.append(f"{name} {sum_up(places)}")
    return ", ".join(said)


def test_the_change_is_coloured_as_approved(design: Design, picture: AtlasPicture) -> None:
    """A part that becomes longer, and a hole that becomes wider."""
    hole = draw_parameter(design, "bone.cross_bolt_diameter_mm", ("bone",), "another design")
    lines = [line for one in (picture, hole) if one for line in (describe_picture(one), *describe_pixels(one.png))]
    check_figures(Path(__file__).parent / "approved" / "atlas.txt", lines, rel=0.04, abs_=2.0)


def test_depth_changes_have_their_sign() -> None:
    old = np.array([[0.0, 0.0, 0.0, -np.inf, 1.0, -np.inf]])
    new = np.array([[0.5, -0.5, 0.05, 2.0, -np.inf, -np.inf]])
    nearer, farther = find_depth_changes(old, new, 0.1)
    assert nearer.tolist() == [[True, False, False, True, False, False]]
    assert farther.tolist() == [[False, True, False, False, True, False]]


def test_a_small_change_has_a_ring_around_it() -> None:
    changed = np.zeros((400, 600), dtype=bool)
    changed[100:108, 200:210] = True
    ring = find_ring(changed, 200)
    assert ring
    left, top, right, bottom = ring
    assert left < 100 < 105 < right
    assert top < 50 < 54 < bottom
    changed[:, :300] = True
    assert find_ring(changed, 200) is None
    assert find_ring(np.zeros((4, 4), dtype=bool), 2) is None


def test_page_shows_every_parameter_in_one_file(design: Design, picture: AtlasPicture) -> None:
    data = render_atlas(design, {picture.path: picture})
    assert data == render_atlas(design, {picture.path: picture})
    page = Page(data.decode())
    assert not page.faults
    assert [tag for tag, _ in page.elements].count("h3") == len(PARAMETERS)
    for parameter in list_parameters():
        assert parameter.path in page.text
        assert parameter.description in page.text
    (source,) = page.attributes("src")
    assert base64.b64decode(source.partition(",")[2]) == picture.png
    assert picture.caption in page.text
    assert not [link for link in page.attributes("href") if not link.startswith("#")]
    assert "script" not in {tag for tag, _ in page.elements}


@pytest.mark.full
def test_every_parameter_that_shapes_a_part_is_drawn(design: Design) -> None:
    """All have a picture, on this design or another, but the one of which no bundled design takes both values."""
    drawn = {picture.path: picture for picture in draw_atlas(design)}
    shaping = {path for path in shapes_of_parameters(design) if path.startswith(("skin.", "bone.", "mold.", "sensor."))}
    assert shaping - set(drawn) == {"sensor.tail"}
    assert len(drawn) > 75
    for picture in drawn.values():
        tinted = find_tinted(picture.png, _NEARER) | find_tinted(picture.png, _FARTHER)
        assert tinted.any(), picture.path
    own = [picture for picture in drawn.values() if not picture.drawn_on]
    assert len(own) > 45
    assert sum(len(picture.png) for picture in drawn.values()) < 2_000_000
