"""Checks of a page: the verdict, what comes closest to its limit, and every check with its value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.cad.verification.check import list_causes
from fingertip.cad.verification.strength import WANTED_AT_GRIP, WANTED_AT_SHOCK
from fingertip.page.html import Markup, code, element, join, table

Check = Mapping[str, Any]

_SIGNS = {"at most": "≤", "at least": "≥", "exactly": "="}
_CLOSEST = 8
"""Number of checks that are listed as the closest to their limits."""
EVERY_FILE = "Every file was read back and measured. A check that fails names the parameters to change."
"""Sentences on the checks of a build."""


def render_verdict(report: Mapping[str, Any], passed: str = "of the parts passed") -> Markup:
    """Render in one line whether the parts passed their checks; `passed` ends the sentence if they did."""
    checks = report["checks"]
    failed = [check for check in checks if not check["passed"]]
    warned = _find_warnings(checks)
    if failed:
        text, kind = f"✗ {len(failed)} of {len(checks)} checks failed: do not print these parts", "failed"
    elif warned:
        text, kind = f"⚠ {len(checks) - len(warned)} of {len(checks)} checks {passed}, {len(warned)} warn", "warned"
    else:
        text, kind = f"✓ All {len(checks)} checks {passed}", "passed"
    return element("p", text, class_=f"verdict {kind}")


def render_checks(report: Mapping[str, Any], basis: str = EVERY_FILE) -> Markup:
    """Render all checks: failed ones first, then the closest to their limits, then all by their subject."""
    checks: Sequence[Check] = report["checks"]
    failed = [check for check in checks if not check["passed"]]
    parts = [
        element("p", basis),
        *([element("h3", "Failed"), _tabulate(failed, "failed checks")] if failed else []),
    ]
    warned = _find_warnings(checks)
    if warned:
        parts += [element("h3", "Warnings"), _tabulate(warned, "checks that warn")]
        parts += [element("p", code(check["name"]), f": {check['warning']}", class_="note") for check in warned]
    elif "strength" in report:
        parts.append(_warn_of_strength(report["strength"]))
    if closest := _find_closest(checks):
        parts += [element("h3", "Closest to their limits"), _tabulate(closest, "checks closest to their limits")]
    groups: dict[str, list[Check]] = {}
    for check in checks:
        groups.setdefault(check["name"].split(".")[0], []).append(check)
    parts.append(element("h3", "All checks"))
    for subject, group in groups.items():
        passed = sum(check["passed"] for check in group)
        warnings = len(_find_warnings(group))
        summary = f"{subject.replace('_', ' ')}: {passed - warnings} of {len(group)} passed"
        summary += f", {warnings} warn" if warnings else ""
        parts.append(element("details", element("summary", summary), _tabulate(group, f"checks of {subject}")))
    return join(parts)


def _warn_of_strength(strength: Mapping[str, Any]) -> Markup:
    """Warn of a bone that passes the limits but is weaker than wanted."""
    grip, shock = strength["grip_safety_factor"], strength["shock_safety_factor"]
    if grip >= WANTED_AT_GRIP and shock >= WANTED_AT_SHOCK:
        return Markup("")
    text = (
        f"The bone is weaker than wanted: its safety factor is {grip:.2f} at the grip force and {shock:.2f} at the "
        f"shock, where {WANTED_AT_GRIP:g} and {WANTED_AT_SHOCK:g} are wanted. It breaks first at the "
        f"{strength['weakest']['place']} at z = {strength['weakest']['z_mm']:.1f} mm."
    )
    return element("p", text, class_="note")


def _find_closest(checks: Sequence[Check]) -> list[Check]:
    """Find the passed checks with the least margin, relative to their limits. Counts and exact values have none."""
    margins = [
        (abs(check["value"] - check["limit"]) / abs(check["limit"]), check)
        for check in checks
        if check["passed"] and check["relation"] != "exactly" and check["limit"] and check["value"] != check["limit"]
        and list_causes(check["name"])
    ]  # fmt: skip
    return [check for _, check in sorted(margins, key=lambda pair: pair[0])[:_CLOSEST]]


def _tabulate(checks: Sequence[Check], caption: str) -> Markup:
    rows = [
        (
            element("span", code(check["name"]), class_="code"),
            element("span", _with_unit(check["value"], check["unit"]), class_="num"),
            element("span", f"{_SIGNS[check['relation']]} {_with_unit(check['limit'], check['unit'])}", class_="num"),
            _say(check),
            join(_list_parameters(check["name"])),
        )
        for check in checks
    ]
    return table(("check", "value", "must be", "passed", "set by"), rows, caption, "broad")


def _find_warnings(checks: Sequence[Check]) -> list[Check]:
    """Find the checks that passed but warn."""
    return [check for check in checks if check["passed"] and check.get("warning")]


def _say(check: Check) -> Markup:
    if not check["passed"]:
        return element("span", "✗ FAILED", class_="failed")
    if check.get("warning"):
        return element("span", "⚠ warns", class_="warned")
    return element("span", "✓", class_="passed", title="passed")


def _list_parameters(name: str) -> list[str]:
    """List the parameters that set a value, as links; a fault of the program has none."""
    found: list[str] = []
    for path in list_causes(name):
        found += [", "] if found else []
        found.append(element("a", code(path), href=f"#p-{path}", class_="code"))
    return found


def _with_unit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".rstrip()
