"""Sets of fingers: files, castings, plates, and what is added up over the fingers."""

from __future__ import annotations

import csv
import io
import math
import re
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType, SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess, print_orientations
from fingertip.cad.verification.check import Check
from fingertip.casting.mixture import mix
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues.electronics import NAMES
from fingertip.cli import app
from fingertip.design import Design
from fingertip.design.design_file import to_toml
from fingertip.design.finger_set import FingerSet, Form, load_set
from fingertip.documents.acceptance import acceptance_sheet
from fingertip.documents.set_sheets import (
    MOLD_MIN,
    STIR_MIN,
    FormSheets,
    SetSheets,
    find_short_pot_lives,
    plan_cups,
    render_sheet,
    set_sheets,
    write_parts_csv,
)
from fingertip.firmware.c_sources import GRIP_SOURCE, library_sources
from fingertip.firmware.fingers import plan_set
from fingertip.foundation.errors import DesignError, FingertipError, OutputError
from fingertip.foundation.output_set import SetWriter
from fingertip.models.parts import PARTS
from fingertip.tasks.make_set import make_set
from fingertip.tasks.manifest_comparison import verify_sets
from tests.approved import check_text
from tests.conftest import ROOT, run_fingertip

APPROVED = ROOT / "tests/documents/approved"
FINGER = Design.load("adult_finger")
THUMB = Design.load("adult_thumb")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_set(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text)
    return path


# Files


def test_changes_are_made_in_all_fingers_of_the_bundled_hand_which_differ_in_size() -> None:
    found = load_set("adult_hand", ["board.cutoff_hz=80"])
    assert [name for name, _ in found.fingers] == list(NAMES)
    assert len(found.forms) == 5
    assert {form.design.board.cutoff_hz for form in found.forms} == {80.0}
    sizes = [(form.design.skin.width_mm, form.design.skin.length_mm) for form in found.forms]
    assert len(set(sizes)) == 5
    assert min(sizes)[0] == 15.0


def test_a_finger_may_differ_from_its_design_and_forms_of_one_design_have_names_of_their_own(
    folder: Path,
) -> None:
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
    (form,) = load_set(
        write_set(folder, 'name = "one"\n[fingers.index]\ndesign = "own.toml"\n')
    ).forms
    assert (form.design.name, form.design.skin.width_mm) == ("own", 17.0)


def test_values_in_a_text_are_written_for_each_finger_of_a_form() -> None:
    two = Form(FINGER, ("index", "ring"))
    assert two.name_values("It turns on with a.b_mm=1.5.") == (
        "It turns on with fingers.index.a.b_mm=1.5 fingers.ring.a.b_mm=1.5."
    )
    typed = two.name_values("it passes with --set a.b=9; or change a.c")
    assert (
        typed == "it passes with --set fingers.index.a.b=9 --set fingers.ring.a.b=9; or change a.c"
    )
    assert two.name_values("z = 2.5 mm, a.b") == "z = 2.5 mm, a.b"


