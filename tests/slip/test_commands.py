"""Commands `fingertip simulate` and `fingertip detect`: options,
streams, and other rates than the design's.
"""

from __future__ import annotations

import io
import json
import re
import shlex

import numpy as np
import pytest

import fingertip
from fingertip.design import Design
from fingertip.detection import live
from fingertip.detection.adaptation import adapt_rate
from fingertip.foundation.errors import FingertipError
from fingertip.slip.detectors.analog_and_digital import noise_level
from fingertip.slip.traces.sampling import (
    MAX_RATE_HZ,
    MIN_RATE_HZ,
    find_rounding,
    rate_bounds_message,
)
from tests.slip.recordings import ONSET, PLAIN, T, V, burst, csv, rows, run, single_onset

ARTICLE = (
    "--design",
    "article",
    "--set",
    "detector.threshold_v=0.017",
    "--set",
    "detector.kind=fast",
    "--detector",
    "digital",
)


@pytest.mark.parametrize("surface", ["smooth", "medium", "gross", "wood", "paper", "plastic"])
def test_slip_of_a_simulated_trace_is_detected(tmp_path, surface):
    out = tmp_path / "new" / "trace.csv"
    words = ("--surface", surface, "--force-n", 1.0, "--seed", 5, "--json", "--quiet")
    done = run("simulate", "article", "--out", out, *words)
    assert done.exit_code == 0
    simulated = json.loads(done.stdout)
    lines = out.read_text().splitlines()
    assert lines[0] == "time_s,voltage_v,force_n,slip"
    assert len(lines) == simulated["samples"] + 1
    found = run("detect", out, *ARTICLE, "--json", "--quiet")
    assert found.exit_code == 0
    data = json.loads(found.stdout)
    assert data["slips"] == simulated["slips"]
    assert len(data["delays_s"]) == 1
    # On the smoothest surface the signal barely exceeds the noise of a 16-bit ADC ahead of the
    # gain.
    assert 0.0 < data["delays_s"][0] < (0.2 if surface == "smooth" else 0.05)
    assert set(data["intervals"][0]) == {
        "onset_s",
        "end_s",
        "strength",
        "force_n",
        "force_interval_n",
    }
    assert data["intervals"][0]["strength"] > 1.0
    assert data["incipient"] is data["learned_noise_v"] is None
    assert data["missed_slips"] == []


def test_without_a_detector_the_designs_own_judges(tmp_path):
    """Its result is that of the detector by its name; without a design the article's chain is."""
    trace = tmp_path / "t.csv"
    trace.write_text(PLAIN)
    divider = ("--set", "board.variant=divider")
    for words, kind, is_said in (
        (("--design", "fsr400"), "fast", True),
        (("--design", "article"), "analog", True),
        (("--set", "detector.kind=fft"), "fft", True),
        (divider, "fast", True),
        ((), "digital", False),
    ):
        done = run("detect", trace, *words, "--json")
        assert done.stdout == run("detect", trace, *words, "--detector", kind, "--json").stdout
        assert json.loads(done.stdout)["detector"] == kind
        assert (f"detector {kind}, that of the design" in done.stderr) == is_said


def test_simulate_reports_every_issue_and_writes_nothing(tmp_path):
    out = tmp_path / "t.csv"
    done = run(
        "simulate",
        "--out",
        out,
        "--surface",
        "ice",
        "--speed-m-s",
        -1,
        "--force-n",
        99,
        "--seed",
        -3,
        "--set",
        "detector.window_samples=3000",
        "--set",
        "detector.threshold_v=9",
    )
    assert done.exit_code == 2
    fields = [line.split(": ")[1] for line in done.stderr.splitlines()]
    assert fields == [
        "detector.window_samples",
        "detector.threshold_v",
        "--surface",
        "--speed-m-s",
        "--force-n",
        "--seed",
    ]
    assert not out.exists()


