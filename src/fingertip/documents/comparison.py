"""Comparison of two versions of a finger, from what `make` and `build` reported of them.

It computes no figure.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.casting.shopping import add_prices
from fingertip.design import Design
from fingertip.design.design_file import flatten, format_value
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_unit
from fingertip.documents.template import render_page
from fingertip.foundation.errors import join_words

_NOTHING = "-"
"""Word for a figure that a report does not state."""
_FORMATS = ("stl", "3mf", "step")
_HASH = re.compile("[0-9a-f]{64}")
_LARGEST = 1e300
"""Largest whole number of a report that is read as a number."""
_TILT_DEG = 2.0
"""Tilt of the finger at which the share of the force is stated [deg]."""


@dataclass(frozen=True)
class Version:
    """One of two versions of a finger."""

    label: str
    design: Design
    report: Mapping[str, Any]
    """Content of report.json."""
    detection: Mapping[str, Any]
    """Content of signal/detection.json; empty if only parts were built."""


@dataclass(frozen=True)
class Change:
    """Figure or parameter before and after, as texts with the unit."""

    name: str
    before: str
    after: str

    @property
    def is_none(self) -> bool:
        """Return whether both are the same, or one is not known."""
        return self.before == self.after or _NOTHING in (self.before, self.after)


@dataclass(frozen=True)
class Comparison:
    """Differences between two versions of a finger."""

    before: str
    after: str
    parameters: tuple[Change, ...]
    figures: tuple[Change, ...]
    """Mass, time, price, share, delay and strength: changed or not."""
    parts: tuple[Change, ...]
    """Volumes of the parts that changed, came or went."""
    gained: tuple[str, ...]
    """Checks that only the new version has."""
    lost: tuple[str, ...]
    """Checks that only the old version has."""
    mended: tuple[str, ...]
    """Checks that failed before and pass now."""
    broken: tuple[str, ...]
    """Checks that passed before and fail now."""

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as plain data."""
        return {
            "before": self.before,
            "after": self.after,
            "parameters": [vars(change) for change in self.parameters],
            "figures": [vars(change) for change in self.figures],
            "parts": [vars(change) for change in self.parts],
            "checks_gained": [*self.gained],
            "checks_lost": [*self.lost],
            "checks_mended": [*self.mended],
            "checks_broken": [*self.broken],
        }

    @property
    def summary(self) -> str:
        """Say in one line how much changed."""
        changed = sum(not figure.is_none for figure in self.figures)
        checks = len(self.gained) + len(self.lost) + len(self.mended) + len(self.broken)
        counts = {
            "parameter": len(self.parameters),
            "figure": changed,
            "part": len(self.parts),
            "check": checks,
        }
        listed = [
            f"{count} {noun}{'' if count == 1 else 's'}" for noun, count in counts.items() if count
        ]

        return f"{join_words(listed)} changed" if listed else "nothing changed"


def compare_versions(old: Version, new: Version) -> Comparison:
    """Compare two versions of a finger."""
    formats = _list_formats(old.report) & _list_formats(new.report)
    before = _read_checks(old.report, formats)
    after = _read_checks(new.report, formats)
    both = before.keys() & after.keys()

    return Comparison(
        before=old.label,
        after=new.label,
        parameters=tuple(_compare_parameters(old.design, new.design)),
        figures=tuple(Change(name, read(old), read(new)) for name, read in _FIGURES.items()),
        parts=tuple(_compare_parts(old.report, new.report)),
        gained=tuple(sorted(after.keys() - before.keys())),
        lost=tuple(sorted(before.keys() - after.keys())),
        mended=tuple(sorted(name for name in both if after[name] and not before[name])),
        broken=tuple(sorted(name for name in both if before[name] and not after[name])),
    )


def render_comparison(comparison: Comparison, picture: str = "") -> str:
    """Render a comparison as Markdown; `picture` is the name of
    the file that shows both, beside it.
    """
    return render_page("comparison.md", comparison=comparison, picture=picture)


def _compare_parameters(old: Design, new: Design) -> Iterator[Change]:
    """Compare the values of all parameters; of an adapter's
    file, a hash of its content stands for it.
    """
    before = dict(flatten(old.identity()))
    after = dict(flatten(new.identity()))

    for name, value in after.items():
        if before.get(name) != value:
            unit = find_unit(PARAMETERS[name])
            yield Change(
                name, _format_parameter(before.get(name), unit), _format_parameter(value, unit)
            )


def _format_parameter(value: Any, unit: str) -> str:
    if isinstance(value, str) and _HASH.fullmatch(value):
        return f"content {value[:8]}"

    text = f"{value:.6g}" if isinstance(value, float) else format_value(value)
    return f"{text} {unit}".rstrip()


