"""Survey of a recording: what each of its columns can be by its
values, and the options that read it.
"""

from __future__ import annotations

import datetime
import itertools
import math
import re
import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue, join_words
from fingertip.foundation.numerics import Array
from fingertip.slip.traces import sampling
from fingertip.slip.traces.columns import (
    DELIMITERS,
    SPACES,
    is_value,
    parse_instant,
    parse_number,
    split_plain,
)
from fingertip.slip.traces.sampling import MAX_RATE_HZ, MIN_RATE_HZ, TIME_UNITS_S
from fingertip.slip.traces.trace import COLUMNS, ColumnMap, is_force

_TIME = re.compile(
    r"%?(time|zeit|date|.*stamp|elapsed|[tx]|[mun]s|millis|micros|x.?axis|seconds?|x_value)\b", re.I
)
_SENSOR = re.compile(r"fsr|force|tactile|touch|finger|sensor|volt", re.I)
_RATE = re.compile(r"fs\b.*|(sampl\w*|acq\w*|scan)?[ _]?(rate|freq\w*).*", re.I)
_INTERVAL = re.compile(
    r"(sampl\w*|scan)[ _]?(interval|period|time|step).*|.*increment|delta[ _]?[xt]|dt", re.I
)
_SETTING = re.compile(
    r"model|serial|firmware|version|instrument|device|source|record|operator|title", re.I
)
_UNIT_IN_NAME = re.compile(r".*?(?:[\[(]\s*([a-zµμ]+)\s*[\])]|_(ms|us|ns|mv|uv|v|s))$", re.I)
UNIT_WORD = re.compile(
    r"[\[(]?(sequence|[mnuµμ]?s|sec(?:onds?)?|[muµμ]?v|volts?|n|newtons?|hz|counts?|a|-|)[\])]?",
    re.I,
)
_OTHERS = {*COLUMNS, "sampled_envelope_v", "sampled_filtered_v"} - {"time_s", "voltage_v"}
_MOST_LISTED = 12
SURVEYED_LINES = 5200
_LEAST_RUN = 20
"""Number of lines by which the body of a file is found, and of
samples in a row with which it begins.
"""


@dataclass(frozen=True)
class Content:
    """Content of a column, from its values."""

    key: str
    """Name or number that selects it."""
    name: str
    unit: str
    kind: str
    """One of text, constant, rate, counter, time and signal."""
    low: float = 0.0
    high: float = 0.0
    rate_hz: float = 0.0
    """Mean rate of one that rises, if it is in seconds [Hz]."""
    is_uneven: bool = False

    def __str__(self) -> str:
        name = (
            f"{self.key} {self.name!r}"
            if self.key.isdecimal() and self.name != self.key
            else self.key
        )
        return f"{name} ({self.low:.4g} to {self.high:.4g})"

    @property
    def time_unit(self) -> str | None:
        """Unit in which its steps are those of a detector's rate."""
        return (
            "s"
            if MIN_RATE_HZ <= self.rate_hz <= MAX_RATE_HZ
            else sampling.guess_time_unit(self.rate_hz)
        )


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def examine(key: str, values: Array, name: str = "", unit: str = "") -> Content:
    """Find what a column can be from its values; those that are no numbers are NaN."""
    name = name or key
    stated = _UNIT_IN_NAME.fullmatch(name)
    unit = (unit or (stated and (stated[1] or stated[2])) or "").lower()
    finite = values[np.isfinite(values)]
    if len(finite) < max(1.0, len(values) / 2):
        return Content(key, name, unit, "text")

    low = float(finite.min())
    high = float(finite.max())
    kind = "signal"
    rate_hz = 0.0

    if low == high:
        kind = "rate" if _RATE.fullmatch(name) and MIN_RATE_HZ <= low <= MAX_RATE_HZ else "constant"
    elif sampling.rises_as_time(finite):
        is_time = (
            _TIME.match(name) and unit != "sequence" and name.lower() != "x"
        ) or unit in TIME_UNITS_S
        kind = "time" if is_time or (np.diff(finite) == 1.0).mean() <= 0.9 else "counter"
        rate_hz = float((len(finite) - 1) / (finite[-1] - finite[0]))

    return Content(
        key=key,
        name=name,
        unit=unit,
        kind=kind,
        low=low,
        high=high,
        rate_hz=rate_hz,
        is_uneven=not sampling.rises_evenly(finite),
    )


