"""Sets of fingers: files, castings, plates, and what is added up over the fingers."""

from __future__ import annotations

import csv
import io
import json
import re
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fingertip.casting.hardware import bill_of_materials
from fingertip.documents.casting.sheet import casting_sheet_data
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from fingertip.cad.files import threemf
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess, print_orientations
from fingertip.cad.printing.print_files import list_pieces, make_plates
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.check import Check
from fingertip.casting.quantities import compute_batch, measure_volumes
from fingertip.casting.set_plan import CHANGE_S, PATCH_CM3, Mold, plan_castings
from fingertip.catalogues.controllers import NAMES
from fingertip.cli import app
from fingertip.design import Design
from fingertip.design.files import to_toml
from fingertip.design.finger_set import FingerSet, Form, load_set
from fingertip.documents.acceptance import acceptance_data
from fingertip.documents.finger_set.sheets import FormSheets, measure_form, render_sheet, set_data, write_parts_csv
from fingertip.documents.start import render_set_start
from fingertip.firmware.fingers import plan_set
from fingertip.firmware.sources import GRIP_SOURCE, library_sources
from fingertip.foundation.errors import DesignError, FingertipError
from fingertip.foundation.output_set import SetWriter
from fingertip.tasks.verification import verify_sets
from tests.approved import check_figures, check_text
from tests.conftest import ROOT, run_fingertip
from tests.documents.test_approved import APPROVED

FINGER, THUMB = Design.load("adult_finger"), Design.load("adult_thumb")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_set(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text)
    return path


# Files


def test_fingers_of_equal_parameters_are_one_form_and_changes_are_made_in_all() -> None:
    found = load_set("adult_hand", ["board.cutoff_hz=80"])
    assert [(form.design.name, form.fingers) for form in found.forms] == [
        ("adult_thumb", ("thumb",)),
        ("adult_finger", ("index", "middle", "ring", "little")),
    ]
    assert [name for name, _ in found.fingers] == list(NAMES)
    assert {form.design.board.cutoff_hz for form in found.forms} == {80.0}
    assert found.forms[1].design.skin == FINGER.skin


def test_a_finger_may_differ_from_its_design_and_forms_of_one_design_have_names_of_their_own(folder: Path) -> None:
    (folder / "own.toml").write_text('name = "own"\nskin.width_mm = 17\n')
    text = 'name = "mine"\nside = "left"\n'
    for finger, more in (("little", "skin.taper_ratio = 0.95"), ("index", ""), ("ring", "")):
        text += f'[fingers.{finger}]\ndesign = "adult_finger"\n{more}\n'
    found = load_set(write_set(folder, text))
    assert [(form.design.name, form.fingers) for form in found.forms] == [
        ("adult_finger_index", ("index", "ring")),
        ("adult_finger_little", ("little",)),
    ]
    assert [form.design.skin.taper_ratio for form in found.forms] == [0.94, 0.95]
    assert found.side == "left"
    (form,) = load_set(write_set(folder, 'name = "one"\n[fingers.index]\ndesign = "own.toml"\n')).forms
    assert (form.design.name, form.design.skin.width_mm) == ("own", 17.0)


def test_values_in_a_text_are_written_for_each_finger_of_a_form() -> None:
    two = Form(FINGER, ("index", "ring"))
    assert two.name_values("It turns on with a.b_mm=1.5.") == (
        "It turns on with fingers.index.a.b_mm=1.5 fingers.ring.a.b_mm=1.5."
    )
    typed = two.name_values("it passes with --set a.b=9; or change a.c")
    assert typed == "it passes with --set fingers.index.a.b=9 --set fingers.ring.a.b=9; or change a.c"
    assert two.name_values("z = 2.5 mm, a.b") == "z = 2.5 mm, a.b"


