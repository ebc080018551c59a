"""Sabotage of what is measured (walls, gaps, vents, stretch): broken in the geometry, its check must see it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.cad import printing
from fingertip.cad.printing import Orientation
from fingertip.cad.shapes import bone, parts
from fingertip.cad.shapes.core import inside_skin
from fingertip.cad.solids import Box, Cone, ElbowTube, cylinder, difference, union
from fingertip.cad.verification import leaning, measures
from fingertip.design import Design
from fingertip.design.cover import min_cover
from fingertip.design.tilt import loose_lean, thinnest_held
from tests.cad.measured import SLEEVE, SOCKET, failures, measured

THICK = ["sensor.model=custom", "custom_sensor.thickness_mm=1.2", "sensor.adhesive_thickness_mm=0.5"]


@pytest.mark.parametrize("changes", [[], SOCKET, SLEEVE, ["sensor.model=fsr400_short"], THICK], ids=str)
def test_nothing_fails_untouched(changes: list[str]) -> None:
    assert failures(*changes) == set()


def test_the_thinnest_skin_is_found_where_it_is() -> None:
    """1.5 mm on the back, less what the taper takes: nowhere else is this skin thinner."""
    assert measured()["skin.thinnest"].value == pytest.approx(1.5, abs=0.01)


@pytest.mark.parametrize("weight", [2.0, 2.3, 2.5])
def test_the_thinnest_skin_is_as_thin_as_the_rule_says(weight: float) -> None:
    """The bone's squarer edges come nearer than its sides; solids and sections find the same."""
    changes = [
        "skin.thickness_side_mm=1.2",
        "skin.min_thickness_mm=0.3",
        "mold.fit_clearance_mm=0.02",
        f"bone.squareness_palmar={weight}",
    ]
    expected = min_cover(Design.load(changes=changes).dimensions, 0.0)
    assert measured(*changes)["skin.thinnest"].value == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize("changes", [[], ["bone.squareness_palmar=2"], ["mold.fit_clearance_mm=0.2"]], ids=str)
def test_a_leaning_bone_leaves_what_the_rule_says(changes: list[str]) -> None:
    design = Design.load(changes=changes)
    expected = thinnest_held(design, design.dimensions)
    assert measured(*changes)["skin.thinnest_when_leaning"].value == pytest.approx(expected, abs=0.03)


def test_a_bone_that_nobody_holds_down(monkeypatch: pytest.MonkeyPatch) -> None:
    """It leans until the recess stops it, and comes nearer to the mold than any skin may be thin."""
    monkeypatch.setattr(leaning, "held_lean", lambda design, dims, x, y: loose_lean(design))
    assert failures() == {"skin.thinnest_when_leaning"}


def test_a_bump_that_is_low_enough_until_the_bone_leans(monkeypatch: pytest.MonkeyPatch) -> None:
    bump = cylinder("y", (20.0, 0.0), 0.0, 5.6, 0.8)
    for module in (measures, leaning):
        monkeypatch.setattr(module, "inside_skin", lambda design: union(inside_skin(design), bump))
    assert failures() == {"skin.thinnest_when_leaning"}


def test_a_bump_under_the_skin(monkeypatch: pytest.MonkeyPatch) -> None:
    bump = cylinder("y", (12.0, 0.0), 0.0, 6.4, 0.8)
    monkeypatch.setattr(measures, "inside_skin", lambda design: union(inside_skin(design), bump))
    assert failures() == {"skin.thinnest"}


def test_a_channel_too_near_the_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.cable_channel

    def sunk(design: Design) -> ElbowTube:
        tube = original(design)
        assert isinstance(tube, ElbowTube)
        return replace(tube, start_y=tube.start_y - 0.5)

    monkeypatch.setattr(bone, "cable_channel", sunk)
    assert failures() == {"bone.wall.channel_to_outside"}


def test_a_tie_hole_in_the_way_of_the_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def nearer(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(hole.centre[0] - 1.5, hole.centre[1] + 1.2))

    monkeypatch.setattr(bone, "tie_hole", nearer)
    assert failures() == {"bone.wall.channel_to_tie_hole"}


def test_a_pocket_that_leaves_no_rim(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    wide = Box((-5.3, -9.0, 20.0), (5.3, -2.3, 25.0))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: union(original(design), wide))
    assert "bone.wall.beside_sensor" in failures()