def _compare_parts(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[Change]:
    """Compare the volumes of the parts, and name a part whose mesh is another one of the same
    volume.

    Volumes of meshes of different tolerances differ without any change of the part: they are not
    compared.
    """
    is_comparable = _find(old, "tolerance_mm", kind=float) == _find(new, "tolerance_mm", kind=float)
    before = _find(old, "parts", kind=dict) or {}
    after = _find(new, "parts", kind=dict) or {}

    for name in dict.fromkeys([*before, *after]):
        volumes = [
            _format(_find(parts, name, "volume_mm3", kind=float), "mm3")
            for parts in (before, after)
        ]
        meshes = [_find(parts, name, "sha256", "stl", kind=str) for parts in (before, after)]
        if (
            volumes[0] == volumes[1]
            and is_comparable
            and None not in meshes
            and meshes[0] != meshes[1]
        ):
            volumes[1] += ", another shape"

        is_on_both_sides = name in before and name in after
        if volumes[0] != volumes[1] and (is_comparable or not is_on_both_sides):
            yield Change(name, *volumes)


def _read_checks(report: Mapping[str, Any], formats: Collection[str]) -> dict[str, bool]:
    """Read whether each check of a report passed, by its name; those of other formats are
    left out.
    """
    left_out = [f".{name}." for name in _FORMATS if name not in formats]
    checks = _find(report, "checks", kind=list) or []
    return {
        name: _find(check, "passed", kind=bool) is True
        for check in checks
        if (name := _find(check, "name", kind=str)) and not _is_of(name, left_out)
    }


def _is_of(check: str, formats: Iterable[str]) -> bool:
    """Return whether a check reads a file of some formats; plates are 3MF files."""
    name = f".3mf.{check}" if check.startswith("plate.") else check
    return any(each in name for each in formats)


def _list_formats(report: Mapping[str, Any]) -> set[str]:
    """List the formats in which a report has every part."""
    parts = _find(report, "parts", kind=dict) or {}
    of_parts = [set(_find(parts, name, "files", kind=dict) or {}) for name in parts]
    return set.intersection(*of_parts) if of_parts else set()


# Figures of a report
# -------------------


def _find(data: Any, *keys: str, kind: type) -> Any:
    """Find a value of a kind in nested tables; None where a report of another release has none."""
    for key in keys:
        if not isinstance(data, Mapping) or key not in data:
            return None

        data = data[key]

    if (
        kind is float
        and isinstance(data, int)
        and not isinstance(data, bool)
        and abs(data) < _LARGEST
    ):
        return float(data)

    return data if isinstance(data, kind) else None


def _format(value: float | None, unit: str, scale: float = 1.0) -> str:
    if value is None or not math.isfinite(value):
        return _NOTHING

    rounded = float(f"{scale * value:.4g}")
    return f"{rounded:g} {unit}".rstrip()


def _read_figure(unit: str, *keys: str) -> Callable[[Version], str]:
    """Return how a figure is read in a report, by its keys."""
    return lambda version: _format(_find(version.report, *keys, kind=float), unit)


def _read_pad(version: Version, key: str, unit: str, scale: float = 1.0) -> str:
    tilts = _find(version.report, "pad", "tilts", kind=list) or []
    values = [
        _find(tilt, key, kind=float)
        for tilt in tilts
        if _find(tilt, "tilt_deg", kind=float) == _TILT_DEG
    ]
    return _format(next(iter(values), None), unit, scale)


@dataclass(frozen=True)
class _Priced:
    """Statement of a shopping list about the price of a thing."""

    price_usd: str
    reason: str


def _read_price(version: Version) -> str:
    things = _find(version.report, "casting", "things", kind=list)
    if not things:
        return _NOTHING

    priced = [
        _Priced(_find(thing, "price_usd", kind=str) or "", _find(thing, "reason", kind=str) or "")
        for thing in things
    ]
    least, most, _ = add_prices(priced)
    return f"{least} to {most} US dollars"


def _read_delay(version: Version) -> str:
    delays_s = _find(version.detection, "delays_s", kind=list)
    if not delays_s:
        return _NOTHING if delays_s is None else "not detected"

    return _format(_find({"delay": delays_s[0]}, "delay", kind=float), "ms", 1e3)


_FIGURES: Mapping[str, Callable[[Version], str]] = {
    "printed material": _read_figure("g", "casting", "printed_g"),
    "printing": _read_figure("h", "casting", "print_h"),
    "silicone to mix": _read_figure("g", "casting", "batch", "total_g"),
    "to order": _read_price,
    "days of work": _read_figure("", "casting", "days"),
    "breaks at": _read_figure("N", "strength", "loads", "breaks_n"),
    "share of a force at the sensor": lambda version: _read_pad(version, "share", "%", 100.0),
    "force at which it turns on": lambda version: _read_pad(version, "turn_on_n", "N"),
    "delay of slip detection, one simulated trial": _read_delay,
}
"""Figure that a comparison always states -> how a report states it."""
