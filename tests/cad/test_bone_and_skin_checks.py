"""Each check of bone, sensor and skin fails when the feature it verifies is broken."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing import orientations
from fingertip.cad.printing.orientations import Orientation
from fingertip.cad.shapes import bone, parts
from fingertip.cad.shapes.insert import skin, skin_interior
from fingertip.cad.verification import skin as skin_checks
from fingertip.cad.verification.skin import check_skin
from fingertip.design import Design
from fingertip.design.geometry.seat import find_losses, min_skin_thickness, worst
from fingertip.design.geometry.solids import Box, Cone, ElbowTube, cylinder, difference, union
from fingertip.design.interfaces import INTERFACES
from fingertip.foundation.errors import DesignError
from tests.cad.part_checks import SLEEVE, SOCKET, TOLERANCE, failed_checks, run_checks

THICK = [
    "sensor.model=custom", "custom_sensor.thickness_mm=1.2", "sensor.adhesive_thickness_mm=0.5",
    "mold.chaplet_screw=M1.6", "mold.chaplet_diameter_mm=5",
]  # fmt: skip


def replace_shapes(monkeypatch: pytest.MonkeyPatch, name: str, changed: Callable[[Design], object]) -> None:
    """Replace the shapes of an interface."""
    monkeypatch.setattr(INTERFACES[name], "shapes", changed)


@pytest.mark.full
@pytest.mark.parametrize("changes", [[], SOCKET, SLEEVE, ["sensor.model=fsr400_short"], THICK], ids=str)
def test_unmodified_design_passes_all_checks(changes: list[str]) -> None:
    assert failed_checks(*changes) == set()


@pytest.mark.full
def test_min_skin_thickness_of_the_default_design() -> None:
    """The default skin is thinnest on the dorsal side, with 1.5 mm reduced by the taper."""
    assert run_checks()["skin.min_thickness"].value == pytest.approx(1.5, abs=0.01)


@pytest.mark.full
@pytest.mark.parametrize("fullness", [0.9721, 0.9784, 0.9815])
def test_min_skin_thickness_agrees_with_the_design_rule(fullness: float) -> None:
    """The squarer edges of the bone are closer to the surface than its sides; meshes and sections agree."""
    changes = [
        "skin.thickness_side_mm=1.2",
        "skin.min_thickness_mm=0.3",
        "mold.fit_clearance_mm=0.02",
        "printer.surface_error_mm=0",
        f"bone.palmar_fullness={fullness}",
    ]
    expected = min_skin_thickness(Design.load(changes=changes).dimensions, 0.0)
    assert run_checks(*changes)["skin.min_thickness"].value == pytest.approx(expected, abs=0.01)


@pytest.mark.full
@pytest.mark.parametrize("changes", [[], ["bone.palmar_fullness=0.9721"], ["mold.fit_clearance_mm=0.1"]], ids=str)
def test_misaligned_skin_thickness_agrees_with_the_design_rule(changes: list[str]) -> None:
    """The bone is moved on the meshes as the linear program says; the rule measures its sections."""
    losses = Design.load(changes=changes).losses
    expected = min(loss.left_mm for loss in losses)
    checks = run_checks(*changes)
    assert checks["skin.min_thickness_misaligned"].value == pytest.approx(expected, abs=0.05)
    assert checks["skin.retained_over_sensor"].value == pytest.approx(100 * worst(losses, True).retained)
    assert checks["skin.retained_elsewhere"].value == pytest.approx(100 * worst(losses, False).retained)


def test_loose_bone_leaves_too_thin_a_skin(monkeypatch: pytest.MonkeyPatch) -> None:
    """A play of 0.4 mm on every side moves the bone further than the rules allow."""
    design, evaluator = Design(), MeshEvaluator(TOLERANCE)
    monkeypatch.setitem(vars(design), "losses", find_losses(design, design.dimensions, 0.4))
    checks = check_skin(design, evaluator, evaluator.mesh(skin(design)))
    assert "skin.retained_elsewhere" in {check.name for check in checks if not check.passed}


def test_larger_clearance_loses_thickness_and_is_refused() -> None:
    tight, loose = (find_losses(Design(), Design().dimensions, clearance) for clearance in (0.05, 0.3))
    assert worst(loose, True).retained < worst(tight, True).retained
    assert worst(loose, False).retained < 0.8 < worst(tight, False).retained
    with pytest.raises(DesignError, match=r"0\.3 mm lets bone or core lie off until .* are needed; at most 0\.\d+ mm"):
        Design.load(changes=["mold.fit_clearance_mm=0.3", "bone.collar_inset_mm=1"])


@pytest.mark.full
def test_bump_that_matters_only_when_misaligned_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    bump = cylinder("y", (12.0, 0.0), 0.0, 5.9, 0.8)
    monkeypatch.setattr(skin_checks, "skin_interior", lambda design: union(skin_interior(design), bump))
    assert failed_checks() == {"skin.min_thickness_misaligned"}


@pytest.mark.full
def test_bump_under_the_skin_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    bump = cylinder("y", (12.0, 0.0), 0.0, 6.4, 0.8)
    monkeypatch.setattr(skin_checks, "skin_interior", lambda design: union(skin_interior(design), bump))
    assert failed_checks() == {"skin.min_thickness", "skin.min_thickness_misaligned"}


@pytest.mark.full
def test_channel_too_close_to_the_surface_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.cable_channel

    def sunk(design: Design) -> ElbowTube:
        tube = original(design)
        assert isinstance(tube, ElbowTube)
        return replace(tube, start_y=tube.start_y - 0.5)

    monkeypatch.setattr(bone, "cable_channel", sunk)
    assert failed_checks() == {"bone.wall.channel_to_outside"}


@pytest.mark.full
def test_tie_hole_too_close_to_the_channel_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def nearer(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(hole.centre[0] - 1.5, hole.centre[1] + 1.2))

    monkeypatch.setattr(bone, "tie_hole", nearer)
    assert failed_checks() == {"bone.wall.channel_to_tie_hole"}


@pytest.mark.full
def test_pocket_without_a_rim_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    wide = Box((-5.3, -9.0, 20.0), (5.3, -2.3, 25.0))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: union(original(design), wide))
    assert "bone.wall.sensor_to_outside" in failed_checks()


@pytest.mark.full
def test_pocket_without_clearance_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    cheek = Box((3.85, -9.0, 20.0), (4.5, 9.0, 25.0))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: difference(original(design), cheek))
    assert failed_checks() == {"sensor.pocket_clearance"}


@pytest.mark.full
def test_burr_on_the_seat_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    burr = Box((-0.3, -2.6, 22.0), (0.3, 0.0, 22.6))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: difference(original(design), burr))
    assert failed_checks() == {"sensor.pocket_clearance", "overlap.bone.sensor"}


@pytest.mark.full
def test_hole_in_the_seat_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    hole = cylinder("y", (21.0, 1.0), -5.0, -1.5, 0.5)
    monkeypatch.setattr(bone, "sensor_recess", lambda design: union(original(design), hole))
    assert failed_checks() == {"sensor.unsupported_area"}


@pytest.mark.full
def test_socket_too_close_to_the_outside_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = INTERFACES["socket"].shapes

    def wider(design: Design) -> object:
        added, (socket, *others) = original(design)
        assert isinstance(socket, Cone)
        return added, (replace(socket, low_radius=3.6, high_radius=3.6), *others)

    replace_shapes(monkeypatch, "socket", wider)
    assert failed_checks(*SOCKET) == {"bone.wall.socket_to_outside"}


@pytest.mark.full
def test_cross_bolt_too_close_to_the_channel_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = INTERFACES["post"].shapes

    def higher(design: Design) -> object:
        added, (hole,) = original(design)
        assert isinstance(hole, Cone)
        return added, (replace(hole, centre=(3.0, -20.0)),)

    replace_shapes(monkeypatch, "post", higher)
    assert "bone.wall.channel_to_interface" in failed_checks()


@pytest.mark.full
def test_tie_hole_too_close_to_the_solder_relief_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def lower(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(1.8, -11.0))

    monkeypatch.setattr(bone, "tie_hole", lower)
    assert failed_checks() == {"bone.wall.sensor_to_tie_hole"}


@pytest.mark.full
def test_socket_too_close_to_the_solder_relief_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    original = INTERFACES["socket"].shapes

    def deeper(design: Design) -> object:
        added, (socket, *others) = original(design)
        assert isinstance(socket, Cone)
        return added, (replace(socket, high=-14.5), *others)

    replace_shapes(monkeypatch, "socket", deeper)
    assert "bone.wall.socket_to_sensor" in failed_checks(*SOCKET)


@pytest.mark.full
def test_closed_air_vent_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the tail's passage through the collar filled, air is trapped behind the sensor."""
    part = parts.PARTS["bone"]
    plug = Box((-4.0, -5.0, -3.0), (4.0, 1.0, 1.0))
    monkeypatch.setitem(parts.PARTS, "bone", replace(part, solid=lambda d: union(part.solid(d), plug)))
    assert failed_checks() == {"sensor.air_volumes", "overlap.bone.sensor", "sensor.pocket_clearance", "bone.overhang"}


