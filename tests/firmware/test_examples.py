"""Examples for Arduino, compiled against a stand-in of its headers
and run on this machine without hardware.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fingertip import __version__
from fingertip.design import Design
from fingertip.firmware.c_sources import library_settings
from fingertip.firmware.fingers import Fingers, plan_fingers
from fingertip.slip.detectors.fast import FastDetector
from fingertip.tasks.firmware_files import write_firmware
from tests.firmware.conftest import INSTALL, Library
from tests.tools import require_tool
from tools.firmware.signals import slip_recording

ARDUINO = Path(__file__).parent / "arduino"
BOARDS = ("TEENSYDUINO", "ARDUINO_ARCH_STM32", "ARDUINO_ARCH_RENESAS", "ARDUINO_ARCH_RP2040")
EXAMPLES = ("slip_pin", "slip_stream")
GAP_SAMPLES = 40
"""Samples after which a gap of samples begins anew."""


@pytest.fixture(scope="session")
def arduino(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Library of the default design, as Arduino takes it, with
    both examples as programs of this machine.
    """
    require_tool("g++", INSTALL)
    folder = tmp_path_factory.mktemp("arduino")
    design = Design()
    write_firmware(design, folder)
    subprocess.run(
        [
            "gcc",
            "-c",
            "-O2",
            "-std=gnu11",
            str(folder / "src/slip_detector.c"),
            "-o",
            str(folder / "detector.o"),
        ],
        check=True,
    )
    for example in EXAMPLES:
        board = [str(ARDUINO / "board.cpp"), "-o", str(folder / f"{example}.run")]
        extra = [str(folder / "detector.o"), *board]
        compile_sketch(folder, example, "TEENSYDUINO", "-O2", *extra)
    return folder


