"""Detection on a stream of CSV lines, one decision a sample; no samples are stored."""

from __future__ import annotations

import contextlib
import heapq
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fingertip.design import Design
from fingertip.design.parameters.board_and_detector import Detector as DetectorParameters
from fingertip.detection.adaptation import Adaptation
from fingertip.detection.recordings import read_floors
from fingertip.detection.stream_channel import (
    StreamChannel,
    StreamSettings,
    Transition,
    open_channel,
)
from fingertip.detection.stream_lines import (
    STREAM_NAME,
    Block,
    SampleLine,
    SampleSplitter,
    TimeColumn,
    find_time_columns,
    open_stream,
    read_time,
    sum_times,
)
from fingertip.detection.stream_rate import FIRST_LINES, SampleClock, measure_rate
from fingertip.detection.warnings import settings_warnings
from fingertip.foundation import jit
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import registry
from fingertip.slip.traces import sampling
from fingertip.slip.traces.trace import ColumnMap

_LEAST_LINES = 16
"""Lines from which a block is parsed at once; fewer are as quick line by line."""
_BACKLOG = 2**15
"""Length from which a block shows that lines wait to be read [characters]: 0.1 s at 20 kHz."""


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
    stated = design or Design()
    kind = registry.check_detector(stated, detector)
    adaptation = Adaptation(detector, report=report)
    adapted = stated if rate_hz is None else adaptation.to_rate(stated, rate_hz)

    voltage = ColumnMap(columns or {}, rate_hz, scale, time_scale)
    column_maps = [_select_voltage(voltage, name) for name in channels] or [voltage]
    _refuse_forces(column_maps)

    envelope = _select_voltage(voltage, voltage.name_in_file("envelope_v"))
    alternatives = [envelope] if kind.takes_envelope else []
    header, stream = open_stream(lines, column_maps[0], *alternatives)

    if rate_hz is None and "sample_rate_hz" not in stated.detector.model_fields_set:
        first_lines = stream.peek(FIRST_LINES)
        known_hz = stated.detector.sample_rate_hz
        measured_hz = measure_rate(header, first_lines, voltage, known_hz)
        if measured_hz:
            adapted = adaptation.to_rate(stated, measured_hz)

    settings = StreamSettings(
        header=header,
        design=adapted,
        detector=detector,
        second_column=None if channels else registry.find_second_column(adapted, detector),
        has_named_channels=bool(channels),
        report=report,
    )
    stream_channels = [
        _begin_channel(settings, column_map, stated, floors) for column_map in column_maps
    ]
    return _start_detection(settings, stream.take_blocks(), stream_channels, voltage)


def _select_voltage(columns: ColumnMap, name: str) -> ColumnMap:
    """Return a column map whose voltage is the column of a name."""
    return replace(columns, names={**columns.names, "voltage_v": name})


def _refuse_forces(column_maps: Iterable[ColumnMap]) -> None:
    """Refuse the column of a force in place of a voltage. Raises TraceError."""
    if not all(column_map.in_volts for column_map in column_maps):
        problem = "names a force, whose thresholds require --calibrate and the whole recording"
        raise TraceError(Issue("--column", f"{problem}; save the lines in a file."))


def _begin_channel(
    settings: StreamSettings,
    columns: ColumnMap,
    stated: Design,
    floors: str | Path | None,
) -> StreamChannel:
    """Open a channel, with the floors of a rest if there is a recording of it.

    `stated` is the design before it was adapted to the stream's rate: the recording of the rest
    adapts it anew. Raises TraceError.
    """
    channel = open_channel(settings, columns)

    if floors is not None:
        rest = read_floors(
            floors,
            design=stated,
            detector=settings.detector,
            columns=columns,
            rate_hz=settings.design.detector.sample_rate_hz,
            with_filtered=len(channel.places) > 1,
        )
        channel.start_with(rest)

    return channel


def _start_detection(
    settings: StreamSettings,
    blocks: Iterable[Block],
    channels: Sequence[StreamChannel],
    columns: ColumnMap,
) -> StreamDetection:
    """Start detection in the lines below the header; none of them is judged yet."""
    time_columns = find_time_columns(settings.header, columns)
    places = _list_places(time_columns, channels)
    splitter = SampleSplitter(settings.header, places)
    has_second = len(channels[0].places) > 1

    return StreamDetection(
        transitions=_follow(blocks, splitter, channels, time_columns, settings.design.detector),
        design=settings.design,
        warnings=tuple(settings_warnings(settings.design, settings.detector)),
        signals=registry.find_signals(settings.design, settings.detector, has_second),
    )