@dataclass(frozen=True)
class Survey:
    """Columns of a file; of a text file also its body, the long
    run of lines with equally many cells.
    """

    columns: Sequence[Content]
    rate_hz: float | None = None
    """Rate that the file states in words [Hz]."""
    delimiter: str = ","
    first: int = 1
    """Line number of the first sample."""
    header: int = 0
    """Line number of the names of the columns; 0 if there is none."""

    def find_issues(
        self,
        field: str,
        noun: str,
        names: Sequence[str],
        columns: ColumnMap,
        missing: Sequence[str],
    ) -> Iterator[Issue]:
        """Name each missing column of a file that has columns of some
        names; propose options with the last one.
        """
        proposal = self.propose(columns, missing)
        for column in missing:
            name = columns.name_in_file(column)
            remedy = suggest_name("" if "NAME" in proposal else name, names)
            yield Issue(
                field,
                f"there is no {noun} {name}; {remedy}{proposal if column == missing[-1] else ''}",
            )

    def propose(self, columns: ColumnMap, missing: Sequence[str], either: str = "Or ") -> str:
        """Propose options that name the columns that are missing,
        in sentences that follow another one.
        """
        signals = [
            c
            for c in self.columns
            if c.kind == "signal" and c.key != columns.name_in_file("time_s")
        ]
        signals = [c for c in signals if c.name not in _OTHERS] or [
            c for c in signals if c.name != "slip"
        ]
        notes = ""
        options = list[str]()
        units = list[str]()

        if "voltage_v" in missing and not signals:
            kinds = ", ".join([f"{each.key} ({each.kind})" for each in self.columns[:_MOST_LISTED]])
            return f" No column varies as a signal does: {kinds or 'none holds numbers'}."

        named = [
            each
            for each in signals
            if len(signals) == 1 or _SENSOR.search(f"{each.key} {each.name}")
        ]
        best = named[0] if len(named) == 1 else Content("NAME", "", "", "signal")
        if "time_s" in missing:
            group = re.sub(r"[^/.]*$", "", best.key) if len(named) == 1 else ""
            notes, options, units = self._propose_time(len(signals) == 1, columns, group)

        if "voltage_v" in missing:
            notes += _list_candidates("voltage", signals)
            options += [f"--column voltage_v={shlex.quote(best.key)}"] * (best.key != "voltage_v")
            if columns.scale == 1.0 and best.unit[1:] == "v":
                units.append(f"--scale {parse_number(f'1 {best.unit}'):g}")
            elif is_force(best.name):
                reason = (
                    "a force has no threshold in volts: give the interval in which nothing happens"
                )
                units.append(f"--calibrate 0:0.5 ({reason})")

        count = sum(option.startswith("--column") for option in options)
        verb = f"name the file's column{'s' * (count > 1)}" if count else "give its rate"
        if count and all(each.key.replace("+", "").isdecimal() for each in self.columns):
            verb = "give its columns by number"
            options = [each.replace("=NAME", "=NUMBER") for each in options]

        proposal = f"{either}{verb}: {' '.join([*options, *units])}"
        return notes + (f" {proposal[0].upper()}{proposal[1:]}" if options or units else "")

    def _propose_time(
        self, is_free: bool, columns: ColumnMap, group: str
    ) -> tuple[str, list[str], list[str]]:
        """Propose the times, or the rate where there are none:
        notes, options, and the option of a unit.
        """
        times = [each for each in self.columns if each.kind == "time"]
        times = [each for each in times if each.key.startswith(group)] or times

        for rank in (
            lambda c: not c.is_uneven,
            lambda c: _TIME.match(c.name),
            lambda c: c.time_unit,
        ):
            times = [each for each in times if rank(each)] or times

        if len(times) > 1 and not is_free:
            return _list_candidates("time", times), ["--column time_s=NAME"], []

        rate_hz = next((each.low for each in self.columns if each.kind == "rate"), self.rate_hz)
        for time in times[:1]:
            unit = time.time_unit or "s"
            if columns.name_in_file("time_s") != "none":
                options = [f"--column time_s={shlex.quote(time.key)}"] * (time.key != "time_s")
                return (
                    "",
                    options,
                    [f"--time-scale {unit}"] * (unit != "s" and columns.time_scale == 1.0),
                )

            rate_hz = time.rate_hz / TIME_UNITS_S[unit]

        if rate_hz:
            return "", [f"--rate-hz {rate_hz:.6g}"], []

        return " No column holds times, so give the sampling rate for HZ.", ["--rate-hz HZ"], []


