"""Detection on recordings in files and arrays, with warnings about the result.

`fingertip detect` prints what these functions return. They adapt the design to the recording's
sampling rate, derive thresholds from a quiet part, and simulate the analog board for the detector
`analog` where a recording contains only the voltage ahead of the board.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from fingertip.design import Design
from fingertip.detection import warnings
from fingertip.detection.adaptation import Adaptation, QuietPart, equivalent_noise_v
from fingertip.foundation.errors import Issue, TraceError, join_words, shorten
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.analog_and_digital import measure_noise_level
from fingertip.slip.detectors.fast import Floors
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel
from fingertip.slip.force import ForceScale
from fingertip.slip.scored_detection import MAX_NOISE_RATIO, Detection
from fingertip.slip.scored_detection import detect as detect_in_trace
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.sampling import check_rate, rises_as_time
from fingertip.slip.traces.trace import ColumnMap, RawTrace, Trace, as_numbers
from fingertip.slip.traces.truth import Origin, read_origin

Progress = Callable[[str], None]


def detect(
    recording: Trace | Any,
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    noise_v: float | None = None,
    *,
    rate_hz: float | None = None,
) -> Detection:
    """Detect slip in a trace, or in an array of voltages.

    Parameters
    ----------
    recording
        A trace, or what numpy makes an array of: voltages, which take `rate_hz`, or rows of time
        and voltage; or a series of pandas whose index holds the times. Without `envelope_v`, the
        detector `analog` takes the output of the design's board, simulated for the voltage.
    design
        Source of filters, window, threshold and board; by default the default design. It is adapted
        to the rate of the recording if it does not state one itself.
    detector
        Name of a detector: `digital`, `analog`, `fft` or `fast`.
    noise_v
        White RMS noise of the signal; by default the design's [V].
    rate_hz
        Sampling rate to which any design is adapted [Hz]. Times of the recording must agree with
        it.

    Raises
    ------
    TraceError
        With all issues of the recording, or if its rate is out of bounds.
    DesignError
        If `rate_hz` is too low for the design's filters.
    """
    design = design or Design()
    kind = registry.check_detector(design, detector)
    adaptation = Adaptation(detector, noise_is_measured=noise_v is not None)
    channels = _read_channels(recording, rate_hz)
    if len(channels) > 1:
        problem = f"holds {len(channels)} channels, {shorten(join_words(channels), 200)}"
        raise TraceError(
            Issue(
                "recording",
                f"{problem}; call detect_channels with the same arguments, or give one.",
            )
        )

    (trace,) = channels.values()
    raw = RawTrace("trace", trace, in_volts=noise_v is None, is_array=True)
    if rate_hz is not None:
        design = adaptation.to_rate(design, rate_hz)
    elif "sample_rate_hz" not in design.detector.model_fields_set:
        design = adaptation.to_recording(design, raw)

    if kind.takes_envelope and trace.envelope_v is None:
        trace = simulate_board(
            raw.validate(design.detector),
            design=design,
            columns=ColumnMap(),
            name="trace",
            progress=lambda message: None,
        )

    return detect_in_trace(trace, design, detector, noise_v)


def detect_channels(
    recording: Any,
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    noise_v: float | None = None,
    *,
    rate_hz: float | None = None,
) -> dict[str, Detection]:
    """Detect slip in each channel of an array of one row per sample, or of a data frame.

    The first column, or a frame's index, holds the times where it rises as these do, or where there
    is no `rate_hz`. The other parameters, and the exceptions, are those of `detect`. Channels are
    named as a frame's columns, or by the number of their column from 0.
    """
    channels = _read_channels(recording, rate_hz)
    return {
        name: detect(trace, design, detector, noise_v, rate_hz=rate_hz)
        for name, trace in channels.items()
    }


def _read_channels(recording: Any, rate_hz: float | None) -> dict[str, Trace]:
    """Read the channels of a recording by name: the columns beside one that holds the times.

    Raises TraceError.
    """
    if isinstance(recording, Trace):
        return {"voltage_v": recording}

    array = as_numbers("recording", recording)
    names = [*map(str, getattr(recording, "columns", ()))]
    array = array[:, None] if array.ndim == 1 else array
    # The index of a series or a frame of pandas.
    index: Any = getattr(getattr(recording, "index", None), "values", None)
    has_index = isinstance(index, np.ndarray) and index.dtype.kind in "fmM" and len(index)

    if rate_hz is None and has_index:
        times = index if index.dtype.kind == "f" else (index - index[0]) / np.timedelta64(1, "s")
        array = np.column_stack([times, array])
        names = ["", *(names or ["voltage_v"])]

    has_times = (
        array.ndim == 2
        and array.shape[1] > 1
        and (array.shape[1] == 2 or rises_as_time(array[:, 0]))
    )
    if array.ndim != 2 or not array.shape[1] or (rate_hz is None and not has_times):
        shape = (
            f"has shape {np.shape(recording)} and "
            f"{'no rate' if rate_hz is None else f'rate_hz={rate_hz:g}'}"
        )
        raise TraceError(
            Issue(
                "recording",
                f"{shape}; give voltages (n,) with rate_hz, or time and voltage (n, 2).",
            )
        )

    if rate_hz is not None:
        check_rate(rate_hz)

    time_s = array[:, 0] if has_times or rate_hz is None else np.arange(len(array)) / rate_hz
    names = names or [*map(str, range(array.shape[1]))]
    return {
        names[i]: Trace(time_s.copy(), array[:, i].copy())
        for i in range(int(has_times), array.shape[1])
    }


@dataclass(frozen=True, eq=False)
class FileDetection:
    """Detection on a file, with what was used for it."""

    detection: Detection
    trace: Trace
    """Validated trace, with the board's output if that was simulated."""
    design: Design
    """Design used: at the recording's rate, and for `analog` with a calibrated threshold."""
    noise: NoiseLevel | None
    """Noise level of the thresholded quantity; None for the detectors `fft` and `fast`."""
    warnings: tuple[str, ...]
    """Reasons to doubt the result."""


