"""Labelled recordings: the benchmark's own signals, and the folders of recordings that it reads.

A folder holds recordings of any kind that `fingertip detect` reads, and two files beside them.

`labels.csv` has one line for each stretch: ``file,kind,start_s,end_s,motion_s``. The kind is
``slip`` or one of `KINDS`. Times count from the first sample. ``start_s`` of a slip is its onset,
gross slip; ``motion_s`` is the moment at which the object or the finger began to move, empty if it
is not known.

`bench.toml` says how the files are to be read. All of it may be left out::

    title = "Name of the set, and of its paper"
    rate_hz = 5000            # if the files hold no times
    scale = 0.01              # volts, or any unit, per unit of the files
    rises_with_force = true   # false: the signal falls as the force grows
    columns = {voltage_v = "Force [N]"}
"""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip.mix_signals import LabelledSignal, Slide
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue, TraceError
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.sampling import rate_bounds_message
from fingertip.slip.traces.trace import ColumnMap, RawTrace
from fingertip.slip.traces.truth import Interval

KINDS = (
    "quiet",
    "contact",
    "hand motion",
    "servo steps",
    "step",
    "set-down",
    "release",
    "ramp",
    "tap",
    "knock",
    "ring",
    "vibration",
    "hum",
    "unsure",
)
"""Kinds of stretches without slip. ``unsure`` is time in which nothing counts."""
SLIP = "slip"
QUIET = "quiet"
UNSURE = "unsure"
UNLABELLED = "unlabelled"
LABELS = "labels.csv"
SETTINGS = "bench.toml"
MIN_QUIET_S = 0.3
"""Shortest quiet stretch from which a detector takes the noise [s]."""
SETTLING_S = 0.5
"""Time from the start of a recording in which alarms do not count [s]: detectors learn
the noise.
"""
_HEADER = ["file", "kind", "start_s", "end_s", "motion_s"]
_SETTINGS: dict[str, tuple[type, ...]] = {
    "title": (str,),
    "rate_hz": (int, float),
    "scale": (int, float),
    "time_scale": (int, float),
    "rises_with_force": (bool,),
    "columns": (dict,),
}


@dataclass(frozen=True)
class Stretch:
    kind: str
    start_s: float
    end_s: float
    motion_s: float | None = None
    """Start of the motion that leads to a slip [s]; None if it is not known."""


@dataclass(frozen=True, eq=False)
class Recording:
    signal: LabelledSignal
    stretches: tuple[Stretch, ...]
    """Stretches without slip that are labelled."""
    rest: Array | None = None
    """Samples of a stated rest, from the end of which detectors take the noise; None: the design's
    noise holds.
    """
    rises_with_force: bool | None = None
    """True if the signal rises as the force grows; None: as on the design's board."""
    design: Design | None = None
    """Design whose detectors hear it; None: that of the command."""


@dataclass(frozen=True)
class RecordingSet:
    title: str
    recordings: tuple[Recording, ...]


def read_folder(
    folder: Path, columns: ColumnMap | None = None, title: str | None = None
) -> RecordingSet:
    """Read a folder of labelled recordings; its settings go before those given.

    Raises TraceError with all faults.
    """
    settings = _read_settings(folder)
    labels = _read_labels(folder / LABELS)
    columns = columns or ColumnMap()
    columns = ColumnMap(
        {**columns.names, **settings.get("columns", {})},
        settings.get("rate_hz", columns.rate_hz),
        settings.get("scale", columns.scale),
        settings.get("time_scale", columns.time_scale),
    )

    def read(path: Path) -> Iterator[Recording]:
        raw = read_raw_trace(path, columns)
        conflicts = [*_find_conflicts(path.name, labels[path.name])]
        if conflicts:
            raise TraceError(conflicts)

        yield label_trace(raw, labels[path.name], settings.get("rises_with_force", True))

    title = settings.get("title", title or folder.resolve().name)
    return collect_recordings(title, [folder / name for name in labels], read, folder)


