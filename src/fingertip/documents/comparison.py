"""Comparison of two versions of a finger, from what `make` and `build` reported of them. It computes no figure."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.casting.sheet import Thing, add_prices
from fingertip.design import Design
from fingertip.design.files import format_value
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_unit
from fingertip.documents.template import render_page
from fingertip.foundation.errors import join_words

_NOTHING = "-"
"""What stands for a figure that a report does not state."""
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
        """Return whether both are the same."""
        return self.before == self.after


@dataclass(frozen=True)
class Comparison:
    """What differs between two versions of a finger."""

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
        counts = {"parameter": len(self.parameters), "figure": changed, "part": len(self.parts), "check": checks}
        listed = [f"{count} {noun}{'' if count == 1 else 's'}" for noun, count in counts.items() if count]
        return f"{join_words(listed)} changed" if listed else "nothing changed"


def compare_versions(old: Version, new: Version) -> Comparison:
    """Compare two versions of a finger."""
    before = _read_checks(old.report)
    after = _read_checks(new.report)
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
    """Render a comparison as Markdown; `picture` is the name of the file that shows both, beside it."""
    return render_page("comparison.md", comparison=comparison, picture=picture)


def _compare_parameters(old: Design, new: Design) -> Iterator[Change]:
    for name, field in PARAMETERS.items():
        before, after = old.value(name), new.value(name)
        if before != after:
            unit = find_unit(field)
            yield Change(name, _format_parameter(before, unit), _format_parameter(after, unit))


def _format_parameter(value: Any, unit: str) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else format_value(value)
    return f"{text} {unit}".rstrip()


def _compare_parts(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[Change]:
    names = dict.fromkeys([*_find(old, "parts", default={}), *_find(new, "parts", default={})])
    for name in names:
        change = Change(name, *(_format(_find(report, "parts", name, "volume_mm3"), "mm3") for report in (old, new)))
        if not change.is_none:
            yield change


def _read_checks(report: Mapping[str, Any]) -> dict[str, bool]:
    """Read whether each check of a report passed, by its name."""
    checks = _find(report, "checks", default=[])
    return {str(_find(check, "name")): _find(check, "passed") is True for check in checks}


# --- figures of a report ----------------------------------------------------------------------------------------------


def _find(data: Any, *keys: str, default: Any = None) -> Any:
    """Find a value in nested tables; the default where a report of another release has none."""
    for key in keys:
        if not isinstance(data, Mapping) or key not in data:
            return default
        data = data[key]
    return data


def _format(value: Any, unit: str, scale: float = 1.0) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return _NOTHING
    rounded = float(f"{scale * value:.4g}")
    return f"{rounded:g} {unit}".rstrip()


def _read_pad(version: Version, key: str) -> Any:
    tilts = _find(version.report, "pad", "tilts", default=[])
    return next((_find(tilt, key) for tilt in tilts if _find(tilt, "tilt_deg") == _TILT_DEG), None)


def _read_price(version: Version) -> str:
    things = _find(version.report, "casting", "things", default=[])
    if not things:
        return _NOTHING
    least, most, _ = add_prices(Thing(**thing) for thing in things)
    return f"{least} to {most} US dollars"


def _read_delay(version: Version) -> str:
    delays_s = _find(version.detection, "delays_s", default=[])
    if not delays_s:
        return "not detected" if version.detection else _NOTHING
    return _format(delays_s[0], "ms", 1e3)


_FIGURES: Mapping[str, Callable[[Version], str]] = {
    "printed material": lambda version: _format(_find(version.report, "casting", "printed_g"), "g"),
    "printing": lambda version: _format(_find(version.report, "casting", "print_h"), "h"),
    "silicone to mix": lambda version: _format(_find(version.report, "casting", "batch", "total_g"), "g"),
    "to order": _read_price,
    "days of work": lambda version: _format(_find(version.report, "casting", "days"), ""),
    "breaks at": lambda version: _format(_find(version.report, "strength", "loads", "breaks_n"), "N"),
    "share of a force at the sensor": lambda version: _format(_read_pad(version, "share"), "%", 100.0),
    "force at which it turns on": lambda version: _format(_read_pad(version, "turn_on_n"), "N"),
    "delay of slip detection, one simulated trial": _read_delay,
}
"""Figure that a comparison always states -> how a report states it."""
