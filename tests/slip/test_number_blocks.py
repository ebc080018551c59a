"""Blocks of lines: parsed at once they give what each line gives, to the last bit and message."""

from __future__ import annotations

import io
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fingertip
from fingertip.detection.recordings import find_force_scale
from fingertip.foundation import jit
from fingertip.slip.detectors import analog_and_digital
from fingertip.slip.force import MEAN_S
from fingertip.slip.traces import csv_file, number_blocks, trace
from fingertip.slip.traces.csv_file import read_csv
from fingertip.slip.traces.number_blocks import parse_numbers
from fingertip.slip.traces.trace import ColumnMap, RawTrace
from tests.slip.recordings import PLAIN, T, V, csv

LINES = PLAIN.splitlines(keepends=True)
DAMAGES: dict[str, Callable[[list[str]], None]] = {
    "nothing": lambda lines: None,
    "empty line, then a gap": lambda lines: lines.__setitem__(slice(900, 903), ["\n"]),
    "text": lambda lines: lines.__setitem__(900, "0.4495,bananas\n"),
    "empty cell": lambda lines: lines.__setitem__(1500, "0.749500,\n"),
    "quoted": lambda lines: lines.__setitem__(1500, '"0.749500","2.3"\n'),
    "sign and spaces": lambda lines: lines.__setitem__(1500, " +0.7495 , +2.3 \n"),
    "NaN": lambda lines: lines.__setitem__(1500, "0.749500,nan\n"),
    "too many cells": lambda lines: lines.__setitem__(1500, "0.749500,2.3,2.3\n"),
    "header and units again": lambda lines: lines.__setitem__(
        slice(1000, 1000), [LINES[0], "s,V\n"]
    ),
    "units alone": lambda lines: lines.__setitem__(
        slice(1000, 1000), [LINES[0], *["0.5,2.3\n"] * 11, "s,V\n"]
    ),
    "units alone, after an even number": lambda lines: lines.__setitem__(
        slice(1001, 1001), [LINES[0], *["0.5,2.3\n"] * 12, "s,V\n"]
    ),
    "comment": lambda lines: lines.insert(1000, "# 5,6\n"),
    "cut off": lambda lines: lines.__setitem__(-1, "0.99"),
    "out of range": lambda lines: lines.__setitem__(1500, "0.749500,7.5\n"),
    "backwards": lambda lines: lines.__setitem__(1500, "0.1,2.3\n"),
}


