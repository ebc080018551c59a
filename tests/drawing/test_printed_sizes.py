"""Sizes that calipers read on the print: what the printer adds, and
what tolerances leave between two parts.
"""

from __future__ import annotations

import pytest

from fingertip.design import Design
from fingertip.design.geometry.sizes import FIT, MIN_TOLERANCE_MM, PartDrawing, Size, general
from fingertip.pictures.drawing.draw import part_drawings
from tests.drawing.conftest import FILES, load_variant

OFFSET_MM = 0.12


def calibrated(name: str, surface_error_mm: float = 0.05) -> Design:
    """Design as `fingertip calibrate printer` leaves it for a printer that prints too much."""
    changes = {"printer.offset_mm": OFFSET_MM, "printer.scale_percent": 100.4}
    return load_variant((name, ())).with_values(
        changes | {"printer.surface_error_mm": surface_error_mm}
    )


def by_name(drawing: PartDrawing) -> dict[str, Size]:
    return {size.name: size for size in drawing.sizes}


def test_sheets_of_a_calibrated_design_state_the_sizes_of_the_print() -> None:
    """The stand's socket is widened for both prints: it leaves the
    post the same play as in the plain design.
    """
    sizes = {drawing.part: by_name(drawing) for drawing in part_drawings(calibrated("fsr400"))}
    plain = {
        drawing.part: by_name(drawing) for drawing in part_drawings(load_variant(("fsr400", ())))
    }
    for part, name, growth in (
        ("bone", "width of the base", 1.0),
        ("bone", "pocket of the sensor", -1.0),
    ):
        assert sizes[part][name].value == pytest.approx(plain[part][name].value)
        assert sizes[part][name].printed == pytest.approx(
            sizes[part][name].value + growth * OFFSET_MM
        )
    assert sizes["bone"]["width of the base"].text() == "13.32"
    plays = [
        found["stand"]["socket of the post"].printed - found["bone"]["post"].printed
        for found in (sizes, plain)
    ]
    assert plays == pytest.approx([plays[1]] * 2)


@pytest.mark.every_case
@pytest.mark.parametrize("name", FILES)
def test_no_tolerance_is_narrower_than_calipers_tell(name: str) -> None:
    for design in (load_variant((name, ())), calibrated(name, surface_error_mm=0.011)):
        for drawing in part_drawings(design):
            for size in drawing.sizes:
                tolerance = size.tolerance or general(size.printed)
                half = (tolerance.high - tolerance.low) / 2
                assert half >= MIN_TOLERANCE_MM - 1e-9 or tolerance.text() == FIT, size.name


def limits_mm(size: Size | float) -> tuple[float, float, float]:
    """Least, stated and largest size [mm]; of a bought part all are one."""
    if isinstance(size, float):
        return size, size, size
    tolerance = size.tolerance or general(size.printed)
    return size.printed + tolerance.low, size.printed, size.printed + tolerance.high


@pytest.mark.parametrize("is_calibrated", [False, True])
@pytest.mark.parametrize("name", ["fsr400", "adult_finger"])
def test_tolerances_of_two_mating_parts_leave_half_of_their_play(
    name: str, is_calibrated: bool
) -> None:
    design = calibrated(name) if is_calibrated else load_variant((name, ()))
    drawings = {drawing.part: by_name(drawing) for drawing in part_drawings(design)}
    bone, palmar, dorsal = (drawings[part] for part in ("bone", "mold_palmar", "mold_dorsal"))
    sensor = design.dimensions.sensor
    mates: list[tuple[Size | float, Size | float]] = [
        (bone["pocket of the sensor"], sensor.head_diameter_mm),
        (bone["width of the slot"], sensor.tail_width_mm),
    ]
    for which in ("larger", "smaller"):
        mates.append(
            (
                palmar[f"{which} socket, at the parting plane"],
                dorsal[f"{which} key, at the parting plane"],
            )
        )
    if "hand_stub" in drawings:
        gap = bone["gap between the cheeks"]
        tongue = drawings["hand_stub"]["width of the tongue"]
        mates.append((gap, design.hand.width_mm))
        assert limits_mm(gap)[0] > limits_mm(tongue)[2], "the finger turns on its stub"
        bores = [part["bore of the joint's pin"].text() for part in (bone, drawings["hand_stub"])]
        assert bores == [f"Ø{design.hand.pin_diameter_mm + loose:g} 0/-0.1" for loose in (0.0, 0.2)]
    else:
        mates.append((bone["hole of the cross bolt"], 3.0))
    for hole, shaft in mates:
        least, stated_hole, _ = limits_mm(hole)
        _, stated_shaft, largest = limits_mm(shaft)
        assert least - largest >= (stated_hole - stated_shaft) / 2 - 1e-9 > 0.0, (hole, shaft)


def test_general_tolerances_are_those_of_the_standard() -> None:
    """ISO 2768-1, table 1, class m."""
    table = {
        3.0: 0.1,
        6.0: 0.1,
        6.01: 0.2,
        30.0: 0.2,
        30.01: 0.3,
        120.0: 0.3,
        120.01: 0.5,
        400.0: 0.5,
    }
    assert {size: general(size).high for size in table} == table
