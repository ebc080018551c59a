"""Survey of a recording's columns: what each can be, and the options that read it."""

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
from fingertip.slip.traces.cells import (
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
"""Number of lines that are surveyed, and of samples in a row with which the body begins."""


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
        name = self.key
        if self.key.isdecimal() and self.name != self.key:
            name = f"{self.key} {self.name!r}"

        return f"{name} ({self.low:.4g} to {self.high:.4g})"

    @property
    def time_unit(self) -> str | None:
        """Unit in which its steps are those of a detector's rate."""
        if MIN_RATE_HZ <= self.rate_hz <= MAX_RATE_HZ:
            return "s"

        return sampling.guess_time_unit(self.rate_hz)


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def examine(key: str, values: Array, name: str = "", unit: str = "") -> Content:
    """Find what a column can be from its values; those that are no numbers are NaN."""
    name = name or key
    match = _UNIT_IN_NAME.fullmatch(name)
    if match and not unit:
        unit = match[1] or match[2] or ""

    unit = unit.lower()
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
        has_time_name = _TIME.match(name) and unit != "sequence" and name.lower() != "x"
        is_counting = (np.diff(finite) == 1.0).mean() > 0.9
        is_time = has_time_name or unit in TIME_UNITS_S or not is_counting
        kind = "time" if is_time else "counter"
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
    """Columns of a file; of a text file also its body of lines with equally many cells."""

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
        """Yield an issue for each missing column; the last one proposes options."""
        proposal = self.propose(columns, missing)
        for column in missing:
            name = columns.name_in_file(column)
            remedy = suggest_name("" if "NAME" in proposal else name, names)
            yield Issue(
                field,
                f"there is no {noun} {name}; {remedy}{proposal if column == missing[-1] else ''}",
            )

    def propose(self, columns: ColumnMap, missing: Sequence[str], either: str = "Or ") -> str:
        """Propose options that name the missing columns, in sentences that follow another one."""
        signals = self._list_signals(columns)
        notes = ""
        options = list[str]()
        units = list[str]()

        if "voltage_v" in missing and not signals:
            kinds = ", ".join(
                f"{content.key} ({content.kind})" for content in self.columns[:_MOST_LISTED]
            )
            return f" No column varies as a signal does: {kinds or 'none holds numbers'}."

        likely = [
            signal
            for signal in signals
            if len(signals) == 1 or _SENSOR.search(f"{signal.key} {signal.name}")
        ]
        best = likely[0] if len(likely) == 1 else Content("NAME", "", "", "signal")
        if "time_s" in missing:
            group = re.sub(r"[^/.]*$", "", best.key) if len(likely) == 1 else ""
            notes, options, units = self._propose_time(len(signals) == 1, columns, group)

        if "voltage_v" in missing:
            notes += _list_candidates("voltage", signals)
            units += _propose_unit(best, columns)
            if best.key != "voltage_v":
                options.append(f"--column voltage_v={shlex.quote(best.key)}")

        if not options and not units:
            return notes

        count = sum(option.startswith("--column") for option in options)
        verb = f"name the file's column{'s' * (count > 1)}" if count else "give its rate"
        if count and all(content.key.replace("+", "").isdecimal() for content in self.columns):
            verb = "give its columns by number"
            options = [option.replace("=NAME", "=NUMBER") for option in options]

        proposal = f"{either}{verb}: {' '.join([*options, *units])}"
        return f"{notes} {proposal[0].upper()}{proposal[1:]}"

    def _list_signals(self, columns: ColumnMap) -> list[Content]:
        """List the columns that may be the voltage: no other column of a trace, if possible."""
        times = columns.name_in_file("time_s")
        signals = [
            content for content in self.columns if content.kind == "signal" and content.key != times
        ]
        preferred = [signal for signal in signals if signal.name not in _OTHERS]
        return preferred or [signal for signal in signals if signal.name != "slip"]

    def _propose_time(
        self, is_free: bool, columns: ColumnMap, group: str
    ) -> tuple[str, list[str], list[str]]:
        """Propose times, or a rate without any: notes, options, and the option of a unit."""
        times = [content for content in self.columns if content.kind == "time"]
        times = [time for time in times if time.key.startswith(group)] or times
        times = [time for time in times if not time.is_uneven] or times
        times = [time for time in times if _TIME.match(time.name)] or times
        times = [time for time in times if time.time_unit] or times

        if len(times) > 1 and not is_free:
            return _list_candidates("time", times), ["--column time_s=NAME"], []

        rates_hz = (content.low for content in self.columns if content.kind == "rate")
        rate_hz = next(rates_hz, self.rate_hz)
        if times:
            time = times[0]
            unit = time.time_unit or "s"
            if columns.name_in_file("time_s") != "none":
                options = [f"--column time_s={shlex.quote(time.key)}"]
                units = [f"--time-scale {unit}"]
                has_unit = unit != "s" and columns.time_scale == 1.0
                return "", options if time.key != "time_s" else [], units if has_unit else []

            rate_hz = time.rate_hz / TIME_UNITS_S[unit]

        if rate_hz:
            return "", [f"--rate-hz {rate_hz:.6g}"], []

        return " No column holds times, so give the sampling rate for HZ.", ["--rate-hz HZ"], []


def _propose_unit(signal: Content, columns: ColumnMap) -> list[str]:
    """Propose the option that a signal in another unit than volts needs."""
    if columns.scale == 1.0 and signal.unit[1:] == "v":
        return [f"--scale {parse_number(f'1 {signal.unit}'):g}"]
    if is_force(signal.name):
        reason = "a force has no threshold in volts: give the interval in which nothing happens"
        return [f"--calibrate 0:0.5 ({reason})"]

    return []


def _list_candidates(noun: str, contents: Sequence[Content]) -> str:
    if len(contents) < 2:
        return ""

    return (
        f" {len(contents)} columns can be the {noun}, "
        f"{join_words([*map(str, contents[:_MOST_LISTED])])}."
    )


def join_seconds(contents: Sequence[Content], values: Mapping[str, Array]) -> Iterator[Content]:
    """Yield the contents, with columns of seconds and nanoseconds joined as "A+B"."""
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
    numbers = ([cells[i] for i in numeric] if len(cells) == width else [] for _, cells in rows)
    is_sample = [any(cells) and all(is_value(cell) for cell in cells if cell) for cells in numbers]
    place = next((i for i in range(len(rows)) if all(is_sample[i : i + _LEAST_RUN])), None)
    if place is None:
        return None

    first = rows[place][0]
    samples = zip(rows[place:], is_sample[place:], strict=True)
    body = [cells for (_, cells), fits in samples if fits]
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
    has_names = (
        len(names) == width == len(set(names))
        and all(names)
        and not any("+" in name for name in names)
        and sum(map(str.isdecimal, names)) != 1  # two names that are numbers win over numbers
    )
    contents = list[Content]()
    values = dict[str, Array]()

    for i in range(width):
        name, unit = (cells[i] if i < len(cells) else "" for cells in (names, units))
        key = name if has_names else str(i + 1)
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
    candidates = (delimiter, *DELIMITERS)
    own = next((candidate for candidate in candidates if candidate in line), delimiter)
    return split_plain(line, own)


def _find_delimiter(lines: Sequence[str]) -> str:
    """Find the delimiter of the second half of the lines; a tab if each is one number."""
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

        # No whole number begins with zero.
        if is_one or any(re.match(r"0\d", cells[-1]) for cells in parts):
            return "\t"

    for delimiter in ("\t", ";", ",", SPACES):
        rows = [split_plain(line, delimiter) for line in half]
        [(usual, count)] = Counter(map(len, rows)).most_common(1)
        has_numbers = any(map(is_value, itertools.chain(*rows[-3:])))
        if usual > 1 and count > 0.8 * len(half) and has_numbers:
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
    """Find the last line above the body with names: its number, the names, and their units."""
    units: list[str] = []
    for number, cells in above[:-3:-1]:
        words = [cells[i] for i in numeric if i < len(cells)]
        is_full = len(cells) >= max(width - 1, min(width, 2)) and any(
            word and not is_value(word) for word in words
        )
        is_pair = sum(map(bool, cells)) == 2
        is_setting = is_pair and (
            _SETTING.match(cells[0]) or (len(cells[1]) > 2 and is_value(cells[1]))
        )
        is_units = (
            words and all(map(UNIT_WORD.fullmatch, words)) and (width > 1 or cells[0][0] in "([")
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
        words = re.split(r"\s*[:=]\s*", filled[0]) if len(filled) == 1 else cells
        for key, text in itertools.pairwise(words):
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
