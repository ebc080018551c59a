"""Detectors by name: what each one takes and judges.

The code of a detector is loaded when one is made, so that the command line can name the detectors
without numpy. Other packages bring detectors by entry points of the group `fingertip.detectors`,
each of which is a `DetectorType`.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.foundation.display import BLUE, ORANGE, RED, TEAL
from fingertip.foundation.errors import Issue, TraceError, quote_value
from fingertip.foundation.extras import blame_plugin, find_plugins, load_plugin

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.foundation.numerics import Array
    from fingertip.slip.detectors.detector import Detector


ENVELOPE_MEAN = "mean of the envelope"
VIBRATION = "mean of the rectified vibration"


@dataclass(frozen=True)
class DetectorType:
    words: str
    input_column: str
    """Column of the trace that the detector takes: ``voltage_v``,
    or the board's output ``envelope_v``.
    """
    quantity: str
    """Quantity that its threshold applies to.
    The design's threshold applies to the mean of the envelope.
    """
    load: Callable[[], type[Detector]]
    """Function that imports the detector's class."""
    colour: str
    marker: str
    second_column: str | None = None
    """Column that the detector takes beside it, where a recording has it."""
    not_on_divider: str = ""
    """Reason why it does not work on a divider, as the end of a sentence; empty if it
    works there.
    """

    @property
    def takes_envelope(self) -> bool:
        """True if it works on the board's output."""
        return self.input_column == "envelope_v"

    @property
    def has_design_threshold(self) -> bool:
        """True if it uses the design's threshold and window."""
        return self.quantity == ENVELOPE_MEAN

    @property
    def implementation(self) -> type[Detector]:
        return self.load()


def _load_analog() -> type[Detector]:
    from fingertip.slip.detectors.analog_and_digital import AnalogDetector  # noqa: PLC0415

    return AnalogDetector


def _load_digital() -> type[Detector]:
    from fingertip.slip.detectors.analog_and_digital import SlipChain  # noqa: PLC0415

    return SlipChain


def _load_fft() -> type[Detector]:
    from fingertip.slip.detectors.fft import FftDetector  # noqa: PLC0415

    return FftDetector


def _load_incipient() -> type[Detector]:
    from fingertip.slip.detectors.fast import IncipientDetector  # noqa: PLC0415

    return IncipientDetector


def _load_fast() -> type[Detector]:
    from fingertip.slip.detectors.fast import FastDetector  # noqa: PLC0415

    return FastDetector


_LOUD = (
    "takes contacts and changes of force for slip on a divider, whose voltage moves more with "
    "them than a board's"
)
DETECTORS: dict[str, DetectorType] = {
    "analog": DetectorType(
        words="on the board's output",
        input_column="envelope_v",
        quantity=ENVELOPE_MEAN,
        load=_load_analog,
        colour=BLUE,
        marker="s",
        not_on_divider="takes the filter board's output, and a divider has none",
    ),
    "digital": DetectorType(
        words="the article's chain in software",
        input_column="voltage_v",
        quantity=ENVELOPE_MEAN,
        load=_load_digital,
        colour=TEAL,
        marker="o",
        not_on_divider=_LOUD,
    ),
    "fft": DetectorType(
        words="the article's baseline",
        input_column="voltage_v",
        quantity="statistic of fft",
        load=_load_fft,
        colour=ORANGE,
        marker="^",
        not_on_divider=_LOUD,
    ),
    "incipient": DetectorType(
        words="fast at its early flag",
        input_column="voltage_v",
        quantity=VIBRATION,
        load=_load_incipient,
        colour=RED,
        marker="o",
        second_column="filtered_v",
        not_on_divider="takes knocks for slip on a divider, which gives no filtered signal",
    ),
    "fast": DetectorType(
        words="the article's chain over a learned floor",
        input_column="voltage_v",
        quantity=VIBRATION,
        load=_load_fast,
        colour=RED,
        marker="D",
        second_column="filtered_v",
    ),
}
GROUP = "fingertip.detectors"
"""Group of entry points by which other packages bring detectors."""
DEFAULT = "digital"
"""Detector of `detect` where neither a detector nor a design is named: the article's."""


