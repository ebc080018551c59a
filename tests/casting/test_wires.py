"""Wires of the sensor: conductors of the American wire gauge, the loop over the joint, and the plug of the board."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.parts.table import PlugWire, find_plug_wire
from fingertip.casting.hardware import describe_plug_wires, size_wires
from fingertip.design import Design
from tests.conftest import design_file


def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=changes)


@pytest.mark.parametrize(("awg", "conductor_mm"), [(28, 0.3211), (30, 0.2546), (31, 0.2268), (32, 0.2019)])
def test_conductor_is_the_thickest_that_fills_half_of_the_wire(awg: int, conductor_mm: float) -> None:
    """Diameters of the published table (ASTM B258); the other half of the wire is insulation."""
    fits, jams = (f"sensor.wire_diameter_mm={2 * conductor_mm + room:.4f}" for room in (0.001, -0.001))
    assert size_wires(load("adult_finger", fits)).conductor_awg == awg
    assert size_wires(load("adult_finger", jams)).conductor_awg == awg + 1


def test_gauges_are_those_of_the_plug_and_two_wires_pass_the_channel() -> None:
    """JST SH takes AWG 28 to 32. Two wires side by side span a channel of 2.4 mm, in which thicker ones have room."""
    wires = size_wires(load("fsr400", "bone.channel_diameter_mm=2.4"))
    assert (wires.max_diameter_mm, wires.conductor_awg, wires.thinnest_awg) == (1.2, 28, 32)
    assert size_wires(load("adult_finger", "sensor.wire_diameter_mm=0.5")).max_diameter_mm == 0.5


def test_loop_is_the_arc_over_the_joint_and_a_centimetre() -> None:
    """The adult's joint turns by 55 degrees about an axis 6.4 mm below the back of the bone: an arc of 6.14 mm."""
    assert size_wires(load("fsr400")).slack_mm == 10.0
    assert size_wires(load("adult_finger")).slack_mm == pytest.approx(16.14, abs=0.01)


SH = PlugWire("JST SH", 28, 32, 0.4, 0.8, "")


@pytest.mark.parametrize(
    ("max_diameter_mm", "thickest_awg", "expected"),
    [
        (1.2, 23, "all of them fit the finger"),
        (0.5, 31, "of them, AWG 31 to 32 with at most 0.5 mm fit the finger"),
        (0.8, 32, "of them, AWG 32 with at most 0.8 mm fit the finger"),
        (0.39, 30, "none of them fits the finger"),
        (0.8, 33, "none of them fits the finger"),
    ],
)
def test_wires_that_fit_plug_and_finger(max_diameter_mm: float, thickest_awg: int, expected: str) -> None:
    assert SH.describe_common(max_diameter_mm, thickest_awg).startswith(expected)


@pytest.mark.full
def test_wires_of_the_bundled_designs_fit_their_boards_plug() -> None:
    for name in ("fsr400", "fsr402", "adult_finger", "child_thumb"):
        design = Design.load(name)
        plug = find_plug_wire(board_circuit(board_values(design)).component("J1"))
        assert plug == replace(SH, source="jst_sh")
        said = describe_plug_wires(design, size_wires(design))
        assert "fit the finger" in said
        assert "none" not in said
    article = Design.load("article")
    assert describe_plug_wires(article, size_wires(article)) == ""