def test_terminal_names_values_as_the_set_takes_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """The thumb fails, the fingers warn, and the trial of both has a warning."""
    failed = Check("bone.safety_factor.grip", 0.5, 1.0, "", "at least", remedy="strength.grip_force_n=9")
    warned = Check("pad.turn_on_force", 1.0, 2.0, "N", warning="it turns on with sensor.distance_from_tip_mm=10.35.")
    made = [
        SimpleNamespace(
            parts=SimpleNamespace(
                checks=[check], strength=None, design=design, folder=Path("out"), parts=(), casting=None
            ),
            detection=SimpleNamespace(warnings=["set detector.adc_bits=12"]),
        )
        for check, design in ((failed, THUMB), (warned, FINGER))
    ]
    totals = dict.fromkeys(("fingers", "molds", "fingers_cm3", "molds_cm3", "castings", "mixtures", "cure_h"), 1)
    data = {"totals": totals | {"silicone_g": {"soft": 1.0}}}
    result = SimpleNamespace(forms=made, data=data, board=(), folder=Path("out"), passed=True)
    monkeypatch.setattr("fingertip.tasks.make_set.make_set", lambda *args, **options: result)
    text = CliRunner().invoke(app, ["make", "adult_hand"]).output
    assert "--set fingers.thumb.strength.grip_force_n=9;" in text
    fingers = ("index", "middle", "ring", "little")
    each = " ".join(f"fingers.{finger}.sensor.distance_from_tip_mm=10.35" for finger in fingers)
    assert each in " ".join(text.split())
    assert "warning: set fingers.thumb.detector.adc_bits=12" in text
    assert " ".join(f"fingers.{finger}.detector.adc_bits=12" for finger in fingers) in text


def test_forms_of_one_long_name_have_folders_of_their_own(folder: Path) -> None:
    text = 'name = "mine"\n'
    for finger, ratio in (("index", 0.94), ("middle", 0.95), ("little", 0.945)):
        text += f'[fingers.{finger}]\ndesign = "adult_finger"\nname = "{"n" * 40}"\nskin.taper_ratio = {ratio}\n'
    names = [form.design.name for form in load_set(write_set(folder, text)).forms]
    assert names == [f"{'n' * 33}_{finger}" for finger in ("index", "middle", "little")]


def test_fingers_that_differ_in_their_sensors_share_a_mold_and_keep_their_force_curves(folder: Path) -> None:
    """A calibrated finger is a file of its own, as `fingertip calibrate sensor --out` writes it."""
    curve = FINGER.force_curve.model_copy(update={"curve": "calibrated", "conductance_us": 60.0})
    (folder / "weighed.toml").write_text(to_toml(FINGER.model_copy(update={"force_curve": curve})))
    text = 'name = "mine"\n[fingers.thumb]\ndesign = "adult_thumb"\n[fingers.index]\ndesign = "weighed.toml"\n'
    alike = load_set(write_set(folder, text))
    assert (alike.forms[1].design.force_curve, alike.calibrated) == (curve, {})
    found = load_set(write_set(folder, text + '[fingers.ring]\ndesign = "adult_finger"\n'))
    assert [(form.design.name, form.fingers) for form in found.forms[1:]] == [("adult_finger", ("index", "ring"))]
    assert found.forms[1].design == FINGER
    assert {finger: design.force_curve for finger, design in found.calibrated.items()} == {"index": curve}
    board, fingers = plan_set(found, "teensy40")
    assert (board.board.channels, fingers.names) == (4, ("thumb", "index", "ring"))  # the ring has the fourth place
    assert fingers.designs == (THUMB, found.calibrated["index"], FINGER)
    source = library_sources(board, fingers)[GRIP_SOURCE].decode()
    assert "slip_curve_of[SLIP_FINGERS] = {0, 1, 2}" in source
    sheets = [make_sheets(THUMB, ("thumb",)), make_sheets(FINGER, ("index", "ring"))]
    own = make_sheets(found.calibrated["index"], ("index",)).acceptance
    rows = collect_data("mine", [sheets[0], replace(sheets[1], calibrated={"index": own})], True, found.calibrated)
    lines = [line for line in render_sheet("acceptance", rows).splitlines() if line.startswith(("| index", "| ring"))]
    limits = [[f"{weight['limits_v'][0]:.2f}" for weight in each["weights"]] for each in (own, sheets[1].acceptance)]
    for line, low in zip(lines, limits, strict=True):
        assert all(f"| {volts} to" in line for volts in low)
    assert limits[0] != limits[1]


