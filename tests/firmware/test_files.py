"""Files of `fingertip firmware`: what they say, and how they are written and compared."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from fingertip.board.bringup.wiring import SKETCH_PINS
from fingertip.board.components.bridge import POWER_UP_S
from fingertip.catalogues.controllers import BOARDS
from fingertip.design import Design
from fingertip.design.files import load_tables
from fingertip.documents.firmware import BUFFER_SAMPLES, CYCLES_PER_INSTRUCTION, find_load
from fingertip.firmware import packaging as costs
from fingertip.firmware.packaging import controller_changes, find_warnings
from fingertip.firmware.sources import HEADER, SOURCE, library_sources
from fingertip.slip.detectors.fast_coefficients import NODES, load_model
from fingertip.tasks.firmware import BUFFER, TIMER, firmware_differences, firmware_files, write_firmware
from fingertip.tasks.verification import verify_sets
from tests.conftest import ROOT, design_file, run_fingertip

PLACES = {".", "src", "examples/slip_pin", "examples/slip_stream"}


def read_readme(design: Design) -> str:
    return firmware_files(design)["."]["README.md"].decode()


def test_tables_hold_the_trees() -> None:
    source = library_sources(Design())[SOURCE].decode()
    model = load_model()
    tables = re.findall(r"static const \w+ (\w+)\[[^\]]*\] = \{(.*?)\n\};", source, re.DOTALL)
    forms = {"slip_features": r"(\d+),", "slip_thresholds": r"KEY\(([^,]+), \w+\),", "slip_leaves": r"R\((.+?)\),"}
    found = {name: re.findall(forms[name], text) for name, text in tables}
    nodes = [i for i in range(model.trees * (NODES + 1)) if i % (NODES + 1)]
    features, thresholds = found["slip_features"], found["slip_thresholds"]
    assert [float(features[i]) for i in nodes] == model.features.tolist()
    assert [float(thresholds[i]) for i in nodes] == model.thresholds.tolist()
    assert [float(leaf) for leaf in found["slip_leaves"]] == model.leaves.tolist()


def test_arduino_and_platformio_know_the_library() -> None:
    design = Design()
    top = firmware_files(design)["."]
    fields = dict(line.split("=", 1) for line in top["library.properties"].decode().splitlines())
    required = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"}
    assert required <= set(fields)
    assert re.fullmatch(r"\d+\.\d+\.\d+", fields["version"])
    assert re.fullmatch(r"[A-Za-z0-9 _.-]+", fields["name"])
    manifest = json.loads(top["library.json"])
    assert (manifest["name"], manifest["version"]) == (fields["name"], fields["version"])
    assert manifest["headers"] == fields["includes"] == HEADER
    assert "12 bits" in fields["paragraph"]


def test_warnings_name_changes_that_end_them() -> None:
    (warning,) = find_warnings(Design.load(design_file("article")))
    assert "board.supply=split" in warning
    assert "detector.adc_polarity=bipolar" in warning
    typed = re.findall(r"--set (\S+)", warning)
    assert typed == list(controller_changes())
    loaded = load_tables([design_file("article")], typed)
    assert not list(find_warnings(Design.from_tables(loaded.tables, loaded.before, loaded.changed)))


def test_controllers_and_ports_of_the_readme_stand_in_the_manual() -> None:
    """The stand-in compiles the sketches for each core that the table gives a timer."""
    controllers = read_readme(Design.load("fsr400")).split("## Controllers")[1].split("## Wiring")[0]
    tables = re.findall(r"(?:^\|.*\n)+", controllers, re.MULTILINE)
    assert len(tables) == 3
    manual = (ROOT / "docs/firmware.md").read_text(encoding="utf-8")
    assert all(table in manual for table in tables)
    timers = firmware_files(Design.load("fsr400"))["src"][TIMER].decode()
    for board in BOARDS:
        core = {"Teensy": "TEENSYDUINO", "STM32": "STM32", "Arduino UNO": "RENESAS", "Raspberry": "RP2040"}
        known = any(board.name.startswith(name) and macro in timers for name, macro in core.items())
        assert known == (board.timer == "yes"), board.name


def test_load_of_each_controller_follows_from_its_clock_and_the_measured_instructions() -> None:
    targets = costs.read_costs()["targets"]
    for board in BOARDS:
        target = targets["Cortex-M4F" if "with floats" in board.core else "Cortex-M0+"]
        found = {rate_hz: find_load(board, rate_hz) for rate_hz in (100.0, 2000.0, 2e6)}
        for load in found.values():
            assert load.mean == pytest.approx(CYCLES_PER_INSTRUCTION * target["instructions"]["slip"], abs=100)
            assert load.longest == pytest.approx(CYCLES_PER_INSTRUCTION * target["max_instructions"], abs=100)
        # On every controller of the table loop() keeps up at 2 kHz; a faster rate is refused to the slow ones.
        assert found[100.0].longest <= found[100.0].available
        assert found[2000.0].mean <= found[2000.0].available == pytest.approx(1e6 * board.clock_mhz / 2000, abs=100)
        assert found[2e6].mean > found[2e6].available


def test_sketches_agree_with_readme_and_board() -> None:
    files = firmware_files(Design())
    for example in ("slip_pin", "slip_stream"):
        sketch = files[f"examples/{example}"][f"{example}.ino"].decode()
        pins = dict(re.findall(r"int (\w+)_PIN = (A\d);", sketch))
        assert pins == {"TACTILE": SKETCH_PINS["ADC_TACTILE"], "FILTERED": SKETCH_PINS["ADC_FILTERED"]}
        assert f"SETTLE_MS = {1000 * POWER_UP_S:.0f};" in sketch
    assert f"#define SLIP_BUFFER_SAMPLES {BUFFER_SAMPLES}u" in files["src"][BUFFER].decode()


def test_folder_is_a_set_that_can_be_checked(tmp_path: Path) -> None:
    design = Design()
    paths = write_firmware(design, tmp_path / "firmware")
    assert {path.relative_to(tmp_path / "firmware").parent.as_posix() for path in paths} == PLACES
    count, differences = verify_sets(tmp_path)
    assert (count, differences) == (len(paths), [])
    assert not firmware_differences(design, tmp_path / "firmware")
    other = Design(detector={"noise_v": 1e-3})
    (difference,) = firmware_differences(other, tmp_path / "firmware")
    assert difference.endswith("slip_detector.h: differs from what this design gives.")
    write_firmware(other, tmp_path / "firmware")
    assert not firmware_differences(other, tmp_path / "firmware")


@pytest.mark.full
def test_command_writes_checks_and_keeps_what_is_somebodys_own(tmp_path: Path) -> None:
    out = tmp_path / "firmware"
    done = run_fingertip("firmware", "fsr400", "--out", out, "--json")
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert {Path(name).relative_to(out).as_posix() for name in data["files"]} >= {"README.md", "src/slip_detector.c"}
    assert data["costs"] == costs.read_costs()
    assert run_fingertip("firmware", "fsr400", "--out", out, "--check").returncode == 0
    source = out / "src" / SOURCE
    source.write_text(source.read_text() + "/* mine */\n")
    done = run_fingertip("firmware", "fsr400", "--out", out, "--check")
    assert done.returncode == 1
    assert "slip_detector.c: differs" in done.stdout
    missing = run_fingertip("firmware", "fsr400", "--out", tmp_path / "none", "--check")
    assert missing.returncode == 1
    assert "cannot be read" in missing.stdout
    assert not (tmp_path / "none").exists()