@pytest.mark.full
def test_parts_larger_than_the_build_volume_fail() -> None:
    """The bone is 62 mm high. The halves lie on a face of 42.4 x 50.1 mm and may be rotated by 90 degrees."""
    halves = {"mold_palmar.build_volume_excess", "mold_dorsal.build_volume_excess"}
    assert failed_checks("printer.bed_z_mm=50") == {"bone.build_volume_excess"}
    assert failed_checks("printer.bed_x_mm=40") == halves
    assert failed_checks("printer.bed_x_mm=43", "printer.bed_y_mm=51") == set()
    assert failed_checks("printer.bed_x_mm=51", "printer.bed_y_mm=43") == set()


@pytest.mark.full
def test_build_volume_is_checked_in_the_print_orientation(monkeypatch: pytest.MonkeyPatch) -> None:
    upright = Orientation(0.0, "its end", needs_supports=False)
    original = orientations.print_orientations
    monkeypatch.setattr(orientations, "print_orientations", lambda design: original(design) | {"mold_palmar": upright})
    assert failed_checks("printer.bed_x_mm=40") == {"mold_dorsal.build_volume_excess"}


@pytest.mark.full
def test_sleeve_that_must_stretch_too_far_fails() -> None:
    stretch = run_checks(*SLEEVE)["skin.fitting_stretch"].value
    assert 5 < stretch < 50
    assert failed_checks(*SLEEVE, f"mold.max_stretch_percent={stretch - 1}") == {"skin.fitting_stretch"}
