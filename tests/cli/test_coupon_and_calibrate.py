"""`fingertip coupon` and `fingertip calibrate printer`."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from fingertip.design import Design
from tests.calibration.simulated import simulate, to_toml
from tests.conftest import run_fingertip

FILES = {
    "coupon.stl", "coupon.3mf", "coupon_slice.stl", "coupon_slice.3mf", "coupon_readings.toml", "coupon.md",
    "coupon.png", "manifest.json",
}  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def readings(name: str = "fsr400", offset_mm: float = 0.1) -> Path:
    path = Path("my_readings.toml")
    path.write_text(to_toml(simulate(Design.load(name), 0, offset_mm=offset_mm)))
    return path


@pytest.mark.full
def test_coupon_writes_its_files_beside_the_parts(folder: Path) -> None:
    done = run_fingertip("coupon", "fsr400")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (folder / "out/fsr400/coupon").iterdir()} == FILES
    assert re.search(r"^22 of 22 checks passed; written to out/fsr400/coupon; fill in coupon_readings.toml$",
                     done.stdout, re.MULTILINE)  # fmt: skip
    page = (folder / "out/fsr400/coupon/coupon.md").read_text()
    for word in ("caliper", "mold.fit_clearance_mm", "sensor.clearance_mm", "M3 nut", "fingertip calibrate printer"):
        assert word in page
    assert run_fingertip("check", "out/fsr400").returncode == 0


@pytest.mark.full
def test_coupon_as_step(folder: Path) -> None:
    done = run_fingertip("coupon", "fsr400", "--formats", "stl,step", "--out", "c")
    assert done.returncode == 0, done.stderr
    assert {"coupon.step", "coupon_slice.step"} <= {path.name for path in (folder / "c").iterdir()}
    assert "16 of 16 checks passed" in done.stdout


@pytest.mark.full
def test_calibrate_writes_a_design_that_the_printed_changes_give_too(folder: Path) -> None:
    path = readings()
    done = run_fingertip("calibrate", "printer", "fsr400", path, "--out", "mine.toml")
    assert done.returncode == 0, done.stderr
    assert "checks of the calibrated design passed" in done.stdout
    (changes,) = (line for line in done.stdout.splitlines() if line.startswith("--set "))
    calibrated = Design.load("mine.toml")
    typed = Design.load("fsr400", changes=[word for word in shlex.split(changes) if word != "--set"])
    assert calibrated == typed.model_copy(update={"name": "mine"}), "the design is named after its file"
    assert calibrated.printer.offset_mm == pytest.approx(0.1, abs=0.01)
    assert calibrated.printer.scale_percent == pytest.approx(99.5, abs=0.05)
    written = (folder / "mine.toml").read_bytes()
    refused = run_fingertip("calibrate", "printer", "fsr400", path, "--out", "mine.toml")
    assert refused.returncode == 2
    assert "mine.toml: exists and is not overwritten; choose another file with --out, or" in refused.stderr
    forced = run_fingertip("calibrate", "printer", "fsr400", path, "--out", "mine.toml", "--force")
    assert forced.returncode == 0, forced.stderr
    assert (folder / "mine.toml").read_bytes() == written
    again = run_fingertip("calibrate", "printer", "fsr400", path, "--json", "-q")
    data = json.loads(again.stdout)
    assert again.stderr == ""
    assert data["passed"]
    assert " ".join(f"--set {change}" for change in data["set"]) == changes
    assert data["values"]["mold.fit_clearance_mm"]["interval_95"][0] < 0.15
    assert str(folder) not in (folder / "mine.toml").read_text()


@pytest.mark.full
def test_a_refused_design_is_explained_with_a_remedy_that_passes(folder: Path) -> None:
    far = "hand.tendon_distance_mm=4.69"  # as far as the collar allows before it is calibrated
    words = ("calibrate", "printer", "child_finger", readings("child_finger"), "--set", far, "--out", "mine.toml")
    done = run_fingertip(*words)
    assert done.returncode == 2
    assert "--set printer.scale_percent=" in done.stdout, "the values are printed all the same"
    assert "error: hand.tendon_distance_mm: 4.69 mm leaves no wall" in done.stderr
    kept = re.search(r"calibration: the calibrated design is refused; (--keep \S+) passes", done.stderr)
    assert kept
    assert not (folder / "mine.toml").exists()
    data = json.loads(run_fingertip(*words, "--json").stdout)
    assert data["values"]
    assert [issue["field"] for issue in data["issues"]] == ["hand.tendon_distance_mm", "calibration"]
    assert run_fingertip(*words, *kept[1].split()).returncode == 0
    assert (folder / "mine.toml").exists()


@pytest.mark.full
def test_a_failed_check_is_named_and_no_design_is_written(folder: Path) -> None:
    """A bone that needs a factor that no material gives fails its check, calibrated or not."""
    changes = ("--set", "strength.min_grip_factor=20")
    words = ("calibrate", "printer", "fsr400", readings(), *changes, "--out", "mine.toml")
    done = run_fingertip(*words)
    assert done.returncode == 1
    assert "FAILED bone.safety_factor.grip" in done.stdout
    assert "mine.toml is not written; change the design" in done.stdout
    assert not (folder / "mine.toml").exists()
    finger = ("adult_finger", readings("adult_finger"), "--keep", "printer.min_wall_mm")
    words = ("calibrate", "printer", *finger, "--out", "mine.toml")
    kept = re.search(r"mine.toml is not written; (--keep \S+) passes", run_fingertip(*words).stdout)
    assert kept
    assert run_fingertip(*words, *kept[1].split()).returncode == 0


def test_all_faults_are_reported_at_once(folder: Path) -> None:
    path = readings()
    path.write_text(path.read_text().replace("slot_mm", "slott_mm"))
    words = ("calibrate", "printer", "fsr400", path, "--out", "mine.txt", "--keep", "sensor.clearance")
    done = run_fingertip(*words)
    assert done.returncode == 2
    assert [line.split(": ")[1] for line in done.stderr.splitlines()] == ["--out", "--keep", "slott_mm"]
    assert "did you mean sensor.clearance_mm?" in done.stderr
    assert "did you mean slot_mm?" in done.stderr


def test_inputs_are_not_overwritten_and_missing_files_are_named(folder: Path) -> None:
    path = readings()
    done = run_fingertip("calibrate", "printer", "fsr400", path, "--out", path)
    assert "is an input of this command; give another name." in done.stderr
    done = run_fingertip("calibrate", "printer", "fsr400", "none.toml")
    assert done.returncode == 2
    assert "none.toml: cannot be read" in done.stderr
