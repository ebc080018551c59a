"""Files of readings: the template, and refusal of everything that cannot be a reading, all at once."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

from fingertip.calibration.readings import MIN_LENGTH_MM, check_readings, list_lengths, read_readings, write_template
from fingertip.design import Design
from fingertip.foundation.errors import DesignError, TomlFileError
from tests.calibration.simulated import simulate, to_toml
from tests.conftest import design_file

DESIGN = Design()


def refuse(changes: dict[str, Any]) -> list[str]:
    """Messages about sound readings with changes."""
    with pytest.raises(DesignError) as caught:
        check_readings(simulate(DESIGN, 0) | changes, DESIGN, "r.toml")
    return [str(issue) for issue in caught.value.issues]


def test_template_has_every_length_with_its_nominal_value_and_place() -> None:
    text = write_template(DESIGN)
    tables = tomllib.loads(text)
    lengths = {length.name: length for length in list_lengths(DESIGN)}
    assert tables.keys() - {"coupon"} == lengths.keys()
    assert all(tables[name] == [] for name in lengths)
    for line in text.splitlines():
        if (name := line.partition(" = ")[0]) in lengths:
            assert f": nominal {lengths[name].nominal_mm:.3f}. {lengths[name].where}" in line
    assert {length.kind for length in lengths.values()} == {"outer", "inner", "wall"}
    assert min(length.nominal_mm for length in lengths.values() if length.kind != "wall") >= MIN_LENGTH_MM


def test_nominal_lengths_are_those_of_the_files() -> None:
    """The scale of the files is part of them, so a coupon of a scaled design is another one."""
    scaled = Design.load(changes=["printer.scale_percent=99.5"])
    for plain, other in zip(list_lengths(DESIGN), list_lengths(scaled), strict=True):
        assert other.nominal_mm == pytest.approx(0.995 * plain.nominal_mm, abs=1e-6)
    (issue,) = refuse({"coupon": simulate(scaled, 0)["coupon"]})
    assert "is another coupon than that of fsr400" in issue


@pytest.mark.parametrize(
    ("readings", "message"),
    [
        (["10,02", 10.0, 10.0], "slot_mm: reading 1, '10,02', is text; write the number in mm with a decimal point"),
        ([10.02, 10, 10.0], "slot_mm: reading 2, 10, is a whole number, as a decimal comma leaves two of them"),
        ([10.02, -10.0, 10.0], "slot_mm: reading 2, -10 mm, is not positive"),
        ([10.02, 10.0, 0.0], "slot_mm: reading 3, 0 mm, is not positive"),
        ([math.nan, 10.0, 10.0], "slot_mm: reading 1, nan, is not a length"),
        ([math.inf, 10.0, 10.0], "slot_mm: reading 1, inf, is not a length"),
        ([True, 10.0, 10.0], "slot_mm: reading 1, True, is not a length"),
        ([0.394, 10.0, 10.0], "slot_mm: reading 1, 0.394, looks like inches; write it in millimetres, about 10.00."),
        ([1.01, 10.0, 10.0], "slot_mm: reading 1, 1.01, looks like centimetres"),
        ([11.2, 10.0, 10.0], "slot_mm: reading 1, 11.2 mm, is more than 0.5 mm off the nominal 10.00 mm"),
        (10.0, "slot_mm: 10.0 is no list of readings; write 3 or more in square brackets."),
        ([10.0, 10.1], "slot_mm: 2 readings cannot show a slip; at least 3, or none."),
    ],
)
def test_a_value_that_is_no_reading_is_refused(readings: Any, message: str) -> None:
    (issue,) = refuse({"slot_mm": readings})
    assert issue.startswith(message)


def test_all_faults_are_reported_at_once() -> None:
    issues = refuse({"slt_mm": [1.0], "outer_x_mm": ["x", -1.0], "coupon": "00000000", "tongue_mm": 3.0})
    assert [issue.partition(":")[0] for issue in issues] == [
        "coupon", "outer_x_mm", "outer_x_mm", "tongue_mm", "slt_mm",
    ]  # fmt: skip
    assert "did you mean slot_mm?" in issues[-1]


def test_too_few_lengths_are_refused_with_the_names_of_others() -> None:
    inner = {length.name: [] for length in list_lengths(DESIGN) if length.kind == "inner"}
    inner["slot_mm"] = [10.0, 10.01, 10.0]
    (issue,) = refuse(inner)
    assert issue.startswith("readings: 1 inner length with readings are too few to tell scale from offset; at least 3")
    assert "window_x_mm and window_y_mm" in issue


def test_a_decimal_comma_and_another_file_are_named(tmp_path: Path) -> None:
    path = tmp_path / "r.toml"
    path.write_text(to_toml(simulate(DESIGN, 0)).replace("slot_mm = [", "slot_mm = [10,02, "))
    with pytest.raises(TomlFileError, match="write the number with a decimal point, not with a comma"):
        read_readings(path, DESIGN)
    with pytest.raises(DesignError, match="is not a file of caliper readings; `fingertip coupon` writes one"):
        read_readings(design_file("fsr400"), DESIGN)
    with pytest.raises(DesignError) as caught:
        check_readings(tomllib.loads(write_template(DESIGN)), DESIGN, "r.toml")
    assert [issue.field for issue in caught.value.issues] == ["readings", "readings"], "the empty template"
