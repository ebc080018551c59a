"""Overhangs: closed forms on simple solids, ceilings of nut traps, and parts with a defect that the check must find."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator, to_arrays
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import MAX_BRIDGE_MM, MAX_LEDGE_MM, MAX_UNSUPPORTED_MM2, bed_pose, find_ceilings
from fingertip.cad.shapes import insert as chaplet
from fingertip.cad.shapes import mold
from fingertip.cad.shapes.bridged_ceiling import (
    BRIDGE_STEP_MM,
    CEILING_STEPS_MM,
    bridge_ceiling,
    ceiling_steps_volume_mm3,
    disc_slot_area_mm2,
    hexagon_slot_area_mm2,
)
from fingertip.cad.shapes.parts import PARTS, print_scale
from fingertip.cad.verification.printing import _is_inside, check_overhang
from fingertip.catalogues.hardware import MAX_TRAP_RATIO, NUT_TRAP_CLEARANCE_MM, THREADS, Thread
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Cone, Prism, Solid, cylinder, difference, hexagon, scaled, union
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from tests.conftest import design_file, some_of

TOLERANCE, FINE = 0.02, 0.0005
WIDTH = 6.0


def unsupported_mm2(solid: Solid) -> float:
    """Largest unsupported ceiling of a solid that stands on z = 0."""
    ceilings = find_ceilings(MeshEvaluator(TOLERANCE).mesh(solid))
    return max((ceiling.unsupported_mm2() for ceiling in ceilings), default=0.0)


def shelf(reach: float) -> Solid:
    """A wall with a shelf that stands out by `reach`."""
    return union(Box((-2.0, 0.0, 0.0), (0.0, WIDTH, 8.0)), Box((-1.0, 0.0, 5.0), (reach, WIDTH, 8.0)))


def gate(span: float) -> Solid:
    """Two pillars with a beam across."""
    beam = Box((-1.0, 0.0, 5.0), (span + 1.0, WIDTH, 8.0))
    return union(Box((-2.0, 0.0, 0.0), (0.0, WIDTH, 8.0)), Box((span, 0.0, 0.0), (span + 2.0, WIDTH, 8.0)), beam)


def test_long_shelves_and_beams_are_unsupported_over_their_whole_area() -> None:
    """Askew threads hold on to a little of a shelf, at its corners."""
    assert unsupported_mm2(shelf(MAX_LEDGE_MM - 0.01)) == 0.0
    assert unsupported_mm2(shelf(1.5 * MAX_LEDGE_MM)) == pytest.approx(1.5 * MAX_LEDGE_MM * WIDTH, rel=0.03)
    assert unsupported_mm2(gate(MAX_BRIDGE_MM - 0.01)) == 0.0
    assert unsupported_mm2(gate(MAX_BRIDGE_MM + 1.0)) == pytest.approx((MAX_BRIDGE_MM + 1.0) * WIDTH, rel=0.03)


@pytest.mark.parametrize("angle", [30.0, 45.0, 90.0])
def test_bridge_is_found_in_every_direction(angle: float) -> None:
    """A beam of 9 mm across two pillars that stand askew; its ends are parallel to them."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))

    def block(low: float, high: float, bottom: float) -> Solid:
        ring = ((low, -3.0), (high, -3.0), (high, 3.0), (low, 3.0))
        return Prism("z", tuple((c * u - s * v, s * u + c * v) for u, v in ring), bottom, 8.0)

    assert unsupported_mm2(union(block(-2.0, 0.0, 0.0), block(9.0, 11.0, 0.0), block(-1.0, 10.0, 5.0))) < 0.01


@pytest.mark.parametrize(("run", "overhangs"), [(0.99, False), (1.01, True)])
def test_slope_counts_above_45_degrees(run: float, overhangs: bool) -> None:
    """A funnel upside down: its wall is its ceiling, of the area of the ring seen from above."""
    height = 4.0
    area = unsupported_mm2(Cone("z", (0.0, 0.0), 0.0, height, 1.0, 1.0 + run * height))
    ring = math.pi * ((1.0 + run * height) ** 2 - 1.0)
    assert area == pytest.approx(ring if overhangs else 0.0, rel=0.02)


