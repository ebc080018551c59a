"""Detection on a stream of CSV lines, one decision a sample; no samples are stored."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fingertip.design import Design
from fingertip.design.parameters.board_and_detector import Detector as DetectorParameters
from fingertip.detection.adaptation import Adaptation
from fingertip.detection.recordings import find_force_scale, read_floors
from fingertip.detection.warnings import StreamWatch, settings_warnings
from fingertip.foundation.errors import Issue, TraceError, shorten
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.detector import Detector
from fingertip.slip.detectors.fast import FastDetector, Floors
from fingertip.slip.force import MEAN_S, Force, ForceScale
from fingertip.slip.traces import sampling
from fingertip.slip.traces.cells import bare_lines, parse_number, split_cells
from fingertip.slip.traces.csv_header import Header, find_header
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
    channel: str = ""
    """Name of its column, where there are several."""


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
    channels: Sequence[str] = (),
    floors: str | Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> StreamDetection:
    """Detect slip in CSV lines while they arrive. The samples are read as transitions are taken.

    The header is read at once. If neither design nor `rate_hz` state a rate, it follows from the
    first samples' times.

    Parameters
    ----------
    lines
        CSV lines, as in a file: texts or bytes, or what has a method `readline`, such as a
        `serial.Serial`. The detector `analog` takes the column `envelope_v` and, if there is none,
        the output of the design's board, simulated for the voltage.
    channels
        Columns of several voltages, by name or number. Each is judged alone, without the board's
        columns.
    design, detector, rate_hz, scale, time_scale, columns, floors, progress
        As for `detect_file`, but the voltage may not be the column of a force.

    Raises
    ------
    TraceError
        If the lines have no header or an option does not apply; while transitions are taken, at the
        first wrong line.
    DesignError
        If `rate_hz` is out of bounds, or too low for the design's filters.
    """
    report = progress or (lambda message: None)
    original = design or Design()
    design = original
    kind = registry.check_detector(design, detector)
    adaptation = Adaptation(detector, report=report)
    if rate_hz is not None:
        design = adaptation.to_rate(design, rate_hz)

    voltage = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    column_maps = [_select_voltage(voltage, name) for name in channels] or [voltage]
    if not all(column_map.in_volts for column_map in column_maps):
        problem = "names a force, whose thresholds require --calibrate and the whole recording"
        raise TraceError(Issue("--column", f"{problem}; save the lines in a file."))

    envelope = _select_voltage(voltage, voltage.name_in_file("envelope_v"))
    alternatives = [envelope] if kind.takes_envelope else []
    header, rows = open_stream(lines, column_maps[0], *alternatives)
    if rate_hz is None and "sample_rate_hz" not in design.detector.model_fields_set:
        first = list(itertools.islice(rows, _FIRST))
        rows = itertools.chain(first, rows)
        measured_hz = _find_rate(header, first, voltage, design.detector.sample_rate_hz)
        if measured_hz:
            design = adaptation.to_rate(design, measured_hz)

    second = None if channels else registry.find_second_column(design, detector)
    opened = []
    for column_map in column_maps:
        channel = _Channel.open(
            header,
            design=design,
            detector=detector,
            voltage=column_map,
            second=second,
            report=report,
            is_named=bool(channels),
        )
        if floors is not None:
            channel.start_with(
                read_floors(
                    floors,
                    design=original,
                    detector=detector,
                    columns=column_map,
                    rate_hz=design.detector.sample_rate_hz,
                    with_filtered=len(channel.places) > 1,
                )
            )

        opened.append(channel)

    transitions = _follow(
        header,
        rows=rows,
        channels=opened,
        parameters=design.detector,
        columns=column_maps[0],
        report=report,
    )
    signals = registry.find_signals(design, detector, len(opened[0].places) > 1)
    return StreamDetection(transitions, design, tuple(settings_warnings(design, detector)), signals)


def _select_voltage(columns: ColumnMap, name: str) -> ColumnMap:
    return replace(columns, names={**columns.names, "voltage_v": name})


@dataclass
class _Channel:
    """One voltage of the lines, with its detector."""

    name: str
    """Name in transitions and warnings; empty for a single one."""
    places: list[int]
    """Places in a line of the detector's inputs."""
    detector: Detector
    watch: StreamWatch | None
    scale: ForceScale | None
    is_on: bool = False
    is_whole: bool = True
    """True if all values were whole numbers."""
    mean_v: float = math.nan

    @classmethod
    def open(
        cls,
        header: Header,
        design: Design,
        detector: str,
        voltage: ColumnMap,
        second: str | None,
        report: Callable[[str], None],
        is_named: bool,
    ) -> _Channel:
        """Create the detector of a channel; `analog` takes the board's output if it is there."""
        voltage = voltage.with_simulated_names(header.names)
        place = header.find_place
        name = voltage.name_in_file("voltage_v")
        envelope = voltage.name_in_file("envelope_v")
        takes_envelope = registry.find_detector_type(detector).takes_envelope
        label = name if is_named else ""

        if takes_envelope and envelope in header.names and not is_named:
            return cls(
                name=label,
                places=[place(envelope)],
                detector=registry.make_detector(detector, design),
                watch=None,
                scale=None,
            )

        places = [place(name)]
        if second is not None and voltage.name_in_file(second) in header.names:
            places.append(place(voltage.name_in_file(second)))

        instance: Detector

        if takes_envelope:
            from fingertip.sim.signal.converter import SimulatedBoardDetector  # noqa: PLC0415

            report(f"{NAME} has no column {envelope}: simulating the design's board")
            instance = SimulatedBoardDetector(design)
        else:
            instance = registry.make_detector(detector, design)

        watch = StreamWatch(design, detector, instance, with_steps=len(places) == 1)
        return cls(
            name=label,
            places=places,
            detector=instance,
            watch=watch,
            scale=find_force_scale(design),
        )

    def start_with(self, floors: Floors) -> None:
        """Give the detector the floors of a rest."""
        assert isinstance(self.detector, FastDetector)  # floors of another one are refused
        self.detector.stored_floors = floors

    def step(self, values: Sequence[float], time_s: float, share: float) -> Transition | None:
        """Process one sample.

        `share` is that of a new voltage in the mean of which the force follows.
        """
        if math.isnan(self.mean_v):
            self.mean_v = values[0]
        else:
            self.mean_v = self.mean_v + share * (values[0] - self.mean_v)

        if self.detector.step(*values) == self.is_on:
            return None

        self.is_on = not self.is_on
        force = self.scale.read(self.mean_v) if self.scale else None
        return Transition(self.is_on, time_s, force, self.name)

    def warn(self, warnings: Sequence[str], report: Callable[[str], None]) -> None:
        prefix = f"{self.name}: " if self.name else ""
        for warning in warnings:
            report(f"warning: {prefix}{warning}")


