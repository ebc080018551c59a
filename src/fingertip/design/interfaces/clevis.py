"""Clevis: the eyes of the bone about the joint's pin, their hard stops, and the anchor of the
tendon.

A load on the fingertip turns it about the pin. On a straight finger a hard stop holds it, and the
pin then pulls at the ends of the eyes. On a bent one the tendon holds it: each strand presses on
the horn over which it turns, and the eyes press on the pin. Forces are those of statics; stresses
are nominal ones of a lug with a pin (net section, bearing, shear-out), the first with the
concentration that finite elements with contact found at its bore.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.design.formulas.stress_and_knock import (
    AT_CORNER,
    CORNER_REACH_MM,
    PIN,
    PIN_IN_EYE,
    STEEL_IN_EYE,
    STEEL_MPA,
    VON_MISES_SHEAR,
    LocalStress,
    StressFactors,
    at_foot,
    pin_peak,
)
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.sizes import (
    ARROW_DEG,
    BEFORE_FACE,
    BEHIND_FACE,
    FINISHED,
    INNER,
    OUTER,
    STEP,
    Circle,
    Length,
    Size,
    bore,
    clearance,
    general,
    size_text,
)
from fingertip.design.interfaces.interface import JointInterface
from fingertip.models import clevis as clevis_models
from fingertip.models.dimensions import Dimensions
from fingertip.models.joint import BESIDE_LINE_MM, Joint, TendonAnchor
from fingertip.models.solids import Point3


class Clevis(JointInterface):
    """Joint with a pin, whose sizes stand in the table [hand]."""

    name = "clevis"
    face_on_plate = weakest = "the eyes of the joint"
    supports_below = "around the eyes of the joint"

    def genus(self, design: DesignTables) -> int:
        """Count a hole in each cheek of a fork, or that of a tongue."""
        return 2 if _joint_of(design).is_fork else 1

    def depth(self, design: DesignTables) -> float:
        joint = _joint_of(design)
        # Without stops the base ends dorsal to the eyes too.
        step = 0.0 if joint.travel_deg else joint.foot
        return joint.radius + joint.clearance + step

    def low_z(self, design: DesignTables) -> float:
        joint = _joint_of(design)
        return joint.low_z if joint.travel_deg else joint.axis_z - joint.eye_radius

    def features(self, design: DesignTables) -> Iterator[tuple[str, tuple[float, float]]]:
        joint = _joint_of(design)
        anchor = design.dimensions.anchor
        yield "joint", (joint.axis_z, joint.axis_y)
        if anchor:
            yield "tendon's groove", (anchor.z, design.dimensions.bone_outline.section.dorsal)

    def beam_begin_z(self, design: DesignTables, low_z: float) -> float:
        """Past the pin only the joint's own forces act, which are assessed for themselves."""
        joint = _joint_of(design)
        return joint.axis_z + joint.pin_radius

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        """Find the factors at the root of the eyes, and at the groove of the tendon."""
        joint = _joint_of(design)
        anchor = design.dimensions.anchor
        section = design.dimensions.collar.section
        base = 2 * section.half_width, section.dorsal + section.palmar
        width = base[0] if joint.is_fork else 2 * joint.half_width
        height = base[1] if joint.travel_deg else 2 * joint.eye_radius
        factors = at_foot(base, (width, height), joint.foot, joint.shoulder_z - z)
        if anchor and 0.0 <= z - anchor.low_z <= CORNER_REACH_MM:
            return factors.combined_with(AT_CORNER)

        return factors

    def local_stresses(self, design: DesignTables, load_z: float) -> Iterator[LocalStress]:
        """Yield the stresses of eyes and anchor, in the plane in which the finger bends."""
        joint = _joint_of(design)
        anchor = design.dimensions.anchor
        thickness = _eye_thickness(design.dimensions, joint)
        # A pin that is printed standing of the bone's material shears across its layers beside both
        # cheeks.
        is_printed = design.hand.pin == "printed"
        shears = VON_MISES_SHEAR / (2 * math.pi * joint.printed_pin_radius**2)

        if joint.travel_deg:
            # The stop pushes the finger away from the hand, and the pin holds it, besides the load
            # itself. The pressure on the stop grows outwards, so its force acts at two thirds of
            # the length.
            pull = (load_z - joint.axis_z) / (2 / 3 * clevis_models.stop_height_mm(design)) + 1.0
            if is_printed:
                yield LocalStress(PIN, joint.axis_z, shears * pull, at_knock=False)

            eye, factor, end = _eye_stresses(design)
            yield LocalStress("eye", joint.axis_z, eye * pull, factor)
            yield LocalStress("end of the eye", joint.low_z, end * pull)

        if anchor:
            force = tendon_force_per_n(design, load_z)
            if is_printed:
                yield LocalStress(
                    f"{PIN}, by the tendon", joint.axis_z, shears * (force + 1.0), at_knock=False
                )

            yield LocalStress(
                "bearing of the pin",
                joint.axis_z,
                (force + 1.0) / (thickness * 2 * joint.pin_radius),
                at_knock=False,
            )
            line_load = force / 2 / anchor.horn_radius / anchor.line
            yield LocalStress("horn of the tendon", anchor.low_z, line_load, at_knock=False)

    def sizes(self, design: DesignTables) -> list[Size]:
        joint = _joint_of(design)
        y = joint.axis_y
        z = joint.axis_z
        half = joint.half_width
        across = design.dimensions.bone_outline.section.half_width
        place = "gap between the cheeks" if joint.is_fork else "width of the tongue"
        remedy = (
            "narrow: file it until the hand's tongue turns"
            if joint.is_fork
            else "wide: sand it until it turns"
        )
        pin: Point3 = (across, y, z)
        sizes: list[Size] = [
            Length(
                name="skin's end to the joint axis",
                growth=BEHIND_FACE,
                view="front",
                side="below",
                axis="z",
                start=(across, 0.0, 0.0),
                end=pin,
            ),
            Circle(
                name="bore of the joint's pin",
                growth=FINISHED,
                view="front",
                axis="x",
                centre=pin,
                radius=joint.pin_radius,
                tolerance=bore(design),
                action="narrow: ream it to the pin; wide: take a thicker pin, or a bush",
            ),
            Circle(
                name="eyes of the joint",
                growth=BEHIND_FACE,
                view="front",
                axis="x",
                centre=pin,
                radius=joint.eye_radius,
                is_radius=True,
                hidden_deg=_beside_stops_deg(joint),
            ),
            Length(
                name=place,
                growth=INNER if joint.is_fork else OUTER,
                view="end",
                side="below",
                axis="x",
                start=(half, y, z),
                end=(-half, y, z),
                tolerance=clearance(2 * joint.clearance - design.printer.offset_mm),
                action=remedy,
            ),
        ]

        if joint.is_fork:
            beside = z - (joint.pin_radius + joint.eye_radius) / 2
            sizes.append(
                Length(
                    name="thickness of each eye beside the bore",
                    growth=OUTER,
                    view="end",
                    side="below",
                    axis="x",
                    start=(half, y, beside),
                    end=(design.dimensions.eyes.half_width_at(y), y, beside),
                )
            )

        if joint.foot:
            corner = (across, y - joint.eye_radius - joint.foot, joint.shoulder_z - joint.foot)
            sizes.append(
                Circle(
                    name="fillet at the root of the eyes",
                    growth=BEFORE_FACE,
                    view="front",
                    axis="x",
                    centre=corner,
                    radius=joint.foot,
                    is_radius=True,
                    hidden_deg=((88.0, 420.0),),
                )
            )

        if abs(y) > 1e-6:
            sizes.append(
                Length(
                    name="height of the joint axis",
                    growth=STEP,
                    view="front",
                    side="left",
                    axis="y",
                    start=(across, 0.0, z),
                    end=pin,
                    is_reference=True,
                )
            )
        if joint.travel_deg and (top := design.dimensions.stops_top_z) is not None:
            sizes += self._stop_sizes(design, joint, top)

        anchor = design.dimensions.anchor
        if anchor:
            sizes += self._anchor_sizes(design, anchor, pin)

        return sizes

    def _stop_sizes(self, design: DesignTables, joint: Joint, top: float) -> list[Size]:
        """List the sizes of eyes and stops."""
        half = design.dimensions.collar.section.half_width
        y = joint.axis_y
        bore = joint.axis_z - joint.pin_radius
        sizes: list[Size] = [
            Length(
                name="edge of the bore to the straight stop",
                growth=OUTER,
                view="front",
                side="above",
                axis="z",
                start=(half, y, bore),
                end=(half, y, joint.low_z),
                tolerance=general(bore - joint.low_z),
                action="long: file both flats alike; short: it stops too late, print again",
            ),
            Length(
                name="height of the eyes",
                growth=OUTER,
                view="end",
                side="left",
                axis="y",
                start=(joint.half_width, clevis_models.stop_toe_y(design, joint, top), joint.low_z),
                end=(joint.half_width, clevis_models.stop_top_y(design, joint), joint.low_z),
            ),
        ]

        if joint.is_fork:
            at = (0.0, joint.axis_z)
            sizes.append(
                Length(
                    name="width across the eyes",
                    growth=OUTER,
                    view="end",
                    side="above",
                    axis="x",
                    start=(half, *at),
                    end=(-half, *at),
                )
            )

        return sizes

    def notes(self, design: DesignTables) -> tuple[str, ...]:
        joint = _joint_of(design)
        if not joint.travel_deg:
            return ()

        away = size_text(joint.radius - joint.pin_radius)
        return (
            f"Flat of the bent stop: {away} from the edge of the bore like the straight",
            f"one, and turned towards the palm by {joint.travel_deg:g} degrees.",
        )

    def _anchor_sizes(self, design: DesignTables, anchor: TendonAnchor, pin: Point3) -> list[Size]:
        """List the sizes of the tendon's groove and horns."""
        side = anchor.half_width, 0.0, anchor.low_z
        return [
            Length(
                name="groove of the tendon",
                growth=INNER,
                view="front",
                side="above",
                axis="z",
                start=side,
                end=(side[0], 0.0, anchor.high_z),
                tolerance=clearance(BESIDE_LINE_MM),
                action="narrow: file it until the tendon lies in it",
            ),
            Length(
                name="base between the strands",
                growth=OUTER,
                view="end",
                side="below",
                axis="x",
                start=side,
                end=(-side[0], 0.0, anchor.low_z),
            ),
            Length(
                name="horns to the joint axis",
                growth=STEP,
                view="front",
                side="right",
                axis="y",
                start=(pin[0], anchor.horn_y, anchor.horn_low_z),
                end=pin,
                tolerance=general(anchor.distance),
            ),
            Circle(
                name="horns of the tendon",
                growth=BEHIND_FACE,
                view="front",
                axis="x",
                centre=(pin[0], anchor.horn_y + anchor.horn_radius, anchor.horn_low_z),
                radius=anchor.horn_radius,
                is_radius=True,
                hidden_deg=((-180.0, 90.0),),
                action="sharp: round it with fine paper, or it cuts the tendon",
            ),
        ]