def test_small_horizontal_bore_needs_no_supports() -> None:
    block = Box((-8.0, -8.0, 0.0), (8.0, 8.0, 16.0))
    across = MAX_BRIDGE_MM * math.sqrt(2.0)  # of a bore whose overhanging arc is as wide as the longest bridge
    assert unsupported_mm2(difference(block, cylinder("x", (0.0, 8.0), -9.0, 9.0, 0.49 * across))) == 0.0
    assert unsupported_mm2(difference(block, cylinder("x", (0.0, 8.0), -9.0, 9.0, 0.51 * across))) > 100.0


def trap_in_block(diameter: float, width: float, is_bridged: bool) -> Solid:
    """A nut trap in the lower face of a block, on the axis of a bolt's hole, with z up."""
    depth, hole = 4.0, diameter / 2
    pocket = hexagon(0.0, 0.0, width, -1.0, depth + (CEILING_STEPS_MM if is_bridged else 0.0))
    trap = bridge_ceiling(pocket, (0.0, 0.0), depth, 1.0, hole, reach=width) if is_bridged else pocket
    block = Box((-width, 0.0, -width), (width, 10.0, width))
    return difference(block, trap, cylinder("y", (0.0, 0.0), -1.0, 11.0, hole))


def lying(solid: Solid) -> float:
    """Largest unsupported ceiling of a solid that stands on y = 0."""
    mesh = MeshEvaluator(TOLERANCE).mesh(solid)
    turned = type(mesh)(mesh.vertices[:, [2, 0, 1]], mesh.triangles)
    return max((ceiling.unsupported_mm2() for ceiling in find_ceilings(turned)), default=0.0)


@pytest.mark.every_case
@pytest.mark.parametrize("thread", THREADS[:-1], ids=lambda thread: thread.label)
@pytest.mark.parametrize("clearance", [0.0, 1.0])
def test_ceiling_of_a_nut_trap_is_bridged_for_every_thread(thread: Thread, clearance: float) -> None:
    """From the narrowest trap with the widest hole of a thread to the widest trap with the narrowest hole."""
    following = THREADS[THREADS.index(thread) + 1]
    hole = thread.hole_mm + (1.0 - clearance) * (following.hole_mm - thread.hole_mm - 0.01)
    narrow, wide = thread.nut_flats_mm + NUT_TRAP_CLEARANCE_MM, thread.nut_flats_mm * MAX_TRAP_RATIO
    width = max(narrow, wide) if clearance else narrow
    assert lying(trap_in_block(hole, width, is_bridged=True)) == 0.0
    if (width - hole) / 2 > MAX_LEDGE_MM:
        assert lying(trap_in_block(hole, width, is_bridged=False)) > MAX_UNSUPPORTED_MM2


def test_steps_of_a_ceiling_have_their_volume_in_closed_form() -> None:
    evaluator, hole, width = MeshEvaluator(FINE), 1.7, 5.8
    for pocket, plain, slot in (
        (hexagon(3.0, -2.0, width, 0.0, 2.0 + CEILING_STEPS_MM), hexagon(3.0, -2.0, width, 0.0, 2.0),
         hexagon_slot_area_mm2(width, hole)),
        (cylinder("y", (3.0, -2.0), 0.0, 2.0 + CEILING_STEPS_MM, 3.0), cylinder("y", (3.0, -2.0), 0.0, 2.0, 3.0),
         disc_slot_area_mm2(3.0, hole)),
    ):  # fmt: skip
        steps = evaluator.manifold(bridge_ceiling(pocket, (3.0, -2.0), 2.0, 1.0, hole, reach=width)).volume()
        added = steps - evaluator.manifold(plain).volume()
        bored = 3.0 * BRIDGE_STEP_MM * math.pi * hole**2
        assert added - bored == pytest.approx(ceiling_steps_volume_mm3(slot, hole), rel=1e-3)


def overhang(part: str, *changes: str, added: Solid | None = None) -> float:
    """Value of the check for a part of the default design, with something added to it."""
    design, evaluator = Design.load(changes=changes), MeshEvaluator(TOLERANCE)
    solid = PARTS[part].solid(design)
    mesh = evaluator.mesh(scaled(union(solid, added) if added else solid, print_scale(design, PARTS[part])))
    check = check_overhang(design, evaluator, part, mesh)
    assert check.name == f"{part}.overhang"
    assert check.passed == (check.value <= MAX_UNSUPPORTED_MM2)
    return check.value


