"""Detection on a stream of CSV lines: each line gives one sample and one decision, and no samples are stored."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from fingertip.design import Design
from fingertip.design.parameters.electronics import Detector as DetectorParameters
from fingertip.detection.adaptation import Adaptation
from fingertip.detection.recordings import find_force_scale
from fingertip.detection.warnings import StepWatch, settings_warnings
from fingertip.foundation.errors import Issue, TraceError, shorten
from fingertip.slip.detectors import registry
from fingertip.slip.force import MEAN_S, Force, ForceScale
from fingertip.slip.traces import sampling
from fingertip.slip.traces.columns import bare_lines, parse_number, split_cells
from fingertip.slip.traces.csv_dialect import Header, find_header
from fingertip.slip.traces.trace import NANOSEC, ColumnMap, bounded_lines

NAME = "standard input"
_MAX_QUOTED = 100
"""Maximum length of a line in an error message [characters]."""
_FIRST = 200
"""Number of samples from whose times the rate follows."""
_RATE_WINDOWS = 100
"""Number of windows over which the mean rate is measured before the measurement restarts."""


@dataclass(frozen=True)
class Transition:
    on: bool
    time_s: float
    """Time of the first sample in that state [s]."""
    force: Force | None = None
    """Force then, by the curve of the sensor; None where that is not known."""


NumberedLines = Iterator[tuple[int, str]]


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


def detect_stream(
    lines: Iterable[str | bytes],
    design: Design | None = None,
    detector: str = registry.DEFAULT,
    *,
    rate_hz: float | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
    columns: Mapping[str, str] | None = None,
    keep_threshold: bool | None = None,
    keep_window: bool = False,
    progress: Callable[[str], None] | None = None,
) -> StreamDetection:
    """Detect slip in CSV lines while they arrive. The samples are read as transitions are taken.

    The header is read at once. If neither design nor `rate_hz` state a rate, it follows from the first samples' times.

    Parameters
    ----------
    lines
        CSV lines, as in a file: texts or bytes, or what has a method `readline`, such as a `serial.Serial`. The
        detector `analog` takes the column `envelope_v` and, if there is none, the output of the design's board,
        simulated for the voltage.
    design, detector, rate_hz, scale, time_scale, columns, keep_threshold, keep_window, progress
        As for `detect_file`, but the voltage may not be the column of a force.

    Raises
    ------
    TraceError
        If the lines have no header or an option does not apply; while transitions are taken, at the first wrong line.
    DesignError
        If `rate_hz` is out of bounds, or too low for the design's filters.
    """
    report, design = progress or (lambda message: None), design or Design()
    kind = registry.check_detector(design, detector)
    adaptation = Adaptation(detector, keep_threshold, keep_window, report=report)
    if rate_hz is not None:
        design = adaptation.to_rate(design, rate_hz)
    voltage = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    if not voltage.in_volts:
        problem = "names a force, whose thresholds require --calibrate and the whole recording"
        raise TraceError(Issue("--column", f"{problem}; save the lines in a file."))
    header, rows = open_stream(lines, voltage, *([_map_envelope(voltage)] if kind.takes_envelope else []))
    voltage = voltage.with_simulated_names(header.names)
    if rate_hz is None and "sample_rate_hz" not in design.detector.model_fields_set:
        first = list(itertools.islice(rows, _FIRST))
        rows = itertools.chain(first, rows)
        if found_hz := _find_rate(header, first, voltage, design.detector.sample_rate_hz):
            design = adaptation.to_rate(design, found_hz)
    instance, column_map = _select_stream_detector(header.names, design, detector, voltage, report)
    second = registry.find_second_column(design, detector)
    reads_second = second is not None and voltage.name_in_file(second) in header.names
    watch = None if reads_second else StepWatch(design, detector)
    forces = find_force_scale(design) if column_map is voltage else None
    transitions = follow(header, rows, instance, design.detector, column_map, report, watch, second, forces)
    signals = registry.find_signals(design, detector, reads_second)
    return StreamDetection(transitions, design, tuple(settings_warnings(design, detector)), signals)


def _map_envelope(voltage: ColumnMap) -> ColumnMap:
    """Map the envelope to where a detector finds its voltage."""
    return replace(voltage, names={**voltage.names, "voltage_v": voltage.name_in_file("envelope_v")})


def _select_stream_detector(
    names: Sequence[str], design: Design, detector: str, voltage: ColumnMap, progress: Callable[[str], None]
) -> tuple[registry.Detector, ColumnMap]:
    """Create the detector and select its columns; `analog` takes the board's output if the lines contain it."""
    if not registry.find_detector_type(detector).takes_envelope:
        return registry.make_detector(detector, design), voltage
    if voltage.name_in_file("envelope_v") in names:
        return registry.make_detector(detector, design), _map_envelope(voltage)
    from fingertip.sim.signal.converter import SimulatedBoardDetector  # noqa: PLC0415

    progress(f"{NAME} has no column {voltage.name_in_file('envelope_v')}: simulating the design's board")
    return SimulatedBoardDetector(design), voltage


