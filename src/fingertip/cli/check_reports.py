"""Results of `fingertip check`, and their reports for machines: JUnit, SARIF, GitHub."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from fingertip.foundation.errors import FingertipError, Issue, escape_control
from fingertip.foundation.files import encode_json
from fingertip.foundation.tables import read_toml

if TYPE_CHECKING:
    from fingertip.cad.verification.check import Check
    from fingertip.design import Design
    from fingertip.design.finger_set import FingerSet

_TABLE = re.compile(r"\s*\[+\s*([\w.-]+)\s*\]")
_KEY = re.compile(r"\s*([\w.-]+)\s*=")


@dataclass(frozen=True)
class Finding:
    """Refusal of a design, or failed check."""

    file: str
    line: int | None
    """Line that states the field; None if the file does not."""
    field: str
    message: str
    value: Any = None

    @classmethod
    def make(cls, path: Path, issue: Issue, field: str = "") -> Finding:
        """Make a finding of an issue, whose place is that of a field, by default its own."""
        field = field or issue.field
        line, value = _find_place(path, field)
        # An issue of a file that is no TOML states its line itself.
        match = re.match(r"line (\d+)\b", issue.message)
        if line is None and match:
            line = int(match[1])

        return cls(
            file=escape_control(path.as_posix()),
            line=line,
            field=issue.field,
            message=issue.message,
            value=value,
        )

    def to_annotation(self) -> str:
        """Write a command of GitHub's workflows, which marks the line."""
        line = f",line={self.line}" if self.line else ""
        place = f"file={_escape_property(self.file)}{line},title={_escape_property(self.field)}"
        return f"::error {place}::{_percent_encode(self.message, '%')}"


@dataclass(frozen=True)
class NamedDesign:
    """Design or set, with the file or bundled name by which it was given."""

    file: Path
    design: Design | FingerSet


@dataclass(frozen=True)
class CheckResult:
    """Result for one design, folder or mesh: as data, as text, and for the reports of CI."""

    label: str
    data: Mapping[str, Any]
    text: str
    cases: tuple[Check | Issue, ...] = ()
    """Cases of a JUnit report: checks, or issues as errors."""
    findings: tuple[Finding, ...] = ()
    """Failed checks and differences, with their place."""

    @property
    def passed(self) -> bool:
        """Return whether nothing was wrong."""
        return bool(self.data["passed"])


def _escape_property(text: str) -> str:
    """Escape a property of a workflow command, which a colon or a comma would end."""
    return _percent_encode(text, "%:,")


def _percent_encode(text: str, reserved: str) -> str:
    """Encode reserved and control characters; GitHub decodes those that it reserves."""
    return "".join(
        f"%{ord(character):02X}" if character in reserved or character < " " else character
        for character in text
    )


def _find_place(path: Path, field: str) -> tuple[int | None, Any]:
    """Find the line of a TOML file that states a parameter, and its value as it stands there."""
    try:
        value: Any = read_toml(path)
        text = path.read_text(encoding="utf-8")
    except (OSError, FingertipError):
        return None, None

    for key in field.split("."):
        value = value.get(key) if isinstance(value, dict) else None

    table = ""
    for number, line in enumerate(text.splitlines(), 1):
        heading = _TABLE.match(line)
        if heading:
            table = f"{heading[1]}."
            continue

        key_match = _KEY.match(line)
        if key_match and table + key_match[1] == field:
            return number, value if isinstance(value, str | int | float | bool) else None

    return None, None


def to_sarif(findings: Iterable[Finding]) -> bytes:
    """Write findings in SARIF 2.1.0, which code scanning of GitHub and editors read."""
    results = []
    for finding in findings:
        place: dict[str, Any] = {"artifactLocation": {"uri": quote(finding.file, safe="/:")}}
        if finding.line:
            place["region"] = {"startLine": finding.line}

        message = {"text": f"{finding.field}: {finding.message}"}
        locations = [{"physicalLocation": place}]
        results.append(
            {
                "ruleId": finding.field,
                "level": "error",
                "message": message,
                "locations": locations,
            }
        )

    run = {"tool": {"driver": {"name": "fingertip"}}, "results": results}
    schema = "https://json.schemastore.org/sarif-2.1.0.json"
    return encode_json({"$schema": schema, "version": "2.1.0", "runs": [run]})


_INVALID_IN_XML = re.compile(r"[^\t\n\r\x20-\uD7FF\uE000-\uFFFD\U00010000-\U0010FFFF]")


def to_junit(
    suites: Mapping[str, Iterable[Check | Issue]],
    refused: Mapping[str, Iterable[Issue]] | None = None,
) -> bytes:
    """Write a JUnit XML report, in the dialect that Jenkins, GitLab and GitHub readers share.

    Each design, given by its name, is a test suite and each check a test case; of one that is
    refused, each issue is a case with an error. No times, dates or host names: the same designs
    give the same bytes.
    """
    root = Element("testsuites", name="fingertip check")
    for name, checks in suites.items():
        _suite(root, _clean(name), checks)

    for name, issues in (refused or {}).items():
        _suite(root, _clean(name), issues)

    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))

    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text + b"\n"


def message(check: Check) -> str:
    """Describe a check's value and limit, such as `value 3 edges, must be exactly 0`."""
    return (
        f"value {check.value:g} {check.unit}".rstrip()
        + f", must be {check.relation} {check.limit:g}"
    )


def _suite(root: Element, name: str, cases: Iterable[Check | Issue]) -> None:
    # Readers group test cases by the dots in the class name, so dots in the design's name are
    # replaced.
    suite = SubElement(root, "testsuite", name=name)
    counts = {
        "tests": 0,
        "failures": 0,
        "errors": 0,
        "skipped": 0,
    }
    for case in cases:
        is_refusal = isinstance(case, Issue)
        title = _clean(case.field if isinstance(case, Issue) else case.name)
        text = _clean(case.message if isinstance(case, Issue) else message(case))
        element = SubElement(
            suite,
            "testcase",
            classname="fingertip." + name.replace(".", "_"),
            name=title or "design",
        )
        counts["tests"] += 1

        if isinstance(case, Issue) or not case.passed:
            tag, kind = ("error", "refused") if is_refusal else ("failure", "check")
            counts[f"{tag}s"] += 1
            SubElement(element, tag, type=kind, message=text).text = f"{name}: {title}: {text}"

        if not is_refusal:
            SubElement(element, "system-out").text = text

    for count, number in counts.items():
        suite.set(count, str(number))


def _clean(text: str) -> str:
    """Replace characters that XML 1.0 cannot represent, not even escaped, by question marks."""
    return _INVALID_IN_XML.sub("?", text)