def collect_recordings(
    title: str, paths: Sequence[Path], read: Callable[[Path], Iterator[Recording]], folder: Path
) -> RecordingSet:
    """Read files one by one. Raises TraceError with the faults of all of them."""
    issues = list[Issue]()
    recordings = list[Recording]()

    for path in paths:
        try:
            recordings += read(path)
        except FingertipError as error:
            issues += error.issues
        except KeyError as error:
            issues.append(
                Issue(
                    str(path),
                    f"has no column {error}, which the set's authors name; give another file.",
                )
            )

    if issues:
        raise TraceError(issues)
    if not recordings:
        raise TraceError(
            Issue(
                str(folder),
                "holds no recording of this layout; give the folder that the set is in.",
            )
        )
    if not any(recording.signal.slides for recording in recordings):
        raise TraceError(
            Issue(str(folder), "holds no slip; label one, or there is no delay to measure.")
        )

    if not any(
        slide.motion_s >= SETTLING_S for one in recordings for slide in one.signal.slides[:1]
    ):
        rest = (
            f"no recording rests for {SETTLING_S:g} s before its first slip, and detectors "
            "learn the noise from rest"
        )
        raise TraceError(
            Issue(
                str(folder), f"{rest}; join rest before it, as python -m benchmarks.slip.real does."
            )
        )

    return RecordingSet(title, _share_quiet(recordings))


def label_trace(raw: RawTrace, stretches: Sequence[Stretch], rises_with_force: bool) -> Recording:
    """Join a recording with its labels. Raises TraceError."""
    rate_hz = raw.rate_hz
    if raw.issues or not rate_hz:
        raise TraceError(
            raw.issues
            or [Issue(f"{raw.name}, time_s", "is not evenly spaced; record without gaps.")]
        )

    message = rate_bounds_message(rate_hz)
    if message:
        raise TraceError(Issue(f"{raw.name}, time_s", message))

    volts = raw.trace.voltage_v
    filtered = raw.trace.filtered_v
    if not np.isfinite(volts).all():
        raise TraceError(
            Issue(
                f"{raw.name}, voltage_v", "holds numbers that are not finite; remove these samples."
            )
        )

    duration_s = len(volts) / rate_hz
    outside = [
        one for one in stretches if not 0.0 <= one.start_s < one.end_s <= duration_s + 0.5 / rate_hz
    ]
    if outside:
        raise TraceError([_outside(raw.name, one, duration_s) for one in outside])

    slips = sorted((one for one in stretches if one.kind == SLIP), key=lambda one: one.start_s)
    starts = (one.start_s if one.motion_s is None else one.motion_s for one in slips)
    slides = tuple(
        Slide(motion_s, one.start_s, one.end_s) for motion_s, one in zip(starts, slips, strict=True)
    )
    others = tuple(one for one in stretches if one.kind != SLIP)
    events = tuple(
        Interval(one.start_s, one.end_s) for one in others if one.kind not in (QUIET, UNSURE)
    )
    long = [one for one in others if one.kind == QUIET and one.end_s - one.start_s >= MIN_QUIET_S]
    quiet = (
        volts[round(long[0].start_s * rate_hz) : round(long[0].end_s * rate_hz)] if long else None
    )
    signal = LabelledSignal(
        kind=raw.name,
        rate_hz=rate_hz,
        voltage_v=volts,
        slides=slides,
        events=events,
        alarms_from_s=SETTLING_S,
        filtered_v=filtered,
    )

    return Recording(signal, others, quiet, rises_with_force)


def _outside(name: str, stretch: Stretch, duration_s: float) -> Issue:
    span = f"{stretch.kind} from {stretch.start_s:g} to {stretch.end_s:g} s"
    return Issue(
        f"{LABELS}, {Path(name).name}",
        f"{span} does not lie within the recording, 0 to {duration_s:.6g} s; correct it.",
    )


def _find_conflicts(name: str, stretches: Sequence[Stretch]) -> Iterator[Issue]:
    """Report slips that begin before a detector can find them, and stretches that overlap one."""
    field = f"{LABELS}, {name}"
    for at, one in enumerate(stretches):
        if one.kind == SLIP and one.start_s < SETTLING_S:
            message = f"a slip begins at {one.start_s:g} s, while detectors still learn the noise"
            yield Issue(
                field,
                f"{message}; record {SETTLING_S:g} s before it, or label that stretch {UNSURE}.",
            )

        for other in stretches[at + 1 :]:
            if (
                SLIP in (one.kind, other.kind)
                and one.start_s < other.end_s
                and other.start_s < one.end_s
            ):
                spans = " and ".join(
                    f"{each.kind} from {each.start_s:g} to {each.end_s:g} s"
                    for each in (one, other)
                )
                yield Issue(field, f"{spans} overlap; let one end where the other begins.")