def test_terminal_names_values_as_the_set_takes_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Thumb and fingers fail, and the trial of both has a warning."""
    found = [
        Check(
            "bone.safety_factor.grip", 0.5, 1.0, "", "at least", remedy="strength.grip_force_n=9"
        ),
        Check("pad.turn_on_force", 2.0, 1.0, "N", remedy="sensor.distance_from_tip_mm=10.35"),
    ]
    made = [
        SimpleNamespace(
            parts=SimpleNamespace(
                checks=[check],
                strength=None,
                design=design,
                folder=Path("out"),
                parts=(),
                casting=None,
            ),
            detection=SimpleNamespace(warnings=["set detector.adc_bits=12"]),
        )
        for check, design in zip(found, (THUMB, FINGER), strict=True)
    ]
    sheets = collect_data(
        "hand", [make_sheets(THUMB, NAMES[:1]), make_sheets(FINGER, NAMES[1:])], has_board=True
    )
    result = SimpleNamespace(forms=made, sheets=sheets, board=(), folder=Path("out"), passed=True)
    monkeypatch.setattr("fingertip.tasks.make_set.make_set", lambda *args, **options: result)
    fingers = FingerSet("hand", "right", (Form(THUMB, NAMES[:1]), Form(FINGER, NAMES[1:])))
    monkeypatch.setattr("fingertip.design.finger_set.load_set", lambda *args: fingers)
    text, boards = (
        " ".join(CliRunner().invoke(app, ["make", "adult_hand"]).output.split())
        for result.board in ("", "b")
    )
    assert [" days; one board for all fingers look at" in each for each in (text, boards)] == [
        False,
        True,
    ]
    assert "--set fingers.thumb.strength.grip_force_n=9;" in text
    assert "--set fingers.index.sensor.distance_from_tip_mm=10.35" in text
    assert "warning: set fingers.thumb.detector.adc_bits=12" in text
    assert " ".join(f"fingers.{finger}.detector.adc_bits=12" for finger in NAMES[1:]) in text


def test_forms_of_one_long_name_have_folders_of_their_own(folder: Path) -> None:
    text = 'name = "mine"\n'
    for finger, ratio in (("index", 0.94), ("middle", 0.95), ("little", 0.945)):
        text += (
            f'[fingers.{finger}]\ndesign = "adult_finger"\nname = '
            f'"{"n" * 40}"\nskin.taper_ratio = {ratio}\n'
        )
    names = [form.design.name for form in load_set(write_set(folder, text)).forms]
    assert names == [f"{'n' * 33}_{finger}" for finger in ("index", "middle", "little")]


def test_fingers_that_differ_in_their_sensors_share_a_mold_and_keep_their_force_curves(
    folder: Path,
) -> None:
    """A calibrated finger is a file of its own, as `fingertip calibrate sensor --out` writes it."""
    curve = FINGER.force_curve.model_copy(update={"curve": "calibrated", "conductance_us": 60.0})
    (folder / "weighed.toml").write_text(to_toml(FINGER.model_copy(update={"force_curve": curve})))
    text = (
        'name = "mine"\n[fingers.thumb]\ndesign = "adult_thumb"\n[fingers.index]\ndesign = '
        '"weighed.toml"\n'
    )
    alike = load_set(write_set(folder, text))
    assert (alike.forms[1].design.force_curve, alike.calibrated) == (curve, {})
    found = load_set(write_set(folder, text + '[fingers.ring]\ndesign = "adult_finger"\n'))
    assert [(form.design.name, form.fingers) for form in found.forms[1:]] == [
        ("adult_finger", ("index", "ring"))
    ]
    assert found.forms[1].design == FINGER
    assert {finger: design.force_curve for finger, design in found.calibrated.items()} == {
        "index": curve
    }
    board, fingers = plan_set(found, "teensy40")
    # The ring has the fourth place.
    assert (board.board.channels, fingers.names) == (
        4,
        ("thumb", "index", "ring"),
    )
    assert fingers.designs == (THUMB, found.calibrated["index"], FINGER)
    source = library_sources(board, fingers)[GRIP_SOURCE].decode()
    assert "slip_curve_of[SLIP_FINGERS] = {0, 1, 2}" in source
    sheets = [make_sheets(THUMB, ("thumb",)), make_sheets(FINGER, ("index", "ring"))]
    own = make_sheets(found.calibrated["index"], ("index",)).acceptance
    rows = collect_data(
        "mine", [sheets[0], replace(sheets[1], calibrated={"index": own})], True, found.calibrated
    )
    lines = [
        line
        for line in render_sheet("acceptance", rows).splitlines()
        if line.startswith(("| index", "| ring"))
    ]
    limits = [
        [f"{weight.limits_v[0]:.2f}" for weight in each.weights]
        for each in (own, sheets[1].acceptance)
    ]
    for line, low in zip(lines, limits, strict=True):
        assert all(f"| {volts} to" in line for volts in low)
    assert limits[0] != limits[1]


def test_one_controller_reads_fingers_of_one_board_alone(folder: Path) -> None:
    text = (
        'name = "mine"\n[fingers.index]\ndesign = "adult_finger"\n[fingers.ring]\ndesign = '
        '"adult_finger"\n'
    )
    mixed = load_set(write_set(folder, f"{text}board.cutoff_hz = 80\ndetector.adc_bits = 10\n"))
    with pytest.raises(FingertipError) as caught:
        plan_set(mixed)
    assert [issue.field for issue in caught.value.issues] == ["board", "detector"]
    run = run_fingertip("firmware", "mine.toml", "--fingers", "3")
    assert run.returncode == 2
    assert "--fingers: does not apply to a set" in run.stderr
    write_set(folder, text)
    assert (
        run_fingertip(
            "firmware", "mine.toml", "--out", "library", "--controller", "teensy40"
        ).returncode
        == 0
    )
    assert (
        run_fingertip(
            "firmware", "mine.toml", "--out", "library", "--controller", "teensy40", "--check"
        ).returncode
        == 0
    )
    assert '"index", "ring"' in (folder / "library/src/slip_detector.h").read_text()
    readme = (folder / "library/README.md").read_text()
    for row in (
        "| ring | A2 | A3 |",
        "| 4 | T2 | analog in: T of index | analog input A0: the detector reads it |",
        "| 10 | T4 | analog in: T of ring | analog input A2: the detector reads it |",
        "| 1 | T1 | analog in: T of thumb | not needed |",
    ):
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
        "fingers.toe",
        "fingers.thumb: design",
        "fingers.index: design",
        "fingers.ring, little: skin.width_mm",
    ]
    assert "put the file there" in str(caught.value)


@pytest.mark.parametrize(
    ("finger", "field", "told"),
    [
        ('design = "youth_finger"', "hand", "not the same joint of the hand for index / ring"),
        ('design = "fsr400"', "bone.interface", "not the same interface for index / ring"),
    ],
)
def test_fingers_of_a_hand_share_joint_and_interface(
    folder: Path, finger: str, field: str, told: str
) -> None:
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


# Castings


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.sampled_from([10.0, 17.0, 30.0, 300.0]), min_size=1, max_size=5),
    st.floats(0.5, 9.0),
)
def test_every_mold_is_filled_once_from_as_few_mixtures_as_the_pot_lives_allow(
    lives: list[float], g: float
) -> None:
    own = {"product": "own"}
    fingers = NAMES[: len(lives)]
    silicones = [
        Design.model_validate(
            {"name": "x", "silicone": own | {"pot_life_min": life}}
        ).silicone.material
        for life in lives
    ]
    molds = {
        finger: (silicone, finger, g + number)
        for number, (finger, silicone) in enumerate(zip(fingers, silicones, strict=True))
    }
    cups = list(plan_cups(molds.values()))
    assert sorted(pour.finger for cup in cups for pour in cup.pours) == sorted(fingers)
    for cup in cups:
        filled = [molds[pour.finger] for pour in cup.pours]
        (silicone,) = {silicone for silicone, _, _ in filled}
        assert (
            cup.pours[-1].closed_min
            == STIR_MIN + MOLD_MIN * len(filled)
            <= silicone.planned_pot_life_min
        )
        cm3 = sum(poured_g for _, _, poured_g in filled) / silicone.density_g_cm3.high
        assert cup.total_g == pytest.approx(mix(silicone, cm3).total_g, abs=0.11)
    fewest = (math.ceil(lives.count(life) / ((life - STIR_MIN) // MOLD_MIN)) for life in set(lives))
    assert len(cups) == sum(fewest)


def test_a_silicone_that_thickens_too_soon_is_refused_before_work_with_a_remedy_that_passes(
    folder: Path,
) -> None:
    short = ("--set", "silicone.product=own", "--set", "silicone.pot_life_min=9")
    done = run_fingertip("make", "adult_hand", *short, "--quiet")
    assert (done.returncode, (folder / "out").exists()) == (2, False)
    assert "thickens after 9 min, and to fill the mold of adult_thumb takes 10 min" in done.stderr
    remedy = done.stderr.splitlines()[0].rpartition("it passes with --set ")[2].rstrip(".")
    assert not list(
        find_short_pot_lives(
            load_set("adult_hand", ["silicone.pot_life_min=9", remedy]).designs.values()
        )
    )


# Sums


def count_words(text: str) -> int:
    return sum(any(character.isalnum() for character in word) for word in text.split())


def make_sheets(design: Design, fingers: tuple[str, ...]) -> FormSheets:
    """Sheets of a form, from coarse meshes."""
    casting = casting_sheet(design, MeshEvaluator(0.2))
    return FormSheets(
        Form(design, fingers), casting, acceptance_sheet(design), "all checks passed", {}
    )


def collect_data(
    name: str,
    sheets: list[FormSheets],
    has_board: bool,
    calibrated: Mapping[str, Design] = MappingProxyType({}),
) -> SetSheets:
    fingers = FingerSet(name, "right", tuple(each.form for each in sheets), calibrated)
    return set_sheets(fingers, sheets, has_board)


@pytest.fixture(scope="module")
def sheets() -> list[FormSheets]:
    return [make_sheets(form.design, form.fingers) for form in load_set("adult_hand").forms]


@pytest.fixture(scope="module")
def data(sheets: list[FormSheets]) -> SetSheets:
    return collect_data("hand", sheets, has_board=True)


def test_a_hand_takes_three_days_one_list_and_few_words(data: SetSheets) -> None:
    assert (data.plan.cast_day, data.plan.days) == (2, 3)
    poured = [pour.finger for cup in data.plan.cups for pour in cup.pours]
    assert poured == list(NAMES), "one pour for each mold"
    assert len(data.things) <= 40
    texts = {
        page: render_sheet(page, data)
        for page in ("start", "overview", "plan", "parts", "acceptance")
    }
    for page, text in texts.items():
        check_text(APPROVED / f"set_hand_{page}.md", text)
    assert sum(map(count_words, texts.values())) <= 1200


def test_the_list_to_buy_adds_up_those_of_the_fingers(
    sheets: list[FormSheets], data: SetSheets
) -> None:
    amounts: dict[str, float] = {}
    for thing in data.things:
        found = re.match(r"[\d.]+", thing.amount)
        if found:
            amounts[thing.key] = amounts.get(thing.key, 0.0) + float(found[0])
    assert {thing.key for each in sheets for thing in each.casting.things} == {
        thing.key for thing in data.things
    }
    assert [amounts[key] for key in ("sensor", "wire", "scale", "cup")] == [5, 10, 1, 2]
    assert (
        amounts["filament"]
        == sum(each.casting.printed_g for each in sheets)
        == data.totals.printed_g
    )
    mixed_g = sum(sum(cup.components_g.values()) for cup in data.plan.cups)
    assert amounts["silicone"] == pytest.approx(mixed_g, abs=0.2)
    assert mixed_g > sum(each.casting.batch.in_cup_g for each in sheets)
    rows = list(csv.DictReader(io.StringIO(write_parts_csv(data.things).decode())))
    assert [row["label"] for row in rows] == [thing.label for thing in data.things]


def test_alike_fingers_have_a_mold_each_and_those_without_a_board_a_board_each() -> None:
    alike = make_sheets(FINGER, ("index", "ring"))
    found = collect_data("pair", [alike], has_board=False)
    assert found.plan.print_h == pytest.approx(2 * alike.casting.print_h, abs=0.1)
    (cup,) = found.plan.cups
    assert [pour.finger for pour in cup.pours] == ["index", "ring"]
    assert {thing.key: thing.amount for thing in found.things}["board"] == "2"


def test_boards_that_differ_or_cannot_be_shared_stay_apart() -> None:
    def board_of(*changes: str, **other: str) -> Design | None:
        designs = [
            Design.load("adult_thumb", changes=changes),
            Design.load("adult_finger", changes=changes),
        ]
        if other:
            designs[1] = Design.load(
                "adult_finger", changes=[*changes, *(f"{k}={v}" for k, v in other.items())]
            )
        forms = (Form(designs[0], NAMES[:1]), Form(designs[1], NAMES[1:3]))
        return FingerSet("hand", "right", forms).board_design

    found = board_of()
    assert found is not None
    assert (found.board.channels, found.name) == (3, "hand")
    assert board_of(**{"board.cutoff_hz": "80"}) is None
    assert board_of("board.variant=comparator") is None


# Commands


@pytest.mark.parametrize(
    ("small", "part"),
    [
        pytest.param("printer.bed_x_mm=30", "core", marks=pytest.mark.full),
        ("printer.bed_z_mm=20", "bone"),
    ],
)
def test_a_bed_that_is_too_small_is_refused_before_work_with_a_remedy_that_holds(
    small: str, part: str, folder: Path
) -> None:
    done = run_fingertip("make", "adult_hand", "--set", small, "--quiet")
    assert done.returncode == 2
    assert not (folder / "out").exists()
    remedy = done.stderr.splitlines()[0].rpartition("it fits with --set ")[2]
    assert f"{part} of adult_thumb exceeds the build volume by" in done.stderr
    thumb = load_set("adult_hand", [remedy]).designs["thumb"]
    mesh = MeshEvaluator(0.05).mesh(PARTS[part].solid(thumb))
    lies = print_orientations(thumb)[part]
    assert -1.2 < build_volume_excess(thumb, mesh, lies.rotate_x_deg) <= 0.0


def test_a_folder_that_has_two_uses_is_refused(folder: Path) -> None:
    path = write_set(
        folder, 'name = "mine"\n[fingers.index]\ndesign = "adult_finger"\nname = "board"\n'
    )
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
    assert (
        "give that of one finger, or the set to `fingertip make` or `check`"
        in run_fingertip("drawing", path).stderr
    )


def test_a_set_is_compared_with_its_own_and_each_form_with_its_own(folder: Path) -> None:
    def write(place: str, kind: str, parameters: str) -> None:
        SetWriter(folder / place, kind, "", parameters).write({"a.csv": b"1"})

    write("out", "set", "of the set")
    write("out/board", "board", "of the board")
    write("out/index", "parts", "of the index")
    write("out/index/print", "print", "of the index")
    assert verify_sets(folder / "out") == (4, [])
    write("out/index/signal", "signal", "of another")
    _, found = verify_sets(folder / "out")
    told = "was made from other parameters than"
    assert found == [f"{folder}/out/index/signal: {told} {folder}/out/index; make both again."]


def test_forms_and_board_are_made_with_the_options_of_the_set(
    sheets: list[FormSheets], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What `make`, `plan_board` and the picture take time for is left out."""
    asked = list[object]()
    fingers = FingerSet("hand", "right", tuple(each.form for each in sheets))

    def note(
        design: Design, folder: Path, *, progress: object = None, **options: object
    ) -> SimpleNamespace:
        asked.append((design.name, folder, options))
        parts = SimpleNamespace(design=design, passed=design.name != "adult_thumb")
        return SimpleNamespace(
            parts=parts, write=lambda progress: (folder / "bringup.md", folder / "a.kicad_pcb")
        )

    collected = {each.form.design.name: each for each in sheets}
    for name, stand_in in {
        "make": note,
        "plan_board": note,
        "_collect": lambda fingers, form, made: collected[form.design.name],
        "draw_finger": lambda *args: b"",
        "_refuse_early": lambda fingers: None,
    }.items():
        monkeypatch.setattr(f"fingertip.tasks.make_set.{name}", stand_in)
    out = tmp_path / "hand"
    made = make_set(fingers, out, formats=("stl",), force=True)
    wanted = [(name, out / name, {"formats": ("stl",), "force": True}) for name in collected]
    assert asked == [
        *wanted,
        ("hand", out / "board", {"force": True, "bring_up": True, "top": out}),
    ]
    assert ([form.parts.passed for form in made.forms], made.passed) == (
        [False, *[True] * 4],
        False,
    )
    assert made.sheets == set_sheets(fingers, sheets, has_board=True)
    page = (out / "index.html").read_text()
    links = {
        link for link in re.findall('href="([^"#]+)"', page) if "/" in link and ":" not in link
    }
    own = {
        f"{name}/{file}"
        for name in collected
        for file in ("index.html", collected[name].casting.plate)
    }
    assert links == {*own, "board/bringup.md"}
    assert "Checks of adult_thumb failed: do not print" in page
    assert Design.load(out / "board_design.toml") == fingers.board_design
    for place in ("board/bringup.md", "adult_little/index.html"):
        (out / place).parent.mkdir(exist_ok=True)
        (out / place).write_text("mine")
        with pytest.raises(OutputError, match=place):
            make_set(fingers, out)
        (out / place).unlink()
    assert len(asked) == 6, "nothing was made of what is refused"


