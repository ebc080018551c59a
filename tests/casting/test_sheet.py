"""The casting sheet: its data, and that the page states no other number. `tests/documents` holds approved pages."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.settings import FDM
from fingertip.cad.printing.slicer import (
    HOW_TO_INSTALL,
    PrintEstimate,
    parse_duration_min,
    parse_gcode,
    slice_plate,
)
from fingertip.cad.report import Build
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification.bone import FILAMENT_CHECK, check_strength
from fingertip.cad.verification.check import list_warnings
from fingertip.cad.verification.mold import check_filling
from fingertip.cad.verification.strength import assess_strength
from fingertip.casting.consumables import flat_width_mm, uses_adhesive
from fingertip.casting.quantities import SiliconeVolumes, pose_tolerance_deg, volumes_data
from fingertip.catalogues.hardware import select_thread
from fingertip.catalogues.silicones import SILICONES, MaterialProperty
from fingertip.design import Design
from fingertip.design.geometry.seat import find_losses
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import CrossBolted
from fingertip.design.new_design import PRESETS
from fingertip.documents.acceptance import acceptance_data, render_acceptance
from fingertip.documents.casting.sheet import casting_sheet_data, render_sheet, steps
from fingertip.filling.mold_filling import MAX_AIR_MM3
from fingertip.filling.vents import find_pose, place_vents
from fingertip.foundation.errors import DesignError, GeometryError
from fingertip.tasks.build import build
from tests.conftest import DESIGNS, design_file, run_fingertip
from tests.tools import require_tool

FSR400 = design_file("fsr400")
POURED = Design.load(FSR400, changes=["mold.filling=gravity"])
SOCKET = ("bone.interface=socket", "bone.base_length_mm=32")
VOLUMES = SiliconeVolumes(12.625, 0.5, 0.125)
PRINTS = {name: PrintEstimate(31.4 + i, 2.87 + i) for i, name in enumerate(PARTS)}


def warnings(data: dict[str, Any]) -> list[str]:
    return render_sheet(data).split("## Warnings\n\n")[1].split("\n\n")[0].splitlines()


def fsr400(*changes: str) -> Design:
    return Design.load(FSR400, changes=changes)


def sheet_data(*changes: str, material: str = "addition_40a") -> dict[str, Any]:
    return casting_sheet_data(fsr400(*changes), VOLUMES, SILICONES[material])


def leaf_values(data: Any) -> Iterator[Any]:
    if isinstance(data, dict):
        for value in data.values():
            yield from leaf_values(value)
    elif isinstance(data, list):
        for value in data:
            yield from leaf_values(value)
    else:
        yield data


def numbers_missing_from_data(page: str, data: dict[str, Any]) -> list[str]:
    """Numbers on the page that are not numbers in the data. Names from the data, which contain digits, do not count."""
    for name in sorted({v for v in leaf_values(data) if isinstance(v, str)} | {HOW_TO_INSTALL}, key=len, reverse=True):
        page = page.replace(name, "")
    page = re.sub(r"^\d+\. ", "", page, flags=re.MULTILINE)
    page = re.sub(r"\bM(?=\d)", "", page)
    known = {float(v) for v in leaf_values(data) if isinstance(v, (int, float)) and not isinstance(v, bool)}
    return [token for token in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", page) if float(token) not in known]


@pytest.mark.parametrize("prints", [None, PRINTS], ids=["unsliced", "sliced"])
@pytest.mark.parametrize("material", SILICONES)
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_every_number_of_the_page_is_in_the_data(
    method: str, material: str, prints: dict[str, PrintEstimate] | None
) -> None:
    data = casting_sheet_data(fsr400(f"mold.method={method}"), VOLUMES, SILICONES[material], prints)
    page = render_sheet(data)
    assert numbers_missing_from_data(page, data) == []
    assert numbers_missing_from_data(page + "\nand 98765 more", data) == ["98765"], "the helper finds a foreign number"
    assert json.loads(json.dumps(data)) == data


def test_masses_are_computed_from_the_volumes() -> None:
    data = sheet_data()
    volumes, batch = data["volumes_cm3"], data["batch"]
    assert volumes["total"] == pytest.approx(13.25)
    assert batch["in_mold_g"] == pytest.approx(13.25 * 1.08)
    assert batch["total_g"] == pytest.approx(1.25 * 13.25 * 1.08, abs=0.1)
    assert batch["a_g"] + batch["b_g"] == pytest.approx(batch["total_g"], abs=1e-9)
    assert batch["a_g"] / batch["b_g"] == pytest.approx(10.0, rel=0.01)


def test_mold_made_for_another_shrinkage_is_warned_of_with_the_change_to_build() -> None:
    (warning,) = (w for w in warnings(sheet_data(material="condensation_40a")) if "shrinkage" in w)
    change = re.search(r"--set (\S+)`", warning)
    assert change
    rebuilt = sheet_data(change[1], material="condensation_40a")
    assert not any("shrinkage" in warning for warning in warnings(rebuilt))


@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
def test_tape_over_the_sensor_covers_its_pocket_and_ends_on_the_flat(name: str) -> None:
    design = Design.load(design_file(name))
    dims, data = design.dimensions, casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])
    cover, rim = data["fit"]["cover_tape"], 0.5
    pocket = max(dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm, dims.tail_half_width)
    assert cover["pocket_mm"] == pytest.approx(2 * pocket, abs=0.005)
    (narrow, wide), (short, long) = cover["width_mm"], cover["length_mm"]
    assert 2 * (pocket + rim) - 1e-9 <= narrow <= wide
    assert wide <= flat_width_mm(design, dims.sensor_z) + 1e-9, "it ends on the flat"
    assert short >= dims.sensor_z + pocket + rim + 0.3 - 1e-9, "it covers the pocket if it is laid off the collar"
    assert long >= short + 0.3, "a knife cuts it"
    assert flat_width_mm(design, long) > 0.0, "the longest one ends on the flat"
    assert flat_width_mm(design, cover["flat_end_mm"] + 0.2) == 0.0
    flat = min(flat_width_mm(design, z) for z in np.linspace(0.1, dims.sensor_z, 50))
    assert cover["trim"] == (flat < narrow)


def test_small_batch_is_raised_to_what_a_scale_can_weigh() -> None:
    """13.25 cm3 need more than 11 g, the least that can be weighed in parts of 10 to 1; 2 cm3 do not."""
    large = sheet_data()["batch"]
    small = casting_sheet_data(POURED, SiliconeVolumes(2.0, 0.0, 0.0), SILICONES["addition_40a"])["batch"]
    assert (large["with_waste_g"], large["is_raised"]) == (17.9, False)
    assert (small["with_waste_g"], small["is_raised"], small["total_g"], small["lighter"]) == (2.7, True, 11, "part B")


def test_a_syringe_is_loaded_with_more_than_the_mold_takes() -> None:
    """What stays in the syringe is mixed too, and so are the test of the cure and the patch."""
    small = casting_sheet_data(fsr400(), SiliconeVolumes(2.0, 0.0, 0.0), SILICONES["dragon_skin_30"])
    load_cm3 = small["filling"]["load_cm3"]
    assert load_cm3 > 2.0
    assert small["batch"]["total_g"] == pytest.approx(1.25 * load_cm3 * 1.08, rel=0.02)
    assert small["batch"]["buy_g"] >= 3 * small["batch"]["total_g"]
    without_patch = sheet_data("mold.chaplet_diameter_mm=0", "mold.fit_clearance_mm=0.01", "printer.surface_error_mm=0")
    assert without_patch["batch"]["mixtures"] == 2


def test_equal_parts_are_weighed_alike() -> None:
    data = sheet_data(material="dragon_skin_30")
    assert data["batch"]["a_g"] == data["batch"]["b_g"] == pytest.approx(1.25 * 13.25 * 1.08 / 2, abs=0.05)
    tiny = casting_sheet_data(POURED, SiliconeVolumes(0.5, 0.0, 0.0), SILICONES["dragon_skin_30"])
    assert (tiny["batch"]["total_g"], tiny["batch"]["lighter"]) == (2, "each component")


def test_the_lighter_component_is_named_even_if_it_is_the_first() -> None:
    one, ten = (MaterialProperty(value, value, "design") for value in (1.0, 10.0))
    silicone = replace(SILICONES["addition_40a"], parts_a=one, parts_b=ten)
    batch = casting_sheet_data(fsr400(), SiliconeVolumes(2.0, 0.0, 0.0), silicone)["batch"]
    assert (batch["total_g"], batch["a_g"], batch["b_g"], batch["lighter"]) == (11, 1, 10, "part A")


def test_ratio_by_volume_is_converted_where_the_densities_are_known() -> None:
    assert sheet_data(material="mold_star_30")["silicone"]["ratio"]["assumed_by_weight"]
    assert not sheet_data(material="dragon_skin_30")["silicone"]["ratio"]["assumed_by_weight"]
    thin, thick = (MaterialProperty(value, value, "design") for value in (1.0, 1.2))
    silicone = replace(SILICONES["mold_star_30"], density_a_g_cm3=thick, density_b_g_cm3=thin)
    data = casting_sheet_data(fsr400(), VOLUMES, silicone)
    assert data["silicone"]["ratio"]["parts_by_weight"] == [1.2, 1.0]
    assert data["batch"]["a_g"] / data["batch"]["b_g"] == pytest.approx(1.2, rel=0.01)
    assert numbers_missing_from_data(render_sheet(data), data) == []


@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_least_skin_is_that_of_the_worst_seat(method: str) -> None:
    design = fsr400(f"mold.method={method}")
    least_mm = min(loss.left_mm for loss in find_losses(design, design.dimensions))
    assert sheet_data(f"mold.method={method}")["fit"]["min_skin_held_mm"] == round(least_mm, 2)


@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
def test_pose_of_the_filling_is_the_direction_that_was_found(name: str) -> None:
    """The stated tilt of the tip, face and roll give back the vertical."""
    design = Design.load(design_file(name))
    data = casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])
    text = next(step.text for step in steps(data) if step.picture == "fill")
    found = re.search(r"tip (\d+) degrees (above|below) the horizontal, its (dorsal|palmar) face up", text)
    assert found
    tip = math.radians(int(found[1])) * (1 if found[2] == "above" else -1)
    rolled = re.search(r"rolled by (\d+) degrees about its length, so that the side of the syringe is (\w+)", text)
    roll = math.radians(int(rolled[1])) if rolled else 0.0
    assert design.mold_layout.inlet
    syringe_side = math.copysign(1.0, design.mold_layout.inlet.x)
    x = math.cos(tip) * math.sin(roll) * syringe_side * (1 if rolled and rolled[2] == "higher" else -1)
    y = math.cos(tip) * math.cos(roll) * (1 if found[3] == "dorsal" else -1)
    assert np.dot((x, y, math.sin(tip)), data["filling"]["up"]) > math.cos(math.radians(4.0))


@pytest.mark.parametrize("skin", [0.0, 2.6064, 2.6049, 12.625])
def test_volumes_add_up_as_they_are_printed(skin: float) -> None:
    volumes = volumes_data(SiliconeVolumes(skin, 0.1284, 0.0176))
    assert volumes["skin"] + volumes["runners"] + volumes["gap"] == pytest.approx(volumes["total"], abs=1e-9)
    assert volumes["total"] == pytest.approx(skin + 0.146, abs=0.005)
    assert volumes["skin"] == pytest.approx(skin, abs=0.01)


def test_silicone_in_the_syringe_is_weighed() -> None:
    data = sheet_data()
    assert data["batch"]["load_g"] == pytest.approx(1.08 * data["filling"]["load_cm3"], abs=0.1)
    poured = sheet_data("mold.filling=gravity", "silicone.product=sylgard_184")
    assert poured["filling"]["load_cm3"] is None


@pytest.mark.full
def test_generic_silicone_names_a_product_of_the_catalogue() -> None:
    """It cures alike and is as hard; a product needs no example."""
    assert sheet_data()["silicone"]["example"]["name"] == "smooth_sil_940"
    for name in SILICONES:
        if name != "addition_40a":
            assert sheet_data(material=name)["silicone"]["example"] is None, name


def test_bolts_that_stand_out_are_named() -> None:
    data = sheet_data()
    layout = fsr400().mold_layout
    height = layout.dorsal_height + layout.palmar_height
    assert data["mold"]["bolts_stand_out_mm"] == pytest.approx(25.0 - height, abs=0.05)


def test_cross_bolt_passes_bore_walls_and_nut_and_its_hole_has_a_place() -> None:
    for changes in ((), SOCKET):
        design = fsr400(*changes)
        mounting, thread = sheet_data(*changes)["mounting"], select_thread(design.bone.cross_bolt_diameter_mm)
        bolt = mounting["bolt"]
        half_width = design.dimensions.bone_outline.section.half_width
        crossed = 2 * half_width if changes else design.bone.post_width_mm + mounting["play_mm"]
        outside = crossed + bolt["walls"] * bolt["wall_mm"]
        assert bolt["length_mm"] >= outside + thread.nut_height_mm - 0.05, "the nut is full"
        interface = interface_of(design)
        assert isinstance(interface, CrossBolted)
        from_mm = abs(interface.cross_bolt_z(design) + design.bone.base_length_mm)
        assert bolt["from_mm"] == round(from_mm, 2)


def test_bone_of_filament_is_a_dummy_only_where_the_check_warns() -> None:
    design = fsr400()
    checks = check_strength(design, assess_strength(design, MeshEvaluator(0.2)))
    assert any(check.name == FILAMENT_CHECK and check.warning for check in checks)
    data = casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"], None, list_warnings(checks))
    assert data["filament_bone_breaks"]
    assert not sheet_data()["filament_bone_breaks"]


@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger"])
def test_tilt_within_the_tolerance_of_the_pose_traps_less_air_than_the_check_lets_pass(name: str) -> None:
    """The cap above the vent, integrated over the cavity for tilts in eight directions."""
    design = Design.load(design_file(name))
    tolerance, outer = pose_tolerance_deg(design), design.dimensions.outer
    assert tolerance
    (x, _, z), up = place_vents(design)[0].point_mm, np.array(find_pose(design))
    at_vent = np.array((x, outer.dorsal_height_at(x, z), z))
    offsets = np.linspace(-8.0, 8.0, 65)
    heights = np.array([[outer.dorsal_height_at(x + i, z + k) for k in offsets] for i in offsets])
    right = np.cross(up, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    across = np.cross(up, right)

    def trapped_mm3(angle_deg: float) -> float:
        found, angle = 0.0, math.radians(angle_deg)
        for way in np.arange(8) * math.pi / 4:
            tilted = up * math.cos(angle) + math.sin(angle) * (right * math.cos(way) + across * math.sin(way))
            grid_x, grid_z = np.meshgrid(x + offsets, z + offsets, indexing="ij")
            plane = (at_vent @ tilted - tilted[0] * grid_x - tilted[2] * grid_z) / tilted[1]
            above = np.where(heights > 0.0, np.maximum(0.0, heights - plane), 0.0)
            found = max(found, float(above.sum() * (offsets[1] - offsets[0]) ** 2))
        return found

    assert 0.4 * MAX_AIR_MM3 < trapped_mm3(tolerance) < MAX_AIR_MM3
    data = casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])
    assert data["filling"]["pose_tolerance_deg"] == math.floor(tolerance)


@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger"])
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_plan_waits_for_every_cure(name: str, method: str) -> None:
    design = Design.load(design_file(name), changes=[f"mold.method={method}"])
    data = casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])
    plan = data["plan"]
    assert [stage["day"] for stage in plan] == sorted({stage["day"] for stage in plan}), "one stage a day"
    cures = [stage for stage in plan if "cure of the silicone: 24 h" in stage["wait"]]
    assert len(cures) == data["batch"]["mixtures"], "one cure for each mixture"
    assert any("as its maker says" in stage["wait"] for stage in plan) == uses_adhesive(data)
    works = " ".join(stage["work"] for stage in plan)
    order = ["try all parts", *(["prime"] if method == "overmold" else []), "mix "]
    assert [works.index(part) for part in order] == sorted(works.index(part) for part in order)
    assert works.count("mount and wire the sensor") == 1
    slow = replace(SILICONES["addition_40a"], cure_h=MaterialProperty(30.0, 30.0, "design"))
    later = casting_sheet_data(design, VOLUMES, slow)["plan"]
    assert later[-1]["day"] == plan[-1]["day"] + 2, "the test of the cure and the skin take a day more each"


def test_force_of_the_check_stands_beside_the_thumb_force() -> None:
    (check,) = (check for check in check_filling(fsr400()) if check.name == "mold.syringe_force")
    assert sheet_data()["filling"]["min_force_n"] == round(check.value, 1)


def test_filling_follows_the_viscosity() -> None:
    filling, thin = sheet_data()["filling"], sheet_data(material="ecoflex_00_30")["filling"]
    assert 5 <= filling["fill_s"] <= 30
    assert filling["load_cm3"] > filling["injected_cm3"]
    assert thin["fill_s"] < filling["fill_s"] / 5
    assert thin["min_force_n"] == pytest.approx(filling["min_force_n"] * 3 / 35, abs=0.05), "3 Pa s instead of 35"


@pytest.mark.full
def test_name_too_long_to_engrave_is_warned_of() -> None:
    long_name = "A_very-long_name_with-forty_characters_1"
    data = sheet_data(f"name={long_name}")["mold"]
    assert (data["not_engraved"], data["min_stroke_mm"]) == ([long_name], 0.4)
    assert sheet_data("name=a")["mold"]["not_engraved"] == []


def test_parts_printed_on_end_need_supports_under_the_collar() -> None:
    """The foot of the collar overhangs wherever it is wider than the base below it."""
    for changes in (["mold.method=sleeve"], ["bone.interface=socket", "bone.base_length_mm=32"]):
        design = fsr400(*changes)
        orientations = print_orientations(design)
        assert all(orientations[name].needs_supports for name in orientations if name in ("bone", "core"))
        assert not any(orientations[name].needs_supports for name in orientations if name.startswith("mold"))


@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_parts_with_places_for_supports_are_those_that_need_them(name: str, method: str) -> None:
    design = Design.load(design_file(name), changes=[f"mold.method={method}"])
    orientations, supports = print_orientations(design), supports_by_part(design)
    assert list(supports) == list(orientations)
    assert {part for part, one in supports.items() if one.places} == {
        part for part, orientation in orientations.items() if orientation.needs_supports
    }


@pytest.mark.parametrize("name", ["fsr400", "fsr400_compact", "adult_finger"])
def test_print_settings_cover_every_part_for_both_processes(name: str) -> None:
    data = casting_sheet_data(Design.load(design_file(name)), VOLUMES, SILICONES["addition_40a"])
    settings, parts = data["printing"]["settings"], {part["part"]: part for part in data["printing"]["parts"]}
    assert {*settings["supports_on"], *settings["no_supports_on"]} == set(parts)
    assert settings["supports_on"] == [part for part in parts if parts[part]["needs_supports"]]
    fdm = settings["fdm"]
    assert {*fdm["brim_on"], *fdm["no_brim_on"]} == set(parts) == set(fdm["infill_percent"])
    assert "bone" in fdm["brim_on"]
    assert fdm["infill_percent"]["bone"] == 100, "its strength is computed for a solid"
    assert 2 * fdm["brim_mm"] < FDM.gap_mm
    assert ("lid" in settings["no_supports_on"]) == (name == "adult_finger")


@pytest.mark.full
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger", "child_thumb"])
@pytest.mark.parametrize("filling", ["syringe", "gravity"])
def test_list_to_buy_holds_what_the_procedure_uses_and_nothing_else(name: str, method: str, filling: str) -> None:
    changes = [f"mold.method={method}", f"mold.filling={filling}", "silicone.product=sylgard_184"]
    try:
        design = Design.load(design_file(name), changes=changes)
    except DesignError:
        pytest.skip("no such design")
    data = casting_sheet_data(design, VOLUMES, SILICONES["sylgard_184"])
    slip = SimpleNamespace(detector="fast", memory_s=0.1, score=None)
    page = render_sheet(data)
    used = page.partition("## Printing")[2] + render_acceptance(acceptance_data(design, slip))  # type: ignore[arg-type]
    bought = {supply["item"]: supply["word"] for supply in data["supplies"]}
    assert [item for item, word in bought.items() if word not in used] == [], "bought, and used by no step"
    known = {supply["item"]: supply["word"] for supply in all_supplies()}
    assert [item for item, word in known.items() if word in used and item not in bought] == [], "used, and not bought"
    assert all(f"| {item} |" in page.partition("## Printing")[0] for item in bought)
    hardware = {
        "mold release": "mold release", "chaplet screw": "screw", "syringe with Luer": "syringe",
        "adhesive film": "adhesive film", "mold bolt": "bolts", "thread or lacing cord": "ie th",
        "insulated wire": "wires", "stranded wire": "wires", "calibration weight": "weight", "joint pin": "pin",
        "tendon": "tendon", "anchor pin": "anchor pin",
    }  # fmt: skip
    for entry in data["bill"]:
        words = [word for item, word in hardware.items() if entry["item"].startswith(item)]
        assert all(word in used for word in words), entry


def all_supplies() -> list[dict[str, Any]]:
    """Consumables and tools of a straight and of a folded tail."""
    both = (Design.load(design_file(name)) for name in ("fsr400", "adult_finger"))
    found = [casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])["supplies"] for design in both]
    return [*found[0], *found[1]]


def test_one_pot_life_is_planned_with() -> None:
    """It is the least of the range, but no less than is asked for when the silicone is bought."""
    design, filling = fsr400(), sheet_data()["filling"]
    assert design.silicone.material.planned_pot_life_min == 20.0
    (limit,) = (check.limit for check in check_filling(design) if check.name == "mold.fill_time")
    assert limit == 600.0
    assert (filling["pot_life_min"], filling["prepare_min"], filling["limit_min"]) == (20, 10, 10)
    own = fsr400("silicone.product=own", "silicone.pot_life_min=8")
    short = casting_sheet_data(own, VOLUMES, own.silicone.material)["filling"]
    assert (short["pot_life_min"], short["prepare_min"], short["wanted_pot_life_min"]) == (8, 4, 20)


@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_every_printed_part_has_an_orientation(method: str) -> None:
    design = fsr400(f"mold.method={method}")
    printed = {name for name, part in parts_by_name(design).items() if part.is_printed}
    assert set(print_orientations(design)) == printed


def test_time_and_filament_of_each_plate_and_of_all_are_stated() -> None:
    prints = {"first": PrintEstimate(90.4, 20.04), "second": PrintEstimate(31.6, 2.98)}
    data = casting_sheet_data(fsr400(), VOLUMES, SILICONES["addition_40a"], prints)
    assert data["printing"]["plates"] == [
        {"plate": "first", "minutes": 90, "filament_cm3": 20.0},
        {"plate": "second", "minutes": 32, "filament_cm3": 3.0},
    ]
    assert (data["printing"]["minutes"], data["printing"]["filament_cm3"]) == (122, 23.0)


def test_estimates_are_read_from_gcode() -> None:
    code = "G1 X0\n; filament used [cm3] = 2.87\n; estimated printing time (normal mode) = 1h 31m 30s\n"
    assert parse_gcode("bone", code) == PrintEstimate(91.5, 2.87)
    assert parse_duration_min("1d 2h 31m 30s") == pytest.approx(1591.5)
    with pytest.raises(GeometryError, match="states no print time"):
        parse_gcode("bone", "G1 X0\n")


@pytest.mark.full
def test_command_writes_page_and_data(tmp_path: Path) -> None:
    done = run_fingertip("sheet", FSR400, "--set", "name=mine", "--json", "--quiet", PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    page = (tmp_path / "out" / "mine" / "casting.md").read_text()
    assert (data.pop("page"), data.pop("pictures")) == (str(Path("out/mine/casting.md")), [])
    assert page == render_sheet(data)
    assert sorted(path.name for path in tmp_path.rglob("*") if path.is_file()) == ["casting.md", "manifest.json"]
    other = tmp_path / "other.md"
    again = run_fingertip("sheet", FSR400, "--set", "name=mine", "--out", other, PYTHONHASHSEED="7")
    assert again.returncode == 0, again.stderr
    assert other.read_text() == page, "the same design gives the same bytes"


@pytest.mark.full
def test_build_writes_the_same_sheet_as_the_command(built: Build, tmp_path: Path) -> None:
    """The report holds the sheet's data, and the page equals the one `fingertip sheet` writes."""
    done = run_fingertip("sheet", design_file(built.design.name), "--out", tmp_path / "casting.md", "--json")
    data = json.loads(done.stdout)
    assert (data.pop("page"), data.pop("pictures")) == (str(tmp_path / "casting.md"), [])
    assert json.loads((built.folder / "report.json").read_text())["casting"] == data
    assert (built.folder / "casting.md").read_bytes() == (tmp_path / "casting.md").read_bytes()


