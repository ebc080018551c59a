"""Fit coupon: sound solids in both kernels, the fits of the real parts, true lengths, and a short print."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.slicer import parse_gcode
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.coupon import COUPON_PARTS, RING_MM, frame_with_fits, loose_slice
from fingertip.cad.shapes.coupon_layout import WALLS_MM, has_key, lay_out
from fingertip.cad.verification.printing import check_mesh_file
from fingertip.calibration.readings import list_lengths
from fingertip.catalogues.bundled import list_bundled_files
from fingertip.catalogues.file_kinds import DESIGN as DESIGN_KIND
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Placed, Solid, difference, intersection
from fingertip.documents.coupon import COUPON_LAYER_MM, COUPON_MINUTES
from tests.conftest import some_of
from tests.tools import require_tool

DESIGNS = sorted(list_bundled_files(DESIGN_KIND))
VARIANTS = {
    "no draft": ["mold.draft_deg=0"],
    "no text": ["mold.engraving_depth_mm=0"],
    "key wider than the slice": ["mold.key_diameter_mm=8.2", "mold.land_mm=4"],
    "small sensor": [
        "sensor.model=custom", "custom_sensor.head_diameter_mm=2.1", "custom_sensor.active_diameter_mm=2",
        "custom_sensor.tail_width_mm=3.6", "custom_sensor.length_mm=30",
    ],
    "compensated": ["printer.scale_percent=99.5"],
}  # fmt: skip
FINE = MeshEvaluator(0.002)


def load(name: str, *changes: str) -> Design:
    return Design.load(name, changes=changes)


def failed(design: Design) -> list[str]:
    """Names of the failed checks of both pieces, read back from STL."""
    names = []
    for name, part in COUPON_PARTS.items():
        read = stl.from_bytes(stl.to_bytes(MeshEvaluator(0.01).mesh(part.solid(design)), name))
        names += [check.name for check in check_mesh_file(design, part, read, "stl") if not check.passed]
    return names


@pytest.mark.parametrize("changes", VARIANTS.values(), ids=VARIANTS)
def test_variants_are_sound(changes: list[str]) -> None:
    design = load("fsr400", *changes)
    assert failed(design) == []
    layout = lay_out(design)
    assert (layout.socket is None) == ("mold.key_diameter_mm=8.2" in changes)
    assert (layout.text is None) == (design.mold.engraving_depth_mm == 0)


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr402", "child_thumb"))
def test_kernels_agree(name: str) -> None:
    """The volumes differ by what the facets leave out: the mesh at 2 um has 1 / 5 of the error of that at 10 um."""
    from fingertip.cad.kernel import brep

    design = load(name)
    for part in COUPON_PARTS.values():
        solid = part.solid(design)
        exact = brep.BrepEvaluator().solid(solid)
        assert brep.genus(exact) == part.genus(design)
        coarse, fine = (abs(MeshEvaluator(t).mesh(solid).volume() - brep.volume(exact)) for t in (0.01, 0.002))
        assert coarse < 0.01 * MeshEvaluator(0.01).mesh(solid).area()
        assert fine < coarse / 3


@pytest.mark.full
@pytest.mark.parametrize("name", DESIGNS)
def test_pieces_are_closed_single_bodies_and_nothing_overhangs(name: str) -> None:
    """Only the bed lies under a face that looks down, so that no piece needs supports."""
    design = load(name)
    assert failed(design) == []
    for part in COUPON_PARTS.values():
        mesh = FINE.mesh(part.solid(design))
        corners = mesh.vertices[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        down = normal[:, 2] < -0.5 * np.linalg.norm(normal, axis=1)
        assert mesh.vertices[:, 2].min() == 0.0
        assert corners[down][:, :, 2].max() < 1e-6


@pytest.mark.full
@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_both_kernels_turn_by_the_right_hand_rule(turns: int) -> None:
    """A box from the origin to (1, 2, 3), turned by hand: y becomes z, and z becomes -y."""
    from fingertip.cad.kernel import brep, occ

    placed = Placed(Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)), turns, (10.0, 20.0, 30.0))
    low, high = {
        -1: ((10, 20, 28), (11, 23, 30)), 0: ((10, 20, 30), (11, 22, 33)), 1: ((10, 17, 30), (11, 20, 32)),
    }[turns]  # fmt: skip
    vertices, exact = FINE.mesh(placed).vertices, occ.bounds(brep.BrepEvaluator().shape(placed))
    assert (tuple(vertices.min(axis=0)), tuple(vertices.max(axis=0))) == (low, high)
    assert (*exact[0], *exact[1]) == pytest.approx((*low, *high), abs=1e-3)


def gap_mm(a: Solid, b: Solid, search: float = 2.0) -> float:
    """Smallest distance of two solids [mm]; 0 if they overlap."""
    first, second = FINE.manifold(a), FINE.manifold(b)
    return 0.0 if (first ^ second).volume() > 1e-9 else float(first.min_gap(second, search))


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_slice_fits_its_recess_with_the_clearance_of_the_mold(name: str) -> None:
    design = load(name)
    layout, clearance = lay_out(design), design.mold.fit_clearance_mm
    x, y = layout.ring.centre[0], layout.ring.low[1] + 1.2 + clearance + design.dimensions.base_flat_depth
    reach = 100.0
    flat = intersection(loose_slice(design), Box((-reach, -reach, 0.1), (reach, reach, RING_MM - 0.1)))  # without key
    assert gap_mm(Placed(flat, 0, (x, y, 0.0)), frame_with_fits(design)) == pytest.approx(clearance, abs=0.005)


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_key_fits_its_socket_with_its_clearance(name: str) -> None:
    """The loose piece is turned over, so that its key hangs into the socket from above."""
    design = load(name)
    assert has_key(design)
    socket, section = lay_out(design).socket, design.dimensions.bone_outline.section
    assert socket
    height = FINE.mesh(loose_slice(design)).vertices[:, 2].max()
    y = (section.dorsal - design.dimensions.base_flat_depth) / 2
    key = intersection(
        loose_slice(design), Box((-9.0, -9.0, height - design.mold.key_height_mm + 0.1), (9.0, 9.0, 99.0))
    )
    over = Placed(Placed(Placed(key, 0, (0.0, -y, -height)), 1, (0.0, 0.0, 0.0)), 1, (0.0, 0.0, 0.0))
    top = design.mold.key_height_mm + design.mold.key_clearance_mm + 0.6
    hanging = Placed(over, 0, (*socket.centre, top - design.mold.key_height_mm))
    gap = gap_mm(hanging, frame_with_fits(design))
    assert gap == pytest.approx(design.mold.key_clearance_mm, abs=0.01)


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_sensor_fits_its_pocket_with_its_clearance(name: str) -> None:
    """The body of the sensor lies on its adhesive film, with the clearance around head and tail."""
    design = load(name)
    dims, layout = design.dimensions, lay_out(design)
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    near = Box((-99.0, -99.0, dims.sensor_z - head - 0.3), (99.0, 99.0, 99.0))
    y = layout.sensor.high[1] - 1.2 - head
    placed = Placed(
        intersection(sensor_body(design), near), -1,
        (layout.sensor.centre[0], y - dims.sensor_z, layout.tile_mm - dims.platform_depth),
    )  # fmt: skip
    expected = min(design.sensor.clearance_mm, design.sensor.adhesive_thickness_mm)
    assert gap_mm(placed, frame_with_fits(design)) == pytest.approx(expected, abs=0.005)


def probe(solid: Solid, point: tuple[float, float, float], axis: int, outer: bool) -> float:
    """Length of solid (outer) or of air (inner) around a point, along an axis [mm]."""
    thin, long = 0.01, 200.0
    low, high = [c - thin for c in point], [c + thin for c in point]
    low[axis], high[axis] = point[axis] - long, point[axis] + long
    rod = Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    along = intersection(rod, solid) if outer else difference(rod, solid)
    for piece in FINE.manifold(along).decompose():
        box = piece.bounding_box()
        if box[axis] <= point[axis] <= box[axis + 3]:
            return float(box[axis + 3] - box[axis])
    raise AssertionError(f"nothing at {point}")


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_nominal_lengths_are_those_of_the_solids(name: str) -> None:
    """Each length is measured on the mesh where the template says."""
    design = load(name)
    layout, frame, piece = lay_out(design), frame_with_fits(design), loose_slice(design)
    (width, depth), ring, tongue = layout.size, layout.ring, layout.tongue
    assert layout.luer
    side = 0.4  # inside the wall of a block
    places = {
        "outer_x_mm": (frame, (0.5, depth - 0.5, 1.0), 0), "outer_y_mm": (frame, (0.5, 0.5, 1.0), 1),
        "recess_block_x_mm": (frame, (ring.centre[0], ring.high[1] - side, 1.6), 0),
        "recess_block_y_mm": (frame, (ring.low[0] + side, ring.centre[1], 1.6), 1),
        "tongue_mm": (frame, (tongue.centre[0], tongue.high[1] - side, 3.0), 0),
        "tower_mm": (frame, (layout.luer.centre[0], layout.luer.high[1] - side, 5.0), 0),
        "slice_width_mm": (piece, (0.0, 0.0, 1.0), 0), "slice_height_mm": (piece, (0.0, 0.0, 1.0), 1),
        "window_x_mm": (frame, (*layout.windows[0].centre, 1.0), 0),
        "window_y_mm": (frame, (layout.windows[1].high[0] - 1.0, layout.windows[1].centre[1], 1.0), 1),
        "upper_window_y_mm": (frame, (layout.windows[2].high[0] - 1.0, layout.windows[2].centre[1], 1.0), 1),
        "slot_mm": (frame, (layout.slot.centre[0], 1.0, 1.0), 0),
        "nut_trap_mm": (frame, (*tongue.centre, 3.0), 1),
    }  # fmt: skip
    lengths = {length.name: length for length in list_lengths(design)}
    assert places.keys() == {name for name, length in lengths.items() if length.kind != "wall"}
    for key, (solid, point, axis) in places.items():
        found = probe(solid, point, axis, lengths[key].kind == "outer")
        assert found == pytest.approx(lengths[key].nominal_mm, abs=0.006), key
    for wall, spot in zip(WALLS_MM, layout.walls, strict=True):
        assert probe(frame, (*spot.centre, 2.0), 0, True) == pytest.approx(wall, abs=1e-3)
        assert lengths[f"wall_{wall:.1f}_mm".replace(".", "_")].nominal_mm == wall
    assert max(width, depth) < 58.0


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr402", "child_thumb"))
def test_both_pieces_print_in_the_stated_time(name: str, tmp_path: Path) -> None:
    """PrusaSlicer, in layers of 0.2 mm and without supports, with both pieces on the bed at once."""
    slicer = require_tool("prusa-slicer", "sh .ci/install-slicer, as root on Debian 12")
    frame, piece = (MeshEvaluator(0.01).mesh(part.solid(load(name))) for part in COUPON_PARTS.values())
    beside = piece.vertices - np.array([20.0, 0.0, 0.0])
    both = Mesh(
        np.vstack([frame.vertices, beside]), np.vstack([frame.triangles, piece.triangles + len(frame.vertices)])
    )
    part, gcode = tmp_path / "both.stl", tmp_path / "both.gcode"
    part.write_bytes(stl.to_bytes(both, "both"))
    command = [slicer, "--export-gcode", "--layer-height", f"{COUPON_LAYER_MM:g}", "-o", gcode, part]
    subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    assert parse_gcode(name, gcode.read_text()).minutes <= COUPON_MINUTES