@pytest.mark.full
def test_a_set_is_made_whole_and_again_with_the_same_bytes(folder: Path) -> None:
    text = 'name = "pair"\n'
    for finger in ("index", "ring"):
        text += f'[fingers.{finger}]\ndesign = "child_finger"\n'
    write_set(folder, text)
    done = run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--quiet")
    assert done.returncode == 0, done.stderr
    out = folder / "out/pair"
    assert sorted(path.name for path in out.iterdir() if path.is_dir()) == ["board", "child_finger"]
    board = run_fingertip("board", out / "board_design.toml", "--check", "--out", out / "board")
    assert board.returncode == 0, board.stdout + board.stderr
    assert "| ring, pin 10 |" in (out / "acceptance.md").read_text()
    assert run_fingertip("check", "out/pair").returncode == 0
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--quiet").returncode == 0
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    commands = re.findall(r"`fingertip ([^`]+ --out [^`]+)`", (out / "set.md").read_text())
    assert [command.split()[0] for command in commands] == ["board"]
    for command in commands * bool(shutil.which("kicad-cli")):
        done = run_fingertip(*shlex.split(command), PWD=str(out))
        assert done.returncode == 0, done.stderr
    assert not (out / "out").exists(), "nothing is written beside the set"
    (out / "casting_plan.md").write_text("mine\n")
    done = run_fingertip("make", "mine.toml", "--formats", "stl,3mf", "--quiet")
    assert done.returncode == 2
    assert "casting_plan.md" in done.stderr
    assert "casting_plan.md: was changed" in run_fingertip("check", "out/pair").stdout
