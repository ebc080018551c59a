"""Results in Python and Jupyter: short forms, tables in HTML, pictures and data frames."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import fingertip
from fingertip import Build, Design, Detection, Trace
from fingertip.foundation.display import html_table
from fingertip.sim.simulation import Trial
from tests.tools import require_module


@pytest.fixture(scope="module")
def trace() -> Trace:
    return fingertip.simulate(Design(), Trial())


@pytest.fixture(scope="module")
def detection(trace: Trace) -> Detection:
    return fingertip.detect(trace, Design(), "fast")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Build:
    design = Design.load("fsr400", changes=["skin.width_mm=18"])
    return fingertip.build(
        design, tmp_path_factory.mktemp("built"), parts=["bone"], formats=["stl"], tolerance_mm=0.05
    )


def test_short_forms_of_designs_name_what_differs() -> None:
    assert repr(Design()) == "Design('fsr400')"
    assert repr(Design.load("fsr400", changes=["skin.width_mm=18", "name=wider"])) == (
        "Design('wider', skin.width_mm=18.0)"
    )
    assert repr(Design.load("adult_finger")).count("=") == 4
    assert re.search(r", \d+ more\)$", repr(Design.load("adult_finger")))
    design = Design.load("adult_finger")
    texts = [f"{name}={value}" for name, value in design.changes().items()]
    assert Design.load(changes=[*texts, "name=adult_finger"]) == design


def test_short_forms_of_traces_and_detections(trace: Trace, detection: Detection) -> None:
    assert re.fullmatch(
        r"Trace\(\d+ samples, [\d.]+ s at 2000 Hz, force_n, slip(, \w+)*\)", repr(trace)
    )
    assert f"{len(trace.time_s)} samples" in repr(trace)
    assert re.fullmatch(
        r"Detection\(fast: 1 interval ON, 1 of 1 slips found, delay -?[\d.]+ ms, 0 false\)",
        repr(detection),
    )
    assert detection.score is not None
    assert f"{1000 * (detection.score.delays_s[0] or 0):.1f} ms" in repr(detection)
    unknown = fingertip.detect(Trace(trace.time_s, trace.voltage_v), Design(), "fast")
    assert repr(unknown) == "Detection(fast: 1 interval ON)"
    assert repr(Trace(np.zeros(0), np.zeros(0))) == "Trace(0 samples)"


def parse(text: str) -> list[ElementTree.Element]:
    """Tables of a page; fails if the text is not well-formed."""
    return list(ElementTree.fromstring(f"<div>{text}</div>").iter("table"))


def test_tables_are_well_formed_and_escaped(
    trace: Trace, detection: Detection, built: Build
) -> None:
    (changes,) = parse(Design.load("fsr402")._repr_html_())
    assert len(list(changes.iter("tr"))) == len(Design.load("fsr402").changes()) + 1
    (columns,) = parse(trace._repr_html_())
    assert [row[0].text for row in columns.iter("tr")][:5] == [
        "column",
        "time_s",
        "voltage_v",
        "force_n",
        "slip",
    ]
    (intervals,) = parse(detection._repr_html_())
    assert [cell.text for cell in list(intervals.iter("tr"))[1]][-1] == "true"
    assert [row[0].text for row in parse(built._repr_html_())[0].iter("tr")] == ["part", "bone"]
    assert len(repr(built)) < 300
    assert "bone; " in repr(built)
    assert f"all {len(built.checks)} checks passed" in repr(built)
    (table,) = parse(html_table("<script>", ["<b>"], [["&", "<script>"]]))
    assert "".join(table.itertext()) == "<script><b>&<script>"


def test_results_are_drawn(
    built: Build, trace: Trace, detection: Detection, tmp_path: Path
) -> None:
    picture = fingertip.picture(built.design, 500)
    assert picture.size_px[0] == 500
    assert picture.save(tmp_path / "a.png").read_bytes() == picture.png
    require_module("matplotlib")
    for picture in (
        fingertip.plot_trace(trace),
        fingertip.plot_detection(detection, "my title"),
    ):
        assert picture.size_px == Image.open(io.BytesIO(picture.png)).size
        assert picture._repr_png_() == picture.png
        assert repr(picture).startswith(f"Picture({picture.size_px[0]} x ")


def test_data_frames(trace: Trace, detection: Detection, built: Build, tmp_path: Path) -> None:
    require_module("pandas")
    frame = trace.to_dataframe()
    frame.to_csv(tmp_path / "trace.csv", index=False)
    assert np.array_equal(fingertip.read_trace(tmp_path / "trace.csv").slip, trace.slip)
    assert list(frame.columns)[:4] == ["time_s", "voltage_v", "force_n", "slip"]
    assert np.array_equal(frame["voltage_v"], trace.voltage_v)
    found = detection.to_dataframe()
    assert found["is_true"].tolist() == [True]
    assert found["onset_s"].tolist() == [detection.intervals[0].onset_s]
    checks = built.to_dataframe()
    assert checks["passed"].all()
    assert len(checks) == len(built.checks)
    parameters = built.design.to_dataframe().set_index("name")
    assert parameters.loc["skin.width_mm", ["value", "unit"]].tolist() == [18.0, "mm"]


@pytest.mark.full
def test_assembly_holds_parts_and_hardware_in_place() -> None:
    require_module("cadquery")
    design = Design()
    made: Any = fingertip.assembly(design)
    names = {child.name for child in made.children}
    assert {"bone", "skin", "mold_palmar", "mold_dorsal", "core", "sensor"} <= names
    volumes = {child.name: child.obj.Volume() for child in made.children}
    assert volumes["bone"] == pytest.approx(fingertip.part_solid(design, "bone").Volume(), rel=1e-9)