def _find_rate(
    header: Header, rows: Sequence[tuple[int, str]], columns: ColumnMap, known_hz: float
) -> float | None:
    """Return the rate by the first times [Hz]; None if it is the known one, or without times."""
    times = _place_times(header, columns)
    if not times or len(rows) < 2:
        return None

    try:
        first_s, last_s = (
            _read_time(times, split_cells(line, header.delimiter), number, line)
            for number, line in (rows[0], rows[-1])
        )
    except (IndexError, TraceError):
        return None  # the line is refused in its turn

    spread = sampling.STEP_TOLERANCE / len(rows)
    duration_s = last_s - first_s
    rate_hz = (len(rows) - 1) / duration_s if duration_s > 0.0 else 0.0

    if (
        sampling.rate_bounds_message(rate_hz)
        or abs(rate_hz / known_hz - 1) <= sampling.RATE_TOLERANCE + spread
    ):
        return None

    return sampling.round_rate(rate_hz, spread)


def open_stream(
    lines: Iterable[str | bytes], columns: ColumnMap, *alternatives: ColumnMap, name: str = NAME
) -> tuple[Header, NumberedLines]:
    """Read the header and the line of units; return it and all lines below that are not empty.

    Raises TraceError.
    """
    remaining = bare_lines(bounded_lines(lines, name))
    header = find_header(name, remaining, columns, *alternatives)
    numbered = enumerate(remaining, start=header.line + 1)
    rows = ((number, line) for number, line in numbered if line.strip())
    first = next(rows, None)
    if first is None or header.is_unit_line(first[1]):
        return header, rows

    return header, itertools.chain([first], rows)


