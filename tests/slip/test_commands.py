"""Commands `fingertip simulate` and `fingertip detect`, on files and on standard input."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import fingertip
from fingertip.detection import files as detect_trace
from tests.slip.recordings import T, V, burst, csv, run

GOOD = [f"{i / 2000:.4f},2.3,0.8,0" for i in range(200)]
HEADER = "time_s,voltage_v,force_n,slip"


@pytest.fixture
def trace(tmp_path):
    def write(lines, header=HEADER):
        path = tmp_path / "t.csv"
        path.write_text("\n".join([header, *lines]) + "\n")
        return path

    return write


def edit(changes):
    lines = list(GOOD)
    for at, line in changes.items():
        lines[at] = line
    return lines


ARTICLE = ("--design", "article")


@pytest.mark.parametrize("surface", ["smooth", "medium", "gross", "wood", "paper", "plastic"])
def test_slip_of_a_simulated_trace_is_detected(tmp_path, surface):
    out = tmp_path / "new" / "trace.csv"
    words = ("--surface", surface, "--force-n", 1.0, "--seed", 5, "--json", "--quiet")
    done = run("simulate", "article", "--out", out, *words)
    assert done.exit_code == 0
    simulated = json.loads(done.stdout)
    lines = out.read_text().splitlines()
    assert lines[0] == HEADER
    assert len(lines) == simulated["samples"] + 1
    found = run("detect", out, *ARTICLE, "--json", "--quiet")
    assert found.exit_code == 0
    data = json.loads(found.stdout)
    assert data["slips"] == simulated["slips"]
    assert len(data["delays_s"]) == 1
    # On the smoothest surface the signal barely exceeds the noise of a 16-bit ADC ahead of the gain.
    assert 0.0 < data["delays_s"][0] < (0.2 if surface == "smooth" else 0.05)
    assert set(data["intervals"][0]) == {"onset_s", "end_s", "confidence"}
    assert data["intervals"][0]["confidence"] > 1.0
    assert data["incipient"] is data["learned_noise_v"] is None
    assert data["missed_slips"] == []


def test_detect_warns_if_every_sample_is_clipped(trace):
    top = 3.3 - 3.3 / 4096
    found = run("detect", trace([f"{i / 2000:.4f},{top:.6f},0.8,0" for i in range(200)]))
    assert "all 200 samples are at the limits of the ADC range" in found.stderr
    assert "is a sensor connected?" not in found.stderr


def test_detect_asks_for_the_sensor_of_a_dead_channel(trace):
    found = run("detect", trace([f"{i / 2000:.4f},0.0,0.8,0" for i in range(200)]))
    assert "the voltage is constant at 0 V; is a sensor connected?" in found.stderr
    assert "limits of the ADC range" not in found.stderr


def test_detect_without_true_slip_as_json_and_text(trace):
    path = trace([",".join(line.split(",")[:2]) for line in GOOD], "time_s,voltage_v")
    data = json.loads(run("detect", path, "--json").stdout)
    assert data["intervals"] == []
    assert data["slips"] is None
    assert (
        run("detect", path).stdout
        == "detector digital, on voltage_v, mean of the envelope: threshold 23 mV\nnever ON\n"
    )


INVALID = {
    "no column": (GOOD, "time_s,volts,force_n,slip", ["there is no column voltage_v; did you mean volts?"]),
    "no header": (GOOD, "1,2,3,4", ["is not the header of a trace"]),
    "duplicate column": (GOOD, "time_s,voltage_v,voltage_v,slip", ["column voltage_v appears 2 times"]),
    "nan": (edit({7: "0.0035,nan,0.8,0"}), HEADER, ["nan in line 9 is not a finite number"]),
    "word": (edit({7: "0.0035,4 V,0.8,0"}), HEADER, ["'4 V' in line 9 is not a number"]),
    "slip": (edit({7: "0.0035,4,0.8,2"}), HEADER, ["2 in line 9 is neither 0 nor 1"]),
    "cells": (edit({7: "0.0035,4"}), HEADER, ["line 9: has 2 cells, but the header has 4"]),
    "gap": (GOOD[:50] + GOOD[60:], HEADER, ["0.03 s in line 52 comes after a gap"]),
    "repeated": (GOOD[:50] + GOOD[49:], HEADER, ["0.0245 s in line 52 repeats the time before it"]),
    "backwards": (
        GOOD[:50] + GOOD[40:],
        HEADER,
        ["0.02 s in line 52 goes backwards (previous time 0.0245 s, median step 0.0005 s)"],
    ),
    "short": (GOOD[:59], HEADER, ["has 59 samples; at least one window of 60 is required"]),
    "several": (
        edit({3: "0.0015,nan,0.8,0", 7: "0.0035,4,x,0", 9: "0.0020,4,0.8,0"}),
        HEADER,
        ["nan in line 5", "'x' in line 9", "0.002 s in line 11 goes backwards"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", INVALID)
def test_invalid_traces_give_errors_and_write_nothing(trace, tmp_path, name):
    lines, header, messages = INVALID[name]
    picture = tmp_path / "p.png"
    picture.write_text("mine")
    done = run("detect", trace(lines, header), "--plot", picture)
    assert done.exit_code == 2
    assert done.stdout == ""
    for message in messages:
        assert message in done.stderr
    assert all(line.startswith("error: ") for line in done.stderr.splitlines())
    assert picture.read_text() == "mine"


@pytest.mark.parametrize("content", [b"", b"\x89PNG\x00\xff\xfe", b"hello\nworld\n", b"\n\n"])
def test_files_that_are_not_csv_give_an_error(tmp_path, content):
    path = tmp_path / "t.csv"
    path.write_bytes(content)
    done = run("detect", path, "--json")
    assert done.exit_code == 2
    (issue,) = json.loads(done.stdout)["issues"]
    assert str(path) in issue["field"]


def test_simulate_reports_every_issue_and_writes_nothing(tmp_path):
    out = tmp_path / "t.csv"
    done = run(
        "simulate", "--out", out, "--surface", "ice", "--speed-m-s", -1, "--force-n", 99, "--seed", -3,
        "--set", "detector.window_samples=3000", "--set", "detector.threshold_v=9",
    )  # fmt: skip
    assert done.exit_code == 2
    fields = [line.split(": ")[1] for line in done.stderr.splitlines()]
    assert fields == [
        "detector.window_samples", "detector.threshold_v", "--surface", "--speed-m-s", "--force-n", "--seed",
    ]  # fmt: skip
    assert not out.exists()


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
