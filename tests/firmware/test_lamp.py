"""Sketch for a finger with a divider: lamp, lines and forces, for each controller, and an
ESP32-S3's converter.
"""

from __future__ import annotations

import re
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.documents.firmware import render_readme
from fingertip.drivers import SampleReader
from fingertip.firmware.c_sources import library_settings
from fingertip.firmware.controller_fit import find_warnings
from fingertip.firmware.fingers import TASK_CONVERSIONS, find_controller, plan_fingers
from fingertip.foundation import jit
from fingertip.foundation.errors import FingertipError
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.run import simulate_trace
from fingertip.sim.signal.finger_curve import FingerCurve
from fingertip.slip.detectors.fast import FastDetector
from fingertip.tasks.firmware_files import write_firmware
from tests.conftest import run_fingertip
from tests.firmware.conftest import INSTALL
from tests.firmware.test_examples import ARDUINO, find_changes
from tests.tools import require_tool

DESIGN = Design.load("first_finger")
STEP_V = DESIGN.detector.adc_step_v
ARM = ("arm-none-eabi-g++", "-mthumb")
XTENSA = ("xtensa-lx106-elf-g++", "--specs=/usr/lib/xtensa-lx106-elf/picolibc.specs")
COMPILERS = {
    "RP2040": (*ARM, "-mcpu=cortex-m0plus", "-DARDUINO_ARCH_RP2040"),
    "RP2350": (
        *ARM,
        "-mcpu=cortex-m33",
        "-mfpu=fpv5-sp-d16",
        "-mfloat-abi=softfp",
        "-DARDUINO_ARCH_RP2040",
    ),
    "UNO R4": (
        *ARM,
        "-mcpu=cortex-m4",
        "-mfpu=fpv4-sp-d16",
        "-mfloat-abi=hard",
        "-DARDUINO_ARCH_RENESAS",
    ),
    "Teensy 4": (*ARM, "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-DTEENSYDUINO"),
    # No package index has the compiler of the ESP32-S3: that is left out, and the one of the
    # ESP8266 stands for it.
    "ESP32-S3": (*XTENSA, "-DARDUINO_ARCH_ESP32"),
}
"""Controller -> its maker's compiler, as Debian has it."""


@cache
def simulate(kind: str, number: int, **changes: float) -> tuple[np.ndarray, np.ndarray]:
    """Tactile voltage of a case of the campaign [V], and whether the object slips."""
    design = Design.load(
        "first_finger", changes={f"detector.{name}": value for name, value in changes.items()}
    )
    cases = [case for case in generate_cases(CampaignPlan(), HELD_OUT_FROM) if case.cause == kind]
    trace = simulate_trace(design, cases[number], ("fast",))
    return trace.voltage_v, trace.slip > 0


def decide(volts: np.ndarray) -> np.ndarray:
    with jit.compiled():
        return FastDetector(library_settings(DESIGN)).process(volts).on


def compile_lamp(folder: Path, *command: str, streams: str = "false") -> list[str]:
    """Compile the sketch and the library beside it, without warnings, against the stand-in for
    Arduino's headers.
    """
    require_tool(command[0], INSTALL)
    write_firmware(DESIGN, folder)
    sketch = folder / "slip_lamp/slip_lamp.ino"
    text = sketch.read_text().replace("STREAM = false", f"STREAM = {streams}")
    sketch.write_text(
        text.replace(
            "MOTION_PIN = -1", "MOTION_PIN = 2" if streams == "true" else "MOTION_PIN = -1"
        )
    )
    sources = {
        "slip_lamp.ino": ["c++", "-std=gnu++17"],
        "slip_detector.c": ["c"],
        "slip_grip.c": ["c"],
    }
    for name, language in sources.items():
        flags = ["-Wall", "-Wextra", "-Werror", "-O2", f"-I{ARDUINO}", "-c", "-x", *language]
        subprocess.run(
            [*command, *flags, str(folder / "slip_lamp" / name), "-o", str(folder / f"{name}.o")],
            check=True,
        )
    return [str(folder / f"{name}.o") for name in sources]


@pytest.mark.full
@pytest.mark.parametrize("controller", COMPILERS)
def test_the_sketch_compiles_with_the_compilers_of_its_controllers(
    controller: str, tmp_path: Path
) -> None:
    compile_lamp(tmp_path, *COMPILERS[controller])


COUNT_V = {"TEENSYDUINO": STEP_V, "ARDUINO_ARCH_RENESAS": 5.0 / 2**14, "ARDUINO_ARCH_ESP32": 1e-3}
"""Macro of a family of boards -> what one count of its conversions means [V]."""


def run_lamp(
    folder: Path, macro: str, counts: np.ndarray, *rest: str, streams: str = "false"
) -> tuple[str, str]:
    """What the sketch writes, and what its board tells; loop() rests from one sample to another."""
    objects = compile_lamp(folder, "g++", f"-D{macro}", streams=streams)
    board = [
        f"-D{macro}",
        f"-I{ARDUINO}",
        f"-I{folder}/slip_lamp",
        str(ARDUINO / "board.cpp"),
        "-lm",
    ]
    subprocess.run(["g++", *objects, *board, "-o", str(folder / "run")], check=True)
    given = "".join(f"{count:.0f} 0\n" for count in counts)
    done = subprocess.run(
        [folder / "run", *rest], input=given, capture_output=True, text=True, check=True
    )
    return done.stdout, done.stderr