def _follow(
    header: Header,
    rows: NumberedLines,
    channels: Sequence[_Channel],
    parameters: DetectorParameters,
    columns: ColumnMap,
    report: Callable[[str], None],
) -> Iterator[Transition]:
    """Process one sample per line and yield each transition as soon as it occurs.

    Raises TraceError.
    """
    times = _place_times(header, columns)
    clock = _SampleClock(parameters)
    width = 0
    sample = -1
    step_s = 1 / parameters.sample_rate_hz
    share = 1 / max(1.0, MEAN_S * parameters.sample_rate_hz)
    places = {place for place, _ in times}.union(*(channel.places for channel in channels))

    for number, line in rows:
        if header.is_repeated(line) or line.startswith("#"):
            continue  # a controller repeats it each second, with its version

        sample += 1
        cells = split_cells(line, header.delimiter)
        width = width or header.count_cells(len(cells), places)

        if len(cells) != width:
            message = (
                f"has {len(cells)} cells, but the header has {len(header.names)}; give one "
                "per column."
            )
            raise _line_error(number, f"{message} {_quote(line)}")

        samples = [
            [_parse_number(cells[place], number, line) * columns.scale for place in channel.places]
            for channel in channels
        ]
        for channel, (volts, *_) in zip(channels, samples, strict=True):
            channel.is_whole = channel.is_whole and volts % 1 == 0
            channel.warn(channel.watch.add(volts) if channel.watch else (), report)
            if not parameters.adc_low_v <= volts <= parameters.adc_range_v:
                message = sampling.range_message(volts, "", channel.is_whole, parameters)
                raise _line_error(number, message)

        time_s = _read_time(times, cells, number, line) if times else sample * step_s
        if times:
            clock.check(time_s, number)

        for channel, values in zip(channels, samples, strict=True):
            transition = channel.step(values, time_s, share)
            if transition:
                yield transition

    for channel in channels:
        channel.warn(channel.watch.end() if channel.watch else (), report)

    if sample < 0:
        message = "has no samples below its header; write at least one line of samples."
        raise TraceError(Issue(NAME, message))
    if sample + 1 < parameters.window_samples:
        message = sampling.length_message(sample + 1, parameters.window_samples)
        raise TraceError(Issue(NAME, message))


def _place_times(header: Header, columns: ColumnMap) -> list[tuple[int, float]]:
    """Return the places of the times with seconds per unit; none if the lines hold no times."""
    units_s = {
        columns.name_in_file("time_s"): columns.time_scale,
        columns.names.get(NANOSEC, ""): 1e-9,
    }
    return [
        (header.names.index(name), unit_s)
        for name, unit_s in units_s.items()
        if name in header.names
    ]


def _read_time(
    times: Sequence[tuple[int, float]], cells: Sequence[str], number: int, line: str
) -> float:
    return sum(unit_s * _parse_number(cells[place], number, line) for place, unit_s in times)


class _SampleClock:
    """Check of the times of samples against the sampling rate: each step, and the mean."""

    def __init__(self, parameters: DetectorParameters) -> None:
        self._parameters = parameters
        self._steps = 0
        self._start_s = self._previous_s = math.nan

    def check(self, time_s: float, line: int) -> None:
        rate_hz = self._parameters.sample_rate_hz
        window = self._parameters.window_samples
        step_s = time_s - self._previous_s
        self._previous_s = time_s

        if math.isnan(step_s):
            self._start_s = time_s
            return

        if abs(step_s * rate_hz - 1) > sampling.STEP_TOLERANCE:
            remedy = "use --rate-hz, or record without gaps"
            if step_s == 0.0:
                remedy = f"ignore rounded times with --rate-hz {rate_hz:g} --column time_s=none"
            elif self._steps:
                remedy = (
                    "if few samples are missing, ignore the times with --rate-hz "
                    f"{rate_hz:g} --column time_s=none"
                )
            elif step_s > 0.0 and sampling.guess_time_unit(1 / step_s):
                raise _line_error(line, sampling.rate_bounds_message(1 / step_s) or "")

            raise _line_error(
                line,
                f"{time_s:.9g} s is {step_s:.4g} s after the previous sample, but the detector "
                "requires steps of "
                f"{1 / rate_hz:.4g} s ({rate_hz:g} Hz); {remedy}.",
            )

        self._steps += 1
        if self._steps % window == 0:
            mean_hz = self._steps / (time_s - self._start_s)
            # A single time stamp may be off by STEP_TOLERANCE, which affects the mean of few steps
            # most.
            if (
                abs(mean_hz / rate_hz - 1)
                > sampling.RATE_TOLERANCE + sampling.STEP_TOLERANCE / self._steps
            ):
                raise _line_error(line, sampling.rate_message(mean_hz, self._parameters))

            if self._steps >= _RATE_WINDOWS * window:
                self._start_s = time_s
                self._steps = 0


def _parse_number(cell: str, number: int, line: str) -> float:
    value = parse_number(cell)
    if value is None:
        message = f"{cell.strip()!r} is not a number; write it with a decimal point."
        if not cell.strip():
            message = "has an empty cell; give one number per column."

        raise _line_error(number, f"{message} {_quote(line)}")

    if not math.isfinite(value):
        raise _line_error(
            number, f"{value} is not a finite number; detection cannot continue across it."
        )

    return value


def _quote(line: str) -> str:
    """Quote a line as it came: it may be a message of the controller."""
    return f"The line reads {shorten(line.strip(), _MAX_QUOTED)!r}."


def _line_error(line: int, message: str) -> TraceError:
    return TraceError(Issue(f"{NAME}, line {line}", message))
