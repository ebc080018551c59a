"""Commands `fingertip simulate` and `fingertip detect`, on files and on standard input."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import fingertip
from fingertip.detection import files as detect_trace
from tests.slip.recordings import PLAIN, T, V, burst, csv, run

HEADER = "time_s,voltage_v,force_n,slip"


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
