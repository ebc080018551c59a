"""Sizes that calipers read on the print: what the printer adds, told from the normals of the mesh; references."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.sizes import (
    AXES,
    FIT,
    MIN_TOLERANCE_MM,
    Circle,
    Length,
    PartDrawing,
    Size,
    general,
)
from fingertip.foundation.numerics import Array
from fingertip.pictures.drawing.draw import part_drawings
from tests.drawing.conftest import FILES, load_variant

OFFSET_MM = 0.12
_ON_FACE_MM = 0.011
"""Distance of a facet from the face that a size states: the tolerance of the mesh, and a rounding error."""
_NEAR_MM = 9.0
"""Distance along a face from which an extension line may come."""
TOOLED = ("pilot hole of the screw", "hole of the screw", "bore of the joint's pin")
"""Holes that are drilled or reamed after the print."""
VARIANTS = (
    ("fsr400", ()),
    ("adult_finger", ()),
    ("child_thumb", ()),
    ("adult_finger", ("mold.method=sleeve",)),
    ("fsr400", ("mold.method=sleeve", "bone.interface=socket", "bone.base_length_mm=31")),
    ("fsr400", ("bone.interface=flange", "bone.base_length_mm=27")),
)


def normals(mesh: Mesh) -> tuple[Array, Array]:
    corners = mesh.vertices[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners, normal / np.linalg.norm(normal, axis=1, keepdims=True)


def outward(corners: Array, normal: Array, size: Length, end: int) -> float | None:
    """Direction, +1 or -1, in which the face at an end of a length looks along its axis; None if there is no face.

    Of the facets that lie across the axis and reach this station, the one nearest to the stated point counts.
    """
    i, point = AXES[size.axis], np.array((size.start, size.end)[end])
    reaches = (np.abs(corners[:, :, i] - point[i]) < _ON_FACE_MM).any(axis=1) & (np.abs(normal[:, i]) > 0.9)
    if not reaches.any():
        return None
    distance = distance_to_triangles(point, corners[reaches], normal[reaches])
    nearest = distance.argmin()
    return float(np.sign(normal[reaches][nearest, i])) if distance[nearest] < _NEAR_MM else None


def distance_to_triangles(point: Array, corners: Array, normal: Array) -> Array:
    """Distance of a point from each triangle: from its plane if the foot lies inside, else from its nearest side."""
    sides = np.roll(corners, -1, axis=1) - corners
    away = point - corners
    along = np.clip((away * sides).sum(axis=2) / np.maximum((sides * sides).sum(axis=2), 1e-12), 0.0, 1.0)
    distance = np.linalg.norm(away - along[:, :, None] * sides, axis=2).min(axis=1)
    inside = ((np.cross(sides, away) * normal[:, None]).sum(axis=2) >= 0.0).all(axis=1)
    return np.where(inside, np.abs((away[:, 0] * normal).sum(axis=1)), distance)


def growth_of(mesh: Mesh, size: Size) -> float:
    """Growth of a size over the printer's offset, if each face moves outwards by half of it."""
    corners, normal = normals(mesh)
    if isinstance(size, Circle) or size.is_diameter:
        return _growth_of_circle(corners, normal, size)
    i = AXES[size.axis]
    way = np.sign(size.end[i] - size.start[i])
    first, last = outward(corners, normal, size, 0), outward(corners, normal, size, 1)
    if "axis" in size.name or size.name in ("centre of the sensor", "first bolt"):
        last = None  # an axis may pass near a face
    return 0.5 * way * ((last or 0.0) - (first or 0.0))


def _growth_of_circle(corners: Array, normal: Array, size: Size) -> float:
    """Growth of a diameter: the facets on the circle look away from its axis, or towards it."""
    if isinstance(size, Circle):
        axis, centre, radius, factor = size.axis, np.array(size.centre), size.radius, 0.5 if size.is_radius else 1.0
    else:
        axis, centre, radius, factor = "y", (np.array(size.start) + np.array(size.end)) / 2, size.value / 2, 1.0
    others = [k for k in range(3) if k != AXES[axis]]
    radial = corners[:, :, others] - centre[others]
    on_circle = (np.abs(np.linalg.norm(radial, axis=2) - radius) < _ON_FACE_MM).sum(axis=1) >= 2
    towards = (normal[:, others] * radial.mean(axis=1)).sum(axis=1) / np.linalg.norm(radial.mean(axis=1), axis=1)
    side = on_circle & (np.abs(towards) > 0.5)
    assert side.any(), size.name
    return factor * float(np.sign(towards[side].sum()))


@pytest.mark.full
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: "-".join((variant[0], *variant[1])))
def test_growth_follows_from_the_faces_of_the_part(variant: tuple[str, tuple[str, ...]]) -> None:
    design = load_variant(variant).with_values({"mold.engraving_depth_mm": 0.0})
    evaluator, wrong = MeshEvaluator(0.01), []
    for drawing in part_drawings(design):
        mesh = evaluator.mesh(PARTS[drawing.part].solid(design))
        for size in drawing.sizes:
            if isinstance(size, Length) and (size.is_reference or size.name.startswith("spacing")):
                expected = 0.0
            else:
                expected = 0.0 if size.name in TOOLED else growth_of(mesh, size)
            if size.growth != expected:
                wrong.append(f"{drawing.part}: {size.name} grows {size.growth:g}, its faces say {expected:g}")
    assert not wrong


