"""Picture of a filling."""

import io
from types import SimpleNamespace

import pytest
from PIL import Image

from fingertip.design import Design
from fingertip.filling.predict import Opening, follow_front, predict_filling
from fingertip.filling.surface_links import build_skin_grid
from fingertip.pictures.filling import _summarise, draw_filling
from tests.conftest import design_file


@pytest.mark.parametrize("has_nail", [False, True])
def test_picture_is_a_png_and_repeats_itself(has_nail: bool) -> None:
    pytest.importorskip("matplotlib")
    design = Design.load(design_file("fsr400"))
    is_closed = (lambda points: (points[..., 1] > 4.0) & (points[..., 2] > 20.0)) if has_nail else None
    grid = build_skin_grid(design, 24, 32, is_closed)
    gate, vents = Opening((9.0, 0.0, 1.5), 2.7), (Opening((0.0, 5.0, 33.0), 1.2),)
    filling = predict_filling(follow_front(grid, gate), vents, (), viscosity_pa_s=35.0, pressure_pa=2000.0)
    first, second = (draw_filling(grid, filling, gate, vents, "Filling of fsr400") for _ in range(2))
    assert first == second
    image = Image.open(io.BytesIO(first))
    assert image.size == (2100, 1110)
    assert len(image.convert("RGB").getcolors(1 << 24)) > 500


def test_summary_tells_volume_pressure_and_time_in_the_units_it_names() -> None:
    filling = SimpleNamespace(volume_mm3=2250.0, fill_s=31.0, pressure_pa=48000.0, viscosity_pa_s=3.0, air_pockets=())
    assert _summarise(filling) == "2.25 cm³ in 31.0 s at 48 kPa and 3 Pa s; no air pocket"  # type: ignore[arg-type]