def test_one_controller_reads_fingers_of_one_board_alone(folder: Path) -> None:
    text = 'name = "mine"\n[fingers.index]\ndesign = "adult_finger"\n[fingers.ring]\ndesign = "adult_finger"\n'
    mixed = load_set(write_set(folder, f"{text}board.cutoff_hz = 80\ndetector.adc_bits = 10\n"))
    with pytest.raises(FingertipError) as caught:
        plan_set(mixed)
    assert [issue.field for issue in caught.value.issues] == ["board", "detector"]
    run = run_fingertip("firmware", "mine.toml", "--fingers", "3")
    assert run.returncode == 2
    assert "--fingers: does not apply to a set" in run.stderr
    write_set(folder, text)
    assert run_fingertip("firmware", "mine.toml", "--out", "library", "--controller", "teensy40").returncode == 0
    assert (
        run_fingertip("firmware", "mine.toml", "--out", "library", "--controller", "teensy40", "--check").returncode
        == 0
    )
    assert '"index", "ring"' in (folder / "library/src/slip_detector.h").read_text()
    readme = (folder / "library/README.md").read_text()
    for row in ("| ring | A2 | A3 |", "| 4 | T2 | analog in: T of index | analog input A0: the detector reads it |",
                "| 10 | T4 | analog in: T of ring | analog input A2: the detector reads it |",
                "| 1 | T1 | analog in: T of thumb | not needed |"):  # fmt: skip
        assert row in readme


def test_everything_that_is_wrong_is_said_at_once(folder: Path) -> None:
    text = 'name = "mine"\n[fingers.toe]\ndesign = "adult_finger"\n[fingers.thumb]\n'
    text += '[fingers.index]\ndesign = "../secret.toml"\n'
    for finger in ("ring", "little"):
        text += f'[fingers.{finger}]\ndesign = "adult_finger"\nskin.width_mm = 5\n'
    with pytest.raises(DesignError) as caught:
        load_set(write_set(folder, text))
    fields = [issue.field for issue in caught.value.issues]
    assert fields == [
        "fingers.toe", "fingers.thumb: design", "fingers.index: design", "fingers.ring, little: skin.width_mm",
    ]  # fmt: skip
    assert "put the file there" in str(caught.value)


@pytest.mark.parametrize(
    ("finger", "field", "told"),
    [
        ('design = "youth_finger"', "hand", "not the same joint of the hand for index / ring"),
        ('design = "fsr400"', "bone.interface", "not the same interface for index / ring"),
        ('design = "adult_finger"\nprinter.bed_x_mm = 200', "printer", "not the same printer for index / ring"),
    ],
)
def test_fingers_of_a_hand_share_joint_interface_and_printer(folder: Path, finger: str, field: str, told: str) -> None:
    text = f'name = "mine"\n[fingers.index]\ndesign = "adult_finger"\n[fingers.ring]\n{finger}\n'
    with pytest.raises(DesignError) as caught:
        load_set(write_set(folder, text))
    assert (field, True) in [(issue.field, told in issue.message) for issue in caught.value.issues]
    if field == "hand":  # a thumb has a joint of its own
        assert len(load_set(write_set(folder, text.replace("ring", "thumb"))).forms) == 2


def test_a_hand_gives_every_finger_its_joint(folder: Path) -> None:
    (folder / "joint.toml").write_text("[hand]\nwidth_mm = 6.4\n")
    text = 'name = "mine"\nhand = "joint.toml"\n[fingers.thumb]\ndesign = "adult_finger"\n'
    (form,) = load_set(write_set(folder, text + '[fingers.index]\ndesign = "adult_finger"\n')).forms
    assert (form.count, form.design.hand.width_mm) == (2, 6.4)
    own = '[fingers.thumb]\ndesign = "adult_finger"\nhand.travel_deg = 50\n'
    (form,) = load_set(write_set(folder, f'name = "mine"\nhand = "joint.toml"\n{own}')).forms
    assert (form.design.hand.width_mm, form.design.hand.travel_deg) == (6.4, 50.0)
    (folder / "joint.toml").unlink()
    (folder / "joint.toml").symlink_to("/etc/hostname")
    with pytest.raises(FingertipError, match="link"):
        load_set(write_set(folder, text))


# Castings


def make_mold(design: Design, fingers: tuple[str, ...], fill_s: float = 60.0) -> Mold:
    return Mold(design, fingers, 2.5, 3.6, fill_s)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 5), st.floats(1.0, 600.0)), min_size=1, max_size=5))
