"""`fingertip new`: a design file to be edited."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest

from fingertip.catalogues.electronics import SENSORS
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.design.design_file import list_parameters
from fingertip.fitting.new_design import write_new_design
from tests.conftest import ROOT, run_fingertip

CHOICES = (*SENSORS, "custom")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def base(sensor: str) -> Design:
    known = SENSORS.get(sensor, SENSORS["fsr400"])
    return Design.load(
        known.bundled_design, changes=[f"sensor.model={sensor}", "name=mine", *known.changes]
    )


@pytest.mark.parametrize("sensor", CHOICES)
def test_the_file_is_the_bundled_design_of_its_sensor(sensor: str, folder: Path) -> None:
    done = run_fingertip("new", "mine", "--sensor", sensor)
    assert done.returncode == 0, done.stderr
    note, _, written = done.stdout.rpartition("wrote mine.toml; ")
    assert ("calibrate" in note, written) == (
        sensor[:4] != "fsr4",
        "edit it, then run: fingertip make mine.toml\n",
    )
    assert Design.load("mine.toml") == base(sensor)
    assert run_fingertip("params", "mine.toml").returncode == 0


@pytest.mark.parametrize("sensor", CHOICES)
def test_every_parameter_stands_in_the_file_once_and_is_described(sensor: str) -> None:
    text = write_new_design("mine", sensor).text
    uncommented = re.sub(r"^#(?=[a-z0-9_.]+ = )", "", text, flags=re.MULTILINE)
    assert Design(**tomllib.loads(uncommented)) == base(sensor)
    lines = {
        line.partition(" = ")[0]: line
        for line in uncommented.splitlines()
        if not line.startswith("#") and line
    }
    assert set(lines) == {parameter.path for parameter in list_parameters()}
    for parameter in list_parameters():
        line = lines[parameter.path]
        assert parameter.description in line
        if parameter.unit:
            assert f"[{parameter.unit}, {parameter.bounds}]" in line


def test_pages_state_the_sizes_of_the_presets_and_what_to_measure() -> None:
    designs, sets = (
        " ".join((ROOT / page).read_text().split()) for page in ("docs/designs.md", "docs/sets.md")
    )
    for name in PRESETS:
        design = Design.load(name)
        to_axis_mm = design.skin.length_mm + design.bone.base_length_mm
        assert re.search(
            rf"`{name}` \({design.skin.width_mm:g} mm( wide)?, {to_axis_mm:.0f} mm[ )]", designs
        ), name
    adult = Design.load("adult_finger")
    assert (
        f"`bone.base_length_mm` behind it, {adult.bone.base_length_mm:g} mm in `adult_finger`"
        in sets
    )
    assert -adult.dimensions.joint.axis_z == adult.bone.base_length_mm


def write_hand(folder: Path, **sizes: float) -> None:
    """Write the hand of the adult finger with other sizes."""
    hand = Design.load("adult_finger").hand.model_dump() | sizes
    rows = (f"{key} = {json.dumps(value)}" for key, value in hand.items())
    (folder / "hand.toml").write_text("\n".join(["[hand]", *rows, ""]))


@pytest.mark.full
def test_the_file_states_the_hands_own_sizes_and_what_moved_for_them(folder: Path) -> None:
    write_hand(folder, clearance_radius_mm=5.8, width_mm=6.9, travel_deg=45.0, axis_height_mm=9.0)
    done = run_fingertip("new", "mine", "--preset", "adult_finger", "--hand", "hand.toml", "--json")
    assert done.returncode == 0, done.stderr
    design = Design.load("mine.toml")
    result = json.loads(done.stdout)
    assert design.hand == Design.load("adult_finger").hand.model_copy(
        update={
            "clearance_radius_mm": 5.8,
            "width_mm": 6.9,
            "travel_deg": 45.0,
            "axis_height_mm": 9.0,
        }
    )
    moved = {one["parameter"]: one for one in result["fitted"]}
    assert "skin.semi_axis_dorsal_mm" in moved
    assert (
        f"skin.semi_axis_dorsal_mm  derived  {moved['skin.semi_axis_dorsal_mm']['was']}"
        in done.stderr
    )
    text = Path("mine.toml").read_text()
    wishes, measured, fitted, derived = re.split(
        "# (?:Measured on|Fitted to|Derived from) .*", text
    )[:4]
    assert "skin.width_mm = 18.0" in wishes
    assert "hand.width_mm = 6.9 " in measured
    assert all(f"\n{name} = {one['is']}" in fitted + wishes for name, one in moved.items())
    assert "\n#bone.channel_bend_radius_mm = 1.5" in derived
    made = run_fingertip("build", "mine.toml", "--formats", "stl", "--out", "out")
    assert made.returncode == 0, made.stderr


@pytest.mark.full
def test_loads_that_are_given_are_refused_if_too_heavy_and_others_become_what_the_finger_holds(
    folder: Path,
) -> None:
    write_hand(
        folder,
        width_mm=9.0,
        axis_height_mm=7.0,
        pin_diameter_mm=3.0,
        clearance_radius_mm=5.0,
        tendon_distance_mm=4.4,
        travel_deg=60.0,
    )
    command = ("new", "mine", "--hand", "hand.toml")
    weak = run_fingertip(
        *command, "--set", "strength.grip_force_n=30", "--set", "strength.knock_speed_m_s=1"
    )
    assert weak.returncode == 2
    assert "strength.grip_force_n" in weak.stderr
    assert not (folder / "mine.toml").exists()
    done = run_fingertip(*command)
    assert done.returncode == 0, done.stderr
    held = Design.load("mine.toml").strength
    assert held.grip_force_n <= 10.0
    moved = f"strength.knock_speed_m_s wish 0.2 {held.knock_speed_m_s:g} the bone holds no more"
    assert moved in " ".join(done.stderr.split())
    assert run_fingertip("check", "mine.toml").returncode == 0