def detect_file(
    path: str | Path,
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    *,
    rate_hz: float | None = None,
    calibrate_s: tuple[float, float] | None = None,
    floors: str | Path | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
    columns: Mapping[str, str] | None = None,
    origin: Origin | None = None,
    progress: Progress | None = None,
) -> FileDetection:
    """Detect slip in a recorded file: CSV, NumPy, MATLAB, Parquet, WAV, TDMS or LVM.

    Parameters
    ----------
    path
        The file. The detector `analog` takes its column `envelope_v` and, if there is none, the
        output of the design's board, simulated for the voltage.
    design
        Source of filters, window, threshold and board, by default the default design; of the
        sampling rate if it states one, else it is adapted to that of the file.
    detector
        Name of a detector: `digital`, `analog`, `fft` or `fast`.
    rate_hz
        Sampling rate to which the design is adapted [Hz]. Times in the file must agree with it.
    calibrate_s
        Start and end of an interval during which nothing happens, after the first sample [s].
        Thresholds then follow from the noise there.
    floors
        Recording of a rest, read as this one: `fast` starts with its floors, so that a start in a
        slip is decided.
    scale
        Volts per unit of the file's voltage.
    time_scale
        Seconds per unit of the file's times, such as 1e-3.
    columns
        Name in the file for each column of a trace, such as ``{"voltage_v": "AI0"}``. The voltage
        may be the column of a force; its thresholds require `calibrate_s`.
    origin
        What is known of the recording beside its columns; by default what the manifest beside the
        file says.
    progress
        Called with each step of the progress.

    Raises
    ------
    TraceError
        With all issues of the file, or if an option does not apply to it.
    DesignError
        If `rate_hz` is out of bounds, or too low for the design's filters.
    MissingLibraryError
        If the file needs a package that is not installed.
    """
    path = Path(path)
    report = progress or (lambda message: None)
    original = design or Design()
    design = original
    kind = registry.check_detector(design, detector)
    if floors is not None and calibrate_s is not None:
        _refuse_floors_beside_calibration(ColumnMap(columns or {}))

    adaptation = Adaptation(detector, calibrate_s is not None, report)
    if rate_hz is not None:
        design = adaptation.to_rate(design, rate_hz)

    column_map = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    if not column_map.in_volts and calibrate_s is None and not kind.takes_envelope:
        message = (
            "is missing: the design's thresholds are in volts, but this column is a force; "
            "give the interval during which nothing happens."
        )
        raise TraceError(Issue("--calibrate", message))

    raw = read_raw_trace(path, column_map)
    if rate_hz is None and "sample_rate_hz" not in design.detector.model_fields_set:
        design = adaptation.to_recording(design, raw)

    trace = replace(raw.validate(design.detector), origin=origin or read_origin(path))
    quiet = None
    if calibrate_s is not None:
        quiet = QuietPart.select(trace, calibrate_s, column_map.in_volts, path.name)

    recording = _Recording(
        name=path.name,
        trace=trace,
        design=design,
        detector=detector,
        columns=column_map,
        quiet=quiet,
    )
    flat = [*warnings.flat_warnings(trace.voltage_v, design)] if column_map.in_volts else []
    doubts = [*raw.notes, *_doubt_signals(recording, flat)]
    del raw  # with the lines of all samples
    level = None
    noise_v = None
    stored = None

    if floors is not None:
        stored = read_floors(
            floors,
            design=original,
            detector=detector,
            columns=column_map,
            rate_hz=design.detector.sample_rate_hz,
            with_filtered=trace.filtered_v is not None,
        )

    if kind.takes_envelope:
        doubts += warnings.envelope_warnings(trace, design)
        recording, level = _add_board(recording, report)
    elif quiet:
        noise_v = _measure_noise(recording, quiet)
        if column_map.in_volts:
            doubts += warnings.calibration_warnings(
                noise_v,
                before=detect_in_trace(trace, design, detector, is_valid=True),
                quiet=quiet.samples,
                design=design,
                part=quiet.describe(),
            )

    detection = detect_in_trace(
        recording.trace,
        design=recording.design,
        detector=detector,
        noise_v=noise_v,
        floors=stored,
        is_valid=not kind.takes_envelope,  # the output of the board may be simulated
    )
    detection = _state_scale(detection, recording, takes_envelope=kind.takes_envelope)
    if quiet:
        quiet.refuse_slip(detection)

    level = level or detection.noise
    doubts += _doubt_result(recording, detection, noise_v, level, is_flat=bool(flat))
    return FileDetection(
        detection=detection,
        trace=recording.trace,
        design=recording.design,
        noise=level,
        warnings=tuple(doubts),
    )