OWN = (
    "silicone.product=own", "silicone.label=Rubber 37", "silicone.parts_a=1", "silicone.parts_b=1",
    "silicone.ratio_by=volume", "silicone.density_g_cm3=1.2", "silicone.viscosity_pa_s=9",
)  # fmt: skip


@pytest.mark.full
def test_own_silicone_goes_through_sheet_and_build(tmp_path: Path) -> None:
    changes = [word for change in OWN for word in ("--set", change)]
    page = tmp_path / "own.md"
    done = run_fingertip("sheet", FSR400, *changes, "--out", page, "--json", "-q")
    assert done.returncode == 0, done.stderr
    batch = json.loads(done.stdout)["batch"]
    assert batch["a_g"] == batch["b_g"]
    loaded = json.loads(done.stdout)["filling"]["load_cm3"]
    assert batch["with_waste_g"] == pytest.approx(1.25 * 1.2 * loaded, abs=0.1)
    assert "Silicone: Rubber 37." in page.read_text()
    result = build(fsr400(*OWN), tmp_path / "built", formats=["stl"], tolerance_mm=0.1)
    assert "Rubber 37" in (result.folder / "casting.md").read_text()


@pytest.mark.full
def test_option_replaces_the_silicone_of_the_design_in_all_files(tmp_path: Path) -> None:
    result = build(fsr400(*OWN), tmp_path / "built", formats=["stl"], tolerance_mm=0.1, material="dragon_skin_30")
    assert "Silicone: Smooth-On Dragon Skin 30." in (result.folder / "casting.md").read_text()
    again = Design.load(result.folder / "design.toml")
    assert again.silicone.product == "dragon_skin_30", "the same design builds the same sheet again"


