"""Volumes and hardware of a mold against closed forms and identities."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.hardware import clamp_bolts
from fingertip.casting.sheet import bill_of_materials
from fingertip.casting.quantities import SiliconeVolumes, measure_volumes
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import lay_out
from fingertip.design.threads import THREADS, select_thread
from fingertip.errors import DesignError
from tests.conftest import design_file

TOLERANCE = 0.005


def fsr400(*changes: str) -> Design:
    return Design.load(design_file("fsr400"), changes=changes)


def test_a_deeper_funnel_adds_a_frustum_and_longer_vents() -> None:
    shallow, deep = (fsr400(f"mold.funnel_depth_mm={depth}") for depth in (4.0, 6.0))
    mold, vents = deep.mold, len(lay_out(deep, deep.dimensions).vents_x)
    throat, mouth = mold.gate_diameter_mm / 2, mold.funnel_diameter_mm / 2
    frustum = math.pi / 3 * (throat**2 + throat * mouth + mouth**2) * 2.0
    longer = vents * math.pi * (mold.vent_diameter_mm / 2) ** 2 * 2.0
    added = 1000 * (
        measure_volumes(deep, MeshEvaluator(TOLERANCE)).runners_cm3 - measure_volumes(shallow, MeshEvaluator(TOLERANCE)).runners_cm3
    )
    assert added == pytest.approx(frustum + longer, rel=4 * TOLERANCE / (mold.vent_diameter_mm / 2))


def test_without_shrinkage_the_cavity_is_filled_by_the_skin() -> None:
    still = fsr400("mold.silicone_shrinkage_percent=0")
    skin = MeshEvaluator(TOLERANCE).manifold(PARTS["skin"].solid(still)).volume() / 1000
    assert measure_volumes(still, MeshEvaluator(TOLERANCE)).skin_cm3 == pytest.approx(skin, rel=1e-9)


def test_a_sleeve_is_poured_larger_by_the_cube_of_its_shrinkage() -> None:
    still, shrinking = (
        fsr400("mold.method=sleeve", f"mold.silicone_shrinkage_percent={percent}") for percent in (0.0, 1.0)
    )
    ratio = measure_volumes(shrinking, MeshEvaluator(TOLERANCE)).skin_cm3 / measure_volumes(still, MeshEvaluator(TOLERANCE)).skin_cm3
    assert ratio == pytest.approx(shrinking.dimensions.shrinkage**3, rel=1e-3)
    assert shrinking.dimensions.shrinkage == pytest.approx(1.01, abs=2e-4)


def test_the_gap_grows_with_the_fit() -> None:
    tight, loose = (measure_volumes(fsr400(f"mold.fit_clearance_mm={gap}"), MeshEvaluator(TOLERANCE)) for gap in (0.1, 0.2))
    assert 0.0 < tight.gap_cm3 < loose.gap_cm3
    assert loose.gap_cm3 / tight.gap_cm3 == pytest.approx(2.0, rel=0.1)


def test_the_total_is_the_sum() -> None:
    assert SiliconeVolumes(1.5, 0.25, 0.125).total_cm3 == 1.875


@pytest.mark.parametrize(("hole", "thread"), [(3.4, 3.0), (3.2, 3.0), (3.19, 2.5), (2.2, 2.0), (9.0, 8.0), (1.7, 1.6)])
def test_the_largest_thread_that_passes_the_hole(hole: float, thread: float) -> None:
    assert select_thread(hole).diameter_mm == thread


@pytest.mark.parametrize(
    ("change", "thread", "length"),
    [
        ("mold.wall_mm=4", 3.0, 25.0),  # 10.01 + 11.01 mm of mold, less a trap of 2.6, and a nut of 2.4: 20.8 mm
        ("mold.nut_depth_mm=4", 3.0, 20.0),  # 19.4 mm
        ("mold.wall_mm=9", 3.0, 35.0),  # 30.8 mm
        ("mold.bolt_diameter_mm=4.5 mold.nut_width_mm=7.3", 4.0, 25.0),  # 21.6 mm with a nut of 3.2
    ],
)
def test_bolts_reach_through_the_nut_and_not_further_than_they_come(change: str, thread: float, length: float) -> None:
    bolts = clamp_bolts(fsr400(*change.split()))
    assert (bolts.count, bolts.thread.diameter_mm, bolts.length_mm) == (4, thread, length)


def test_holes_that_pass_no_bolt_are_refused_with_the_least_that_does() -> None:
    for field in ("mold.bolt_diameter_mm", "bone.cross_bolt_diameter_mm"):
        with pytest.raises(DesignError, match=rf"{field}: 1.5 mm is too small; at least 1.7 mm"):
            fsr400(f"{field}=1.5")
    fsr400("mold.bolt_diameter_mm=1.7", "mold.nut_width_mm=3.45", "mold.pry_depth_mm=2")
    fsr400("bone.cross_bolt_diameter_mm=1.7")


def test_what_is_bought_fits_what_is_printed() -> None:
    """Bolts through their holes, nuts into their traps, and no trap in which a nut turns."""
    for thread in THREADS:
        width = thread.nut_flats_mm + 0.25
        changes = [f"mold.bolt_diameter_mm={thread.hole_mm}", f"mold.nut_width_mm={width}"]
        design = fsr400(*changes, "skin.length_mm=40", "mold.pry_depth_mm=0.5")
        bill = {entry["item"]: entry for entry in bill_of_materials(design)}
        assert bill["bolt of the mold"]["thread_mm"] == bill["nut of the mold"]["thread_mm"] == thread.diameter_mm
        assert thread.diameter_mm < design.mold.bolt_diameter_mm
        assert thread.nut_flats_mm == bill["nut of the mold"]["across_flats_mm"] < width < 1.1 * thread.nut_flats_mm