def test_every_finger_is_cast_once_and_no_cup_thickens(forms: list[tuple[int, float]]) -> None:
    molds = [
        make_mold(FINGER, tuple(f"{number} {finger}" for finger in range(count)), fill_s)
        for number, (count, fill_s) in enumerate(forms)
    ]
    plan = plan_castings(molds)
    castings = [casting for cup in plan.cups for casting in cup.castings]
    assert sorted(casting.finger for casting in castings) == sorted(name for mold in molds for name in mold.fingers)
    assert len(plan.rounds) == max(count for count, _ in forms)
    for cups in plan.rounds:
        used = [id(casting.mold) for cup in cups for casting in cup.castings]
        assert len(set(used)) == len(used), "a mold holds one casting at a time"
        for cup, after in zip(cups, [*cups[1:], None], strict=True):
            fills = [casting.mold.fill_s for casting in cup.castings]
            assert fills == sorted(fills, reverse=True)
            assert cup.full_s[-1] == pytest.approx(sum(fills) + CHANGE_S * (len(fills) - 1))
            assert cup.full_s[-1] <= cup.silicone.filling_limit_s
            if after:  # no cup more than needed, as far as the order goes
                assert cup.full_s[-1] + CHANGE_S + after.castings[0].mold.fill_s > cup.silicone.filling_limit_s
            patch_cm3 = PATCH_CM3 * len(cup.patched)
            cast = (2.5 * len(fills) + patch_cm3, 3.6 * len(fills) + patch_cm3)
            assert cup.batch == compute_batch(cup.silicone, *cast)
    patched = [finger for cup in plan.cups for finger in cup.patched]
    patched += [finger for _, _, fingers in plan.patches for finger in fingers]
    assert patched == [
        casting.finger
        for cups in plan.rounds
        for casting in sorted(
            (casting for cup in cups for casting in cup.castings), key=lambda one: molds.index(one.mold)
        )
    ]


def test_one_finger_cures_as_long_as_its_casting_sheet_says_and_takes_as_much() -> None:
    sheet = casting_sheet_data(FINGER, measure_volumes(FINGER, MeshEvaluator(0.1)), FINGER.silicone.material)
    plan = plan_castings([Mold.of_sheet(FINGER, ("index",), sheet)])
    waits = [row["wait"] for row in sheet["plan"] if "cure of the silicone" in row["wait"]]
    assert plan.cure_h == sum(float(wait.split()[-2]) for wait in waits) == 72.0
    mixed_g = sum(batch.total_g for _, batch in plan.mixtures)
    assert mixed_g == pytest.approx(sheet["batch"]["mixtures"] * sheet["batch"]["total_g"])


def test_silicones_do_not_share_a_cup_and_one_that_thickens_too_soon_is_refused() -> None:
    other = FINGER.with_silicone("dragon_skin_30")
    plan = plan_castings([make_mold(FINGER, ("index", "ring")), make_mold(other, ("thumb",))])
    assert [len(cups) for cups in plan.rounds] == [2, 1]
    assert plan.cure_h == 24.0 * 4
    with pytest.raises(DesignError, match=r"silicone\.product: addition_40a must fill the mold of adult_finger within"):
        plan_castings([make_mold(FINGER, ("index",), 601.0)])


# Sums


def make_sheets(design: Design, fingers: tuple[str, ...], delay_s: float | None = 0.01) -> FormSheets:
    """Sheets of a form, from coarse meshes."""
    measured = measure_form(Form(design, fingers), MeshEvaluator(0.2))
    score = SimpleNamespace(delays_s=(delay_s,))
    detection: Any = SimpleNamespace(detector="fast", memory_s=0.1, score=score)
    warnings = ("pad: the sensor turns on late; harder silicone helps.",) if delay_s is None else ()
    accepted = acceptance_data(design, detection)
    return replace(measured, acceptance=accepted, verdict="all checks passed", warnings=warnings)


def collect_data(
    name: str, sheets: list[FormSheets], has_board: bool, calibrated: Mapping[str, Design] = MappingProxyType({})
) -> dict[str, Any]:
    fingers = FingerSet(name, "right", tuple(each.form for each in sheets), calibrated)
    plan = plan_castings([each.mold for each in sheets])
    return set_data(fingers, sheets, plan, {"plate_sla.3mf": ("bone thumb",)}, has_board)


@pytest.fixture(scope="module")
def sheets() -> list[FormSheets]:
    return [make_sheets(THUMB, NAMES[:1]), make_sheets(FINGER, NAMES[1:])]


@pytest.fixture(scope="module")
def data(sheets: list[FormSheets]) -> dict[str, Any]:
    return collect_data("hand", sheets, has_board=True)


