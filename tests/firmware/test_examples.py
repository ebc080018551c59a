"""Examples for Arduino, compiled against a stand-in of its headers and run on this machine without hardware."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
import tty
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.tasks.firmware import write_firmware
from tests.conftest import ROOT
from tests.firmware.conftest import INSTALL, Library
from tests.tools import require_tool
from tools.firmware.signals import slip_recording

ARDUINO = Path(__file__).parent / "arduino"
BOARDS = ("TEENSYDUINO", "ARDUINO_ARCH_STM32", "ARDUINO_ARCH_RENESAS", "ARDUINO_ARCH_RP2040")
EXAMPLES = ("slip_pin", "slip_stream")


@pytest.fixture(scope="session")
def arduino(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Library of the default design, as Arduino takes it, with both examples as programs of this machine."""
    require_tool("g++", INSTALL)
    folder = tmp_path_factory.mktemp("arduino")
    design = Design()
    write_firmware(design, folder)
    subprocess.run(
        ["gcc", "-c", "-O2", "-std=gnu11", str(folder / "src/slip_detector.c"), "-o", str(folder / "detector.o")],
        check=True,
    )
    for example in EXAMPLES:
        extra = [str(folder / "detector.o"), str(ARDUINO / "board.cpp"), "-o", str(folder / f"{example}.run")]
        compile_sketch(folder, example, "TEENSYDUINO", "-O2", *extra)
    return folder


