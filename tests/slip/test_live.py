"""`fingertip detect -`: detection on lines from standard input."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import fingertip
from fingertip.detection import files as detect_trace
from tests.slip.recordings import T, V, burst, csv, run

PLAIN = csv(T, V)


@pytest.mark.full
@pytest.mark.parametrize("detector", ["digital", "fft", "fast"])
def test_a_stream_gives_the_same_transitions_as_the_file(tmp_path, detector):
    (tmp_path / "t.csv").write_text(csv(T, V))
    whole = json.loads(run("detect", tmp_path / "t.csv", "--detector", detector, "--json").stdout)["intervals"]
    data = json.loads(run("detect", "-", "--detector", detector, "--json", lines=csv(T, V)).stdout)
    assert [transition["time_s"] for transition in data["transitions"]] == [
        time for i in whole for time in (i["onset_s"], i["end_s"])
    ]
    text = run("detect", "-", "--detector", detector, lines=csv(T, V)).stdout.splitlines()
    assert text[0] == f"ON   {whole[0]['onset_s']:9.4f} s"


@pytest.mark.full
def test_an_invalid_line_ends_the_stream_after_the_transitions_before_it():
    lines = csv(T, V).splitlines()
    for invalid, message in (
        ("1500", "line 1500: has 1 cells, but the header has 2"),
        ("0.749,nan", "line 1500: nan is not a finite number"),
        ("0.749,4 V", "line 1500: '4 V' is not a number"),
        ("0.8,2.3", "line 1500: 0.8 s is 0.0515 s after the previous sample"),
        ("0.7485,2.3", "line 1500: 0.7485 s is 0 s after the previous sample"),
    ):
        edited = [*lines[:1499], invalid, *lines[1500:]]
        done = run("detect", "-", lines="\n".join(edited))
        assert done.exit_code == 2
        assert message in done.stderr
        assert done.stdout.splitlines()[0].startswith("ON ")
    # What a controller says among its samples is quoted, shortened.
    for said, quoted in (
        ("no timer is free", "'no timer is free'"),
        ("0.749,x\x07" + 300 * "y", "...(308 characters)..."),
    ):
        done = run("detect", "-", lines="\n".join([*lines[:1499], said, *lines[1500:]]))
        assert f"The line reads '{said[:5]}" in done.stderr
        assert quoted in done.stderr
        assert "\x07" not in done.stderr
    assert "is empty" in run("detect", "-", lines="").stderr
    empty = run("detect", "-", lines="time_s,voltage_v\n")
    assert empty.exit_code == 2
    assert "has no samples below its header" in empty.stderr
    assert "requires the whole recording" in run("detect", "-", "--plot", "p.png", lines=csv(T, V)).stderr


@pytest.mark.parametrize("rate", [1400, 1900, 1980, 2020, 2100, 2990])
def test_another_sampling_rate_gives_the_same_message_as_a_file(rate):
    t, v = burst(rate)
    done = run("detect", "-", lines=csv(t, v))
    assert done.exit_code == 2
    rates = re.search(
        r"is sampled at ([\d.]+) Hz, but the detector is designed for 2000 Hz .*-hz ([\d.]+)", done.stderr
    )
    assert rates
    assert float(rates[1]) == float(rates[2]) == pytest.approx(rate, rel=1e-3)
    assert run("detect", "-", "--rate-hz", rate, "--quiet", lines=csv(t, v)).stdout.startswith("ON      0.50")


def test_jitter_is_accepted_and_a_change_of_rate_is_not():
    t, v = burst()
    jittered = t + np.random.default_rng(2).uniform(-1e-4, 1e-4, len(t))
    assert run("detect", "-", lines=csv(jittered, v)).exit_code == 0
    t, v = np.concatenate((t, t[-1] + np.arange(1, 8000) / 2040)), np.full(9999, 2.3)
    done = run("detect", "-", lines=csv(t, v))  # 2 % faster from the first second on
    assert "the detector is designed for 2000 Hz" in done.stderr


def test_voltages_outside_the_adc_range_give_an_error():
    for v, message in (
        (np.round(V / 3.3 * 4096), "line 2: 2855 exceeds the ADC range of 0 to 3.3 V; the values are whole numbers"),
        (1000 * V, "exceeds the ADC range of 0 to 3.3 V; use --scale if the column is not in volts"),
        (np.where(T < 0.1, V, 11.0), "line 202: 11 exceeds the ADC range of 0 to 3.3 V; use --scale"),
    ):
        done = run("detect", "-", lines=csv(T, v))
        assert done.exit_code == 2
        assert message in done.stderr
    assert run("detect", "-", "--scale", 0.001, lines=csv(T, 1000 * V)).stdout.startswith("ON")


@pytest.mark.full
def test_transitions_are_reported_whatever_ends_the_stream(monkeypatch):
    whole = json.loads(run("detect", "-", "--json", lines=PLAIN).stdout)
    assert json.loads(run("detect", "-", "--json", lines=PLAIN + "\n \n").stdout) == whole
    invalid = json.loads(run("detect", "-", "--json", lines=PLAIN + "1.0,x\n").stdout)
    assert invalid["transitions"] == whole["transitions"]
    assert invalid["issues"][0]["field"] == "standard input, line 2002"

    def interrupted(*_):
        yield from PLAIN.splitlines(keepends=True)
        raise KeyboardInterrupt

    open_stream = detect_trace.open_stream
    monkeypatch.setattr(detect_trace, "open_stream", lambda lines, *columns: open_stream(interrupted(), *columns))
    done = run("detect", "-", "--json", lines="")
    assert done.exit_code == 130
    assert json.loads(done.stdout) == whole


def test_detect_stream_in_python_yields_transitions_as_lines_arrive():
    lines = csv(T, V).splitlines()
    taken = 0

    def count_lines():
        nonlocal taken
        for line in lines:
            taken += 1
            yield line

    found = fingertip.detect_stream(count_lines(), detector="fast")
    first = next(found.transitions)
    assert first.on
    # Lines 1 and 2 are the header and the sample at 0 s.
    assert T[taken - 2] == pytest.approx(first.time_s)
    (last,) = found.transitions
    assert not last.on
    assert found.warnings == ()


def test_a_stream_without_detection_says_so():
    quiet = csv(T, V).splitlines()
    assert run("detect", "-", lines="\n".join(quiet[:100])).stdout == "never ON\n"
    short = run("detect", "-", lines="\n".join(quiet[:31]))
    assert short.exit_code == 2
    assert "has 30 samples; at least one window of 60 is required; record for longer." in short.stderr
