"""Loading of designs: defaults, files and changes are merged, and all issues are
reported at once.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.catalogues.electronics import SENSORS
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.design.design_file import list_parameters, to_toml
from fingertip.design.design_text import write_design
from fingertip.foundation.errors import DesignError
from tests.approved import check_text
from tests.conftest import design_file


def load_issues(*files: Path, changes: tuple[str, ...] = ()) -> dict[str, str]:
    """Messages of a design that is refused, by field."""
    with pytest.raises(DesignError) as caught:
        Design.load(*files, changes=changes)
    return {issue.field: issue.message for issue in caught.value.issues}


def test_later_values_win(tmp_path: Path) -> None:
    first = tmp_path / "a.toml"
    second = tmp_path / "b.toml"
    first.write_text("[mold]\nengraving_depth_mm = 0.2\nwall_mm = 5\n")
    second.write_text("[mold]\nengraving_depth_mm = 0.4\n")
    design = Design.load(first, second, changes=["mold.core_inset_mm=0.1"])
    assert (design.mold.engraving_depth_mm, design.mold.wall_mm, design.mold.core_inset_mm) == (
        0.4,
        5,
        0.1,
    )
    assert design.skin == Design().skin


@pytest.mark.every_case
@pytest.mark.parametrize("path", list_bundled_files(DESIGN).values(), ids=lambda path: path.stem)
def test_bundled_designs_are_written_as_new_ones_are_and_can_be_read_in_a_minute(
    path: Path,
) -> None:
    schema, *heading = path.read_text(encoding="utf-8").partition("\n\n")[0].splitlines()
    assert schema == "#:schema schemas/design.json"

    text = write_design(Design.load(path), (line.removeprefix("#").strip() for line in heading))

    check_text(path, f"{schema}\n{text}")
    assert sum(not line.startswith("#") for line in text.splitlines() if line) <= 40


def test_every_parameter_has_a_description_and_its_unit_in_its_name() -> None:
    suffix = {
        "mm": "_mm",
        "degree": "_deg",
        "Hz": "_hz",
        "uF": "_uf",
        "ohm": "_ohm",
        "V": "_v",
        "samples": "_samples",
        "bit": "_bits",
        "%": "_percent",
        "N": "_n",
        "Pa s": "_pa_s",
        "g/cm3": "_g_cm3",
        "m": "_m",
        "min": "_min",
        "h": "_h",
        "MPa": "_mpa",
        "uS": "_us",
        "kg": "_kg",
        "m/s": "_m_s",
    }
    for parameter in list_parameters():
        assert parameter.description, parameter.path
        if parameter.unit:
            assert parameter.path.endswith(suffix[parameter.unit]), parameter.path


def test_all_issues_are_reported_at_once() -> None:
    found = load_issues(
        changes=(
            "skin.widht_mm=17",
            "mold.wall_mm=nan",
            "bone.rim_mm=-1",
            "sensor.model=fsr4o2",
            "sensor.core_inset_mm=1",
            "detector.window_samples=2.5",
            "board.cutoff_hz=-67",
            "bone.channel_diameter_mm=9",
            "name=a/b",
            "mould.x=1",
            "skin.length_mm='long'",
        )
    )
    assert found["skin.widht_mm"] == "there is no such parameter; did you mean skin.width_mm?"
    assert found["mold.wall_mm"] == "nan is not a finite number; give one in mm."
    assert found["bone.rim_mm"] == "-1 mm is too small; at least 0.2 mm."
    assert "choose 'fsr400'" in found["sensor.model"]
    assert (
        found["sensor.core_inset_mm"]
        == "there is no such parameter; did you mean mold.core_inset_mm?"
    )
    assert "whole number" in found["detector.window_samples"]
    assert found["board.cutoff_hz"].startswith("-67 Hz is too small")
    assert found["mould"] == "there is no such parameter; did you mean mold?"
    assert (
        found["skin.length_mm"] == "'long' is not a number; write a number in mm, without quotes."
    )
    assert "cannot name a folder" in found["name"]
    # Rules between parameters that are valid are reported beside the issues of single parameters.
    assert "folds a channel of 9 mm" in found["bone.channel_bend_radius_mm"]
    # A rule that reads an invalid parameter is skipped.
    assert "skin.width_mm" not in found


def test_rules_on_a_table_whose_heading_was_lost_are_not_checked(tmp_path: Path) -> None:
    """Its values stand below another heading, so the defaults in their
    place would break rules that the file keeps.
    """
    text = to_toml(Design.load("youth_finger"))
    (tmp_path / "lost.toml").write_text(text.replace("[mold]", ""))
    found = load_issues(tmp_path / "lost.toml")
    assert (
        found["silicone.core_inset_mm"]
        == "there is no such parameter; did you mean mold.core_inset_mm?"
    )
    assert len(found) >= 4
    assert all(name.startswith("silicone.") for name in found)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    binary = tmp_path / "binary.toml"
    broken.write_text("[mold\n")
    binary.write_bytes(b"\xff\xfe\x00")
    found = load_issues(tmp_path / "none.toml", broken, binary, tmp_path, changes=("mold.wall_mm",))
    assert "No such file" in found[str(tmp_path / "none.toml")]
    assert "is not valid TOML" in found[str(broken)]
    assert "UTF-8" in found[str(binary)]
    assert "is a folder" in found[str(tmp_path)]
    assert "table.key=value" in found["--set mold.wall_mm"]
    assert "is not a table" in load_issues(changes=("mold=3",))["mold"]
    assert "table.key=value" in load_issues(changes=("=3",))["--set =3"]
    for value in ("inf", "-inf", "nan", "true", "[1]", "''"):
        assert "skin.width_mm" in load_issues(changes=(f"skin.width_mm={value}",))
    marked = tmp_path / "bom.toml"
    marked.write_bytes(b"\xef\xbb\xbf[skin]\r\nwidth_mm = 18\r\n")
    assert Design.load(marked).skin.width_mm == 18


def test_each_sensor_of_the_catalogue_fits_a_bundled_design() -> None:
    for name, sensor in SENSORS.items():
        Design.load(
            design_file(sensor.bundled_design), changes=[f"sensor.model={name}", *sensor.changes]
        )