def _list_places(
    time_columns: Iterable[TimeColumn], channels: Iterable[StreamChannel]
) -> frozenset[int]:
    """List the places in a line that are read."""
    places = {column.place for column in time_columns}
    for channel in channels:
        places.update(channel.places)

    return frozenset(places)


def _follow(
    blocks: Iterable[Block],
    splitter: SampleSplitter,
    channels: Sequence[StreamChannel],
    time_columns: Sequence[TimeColumn],
    parameters: DetectorParameters,
) -> Iterator[Transition]:
    """Process one sample per line and yield each transition as soon as it occurs.

    Raises TraceError at the first wrong line, or at the end of too few samples.
    """
    judge = _Judge(splitter, channels, time_columns, SampleClock(parameters), parameters)
    for block in blocks:
        yield from judge.process(block)

    for channel in channels:
        channel.end()

    _refuse_few_samples(judge.count, parameters)


@dataclass
class _Judge:
    """Judge of the samples in blocks of lines."""

    splitter: SampleSplitter
    channels: Sequence[StreamChannel]
    time_columns: Sequence[TimeColumn]
    clock: SampleClock
    parameters: DetectorParameters
    count: int = 0
    """Number of samples so far."""

    def process(self, block: Block) -> Iterator[Transition]:
        """Judge a block of plain samples at once, and any other line by line."""
        is_long = block.text.count("\n") >= _LEAST_LINES
        columns = self.splitter.parse(block) if is_long else None
        inputs = [channel.select(columns) for channel in self.channels] if columns else []
        times_s = self._find_times(columns) if columns else np.zeros(0)

        if inputs and self._accept(inputs, times_s):
            self.count += len(times_s)
            parts = zip(self.channels, inputs, strict=True)
            # Samples of a live signal do not wait for numba. Whole arrivals come of a file.
            is_live = len(block.text) < _BACKLOG
            with jit.interpreted() if is_live else contextlib.nullcontext():
                found = [channel.process(values, times_s) for channel, values in parts]
                transitions = [*heapq.merge(*found, key=operator.itemgetter(0))]

            for _, transition in transitions:
                yield transition
        else:
            for line in self.splitter.split(block):
                yield from self._process_line(line)

    def _find_times(self, columns: Mapping[int, Array]) -> Array:
        """Find the times of plain samples [s]."""
        if not self.time_columns:
            samples = self.count + np.arange(len(next(iter(columns.values()))))
            return np.asarray(samples * (1 / self.parameters.sample_rate_hz), np.float64)

        return sum_times(columns, self.time_columns)

    def _accept(self, inputs: Sequence[Sequence[Array]], times_s: Array) -> bool:
        """Return whether nothing is wrong with samples; else their lines are named one by one."""
        pairs = zip(self.channels, inputs, strict=True)
        if not all(channel.accepts(values[0]) for channel, values in pairs):
            return False

        return not self.time_columns or self.clock.accept(times_s)

    def _process_line(self, line: SampleLine) -> Iterator[Transition]:
        inputs = [channel.read_inputs(line) for channel in self.channels]
        for channel, values in zip(self.channels, inputs, strict=True):
            channel.check(values[0], line.number)

        if self.time_columns:
            time_s = read_time(line, self.time_columns)
            self.clock.check(time_s, line.number)
        else:
            time_s = self.count * (1 / self.parameters.sample_rate_hz)

        self.count += 1
        for channel, values in zip(self.channels, inputs, strict=True):
            transition = channel.step(values, time_s)
            if transition:
                yield transition


def _refuse_few_samples(count: int, parameters: DetectorParameters) -> None:
    """Refuse a stream that ended before one window was full. Raises TraceError."""
    if count == 0:
        message = "has no samples below its header; write at least one line of samples."
        raise TraceError(Issue(STREAM_NAME, message))

    if count < parameters.window_samples:
        message = sampling.length_message(count, parameters.window_samples)
        raise TraceError(Issue(STREAM_NAME, message))
