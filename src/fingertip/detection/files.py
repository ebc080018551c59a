"""Detection on recorded files and on streams of lines, from reading the recording to warnings about the result.

`fingertip detect` prints what these functions return. They adapt the design to the recording's sampling rate, derive
thresholds from a quiet part, and simulate the analog board for the detector `analog` where a recording contains only
the voltage ahead of the board.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from fingertip.design import Design
from fingertip.detection import adaptation, warnings
from fingertip.detection.live import NAME as STREAM_NAME
from fingertip.detection.live import Transition, follow, open_stream
from fingertip.foundation.errors import FingertipError, Issue, TraceError
from fingertip.slip.detection import Detection, detect
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.analog_and_digital import measure_noise_level
from fingertip.slip.detectors.noise import NoiseLevel
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.sampling import RATE_TOLERANCE, rate_bounds_message
from fingertip.slip.traces.trace import ColumnMap, RawTrace, Trace, signal_warnings
from fingertip.slip.traces.truth import Origin, read_origin

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class FileDetection:
    detection: Detection
    trace: Trace
    """Validated trace, with the board's output if that was simulated."""
    design: Design
    """Design used: at the recording's sampling rate, and for `analog` with the threshold from the quiet part."""
    noise: NoiseLevel | None
    """Noise level of the quantity that the threshold applies to; None for the detectors `fft` and `fast`."""
    warnings: tuple[str, ...]
    """Reasons to doubt the result."""


@dataclass(frozen=True, eq=False)
class StreamDetection:
    """Detection on a stream of lines, in progress."""

    transitions: Iterator[Transition]
    """Transitions between ON and OFF; each is available as soon as its line has been read."""
    design: Design
    """Design used, at the stream's sampling rate."""
    warnings: tuple[str, ...]
    """Reasons to doubt the result."""
    signals: registry.UsedSignals
    """Columns of a trace that the detector takes from the lines."""


