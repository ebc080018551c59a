"""The casting sheet: its page states its data and nothing else."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fingertip.build_files import Build, build
from fingertip.cad.printing import print_orientations
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting import markdown, sheet
from fingertip.casting.materials import MATERIALS
from fingertip.casting.slicer import HOW_TO_INSTALL, PrintEstimate, parse_gcode, minutes, slice_part
from fingertip.casting.quantities import SiliconeVolumes
from fingertip.design import Design
from fingertip.design.geometry.misalignment import min_thickness_held
from fingertip.errors import DesignError, GeometryError
from tests.conftest import design_file, run_fingertip
from tests.tools import require_tool

FSR400 = design_file("fsr400")
VOLUMES = SiliconeVolumes(12.625, 0.5, 0.125)
PRINTS = {name: PrintEstimate(31.4 + i, 2.87 + i) for i, name in enumerate(PARTS)}


def fsr400(*changes: str) -> Design:
    return Design.load(FSR400, changes=changes)


def leaves(data: Any) -> Iterator[Any]:
    if isinstance(data, dict):
        for value in data.values():
            yield from leaves(value)
    elif isinstance(data, list):
        for value in data:
            yield from leaves(value)
    else:
        yield data


def foreign_numbers(page: str, data: dict[str, Any]) -> list[str]:
    """Numbers of the page that the data do not hold as numbers. Names of the data, which hold digits, are left out."""
    for name in sorted({v for v in leaves(data) if isinstance(v, str)} | {HOW_TO_INSTALL}, key=len, reverse=True):
        page = page.replace(name, "")
    page = re.sub(r"^\d+\. ", "", page, flags=re.MULTILINE)
    page = re.sub(r"\bM(?=\d)", "", page)
    known = {float(v) for v in leaves(data) if isinstance(v, (int, float)) and not isinstance(v, bool)}
    return [token for token in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", page) if float(token) not in known]


@pytest.mark.parametrize("prints", [None, PRINTS], ids=["unsliced", "sliced"])
@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_every_number_of_the_page_is_in_the_data(method: str, material: str, prints: dict[str, PrintEstimate] | None) -> None:
    data = sheet.figures(fsr400(f"mold.method={method}"), VOLUMES, MATERIALS[material], prints)
    page = markdown.page(data)
    assert foreign_numbers(page, data) == []
    assert foreign_numbers(page + "\nand 98765 more", data) == ["98765"], "the test above can fail"
    assert json.loads(json.dumps(data)) == data


def test_masses_follow_from_the_volumes() -> None:
    card = MATERIALS["addition_40a"]
    data = sheet.figures(fsr400(), VOLUMES, card)
    volumes, batch = data["volumes_cm3"], data["batch"]
    assert volumes["total"] == pytest.approx(13.25)
    assert batch["in_mold_g"] == pytest.approx(13.25 * 1.08)
    assert batch["total_g"] == pytest.approx(1.25 * 13.25 * 1.08, abs=0.1)
    assert batch["a_g"] + batch["b_g"] == pytest.approx(batch["total_g"], abs=1e-9)
    assert batch["a_g"] / batch["b_g"] == pytest.approx(10.0, rel=0.01)


def test_only_a_platinum_silicone_is_warned_of_uncured_resin() -> None:
    told = {
        name: " ".join(markdown.warnings(sheet.figures(fsr400(), VOLUMES, card))) for name, card in MATERIALS.items()
    }
    assert {name for name, text in told.items() if "Uncured resin" in text} == {"addition_40a", "sylgard_184"}
    for text in told.values():
        assert "cyanoacrylate" in text
        assert "air vent open" in text


def test_a_mold_made_for_another_silicone_says_what_to_build() -> None:
    card = MATERIALS["condensation_40a"]
    (told,) = (w for w in markdown.warnings(sheet.figures(fsr400(), VOLUMES, card)) if "shrinkage" in w)
    change = re.search(r"--set (\S+)`", told)
    assert change
    again = sheet.figures(fsr400(change[1]), VOLUMES, card)
    assert not any("shrinkage" in warning for warning in markdown.warnings(again))


def test_what_keeps_silicone_out_depends_on_the_method() -> None:
    over, sleeve = (
        markdown.steps(sheet.figures(fsr400(f"mold.method={m}"), VOLUMES, MATERIALS["addition_40a"]))
        for m in ("overmold", "sleeve")
    )
    assert [i for i, step in enumerate(over) if "tape" in step] < [i for i, step in enumerate(over) if "Weigh" in step]
    assert not any("tape" in step for step in sleeve)
    assert any("Nothing is let into the core" in step for step in sleeve)
    assert [i for i, step in enumerate(sleeve) if "sensor into" in step] > [
        i for i, step in enumerate(sleeve) if "Weigh" in step
    ], "the sensor never sees the mold"


def steps_of(*changes: str) -> str:
    return "\n".join(markdown.steps(sheet.figures(fsr400(*changes), VOLUMES, MATERIALS["addition_40a"])))


def test_only_a_tail_that_leaves_the_mold_needs_its_passage_filled() -> None:
    assert "passage around the tail" in steps_of()
    assert "passage around the tail" not in steps_of("sensor.model=fsr400_short", "bone.base_length_mm=15")
    assert "passage around the tail" not in steps_of("mold.method=sleeve")


@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_the_caster_is_told_to_hold_what_would_lean(method: str) -> None:
    design = fsr400(f"mold.method={method}")
    told = steps_of(f"mold.method={method}")
    left = min_thickness_held(design, design.dimensions)
    assert f"{left:.2f}".rstrip("0").rstrip(".") + " mm of silicone at least" in told
    assert "could lean by 2.1 degrees and leave" in told, "2 x 0.15 mm of play in a recess of 8 mm"
    assert "two narrow sides" in told
    assert told.index("centre it") < told.index("Weigh") < told.index("two narrow sides")


def test_a_name_that_finds_no_room_is_to_be_written() -> None:
    long, short = (
        markdown.warnings(sheet.figures(fsr400(f"name={name}"), VOLUMES, MATERIALS["addition_40a"]))
        for name in ("A_very-long_name_with-forty_characters_1", "a")
    )
    assert [told for told in long if "engrave" in told] == [
        "No room to engrave A_very-long_name_with-forty_characters_1 in strokes of 0.4 mm: mark the halves with a pen."
    ]
    assert not any("engrave" in told for told in short)


def test_what_would_touch_the_mold_is_said_to() -> None:
    design = Design.load(design_file("fsr402"))
    told = markdown.steps(sheet.figures(design, VOLUMES, MATERIALS["addition_40a"]))
    assert any("could lean by 2.9 degrees and touch the mold" in step for step in told)


def test_what_stands_on_end_takes_supports_under_its_collar() -> None:
    """The collar's foot is a shelf in the air, wherever it is wider than the base below it."""
    for changes in (["mold.method=sleeve"], ["bone.interface=socket", "bone.base_length_mm=32"]):
        design = fsr400(*changes)
        lying = print_orientations(design)
        assert all(lying[name].supports for name in lying if name in ("bone", "core"))
        assert not any(lying[name].supports for name in lying if name.startswith("mold"))


