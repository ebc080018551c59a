"""Figures of designs, compared whole with approved ones: sizes, solids, filling, checks, and the catalogues."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path

import numpy as np
import pytest
from fingertip.filling.mold_filling import gate_opening, list_ducts, predict_mold_filling, vent_cavity

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.settings import FDM, slicer_settings
from fingertip.cad.shapes.engraving import engraved_lines, omitted_lines
from fingertip.cad.shapes.skin import cavity
from fingertip.cad.shapes.mold import runners
from fingertip.cad.shapes.parts import hardware, parts_by_name
from fingertip.cad.verification.check import list_causes, list_warnings
from fingertip.casting.quantities import measure_poured_cm3
from fingertip.catalogues import amplifiers, print_materials, sensors, silicones
from fingertip.catalogues.controllers import load_controllers
from fingertip.catalogues.hardware import SYRINGES, THREADS, find_needle
from fingertip.design import Design
from fingertip.design.geometry.seat import list_contacts, tape_span_mm
from fingertip.design.interfaces import interface_of
from tests.approved import check_figures
from tests.cad.part_checks import run_all_checks
from tests.conftest import design_file, some_of

APPROVED = Path(__file__).parent / "approved"
CHANGES = {
    "fsr400": "",
    "fsr402": "",
    "fsr400_compact": "",
    "adult_finger": "",
    "socket": "bone.interface=socket bone.base_length_mm=32 mold.seat_tape_mm=0 name=forty_" + 34 * "x",
    "flange": "bone.interface=flange bone.base_length_mm=26 bone.flange_spacing_y_mm=12 bone.flange_height_mm=18",
    "free": "mold.chaplet_diameter_mm=0 mold.fit_clearance_mm=0.01 printer.surface_error_mm=0",
    "clevis": "sensor.model=fsr402 sensor.tail=folded skin.length_mm=31.9 bone.base_length_mm=10.1 bone.wall_mm=0.8 "
    "bone.groove_depth_mm=0 bone.interface=clevis bone.collar_length_mm=5 mold.recess_length_mm=6.2 hand.width_mm=9 "
    "hand.pin_diameter_mm=2.5 hand.axis_height_mm=8 hand.travel_deg=55 skin.min_thickness_mm=0.7 "
    "strength.min_grip_factor=1 strength.min_shock_factor=1 hand.tendon_distance_mm=6.05 mold.chaplet_diameter_mm=4.2 "
    "mold.chaplet_from_tip_mm=6.7 mold.fit_clearance_mm=0.04 skin.crown_drop_mm=1.7 skin.thickness_side_mm=1.79 "
    "bone.palmar_fullness=0.99 sensor.distance_from_tip_mm=14.4 bone.platform_mm=1.07 sensor.insert=disc",
    "fork": "hand.knuckle=fork bone.base_length_mm=14.3 strength.min_grip_factor=1 strength.min_shock_factor=0",
}
"""Changes of each design; those without are bundled ones."""
BASE = {"fork": "youth_thumb", "clevis": "fsr402"}
WITH_PLAY = ("fsr400", "free")


def render(value: object) -> str:
    """Write a value with six digits of each number; of an object, its name and its fields."""
    match value:
        case bool() | None | str():
            return repr(value)
        case float():
            return f"{value:.6g}" if abs(value) > 1e-12 else "0"
        case int():
            return str(value)
        case tuple() | list():
            return f"({', '.join(map(render, value))})"
        case Mapping():
            return f"{{{', '.join(f'{key}: {render(item)}' for key, item in value.items())}}}"
    if dataclasses.is_dataclass(value):
        fields = (f"{field.name}={render(getattr(value, field.name))}" for field in dataclasses.fields(value))
        return f"{type(value).__name__}({', '.join(fields)})"
    return str(value)


def list_properties(value: object) -> Iterator[str]:
    """Yield a line for each property of an object, in the order of its classes, the base first."""
    members = (item for kind in reversed(type(value).__mro__) for item in vars(kind).items())
    for name, member in members:
        if isinstance(member, (property, cached_property)) and not name.startswith("_"):
            yield f"{name} = {render(getattr(value, name))}"


"""Designs whose contacts in the mold and losses of silicone are compared."""


@cache
def load(name: str) -> Design:
    base = BASE.get(name, "fsr400") if CHANGES[name] else name
    return Design.load(design_file(base), changes=CHANGES[name].split())


def list_sizes(design: Design) -> Iterator[str]:
    yield from list_properties(design.dimensions)
    yield from list_properties(design.mold_layout)
    interface, low_z = interface_of(design), -design.dimensions.full_base_length
    yield f"interface {type(interface).__name__}, genus {interface.genus(design)}"
    for z in (0.7 * low_z, low_z + 0.5):
        factors = interface.moment_share(design, z), interface.stress_factors(design, z)
        yield f"at {render(z)}: {render(factors)}"
    yield from (render(stress) for stress in interface.local_stresses(design, 20.0))
    yield from (render(size) for size in interface.sizes(design))
    if design in map(load, WITH_PLAY):
        yield from map(render, list_contacts(design, design.dimensions))
        yield from (f"{render(loss.point)} loses {render(loss.loss_mm)}" for loss in design.losses)
    yield f"tape span {render(tape_span_mm(design))}"


def list_solids(design: Design) -> Iterator[str]:
    """Volume, area, bounding box and moment of volume of each solid: what is moved or mirrored changes the last."""
    evaluator = MeshEvaluator(0.05)
    parts = parts_by_name(design)
    solids = {name: part.solid(design) for name, part in parts.items()}
    solids |= {item.name: item.solid for item in hardware(design, list(parts))}
    solids |= {"cavity": cavity(design)}
    solids |= {f"runner {number}": solid for number, solid in enumerate(runners(design))}
    for name, solid in solids.items():
        body, mesh = evaluator.manifold(solid), evaluator.mesh(solid)
        corners = mesh.vertices[mesh.triangles]
        moment = np.linalg.det(corners) @ corners.sum(axis=1) / 24.0
        moment[abs(moment) < 1e-3] = 0.0  # what remains of two equal halves
        figures = mesh.volume(), mesh.area(), body.bounding_box(), moment.tolist()
        yield f"{name}: genus {body.genus()}, {render(figures)}"
    yield f"poured {render(measure_poured_cm3(design, evaluator))}"
    yield from (render(line) for half in ("palmar", "dorsal") for line in engraved_lines(design, half))
    yield f"not engraved: {omitted_lines(design)}"
    supports = supports_by_part(design)
    for name, pose in print_orientations(design).items():
        yield f"{name}: {render(pose)}, {slicer_settings(FDM, name, pose, supports[name])}, {supports[name].note}"


def list_filling(design: Design) -> Iterator[str]:
    yield render(gate_opening(design))
    yield from (render(duct) for duct in list_ducts(design))
    yield render(vent_cavity(design))
    found = predict_mold_filling(design)
    yield from list_properties(found)
    for field, value in vars(found).items():
        if np.ndim(value) == 0 or isinstance(value, tuple):
            yield f"{field} = {render(value)}"


@pytest.mark.every_case
@pytest.mark.parametrize("name", CHANGES)
@pytest.mark.parametrize("list_figures", [list_sizes, list_solids, list_filling])
def test_figures_of_designs_are_the_approved_ones(name: str, list_figures: Callable[[Design], Iterator[str]]) -> None:
    kind = list_figures.__name__.removeprefix("list_")
    check_figures(APPROVED / f"{name}_{kind}.txt", list_figures(load(name)), 1e-4, 1e-4)


@pytest.mark.every_case
@pytest.mark.parametrize("name", some_of(sorted(CHANGES.keys() - {"free"}), "clevis", "fsr400"))
def test_values_of_checks_are_the_approved_ones(name: str) -> None:
    """Each check names the parameters to change, or none where its failure would be a fault of the program.

    A warning fits on two lines of a terminal.
    """
    lines, checks = [], run_all_checks(load(name))
    assert [check.name for check in checks.values() if not check.passed] == []
    for check in checks.values():
        lines.append(f"{check.name}: {render(check.value)} {check.sign} {render(check.limit)} {check.unit}")
        assert isinstance(list_causes(check.name), tuple)
        assert all(len(text) <= 160 for text in list_warnings([check])), check.warning
    check_figures(APPROVED / f"{name}_checks.txt", lines, 1e-3, 1e-3)


def test_catalogues_are_the_approved_ones() -> None:
    """Each figure is entered a second time, from the document that its entry names."""
    entries = [
        *silicones.load_silicones().values(), *sensors.CATALOGUE.values(), *amplifiers.CATALOGUE.values(),
        *print_materials.PRINT_MATERIALS.values(), *load_controllers(), *THREADS, *SYRINGES.values(),
    ]  # fmt: skip
    needles = [f"needle for {hole} mm: {render(find_needle(hole))}" for hole in (0.9, 1.1, 1.3, 1.6, 2.0, 2.4)]
    check_figures(APPROVED / "catalogues.txt", [*map(render, entries), *needles], 0.0, 0.0)