def _refuse_floors_beside_calibration(columns: ColumnMap) -> NoReturn:
    option = "--calibrate" if columns.in_volts else "--floors, which are of a voltage,"
    raise TraceError(Issue("--floors", f"are not used beside --calibrate; leave {option} out."))


@dataclass(frozen=True, eq=False)
class _Recording:
    """Recording to be judged, with the design that fits it."""

    name: str
    trace: Trace
    design: Design
    detector: str
    columns: ColumnMap
    quiet: QuietPart | None


def _doubt_signals(recording: _Recording, flat: Sequence[str]) -> Iterator[str]:
    """Warn of signals that are wrong or do not suit the design; of a force nothing is known.

    `flat` are the warnings of a signal at its limits.
    """
    design = recording.design
    volts = recording.trace.voltage_v
    trace = recording.trace
    if not recording.columns.in_volts:
        return

    yield from warnings.hum_warnings(volts, design.detector.sample_rate_hz)
    yield from warnings.preload_warnings(volts, design)
    below_limit_v = design.detector.adc_range_v - 1.5 * design.detector.adc_step_v
    if np.ptp(volts) == 0.0 and volts[0] < below_limit_v:
        yield f"the voltage is constant at {volts[0]:g} V; is a sensor connected?"
    else:
        yield from flat or warnings.polarity_warnings(volts, design)

    yield from warnings.settings_warnings(design, recording.detector)
    # A filtered signal has finer steps. Thresholds follow from the recording itself after a
    # calibration.
    takes_filtered = registry.find_second_column(design, recording.detector) is not None
    if takes_filtered and trace.filtered_v is not None:
        yield from warnings.filtered_warnings(trace, design)
    elif recording.quiet is None:
        yield from warnings.step_warnings(volts, design, recording.detector)


def _state_scale(detection: Detection, recording: _Recording, *, takes_envelope: bool) -> Detection:
    """Add the force that a voltage means, or the unit of a force that stands for the voltage."""
    columns = recording.columns
    signal = columns.name_in_file("voltage_v")
    if columns.in_volts:
        if signal == columns.name_in_file("envelope_v"):
            return detection

        return replace(detection, scale=find_force_scale(recording.design))

    if takes_envelope:
        return detection

    threshold = replace(detection.threshold, unit=f"thousandths of {signal}")
    return replace(detection, threshold=threshold)


FLOORS_S = 0.5
"""Time in which `fast` learns its floors [s]."""


def read_floors(
    path: str | Path,
    design: Design,
    detector: str,
    columns: ColumnMap,
    rate_hz: float,
    with_filtered: bool,
) -> Floors:
    """Read the floors of a rest that is recorded as the signal that follows it.

    Raises TraceError.
    """
    rest = detect_file(
        path,
        design,
        detector,
        rate_hz=columns.rate_hz,
        scale=columns.scale,
        time_scale=columns.time_scale,
        columns=columns.names,
    )
    has_filtered = rest.trace.filtered_v is not None
    rest_hz = rest.design.detector.sample_rate_hz
    detection = rest.detection
    noise_v = detection.learned_noise_v or 0.0
    lasts_s = rest.trace.time_s[-1] - rest.trace.time_s[0]

    if detection.floors is None:
        message = (
            f"are not learned by {detection.detector}; add --detector fast, or leave --floors out."
        )
    elif lasts_s < FLOORS_S:
        message = (
            f"the rest lasts {lasts_s:.3g} s, and fast learns for {FLOORS_S:g} s; record a "
            "longer one."
        )
    elif detection.incipient:
        message = (
            f"the rest may hold slip at {detection.incipient[0].onset_s:.4f} s; record it while "
            "nothing moves."
        )
    elif any(warnings.noise_warnings(noise_v, design, None)):
        message = (
            f"the rest vibrates by {1000 * noise_v:.2g} mV, over {MAX_NOISE_RATIO:g} times the "
            "stated noise; "
            "record it while nothing moves; if nothing did, state the noise with --set "
            f"detector.noise_v={noise_v:.2g}."
        )
    elif (has_filtered, rest_hz) != (with_filtered, rate_hz):
        message = (
            f"the rest has {rest_hz:g} Hz, or other columns than what follows it; record "
            "both in the same way."
        )
    else:
        return detection.floors

    raise TraceError(Issue("--floors", message))