def make_detector(
    name: str, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0
) -> Detector:
    """Create a detector for a design, ready for its first sample. Raises TraceError."""
    return check_detector(design, name).implementation.for_design(design, noise_v, threshold_scale)


def list_detectors() -> tuple[str, ...]:
    """List the names of all detectors, those of other packages last."""
    return (*DETECTORS, *(name for name in find_plugins(GROUP) if name not in DETECTORS))


def describe_detectors() -> list[str]:
    """List the names with few words on each, the default first."""
    words = {name: kind.words for name, kind in DETECTORS.items()}
    names = sorted(list_detectors(), key=lambda name: name != DEFAULT)
    return [f"{name} ({words.get(name, 'of another package')})" for name in names]


def select_inputs(source: object, name: str) -> tuple[Array, ...]:
    """Select the columns that a detector processes, of a trace or an observation."""
    kind = find_detector_type(name)
    first: Array | None = getattr(source, kind.input_column, None)
    second: Array | None = getattr(source, kind.second_column, None) if kind.second_column else None
    if first is None:
        return ()

    return (first,) if second is None else (first, second)


@dataclass(frozen=True)
class UsedSignals:
    """Columns of a trace that a detector takes."""

    columns: tuple[str, ...]
    missing: str | None
    """Column that it would take too and that is not there."""

    def describe(self) -> str:
        used = " and ".join(self.columns)
        return (
            f"on {used}" if self.missing is None else f"on {used} alone (no column {self.missing})"
        )


def find_signals(design: Design, name: str, has_second: bool) -> UsedSignals:
    """Find the columns that a detector takes for the board of a design."""
    first = find_detector_type(name).input_column
    second = find_second_column(design, name)
    if second is None:
        return UsedSignals((first,), None)

    return UsedSignals((first, second), None) if has_second else UsedSignals((first,), second)


def find_second_column(design: Design, name: str) -> str | None:
    """Find the column that a detector takes beside its first for the
    board of a design; None if there is none.
    """
    from fingertip.design.formulas.filter import filtered_range_v  # noqa: PLC0415

    second = find_detector_type(name).second_column
    return (
        second if filtered_range_v(design.board, design.detector.adc_range_v) is not None else None
    )


def check_detector(design: Design, name: str, field: str = "--detector") -> DetectorType:
    """Look up a type of detector, and refuse one that does not work on a divider.

    Raises TraceError, about a field.
    """
    kind = find_detector_type(name, field)
    if kind.not_on_divider and not design.board.has_filter:
        remedy = (
            f"use {field} fast, or a board with --set board.variant=precision --set "
            "board.supply_v=3.3"
        )
        raise TraceError(Issue(field, f"{name} {kind.not_on_divider}; {remedy}."))

    return kind


def find_detector_type(name: str, field: str = "--detector") -> DetectorType:
    """Look up a type of detector by name. Raises TraceError, about a field."""
    if name in find_plugins(GROUP):
        return _load_type(name)

    if name not in DETECTORS:
        from fingertip.design.parameters.declaration import suggest_name  # noqa: PLC0415

        raise TraceError(
            Issue(field, f"{name!r} is not a detector; {suggest_name(name, list_detectors())}")
        )

    return DETECTORS[name]


@functools.cache
def _load_type(name: str) -> DetectorType:
    found = load_plugin(GROUP, name, DETECTORS)
    if not isinstance(found, DetectorType):
        raise TraceError(
            Issue(
                f"{GROUP}, {name}",
                f"is no DetectorType but {quote_value(found)}; correct the package.",
            )
        )

    with blame_plugin(GROUP, name):
        found.implementation  # noqa: B018 (its code is imported here, where its package is named)

    return found
