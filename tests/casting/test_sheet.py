"""The casting sheet: its data, and that the page states no other number. `tests/documents` holds approved pages."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip.cad.printing.slicer import HOW_TO_INSTALL, PrintEstimate
from fingertip.cad.report import Build
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.consumables import AIDS, flat_width_mm
from fingertip.casting.quantities import SiliconeVolumes, pose_tolerance_deg
from fingertip.catalogues.silicones import load_silicones
from fingertip.design import Design
from fingertip.design.new_design import PRESETS
from fingertip.documents.acceptance import acceptance_data, render_acceptance
from fingertip.documents.casting.sheet import casting_sheet_data, render_sheet
from fingertip.filling.mold_filling import MAX_AIR_MM3, find_pose, place_vents
from fingertip.tasks.build import build
from tests.conftest import DESIGNS, design_file, run_fingertip
from tests.drawing.test_printed_sizes import calibrated
from tests.tools import require_tool

SILICONES = load_silicones()

FSR400 = design_file("fsr400")
SOCKET = ("bone.interface=socket", "bone.base_length_mm=32")
VOLUMES = SiliconeVolumes(12.625, 0.5, 0.125)
PRINTS = {name: PrintEstimate(31.4 + i, 2.87 + i) for i, name in enumerate(PARTS)}


def fsr400(*changes: str) -> Design:
    return Design.load(FSR400, changes=changes)


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


@pytest.mark.every_case
@pytest.mark.parametrize("prints", [None, PRINTS], ids=["unsliced", "sliced"])
@pytest.mark.parametrize("material", SILICONES)
def test_every_number_of_the_page_is_in_the_data(material: str, prints: dict[str, PrintEstimate] | None) -> None:
    data = casting_sheet_data(fsr400(), VOLUMES, SILICONES[material], prints)
    page = render_sheet(data)
    assert numbers_missing_from_data(page, data) == []
    assert numbers_missing_from_data(page + "\nand 98765 more", data) == ["98765"], "the helper finds a foreign number"
    assert json.loads(json.dumps(data)) == data


@pytest.mark.every_case
@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
def test_tape_over_the_sensor_covers_its_pocket_and_ends_on_the_flat(name: str) -> None:
    design = Design.load(design_file(name))
    dims, data = design.dimensions, casting_sheet_data(design, VOLUMES, SILICONES["addition_40a"])
    cover, rim = data["fit"]["cover_tape"], min(0.5, design.bone.rim_mm / 2) if design.bone.platform_mm else 0.5
    pocket = max(dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm, dims.tail_half_width)
    assert cover["pocket_mm"] == pytest.approx(2 * pocket, abs=0.005)
    (narrow, wide), (short, long) = cover["width_mm"], cover["length_mm"]
    assert 2 * (pocket + rim) - 1e-9 <= narrow <= wide
    assert wide <= flat_width_mm(design, dims.sensor_z) + 1e-9, "it ends on the flat"
    if design.bone.platform_mm:
        along = math.hypot(dims.ramp[1] - dims.ramp[0], design.bone.platform_mm)
        film = dims.ramp[0] + along + dims.sensor_z - dims.ramp[1]
        assert short >= film + pocket + rim - 1e-9, "it reaches along the ramp to the collar, where it is cut"
        assert 0.0 < cover["neck_mm"] <= 2 * dims.neck_half_width, "it lies on the ramp"
        assert short <= long <= cover["flat_end_mm"] <= film + dims.platform_radius < cover["flat_end_mm"] + 0.1
    else:
        assert long >= short + 0.3, "a knife cuts it"
        assert short >= dims.sensor_z + pocket + rim + 0.3 - 1e-9, "it covers the pocket if it is laid off the collar"
        assert flat_width_mm(design, long) > 0.0, "the longest one ends on the flat"
        assert flat_width_mm(design, cover["flat_end_mm"] + 0.2) == 0.0
    flat = min(flat_width_mm(design, z) for z in np.linspace(0.1, dims.sensor_z, 50))
    assert cover["trim"] == (flat < narrow)


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


@pytest.mark.full
@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger", "child_thumb"])
def test_list_to_buy_holds_what_the_procedure_uses_and_nothing_else(name: str) -> None:
    design = Design.load(design_file(name))
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
        "adhesive film": "adhesive film", "mold bolt": "bolts", "thread or lacing cord": "turns of thread",
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


@pytest.mark.parametrize(
    ("name", "silicone", "named"),
    [("adult_finger", "addition_40a", {"primer", "lacquer"}), ("adult_finger", "condensation_40a", {"lacquer"}),
     ("fsr400", "condensation_40a", set())],
)  # fmt: skip
def test_primer_and_lacquer_are_named_with_a_source_where_they_are_bought(
    name: str, silicone: str, named: set[str]
) -> None:
    page = render_sheet(casting_sheet_data(Design.load(design_file(name)), VOLUMES, SILICONES[silicone]))
    to_buy, sources = page.partition("## Printing")[0], page.partition("## Silicone data")[2]
    assert {word for word, aid in AIDS.items() if aid["label"] in to_buy} == named
    assert {word for word, aid in AIDS.items() if f"| {aid['source']} |" in sources} == named
    assert ("seal the cavity, never the bone," in page) == (silicone == "addition_40a"), "tin cures on any print"
    faq = (Path(__file__).parents[2] / "docs" / "faq.md").read_text(encoding="utf-8")
    assert all(aid["label"] in faq for aid in AIDS.values())


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
    built = tmp_path / "built"
    build(fsr400(*OWN), built, formats=["stl"], tolerance_mm=0.1)
    assert "Rubber 37" in (built / "casting.md").read_text()
    build(fsr400(*OWN), built, formats=["stl"], tolerance_mm=0.1, material="dragon_skin_30")
    assert "Silicone: Smooth-On Dragon Skin 30." in (built / "casting.md").read_text()
    again = Design.load(built / "design.toml")
    assert again.silicone.product == "dragon_skin_30", "the same design builds the same sheet again"


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


# Figures that a person drills, cuts, buys or weighs, each computed by hand from the design


FIGURES = {
    "fsr400": {
        "fit.max_play_mm": 0.3,  # two gaps of 0.05 mm, each between two surfaces that are off by 0.05 mm
        "fit.paper_mm": 0.1,  # office paper of 80 g/m2
        "fit.papers": 3,
        "fit.tab_room_mm": 2.2,  # half a relief of 5 mm, less 0.3 mm
        "fit.slot_mm": 6.7,  # a tail of 6.4 mm and 0.15 mm on both sides
        "fit.seat_tape.from_mm": 2.0,  # below a collar of 2 mm
        "fit.seat_tape.to_mm": 7.5,  # 0.5 mm before the end of a recess of 8 mm
        "fit.cover_tape.length_mm": [27.1, 27.3],  # 22.5 mm to the sensor, 3.96 of its pocket, 0.3 of rim, 0.33 of ramp
        "chaplet.hole_mm": 2.1,  # a screw M2 passes with 0.1 mm
        "chaplet.pilot_mm": 1.6,  # and cuts its thread into 0.8 of its diameter
        "chaplet.pilot_depth_mm": 4.7,  # two diameters, and 0.7 mm
        "chaplet.needle.gauge": 18,  # 1.27 mm
        "mold.bolt_hole_mm": 3.4,
        "bill.cross bolt (machine screw).crossed_mm": 8.4,  # the width of the post
        "supplies.cups.count": 4,  # one for each of three mixtures, and one to pour into
    },
    "adult_finger": {
        "fit.seat_tape.from_mm": 0.5,  # on a collar of 6.65 mm, 0.5 mm from both ends
        "fit.seat_tape.to_mm": 6.2,
        "bill.anchor pin of the tendon (spring steel wire).diameter_mm": 1.5,  # a hole of 1.72 mm and 0.2 mm of play
        "bill.anchor pin of the tendon (spring steel wire).length_mm": 14.8,  # the chord of the collar there
        "chaplet.length_mm": 12.0,  # M2 from 4 mm below the facet at 4.52 mm to less than the face at 12.9 mm
    },
    "fsr400 bone.interface=socket bone.base_length_mm=32": {
        "bill.cross bolt (machine screw).crossed_mm": 13.2,  # a finger of 17 mm less 1.9 mm of skin on both sides
    },
    "fsr400 bone.interface=flange bone.base_length_mm=27": {
        "bill.flange bolt (machine screw).count": 2,  # in one row
        "bill.flange bolt (machine screw).thread_mm": 3.0,
    },
}  # fmt: skip


def figures_data(design: Design) -> dict[str, Any]:
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
    data = figures_data(Design.load(design_file(name), changes=changes))
    assert {path: figure(data, path) for path in FIGURES[case]} == FIGURES[case]
    # Screw and boss hold the tip beside the sensor; play grows towards the apex.
    assert data["fit"]["retained_over_sensor_percent"] > data["fit"]["retained_elsewhere_percent"]


def test_sheet_of_a_calibrated_printer_states_the_same_prints() -> None:
    """Only the model is larger, by what the printer adds: drills, paper, gaps and quantities stay."""
    plain, measured = (figures_data(d) for d in (Design.load(design_file("fsr400")), calibrated("fsr400")))
    for data in (plain, measured):
        data["fit"].pop("cover_tape")  # covers the pocket of the model, which is wider than that of the print
        data["filling"].pop("up")
        assert data["filling"].pop("roll_deg") in (9, 10)
        assert data["filling"].pop("tip_deg") in (32, 34)
        data["supplies"] = [entry for entry in data["supplies"] if "tape over the sensor" not in entry["item"]]
    assert measured == plain