def test_the_sheets_of_a_set_are_the_approved_ones(data: dict[str, Any]) -> None:
    """Those of a hand, and those of two fingers in silicones that share no cup."""
    other = FINGER.with_silicone("dragon_skin_30").model_copy(update={"name": "soft"})
    pair = [make_sheets(FINGER, ("index",), None), make_sheets(other, ("ring",), None)]
    every = {"hand": data, "pair": collect_data("pair", pair, has_board=False)}
    for name, found in every.items():
        assert json.loads(json.dumps(found)) == found
        check_figures(APPROVED / f"set_{name}.json", json.dumps(found, indent=1).splitlines(), abs_=1e-3)
        pages = {"overview": "overview", "plan": "casting_plan", "parts": "parts_list", "acceptance": "acceptance"}
        for page, sheet in pages.items():
            check_text(APPROVED / f"set_{name}_{page}.md", render_sheet(sheet, found))
    plates = {name: ("bone thumb",) for name in ("fingers_sla.3mf", "molds_fdm_1.3mf", "molds_sla_1.3mf")}
    board = Design(name="hand", board={"channels": 5})
    check_text(APPROVED / "set_hand_start.md", render_set_start(data | {"plates": plates}, board))
    check_text(APPROVED / "set_pair_start.md", render_set_start(every["pair"] | {"plates": {}}, None))


def test_sums_of_a_set_are_those_of_its_fingers(sheets: list[FormSheets], data: dict[str, Any]) -> None:
    thumb, finger = sheets
    printed = {
        each.form.design.name: sum(v for name, v in each.volumes_cm3.items() if name.startswith("mold"))
        + each.form.count * (each.volumes_cm3["bone"] + each.volumes_cm3["lid"])
        for each in sheets
    }
    totals = data["totals"]
    assert totals["fingers_cm3"] + totals["molds_cm3"] == pytest.approx(sum(printed.values()), abs=0.01)
    cast = thumb.casting["volumes_cm3"]["total"] + 4 * finger.casting["volumes_cm3"]["total"]
    assert totals["cast_cm3"] == pytest.approx(cast, abs=0.005)
    assert (totals["fingers"], totals["molds"], totals["castings"], totals["mixtures"]) == (5, 2, 5, 6)
    cups = [cup for cups in data["plan"]["rounds"] for cup in cups]
    mixtures = [*cups, *data["plan"]["tests"], *data["plan"]["patches"]]
    mixed_g = sum(mass for mixture in mixtures for mass in mixture["components_g"].values())
    assert totals["silicone_g"] == {FINGER.silicone.material.label: pytest.approx(mixed_g, abs=0.1)}
    assert totals["cure_h"] == 144.0
    alone = [each.form.count * each.casting["batch"]["mixtures"] for each in sheets]
    alone_g = sum(n * each.casting["batch"]["total_g"] for n, each in zip(alone, sheets, strict=True))
    text = " ".join((ROOT / "docs/sets.md").read_text().split())
    silicone_g = totals["silicone_g"][FINGER.silicone.material.label]
    assert f"four rounds, {silicone_g:g} g of silicone in six mixtures and six waits of 24 h" in text
    assert f"take {alone_g:g} g in fifteen mixtures" in text
    assert sum(alone) == 15


def test_the_parts_list_adds_up_the_bills_of_the_fingers(sheets: list[FormSheets], data: dict[str, Any]) -> None:
    thumb, finger = (
        {entry["item"]: entry["count"] for entry in bill_of_materials(each.form.design)} for each in sheets
    )
    found: dict[str, int] = {}
    for part in data["parts"]:
        if "note" in part and part["use"] == "bench" and "mass_g" not in part and part["item"][:9] != "mold rele":
            continue  # a consumable
        found[part["item"]] = found.get(part["item"], 0) + part["count"]
    for item in set(thumb) | set(finger):
        each, once = thumb.get(item, 0) + 4 * finger.get(item, 0), thumb.get(item, 0) + finger.get(item, 0)
        expected = {"mold bolt": once, "mold nut ": once, "chaplet s": once, "mold rele": 1, "calibrati": 2}
        assert found[item] == expected.get(item[:9], each), item
    rows = list(csv.DictReader(io.StringIO(write_parts_csv(data).decode())))
    assert len(rows) == len(data["parts"]) + 2 + len(data["totals"]["silicone_g"])  # two materials to print
    assert [part["count"] for part in data["parts"] if part["item"].startswith("syringe of 1 ml")] == [4]
    assert [part["count"] for part in data["parts"] if part["item"] == "vise or stand"] == [2]
    assert {row["item"]: row["count"] for row in rows}["force-sensing resistor"] == "5"


