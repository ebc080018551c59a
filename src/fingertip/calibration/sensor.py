"""Force curve of a design's sensor, from a file of weighings of it, in which all faults are found
at once.

A CSV file names one column of loads, `weight_g` or `force_n`, and one of readings, `voltage_v` (the
tactile voltage), `counts` (of a converter) or `resistance_ohm` (of the sensor alone). Each line is
one weighing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.board.analysis.tactile_response import (
    MAX_PRELOAD_V,
    TactileResponse,
    find_tactile_response,
)
from fingertip.board.components.front_end import NEWTON_PER_GRAM
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.foundation.errors import (
    InputFileError,
    Issue,
    TraceError,
    join_words,
    quote_value,
    raise_issues,
)
from fingertip.foundation.input_files import RECORDING_LIMIT, read_input
from fingertip.foundation.numerics import CONFIDENCE, t_quantile
from fingertip.sim.signal.bridge import TURN_ON_WIDTH_N, fit_conductance_curve
from fingertip.slip.traces.cells import DELIMITERS, split_cells, unquote

LOADS = {"weight_g": NEWTON_PER_GRAM, "force_n": 1.0}
"""Columns of loads -> newtons per unit."""
READINGS = ("voltage_v", "counts", "resistance_ohm")
MIN_WEIGHINGS = 4
"""Least number of weighings with a load: two figures are fitted, two more show the scatter."""
MIN_LOADS = 3
"""Least number of different loads among them."""
MAX_BYTES = 2**20
"""Maximum size of a file of weighings [bytes]."""
_FULL_SCALES = frozenset(2.0**bits - 1 for bits in (8, 10, 12, 14, 16, 18, 20, 24))
"""Largest counts of converters."""
MAX_FORCE_N = 1000.0
"""Largest force that a sensor survives, with a wide margin [N]."""


@dataclass(frozen=True)
class Weighing:
    """Load on the sensor, and the reading under it."""

    force_n: float
    reading: float
    line: int


@dataclass(frozen=True)
class Weighings:
    """Weighings of one sensor, from one file."""

    source: str
    """Name of the file in messages."""
    kind: str
    """Column of the readings, from `READINGS`."""
    rows: tuple[Weighing, ...]
    """Weighings under load."""
    unloaded: tuple[Weighing, ...]
    """Readings without load, which show the offset of the board."""
    saturated: tuple[Weighing, ...] = ()
    """Weighings that are left out: their readings do not grow with the load."""


def read_weighings(path: str | Path) -> Weighings:
    """Read a file of weighings. Raises TraceError."""
    try:
        content = read_input(Path(path), RECORDING_LIMIT, "a file of weighings", MAX_BYTES + 1)
    except InputFileError as error:
        raise TraceError(error.issues) from None

    if len(content) > MAX_BYTES or b"\0" in content:
        message = (
            f"is not a text file of less than {MAX_BYTES // 2**20} MB; write weighings as CSV."
        )
        raise TraceError(Issue(str(path), message))

    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")

    return parse_weighings(text, str(path))


def parse_weighings(text: str, source: str) -> Weighings:
    """Parse the text of a file; `source` names it in messages. Raises TraceError."""
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise TraceError(
            Issue(
                source,
                "is empty; write a header such as weight_g,voltage_v, and a line per weighing.",
            )
        )

    number, first = lines[0]
    delimiter = max(DELIMITERS, key=first.count)
    header = [unquote(cell).lower() for cell in split_cells(first, delimiter)]
    field = f"{source}, line {number}"
    load_place = _find_column(header, tuple(LOADS), "loads", field)
    reading_place = _find_column(header, READINGS, "readings", field)
    newton_per_unit = LOADS[header[load_place]]
    kind = header[reading_place]
    rows = list[Weighing]()
    issues = list[Issue]()

    for number, line in lines[1:]:
        cells = split_cells(line, delimiter)
        try:
            load = _parse_number(cells[load_place], delimiter)
            reading = _parse_number(cells[reading_place], delimiter)
        except (ValueError, IndexError):
            problem = f"{quote_value(line.strip())} is not a weighing; write two numbers."
            issues.append(Issue(f"{source}, line {number}", problem))
            continue

        rows.append(Weighing(load * newton_per_unit, reading, number))

    for row in rows:
        issues += _find_row_issues(row, kind, f"{source}, line {row.line}")

    loaded = tuple(row for row in rows if row.force_n > 0.0)
    unloaded = tuple(row for row in rows if not row.force_n > 0.0)
    saturated = () if issues else _find_saturated(kind, loaded)
    loaded = tuple(row for row in loaded if row not in saturated)
    loads = len({row.force_n for row in loaded})

    if not issues and (len(loaded) < MIN_WEIGHINGS or loads < MIN_LOADS):
        message = (
            f"holds {len(loaded)} weighings under {loads} different loads; at least "
            f"{MIN_WEIGHINGS} under {MIN_LOADS} "
            "are needed for a curve and its interval."
        )
        if saturated:
            message = (
                f"{_describe_saturated(kind, saturated)}; without them it {message[:-1]} "
                "(weigh smaller loads)."
            )

        issues.append(Issue(source, message))

    raise_issues(TraceError, issues)
    return Weighings(
        source=source,
        kind=kind,
        rows=loaded,
        unloaded=unloaded,
        saturated=saturated,
    )


def _find_column(header: Sequence[str], names: Sequence[str], noun: str, field: str) -> int:
    """Find the place of the one column that has one of some names. Raises TraceError."""
    named = [name for name in names if name in header]
    if len(named) != 1:
        problem = f"names {' and '.join(named)}" if named else f"names no column of {noun}"
        remedy = f"give one of {', '.join(names)}, with values in that unit"
        raise TraceError(Issue(field, f"{problem}; {remedy}."))

    return header.index(named[0])


def _parse_number(cell: str, delimiter: str) -> float:
    """Parse a number; it may have a decimal comma unless commas separate the cells."""
    text = unquote(cell)
    return float(text if delimiter == "," else text.replace(",", "."))


def _find_row_issues(row: Weighing, kind: str, field: str) -> Iterator[Issue]:
    if not 0.0 <= row.force_n <= MAX_FORCE_N:
        yield Issue(field, f"{row.force_n:g} N is not a load; give 0 to {MAX_FORCE_N:g} N.")

    if not math.isfinite(row.reading):
        yield Issue(field, f"{row.reading} is not a reading; weigh again, or delete the line.")
    elif kind == "resistance_ohm" and row.reading <= 0.0:
        yield Issue(field, f"{row.reading:g} ohm is not a resistance; give a value above 0.")


_FLAT_SHARE = 0.002
_FLAT_LOADS = 1.2
"""Largest difference between readings at a limit, as a share of the span of all, and least ratio of
their loads.
"""


def _find_saturated(kind: str, loaded: Sequence[Weighing]) -> tuple[Weighing, ...]:
    """Find weighings at the end of a converter, or at the limit that the readings of the largest
    loads do not leave.
    """
    if kind == "resistance_ohm" or not loaded:
        return ()

    last = max(loaded, key=lambda row: row.force_n)
    readings = [row.reading for row in loaded]
    near = _FLAT_SHARE * (max(readings) - min(readings))
    flat = tuple(row for row in loaded if abs(row.reading - last.reading) <= near)
    is_end = kind == "counts" and last.reading in _FULL_SCALES

    return flat if is_end or last.force_n >= _FLAT_LOADS * min(row.force_n for row in flat) else ()


def _describe_saturated(kind: str, rows: Sequence[Weighing]) -> str:
    limit = (
        "the end of a converter"
        if rows[0].reading in _FULL_SCALES
        else "a limit that larger loads do not move"
    )
    unit = "V" if kind == "voltage_v" else kind
    lines = join_words([str(row.line) for row in rows])
    plural = "s" * (len(rows) > 1)

    return (
        f"line{plural} {lines} at {rows[0].reading:.6g} {unit} reached {limit}, where the load "
        "does not show"
    )


# Power law fitted to weighings, with the interval of a force that is read off it. The conductance G
# under a force F above the turn-on force F0 is
#
#   ln G = intercept + exponent * ln(F - F0) + error
#
# The relative scatter of force-sensing resistors is about the same at all forces, so the logarithms
# have errors of one variance: ordinary least squares. The interval of a force inverts the
# prediction interval of a single reading (inverse regression; N. R. Draper and H. Smith, Applied
# Regression Analysis, 3rd ed., section 3.2). It is exact for normal errors of the logarithm.


@dataclass(frozen=True)
class PowerLaw:
    turn_on_n: float
    """Force at which the sensor begins to conduct [N], which is not fitted."""
    exponent: float
    conductance_s: float
    """Conductance 1 N above the turn-on [S]."""
    scatter: float
    """Relative standard deviation of a conductance about the curve."""
    count: int
    mean_log_force: float
    """Mean of ln(F - F0)."""
    squares: float
    """Sum of squared deviations of ln(F - F0) from their mean."""

    @property
    def coverage_factor(self) -> float:
        """Student's t of the fit's degrees of freedom."""
        return t_quantile(CONFIDENCE, self.count - 2)

    @property
    def exponent_uncertainty(self) -> float:
        return self.scatter / math.sqrt(self.squares)

    def interval_n(self, conductance_s: float) -> tuple[float, float]:
        """Interval that holds the true force [N] for one reading of a conductance [S] with 95 %
        probability.

        The upper end is infinite if the weighings do not even show that the conductance grows.
        """
        b = self.exponent
        reach = self.coverage_factor * self.scatter
        centre = math.log(conductance_s / self.conductance_s) / b - self.mean_log_force
        # (b (centre - d))^2 = reach^2 (1 + 1/n + d^2 / squares), solved for d = ln(F - F0) - mean
        lead = b * b - reach * reach / self.squares
        if lead <= 0.0:
            return self.turn_on_n, math.inf

        root = reach * math.sqrt(
            lead * (1.0 + 1.0 / self.count) + b * b * centre * centre / self.squares
        )
        low, high = (
            (b * b * centre + sign * root) / lead + self.mean_log_force for sign in (-1.0, 1.0)
        )
        return self.turn_on_n + math.exp(low), self.turn_on_n + math.exp(high)


def fit_power_law(
    forces_n: Sequence[float], conductances_s: Sequence[float], turn_on_n: float
) -> PowerLaw:
    """Fit a power law to three weighings or more, under at least two forces, all above the turn-on
    force.
    """
    x = [math.log(force - turn_on_n) for force in forces_n]
    y = [math.log(conductance) for conductance in conductances_s]
    count = len(x)
    x_mean = math.fsum(x) / count
    y_mean = math.fsum(y) / count
    squares = math.fsum((xi - x_mean) ** 2 for xi in x)
    exponent = (
        math.fsum((xi - x_mean) * (yi - y_mean) for xi, yi in zip(x, y, strict=True)) / squares
    )
    residuals = (yi - y_mean - exponent * (xi - x_mean) for xi, yi in zip(x, y, strict=True))
    scatter = math.sqrt(math.fsum(r * r for r in residuals) / (count - 2))

    return PowerLaw(
        turn_on_n=turn_on_n,
        exponent=exponent,
        conductance_s=math.exp(y_mean - exponent * x_mean),
        scatter=scatter,
        count=count,
        mean_log_force=x_mean,
        squares=squares,
    )


_DIGITS = 6
"""Significant digits of the figures that are written into a design."""


@dataclass(frozen=True)
class CurvePoint:
    """Point of the calibrated curve under one of the weights."""

    force_n: float
    conductance_s: float
    voltage_v: float
    """Tactile voltage of the design's board."""
    low_n: float
    high_n: float
    """Ends of the 95 % interval of a force that is read off one voltage."""