def _find_rate(header: Header, rows: Sequence[tuple[int, str]], columns: ColumnMap, known_hz: float) -> float | None:
    """Find the rate from the times of the first lines [Hz]; None if it is the known one, or if there are none."""
    names = [columns.name_in_file("time_s"), *([columns.names[NANOSEC]] if NANOSEC in columns.names else [])]
    if not set(names) <= set(header.names) or len(rows) < 2:
        return None
    seconds = []
    for cells in (split_cells(line, header.delimiter) for _, line in (rows[0], rows[-1])):
        parts = [parse_number(cells[place]) for place in map(header.names.index, names) if place < len(cells)]
        if len(parts) < len(names) or None in parts:
            return None
        seconds.append(
            sum(scale * (part or 0.0) for scale, part in zip((columns.time_scale, 1e-9), parts, strict=False))
        )
    spread, duration_s = sampling.STEP_TOLERANCE / len(rows), seconds[1] - seconds[0]
    rate_hz = (len(rows) - 1) / duration_s if duration_s > 0.0 else 0.0
    if sampling.rate_bounds_message(rate_hz) or abs(rate_hz / known_hz - 1) <= sampling.RATE_TOLERANCE + spread:
        return None
    return sampling.round_rate(rate_hz, spread)


def open_stream(
    lines: Iterable[str | bytes], columns: ColumnMap, *alternatives: ColumnMap, name: str = NAME
) -> tuple[Header, NumberedLines]:
    """Read the header and the line of units; return it and all lines below that are not empty. Raises TraceError."""
    remaining = bare_lines(bounded_lines(lines, name))
    header = find_header(name, remaining, columns, *alternatives)
    rows = ((n, line) for n, line in enumerate(remaining, start=header.line + 1) if line.strip())
    if (first := next(rows, None)) is None or header.is_unit_line(first[1]):
        return header, rows
    return header, itertools.chain([first], rows)


def follow(
    header: Header,
    rows: NumberedLines,
    detector: registry.Detector,
    parameters: DetectorParameters,
    columns: ColumnMap,
    report: Callable[[str], None] = lambda message: None,
    watch: StepWatch | None = None,
    second_column: str | None = None,
    scale: ForceScale | None = None,
) -> Iterator[Transition]:
    """Process one sample per line and yield each transition as soon as it occurs. Raises TraceError."""
    names, delimiter = header.names, header.delimiter
    voltage_index = names.index(columns.name_in_file("voltage_v"))
    time_name = columns.name_in_file("time_s")
    time_index = names.index(time_name) if time_name in names else None
    second_name = columns.name_in_file(second_column) if second_column else ""
    second_index = names.index(second_name) if second_name in names else None
    nanosec_index = names.index(columns.names[NANOSEC]) if NANOSEC in columns.names else None
    clock, on, all_whole, width, sample = _SampleClock(parameters), False, True, 0, -1
    share, mean_v = 1 / max(1.0, MEAN_S * parameters.sample_rate_hz), math.nan
    for number, line in rows:
        if header.is_repeated(line) or line.startswith("#"):
            continue  # a controller repeats it each second, with its version
        sample += 1
        cells = split_cells(line, delimiter)
        width = width or header.count_cells(len(cells), columns)
        if len(cells) != width:
            message = f"has {len(cells)} cells, but the header has {len(names)}; give one per column."
            raise _line_error(number, f"{message} {_quote(line)}")
        volts = _parse_number(cells[voltage_index], number, line) * columns.scale
        all_whole = all_whole and volts % 1 == 0
        if watch is not None and (warning := watch.add(volts)):
            report(f"warning: {warning}")
        if columns.in_volts and not parameters.adc_low_v <= volts <= parameters.adc_range_v:
            raise _line_error(number, sampling.range_message(volts, "", all_whole, parameters))
        time_s = sample / parameters.sample_rate_hz
        if time_index is not None:
            time_s = _parse_number(cells[time_index], number, line) * columns.time_scale
            if nanosec_index is not None:
                time_s += 1e-9 * _parse_number(cells[nanosec_index], number, line)
            clock.check(time_s, number)
        values = [volts]
        if second_index is not None:
            values.append(_parse_number(cells[second_index], number, line) * columns.scale)
        mean_v = volts if sample == 0 else mean_v + share * (volts - mean_v)
        if detector.step(*values) != on:
            on = not on
            yield Transition(on, time_s, scale.read(mean_v) if scale else None)
    if watch is not None and (warning := watch.end()):
        report(f"warning: {warning}")
    if sample < 0:
        raise TraceError(Issue(NAME, "has no samples below its header; write at least one line of samples."))
    if sample + 1 < parameters.window_samples:
        raise TraceError(Issue(NAME, sampling.length_message(sample + 1, parameters.window_samples)))


