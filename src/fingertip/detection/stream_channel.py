"""One voltage of a stream, with the detector that judges it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.detection.recordings import find_force_scale
from fingertip.detection.stream_lines import STREAM_NAME, SampleLine, line_error
from fingertip.detection.warnings import StreamWatch
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.detector import Detector
from fingertip.slip.detectors.fast import FastDetector, Floors
from fingertip.slip.force import MEAN_S, Force, ForceScale
from fingertip.slip.traces import sampling
from fingertip.slip.traces.csv_header import Header
from fingertip.slip.traces.trace import ColumnMap


@dataclass(frozen=True)
class Transition:
    """Change of a detector's verdict between ON and OFF."""

    on: bool
    time_s: float
    """Time of the first sample in that state [s]."""
    force: Force | None = None
    """Force then, by the curve of the sensor; None where that is not known."""
    channel: str = ""
    """Name of its column, where there are several."""


@dataclass(frozen=True, eq=False)
class StreamSettings:
    """Settings that all channels of a stream have in common."""

    header: Header
    design: Design
    """Design at the stream's sampling rate."""
    detector: str
    """Name of the detector."""
    second_column: str | None
    """Column of a trace that the detector takes beside the voltage; None if it takes none."""
    has_named_channels: bool
    """True if transitions and warnings state the name of their channel."""
    report: Callable[[str], None]
    """Function that takes messages on the progress, and warnings."""


class StreamChannel:
    """One voltage of a stream, with its detector and the state between two samples."""

    def __init__(
        self,
        settings: StreamSettings,
        detector: Detector,
        *,
        name: str,
        places: Sequence[int],
        unit_v: float,
        watch: StreamWatch | None,
        scale: ForceScale | None,
    ) -> None:
        """Begin before the first sample.

        Parameters
        ----------
        name
            Name in transitions and warnings; empty for a single channel.
        places
            Places in a line of the detector's inputs, from 0.
        unit_v
            Volts per unit of the numbers in the lines.
        watch
            Watch over the voltage; None for an output of the board.
        scale
            Force by the voltage; None where the curve of the sensor is not known.
        """
        self.name = name
        self.places = places
        self._parameters = settings.design.detector
        self._report = settings.report
        self._detector = detector
        self._unit_v = unit_v
        self._watch = watch
        self._scale = scale
        self._is_on = False
        self._has_whole_numbers = True
        self._mean_v = math.nan
        self._mean_share = 1 / max(1.0, MEAN_S * self._parameters.sample_rate_hz)
        """Share of a new voltage in the mean of which the force follows."""

    def start_with(self, floors: Floors) -> None:
        """Give the detector the floors of a rest; only `fast` and `incipient` take floors."""
        assert isinstance(self._detector, FastDetector)  # floors of another one are refused
        self._detector.stored_floors = floors

    def read_inputs(self, line: SampleLine) -> list[float]:
        """Return the detector's inputs in a line [V]. Raises TraceError."""
        return [line.read_number(place) * self._unit_v for place in self.places]

    def check(self, volts: float, line_number: int) -> None:
        """Report what the voltage of a sample is warned of [V].

        Raises TraceError if the voltage is outside the range of the ADC.
        """
        self._has_whole_numbers = self._has_whole_numbers and volts % 1 == 0
        if self._watch is not None:
            self._warn(self._watch.add((volts,)))

        if not self._parameters.adc_low_v <= volts <= self._parameters.adc_range_v:
            message = sampling.range_message(volts, "", self._has_whole_numbers, self._parameters)
            raise line_error(line_number, message)

    def step(self, inputs: Sequence[float], time_s: float) -> Transition | None:
        """Process the detector's inputs [V] at a time [s]; return the transition, if one occurs."""
        self._average(inputs[:1])
        return None if self._detector.step(*inputs) == self._is_on else self._turn(time_s)

    def select(self, columns: Mapping[int, Array]) -> list[Array]:
        """Return the detector's inputs of several lines, of which the columns are given [V]."""
        return [columns[place] * self._unit_v for place in self.places]

    def accepts(self, volts: Array) -> bool:
        """Return whether voltages are within the range of the ADC [V]."""
        low_v = self._parameters.adc_low_v
        return bool(low_v <= volts.min() and volts.max() <= self._parameters.adc_range_v)

    def process(self, inputs: Sequence[Array], times_s: Array) -> Iterator[tuple[int, Transition]]:
        """Process inputs that it accepts [V], at times [s]; yield the transitions by sample."""
        self._has_whole_numbers = self._has_whole_numbers and bool((inputs[0] % 1 == 0).all())
        begin = 0
        while begin < len(times_s):
            room = len(times_s) if self._watch is None else self._watch.room
            end = min(len(times_s), begin + room)

            # The watch looks at the detector between a sample's arrival and its step.
            yield from self._judge(inputs, times_s, slice(begin, end - 1))
            if self._watch is not None:
                self._warn(self._watch.add(inputs[0][begin:end].tolist()))

            yield from self._judge(inputs, times_s, slice(end - 1, end))
            begin = end

    def _judge(
        self, inputs: Sequence[Array], times_s: Array, part: slice
    ) -> Iterator[tuple[int, Transition]]:
        if part.start == part.stop:
            return

        on = self._detector.process(*(values[part] for values in inputs)).on
        volts = inputs[0][part].tolist()
        done = 0
        for place in np.flatnonzero(np.diff(on, prepend=self._is_on)).tolist():
            self._average(volts[done : place + 1])
            done = place + 1
            yield part.start + place, self._turn(float(times_s[part.start + place]))

        self._average(volts[done:])

    def _turn(self, time_s: float) -> Transition:
        self._is_on = not self._is_on
        force = self._scale.read(self._mean_v) if self._scale else None
        return Transition(self._is_on, time_s, force, self.name)

    def _average(self, volts: Sequence[float]) -> None:
        """Follow the mean of which the force is read [V]."""
        if math.isnan(self._mean_v) and volts:
            self._mean_v = volts[0]
            volts = volts[1:]

        mean_v = self._mean_v
        share = self._mean_share
        for value in volts:
            mean_v = mean_v + share * (value - mean_v)

        self._mean_v = mean_v

    def end(self) -> None:
        """Report what the last samples are warned of."""
        if self._watch is not None:
            self._warn(self._watch.end())

    def _warn(self, warnings: Sequence[str]) -> None:
        prefix = f"{self.name}: " if self.name else ""
        for warning in warnings:
            self._report(f"warning: {prefix}{warning}")