def detect_file(
    path: str | Path,
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    *,
    rate_hz: float | None = None,
    calibrate_s: tuple[float, float] | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
    columns: Mapping[str, str] | None = None,
    adapt_to_file: bool | None = None,
    keep_threshold: bool | None = None,
    keep_window: bool = False,
    origin: Origin | None = None,
    progress: Progress | None = None,
) -> FileDetection:
    """Detect slip in a recorded file: CSV, NumPy, MATLAB, Parquet, WAV, TDMS or LVM.

    Parameters
    ----------
    path
        The file. The detector `analog` takes its column `envelope_v` and, if there is none, the output of the design's
        board, simulated for the voltage.
    design
        Source of sampling rate, filters, window, threshold and board; by default the default design.
    detector
        Name of a detector: `digital`, `analog`, `fft` or `fast`.
    rate_hz
        Sampling rate to which the design is adapted [Hz]. Times in the file must agree with it.
    calibrate_s
        Start and end of an interval during which nothing happens, after the first sample [s]. Thresholds then follow
        from the noise there.
    scale
        Volts per unit of the file's voltage.
    time_scale
        Seconds per unit of the file's times, such as 1e-3.
    columns
        Name in the file for each column of a trace, such as ``{"voltage_v": "AI0"}``. The voltage may be the column of
        a force; its thresholds require `calibrate_s`.
    adapt_to_file
        Whether the design is adapted to the file's sampling rate; another rate is otherwise an error. By default it is
        adapted unless `rate_hz` or the design states a rate.
    keep_threshold
        Whether the threshold remains the same when the design is adapted; by default if the design states one.
    keep_window
        Whether the number of samples in the window remains the same when the design is adapted.
    origin
        What is known of the recording beside its columns; by default what the manifest beside the file says.
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
    path, report = Path(path), progress or (lambda message: None)
    design = design or Design()
    kind = registry.check_detector(design, detector)
    adapt = partial(adaptation.adapt_detector, detector, keep_threshold, keep_window, calibrate_s is not None, report)
    if adapt_to_file is None:
        adapt_to_file = "sample_rate_hz" not in design.detector.model_fields_set
    if rate_hz is not None:
        design = adapt(design, rate_hz)
    column_map = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    if not column_map.in_volts and calibrate_s is None and not kind.takes_envelope:
        message = "is missing: the design's thresholds are in volts, but this column is a force; give the interval "
        raise TraceError(Issue("--calibrate", message + "during which nothing happens."))
    raw = read_raw_trace(path, column_map)
    if rate_hz is None and adapt_to_file:
        design = adapt_to_rate(design, raw, adapt)
    trace = replace(raw.validate(design.detector), origin=origin or read_origin(path))
    doubts = list(raw.notes)
    if column_map.in_volts:
        doubts += warnings.hum_warnings(trace.voltage_v, design.detector.sample_rate_hz)
        doubts += warnings.polarity_warnings(trace.voltage_v, design)
        doubts += signal_warnings(trace, design.detector, design.board.has_filter)
        doubts += warnings.settings_warnings(design, detector)
        reads_second = registry.find_second_column(design, detector) is not None and trace.filtered_v is not None
        # Thresholds follow from the recording itself after a calibration. A filtered signal has finer steps.
        if reads_second:
            doubts += warnings.filtered_warnings(trace, design)
        elif calibrate_s is None:
            doubts += warnings.step_warnings(trace.voltage_v, design, detector)

    quiet = slice(0, 0) if calibrate_s is None else adaptation.select_quiet_part(trace, calibrate_s, path.name)
    if calibrate_s is not None and (moved := adaptation.describe_ramp(trace, quiet, column_map.in_volts)):
        message = f"{moved}, within {calibrate_s[0]:g}:{calibrate_s[1]:g} s; choose a part in which the force rests."
        raise TraceError(Issue("--calibrate", message))
    noise_v, level = None, None
    if kind.takes_envelope:
        is_replayed = trace.envelope_v is None
        doubts += warnings.envelope_warnings(trace, design)
        if is_replayed:
            trace = simulate_board(trace, design, column_map, path.name, report)
        level = _board_noise(trace, design, is_replayed, quiet, path.name)
        if calibrate_s is not None:
            calibrated = design.with_values({"detector.threshold_v": level.rounded_threshold_v})
            design = Design(**calibrated.model_dump())
    elif calibrate_s is not None:
        noise_v = adaptation.equivalent_noise_v(detector, design, trace.voltage_v[quiet], path.name)
        if column_map.in_volts:
            noise_v = max(noise_v, kind.implementation.min_noise_v(design))
            part = f"the part {calibrate_s[0]:g}:{calibrate_s[1]:g} s of --calibrate"
            doubts += warnings.calibration_warnings(noise_v, detect(trace, design, detector), quiet, design, part)

    detection = detect(trace, design, detector, noise_v)
    if calibrate_s and detection.output.on[quiet].any():
        first_s = trace.time_s[quiet][detection.output.on[quiet]][0]
        message = f"{detector} finds slip at {first_s:.4f} s, within {calibrate_s[0]:g}:{calibrate_s[1]:g} s"
        raise TraceError(Issue("--calibrate", f"{message}; choose a part in which nothing moves or vibrates."))
    if column_map.in_volts:
        # Noise jumps, too.
        noisy = list(warnings.noise_warnings(detection.learned_noise_v, design, noise_v))
        doubts += noisy or warnings.glitch_warnings(detection.output, trace)
    level = level or detection.noise
    if level:
        may_be_lower = not kind.takes_envelope or calibrate_s is not None
        doubts += warnings.threshold_warnings(detection.threshold_v, level, may_be_lower)
    if calibrate_s and (sample := adaptation.first_disturbance(design, trace.voltage_v[quiet])) is not None:
        within = f"within {calibrate_s[0]:g}:{calibrate_s[1]:g} s of --calibrate"
        constant = adaptation.count_constant_samples(trace.voltage_v[quiet])
        if constant > sample / 2:
            last_s = trace.time_s[quiet.start + constant - 1]
            message = f"the signal is constant up to {last_s:.4f} s, {within}"
            doubts.append(f"{message}: a signal without noise gives no threshold; {adaptation.NOISELESS_REMEDY}.")
        else:
            message = f"the signal is disturbed at {trace.time_s[quiet.start + sample]:.4f} s, {within}"
            doubts.append(f"{message}: thresholds may be too high; choose another part.")
    return FileDetection(detection, trace, design, level, tuple(doubts))


def detect_stream(
    lines: Iterable[str],
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    *,
    rate_hz: float | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
    columns: Mapping[str, str] | None = None,
    keep_threshold: bool | None = None,
    keep_window: bool = False,
    progress: Progress | None = None,
) -> StreamDetection:
    """Detect slip in CSV lines while they arrive. The header is read at once, the samples as transitions are taken.

    Parameters
    ----------
    lines
        CSV lines, as in a file. The detector `analog` takes the column `envelope_v` and, if there is none, the output
        of the design's board, simulated for the voltage.
    design, detector, rate_hz, scale, time_scale, columns, keep_threshold, keep_window, progress
        As for `detect_file`, but the voltage may not be the column of a force.

    Raises
    ------
    TraceError
        If the lines have no header or an option does not apply; while transitions are taken, at the first wrong line.
    DesignError
        If `rate_hz` is out of bounds, or too low for the design's filters.
    """
    report = progress or (lambda message: None)
    design = design or Design()
    kind = registry.check_detector(design, detector)
    if rate_hz is not None:
        design = adaptation.adapt_detector(detector, keep_threshold, keep_window, False, report, design, rate_hz)
    voltage = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    if not voltage.in_volts:
        problem = "names a force, whose thresholds require --calibrate and the whole recording"
        raise TraceError(Issue("--column", f"{problem}; save the lines in a file."))
    header, rows = open_stream(lines, voltage, *([_map_envelope(voltage)] if kind.takes_envelope else []))
    voltage = voltage.with_simulated_names(header.names)
    instance, column_map = _select_stream_detector(header.names, design, detector, voltage, report)
    second = registry.find_second_column(design, detector)
    reads_second = second is not None and voltage.name_in_file(second) in header.names
    watch = None if reads_second else warnings.StepWatch(design, detector)
    transitions = follow(header, rows, instance, design.detector, column_map, report, watch, second)
    signals = registry.find_signals(design, detector, reads_second)
    return StreamDetection(transitions, design, tuple(warnings.settings_warnings(design, detector)), signals)


def _map_envelope(voltage: ColumnMap) -> ColumnMap:
    """Map the envelope to where a detector finds its voltage."""
    return replace(voltage, names={**voltage.names, "voltage_v": voltage.name_in_file("envelope_v")})


def adapt_to_rate(design: Design, raw: RawTrace, adapt: Callable[[Design, float, str], Design]) -> Design:
    """Adapt the design to a recording's sampling rate, if the rates differ and some detector has it."""
    # A rate out of bounds is refused as the recording is validated, with all else that is wrong.
    if not (rate_hz := raw.rate_hz) or rate_bounds_message(rate_hz):
        return design
    if abs(rate_hz / design.detector.sample_rate_hz - 1) <= RATE_TOLERANCE:
        return design
    try:
        return adapt(design, rate_hz, f"{raw.name} is sampled at {rate_hz:g} Hz: ")
    except FingertipError as error:
        reasons = " ".join(issue.message for issue in error.issues)
        message = f"is sampled at {rate_hz:g} Hz, for which no detector can be designed: {reasons}"
        raise TraceError([*raw.issues, Issue(f"{raw.name}, time_s", message)]) from None