def calibrated(name: str, surface_error_mm: float = 0.05) -> Design:
    """Design as `fingertip calibrate printer` leaves it for a printer that prints too much."""
    from fingertip.calibration.printer import CLEARANCES

    plain = load_variant((name, ()))
    changes = {path: float(plain.value(path)) + surfaces / 2 * OFFSET_MM for path, surfaces in CLEARANCES.items()}
    changes |= {"printer.offset_mm": OFFSET_MM, "printer.scale_percent": 100.4}
    return plain.with_values(changes | {"printer.surface_error_mm": surface_error_mm})


def by_name(drawing: PartDrawing) -> dict[str, Size]:
    return {size.name: size for size in drawing.sizes}


def test_sheets_of_a_calibrated_design_state_the_sizes_that_the_plain_design_intends() -> None:
    """Pocket, traps, bolt holes and sockets are widened in the files, and print as before."""
    plain = {drawing.part: by_name(drawing) for drawing in part_drawings(load_variant(("fsr400", ())))}
    for drawing in part_drawings(calibrated("fsr400")):
        for name, size in by_name(drawing).items():
            if name in ("pocket of the sensor", "width of the slot", "bolt holes") or "nut traps across" in name:
                assert size.printed == pytest.approx(plain[drawing.part][name].printed), name
                assert size.value == pytest.approx(size.printed + OFFSET_MM)
                assert size.tolerance == pytest.approx(plain[drawing.part][name].tolerance), name
    sizes = by_name(part_drawings(calibrated("fsr400"))[0])
    assert sizes["width of the base"].printed == pytest.approx(sizes["width of the base"].value + OFFSET_MM)
    assert sizes["width of the base"].text() == "13.12 ±0.1"


@pytest.mark.parametrize("name", FILES)
def test_no_tolerance_is_narrower_than_calipers_tell(name: str) -> None:
    for design in (load_variant((name, ())), calibrated(name, surface_error_mm=0.011)):
        for drawing in part_drawings(design):
            for size in drawing.sizes:
                tolerance = size.tolerance or general(size.printed)
                half = (tolerance.high - tolerance.low) / 2
                assert half >= MIN_TOLERANCE_MM - 1e-9 or tolerance.text() == FIT, size.name
                if "width of the" in size.name and ("base" in size.name or "recess" in size.name):
                    assert tolerance.text() != FIT, "a size with a number of its own is measured"


def test_sizes_without_a_surface_stand_in_parentheses_and_are_not_checked() -> None:
    for variant in VARIANTS:
        for drawing in part_drawings(load_variant(variant)):
            references = [size for size in drawing.sizes if isinstance(size, Length) and size.is_reference]
            assert not [size.name for size in references if size.tolerance or size.action]
            assert all(size.text().startswith("(") and size.text().endswith(")") for size in references)
            assert not [size.name for size in drawing.sizes if size not in references and size.text().startswith("(")]
            if references:
                assert any("parentheses" in note for note in drawing.notes)


def limits_mm(size: Size | float) -> tuple[float, float, float]:
    """Least, stated and largest size [mm]; of a bought part all are one."""
    if isinstance(size, float):
        return size, size, size
    tolerance = size.tolerance or general(size.printed)
    return size.printed + tolerance.low, size.printed, size.printed + tolerance.high


@pytest.mark.parametrize("is_calibrated", [False, True])
@pytest.mark.parametrize("name", ["fsr400", "adult_finger"])
def test_tolerances_of_two_mating_parts_leave_half_of_their_play(name: str, is_calibrated: bool) -> None:
    design = calibrated(name) if is_calibrated else load_variant((name, ()))
    drawings = {drawing.part: by_name(drawing) for drawing in part_drawings(design)}
    bone, palmar, dorsal = (drawings[part] for part in ("bone", "mold_palmar", "mold_dorsal"))
    sensor, bolt_mm = design.dimensions.sensor, 3.0
    mates: list[tuple[Size | float, Size | float]] = [
        (bone["pocket of the sensor"], sensor.head_diameter_mm), (bone["width of the slot"], sensor.tail_width_mm),
        (dorsal["hole of the screw"], 2.0),
    ]  # fmt: skip
    assert bone["pilot hole of the screw"].text() == "Ø1.6 ±0.1", "the screw keeps three quarters of its bite"
    for which in ("larger", "smaller"):
        mates.append((palmar[f"{which} socket, at the parting plane"], dorsal[f"{which} key, at the parting plane"]))
    if "lid" in drawings:
        mates.append((sensor.tail_width_mm + 2 * design.sensor.clearance_mm - design.printer.offset_mm,
                      drawings["lid"]["width"]))  # fmt: skip
        mates.append((drawings["lid"]["length"].value + design.sensor.clearance_mm, drawings["lid"]["length"]))
        mates.append((bone["gap between the cheeks"], design.hand.width_mm))
        assert bone["bore of the joint's pin"].text() == "Ø2 0/-0.1", "it is reamed, never wider than the pin"
    else:
        mates.append((bone["hole of the cross bolt"], 2.0))
    for half in (palmar, dorsal):
        hole = half["bolt holes"]
        mates.append((hole, bolt_mm))
        for way in ("across", "along"):
            low, _, high = limits_mm(half[f"spacing of the bolts, {way}"])
            # The spacings of the halves differ by this at most, and their holes by half of it at either end.
            assert limits_mm(hole)[0] - (high - low) / 2 >= bolt_mm - 1e-9, "bolts pass both halves"
    for hole, shaft in mates:
        (least, stated_hole, _), (_, stated_shaft, largest) = limits_mm(hole), limits_mm(shaft)
        assert least - largest >= (stated_hole - stated_shaft) / 2 - 1e-9 > 0.0, (hole, shaft)