@pytest.mark.full
def test_the_sketch_counts_lost_samples_and_streams_for_the_computer(tmp_path: Path) -> None:
    volts, _ = simulate("slip", 0)
    counts = np.round(volts / STEP_V)
    text, _ = run_lamp(tmp_path, "TEENSYDUINO", counts, "100", "1200")
    assert set(re.findall(r"late:(\d+)", text)) == {"1101"}
    text, _ = run_lamp(tmp_path / "stream", "TEENSYDUINO", counts, streams="true")
    samples = [*SampleReader(text.encode().splitlines())]
    assert [round(2000 * one[0]) for one in samples] == [*range(len(counts))]
    assert np.flatnonzero([one[3] for one in samples])[[0, -1]].tolist() == [500, 899], (
        "the contact of MOTION_PIN"
    )
    done = run_fingertip(
        "detect", "-", "--design", "first_finger", "--detector", "fast", given=text
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("ON") == np.count_nonzero(
        np.diff(decide(counts * STEP_V).astype(int)) > 0
    )


@pytest.mark.parametrize(
    "macro",
    ["TEENSYDUINO", *(pytest.param(macro, marks=pytest.mark.full) for macro in [*COUNT_V][1:])],
)
def test_the_sketch_lights_the_lamp_and_writes_forces_whatever_the_converter(
    macro: str, tmp_path: Path
) -> None:
    volts, _ = simulate("slip", 0)
    counts = np.round(volts / COUNT_V[macro])
    text, told = run_lamp(tmp_path, macro, counts)
    lamp = [(int(a), int(b)) for a, b in re.findall(r"^(\d+) (\d)$", told, re.MULTILINE)]
    codes = np.floor(counts * (COUNT_V[macro] / STEP_V) + 0.5)
    assert lamp[:2] == [(0, 1), (0, 0)], "the lamp shows that it works"
    assert lamp[2:] == find_changes(decide(codes * STEP_V))[1:] != []
    assert "period 500" in told
    lines = re.findall(r"^force_n:(\d+\.\d\d) volts:(\d\.\d\d) slip:([01]) $", text, re.MULTILINE)
    means = volts[: len(volts) // 40 * 40].reshape(-1, 40).mean(axis=1)
    forces, found, slips = np.array(lines, float).T
    assert found == pytest.approx(means, abs=0.007)
    assert forces == pytest.approx(
        [FingerCurve.from_design(DESIGN).force_n(mean) for mean in means], rel=0.02, abs=0.02
    )
    assert 0.05 < slips.mean() < 0.5


def convert_as_esp32_s3(
    volts: np.ndarray, conversions: int, noise_v: float, seed: int
) -> np.ndarray:
    """Mean of conversions [V] with the worst integral and differential nonlinearity that the maker
    states.

    8 and 4 steps, up to 2.9 V: developer.espressif.com/blog/2025/08/adc-performance. A step is 3.1
    V / 4096 (ESP-IDF's manual). The noise of a conversion is stated nowhere: it is an assumption.
    """
    random = np.random.default_rng(seed)
    code = np.arange(4097)
    lsb_v = 3.1 / 4096
    integral = sum(
        np.sin(2 * np.pi * waves * code / 4096 + random.uniform(0, 6)) for waves in (1, 3, 10, 40)
    )
    levels = lsb_v * np.sort(
        code + 6 * integral / np.abs(integral).max() + random.uniform(-2, 2, 4097)
    )
    noisy = np.minimum(volts, 2.9) + random.normal(0.0, noise_v, (conversions, len(volts)))
    millivolts = np.round(1e3 * lsb_v * (np.searchsorted(levels, noisy) - 1).clip(0))
    return np.round(1e-3 * millivolts.mean(axis=0) / STEP_V) * STEP_V


@pytest.mark.full
def test_an_esp32_s3_finds_slips_in_spite_of_its_nonlinearity_by_averaging() -> None:
    wrong = dict.fromkeys((1, TASK_CONVERSIONS), 0)
    cases = [("slip", number) for number in range(0, 120, 6)]
    cases += [
        (kind, number) for kind in ("contact", "release", "load change") for number in range(5)
    ]
    for conversions in wrong:
        for kind, number in cases:
            volts, slips = simulate(kind, number, noise_v=0.0, adc_bits=24)
            on = decide(convert_as_esp32_s3(volts, conversions, 1e-3, number))
            start = np.flatnonzero(slips)[0] if kind == "slip" else len(on)
            wrong[conversions] += int(
                on[:start].any() or (kind == "slip" and not on[start : start + 200].any())
            )
    print(wrong)
    assert wrong[1] > wrong[TASK_CONVERSIONS] == 0


def test_dividers_are_limited_by_pins_and_conversions() -> None:
    planned = plan_fingers(DESIGN, "3", "pico_2")
    assert planned.inputs == (("A0",), ("A1",), ("A2",))
    assert not list(find_warnings(DESIGN, planned.controller))
    five_volts = Design.load(
        "first_finger", changes={"board.supply_v": 5.0, "detector.adc_range_v": 5.0}
    )
    assert [
        "board.supply_v=3.3" in warning for warning in find_warnings(five_volts, planned.controller)
    ] == [True]
    assert not list(find_warnings(five_volts, find_controller(DESIGN, "uno_r4")))
    assert "thumb A0, index A1, middle A2." in render_readme(DESIGN, planned)
    refused = {
        "3,uno_r4": "conversions for 2",
        "4,pico_2": "analog inputs for 3",
        "2,esp32_s3": "conversions for 1",
    }
    for words, reason in refused.items():
        with pytest.raises(FingertipError, match=reason):
            plan_fingers(DESIGN, *words.split(","))