def simulate_board(trace: Trace, design: Design, columns: ColumnMap, name: str, progress: Progress) -> Trace:
    """Add the simulated output of the design's board to a trace; a force passes the design's bridge first."""
    from fingertip.sim.signal.converter import SimulatedBoardDetector, compute_bridge_v  # noqa: PLC0415

    voltage_v, circuits = trace.voltage_v, "the design's board"
    if not columns.in_volts:
        voltage_v, circuits = compute_bridge_v(design, voltage_v), "the design's bridge and board"
        progress(design.force_curve.describe())
    missing, given = columns.name_in_file("envelope_v"), columns.name_in_file("voltage_v")
    progress(f"{name} has no column {missing}: simulating {circuits} for the column {given}")
    envelope_v = SimulatedBoardDetector(design).simulate_envelope_v(voltage_v)
    return replace(trace, voltage_v=voltage_v, envelope_v=envelope_v)


def _board_noise(trace: Trace, design: Design, is_replayed: bool, quiet: slice, name: str) -> NoiseLevel:
    """Find the noise level of the board's output: measured in the quiet part if there is one, otherwise simulated."""
    if quiet.stop:
        assert trace.envelope_v is not None
        return measure_noise_level(trace.envelope_v[quiet], design, name)
    from fingertip.sim.signal.converter import simulate_quiescent_level, simulate_replay_level  # noqa: PLC0415

    return simulate_replay_level(design) if is_replayed else simulate_quiescent_level(design)


def _select_stream_detector(
    names: Sequence[str], design: Design, detector: str, voltage: ColumnMap, progress: Progress
) -> tuple[registry.Detector, ColumnMap]:
    """Create the detector and select its columns; `analog` takes the board's output if the lines contain it."""
    if not registry.find_detector_type(detector).takes_envelope:
        return registry.make_detector(detector, design), voltage
    if voltage.name_in_file("envelope_v") in names:
        return registry.make_detector(detector, design), _map_envelope(voltage)
    from fingertip.sim.signal.converter import SimulatedBoardDetector  # noqa: PLC0415

    progress(f"{STREAM_NAME} has no column {voltage.name_in_file('envelope_v')}: simulating the design's board")
    return SimulatedBoardDetector(design), voltage