def open_channel(settings: StreamSettings, columns: ColumnMap) -> StreamChannel:
    """Create the channel of the voltage in a column map, ready for its first sample.

    A detector on the board's output takes that column, if there is one and the channels have no
    names. Otherwise the board is simulated for the voltage.

    Raises TraceError if there is no such column.
    """
    columns = columns.with_simulated_names(settings.header.names)
    envelope = columns.name_in_file("envelope_v")
    takes_envelope = registry.find_detector_type(settings.detector).takes_envelope
    has_envelope = envelope in settings.header.names and not settings.has_named_channels

    if takes_envelope and has_envelope:
        return StreamChannel(
            settings,
            registry.make_detector(settings.detector, settings.design),
            name="",
            places=[settings.header.find_place(envelope)],
            unit_v=columns.scale,
            watch=None,
            scale=None,
        )

    name = columns.name_in_file("voltage_v")
    places = _find_places(settings, columns)

    if takes_envelope:
        settings.report(f"{STREAM_NAME} has no column {envelope}: simulating the design's board")
        detector = _simulate_board(settings.design)
    else:
        detector = registry.make_detector(settings.detector, settings.design)

    has_steps = len(places) == 1
    return StreamChannel(
        settings,
        detector,
        name=name if settings.has_named_channels else "",
        places=places,
        unit_v=columns.scale,
        watch=StreamWatch(settings.design, settings.detector, detector, with_steps=has_steps),
        scale=find_force_scale(settings.design),
    )


def _find_places(settings: StreamSettings, columns: ColumnMap) -> list[int]:
    """Find the places of the voltage and, if there is one, of the second column.

    Raises TraceError if the lines do not hold the voltage.
    """
    places = [settings.header.find_place(columns.name_in_file("voltage_v"))]
    if settings.second_column is None:
        return places

    second_name = columns.name_in_file(settings.second_column)
    if second_name in settings.header.names:
        places.append(settings.header.find_place(second_name))

    return places


def _simulate_board(design: Design) -> Detector:
    """Create the detector on the output of a design's board, which is simulated."""
    from fingertip.sim.signal.converter import SimulatedBoardDetector  # noqa: PLC0415

    return SimulatedBoardDetector(design)