@pytest.fixture(params=DAMAGES)
def damaged(request: pytest.FixtureRequest) -> list[str]:
    lines = list(LINES)
    DAMAGES[request.param](lines)
    return lines


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1), st.booleans())
def test_both_parsers_round_as_python_does(numbers: list[float], is_short: bool) -> None:
    pytest.importorskip("pyarrow")
    cells = [f"{number:.7g}" if is_short else repr(number) for number in numbers]
    block = "".join(f"{cell},x\n" for cell in cells)
    expected = np.array([float(cell) for cell in cells])
    arrow = number_blocks._parse_by_arrow(block, ",", 2, [0])
    numpy = number_blocks._parse_by_numpy(block.replace("x", "0"), ",", 2, [0])
    assert arrow is not None
    assert numpy is not None
    assert arrow[0].tobytes() == numpy[0].tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    "line", ["", "1", "1,2,3", "1,", "1,nan", "1,inf", "1,1e999", "1,NA", "#1,2", '"1",2', "1,1_0"]
)
@pytest.mark.parametrize("arrow_from", [0, sys.maxsize])
def test_a_block_with_another_line_is_refused(
    line: str, arrow_from: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(number_blocks, "_ARROW_FROM", arrow_from)
    assert parse_numbers("1,2\n3,4\n", ",", 2, [1, 0]) is not None
    assert parse_numbers(f"1,2\n{line}\n3,4\n", ",", 2, [1, 0]) is None


@pytest.mark.parametrize("line", ['"a,b",1,2', "#a,b,1,2"])
def test_a_quote_or_comment_in_a_column_that_is_not_read(
    line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.setattr(number_blocks, "_ARROW_FROM", 0)
    assert parse_numbers("a,b,1,2\na,b,1,2\n", ",", 4, [2, 3]) is not None
    assert parse_numbers(f"a,b,1,2\n{line}\n", ",", 4, [2, 3]) is None


def test_arrays_are_read_without_pandas() -> None:
    pytest.importorskip("pyarrow")
    code = (
        "import sys; from fingertip.slip.traces import number_blocks as blocks; "
        "blocks._parse_by_arrow('1,2\\n', ',', 2, [0]); sys.exit('pandas' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def describe(raw: RawTrace) -> tuple[object, ...]:
    assert raw.lines is not None
    issues = [str(issue) for issue in raw.find_issues(fingertip.Design().detector)]
    columns = (raw.trace.time_s.tobytes(), raw.trace.voltage_v.tobytes())
    return columns, list(raw.lines), issues, raw.notes, raw.has_all_times


@pytest.mark.parametrize("arrow_from", [0, sys.maxsize])
@pytest.mark.parametrize("length", [18, 1000])
def test_a_file_in_blocks_is_read_as_line_by_line(
    damaged: list[str], length: int, arrow_from: int, tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "t.csv"
    path.write_text("".join(damaged))
    with monkeypatch.context() as patch:
        patch.setattr(csv_file, "parse_numbers", lambda *_: None)
        expected = describe(read_csv(path, ColumnMap()))

    monkeypatch.setattr(trace, "MAX_LINE", length)
    monkeypatch.setattr(number_blocks, "_ARROW_FROM", arrow_from)
    assert describe(read_csv(path, ColumnMap())) == expected


def test_a_line_is_counted_after_an_empty_one(tmp_path) -> None:
    (tmp_path / "t.csv").write_text("".join([*LINES[:900], "\n", *LINES[902:]]))
    with pytest.raises(fingertip.FingertipError, match="s in line 902 comes after a gap"):
        fingertip.detect_file(tmp_path / "t.csv")


def follow(lines: object, detector: str) -> tuple[list[object], list[str], str]:
    found = list[object]()
    reported = list[str]()
    problem = ""
    try:
        detection = fingertip.detect_stream(lines, detector=detector, progress=reported.append)  # type: ignore[arg-type]
        found.extend(detection.transitions)
    except fingertip.FingertipError as error:
        problem = str(error)

    return found, reported, problem


@pytest.mark.parametrize("detector", ["digital", "fast"])
def test_a_stream_in_blocks_is_judged_as_line_by_line(damaged: list[str], detector: str) -> None:
    whole = follow(io.BytesIO("".join(damaged).encode()), detector)
    assert whole == follow(iter(damaged), detector)


def test_a_stream_that_begins_in_vibration_is_warned_of_alike() -> None:
    time_s = np.arange(10_000) / 2000.0
    noise_v = np.random.default_rng(3).normal(0, 4e-4, len(time_s))
    volts = 2.3 + noise_v + 0.01 * np.sin(2 * np.pi * 90 * time_s) * (time_s < 0.6)
    lines = csv(time_s, volts).splitlines(keepends=True)
    whole = follow(io.BytesIO("".join(lines).encode()), "fast")
    assert whole == follow(iter(lines), "fast")
    assert any("begins in more vibration" in line for line in whole[1])


def test_a_long_stream_warns_at_the_same_samples() -> None:
    noise = np.random.default_rng(2).normal(0, 4e-4, 9000)
    volts = np.concatenate([V, np.full(3000, 2.5), 2.4 + noise])
    lines = csv(np.arange(len(volts)) / 2000.0, volts).splitlines(keepends=True)
    for detector in ("digital", "fast", "fft"):
        whole = follow(io.BytesIO("".join(lines).encode()), detector)
        assert whole == follow(iter(lines), detector)
        assert whole[0]
        assert any("warning" in line for line in whole[1])


class Trickle(io.BytesIO):
    """Buffer in which 100 bytes arrive at a time."""

    def read1(self, size: int | None = -1) -> bytes:
        return super().read1(100)


@pytest.mark.parametrize("end", ["", "\n"])
def test_a_line_that_never_ends_is_refused_in_a_stream(
    end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trace, "MAX_LINE", 1000)
    text = "".join([*LINES[:300], "1" * 5000]) + end
    problem = follow(Trickle(text.encode()), "fft")[2]
    assert "line 301: is longer than 1000 characters" in problem


def test_a_stream_is_judged_alike_however_it_arrives() -> None:
    whole = follow(io.BytesIO(PLAIN.encode()), "fast")
    assert whole == follow(Trickle(PLAIN.encode()), "fast")


@pytest.mark.parametrize("read", [io.BytesIO, lambda data: data.splitlines(keepends=True)])
def test_the_force_of_a_transition_is_that_of_the_mean_voltage_before_it(
    read: Callable[[bytes], object],
) -> None:
    design = fingertip.Design()
    scale = find_force_scale(design)
    assert scale is not None
    text = csv(T, V - 1.4)  # at 0.9 V the curve is known
    first = next(fingertip.detect_stream(read(text.encode()), design).transitions)  # type: ignore[arg-type]
    volts = np.round(V - 1.4, 6)[: round(first.time_s * 2000) + 1]
    share = 1 / (MEAN_S * 2000)
    weights = share * (1 - share) ** np.arange(len(volts))[::-1]
    weights[0] /= share
    assert first.force is not None
    assert first.force.force_n == pytest.approx(
        scale.read(float(weights @ volts)).force_n, rel=1e-9
    )


def test_only_a_stream_that_is_behind_waits_for_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    run_compiled = jit.CompiledLoop._run_compiled
    compiled_loops = list[object]()

    def note(loop: jit.CompiledLoop, arguments: tuple[object, ...]) -> None:
        compiled_loops.append(loop)
        run_compiled(loop, arguments)

    monkeypatch.setattr(jit.CompiledLoop, "_run_compiled", note)
    with jit.compiled():
        live = follow(Trickle(PLAIN.encode()), "digital")
        assert analog_and_digital._FILTER not in compiled_loops
        assert follow(io.BytesIO(PLAIN.encode()), "digital") == live

    assert analog_and_digital._FILTER in compiled_loops