def test_plain_nut_traps_and_counterbores_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    assert overhang("mold_palmar") == 0.0
    assert overhang("mold_dorsal") == 0.0
    for module in (mold, chaplet):
        monkeypatch.setattr(module, "bridge_ceiling", lambda pocket, *arguments, **names: pocket)
    assert overhang("mold_palmar") > 5.0
    assert overhang("mold_dorsal") > 3.0


def test_fin_above_the_collar_fails_and_below_it_does_not() -> None:
    def fin(z: float) -> Box:
        return Box((-12.0, -1.0, z), (12.0, 1.0, z + 2.0))

    assert overhang("bone", added=fin(10.0)) > 5.0
    assert overhang("bone", added=fin(-12.0)) <= MAX_UNSUPPORTED_MM2
    for scale in (98, 103):  # the places of supports follow the scale of the print
        assert overhang("bone", f"printer.scale_percent={scale}") <= MAX_UNSUPPORTED_MM2
    assert find_bounds(PARAMETERS["printer.scale_percent"]).minimum * BRIDGE_STEP_MM / 100.0 > 0.2, "above a layer"


def test_shelf_in_the_recess_of_the_sensor_fails() -> None:
    """Below the collar supports may stand outside, but not in the relief of the solder joints."""
    dims = Design().dimensions
    z, half, floor = dims.tail_end_z, dims.tail_half_width, dims.channel_depth - dims.flat_depth
    assert z < -Design().bone.collar_length_mm
    assert overhang("bone", added=Box((-half - 1.0, -dims.flat_depth, z), (0.0, floor + 2.0, z + 0.5))) > 2.0


NARROW = ("child_thumb", "youth_finger")
"""Bones whose lid is as wide as they are, and hangs."""
LIDS = ("fsr400_compact", "adult_finger", "adult_thumb", "child_finger", "child_thumb", "youth_finger", "youth_thumb")


@pytest.mark.every_case
@pytest.mark.parametrize("name", some_of(LIDS, "fsr400_compact", "adult_finger"))
def test_lid_lies_as_it_overhangs_least(name: str) -> None:
    """Upright or on its feet. A lid whose collar hangs above its nose, or whose rims hang, needs supports below."""
    design, evaluator = Design.load(design_file(name)), MeshEvaluator(TOLERANCE)
    mesh = evaluator.mesh(PARTS["lid"].solid(design))
    areas = {
        turn: [each.unsupported_mm2() for each in find_ceilings(bed_pose(mesh, turn).apply(mesh))]
        for turn in (0.0, 90.0)
    }
    lies = print_orientations(design)["lid"]
    assert sum(areas[lies.rotate_x_deg]) <= min(map(sum, areas.values())) + 0.01
    assert sum(areas[90.0]) > 8.0, "the feet leave long ledges"
    needs = max(areas[lies.rotate_x_deg], default=0.0) > MAX_UNSUPPORTED_MM2
    assert lies.needs_supports == needs == (name in {"fsr400_compact", *NARROW})
    assert bool(supports_by_part(design)["lid"].places) == lies.needs_supports
    assert check_overhang(design, evaluator, "lid", mesh).passed
    top = design.dimensions.bone_outline.section.dorsal
    fin = Box((-1.0, top - 1.0, 5.0), (1.0, top + 4.0, 7.0))
    if not needs:
        finned = evaluator.mesh(union(PARTS["lid"].solid(design), fin))
        assert check_overhang(design, evaluator, "lid", finned).value > 2.0


def test_points_are_inside_a_hollow_block_as_its_sizes_say() -> None:
    """The ray may pass the hollow, so that it enters and leaves twice."""
    block = difference(Box((-3.0, -2.0, 0.0), (3.0, 2.0, 5.0)), Box((-1.0, -1.0, 1.0), (2.0, 1.0, 4.0)))
    rng = np.random.default_rng(18)
    points = rng.uniform((-4.0, -3.0, -1.0), (4.0, 3.0, 6.0), (4000, 3))

    def within(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:  # type: ignore[type-arg]
        return np.asarray(((points > low) & (points < high)).all(axis=1))

    expected = within((-3.0, -2.0, 0.0), (3.0, 2.0, 5.0)) & ~within((-1.0, -1.0, 1.0), (2.0, 1.0, 4.0))
    found = _is_inside(points, *to_arrays(MeshEvaluator(TOLERANCE).manifold(block)))
    assert (found == expected).all()
    assert 0.1 < expected.mean() < 0.9