def _list_candidates(noun: str, contents: Sequence[Content]) -> str:
    if len(contents) < 2:
        return ""

    return (
        f" {len(contents)} columns can be the {noun}, "
        f"{join_words([*map(str, contents[:_MOST_LISTED])])}."
    )


def join_seconds(contents: Sequence[Content], values: Mapping[str, Array]) -> Iterator[Content]:
    """Yield the contents, with columns of seconds and of nanoseconds
    as one, whose key joins theirs by a plus.
    """
    joined: dict[str, Content] = {}
    for (seconds, whole), (nanos, parts) in itertools.permutations(values.items(), 2):
        if len(whole) != len(parts) or not np.isfinite([whole, parts]).all() or (whole % 1).any():
            continue

        carries = np.diff(whole) == 1.0
        in_second = parts.min(initial=1.0) >= 0.0 and 1e6 < parts.max(initial=0.0) < 1e9
        if in_second and (carries == (np.diff(parts) < 0.0)).all():
            content = examine(f"{seconds}+{nanos}", whole - whole[0] + 1e-9 * parts, "time")
            if content.time_unit == "s" and (carries.any() or "sec" in seconds.lower()):
                joined[seconds] = joined[nanos] = content

    yield from dict.fromkeys(joined.get(content.key, content) for content in contents)