def test_the_plan_tells_each_round_and_what_is_patched_when(data: dict[str, Any]) -> None:
    text = render_sheet("casting_plan", data)
    assert text.count("## Round") == 4
    assert "Last, patch the holes in thumb and index from the same cup." in text
    assert "1.0 g of part B" not in text
    first = text.partition("## Round 2")[0].partition("## Round 1")[2]
    assert "| 1 | adult_thumb | thumb |" in first
    assert "| 2 | adult_finger | index |" in first
    assert "atch" not in first
    assert [stage["day"] for stage in data["calendar"]] == list(range(1, 12))
    assert [stage["work"].partition(":")[0] for stage in data["calendar"][4:8]] == [f"round {k}" for k in range(1, 5)]


def test_plates_hold_every_bone_and_each_mold_once_without_overlap() -> None:
    names = ("bone", "lid", "mold_palmar", "mold_dorsal")
    meshes = {name: MeshEvaluator(0.2).mesh(PARTS[name].solid(FINGER)) for name in names}
    pieces = list_pieces(FINGER, meshes, {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()})
    many = [replace(pieces["bone"], name=f"bone {finger}") for finger in NAMES]
    many += [replace(pieces["lid"], name=f"lid {finger}") for finger in NAMES]
    many += [replace(pieces[name], name=f"{name} {number}") for name in names[2:] for number in range(3)]
    made = make_plates("hand", FINGER.printer, many)
    resin = [plate for file, plate in made.plates.items() if "sla" in file]
    assert sorted(name for plate in resin for name in plate) == sorted(piece.name for piece in many)
    bed = np.array([FINGER.printer.bed_x_mm, FINGER.printer.bed_y_mm])
    for file, plate in made.plates.items():
        boxes = []
        for item in threemf.read_items(made.contents[file]):
            placed = meshes[item.name.partition(" ")[0]].vertices @ item.rotation.T + np.array(item.shift)
            boxes.append((placed.min(axis=0)[:2], placed.max(axis=0)[:2]))
        assert len(boxes) == len(plate)
        gap_mm = 2.5 if "sla" in file else 5.0
        for i, (low, high) in enumerate(boxes):
            assert (low >= -1e-3).all()
            assert (high <= bed + 1e-3).all()
            gaps = [np.maximum(low - other_high, other_low - high).max() for other_low, other_high in boxes[:i]]
            assert min(gaps, default=gap_mm) >= gap_mm - 1e-3


def test_boards_that_differ_or_cannot_be_shared_stay_apart() -> None:
    def board_of(*changes: str, **other: str) -> Design | None:
        designs = [Design.load("adult_thumb", changes=changes), Design.load("adult_finger", changes=changes)]
        if other:
            designs[1] = Design.load("adult_finger", changes=[*changes, *(f"{k}={v}" for k, v in other.items())])
        forms = (Form(designs[0], NAMES[:1]), Form(designs[1], NAMES[1:3]))
        return FingerSet("hand", "right", forms).board_design

    found = board_of()
    assert found is not None
    assert (found.board.channels, found.name) == (3, "hand")
    assert board_of(**{"board.cutoff_hz": "80"}) is None
    assert board_of("board.variant=comparator") is None


# Commands


@pytest.mark.parametrize(
    ("small", "parts"), [("printer.bed_x_mm=30", ("mold_palmar", "mold_dorsal")), ("printer.bed_z_mm=20", ("bone",))]
)
def test_a_bed_that_is_too_small_is_refused_before_work_with_a_remedy_that_holds(
    small: str, parts: tuple[str, ...], folder: Path
) -> None:
    done = run_fingertip("make", "adult_hand", "--set", small, "--quiet")
    assert done.returncode == 2
    assert not (folder / "out").exists()
    remedy = done.stderr.splitlines()[0].rpartition("it fits with --set ")[2]
    assert f"{parts[0]} of adult_thumb exceeds the build volume by" in done.stderr
    thumb = Design.load("adult_thumb", changes=[remedy])
    for name in parts:
        mesh, lies = MeshEvaluator(0.05).mesh(PARTS[name].solid(thumb)), print_orientations(thumb)[name]
        assert -1.2 < build_volume_excess(thumb, mesh, lies.rotate_x_deg) <= 0.0


