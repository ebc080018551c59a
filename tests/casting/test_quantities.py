"""Silicone volumes, hardware, wires and retention of a mold, compared with closed forms and identities."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.parts.table import PlugWire, find_plug_wire
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import mold
from fingertip.cad.shapes.insert import cavity, mold_insert
from fingertip.cad.shapes.mold import runners
from fingertip.cad.verification.mold import check_filling
from fingertip.casting.hardware import describe_plug_wires, size_wires
from fingertip.casting.quantities import (
    SiliconeVolumes,
    compute_batch,
    load_cm3,
    measure_volumes,
    skin_pull_off_n,
    volumes_data,
)
from fingertip.catalogues.hardware import select_thread
from fingertip.catalogues.silicones import load_silicones
from fingertip.design import Design
from fingertip.design.geometry.solids import difference, intersection, union
from fingertip.filling.mold_filling import injected_cm3, predict_mold_filling
from tests.conftest import design_file

SILICONES = load_silicones()


def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=changes)


def fsr400(*changes: str) -> Design:
    return load("fsr400", *changes)


def test_volumes_add_up_to_the_hollow_without_the_insert() -> None:
    design, evaluator = fsr400("mold.fit_clearance_mm=0.07"), MeshEvaluator(0.02)
    hollow = intersection(mold.cast_hollow(design), mold.block(design))
    cast_mm3 = evaluator.manifold(difference(hollow, mold_insert(design))).volume()
    runners_mm3 = evaluator.manifold(
        difference(intersection(union(*runners(design)), mold.block(design)), cavity(design))
    ).volume()
    volumes = measure_volumes(design, evaluator)
    assert volumes.total_cm3 == pytest.approx(cast_mm3 / 1000, rel=1e-6)
    assert volumes.runners_cm3 == pytest.approx(runners_mm3 / 1000, rel=1e-6)


@pytest.mark.parametrize(
    ("volumes", "rounded"),
    [
        # 100.6, 50.3 and 25.4 hundredths are 176.3: the hundredth beyond 100, 50 and 25 is the skin's.
        ((1.006, 0.503, 0.254), (1.01, 0.50, 0.25, 1.76)),
        # 100.2, 50.7 and 25.9 are 176.8: two hundredths are left.
        ((1.002, 0.507, 0.259), (1.00, 0.51, 0.26, 1.77)),
        # 2.3, 4.1 and 6.9 are 13.3: what counts is the part cut off, not the size.
        ((0.069, 0.041, 0.023), (0.07, 0.04, 0.02, 0.13)),
        ((0.023, 0.069, 0.041), (0.02, 0.07, 0.04, 0.13)),
        # 0.29 is 28.999999999999996 hundredths.
        ((0.29, 0.29, 0.29), (0.29, 0.29, 0.29, 0.87)),
        ((2.0, 0.0, 0.0), (2.0, 0.0, 0.0, 2.0)),
    ],
)
def test_rounded_volumes_add_up(volumes: tuple[float, float, float], rounded: tuple[float, ...]) -> None:
    skin, runners, gap, total = rounded
    assert volumes_data(SiliconeVolumes(*volumes)) == {"skin": skin, "runners": runners, "gap": gap, "total": total}


def test_syringe_is_loaded_with_half_as_much_again_or_filled() -> None:
    design, small = fsr400(), fsr400("mold.syringe=3ml")
    assert load_cm3(design) == pytest.approx(1.5 * injected_cm3(predict_mold_filling(design)), rel=1e-12)
    assert 1.5 * injected_cm3(predict_mold_filling(small)) > 3.0
    assert load_cm3(small) == 2.5, "the plunger needs room"
    assert "mold.syringe_volume" in {check.name for check in check_filling(small) if not check.passed}
    assert load_cm3(Design.load("first_finger")) == 0.0


def test_only_a_load_of_more_than_the_mold_holds_changes_the_batch() -> None:
    silicone = SILICONES["dragon_skin_30"]
    batch = compute_batch(silicone, 0.5)
    assert batch.with_waste_g == pytest.approx(1.25 * 0.5 * silicone.density_g_cm3.high)
    assert compute_batch(silicone, 0.5, 0.4) == batch
    assert compute_batch(silicone, 0.5, 0.6).with_waste_g == pytest.approx(1.2 * batch.with_waste_g)


@pytest.mark.parametrize(("hole", "thread"), [(3.4, 3.0), (3.2, 3.0), (3.19, 2.5), (2.2, 2.0), (9.0, 8.0), (1.7, 1.6)])
def test_largest_thread_that_passes_a_hole_is_selected(hole: float, thread: float) -> None:
    assert select_thread(hole).diameter_mm == thread


# Pull-off force of the skin


SILICONE = SILICONES["addition_40a"]


def pull(*changes: str) -> float:
    return skin_pull_off_n(Design.load(changes=changes), SILICONE)


def test_groove_holds_as_a_stretched_ring() -> None:
    """E e t / R over the width of a groove of 0.6 mm around a bone of 13.2 x 8 mm."""
    dims = Design().dimensions
    radius = (6.6 + (5.5 + dims.flat_depth) / 2) / 2
    expected = SILICONE.modulus_mpa.low * (0.6 / radius) * 1.5 / radius * math.tau * radius * 3.0
    assert pull() == pytest.approx(expected)
    assert pull("bone.groove_depth_mm=0") == 0.0
    assert pull("bone.groove_width_mm=6") == pytest.approx(2 * expected)


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
    """The adult's joint turns by 55 degrees about an axis 6.58 mm below the back of its eyes: an arc of 6.32 mm."""
    assert size_wires(load("fsr400")).slack_mm == 10.0
    assert size_wires(load("adult_finger")).slack_mm == pytest.approx(16.32, abs=0.01)


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