@pytest.mark.every_case
@pytest.mark.parametrize("detector", ["analog", "digital", "fft", "fast"])
def test_a_stream_gives_the_same_transitions_as_the_file(tmp_path, detector):
    (tmp_path / "t.csv").write_text(csv(T, V))
    whole = json.loads(run("detect", tmp_path / "t.csv", "--detector", detector, "--json").stdout)[
        "intervals"
    ]
    data = json.loads(run("detect", "-", "--detector", detector, "--json", lines=csv(T, V)).stdout)
    assert [transition["time_s"] for transition in data["transitions"]] == [
        time for i in whole for time in (i["onset_s"], i["end_s"])
    ]
    text = run("detect", "-", "--detector", detector, lines=csv(T, V)).stdout.splitlines()
    assert text[0].startswith(f"ON   {whole[0]['onset_s']:9.4f} s, at ")
    assert data["transitions"][0]["force_n"] == pytest.approx(whole[0]["force_n"], rel=0.1)


@pytest.mark.parametrize("rate", [1400, 1900, 1980, 2020, 2100, 2990])
def test_another_sampling_rate_gives_the_same_message_as_a_file(rate):
    t, v = burst(rate)
    assert run("detect", "-", "--quiet", lines=csv(t, v)).stdout.startswith("ON      0.50"), (
        "unless one is stated"
    )
    done = run("detect", "-", "--set", "detector.sample_rate_hz=2000", lines=csv(t, v))
    assert done.exit_code == 2
    rates = re.search(
        r"is sampled at ([\d.]+) Hz, but the .* designed for 2000 Hz .*-hz ([\d.]+)", done.stderr
    )
    assert rates
    assert float(rates[1]) == float(rates[2]) == pytest.approx(rate, rel=1e-3)
    assert run("detect", "-", "--rate-hz", rate, "--quiet", lines=csv(t, v)).stdout.startswith(
        "ON      0.50"
    )


def test_jitter_is_accepted_and_a_change_of_rate_is_not():
    t, v = burst()
    jittered = t + np.random.default_rng(2).uniform(-1e-4, 1e-4, len(t))
    assert run("detect", "-", lines=csv(jittered, v)).exit_code == 0
    t = np.concatenate((t, t[-1] + np.arange(1, 8000) / 2040))
    v = np.full(9999, 2.3)
    done = run("detect", "-", lines=csv(t, v))  # 2 % faster from the first second on
    assert "the detector is designed for 2000 Hz" in done.stderr


def test_several_voltages_of_a_stream_are_judged_alone():
    begins = [f"{t:.4f},{v:.6f},2.3" for t, v in zip(T, V, strict=True)]
    lines = "time_s,A0,still,A2\n" + rows(begins, volts=np.roll(V, 400))
    options = ("--column", "voltage_v=A0", "--column", "voltage_v=4", "--column", "voltage_v=still")
    found = json.loads(run("detect", "-", "--json", *options, lines=lines).stdout)["transitions"]
    onsets = {each["channel"]: each["time_s"] for each in found if each["on"]}
    assert onsets == {"A0": ONSET, "4": pytest.approx(ONSET + 0.2, abs=0.002)}
    assert (
        "no column A1; known"
        in run("detect", "-", *options[:3], "voltage_v=A1", lines=lines).stderr
    )


def test_transitions_are_reported_whatever_ends_the_stream(monkeypatch):
    whole = json.loads(run("detect", "-", "--json", lines=PLAIN).stdout)
    assert json.loads(run("detect", "-", "--json", lines=PLAIN + "\n \n").stdout) == whole
    invalid = json.loads(run("detect", "-", "--json", lines=PLAIN + "1.0,x\n").stdout)
    assert invalid["transitions"] == whole["transitions"]
    assert invalid["issues"][0]["field"] == "standard input, line 2002"

    def interrupted(*_):
        yield from PLAIN.splitlines(keepends=True)
        raise KeyboardInterrupt

    open_stream = live.open_stream
    monkeypatch.setattr(
        live, "open_stream", lambda lines, *columns: open_stream(interrupted(), *columns)
    )
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


