"""Files of `fingertip firmware`: what they say, and how they are written and compared."""

from __future__ import annotations

import json
import re
from pathlib import Path

from fingertip.board.components.front_end import POWER_UP_S
from fingertip.catalogues.electronics import load_controllers
from fingertip.catalogues.output_files import BUFFER, TIMER
from fingertip.design import Design
from fingertip.design.design_file import load_tables
from fingertip.documents.wiring import SKETCH_PINS
from fingertip.firmware.c_sources import HEADER
from fingertip.firmware.controller_fit import controller_changes, find_warnings
from fingertip.firmware.fingers import BUFFER_SAMPLES
from fingertip.tasks.firmware_files import firmware_differences, firmware_files, write_firmware
from fingertip.tasks.manifest_comparison import verify_sets
from tests.conftest import ROOT, design_file, run_fingertip

PLACES = {".", "src", "examples/slip_pin", "examples/slip_stream"}


def read_readme(design: Design) -> str:
    return firmware_files(design)["."]["README.md"].decode()


def test_arduino_and_platformio_know_the_library() -> None:
    design = Design()
    top = firmware_files(design)["."]
    fields = dict(line.split("=", 1) for line in top["library.properties"].decode().splitlines())
    required = {
        "name",
        "version",
        "author",
        "maintainer",
        "sentence",
        "paragraph",
        "category",
        "url",
        "architectures",
    }
    assert required <= set(fields)
    assert re.fullmatch(r"\d+\.\d+\.\d+", fields["version"])
    assert re.fullmatch(r"[A-Za-z0-9 _.-]+", fields["name"])
    manifest = json.loads(top["library.json"])
    assert (manifest["name"], manifest["version"]) == (fields["name"], fields["version"])
    assert manifest["headers"] == fields["includes"] == HEADER
    assert "12 bits" in fields["paragraph"]


def test_warnings_name_changes_that_end_them() -> None:
    (warning,) = find_warnings(Design.load(design_file("article")))
    assert "board.variant=article" in warning
    assert "detector.adc_polarity=bipolar" in warning
    typed = re.findall(r"--set (\S+)", warning)
    assert typed == list(controller_changes())
    loaded = load_tables([design_file("article")], typed)
    assert not list(find_warnings(Design.from_tables(loaded.tables, loaded.before, loaded.changed)))


def test_controllers_of_the_readme_stand_in_the_manual() -> None:
    """The stand-in compiles the sketches for each core that the table gives a timer."""
    controllers = (
        read_readme(Design.load("fsr400")).split("## Controllers")[1].split("## Wiring")[0]
    )
    tables = re.findall(r"(?:^\|.*\n)+", controllers, re.MULTILINE)
    assert len(tables) == 2
    manual = (ROOT / "docs/firmware.md").read_text(encoding="utf-8")
    assert all(board.name in manual for board in load_controllers())
    timers = firmware_files(Design.load("fsr400"))["src"][TIMER].decode()
    for board in load_controllers():
        core = {
            "Teensy": "TEENSYDUINO",
            "STM32": "STM32",
            "Arduino UNO": "RENESAS",
            "Raspberry": "RP2040",
        }
        known = any(board.name.startswith(name) and macro in timers for name, macro in core.items())
        assert known == (board.timer == "yes"), board.name


def test_sketches_agree_with_readme_and_board() -> None:
    files = firmware_files(Design())
    for example in ("slip_pin", "slip_stream"):
        sketch = files[f"examples/{example}"][f"{example}.ino"].decode()
        pins = re.findall(r"\b(A\d)\b", sketch)
        assert pins == [SKETCH_PINS["ADC_TACTILE"], SKETCH_PINS["ADC_FILTERED"]]
        assert f"SETTLE_MS = {1000 * POWER_UP_S:.0f};" in sketch
    assert f"#define SLIP_BUFFER_SAMPLES {BUFFER_SAMPLES}u" in files["src"][BUFFER].decode()


def test_folder_is_a_set_that_can_be_checked(tmp_path: Path) -> None:
    design = Design()
    paths = write_firmware(design, tmp_path / "firmware")
    assert {path.relative_to(tmp_path / "firmware").parent.as_posix() for path in paths} == PLACES
    count, differences = verify_sets(tmp_path)
    assert (count, differences) == (len(paths), [])
    assert not firmware_differences(design, tmp_path / "firmware")
    missing = run_fingertip("firmware", "fsr400", "--out", tmp_path / "none", "--check")
    assert (
        missing.returncode,
        "cannot be read" in missing.stdout,
        (tmp_path / "none").exists(),
    ) == (1, True, False)
    other = Design(detector={"noise_v": 1e-3})
    (difference,) = firmware_differences(other, tmp_path / "firmware")
    assert difference.endswith("slip_detector.h: differs from what this design gives.")
    write_firmware(other, tmp_path / "firmware")
    assert not firmware_differences(other, tmp_path / "firmware")
