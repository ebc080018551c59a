"""Report of `python -m benchmarks.slip`: table, JSON and the curve of delay against alarms."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.slip.bench import Found, list_factors, select
from benchmarks.slip.competitors import Row
from benchmarks.slip.curve import CurvePoint, Panel, at_rate, draw, make_point
from benchmarks.slip.scores import Tally

FILES = ("slip_curve.svg", "slip_bench.json", "slip_bench.txt")
RATES = (0.1, 1.0)
"""Rates of alarms at which delays are compared [1/min]."""


@dataclass(frozen=True, eq=False)
class Report:
    title: str
    found: Found
    rows: Sequence[Row]

    def own(self, row: Row) -> Tally:
        """What a detector reached at its own threshold."""
        return select(self.found, row).whole()

    def points(self, row: Row) -> list[CurvePoint]:
        whole = [
            (factor, select(self.found, row, factor).whole())
            for factor in list_factors(self.found, row)
        ]
        return [make_point(factor, tally, tally) for factor, tally in whole]

    def as_data(self) -> dict[str, Any]:
        """Convert it to plain mappings and lists for JSON. Keys contain their units."""
        return {"title": self.title, "rows": [self._row_data(row) for row in self.rows]}

    def _row_data(self, row: Row) -> dict[str, Any]:
        own = self.own(row)
        tallies = {f: select(self.found, row, f).whole() for f in list_factors(self.found, row)}
        rates = {rate: at_rate(self.points(row), rate, own.minutes) for rate in RATES}
        return {
            "detector": row.name,
            "rest_s": row.rest_s,
            "label": row.label,
            **own.as_data(),
            "alarms_by_kind": dict(own.alarms),
            "points": [{"factor": f, **tally.as_data()} for f, tally in tallies.items()],
            "at_rates": {
                f"{rate:g}_per_minute": None if one is None else tallies[one.factor].as_data()
                for rate, one in rates.items()
            },
        }

    def as_text(self) -> str:
        """Describe what each detector reaches, at its own threshold and at equal alarms."""
        first = self.own(self.rows[0])
        heads = [f"at most {rate:g}/min" for rate in RATES]
        cells = ["detector", "found", "delay, ms", "ON", "alarms/min", "95 %", *heads]
        lines = [
            f"{self.title}: {first.slips} slips, {first.minutes:.1f} min without slip.",
            "Delays from gross slip to ON, median / 90th percentile; a slip that was not found is "
            "infinitely late.",
            "",
            _join(cells),
            *(_join(self._cells(row)) for row in self.rows),
            "",
            *self._describe_alarms(),
        ]
        if first.minutes < 1 / min(RATES):
            rates = " or ".join(f"{rate:g}" for rate in RATES if first.minutes < 1 / rate)
            lines.append(f"{first.minutes:.1f} min are too short to show {rates} alarms a minute.")

        return "\n".join(lines)

    def _cells(self, row: Row) -> list[str]:
        own = self.own(row)
        points = self.points(row)
        kept = [at_rate(points, rate, own.minutes) for rate in RATES]
        low, high = own.alarm_interval
        return [
            row.label,
            f"{100 * own.found_share:.1f} %",
            delays(own.quantile_ms(0.5), own.quantile_ms(0.9)),
            f"{own.on_share:.3f}",
            f"{own.alarms_per_minute:.2f}" if own.minutes else "-",
            f"{low:.2g} to {high:.2g}" if own.minutes else "-",
            *("-" if one is None else delays(one.median_ms, one.p90_ms) for one in kept),
        ]

    def _describe_alarms(self) -> list[str]:
        """Describe the alarms at the own threshold, by what the recordings show."""
        kinds = sorted({kind for row in self.rows for kind in self.own(row).alarms})
        if not kinds:
            return []

        lines = ["Alarms at the own threshold, by what the recordings show:"]
        for kind in kinds:
            counts = (f"{row.label} {self.own(row).alarms[kind]}" for row in self.rows)
            lines.append(f"  {kind}: {', '.join(counts)}")

        return lines

    def draw(self) -> bytes:
        curves = {row: self.points(row) for row in self.rows}
        least = 0.5 / max(self.own(self.rows[0]).minutes, 0.05)
        return draw([Panel("median", 0.5, curves), Panel("late ones", 0.9, curves)], least)

    def encode(self) -> tuple[bytes, ...]:
        """Contents of the files, in the order of `FILES`."""
        data = json.dumps(self.as_data(), indent=2, allow_nan=False) + "\n"
        return self.draw(), data.encode(), f"{self.as_text()}\n".encode()


def delays(median_ms: float, p90_ms: float) -> str:
    return " / ".join(f"{d:.1f}" if math.isfinite(d) else "-" for d in (median_ms, p90_ms))


def _join(cells: Sequence[str]) -> str:
    return f"{cells[0]:30}" + "".join(f"{cell:>16}" for cell in cells[1:])