def test_a_force_is_detected_with_thresholds_from_a_quiet_part(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, 50 * (V - 3.9), header=("time_s", "force_n")))
    words = ("detect", tmp_path / "t.csv", "--column", "voltage_v=force_n")
    assert "thresholds are in volts, but this column is a force" in run(*words).stderr
    for detector in ("digital", "fft", "fast"):
        options = "--calibrate", "0:0.4", "--detector", detector, "--json"
        done, small = (run(*words, *options, "--scale", scale) for scale in (1, 1e-3))
        assert 0.5 < single_onset(done) < 0.535
        done, small = (json.loads(each.stdout) for each in (done, small))
        assert small["intervals"] == done["intervals"], "a force is in any unit"
        assert small["threshold_v"] == pytest.approx(1e-3 * done["threshold_v"], rel=0.01)
        assert "thousandths of force_n" in run(*words, *options[:-1]).stdout


def test_a_recording_that_begins_in_slip_is_decided_with_the_floors_of_a_rest(tmp_path):
    rest, slip = np.random.default_rng(3).normal(2.3, [[4e-4], [4e-3]], (2, 4000))
    late = np.concatenate([slip, rest])
    flicker = np.concatenate([np.where(rest > 2.3, 2.3, 2.305), 2.3 + (rest - 2.3) / 8])
    signals = {
        "rest": rest[:1001],
        "short": rest[:1000],
        "slip": slip,
        "late": late,
        "flicker": flicker,
    }
    texts = {name: csv(np.arange(len(volts)) / 2000, volts) for name, volts in signals.items()}
    for name, text in texts.items():
        (tmp_path / name).with_suffix(".csv").write_text(text)
    words = ("--detector", "fast", "--json")
    rested = ("--floors", tmp_path / "rest.csv")
    for name, end_s, said in (
        ("slip", 2.0, "noise of 3.9 mV, 8 times"),
        ("late", 2.08, "before 2.1 s"),
    ):
        done = json.loads(run("detect", tmp_path / f"{name}.csv", *words, "-q").stdout)
        assert (done["intervals"], done["undecided"]["end_s"]) == (
            [],
            pytest.approx(end_s, abs=0.05),
        )
        assert said in done["warnings"][0]
        done = run("detect", "-", *words, "-q", lines=texts[name])
        assert "if something slides all the time" in json.loads(done.stdout)["warnings"][0]
    assert json.loads(run("detect", tmp_path / "flicker.csv", *words).stdout)["undecided"] is None
    assert "begins in more" not in run("detect", "-", *words, lines=texts["flicker"]).stdout
    done = json.loads(run("detect", tmp_path / "slip.csv", *words, *rested).stdout)
    assert (done["intervals"][0]["onset_s"] < 0.1, done["undecided"], done["warnings"]) == (
        True,
        None,
        [],
    )
    streamed = json.loads(run("detect", "-", *words, *rested, lines=texts["slip"]).stdout)
    assert streamed["transitions"][0]["time_s"] == done["intervals"][0]["onset_s"]
    for name, options, said in (
        ("short", (), "the rest lasts 0.499 s"),
        ("slip", (), "the rest vibrates by 3.9 mV, over 5 times the stated"),
        ("rest", ("--detector", "digital"), "are not learned by digital"),
        ("rest", ("--calibrate", "0:1"), "are not"),
    ):
        refused = run(
            "detect", tmp_path / "slip.csv", *words, *options, "--floors", tmp_path / f"{name}.csv"
        ).stderr
        assert f"--floors: {said}" in refused


def test_adc_counts_are_converted_by_the_suggested_scale(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.round(V / 3.3 * 4096)))
    words = ("detect", tmp_path / "t.csv", "--json")
    assert "--scale 0.00080566406 converts counts of 12 bits to volts" in run(*words).stderr
    assert single_onset(run(*words, "--scale", 0.00080566406)) == pytest.approx(ONSET, abs=0.003)