def survey_lines(lines: Sequence[str]) -> Survey | None:
    """Survey the first lines of a text file; None if no body of numbers is found."""
    filled = [(number, line) for number, line in enumerate(lines, 1) if line.strip()]
    data = [(number, line) for number, line in filled if not line.lstrip().startswith("#")]
    if not data:
        return None

    delimiter = _find_delimiter([line.strip() for _, line in data])
    rows = [(number, split_plain(line, delimiter)) for number, line in data]
    width = Counter(len(cells) for _, cells in rows[len(rows) // 2 :]).most_common(1)[0][0]
    columns = zip(*(cells for _, cells in rows if len(cells) == width), strict=True)
    numeric = [i for i, cells in enumerate(columns) if 2 * sum(map(is_value, cells)) > len(cells)]
    shown = ([cells[i] for i in numeric] if len(cells) == width else [] for _, cells in rows)
    is_sample = [any(cells) and all(is_value(cell) for cell in cells if cell) for cells in shown]
    place = next((i for i in range(len(rows)) if all(is_sample[i : i + _LEAST_RUN])), None)
    if place is None:
        return None

    found = zip(rows[place:], is_sample[place:], strict=True)
    first = rows[place][0]
    body = [cells for (_, cells), is_one in found if is_one]
    above = [
        (number, _split_above(line.lstrip("# "), delimiter))
        for number, line in filled
        if number < first
    ]
    header, names, units = _find_header(above, width, numeric)
    # Rigol writes the increment below its name, and Tektronix the settings beside the samples.
    settings = [
        *(cells for _, cells in above),
        *zip(names, units, strict=False),
        *(cells[:3] for cells in body[:30]),
    ]
    is_plain = (
        len(names) == width == len(set(names))
        and all(names)
        and not any("+" in name for name in names)
    )
    is_plain = (
        is_plain and sum(map(str.isdecimal, names)) != 1
    )  # two names that are numbers win over numbers
    contents = list[Content]()
    values = dict[str, Array]()

    for i in range(width):
        name, unit = (cells[i] if i < len(cells) else "" for cells in (names, units))
        key = name if is_plain else str(i + 1)
        values[key] = np.array([_parse(cells[i]) for cells in body])
        match = UNIT_WORD.fullmatch(unit)
        contents.append(examine(key, values[key], name, match[1] if match else ""))

    return Survey(
        columns=tuple(join_seconds(contents, values)),
        rate_hz=_find_rate(settings),
        delimiter=delimiter,
        first=first,
        header=header,
    )


def _split_above(line: str, delimiter: str) -> list[str]:
    """Split a line above the body, which may have another delimiter."""
    return split_plain(
        line, next((each for each in (delimiter, *DELIMITERS) if each in line), delimiter)
    )


def _find_delimiter(lines: Sequence[str]) -> str:
    """Find the delimiter of the lines in the second half, in which no
    preamble is; a tab if each is one number.
    """
    half = lines[len(lines) // 2 :][:200]
    if sum(parse_number(line.strip('"')) is not None for line in half) > 0.9 * len(half):
        above = next(
            (line for line in reversed(lines) if not any(map(is_value, line.split(",")))), ""
        )
        parts = [line.split(",") for line in half]
        is_one = (
            '"' in "".join(half)
            or len({*map(len, parts)}) > 1
            or len(parts[0]) == 1
            or "," not in (above or ",")
        )

        if is_one or any(
            re.match(r"0\d", cells[-1]) for cells in parts
        ):  # no whole number begins with zero
            return "\t"

    for delimiter in ("\t", ";", ",", SPACES):
        rows = [split_plain(line, delimiter) for line in half]
        [(usual, count)] = Counter(map(len, rows)).most_common(1)
        if (
            usual > 1
            and count > 0.8 * len(half)
            and any(is_value(cell) for cells in rows[-3:] for cell in cells)
        ):
            return delimiter

    return ","


def _parse(cell: str) -> float:
    """Return a number, or the seconds of a date; else NaN."""
    value = parse_number(cell)
    instant = parse_instant(cell)
    if instant:
        return instant.replace(tzinfo=datetime.UTC).timestamp()
    if value is None:
        return math.nan

    return value


def _find_header(
    above: Sequence[tuple[int, list[str]]], width: int, numeric: Sequence[int]
) -> tuple[int, list[str], list[str]]:
    """Find the last line above the body that names its columns: its
    number, its names, and the units below it.
    """
    units: list[str] = []
    for number, cells in above[:-3:-1]:
        shown = [cells[i] for i in numeric if i < len(cells)]
        is_full = len(cells) >= max(width - 1, min(width, 2)) and any(
            cell and not is_value(cell) for cell in shown
        )
        is_pair = sum(map(bool, cells)) == 2
        is_setting = is_pair and (
            _SETTING.match(cells[0]) or (len(cells[1]) > 2 and is_value(cells[1]))
        )
        is_units = (
            shown and all(map(UNIT_WORD.fullmatch, shown)) and (width > 1 or cells[0][0] in "([")
        )

        if not units and is_units and len(above) > 1:
            units = cells
        elif is_full and not is_setting:
            return number, cells, units
        else:
            break

    if units and any(units) and len(units) >= width - 1:  # names that look like units
        return above[-1][0], units, []

    return 0, [], []


def _find_rate(settings: Sequence[Sequence[str]]) -> float | None:
    """Find the sampling rate among settings and their values [Hz]."""
    for cells in settings:
        filled = [cell for cell in cells if cell]
        for key, text in itertools.pairwise(
            re.split(r"\s*[:=]\s*", filled[0]) if len(filled) == 1 else cells
        ):
            value = parse_number(text) or 0.0
            if value and _INTERVAL.fullmatch(key):
                rate_hz = 1 / value
            elif _RATE.fullmatch(key):
                rate_hz = value
            else:
                rate_hz = 0.0

            if MIN_RATE_HZ <= rate_hz <= MAX_RATE_HZ:
                return float(f"{rate_hz:.9g}")

    return None
