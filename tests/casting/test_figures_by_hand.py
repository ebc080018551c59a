"""Figures of the casting sheet that a person drills, cuts, buys or weighs, each computed by hand from the design."""

from __future__ import annotations

from functools import reduce
from typing import Any

import pytest

from fingertip.casting.quantities import SiliconeVolumes
from fingertip.catalogues.hardware import find_needle
from fingertip.catalogues.silicones import SILICONES
from fingertip.design import Design
from fingertip.documents.casting.sheet import casting_sheet_data
from tests.conftest import design_file
from tests.drawing.test_printed_sizes import calibrated

FIGURES = {
    "fsr400": {
        "fit.max_play_mm": 0.3,  # two gaps of 0.05 mm, each between two surfaces that are off by 0.05 mm
        "fit.paper_mm": 0.1,  # office paper of 80 g/m2
        "fit.papers": 3,
        "fit.tab_room_mm": 2.2,  # half a relief of 5 mm, less 0.3 mm
        "fit.slot_mm": 6.7,  # a tail of 6.4 mm and 0.15 mm on both sides
        "fit.seat_tape.from_mm": 2.0,  # below a collar of 2 mm
        "fit.seat_tape.to_mm": 7.5,  # 0.5 mm before the end of a recess of 8 mm
        "fit.cover_tape.length_mm": [27.5, 28.0],  # 22.5 mm to the sensor, 3.96 of its pocket, 0.5 and 0.3 of rim
        "chaplet.hole_mm": 2.1,  # a screw M2 passes with 0.1 mm
        "chaplet.pilot_mm": 1.6,  # and cuts its thread into 0.8 of its diameter
        "chaplet.pilot_depth_mm": 4.7,  # two diameters, and 0.7 mm
        "chaplet.needle.gauge": 18,  # 1.27 mm
        "mold.bolt_hole_mm": 3.4,
        "bill.cross bolt (machine screw).crossed_mm": 8.4,  # the width of the post
        "supplies.cups.count": 4,  # one for each of three mixtures, and one to pour into
    },
    "adult_finger": {
        "fit.seat_tape.from_mm": 0.5,  # on a collar of 6 mm, 0.5 mm from both ends
        "fit.seat_tape.to_mm": 5.5,
        "bill.anchor pin of the tendon (spring steel wire).diameter_mm": 1.0,  # a hole of 1.2 mm and 0.2 mm of play
        "bill.anchor pin of the tendon (spring steel wire).length_mm": 14.0,  # the chord of the collar there
        "chaplet.length_mm": 12.0,  # M2 from 4 mm below the facet at 4.52 mm to less than the face at 12.9 mm
    },
    "fsr400 bone.interface=socket bone.base_length_mm=32": {
        "bill.cross bolt (machine screw).crossed_mm": 13.0,  # a finger of 17 mm less 2 mm of skin on both sides
    },
    "fsr400 bone.interface=flange bone.base_length_mm=27": {
        "bill.flange bolt (machine screw).count": 2,  # in one row
        "bill.flange bolt (machine screw).thread_mm": 3.0,
    },
}  # fmt: skip


def sheet_data(design: Design) -> dict[str, Any]:
    return casting_sheet_data(design, SiliconeVolumes(2.6, 0.2, 0.1), SILICONES["addition_40a"])


def figure(data: Any, path: str) -> Any:
    """Figure at a path; entries of a list are found by their item."""
    return reduce(
        lambda part, key: next(e for e in part if e["item"] == key) if isinstance(part, list) else part[key],
        path.split("."), data,
    )  # fmt: skip


@pytest.mark.parametrize("case", FIGURES)
def test_figures_are_those_computed_by_hand(case: str) -> None:
    name, *changes = case.split()
    data = sheet_data(Design.load(design_file(name), changes=changes))
    assert {path: figure(data, path) for path in FIGURES[case]} == FIGURES[case]
    # Screw and boss hold the tip beside the sensor; play grows towards the apex.
    assert data["fit"]["retained_over_sensor_percent"] > data["fit"]["retained_elsewhere_percent"]


def test_sheet_of_a_calibrated_printer_states_the_same_prints() -> None:
    """Only the model is larger, by what the printer adds: drills, paper, gaps and quantities stay."""
    plain, measured = (sheet_data(d) for d in (Design.load(design_file("fsr400")), calibrated("fsr400")))
    for data in (plain, measured):
        data["fit"].pop("cover_tape")  # covers the pocket of the model, which is wider than that of the print
        data["filling"].pop("up")
        data["supplies"] = [entry for entry in data["supplies"] if "tape over the sensor" not in entry["item"]]
    assert measured == plain


@pytest.mark.parametrize(("hole_mm", "gauge"), [(2.4, 14), (2.0, 16), (1.6, 18), (1.2, 20), (1.0, 22)])
def test_needles_are_those_of_the_standard_and_leave_air_a_way(hole_mm: float, gauge: int) -> None:
    """ISO 9626: outer diameters by gauge; the next thicker one would touch the hole or leave less than 0.2 mm."""
    outer_mm = {14: 2.11, 16: 1.65, 18: 1.27, 20: 0.91, 22: 0.72}[gauge]
    assert find_needle(hole_mm) == {"gauge": gauge, "outer_mm": outer_mm}
    assert find_needle(outer_mm + 0.19) != {"gauge": gauge, "outer_mm": outer_mm}
    assert find_needle(0.8) is None