class _SampleClock:
    """Checks the times of samples against the sampling rate: each step, and the mean rate once a window is full."""

    def __init__(self, parameters: DetectorParameters) -> None:
        self._parameters = parameters
        self._step_s = 1 / parameters.sample_rate_hz
        self._previous_s = -math.inf
        self._start_s = 0.0
        self._steps = 0
        self._has_valid_step = False

    def check(self, time_s: float, line: int) -> None:
        previous_s, self._previous_s = self._previous_s, time_s
        if previous_s == -math.inf:
            self._start_s = time_s
            return
        step_s = time_s - previous_s
        if abs(step_s - self._step_s) > sampling.STEP_TOLERANCE * self._step_s:
            remedy = "use --rate-hz, or record without gaps"
            if step_s == 0.0:
                remedy = "ignore rounded times with --column time_s=none and --rate-hz"
            elif self._has_valid_step:
                rate_hz = self._parameters.sample_rate_hz
                remedy = f"if few samples are missing, ignore the times with --rate-hz {rate_hz:g} --column time_s=none"
            elif step_s > 0.0 and sampling.guess_time_unit(1 / step_s):
                raise _line_error(line, sampling.rate_bounds_message(1 / step_s) or "")
            raise _line_error(
                line,
                f"{time_s:.9g} s is {step_s:.4g} s after the previous sample, but the detector requires steps of "
                f"{self._step_s:.4g} s ({self._parameters.sample_rate_hz:g} Hz); {remedy}.",
            )
        self._has_valid_step = True
        self._steps += 1
        if self._steps % self._parameters.window_samples == 0:
            self._check_rate(time_s, line)

    def _check_rate(self, time_s: float, line: int) -> None:
        rate_hz = self._steps / (time_s - self._start_s)
        # A single time stamp may be off by STEP_TOLERANCE, which affects the mean of few steps more than that of many.
        tolerance = sampling.RATE_TOLERANCE + sampling.STEP_TOLERANCE / self._steps
        if abs(rate_hz / self._parameters.sample_rate_hz - 1) > tolerance:
            raise _line_error(line, sampling.rate_message(rate_hz, self._parameters))
        if self._steps >= _RATE_WINDOWS * self._parameters.window_samples:
            self._start_s, self._steps = time_s, 0


def _parse_number(cell: str, number: int, line: str) -> float:
    value = parse_number(cell)
    if value is None:
        message = f"{cell.strip()!r} is not a number; write it with a decimal point."
        if not cell.strip():
            message = "has an empty cell; give one number per column."
        raise _line_error(number, f"{message} {_quote(line)}")
    if not math.isfinite(value):
        raise _line_error(number, f"{value} is not a finite number; detection cannot continue across it.")
    return value


def _quote(line: str) -> str:
    """Quote a line as it came, so that a message of a controller among the samples is read."""
    return f"The line reads {shorten(line.strip(), _MAX_QUOTED)!r}."


def _line_error(line: int, message: str) -> TraceError:
    return TraceError(Issue(f"{NAME}, line {line}", message))