@dataclass(frozen=True)
class SensorCalibration:
    law: PowerLaw
    points: tuple[CurvePoint, ...]
    """Curve under each weight of the file, in the order of the weights."""
    offset_v: float
    """Voltage that the board showed without load, less the design's [V].
    It is 0 without such readings.
    """
    preload: str | None
    """Sentence about an offset that a skin makes; None without one."""
    ratio_to_typical: float
    """Conductance under the middle weight over that of the typical sensor."""

    @property
    def interval_factor(self) -> float:
        """Factor within which a force read off the curve lies with 95 % probability, at its worst
        weight.
        """
        return max(
            max(point.high_n / point.force_n, point.force_n / point.low_n) for point in self.points
        )

    @property
    def changes(self) -> dict[str, Any]:
        """Parameter -> calibrated value."""
        return {
            "force_curve.curve": "calibrated",
            "force_curve.turn_on_n": self.law.turn_on_n,
            "force_curve.conductance_us": _round(1e6 * self.law.conductance_s),
            "force_curve.exponent": _round(self.law.exponent),
            "force_curve.min_force_n": _round(self.points[0].force_n),
            "force_curve.max_force_n": _round(self.points[-1].force_n),
            "force_curve.interval_factor": _round(self.interval_factor),
        }


def calibrate_sensor(
    design: Design, weighings: Weighings, scale: float | None = None
) -> SensorCalibration:
    """Fit the force curve of a sensor to its weighings.

    `scale` is that of counts [V]. Raises TraceError.
    """
    _check_scale(design, weighings, scale)
    response = find_tactile_response(design)
    offset_v = _find_offset(weighings, response, scale or 1.0)
    turn_on = design.force_curve.turn_on_n
    issues = list[Issue]()
    forces = list[float]()
    conductances = list[float]()

    for row in weighings.rows:
        field = f"{weighings.source}, line {row.line}"
        issues += _find_turn_on_issues(row, turn_on, field)
        conductance = _find_conductance(
            row,
            kind=weighings.kind,
            response=response,
            scale=scale or 1.0,
            offset_v=offset_v,
        )
        if isinstance(conductance, str):
            issues.append(Issue(field, conductance))
        else:
            forces.append(row.force_n)
            conductances.append(conductance)

    raise_issues(TraceError, issues)
    law = fit_power_law(forces, conductances, turn_on)
    if law.exponent < (find_bounds(PARAMETERS["force_curve.exponent"]).minimum or 0.0):
        message = (
            "the readings do not grow with the load; check the order of the columns, and "
            "the wiring."
        )
        raise TraceError(Issue(weighings.source, message))

    points = [_find_point(law, response, force_n) for force_n in sorted(set(forces))]
    middle = points[len(points) // 2]
    preload = response.describe_preload(response.open_v + offset_v)
    typical_s = fit_conductance_curve().conductance_s(middle.force_n)
    calibration = SensorCalibration(
        law=law,
        points=tuple(points),
        offset_v=offset_v,
        preload=preload,
        ratio_to_typical=middle.conductance_s / typical_s,
    )

    most = find_bounds(PARAMETERS["force_curve.interval_factor"]).maximum or math.inf
    if not calibration.interval_factor <= most:
        message = (
            "the readings scatter so much that they tell no force; weigh more often, or "
            "over more loads."
        )
        raise TraceError(Issue(weighings.source, message))

    return calibration


def _check_scale(design: Design, weighings: Weighings, scale: float | None) -> None:
    """Refuse a scale that readings do not need, and one that is missing or no number.

    Raises TraceError.
    """
    if weighings.kind == "counts" and scale is None:
        step = design.detector.adc_step_v
        message = (
            f"is missing: the readings are counts; give volts per count ({step:.8g} for the "
            "design's converter)."
        )
        raise TraceError(Issue("--scale", message))

    if weighings.kind != "counts" and scale is not None:
        raise TraceError(Issue("--scale", f"does not apply to {weighings.kind}; leave it out."))

    if scale is not None and not (math.isfinite(scale) and scale != 0.0):
        raise TraceError(Issue("--scale", f"{scale:g} is not a scale; give volts per count."))


def _find_turn_on_issues(row: Weighing, turn_on_n: float, field: str) -> Iterator[Issue]:
    """Report a load with which the sensor may not be on yet."""
    least_n = turn_on_n + TURN_ON_WIDTH_N
    if row.force_n < least_n:
        problem = f"{row.force_n:.3g} N is below {least_n:g} N, where the sensor turns on"
        yield Issue(field, f"{problem}; delete the line, or set force_curve.turn_on_n.")


def _find_point(law: PowerLaw, response: TactileResponse, force_n: float) -> CurvePoint:
    """Find conductance, voltage and interval of the fitted curve at a force."""
    conductance_s = law.conductance_s * math.pow(force_n - law.turn_on_n, law.exponent)
    low_n, high_n = law.interval_n(conductance_s)
    return CurvePoint(
        force_n=force_n,
        conductance_s=conductance_s,
        voltage_v=response.tactile_v(conductance_s),
        low_n=low_n,
        high_n=high_n,
    )


def list_warnings(weighings: Weighings, calibration: SensorCalibration | None = None) -> list[str]:
    """List what makes a calibration less certain than its interval says."""
    kind = weighings.kind
    saturated = weighings.saturated
    warnings = (
        [f"{weighings.source}: {_describe_saturated(kind, saturated)}: left out"]
        if saturated
        else []
    )

    if calibration and calibration.preload:
        warnings.append(
            f"{calibration.preload} Taken off as an offset, that bends the curve: weigh again."
        )
    if weighings.unloaded or weighings.kind == "resistance_ohm":
        return warnings

    return [
        *warnings,
        f"{weighings.source} holds no reading without load, so the offset of the board counts as "
        "0; add a line with "
        f"load 0 and the {weighings.kind} of the untouched finger.",
    ]


def _find_offset(weighings: Weighings, response: TactileResponse, scale: float) -> float:
    """Find the voltage without load, less that of the design [V]."""
    if not weighings.unloaded or weighings.kind == "resistance_ohm":
        return 0.0

    mean = scale * math.fsum(row.reading for row in weighings.unloaded) / len(weighings.unloaded)
    offset = mean - response.open_v
    if abs(offset) > MAX_PRELOAD_V:
        message = (
            f"{mean:.3g} V without load is more than {MAX_PRELOAD_V:g} V off the "
            f"{response.open_v:.3g} V of the "
            "design's board; give the design of the board that took the readings, or check "
            "--scale and wiring."
        )
        raise TraceError(Issue(f"{weighings.source}, line {weighings.unloaded[0].line}", message))

    return offset


def _find_conductance(
    row: Weighing,
    kind: str,
    response: TactileResponse,
    scale: float,
    offset_v: float,
) -> float | str:
    """Return the sensor's conductance [S], or why the board cannot give such a reading."""
    if kind == "resistance_ohm":
        return 1.0 / row.reading

    volts = scale * row.reading - offset_v
    current_a = (response.open_v - volts) / response.transfer_ohm
    remaining_v = response.sensor_v - response.source_ohm * current_a
    if current_a > 0.0 and remaining_v > 0.0:
        return current_a / remaining_v

    shorted_v = response.open_v - response.transfer_ohm * response.sensor_v / response.source_ohm
    return (
        f"{volts:.4g} V is not between {shorted_v:.3g} and {response.open_v:.3g} V, the design's "
        "board with a shorted "
        "and with an open sensor; check design, unit and wiring."
    )


def _round(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