def _joint_of(design: DesignTables) -> Joint:
    joint = design.dimensions.joint
    assert joint
    return joint


def _beside_stops_deg(joint: Joint) -> tuple[tuple[float, float], ...]:
    """Directions in the front view in which the eyes are not round: all but those between the
    stops.
    """
    if not joint.travel_deg:
        return ((-90.0, 90.0),)

    beside = ARROW_DEG - clevis_models.ramp_angle_deg(joint)
    return ((180.0 + joint.travel_deg - beside, 540.0 + beside),)


def tendon_force_per_n(design: DesignTables, load_z_mm: float) -> float:
    """Force of the tendon per newton of load on the pad or apex, by their levers about the pin; 0
    without a tendon.
    """
    joint = design.dimensions.joint
    anchor = design.dimensions.anchor
    return (load_z_mm - joint.axis_z) / anchor.distance if joint and anchor else 0.0


def _eye_stresses(design: DesignTables) -> tuple[float, float, float]:
    """Stress of the eyes per newton on the pin [MPa/N], its concentration, and the stress of their
    ends.
    """
    joint = _joint_of(design)
    anchor = design.dimensions.anchor
    thickness = _eye_thickness(design.dimensions, joint)
    palmar = (
        min(joint.eye_radius, anchor.distance - anchor.line / 2) if anchor else joint.eye_radius
    )
    width = joint.eye_radius + palmar
    bore = 2 * joint.pin_radius
    factor = PIN_IN_EYE * pin_peak(thickness / 2, bore)

    if design.hand.pin == "steel":
        factor = STEEL_IN_EYE * pin_peak(
            thickness / 2, bore, STEEL_MPA / design.strength.material.modulus_mpa
        )

    shear = VON_MISES_SHEAR / (2 * thickness * (joint.eye_radius - joint.pin_radius))
    return factor / (thickness * (width - bore)), factor, shear


def _eye_thickness(dims: Dimensions, joint: Joint) -> float:
    """Thickness [mm] of both cheeks beside the pin, or of the tongue."""
    if not joint.is_fork:
        return 2 * joint.half_width

    edges = (joint.axis_y - joint.pin_radius, joint.axis_y + joint.pin_radius)
    return 2 * (min(dims.eyes.half_width_at(y) for y in edges) - joint.half_width)