def _share_quiet(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Give recordings without a quiet stretch that of the first one
    that has any, or else their own beginning.
    """
    first = next((recording.rest for recording in recordings if recording.rest is not None), None)

    def choose(one: Recording) -> Recording:
        if one.rest is not None:
            return one

        begin = one.signal.voltage_v[: round(MIN_QUIET_S * one.signal.rate_hz)]
        return replace(one, rest=begin if first is None else first)

    return tuple(map(choose, recordings))


def _read_settings(folder: Path) -> dict[str, Any]:
    path = folder / SETTINGS
    if not path.is_file():
        return {}

    try:
        tables = tomllib.loads(read_input(path, PARSED_LIMIT, below=folder).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise TraceError(Issue(str(path), f"is not TOML ({error}); correct it.")) from None

    issues = [
        Issue(f"{path}, {name}", f"is not known; choose among {', '.join(_SETTINGS)}.")
        for name in tables
        if name not in _SETTINGS
    ]
    for name, types in _SETTINGS.items():
        if name not in tables:
            continue

        value = tables[name]
        # In Python, true is a number.
        if not isinstance(value, types) or isinstance(value, bool) != (bool in types):
            expected = {str: "a text", bool: "true or false", dict: "a table"}.get(
                types[0], "a number"
            )
            issues.append(Issue(f"{path}, {name}", f"{value!r} is not {expected}; correct it."))

    if not issues and any(
        not isinstance(value, str) for value in tables.get("columns", {}).values()
    ):
        issues.append(
            Issue(f"{path}, columns", 'gives a name for each column, such as {voltage_v = "AI0"}.')
        )
    if issues:
        raise TraceError(issues)

    return tables


def _read_labels(path: Path) -> dict[str, list[Stretch]]:
    """Read the labels by file. Raises TraceError."""
    if not path.is_file():
        raise TraceError(
            Issue(
                str(path), f"is missing; write a line {','.join(_HEADER)} and one for each stretch."
            )
        )

    text = read_input(path, PARSED_LIMIT, below=path.parent).decode("utf-8-sig", errors="replace")
    rows = list(csv.reader(io.StringIO(text)))
    if not rows or [cell.strip() for cell in rows[0]] not in (_HEADER, _HEADER[:4]):
        raise TraceError(
            Issue(f"{path}, line 1", f"is not the header {','.join(_HEADER)}; write it so.")
        )

    labels = dict[str, list[Stretch]]()
    issues = list[Issue]()
    for number, row in enumerate(rows[1:], start=2):
        cells = [cell.strip() for cell in row]
        if not any(cells):
            continue

        try:
            labels.setdefault(cells[0] if cells else "", []).append(
                _parse_stretch(cells, len(rows[0]))
            )
        except ValueError as error:
            issues.append(Issue(f"{path}, line {number}", str(error)))

    issues += [
        Issue(
            f"{path}, {name}", "does not name a file of this folder; give its name without folders."
        )
        for name in labels
        if Path(name).name != name
    ]
    if issues:
        raise TraceError(issues)

    return labels


def _parse_stretch(cells: Sequence[str], expected: int) -> Stretch:
    if len(cells) != expected:
        raise ValueError(f"has {len(cells)} cells; give {expected}, as the header does.")

    kind = cells[1]
    if kind not in (SLIP, *KINDS):
        raise ValueError(
            f"{kind!r} is not a kind of stretch; choose among {SLIP}, {', '.join(KINDS)}."
        )

    try:
        start_s = float(cells[2])
        end_s = float(cells[3])
        motion_s = float(cells[4]) if cells[4:] and cells[4] else None
    except ValueError:
        raise ValueError("has a time that is not a number; give seconds, such as 1.25.") from None

    if not start_s < end_s:
        raise ValueError(
            f"ends at {end_s:g} s and begins at {start_s:g} s; give an end after the start."
        )
    if motion_s is not None and (kind != SLIP or not motion_s <= start_s):
        raise ValueError(
            "motion_s is the moment at which a slip's motion begins, before its onset; correct it."
        )

    return Stretch(kind, start_s, end_s, motion_s)
