"""Checks as a JUnit XML report, in the dialect that Jenkins, GitLab and GitHub readers share.

Each design is a test suite and each check a test case. A warning stands in the output of its test case, which passed.
The report holds no times, dates or host names, so the same
designs give the same bytes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fingertip.cad.verification.check import Check

_INVALID_IN_XML = re.compile(r"[^\t\n\r\x20-\uD7FF\uE000-\uFFFD\U00010000-\U0010FFFF]")


def to_bytes(suites: Mapping[str, Iterable[Check]]) -> bytes:
    """Write the report for the checks of each design, given by the design's name."""
    root = Element("testsuites", name="fingertip check")
    for name, checks in suites.items():
        _suite(root, _clean(name), tuple(checks))
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def message(check: Check) -> str:
    """Describe a check's value and limit, such as `value 3 edges, must be exactly 0`."""
    return f"value {check.value:g} {check.unit}".rstrip() + f", must be {check.relation} {check.limit:g}"


def _suite(root: Element, name: str, checks: tuple[Check, ...]) -> None:
    failed = sum(not check.passed for check in checks)
    # Readers group test cases by the dots in the class name, so dots in the design's name are replaced.
    classname = "fingertip." + name.replace(".", "_")
    suite = SubElement(root, "testsuite", name=name, tests=str(len(checks)), failures=str(failed), errors="0")
    suite.set("skipped", "0")
    for check in checks:
        case = SubElement(suite, "testcase", classname=classname, name=_clean(check.name))
        if not check.passed:
            failure = SubElement(case, "failure", type="check", message=message(check))
            failure.text = f"{name}: {check.name}: {message(check)}"
        warning = f"; warning: {check.warning}" if check.state == "warning" else ""
        SubElement(case, "system-out").text = _clean(message(check) + warning)


def _clean(text: str) -> str:
    """Replace characters that XML 1.0 cannot represent, not even escaped, by question marks."""
    return _INVALID_IN_XML.sub("?", text)