def compile_sketch(folder: Path, example: str, board: str, *arguments: str) -> None:
    sketch = folder / "examples" / example / f"{example}.ino"
    flags = ["-std=gnu++17", "-Wall", "-Wextra", "-Werror", f"-D{board}", f"-I{ARDUINO}", f"-I{folder / 'src'}"]
    compiler = ["-x", "c++", "-include", "Arduino.h", str(sketch), "-x", "none"]
    done = subprocess.run(["g++", *flags, *compiler, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", EXAMPLES)
@pytest.mark.parametrize("board", BOARDS)
def test_examples_compile_for_each_family_of_boards(arduino: Path, example: str, board: str) -> None:
    compile_sketch(arduino, example, board, "-fsyntax-only")


def test_another_board_is_answered_with_what_to_do(arduino: Path) -> None:
    with pytest.raises(AssertionError, match="times a second yourself"):
        compile_sketch(arduino, "slip_pin", "ARDUINO_ARCH_NONE", "-fsyntax-only")


def as_lines(codes: tuple[np.ndarray, ...]) -> str:
    return "".join(f"{tactile} {filtered}\n" for tactile, filtered in zip(*codes, strict=True))


def run_example(
    arduino: Path, example: str, codes: tuple[np.ndarray, ...], rest: tuple[int, int] = (0, 0)
) -> tuple[str, list[tuple[int, int]], float]:
    """Standard output of an example, the pin's changes with the sample of each, and the timer's period [us]."""
    given, command = as_lines(codes), [str(arduino / f"{example}.run"), *map(str, rest)]
    done = subprocess.run(command, input=given, capture_output=True, text=True, check=True)
    period = float(re.findall(r"period (\S+)", done.stderr)[0])
    return done.stdout, [(int(a), int(b)) for a, b in re.findall(r"^(\d+) (\d)$", done.stderr, re.MULTILINE)], period


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_switch_the_pin_as_the_detector_decides(arduino: Path, library: Library, example: str) -> None:
    design = library.design
    codes = slip_recording(design, 2.0).codes(design)
    _, changes, period = run_example(arduino, example, codes)
    assert changes == find_changes(library.detector("float").process_codes(*codes))
    assert len(changes) > 1
    assert period == pytest.approx(1e6 / design.detector.sample_rate_hz)


@pytest.mark.parametrize("example", EXAMPLES)
def test_the_interrupt_only_takes_and_stores_a_sample(arduino: Path, example: str) -> None:
    """A step of the detector takes more than a sample on slow controllers."""
    sketch = (arduino / "examples" / example / f"{example}.ino").read_text()
    buffer = (arduino / "src/slip_buffer.h").read_text()
    (callback,) = re.findall(r"slip_start_timer\((\w+)\)", sketch)
    assert find_calls(sketch, callback) == {"analogRead", "slip_store"}
    assert find_calls(buffer, "slip_store") == set()
    assert {"slip_fetch", "slip_step_codes"} <= find_calls(sketch, "loop")


def find_calls(source: str, function: str) -> set[str]:
    """Names that the body of a function calls."""
    (body,) = re.findall(rf"\bvoid {function}\([^)]*\) \{{\n(.*?)^\}}", source, re.MULTILINE | re.DOTALL)
    return set(re.findall(r"(\w+)\(", body)) - {"if", "for", "while", "switch"}


def find_changes(on: np.ndarray) -> list[tuple[int, int]]:
    return [(0, 0), *((int(i) + 1, int(on[i + 1])) for i in np.flatnonzero(np.diff(on.astype(int))))]


def test_a_loop_that_lags_catches_up_without_losing_a_decision(arduino: Path, library: Library) -> None:
    codes = slip_recording(library.design, 2.0).codes(library.design)
    expected = find_changes(library.detector("float").process_codes(*codes))
    first, last = expected[1][0] - 500, expected[1][0] + 400
    _, found, _ = run_example(arduino, "slip_pin", codes, (first, last))
    late = [(max(sample, last) if sample >= first else sample, level) for sample, level in expected]
    assert found == late
    assert found != expected


@pytest.mark.parametrize("example", EXAMPLES)
def test_after_a_gap_the_detector_learns_the_noise_anew(arduino: Path, library: Library, example: str) -> None:
    """A full buffer drops what waits: its oldest sample may be overwritten while it is read."""
    recorded = slip_recording(library.design, 2.0).codes(library.design)
    codes = tuple(np.concatenate([each[:900], each[:900] + 100, each + 100]) for each in recorded)
    first, last = 100, 100 + 1023
    text, found, _ = run_example(arduino, example, codes, (first, last))
    parts = (slice(first), slice(last + 1, None))
    before, after = (library.detector("float").process_codes(*(each[part] for each in codes)) for part in parts)
    on = np.concatenate([before, np.repeat(before[-1], last + 1 - first), after])
    assert found == find_changes(on)
    assert len(found) > 1
    if example == "slip_stream":
        times = [float(line.split(",")[0]) for line in text.splitlines() if line[0].isdigit()]
        rate_hz = library.design.detector.sample_rate_hz
        assert times[first - 1 : first + 1] == pytest.approx([(first - 1) / rate_hz, (last + 1) / rate_hz])


def test_lines_hold_time_and_voltage(arduino: Path, library: Library) -> None:
    design = library.design
    codes = np.array([0, 1, 2048, 4095, *[1000] * 3000])
    text, _, _ = run_example(arduino, "slip_stream", (codes, codes[::-1]))
    header, *lines = text.splitlines()
    assert header == "time_s,voltage_v,filtered_v"
    assert lines[2000] == header  # again, with the second second
    lines = [line for line in lines if line != header]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert rows[:, 0] == pytest.approx(np.arange(len(codes)) / design.detector.sample_rate_hz, abs=5e-7)
    assert rows[:, 1] == pytest.approx(codes * design.detector.adc_step_v, abs=1e-6)
    assert rows[:, 2] == pytest.approx(codes[::-1] * design.detector.adc_step_v, abs=1e-6)
    assert lines[0] == "0.000000,0.000000,0.805664"
    assert all(re.fullmatch(r"\d+(\.\d{6},\d+){2}\.\d{6}", line) for line in lines)


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


def test_the_longest_line_fits_and_negative_voltages_are_written(arduino: Path, tmp_path: Path) -> None:
    (tmp_path / "line.c").write_text(LINE_PROGRAM)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsanitize=address,undefined"]
    folders = [f"-I{arduino / 'src'}", f"-I{arduino / 'examples/slip_stream'}"]
    binary = tmp_path / "line"
    subprocess.run(["gcc", *flags, *folders, str(tmp_path / "line.c"), "-o", str(binary)], check=True)
    given = "4294967295 -100 -100\n3 -0.0000014 1\n7 0.0000004 -2\n"
    done = subprocess.run([str(binary)], input=given, capture_output=True, text=True, check=True)
    # After 24 days at 2 kHz the counter of samples is full.
    assert done.stdout.splitlines() == [
        "2147483.647500,-100.000000,-100.000000",
        "0.001500,-0.000001,1.000000",
        "0.003500,0.000000,-2.000000",
    ]


@pytest.mark.full
def test_detect_reads_the_stream_from_a_serial_port(arduino: Path, library: Library) -> None:
    """A pseudo-terminal stands for the port: the sketch writes to it, and `fingertip detect -` reads it as it comes."""
    design = library.design
    codes = slip_recording(design, 3.0).codes(design)
    first, second = pty.openpty()
    tty.setraw(first)
    tty.setraw(second)
    detect = subprocess.Popen(
        [sys.executable, "-m", "fingertip", "detect", "-", "--detector", "fast"],
        stdin=second, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT / "src")},
    )  # fmt: skip
    os.close(second)
    with subprocess.Popen([str(arduino / "slip_stream.run")], stdin=subprocess.PIPE, stdout=first) as sketch:
        os.close(first)  # the port closes when the sketch ends
        assert sketch.stdin
        sketch.stdin.write(as_lines(codes).encode())
        sketch.stdin.close()
    out, err = detect.communicate(timeout=60)
    on = library.detector("float").process_codes(*codes)
    changes = np.flatnonzero(np.diff(np.concatenate(([0], on.astype(int)))))
    expected = [(("OFF", "ON")[int(on[i])], round(i / design.detector.sample_rate_hz, 4)) for i in changes]
    found = [(line.split()[0], float(line.split()[1])) for line in out.splitlines()]
    assert found == expected, err
    assert found