def test_build_of_some_parts_writes_no_sheet(tmp_path: Path) -> None:
    result = build(Design(), tmp_path, parts=["skin"], formats=["stl"], tolerance_mm=0.1)
    assert "casting" not in result.report()
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "design.toml", "manifest.json", "report.json", "skin.stl",
    ]  # fmt: skip


def test_unknown_silicone_is_refused_before_anything_is_built(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="there is no 'latex'"):
        build(Design(), tmp_path / "out", material="latex")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--material", "adition_40a"], "did you mean addition_40a?"),
        (["--set", "silicone.product=smoothsil_940"], "Did you mean smooth_sil_940?"),
        (["--set", "skin.width_mm=5"], "skin.width_mm"),
    ],
)
def test_bad_input_exits_2_and_writes_nothing(tmp_path: Path, arguments: list[str], message: str) -> None:
    done = run_fingertip("sheet", FSR400, *arguments, PWD=str(tmp_path))
    assert done.returncode == 2
    assert message in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.full
def test_without_a_slicer_the_sheet_says_how_to_install_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "casting.md"
    monkeypatch.setenv("PATH", str(tmp_path))
    done = run_fingertip("sheet", FSR400, "--slicer", "--out", page)
    assert done.returncode == 0, done.stderr
    assert HOW_TO_INSTALL in done.stderr
    assert HOW_TO_INSTALL in page.read_text()


@pytest.mark.full
def test_prusa_slicer_gives_plausible_estimates(tmp_path: Path) -> None:
    require_tool("prusa-slicer", "apt-get install prusa-slicer")
    page = tmp_path / "casting.md"
    done = run_fingertip("sheet", FSR400, "--slicer", "--out", page, "--json", "-q")
    assert done.returncode == 0, done.stderr
    printing = json.loads(done.stdout)["printing"]
    assert [plate["plate"] for plate in printing["plates"]] == ["plate_fdm"]
    assert all(60 < plate["minutes"] < 1200 and 10 < plate["filament_cm3"] < 100 for plate in printing["plates"])
    assert printing["minutes"] == sum(plate["minutes"] for plate in printing["plates"])
    assert f"| plate_fdm | {printing['minutes']} min |" in page.read_text()
    assert HOW_TO_INSTALL not in page.read_text()


def test_plate_that_cannot_be_sliced_is_reported() -> None:
    slicer = require_tool("prusa-slicer", "apt-get install prusa-slicer")
    with pytest.raises(GeometryError, match="plate_fdm: PrusaSlicer could not slice it"):
        slice_plate(slicer, "plate_fdm", b"no 3MF at all", fsr400())