def test_a_pocket_that_squeezes_the_sensor(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    cheek = Box((3.85, -9.0, 20.0), (4.5, 9.0, 25.0))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: difference(original(design), cheek))
    assert failures() == {"sensor.room_in_pocket"}


def test_a_burr_on_the_seat(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    burr = Box((-0.3, -2.6, 22.0), (0.3, 0.0, 22.6))
    monkeypatch.setattr(bone, "sensor_recess", lambda design: difference(original(design), burr))
    assert failures() == {"sensor.room_in_pocket", "overlap.bone.sensor"}


def test_a_hole_in_the_seat(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.sensor_recess
    hole = cylinder("y", (21.0, 1.0), -5.0, -1.5, 0.5)
    monkeypatch.setattr(bone, "sensor_recess", lambda design: union(original(design), hole))
    assert failures() == {"sensor.unsupported"}


def test_a_socket_through_the_side(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def wider(design: Design) -> object:
        plus, (socket, *rest) = original(design)
        assert isinstance(socket, Cone)
        return plus, (replace(socket, low_radius=3.6, high_radius=3.6), *rest)

    monkeypatch.setattr(bone, "interface", wider)
    assert failures(*SOCKET) == {"bone.wall.socket_to_outside"}


def test_a_cross_bolt_in_the_way_of_the_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def higher(design: Design) -> object:
        plus, (hole,) = original(design)
        assert isinstance(hole, Cone)
        return plus, (replace(hole, centre=(3.0, -20.0)),)

    monkeypatch.setattr(bone, "interface", higher)
    assert "bone.wall.channel_to_interface" in failures()


def test_a_tie_hole_into_the_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.tie_hole

    def lower(design: Design) -> Cone:
        hole = original(design)
        assert isinstance(hole, Cone)
        return replace(hole, centre=(1.8, -11.0))

    monkeypatch.setattr(bone, "tie_hole", lower)
    assert failures() == {"bone.wall.sensor_to_tie_hole"}


def test_a_socket_into_the_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    original = bone.interface

    def deeper(design: Design) -> object:
        plus, (socket, *rest) = original(design)
        assert isinstance(socket, Cone)
        return plus, (replace(socket, high=-14.5), *rest)

    monkeypatch.setattr(bone, "interface", deeper)
    assert "bone.wall.socket_to_sensor" in failures(*SOCKET)


def test_a_vent_that_is_shut(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tail's passage through the collar is filled: air stays behind the sensor."""
    part = parts.PARTS["bone"]
    plug = Box((-4.0, -5.0, -3.0), (4.0, 1.0, 1.0))
    monkeypatch.setitem(parts.PARTS, "bone", replace(part, describe=lambda d: union(part.describe(d), plug)))
    assert failures() == {"sensor.vent_open_to_outside", "overlap.bone.sensor", "sensor.room_in_pocket"}


def test_parts_larger_than_the_printer() -> None:
    """The bone stands 62 mm high; the halves lie on a face of 42.4 x 50.1 mm, which may be turned by a quarter."""
    halves = {"mold_palmar.past_the_printer", "mold_dorsal.past_the_printer"}
    assert failures("printer.bed_z_mm=50") == {"bone.past_the_printer"}
    assert failures("printer.bed_x_mm=40") == halves
    assert failures("printer.bed_x_mm=43", "printer.bed_y_mm=51") == set()
    assert failures("printer.bed_x_mm=51", "printer.bed_y_mm=43") == set()


def test_parts_that_would_fit_only_as_they_do_not_lie(monkeypatch: pytest.MonkeyPatch) -> None:
    upright = Orientation(0.0, "its end", supports=False)
    lying = printing.orientations
    monkeypatch.setattr(printing, "orientations", lambda design: lying(design) | {"mold_palmar": upright})
    assert failures("printer.bed_x_mm=40") == {"mold_dorsal.past_the_printer"}


def test_a_sleeve_that_must_stretch_too_far() -> None:
    stretch = measured(*SLEEVE)["skin.stretch_to_strip"].value
    assert 5 < stretch < 50
    assert failures(*SLEEVE, f"mold.max_stretch_percent={stretch - 1}") == {"skin.stretch_to_strip"}