def _add_board(recording: _Recording, report: Progress) -> tuple[_Recording, NoiseLevel]:
    """Add the board's output if it was not recorded, and the threshold from its noise."""
    from fingertip.sim.signal.converter import simulate_quiescent_level, simulate_replay_level  # noqa: PLC0415

    trace = recording.trace
    design = recording.design
    quiet = recording.quiet
    is_replayed = trace.envelope_v is None

    if is_replayed:
        trace = simulate_board(
            trace,
            design=design,
            columns=recording.columns,
            name=recording.name,
            progress=report,
        )

    if quiet is None:
        level = simulate_replay_level(design) if is_replayed else simulate_quiescent_level(design)
    else:
        assert trace.envelope_v is not None
        level = measure_noise_level(trace.envelope_v[quiet.samples], design, recording.name)
        calibrated = design.with_values({"detector.threshold_v": level.rounded_threshold_v})
        design = Design(**calibrated.model_dump())

    return replace(recording, trace=trace, design=design), level


def _measure_noise(recording: _Recording, quiet: QuietPart) -> float:
    """Return the white noise for which the detector has the quiet part's threshold [V]."""
    design = recording.design
    quiet_v = recording.trace.voltage_v[quiet.samples]
    noise_v = equivalent_noise_v(recording.detector, design, quiet_v, recording.name)
    min_v = registry.find_detector_type(recording.detector).implementation.min_noise_v(design)

    return max(noise_v, min_v) if recording.columns.in_volts else noise_v


def _doubt_result(
    recording: _Recording,
    detection: Detection,
    noise_v: float | None,
    level: NoiseLevel | None,
    *,
    is_flat: bool,
) -> Iterator[str]:
    """Warn of noise, thresholds and quiet parts that make the result doubtful."""
    trace = recording.trace
    design = recording.design
    quiet = recording.quiet

    if recording.columns.in_volts:
        # Noise jumps, too.
        noisy = list(warnings.noise_warnings(detection.learned_noise_v, design, noise_v))
        # A clipped signal jumps, and is named as such.
        if not is_flat:
            undecided = detection.undecided
            if undecided and undecided.end_s < trace.time_s[-1]:
                yield from warnings.begin_warnings(undecided.end_s)

            yield from noisy or warnings.glitch_warnings(detection.output, trace)

    if level:
        may_be_lower = (
            quiet is not None or not registry.find_detector_type(recording.detector).takes_envelope
        )
        yield from warnings.threshold_warnings(detection.threshold_v, level, may_be_lower)

    disturbance = quiet.describe_disturbance(design, trace) if quiet else None
    if disturbance:
        yield disturbance


def find_force_scale(design: Design) -> ForceScale | None:
    """Return the force at each tactile voltage; None if the sensor's curve is not known."""
    from fingertip.sim.signal.finger_curve import FingerCurve  # noqa: PLC0415

    if design.force_curve.find_doubt(design.sensor.model):
        return None

    curve = FingerCurve.from_design(design)
    return ForceScale.of(design, curve.volts, curve.forces_n)


def simulate_board(
    trace: Trace,
    design: Design,
    columns: ColumnMap,
    name: str,
    progress: Progress,
) -> Trace:
    """Add the simulated output of the design's board; a force passes its bridge first."""
    from fingertip.sim.signal.bridge import Bridge  # noqa: PLC0415
    from fingertip.sim.signal.converter import SimulatedBoardDetector  # noqa: PLC0415

    voltage_v = trace.voltage_v
    circuits = "the design's board"

    if not columns.in_volts:
        voltage_v = Bridge.of_board(design).voltage_v(voltage_v)
        circuits = "the design's bridge and board"
        progress(design.force_curve.describe(design.sensor.model))

    missing = columns.name_in_file("envelope_v")
    voltage = columns.name_in_file("voltage_v")
    progress(f"{name} has no column {missing}: simulating {circuits} for the column {voltage}")
    envelope_v = SimulatedBoardDetector(design).simulate_envelope_v(voltage_v)

    return replace(trace, voltage_v=voltage_v, envelope_v=envelope_v)