@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_every_printed_part_has_an_orientation(method: str) -> None:
    design = fsr400(f"mold.method={method}")
    printed = {name for name, part in PARTS.items() if part.printed and (name != "core" or method == "sleeve")}
    assert set(print_orientations(design)) == printed


def test_the_figures_in_gcode() -> None:
    code = "G1 X0\n; filament used [cm3] = 2.87\n; estimated printing time (normal mode) = 1h 31m 30s\n"
    assert parse_gcode("bone", code) == PrintEstimate(91.5, 2.87)
    assert minutes("1d 2h 31m 30s") == pytest.approx(1591.5)
    with pytest.raises(GeometryError, match="states no time"):
        parse_gcode("bone", "G1 X0\n")


def test_the_command_writes_page_and_data(tmp_path: Path) -> None:
    done = run_fingertip("sheet", FSR400, "--set", "name=mine", "--json", "--quiet", PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    page = (tmp_path / "out" / "mine" / "casting.md").read_text()
    assert data.pop("page") == str(Path("out/mine/casting.md"))
    assert page == markdown.page(data)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["casting.md"]
    other = tmp_path / "other.md"
    again = run_fingertip("sheet", FSR400, "--set", "name=mine", "--out", other, PYTHONHASHSEED="7")
    assert again.returncode == 0, again.stderr
    assert other.read_text() == page, "the same design gives the same bytes"


def test_a_build_brings_the_same_sheet(built: Build, tmp_path: Path) -> None:
    """In the report as data, and as the page the command alone would write."""
    done = run_fingertip("sheet", design_file(built.design.name), "--out", tmp_path / "casting.md", "--json")
    told = json.loads(done.stdout)
    told.pop("page")
    assert json.loads((built.folder / "report.json").read_text())["casting"] == told
    assert (built.folder / "casting.md").read_bytes() == (tmp_path / "casting.md").read_bytes()


def test_no_sheet_where_parts_are_left_out(tmp_path: Path) -> None:
    result = build(Design(), tmp_path, parts=["skin"], formats=["stl"], tolerance_mm=0.1)
    assert "casting" not in result.report()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["design.toml", "report.json", "skin.stl"]


def test_an_unknown_silicone_is_refused_before_anything_is_built(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="there is no 'latex'"):
        build(Design(), tmp_path / "out", material="latex")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [(["--material", "adition_40a"], "did you mean addition_40a?"), (["--set", "skin.width_mm=5"], "skin.width_mm")],
)
def test_bad_input_exits_2_and_writes_nothing(tmp_path: Path, arguments: list[str], sentence: str) -> None:
    done = run_fingertip("sheet", FSR400, *arguments, PWD=str(tmp_path))
    assert done.returncode == 2
    assert sentence in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_without_a_slicer_the_sheet_says_how_to_get_one(tmp_path: Path) -> None:
    page = tmp_path / "casting.md"
    done = run_fingertip("sheet", FSR400, "--slicer", "--out", page, PATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert HOW_TO_INSTALL in done.stderr
    assert HOW_TO_INSTALL in page.read_text()


def test_the_real_slicer_gives_times(tmp_path: Path) -> None:
    require_tool("prusa-slicer", "apt-get install prusa-slicer")
    page = tmp_path / "casting.md"
    done = run_fingertip("sheet", FSR400, "--slicer", "--out", page, "--json", "-q")
    assert done.returncode == 0, done.stderr
    printing = json.loads(done.stdout)["printing"]
    assert all(10 < part["minutes"] < 600 and 1 < part["filament_cm3"] < 60 for part in printing["parts"])
    assert printing["minutes"] == sum(part["minutes"] for part in printing["parts"])
    assert HOW_TO_INSTALL not in page.read_text()


def test_what_the_slicer_cannot_read_is_said() -> None:
    slicer = require_tool("prusa-slicer", "apt-get install prusa-slicer")
    with pytest.raises(GeometryError, match="bone: was not sliced"):
        slice_part(slicer, "bone", b"no STL at all", print_orientations(fsr400())["bone"])