def test_a_folder_that_leads_elsewhere_or_has_two_uses_is_refused(folder: Path) -> None:
    (folder / "out/adult_hand").mkdir(parents=True)
    (folder / "out/adult_hand/adult_thumb").symlink_to(folder)
    done = run_fingertip("make", "adult_hand", "--quiet")
    assert (done.returncode, "adult_thumb: is a link; remove it." in done.stderr) == (2, True)
    path = write_set(folder, 'name = "mine"\n[fingers.index]\ndesign = "adult_finger"\nname = "board"\n')
    done = run_fingertip("make", path, "--quiet")
    assert done.returncode == 2
    assert "name: board is a folder of every set" in done.stderr


def test_other_commands_name_those_that_take_a_set(tmp_path: Path) -> None:
    done = run_fingertip("build", "adult_hand")
    assert done.returncode == 2
    assert "adult_hand: is a set file, not a design file" in done.stderr
    assert "`fingertip make` and `fingertip check` take a set file" in done.stderr
    path = tmp_path / "mine.toml"
    path.write_text('[fingers.index]\ndesign = "adult_finger"\n')
    assert "give that of one finger, or the set to `fingertip make` or `check`" in run_fingertip("robot", path).stderr


def test_a_set_is_compared_with_its_own_and_each_form_with_its_own(folder: Path) -> None:
    def write(place: str, kind: str, parameters: str) -> None:
        SetWriter(folder / place, kind, "", parameters).write({"a.csv": b"1"})

    write("out", "set", "of the set")
    write("out/print", "set prints", "of the set")
    write("out/board", "board", "of the board")
    write("out/index", "parts", "of the index")
    write("out/index/print", "print", "of the index")
    assert verify_sets(folder / "out") == (5, [])
    write("out/index/signal", "signal", "of another")
    write("out/print", "set prints", "of another")
    _, found = verify_sets(folder / "out")
    told = "was made from other parameters than"
    assert sorted(found) == [
        f"{folder}/out/index/signal: {told} {folder}/out/index; make both again.",
        f"{folder}/out/print: {told} {folder}/out; make both again.",
    ]


@pytest.mark.full
def test_a_set_is_made_whole_and_again_with_the_same_bytes(folder: Path) -> None:
    text = 'name = "pair"\n'
    for finger in ("index", "ring"):
        text += f'[fingers.{finger}]\ndesign = "child_finger"\n'
    write_set(folder, text)
    done = run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--json", "--quiet")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    out = folder / "out/pair"
    assert sorted(path.name for path in out.iterdir() if path.is_dir()) == ["board", "child_finger", "print"]
    assert (result["totals"]["fingers"], result["totals"]["molds"]) == (2, 1)
    plates = [name for file, parts in result["plates"].items() if "sla" in file for name in parts]
    assert sorted(plates) == sorted(
        ["bone index", "bone ring", "lid index", "lid ring", "mold_dorsal child_finger", "mold_palmar child_finger"]
    )
    assert all(parts[0].startswith("mold") == ("molds" in file) for file, parts in result["plates"].items())
    board = run_fingertip("board", out / "board_design.toml", "--check", "--out", out / "board")
    assert board.returncode == 0, board.stdout + board.stderr
    assert "| ring, pin 10 |" in (out / "acceptance.md").read_text()
    assert "do not print these parts" not in (out / "index.html").read_text()
    assert run_fingertip("check", "out/pair").returncode == 0
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--quiet").returncode == 0
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    commands = re.findall(r"`fingertip ([^`]+ --out [^`]+)`", (out / "set.md").read_text())
    assert [command.split()[0] for command in commands] == ["board", "drawing"]
    for command in commands[:1] * bool(shutil.which("kicad-cli")) + commands[1:]:
        done = run_fingertip(*shlex.split(command), PWD=str(out))
        assert done.returncode == 0, done.stderr
    assert not (out / "out").exists(), "nothing is written beside the set"
    (out / "casting_plan.md").write_text("mine\n")
    done = run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--quiet")
    assert done.returncode == 2
    assert "casting_plan.md" in done.stderr
    assert "casting_plan.md: was changed" in run_fingertip("check", "out/pair").stdout
