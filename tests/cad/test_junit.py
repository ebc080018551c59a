"""The JUnit report as its readers interpret it."""

from __future__ import annotations

import io
from xml.etree import ElementTree

import pytest

from fingertip.cad.verification.check import Check
from fingertip.cli.check import to_bytes

PASSED = Check("bone.stl.genus", 2, 2, "through holes", "exactly")
FAILED = Check("overlap.bone.skin", 0.5, 1e-3, "mm3")
# (required, allowed) attributes of each element in the schema of Jenkins' xUnit plug-in (junit-10.xsd).
ALLOWED = {
    "testsuites": ({"name", "tests", "failures", "errors"}, {"name", "time", "tests", "failures", "errors"}),
    "testsuite": ({"name", "tests", "failures", "errors"}, {"name", "tests", "failures", "errors", "skipped", "time"}),
    "testcase": ({"name", "classname"}, {"name", "classname", "time"}),
    "failure": ({"message", "type"}, {"message", "type"}),
    "system-out": (set(), set()),
}


def test_counts_equal_the_number_of_cases() -> None:
    root = ElementTree.fromstring(to_bytes({"one": [PASSED, FAILED], "two": [PASSED]}))
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("3", "1", "0")
    assert [(s.get("name"), s.get("tests"), s.get("failures")) for s in root] == [("one", "2", "1"), ("two", "1", "0")]
    (failure,) = root.iter("failure")
    assert failure.get("message") == "value 0.5 mm3, must be at most 0.001"
    assert [case.get("name") for case in root.iter("testcase") if case.find("failure") is not None] == [FAILED.name]


def test_elements_and_attributes_conform_to_the_schema() -> None:
    root = ElementTree.fromstring(to_bytes({"one": [PASSED, FAILED]}))
    for element in root.iter():
        required, allowed = ALLOWED[element.tag]
        assert required <= set(element.attrib) <= allowed, element.tag


def test_junitparser_reads_it() -> None:
    junitparser = pytest.importorskip("junitparser")
    report = junitparser.JUnitXml.fromroot(ElementTree.parse(io.BytesIO(to_bytes({"one": [PASSED, FAILED]}))).getroot())
    (suite,) = report
    assert (suite.tests, suite.failures, suite.errors) == (2, 1, 0)
    assert [case.is_passed for case in suite] == [True, False]


def test_characters_invalid_in_xml_are_replaced() -> None:
    root = ElementTree.fromstring(to_bytes({'a<&"\x00\x1b.toml': [PASSED]}))
    assert root[0].get("name") == 'a<&"??.toml'
    (case,) = root.iter("testcase")
    assert case.get("classname", "").count(".") == 1, "readers group test cases by the dots in the class name"


def test_a_warning_stands_in_the_output_of_a_passed_case() -> None:
    warned = Check("bone.safety_factor.shock", 0.59, 0.5, "", "at least", "breaks at 60 N\x00")
    root = ElementTree.fromstring(to_bytes({"one": [PASSED, warned]}))
    assert root.get("failures") == "0"
    outputs = [case.findtext("system-out") for case in root.iter("testcase")]
    assert outputs[1] == "value 0.59, must be at least 0.5; warning: breaks at 60 N?"
    assert "warning" not in (outputs[0] or "")


def test_nan_value_is_a_failure() -> None:
    root = ElementTree.fromstring(to_bytes({"one": [Check("overlap", float("nan"), 1.0, "mm3")]}))
    assert root.get("failures") == "1"
