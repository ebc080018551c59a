"""Seconds of the tests, from the JUnit file that pytest writes with `--junit-xml=FILE`."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from tools.grain import GrainError

REMEDY = "write one with: .venv/bin/pytest --junit-xml=out/tests.xml"


def read_seconds(path: Path) -> float:
    """Add up the times of all tests in a JUnit file, those of their fixtures included [s]."""
    try:
        cases = list(ElementTree.parse(path).iter("testcase"))
    except OSError as error:
        raise GrainError(f"{path} cannot be read, {error.strerror}; {REMEDY}") from error
    except ElementTree.ParseError as error:
        raise GrainError(f"{path} is no JUnit file, {error}; {REMEDY}") from error

    if not cases:
        raise GrainError(f"{path} holds no test; {REMEDY}")
    return sum(float(case.get("time", "0")) for case in cases)
