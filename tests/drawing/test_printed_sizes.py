"""Sizes that calipers read on the print: what the printer adds, and what tolerances leave between two parts."""

from __future__ import annotations

import pytest

from fingertip.design import Design
from fingertip.design.geometry.sizes import FIT, MIN_TOLERANCE_MM, PartDrawing, Size, general
from fingertip.pictures.drawing.draw import part_drawings
from tests.drawing.conftest import FILES, load_variant

OFFSET_MM = 0.12


def calibrated(name: str, surface_error_mm: float = 0.05) -> Design:
    """Design as `fingertip calibrate printer` leaves it for a printer that prints too much."""
    from fingertip.calibration.printer import CLEARANCES

    plain = load_variant((name, ()))
    changes = {path: float(plain.value(path)) + surfaces / 2 * OFFSET_MM for path, surfaces in CLEARANCES.items()}
    changes |= {"printer.offset_mm": OFFSET_MM, "printer.scale_percent": 100.4}
    return plain.with_values(changes | {"printer.surface_error_mm": surface_error_mm})


def by_name(drawing: PartDrawing) -> dict[str, Size]:
    return {size.name: size for size in drawing.sizes}


def test_sheets_of_a_calibrated_design_state_the_sizes_that_the_plain_design_intends() -> None:
    """Pocket, traps, bolt holes and sockets are widened in the files, and print as before."""
    plain = {drawing.part: by_name(drawing) for drawing in part_drawings(load_variant(("fsr400", ())))}
    for drawing in part_drawings(calibrated("fsr400")):
        for name, size in by_name(drawing).items():
            if name in ("pocket of the sensor", "width of the slot", "bolt holes") or "nut traps across" in name:
                assert size.printed == pytest.approx(plain[drawing.part][name].printed), name
                assert size.value == pytest.approx(size.printed + OFFSET_MM)
                assert size.tolerance == pytest.approx(plain[drawing.part][name].tolerance), name
    sizes = by_name(part_drawings(calibrated("fsr400"))[0])
    assert sizes["width of the base"].printed == pytest.approx(sizes["width of the base"].value + OFFSET_MM)
    assert sizes["width of the base"].text() == "13.32 ±0.1"


@pytest.mark.every_case
@pytest.mark.parametrize("name", FILES)
def test_no_tolerance_is_narrower_than_calipers_tell(name: str) -> None:
    for design in (load_variant((name, ())), calibrated(name, surface_error_mm=0.011)):
        for drawing in part_drawings(design):
            for size in drawing.sizes:
                tolerance = size.tolerance or general(size.printed)
                half = (tolerance.high - tolerance.low) / 2
                assert half >= MIN_TOLERANCE_MM - 1e-9 or tolerance.text() == FIT, size.name
                if "width of the" in size.name and ("base" in size.name or "recess" in size.name):
                    assert tolerance.text() != FIT, "a size with a number of its own is measured"


def limits_mm(size: Size | float) -> tuple[float, float, float]:
    """Least, stated and largest size [mm]; of a bought part all are one."""
    if isinstance(size, float):
        return size, size, size
    tolerance = size.tolerance or general(size.printed)
    return size.printed + tolerance.low, size.printed, size.printed + tolerance.high


@pytest.mark.parametrize("is_calibrated", [False, True])
@pytest.mark.parametrize("name", ["fsr400", "adult_finger"])
def test_tolerances_of_two_mating_parts_leave_half_of_their_play(name: str, is_calibrated: bool) -> None:
    design = calibrated(name) if is_calibrated else load_variant((name, ()))
    drawings = {drawing.part: by_name(drawing) for drawing in part_drawings(design)}
    bone, palmar, dorsal = (drawings[part] for part in ("bone", "mold_palmar", "mold_dorsal"))
    sensor, bolt_mm = design.dimensions.sensor, 3.0
    mates: list[tuple[Size | float, Size | float]] = [
        (bone["pocket of the sensor"], sensor.head_diameter_mm), (bone["width of the slot"], sensor.tail_width_mm),
        (dorsal["hole of the screw"], 2.0),
    ]  # fmt: skip
    assert bone["pilot hole of the screw"].text() == "Ø1.6 ±0.1", "the screw keeps three quarters of its bite"
    for which in ("larger", "smaller"):
        mates.append((palmar[f"{which} socket, at the parting plane"], dorsal[f"{which} key, at the parting plane"]))
    if "lid" in drawings:
        mates.append((bone["width of the trough"], drawings["lid"]["width"]))
        mates.append((drawings["lid"]["length"].value + design.sensor.clearance_mm, drawings["lid"]["length"]))
        mates.append((bone["gap between the cheeks"], design.hand.width_mm))
        assert bone["bore of the joint's pin"].text() == "Ø2 0/-0.1", "it is reamed, never wider than the pin"
    else:
        mates.append((bone["hole of the cross bolt"], 2.0))
    for half in (palmar, dorsal):
        hole = half["bolt holes"]
        mates.append((hole, bolt_mm))
        for way in ("across", "along"):
            low, _, high = limits_mm(half[f"spacing of the bolts, {way}"])
            # The spacings of the halves differ by this at most, and their holes by half of it at either end.
            assert limits_mm(hole)[0] - (high - low) / 2 >= bolt_mm - 1e-9, "bolts pass both halves"
    for hole, shaft in mates:
        (least, stated_hole, _), (_, stated_shaft, largest) = limits_mm(hole), limits_mm(shaft)
        assert least - largest >= (stated_hole - stated_shaft) / 2 - 1e-9 > 0.0, (hole, shaft)


def test_general_tolerances_are_those_of_the_standard() -> None:
    """ISO 2768-1, table 1, class m."""
    table = {3.0: 0.1, 6.0: 0.1, 6.01: 0.2, 30.0: 0.2, 30.01: 0.3, 120.0: 0.3, 120.01: 0.5, 400.0: 0.5}
    assert {size: general(size).high for size in table} == table
