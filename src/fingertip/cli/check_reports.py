"""Reports of `fingertip check` for machines: findings with file and
line, JUnit, SARIF, and annotations of GitHub.
"""

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
        stated = re.match(r"line (\d+)\b", issue.message)  # of what is no TOML

        return cls(
            file=escape_control(path.as_posix()),
            line=line or (int(stated[1]) if stated else None),
            field=issue.field,
            message=issue.message,
            value=value,
        )

    def to_annotation(self) -> str:
        """Write a command of GitHub's workflows, which marks the line."""
        line = f",line={self.line}" if self.line else ""
        place = f"file={_escape_property(self.file)}{line},title={_escape_property(self.field)}"
        return f"::error {place}::{_percent_encode(self.message, '%')}"


def _escape_property(text: str) -> str:
    """Escape a property of a workflow command, which a colon or a comma would end."""
    return _percent_encode(text, "%:,")


def _percent_encode(text: str, reserved: str) -> str:
    """Encode reserved and control characters; GitHub decodes those
    that it reserves, and shows the others encoded.
    """
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
        elif (key_found := _KEY.match(line)) and table + key_found[1] == field:
            return number, value if isinstance(value, str | int | float | bool) else None

    return None, None


def to_sarif(findings: Iterable[Finding]) -> bytes:
    """Write findings in SARIF 2.1.0, which code scanning of GitHub and editors read."""
    results = []
    for found in findings:
        place: dict[str, Any] = {"artifactLocation": {"uri": quote(found.file, safe="/:")}}
        if found.line:
            place["region"] = {"startLine": found.line}

        message = {"text": f"{found.field}: {found.message}"}
        locations = [{"physicalLocation": place}]
        results.append(
            {
                "ruleId": found.field,
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
    for each in cases:
        is_refusal = isinstance(each, Issue)
        title, text = (
            (each.field, each.message) if isinstance(each, Issue) else (each.name, message(each))
        )
        title = _clean(title)
        text = _clean(text)
        case = SubElement(
            suite,
            "testcase",
            classname="fingertip." + name.replace(".", "_"),
            name=title or "design",
        )
        counts["tests"] += 1

        if isinstance(each, Issue) or not each.passed:
            tag, kind = ("error", "refused") if is_refusal else ("failure", "check")
            counts[f"{tag}s"] += 1
            SubElement(case, tag, type=kind, message=text).text = f"{name}: {title}: {text}"

        if not is_refusal:
            SubElement(case, "system-out").text = text

    for count, number in counts.items():
        suite.set(count, str(number))


def _clean(text: str) -> str:
    """Replace characters that XML 1.0 cannot represent, not even escaped, by question marks."""
    return _INVALID_IN_XML.sub("?", text)