def test_detect_file_in_python_gives_the_result_of_the_command(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v, header=("t", "AI0")))
    progress: list[str] = []
    columns = {"time_s": "t", "voltage_v": "AI0"}
    found = fingertip.detect_file(
        tmp_path / "t.csv", columns=columns, calibrate_s=(0.0, 0.4), progress=progress.append
    )
    words = ("--column", "time_s=t", "--column", "voltage_v=AI0", "--calibrate", "0:0.4", "--json")
    done = run("detect", tmp_path / "t.csv", *words)
    assert found.detection.intervals[0].onset_s == pytest.approx(single_onset(done))
    assert found.design.detector.sample_rate_hz == 5000
    assert progress == done.stderr.splitlines()
    assert found.warnings == ()


def test_detect_file_in_python_adapts_a_design_that_states_no_rate(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    chosen = Design(detector={"threshold_v": 0.0123})
    assert fingertip.detect_file(tmp_path / "t.csv", chosen).detection.threshold_v == 0.0123
    with pytest.raises(
        fingertip.FingertipError, match="sampled at 5000 Hz, but the detector is designed for 2000"
    ):
        fingertip.detect_file(tmp_path / "t.csv", Design(detector={"sample_rate_hz": 2000.0}))


def test_the_shortest_quiet_part_in_the_message_is_long_enough(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, V))
    for detector, seconds in (("fast", "0.3"), ("analog", "0.33")):
        words = ("detect", tmp_path / "t.csv", "--detector", detector, "--calibrate")
        assert (
            f"covers 1 sample of t.csv; choose at least {seconds} s."
            in run(*words, "0:0.0001").stderr
        )
        assert run(*words, f"0:{seconds}").exit_code == 0


def test_calibration_on_any_interval(tmp_path):
    """Noise that begins with the grasp is calibrated there: an
    interval in the air gives a lower threshold.
    """
    rng = np.random.default_rng(8)
    t = np.arange(12_000) / 2000
    volts = 2.6 + rng.normal(0, 4e-4, len(t)) + (t > 3.0) * (rng.normal(0, 1.2e-3, len(t)) - 0.3)
    (tmp_path / "t.csv").write_text(csv(t, volts))

    def threshold_v(interval: str) -> float:
        return json.loads(
            run("detect", tmp_path / "t.csv", "--calibrate", interval, "--json").stdout
        )["threshold_v"]

    assert threshold_v("4.0:4.5") == pytest.approx(threshold_v("5:5.9"), rel=0.25)
    assert threshold_v("4.0:4.5") > 2 * threshold_v("0.5:2.5")


@pytest.mark.full
@pytest.mark.parametrize("rate", [1000, 5000, 20000])
@pytest.mark.parametrize("detector", ["digital", "fft", "fast"])
def test_detectors_adapt_to_the_sampling_rate_of_a_file(tmp_path, rate, detector):
    t, v = burst(rate)
    (tmp_path / "t.csv").write_text(csv(t, v))
    done = run("detect", tmp_path / "t.csv", "--detector", detector, "--json")
    assert f"is sampled at {rate} Hz: filters adapted to {rate} Hz" in done.stderr
    assert 0.5 < single_onset(done) < {"digital": 0.525, "fft": 0.54, "fast": 0.535}[detector]
    stated = run("detect", tmp_path / "t.csv", "--detector", detector, "--rate-hz", rate, "--json")
    assert stated.stdout == done.stdout
    # A stated rate is not adapted.
    for options in (("--set", "detector.sample_rate_hz=2000"), ("--rate-hz", 2000)):
        done = run("detect", tmp_path / "t.csv", *options)
        assert done.exit_code == 2
        assert f"is sampled at {rate} Hz, but the detector is designed for 2000 Hz" in done.stderr


