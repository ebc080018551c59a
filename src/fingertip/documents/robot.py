"""README beside the model of a finger for simulators, and the figures in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fingertip.catalogues.output_files import README, ROBOT_FILES
from fingertip.design.finger_set import FingerSet
from fingertip.documents.template import WIDTH, render_page
from fingertip.robot.contact import FACET_MM, FORCES_N, REFERENCE_N, SPACING_MM
from fingertip.robot.formats import MAX_SPEED_RAD_S, TIMESTEP_S
from fingertip.robot.model import TOLERANCE_MM, FingerModel


def describe_model(finger: FingerModel, file_format: str) -> dict[str, Any]:
    """Collect the figures of a model, as --json and the README state them; processors differ in digits far beyond."""
    inertia, contact, parts = finger.inertia, finger.contact, finger.bodies
    pieces, low_n, high_n = len(finger.pieces), FORCES_N[0], FORCES_N[-1]
    surface = "1 convex piece, its surface" if pieces == 1 else f"{pieces} convex pieces, their surface"
    figures = {
        "mass_kg": inertia.mass_kg, "centre_m": inertia.centre_m, "moments_kg_m2": inertia.moments_kg_m2,
        "parts": {part.name: [part.density_g_cm3, 1e-3 * part.density_g_cm3 * part.mesh.volume()] for part in parts},
        "tip_m": finger.tip_m, "sensor_m": finger.sensor_m, "offset_m": finger.offset_m,
        "travel_deg": finger.travel_deg, "stop_moment_n_m": finger.stop_moment_n_m, "collision_pieces": pieces,
        "collision_error_mm": finger.piece_error_mm, "contact_error": contact.error, "solimp": contact.solimp,
        "solref": contact.solref(contact.inverse_mass_per_kg), "inverse_mass_per_kg": contact.inverse_mass_per_kg,
        "friction": contact.friction, "torsion_m": contact.torsion_m,
        "stiffness_n_per_m": contact.pad_stiffness_n_per_m, "depths_mm": contact.depths_mm,
        "forces_n": contact.forces_n, "taxels": len(finger.taxels.points_mm),
        "below_interface_m": -1e-3 * float(finger.bodies[0].mesh.vertices[:, 2].min()) - finger.offset_m[2],
    }  # fmt: skip
    errors = f"Collision: {surface} within {finger.piece_error_mm:.2f} mm of the skin's outline."
    if file_format == "mjcf":
        errors += (
            f" Contact: force within {100 * contact.error:.1f} percent of that of the layer model of the pad over its "
            f"depth, from {low_n:g} to {high_n:g} N."
        )
    return {
        "design": finger.name, "format": file_format, "turns": finger.turns, "errors": errors, **_round(figures),
        "has_tendon": bool(finger.strands),
    }  # fmt: skip


def render_robot_readme(figures: Mapping[str, Any], fingers: Sequence[str]) -> str:
    """Render the README of a finger's model, or of the fingers of one form in the model of a set."""
    return render_page(
        "robot.md", WIDTH, **figures, fingers=fingers, file=ROBOT_FILES[figures["format"]], tolerance_mm=TOLERANCE_MM,
        reference_n=REFERENCE_N, timestep_s=TIMESTEP_S, pad_n=FORCES_N, spacing_mm=SPACING_MM, facet_mm=FACET_MM,
        speed_rad_s=MAX_SPEED_RAD_S,
    )  # fmt: skip


def render_set_readme(fingers: FingerSet, file: str, places_m: Mapping[str, float]) -> str:
    rows = [(name, form.design.name, places_m[name]) for name, form in fingers.fingers]
    return render_page("set_robot.md", WIDTH, name=fingers.name, side=fingers.side, file=file, rows=rows, readme=README)


def _round(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _round(inner) for key, inner in value.items()}
    if isinstance(value, float):
        return float(f"{value + 0.0:.6g}")
    return value if isinstance(value, int) else [_round(inner) for inner in value]
