"""Checks as JUnit XML, in the dialect that Jenkins, GitLab and GitHub's readers share.

One suite for each design, one test case for each check. No times, dates or host stand in it: the same designs give
the same bytes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fingertip.cad.verification.checks import Check

_NOT_XML = re.compile(r"[^\t\n\r\x20-\uD7FF\uE000-\uFFFD\U00010000-\U0010FFFF]")


def to_bytes(suites: Mapping[str, Iterable[Check]]) -> bytes:
    """A JUnit report of the checks of each design, by its name."""
    root = Element("testsuites", name="fingertip check")
    for name, checks in suites.items():
        _suite(root, _clean(name), tuple(checks))
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def message(check: Check) -> str:
    """What was found, against what: `value 3 edges, must be 0`."""
    must = f"{check.relation} {check.limit:g}"
    return f"value {check.value:g} {check.unit}".rstrip() + f", {must}"


def _suite(root: Element, name: str, checks: tuple[Check, ...]) -> None:
    failed = sum(not check.passed for check in checks)
    # Readers group by the class name's dots, so a design's own dots must not make a folder.
    classname = "fingertip." + name.replace(".", "_")
    suite = SubElement(root, "testsuite", name=name, tests=str(len(checks)), failures=str(failed), errors="0")
    suite.set("skipped", "0")
    for check in checks:
        case = SubElement(suite, "testcase", classname=classname, name=_clean(check.name))
        if not check.passed:
            failure = SubElement(case, "failure", type="check", message=message(check))
            failure.text = f"{name}: {check.name}: {message(check)}"
        SubElement(case, "system-out").text = message(check)


def _clean(text: str) -> str:
    """XML 1.0 has no way to write most control characters, not even escaped."""
    return _NOT_XML.sub("?", text)