def test_adaptation_keeps_the_windows_duration_and_the_ratio_of_threshold_to_noise():
    adapted = adapt_rate(Design(), 8000.0)
    assert adapted.detector.window_samples == 240
    ratio = adapted.detector.threshold_v / noise_level(adapted).threshold_v
    assert ratio == pytest.approx(Design().detector.threshold_v / noise_level(Design()).threshold_v)
    assert adapt_rate(Design(), 2000.0) == Design()


def test_a_stated_threshold_does_not_change_with_the_rate(tmp_path):
    t, v = burst(5000)
    (tmp_path / "t.csv").write_text(csv(t, v))
    (tmp_path / "d.toml").write_text("[detector]\nthreshold_v = 0.0123\n")
    rate = ("--rate-hz", 5000)
    mine = ("--set", "detector.threshold_v=0.0123")
    default = Design().detector.threshold_v
    adapted = adapt_rate(Design(), 5000.0).detector.threshold_v
    assert adapted != pytest.approx(default, rel=0.05)
    for words, volts, message in (
        ((), adapted, f"the threshold is {adapted:.3g} V"),
        (mine, 0.0123, "the window is 150 samples, 30 ms; the threshold is 0.0123 V"),
        (
            (*rate, *mine),
            0.0123,
            "adapted to 5000 Hz; the window is 150 samples, 30 ms; the threshold is 0.0123",
        ),
        (
            (*rate, "--design", tmp_path / "d.toml", "--detector", "digital"),
            0.0123,
            "the threshold is 0.0123 V",
        ),
        ((*rate, "--detector", "analog"), default, f"the threshold is {default:g} V"),
    ):
        done = run("detect", tmp_path / "t.csv", *words, "--json")
        assert json.loads(done.stdout)["threshold_v"] == pytest.approx(volts, abs=2e-6), words
        assert message in done.stderr, words
    fast = run("detect", tmp_path / "t.csv", "--detector", "fast")
    assert "filters adapted to 5000 Hz; the window is 150 samples, 30 ms\n" in fast.stderr


@pytest.mark.full
@pytest.mark.parametrize("rate", [1200, 2000, 3000, 5000])
@pytest.mark.parametrize("cut", [np.floor, np.round])
def test_rounded_times_are_ignored_with_the_options_in_the_message(tmp_path, rate, cut):
    t, v = burst(rate)
    coarse = cut(np.round(1000 * t, 6)) / 1000
    (tmp_path / "t.csv").write_text(csv(coarse, v))
    np.savez(tmp_path / "t.npz", time_s=coarse, voltage_v=v)
    np.save(tmp_path / "t.npy", np.column_stack((coarse, v)))
    for name in ("t.csv", "t.npz", "t.npy"):
        onsets = set()
        for stated in ((), ("--rate-hz", rate)):
            done = run("detect", tmp_path / name, *stated)
            assert done.exit_code == 2
            (message,) = [line for line in done.stderr.splitlines() if line.startswith("error")]
            assert f"the times are rounded to 0.001 s, at a mean rate of {rate} Hz" in message
            assert "is sampled at" not in done.stderr
            remedy = shlex.split(re.search(r"ignore them with (.*)$", message)[1])
            assert remedy == ["--rate-hz", str(rate), "--column", "time_s=none"]
            onsets.add(single_onset(run("detect", tmp_path / name, *remedy, "--json")))
        (onset,) = onsets
        assert 0.5 < onset < 0.525
    live = run("detect", "-", "--rate-hz", rate, lines=csv(np.floor(1000 * t) / 1000, v)).stderr
    assert f"ignore rounded times with --rate-hz {rate} --column time_s=none" in live


