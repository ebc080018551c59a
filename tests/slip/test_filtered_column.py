"""Column `filtered_v` of recordings and streams, which the detector `fast` reads on boards for a controller."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.detection.files import detect_file, detect_stream
from fingertip.foundation.errors import TraceError
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.sim import ManipulationFile, SceneFile, run_manipulation, run_scene
from fingertip.slip import make_detector
from fingertip.slip.report import as_data, as_text
from fingertip.slip.traces.truth import intervals
from tests.slip.test_fast_filtered import CONTROLLER, board, quantise, slip_from

ARTICLE = Design(
    board={"variant": "article", "supply": "split", "supply_v": 5.0},
    detector={"noise_v": 4e-4, "adc_bits": 16, "adc_range_v": 10.0, "adc_polarity": "bipolar"},
)


@pytest.fixture(scope="module")
def recording() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    volts = slip_from(2.0, 0.003, 1.2, 7)
    return np.arange(len(volts)) / 2000, quantise(volts, rng, 1.2e-3), quantise(board(volts), rng, 1.2e-3)


def as_lines(columns: tuple[np.ndarray, ...], names: str, factor: float = 1.0) -> Iterator[str]:
    yield names
    for time_s, *values in zip(*columns, strict=True):
        yield ",".join([f"{time_s:.6f}", *(f"{factor * value:.9g}" for value in values)])


@pytest.mark.parametrize(
    ("names", "columns", "factor"),
    [
        ("time_s,voltage_v,filtered_v", {}, 1.0),
        ("time_s,voltage_v,sampled_filtered_v", {}, 1.0),  # as a simulation calls it
        ("time_s,T,S", {"voltage_v": "T", "filtered_v": "S"}, 1.0),
        ("time_s,T,S", {"voltage_v": "T", "filtered_v": "S"}, 1000.0),
    ],
)
def test_files_and_streams_use_the_column(tmp_path: Path, recording, names, columns, factor):
    """Both find what the detector finds on the arrays, in volts or in millivolts."""
    time_s, samples, filtered = recording
    expected = intervals(time_s, make_detector("fast", CONTROLLER).process(samples, filtered).on)
    assert [round(i.onset_s, 1) for i in expected] == [1.2]
    lines = list(as_lines(recording, names, factor))
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    found = detect_file(path, CONTROLLER, "fast", scale=1 / factor, columns=columns)
    assert found.detection.intervals == pytest.approx(expected)
    assert not any("steps" in warning for warning in found.warnings)
    stream = detect_stream(lines, CONTROLLER, "fast", scale=1 / factor, columns=columns)
    archive = dict(zip(names.split(","), (time_s, factor * samples, factor * filtered), strict=True))
    np.savez(tmp_path / "trace.npz", **archive)
    found = detect_file(tmp_path / "trace.npz", CONTROLLER, "fast", scale=1 / factor, columns=columns)
    assert found.detection.intervals == pytest.approx(expected)
    first = next(iter(stream.transitions))
    assert first.on
    assert first.time_s == pytest.approx(expected[0].onset_s)


def test_the_first_line_says_which_signals_were_used(tmp_path: Path, recording):
    path, bare = tmp_path / "both.csv", tmp_path / "bare.csv"
    path.write_text("\n".join(as_lines(recording, "time_s,voltage_v,sampled_filtered_v")) + "\n", encoding="utf-8")
    bare.write_text("\n".join(as_lines(recording[:2], "time_s,voltage_v")) + "\n", encoding="utf-8")
    both, alone = ["voltage_v", "filtered_v"], ["voltage_v"]
    for given, design, detector, said, columns in (
        (path, CONTROLLER, "fast", "fast, on voltage_v and filtered_v, ", both),
        (bare, CONTROLLER, "fast", "fast, on voltage_v alone (no column filtered_v), ", alone),
        (path, ARTICLE, "fast", "fast, on voltage_v, ", alone),
        (path, CONTROLLER, "digital", "digital, on voltage_v, ", alone),
        (path, CONTROLLER, "analog", "analog, on envelope_v, ", ["envelope_v"]),
    ):
        found = detect_file(given, design, detector).detection
        assert as_text(found).startswith(f"detector {said}")
        assert as_data(found, None)["signals"] == columns
        if detector != "analog":
            stream = detect_stream(iter(given.read_text(encoding="utf-8").splitlines()), design, detector)
            assert list(stream.signals.columns) == columns


def test_only_signals_that_a_detector_reads_are_simulated():
    assert select_board_outputs(CONTROLLER, ["digital", "fft"]) == []
    assert select_board_outputs(CONTROLLER, ["analog", "fast"]) == ["sampled_envelope_v", "sampled_filtered_v"]
    assert select_board_outputs(ARTICLE, ["analog", "fast"]) == ["sampled_envelope_v"]


@pytest.mark.full
def test_simulated_traces_carry_the_filtered_signal():
    """The board's simulated signal is the high-pass of the voltage, and every finger of a hand has its own."""
    outputs = ["voltage_v", "slip", "sampled_filtered_v"]
    scene = SceneFile(scene="sliding_finger", slide={"distance_m": 0.04, "speed_m_s": 0.04}, outputs=outputs)
    trace = run_scene(CONTROLLER, scene, 1).trace
    assert trace.filtered_v is not None
    both = make_detector("fast", CONTROLLER).process(trace.voltage_v, trace.filtered_v)
    alone = make_detector("fast", CONTROLLER).process(trace.voltage_v)
    slipping = trace.slip
    assert np.corrcoef(both.filtered_v[slipping], alone.filtered_v[slipping])[0, 1] > 0.9
    hand = ManipulationFile(scene="hand", outputs=outputs)
    result = run_manipulation(CONTROLLER, hand, None, 1)
    signals = [result.trace(finger).filtered_v for finger in result.fingers]
    assert all(signal is not None for signal in signals)
    assert not np.array_equal(signals[0], signals[1])
    with pytest.raises(TraceError, match="sampled_filtered_v"):
        run_manipulation(ARTICLE, hand, None, 1)


def test_a_named_column_that_is_missing_is_refused(tmp_path: Path, recording):
    lines = list(as_lines(recording, "time_s,voltage_v,filtered_v"))
    path = tmp_path / "trace.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(TraceError, match="there is no column nothing"):
        detect_file(path, CONTROLLER, "fast", columns={"filtered_v": "nothing"})
    with pytest.raises(TraceError, match="there is no column nothing"):
        detect_stream(lines, CONTROLLER, "fast", columns={"filtered_v": "nothing"})


def test_a_stream_may_begin_before_its_header(recording):
    """A controller that runs already sends the rest of a line, samples, and its header with the next second."""
    lines = list(as_lines(recording, "time_s,voltage_v,filtered_v"))
    running = ["843,1.471948", *lines[1:500], *lines]
    first = next(iter(detect_stream(running, CONTROLLER, "fast").transitions))
    assert first == next(iter(detect_stream(lines, CONTROLLER, "fast").transitions))
    with pytest.raises(TraceError, match="is not the header of a trace"):
        detect_stream([lines[1]] * 6000, CONTROLLER, "fast")