def compile_sketch(folder: Path, example: str, board: str, *arguments: str) -> None:
    sketch = folder / "examples" / example / f"{example}.ino"
    flags = [
        "-std=gnu++17",
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-D{board}",
        f"-I{ARDUINO}",
        f"-I{folder / 'src'}",
    ]
    compiler = ["-x", "c++", "-include", "Arduino.h", str(sketch), "-x", "none"]
    done = subprocess.run(
        ["g++", *flags, *compiler, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", EXAMPLES)
@pytest.mark.parametrize("board", BOARDS)
def test_examples_compile_for_each_family_of_boards(
    arduino: Path, example: str, board: str
) -> None:
    compile_sketch(arduino, example, board, "-fsyntax-only")


def test_another_board_is_answered_with_what_to_do(arduino: Path) -> None:
    with pytest.raises(AssertionError, match="times a second yourself"):
        compile_sketch(arduino, "slip_pin", "ARDUINO_ARCH_NONE", "-fsyntax-only")


def as_lines(codes: tuple[np.ndarray, ...]) -> str:
    return "".join(f"{tactile} {filtered}\n" for tactile, filtered in zip(*codes, strict=True))


def run_example(
    arduino: Path, example: str, codes: tuple[np.ndarray, ...], rest: tuple[int, int] = (0, 0)
) -> tuple[str, list[tuple[int, int]], float]:
    """Standard output of an example, the pin's changes with the
    sample of each, and the timer's period [us].
    """
    given = as_lines(codes)
    command = [str(arduino / f"{example}.run"), *map(str, rest)]
    done = subprocess.run(command, input=given, capture_output=True, text=True, check=True)
    period = float(re.findall(r"period (\S+)", done.stderr)[0])
    return (
        done.stdout,
        [(int(a), int(b)) for a, b in re.findall(r"^(\d+) (\d)$", done.stderr, re.MULTILINE)],
        period,
    )


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_switch_the_pin_as_the_detector_decides(
    arduino: Path, library: Library, example: str
) -> None:
    design = library.design
    codes = slip_recording(design, 2.0).codes(design)
    _, changes, period = run_example(arduino, example, codes)
    assert changes == find_changes(library.detector().process_codes(*codes))
    assert len(changes) > 1
    assert period == pytest.approx(1e6 / design.detector.sample_rate_hz)


def find_changes(on: np.ndarray) -> list[tuple[int, int]]:
    return [
        (0, 0),
        *((int(i) + 1, int(on[i + 1])) for i in np.flatnonzero(np.diff(on.astype(int)))),
    ]


def test_a_loop_that_lags_catches_up_without_losing_a_decision(
    arduino: Path, library: Library
) -> None:
    codes = slip_recording(library.design, 2.0).codes(library.design)
    expected = find_changes(library.detector().process_codes(*codes))
    first = expected[1][0] - 500
    last = expected[1][0] + 400
    _, found, _ = run_example(arduino, "slip_pin", codes, (first, last))
    late = [(max(sample, last) if sample >= first else sample, level) for sample, level in expected]
    assert found == late
    assert found != expected


@pytest.mark.parametrize("example", EXAMPLES)
def test_after_a_gap_the_detector_goes_on(arduino: Path, library: Library, example: str) -> None:
    """A full buffer drops what waits, as its oldest sample may be
    overwritten; no step of the gap counts.
    """
    recorded = slip_recording(library.design, 2.0).codes(library.design)
    codes = tuple(np.concatenate([each[:900], each[:900] + 100, each + 100]) for each in recorded)
    first = 100
    last = 100 + 1023
    text, found, _ = run_example(arduino, example, codes, (first, last))
    step = library.design.detector.adc_step_v
    volts = [step * each[np.r_[:first, first:first:1, last + 1 : len(each)]] for each in codes]
    volts = [np.insert(each, first, np.full(GAP_SAMPLES + 1, np.nan)) for each in volts]
    on = FastDetector(library_settings(library.design)).process(*volts).on
    expected = find_changes(np.insert(on, first, np.zeros(last - first - GAP_SAMPLES, bool)))
    assert [level for _, level in found] == [level for _, level in expected] == [0, 1]
    assert found[1][0] == pytest.approx(expected[1][0], abs=1)  # single precision
    if example == "slip_stream":
        times = [float(line.split(",")[0]) for line in text.splitlines() if line[0].isdigit()]
        rate_hz = library.design.detector.sample_rate_hz
        assert times[first - 1 : first + 1] == pytest.approx(
            [(first - 1) / rate_hz, (last + 1) / rate_hz]
        )


def test_lines_hold_time_and_voltage(arduino: Path, library: Library) -> None:
    design = library.design
    codes = np.array([0, 1, 2048, 4095, *[1000] * 3000])
    text, _, _ = run_example(arduino, "slip_stream", (codes, codes[::-1]))
    version, header, *lines = text.splitlines()
    assert (version, header) == (f"# fingertip {__version__}", "time_s,voltage_v,filtered_v")
    assert lines[2000:2002] == [version, header]  # again, with the second second
    lines = [line for line in lines if line not in (version, header)]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert rows[:, 0] == pytest.approx(
        np.arange(len(codes)) / design.detector.sample_rate_hz, abs=5e-7
    )
    assert rows[:, 1] == pytest.approx(codes * design.detector.adc_step_v, abs=1e-6)
    assert rows[:, 2] == pytest.approx(codes[::-1] * design.detector.adc_step_v, abs=1e-6)
    assert lines[0] == "0.000000,0.000000,0.805664"
    assert all(re.fullmatch(r"\d+(\.\d{6},\d+){2}\.\d{6}", line) for line in lines)


HAND_BOARDS = {"TEENSYDUINO": "teensy40", "STM32F4xx": "black_pill_f411"}
"""Macro of a family of boards -> a controller of it that carries five fingers."""


def make_hand_sketch(
    folder: Path,
    macro: str,
    fingers: Fingers,
    example: str = "slip_hand",
    change: tuple[str, str] = ("", ""),
) -> Path:
    """Compile an example of a hand for the stand-in of a family of
    boards; its addresses fit the DMA's registers.
    """
    require_tool("g++", INSTALL)
    write_firmware(Design(), folder, fingers=fingers)
    sketch = folder / "examples" / example / f"{example}.ino"
    sketch.write_text(sketch.read_text().replace(*change))
    objects = []
    for source in ("slip_detector", "slip_grip"):
        objects.append(str(folder / f"{source}.o"))
        flags = [
            "-c",
            "-O2",
            "-std=gnu11",
            "-fno-pie",
            str(folder / f"src/{source}.c"),
            "-o",
            objects[-1],
        ]
        subprocess.run(["gcc", *flags], check=True)
    boards = [f"-DSLIP_FINGERS={fingers.count}"]
    boards += ["-DARDUINO_ARCH_STM32"] if macro.startswith("STM32") else []
    program = folder / f"{example}.run"
    options = [
        *boards,
        "-O2",
        "-no-pie",
        *objects,
        str(ARDUINO / "board.cpp"),
        "-lm",
        "-o",
        str(program),
    ]
    compile_sketch(folder, example, macro, *options)
    return program


@pytest.mark.full
@pytest.mark.parametrize("macro", HAND_BOARDS)
def test_the_example_of_a_hand_tells_which_finger_slips_and_which_has_a_fault(
    macro: str, tmp_path: Path
) -> None:
    """Index slips from 0.5 s on; the wire of T of the ring finger breaks at 1.5 s;
    S of the little finger is dead; T of the thumb is limited.
    """
    design = Design()
    program = make_hand_sketch(
        tmp_path / "library", macro, plan_fingers(design, "5", HAND_BOARDS[macro])
    )
    count = round(2.5 * design.detector.sample_rate_hz)
    random = np.random.default_rng(1)
    step = design.detector.adc_step_v
    volts = np.full((count, 10), 1.0) + random.normal(0.0, 4e-4, (count, 10))
    volts[:, 1::2] += 0.65
    volts[:, 2], volts[:, 3] = slip_recording(design, 2.5).inputs
    volts[3000:, 6] = 0.0
    volts[:, 9] = 1.65
    volts[:, 0] = np.minimum(volts[:, 0] + np.arange(count) / 4000, 1.8)
    codes = np.round(volts / step).astype(int)
    given = "\n".join(" ".join(map(str, row)) for row in codes.tolist())
    done = subprocess.run([str(program)], input=given, capture_output=True, text=True, check=True)
    found = [re.fullmatch(r"(\d+\.\d{3}) s: (\w+) (.*)", line) for line in done.stdout.splitlines()]
    told = {
        (match[2], match[3].split(":")[0]): float(match[1]) for match in reversed(found) if match
    }
    # The wire's break may look like a glitch first.
    told.pop(("ring", "has lost or wrong samples"), None)
    assert set(told) == {
        ("index", "slips"),
        ("ring", "has a voltage that no force gives"),
        ("little", "has a silent S"),
        ("thumb", "has a flat T"),
    }
    assert 0.5 < told["index", "slips"] < 0.6
    assert 1.5 < told["ring", "has a voltage that no force gives"] < 1.6
    assert "grip tightened" in done.stdout
    changes = [(int(a), int(b)) for a, b in re.findall(r"^(\d+) (\d)$", done.stderr, re.MULTILINE)]
    assert [level for _, level in changes[:2]] == [0, 1]


@pytest.mark.full
def test_a_scan_that_the_converter_did_not_finish_is_lost_and_the_next_one_is_not(
    tmp_path: Path,
) -> None:
    """Each tenth scan of an STM32F4 overruns from 1 s on: every
    finger reports it, and slip at index is found.
    """
    design = Design()
    program = make_hand_sketch(
        tmp_path / "library", "STM32F4xx", plan_fingers(design, "2", "black_pill_f411")
    )
    count = round(2.5 * design.detector.sample_rate_hz)
    volts = np.full((count, 4), 1.0) + np.random.default_rng(1).normal(0.0, 4e-4, (count, 4))
    volts[:, 1] += 0.65
    volts[:, 2], volts[:, 3] = slip_recording(design, 2.5).inputs
    codes = np.round(volts / design.detector.adc_step_v).astype(int)
    given = "\n".join(" ".join(map(str, row)) for row in codes.tolist())
    command = [str(program), "0", "0", "2000"]
    told = subprocess.run(
        command, input=given, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    lost = [line for line in told if line.endswith("has lost or wrong samples")]
    # Once: the report lasts from one to the next.
    assert [line.split()[2] for line in lost] == [
        "thumb",
        "index",
    ]
    assert all(1.0 <= float(line.split()[0]) <= 1.02 for line in lost)
    assert any(line.endswith("index slips") for line in told)
    assert not any("no force gives" in line or "silent" in line for line in told)


@pytest.mark.parametrize("macro", BOARDS)
def test_the_example_of_a_hand_compiles_for_each_family_of_boards(
    macro: str, tmp_path: Path
) -> None:
    require_tool("g++", INSTALL)
    write_firmware(Design(), tmp_path, fingers=plan_fingers(Design(), "3", "teensy40"))
    for example in ("slip_hand", "slip_stream"):
        compile_sketch(tmp_path, example, macro, "-fsyntax-only")


LINE_PROGRAM = """
#include "slip_line.h"
#include <stdio.h>
int main(void) {
    char line[SLIP_LINE_BYTES];
    unsigned long sample;
    float tactile, filtered;
    while (scanf("%lu %f %f", &sample, &tactile, &filtered) == 3) {
        fwrite(line, 1, slip_format_line(line, (uint32_t)sample, tactile, filtered), stdout);
    }
    return 0;
}
"""


def test_the_longest_line_fits_and_negative_voltages_are_written(
    arduino: Path, tmp_path: Path
) -> None:
    (tmp_path / "line.c").write_text(LINE_PROGRAM)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsanitize=address,undefined"]
    folders = [f"-I{arduino / 'src'}", f"-I{arduino / 'examples/slip_stream'}"]
    binary = tmp_path / "line"
    subprocess.run(
        ["gcc", *flags, *folders, str(tmp_path / "line.c"), "-o", str(binary)], check=True
    )
    given = "4294967295 -100 -100\n3 -0.0000014 1\n7 0.0000004 -2\n"
    done = subprocess.run([str(binary)], input=given, capture_output=True, text=True, check=True)
    # After 24 days at 2 kHz the counter of samples is full.
    assert done.stdout.splitlines() == [
        "2147483.647500,-100.000000,-100.000000",
        "0.001500,-0.000001,1.000000",
        "0.003500,0.000000,-2.000000",
    ]