def test_only_evenly_spaced_times_are_recognised_as_rounded():
    assert find_rounding(T) is None
    assert find_rounding(np.zeros(100)) is None
    assert find_rounding(np.sort(np.append(T, T[7]))) is None  # one
    assert find_rounding(np.sort(np.append(T, T[:300]))) is None  # many, all at the start
    assert find_rounding(np.where(np.arange(2000) % 2, T - 0.001, T)[::-1]) is None  # backwards
    whole = find_rounding(np.floor(T * 4))  # whole seconds do not determine the rate
    assert whole is not None
    assert whole.rate_hz is None
    assert find_rounding(np.round(np.arange(100_000) / 4567, 3)).rate_hz == pytest.approx(
        4567, rel=1e-4
    )


def test_bounds_of_the_sampling_rate_are_those_of_a_design():
    for rate in (MIN_RATE_HZ, MAX_RATE_HZ):
        assert Design(detector={"sample_rate_hz": rate})
        assert rate_bounds_message(rate) is None
    for rate in (0.99 * MIN_RATE_HZ, 1.01 * MAX_RATE_HZ):
        with pytest.raises(FingertipError):
            Design(detector={"sample_rate_hz": rate})
        assert rate_bounds_message(rate)


def test_a_wrong_value_is_refused_without_a_word_on_the_rate(tmp_path):
    (tmp_path / "t.csv").write_text(csv(*burst(1000.0)).replace("\n", "\n0,x\n", 1))
    assert run("detect", tmp_path / "t.csv", "--detector", "fast").stderr.count("error: ") == 2


def test_a_stream_is_warned_of_at_its_end() -> None:
    assert (
        "samples are at the limits of the ADC range"
        in run("detect", "-", lines=csv(T, np.full(len(T), 3.3))).stderr
    )


def test_detect_file_in_python_returns_warnings(tmp_path):
    (tmp_path / "t.csv").write_text(csv(T, np.full(len(T), 2.3)))
    design = Design(detector={"threshold_v": 0.001})
    constant, threshold = fingertip.detect_file(tmp_path / "t.csv", design).warnings
    assert constant == "the voltage is constant at 2.3 V; is a sensor connected?"
    assert "is within the noise" in threshold


class _Port(io.RawIOBase):
    """Serial port as pyserial gives it: bytes as they come; once it
    is unplugged, an error without a number.
    """

    in_waiting = 1000

    def __init__(self, text: str) -> None:
        self._file = io.BytesIO(text.encode())

    def read(self, size: int = -1) -> bytes:
        block = self._file.read(size)
        if block:
            return block
        raise OSError("device disconnected")


@pytest.mark.parametrize("rate_hz", [1250.0, 2000.0])
def test_a_serial_port_gives_bytes_its_rate_and_its_end(rate_hz: float) -> None:
    text = csv(np.arange(len(V)) / rate_hz, V)
    found = fingertip.detect_stream(_Port(text))
    assert found.design.detector.sample_rate_hz == rate_hz
    assert [transition.on for transition in found.transitions][:1] == [True]


@pytest.mark.parametrize("unit", ["s", "ms"])
def test_a_series_whose_index_holds_the_times(unit: str) -> None:
    pandas = pytest.importorskip("pandas")
    index = T if unit == "s" else pandas.to_timedelta(1000 * T, unit="ms")
    onset_s = fingertip.detect(pandas.Series(V, index=index)).intervals[0].onset_s
    assert onset_s == fingertip.detect(np.column_stack([T, V])).intervals[0].onset_s
    wide = np.column_stack([V, np.full_like(V, 2.3), V])
    for recording, names, rate_hz in (
        (np.column_stack([T, wide]), "123", None),
        (wide, "012", 2000.0),
        (pandas.DataFrame(wide, index=index, columns=[*"abc"]), "abc", None),
    ):
        found = fingertip.detect_channels(recording, rate_hz=rate_hz)
        assert {name: [i.onset_s for i in each.intervals] for name, each in found.items()} == dict(
            zip(names, ([onset_s], [], [onset_s]), strict=True)
        )
        with pytest.raises(
            fingertip.FingertipError,
            match=rf"holds 3 channels, {names[0]}, .* call detect_channels",
        ):
            fingertip.detect(recording, rate_hz=rate_hz)
