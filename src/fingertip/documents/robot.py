"""README beside the model of a finger for simulators, and the figures in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.catalogues.output_files import README, ROBOT_FILES
from fingertip.design.finger_set import FingerSet
from fingertip.documents.template import WIDTH, render_page
from fingertip.models.solids import Point3
from fingertip.robot.collision_pieces import FACET_MM
from fingertip.robot.contact import FORCES_N, REFERENCE_N
from fingertip.robot.finger_model import TOLERANCE_MM, FingerModel
from fingertip.robot.formats import FRAME, MAX_SPEED_RAD_S, TIMESTEP_S
from fingertip.robot.tactile_mesh import SPACING_MM


@dataclass(frozen=True)
class ModelFigures:
    """Figures of a model, as --json and its README state them:
    processors differ in digits far beyond.
    """

    design: str
    format: str
    turns: bool
    errors: str
    """Sentences on how near collision pieces and contact are."""
    mass_kg: float
    centre_m: Point3
    moments_kg_m2: tuple[float, ...]
    parts: Mapping[str, tuple[float, float]]
    """Name of a part -> density [g/cm3] and mass [g]."""
    tip_m: Point3
    sensor_m: Point3
    offset_m: Point3
    travel_deg: float
    stop_moment_n_m: float
    collision_pieces: int
    collision_error_mm: float
    contact_error: float
    solimp: tuple[float, ...]
    solref: tuple[float, float]
    inverse_mass_per_kg: float
    friction: float
    torsion_m: float
    stiffness_n_per_m: float
    depths_mm: tuple[float, ...]
    forces_n: tuple[float, ...]
    taxels: int
    below_interface_m: float
    """Length of the bone beyond the interface."""
    has_tendon: bool
    stub_mass_kg: float
    """Mass of the stub of the hand; 0 without one."""


def describe_model(finger: FingerModel, file_format: str) -> ModelFigures:
    inertia = finger.inertia
    contact = finger.contact
    pieces = len(finger.collision.pieces)
    low_n = FORCES_N[0]
    high_n = FORCES_N[-1]
    surface = (
        "1 convex piece, its surface" if pieces == 1 else f"{pieces} convex pieces, their surface"
    )
    errors = (
        f"Collision: {surface} within {finger.collision.error_mm:.2f} mm of the skin's outline."
    )

    if file_format == "mjcf":
        errors += (
            f" Contact: force within {100 * contact.error:.1f} percent of that of the layer model "
            "of the pad over its "
            f"depth, from {low_n:g} to {high_n:g} N."
        )

    stub = finger.stub
    stub_mass_kg = 1e-6 * stub.density_g_cm3 * stub.mesh.volume() if stub else 0.0
    exact = ModelFigures(
        design=finger.name,
        format=file_format,
        turns=finger.joint.turns,
        errors=errors,
        mass_kg=inertia.mass_kg,
        centre_m=inertia.centre_m,
        moments_kg_m2=inertia.moments_kg_m2,
        parts={
            part.name: (part.density_g_cm3, 1e-3 * part.density_g_cm3 * part.mesh.volume())
            for part in finger.bodies
        },
        tip_m=finger.tip_m,
        sensor_m=finger.sensor.middle_m,
        offset_m=finger.offset_m,
        travel_deg=finger.joint.travel_deg,
        stop_moment_n_m=finger.joint.stop_moment_n_m,
        collision_pieces=pieces,
        collision_error_mm=finger.collision.error_mm,
        contact_error=contact.error,
        solimp=contact.solimp,
        solref=contact.solref(contact.inverse_mass_per_kg),
        inverse_mass_per_kg=contact.inverse_mass_per_kg,
        friction=contact.friction,
        torsion_m=contact.torsion_m,
        stiffness_n_per_m=contact.pad_stiffness_n_per_m,
        depths_mm=contact.depths_mm,
        forces_n=contact.forces_n,
        taxels=len(finger.sensor.taxels.points_mm),
        below_interface_m=-1e-3 * float(finger.bodies[0].mesh.vertices[:, 2].min())
        - finger.offset_m[2],
        has_tendon=bool(finger.strands),
        stub_mass_kg=stub_mass_kg,
    )
    return ModelFigures(**{name: _round(value) for name, value in vars(exact).items()})


def render_robot_readme(figures: ModelFigures, fingers: Sequence[str]) -> str:
    """Render the README of a finger's model, or of the fingers of one form in the model
    of a set.
    """
    return render_page(
        "robot.md",
        WIDTH,
        **vars(figures),
        fingers=fingers,
        file=ROBOT_FILES[figures.format],
        pad_n=FORCES_N,
        tolerance_mm=TOLERANCE_MM,
        reference_n=REFERENCE_N,
        timestep_s=TIMESTEP_S,
        spacing_mm=SPACING_MM,
        facet_mm=FACET_MM,
        speed_rad_s=MAX_SPEED_RAD_S,
        frame_mass_kg=FRAME.mass_kg,
    )


def render_set_readme(fingers: FingerSet, file: str, places_m: Mapping[str, float]) -> str:
    rows = [(name, form.design.name, places_m[name]) for name, form in fingers.fingers]
    return render_page(
        "set_robot.md",
        WIDTH,
        name=fingers.name,
        side=fingers.side,
        file=file,
        rows=rows,
        readme=README,
    )


def _round(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _round(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        return tuple(map(_round, value))

    return float(f"{value + 0.0:.6g}") if isinstance(value, float) else value
