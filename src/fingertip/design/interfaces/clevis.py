"""Clevis: the eyes of the bone about the joint's pin, their hard stops, and the anchor of the tendon.

A load on the fingertip turns it about the pin. On a straight finger a hard stop holds it, and the pin then pulls at
the ends of the eyes. On a bent one the tendon holds it: it pulls at its anchor, and the eyes press on the pin.
Forces are those of statics; stresses are nominal ones of a lug with a pin (net section, bearing, shear-out), the
first with the concentration that finite elements with contact found at its bore.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fingertip.design.formulas.stress import PIN_IN_EYE, VON_MISES_SHEAR, LocalStress, StressFactors, at_foot, pin_peak
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.dimensions import Dimensions
from fingertip.design.geometry.features import Joint, TendonAnchor
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
    Tolerance,
    bore,
    clearance,
    general,
    size_text,
)
from fingertip.design.geometry.solids import Point3, cylinder
from fingertip.design.interfaces import clevis_solids
from fingertip.design.interfaces.interface import JointInterface, Shapes, base_size

_PIN_PLAY_MM = 0.2
"""Play of the anchor pin in its printed hole [mm]."""
_CARRIES_MM = 1.15
"""Longest part of the anchor's hole in a cheek that carries the pin [mm], which bends beside its knots.

Own finite elements of six fingers, with the pin glued into its hole as a beam on its bed, found the bearing pressure on
this part as the largest tension beside the hole: 0.88 to 1.02 times it.
"""
_WRONG_PLACE = "fill the hole with epoxy and drill it again: the joint's torque and walls follow from its place"
ANCHOR_PIN_MPA = 1500.0
"""Stress up to which spring steel wire springs back [MPa]: three quarters of its tensile strength (EN 10270-1)."""


class Clevis(JointInterface):
    """Joint with a pin, whose sizes stand in the table [hand]."""

    name = "clevis"
    face_on_plate = weakest = "the eyes of the joint"
    supports_below = "under the foot of the collar; around the eyes of the joint"

    def shapes(self, design: DesignTables) -> Shapes:
        """Build the palmar stop, which stands out below the base, and what is removed: the joint's space, holes."""
        joint, anchor = _joint_of(design), design.dimensions.anchor
        top = design.dimensions.stops_top_z
        added = () if top is None else (clevis_solids.stops(design, joint, top),)
        across = 2 * design.dimensions.collar.section.half_width
        removed = [clevis_solids.space(design, joint), clevis_solids.pin_bore(joint, across)]
        if anchor:
            removed.append(cylinder("x", (anchor.y, anchor.z), -across, across, anchor.radius))
            removed += clevis_solids.open_ends(design, anchor)
            if not design.dimensions.window_opens_into_gap:
                removed.append(clevis_solids.notch(design, anchor))
        return added, tuple(removed)

    def genus(self, design: DesignTables) -> int:
        """Count a hole in each cheek of a fork, and two of the anchor, on either side of the notch that it crosses."""
        return (2 if _joint_of(design).is_fork else 1) + (2 if design.dimensions.anchor else 0)

    def depth(self, design: DesignTables) -> float:
        joint = _joint_of(design)
        step = 0.0 if joint.travel_deg else joint.foot  # without stops the base ends dorsal to the eyes too
        return joint.radius + joint.clearance + step

    def low_z(self, design: DesignTables) -> float:
        joint = _joint_of(design)
        return joint.low_z if joint.travel_deg else joint.axis_z - joint.eye_radius

    def features(self, design: DesignTables) -> Iterator[tuple[str, tuple[float, float]]]:
        joint, anchor = _joint_of(design), design.dimensions.anchor
        yield "joint", (joint.axis_z, joint.axis_y)
        if anchor:
            yield "tendon's anchor", (anchor.z, anchor.y)

    def beam_begin_z(self, design: DesignTables, low_z: float) -> float:
        """Past the pin only the joint's own forces act, which are assessed for themselves."""
        joint = _joint_of(design)
        return joint.axis_z + joint.pin_radius

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        """Find the factors at the root of the eyes, which are as high as the base if they have stops."""
        joint, base, top = _joint_of(design), base_size(design.dimensions), design.dimensions.stops_top_z
        width = base[0] if joint.is_fork else 2 * joint.half_width
        height = base[1] if joint.travel_deg else 2 * joint.eye_radius
        factors = at_foot(base, (width, height), joint.foot, joint.shoulder_z - z)
        if top is None:
            return factors
        collar, radius = design.dimensions.collar.section, clevis_solids.eye_radius_mm(design, joint, top)
        eyes = 2 * collar.half_width, collar.dorsal + collar.palmar
        return factors.combined_with(at_foot(eyes, base, radius, z - (top - radius)))

    def local_stresses(self, design: DesignTables, load_z: float) -> Iterator[LocalStress]:
        """Yield the stresses of eyes and anchor, in the plane in which the finger bends."""
        joint, anchor = _joint_of(design), design.dimensions.anchor
        thickness = _eye_thickness(design.dimensions, joint)
        if joint.travel_deg:
            pull = self.pin_pulls(design, load_z)[0]
            width, bore = 2 * joint.eye_radius, 2 * joint.pin_radius
            modulus = design.strength.material.modulus_mpa
            factor = PIN_IN_EYE * pin_peak(thickness / 2, bore, modulus)
            yield LocalStress("eye", joint.axis_z, factor * pull / (thickness * (width - bore)), factor)
            shear = pull / (2 * thickness * (joint.eye_radius - joint.pin_radius))
            yield LocalStress("end of the eye", joint.low_z, VON_MISES_SHEAR * shear)
        if anchor:
            force = tendon_force_per_n(design, load_z)
            yield LocalStress(
                "bearing of the pin", joint.axis_z, (force + 1.0) / (thickness * 2 * joint.pin_radius), at_knock=False
            )
            # The length of the anchor's hole in both cheeks together, and what of it carries the pin.
            outside = design.dimensions.collar.section.half_width_at(anchor.y) - anchor.inner_half_width
            length, closed = 2 * outside, min(outside, anchor.open_half_width - anchor.inner_half_width)
            bearing = force / (2 * min(closed, _CARRIES_MM) * 2 * anchor.radius)
            yield LocalStress("hole of the anchor", anchor.z, bearing, at_knock=False)
            shear = force / (2 * length * design.bone.wall_mm)
            yield LocalStress("wall at the anchor", anchor.z, VON_MISES_SHEAR * shear, at_knock=False)

    def pin_pulls(self, design: DesignTables, load_z: float) -> tuple[float, ...]:
        """Pull on the pin per newton of load: by the stop of a straight finger, and by the tendon of a bent one.

        The stop pushes the finger away from the hand, and the pin holds it, besides the load itself. The pressure on
        the stop grows outwards, so its force acts at two thirds of the length.
        """
        joint, pulls = _joint_of(design), []
        if joint.travel_deg:
            pulls.append((load_z - joint.axis_z) / (2 / 3 * clevis_solids.stop_height_mm(design)) + 1.0)
        if design.dimensions.anchor:
            pulls.append(tendon_force_per_n(design, load_z) + 1.0)
        return tuple(pulls)

    def sizes(self, design: DesignTables) -> list[Size]:
        joint = _joint_of(design)
        y, z, half = joint.axis_y, joint.axis_z, joint.half_width
        across = design.dimensions.bone_outline.section.half_width
        place = "gap between the cheeks" if joint.is_fork else "width of the tongue"
        remedy = "narrow: file it until the hand's tongue turns" if joint.is_fork else "wide: sand it until it turns"
        pin: Point3 = (across, y, z)
        sizes: list[Size] = [
            Length("skin's end to the joint axis", BEHIND_FACE, "front", "below", "z", (across, 0.0, 0.0), pin),
            Circle("bore of the joint's pin", FINISHED, "front", "x", pin, joint.pin_radius, bore(design),
                   "narrow: ream it to the pin; wide: take a thicker pin, or a bush"),
            Circle("eyes of the joint", BEHIND_FACE, "front", "x", pin, joint.eye_radius, is_radius=True,
                   hidden_deg=_beside_stops_deg(joint)),
            Length(place, INNER if joint.is_fork else OUTER, "end", "below", "x", (half, y, z), (-half, y, z),
                   clearance(2 * joint.clearance - design.printer.offset_mm), remedy),
        ]  # fmt: skip
        if joint.is_fork:
            beside = z - (joint.pin_radius + joint.eye_radius) / 2
            sizes.append(
                Length("thickness of each eye beside the bore", OUTER, "end", "below", "x", (half, y, beside),
                       (design.dimensions.eyes.half_width_at(y), y, beside))
            )  # fmt: skip
        if joint.foot:
            corner = (across, y - joint.eye_radius - joint.foot, joint.shoulder_z - joint.foot)
            sizes.append(
                Circle("fillet at the root of the eyes", BEFORE_FACE, "front", "x", corner, joint.foot, is_radius=True,
                       hidden_deg=((88.0, 420.0),))
            )  # fmt: skip
        if abs(y) > 1e-6:
            sizes.append(
                Length("height of the joint axis", STEP, "front", "left", "y", (across, 0.0, z), pin, is_reference=True)
            )
        if (top := design.dimensions.stops_top_z) is not None:
            sizes += self._stop_sizes(design, joint, top)
        if anchor := design.dimensions.anchor:
            sizes += self._anchor_sizes(design, anchor, (across, anchor.y, anchor.z), pin)
        return sizes

    def _stop_sizes(self, design: DesignTables, joint: Joint, top: float) -> list[Size]:
        """List the sizes of the eyes outside the mold, and of their stops."""
        half, y, foot = design.dimensions.collar.section.half_width, joint.axis_y, -design.bone.collar_length_mm
        bore, eyes = joint.axis_z - joint.pin_radius, top - clevis_solids.eye_radius_mm(design, joint, top)
        sizes: list[Size] = [
            Length("groove between collar and joint", INNER, "front", "above", "z", (half, 0.0, foot),
                   (half, 0.0, eyes), clearance(joint.clearance),
                   "narrow: sand the side of the joint, the mold's end lies in it"),
            Length("edge of the bore to the straight stop", OUTER, "front", "above", "z", (half, y, bore),
                   (half, y, joint.low_z), general(bore - joint.low_z),
                   "long: file both flats alike; short: it stops too late, print again"),
            Length("height of the eyes", OUTER, "end", "left", "y",
                   (joint.half_width, clevis_solids.stop_toe_y(design, joint, top), joint.low_z),
                   (joint.half_width, clevis_solids.stop_top_y(design, joint), joint.low_z)),
        ]  # fmt: skip
        if joint.is_fork:
            at = (0.0, joint.axis_z)
            sizes.append(Length("width across the eyes", OUTER, "end", "above", "x", (half, *at), (-half, *at)))
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

    def _anchor_sizes(self, design: DesignTables, anchor: TendonAnchor, at: Point3, pin: Point3) -> list[Size]:
        """List place and size of the anchor's hole, and the two lengths that hold its pin."""
        collar, wall = design.dimensions.collar.section, design.bone.wall_mm
        edge, closed = anchor.z - anchor.radius, anchor.open_half_width - anchor.inner_half_width
        # The collar's foot stands out beside the base there. The other one is read in the slot, below the hole.
        beside = (design.dimensions.bone_outline.section.half_width_at(anchor.y) + collar.half_width_at(anchor.y)) / 2
        under = anchor.y - anchor.radius - design.printer.min_wall_mm / 2
        return [
            Circle("hole of the tendon's anchor", INNER, "front", "x", at, anchor.radius,
                   clearance(_PIN_PLAY_MM - design.printer.offset_mm),
                   f"narrow: ream it to {design.bone.anchor_diameter_mm:.1f} mm; wide: take a thicker pin"),
            Length("anchor to joint axis", STEP, "front", "right", "y", at, pin, is_reference=True),
            Length("skin's end to the anchor's axis", BEHIND_FACE, "front", "below", "z", (at[0], at[1], 0.0), at,
                   None, _WRONG_PLACE),
            Length("palmar side to the anchor's axis", BEHIND_FACE, "front", "right", "y", (0.0, -collar.palmar, 0.0),
                   at, None, _WRONG_PLACE),
            Length("wall at the anchor's hole", OUTER, "front", "below", "z", (beside, anchor.y, edge),
                   (beside, anchor.y, edge - wall), self._thinner_by(design, "wall at the anchor", wall, wall),
                   "thin: the tendon tears it out, print again"),
            Length("closed part of the anchor's hole", OUTER, "palmar", "left", "x",
                   (anchor.inner_half_width, under, anchor.z), (anchor.open_half_width, under, anchor.z),
                   self._thinner_by(design, "hole of the anchor", closed, min(closed, _CARRIES_MM)),
                   "short: drill the hole for a thicker pin, or print again"),
        ]  # fmt: skip

    def _thinner_by(self, design: DesignTables, place: str, size: float, carrying: float) -> Tolerance:
        """Find how much shorter a size may be, of which a part carries, for the safety factor at the grip.

        The wall could lose far more than prints err: the general tolerance is the limit then.
        """
        strength = design.strength
        allowed = strength.material.strength_mpa
        stresses = {found.place: found.stress_per_n for found in self.local_stresses(design, design.skin.length_mm)}
        needed = carrying * stresses[place] * strength.grip_force_n * strength.min_grip_factor / allowed
        usual = general(size)
        return Tolerance(min(max(needed - size, usual.low), 0.0), usual.high)

    def bolts(self, design: DesignTables) -> list[dict[str, Any]]:
        """List the pin, and what holds the tendon."""
        anchor = design.dimensions.anchor
        item = "joint pin (hardened steel, such as a dowel pin)"
        pin: dict[str, Any] = {"item": item, "diameter_mm": design.hand.pin_diameter_mm, "count": 1}
        if design.hand.knuckle == "tongue":  # else it is as long as the hand's fork is wide
            pin["length_mm"] = design.dimensions.pin_length
        items = [pin]
        if anchor:
            items.append({
                "item": "anchor pin of the tendon (spring steel wire)",
                "diameter_mm": _anchor_pin_mm(design),
                "length_mm": round(2 * design.dimensions.collar.section.half_width_at(anchor.y), 1), "count": 1,
            })  # fmt: skip
            held_n = design.strength.grip_force_n * tendon_force_per_n(design, design.skin.length_mm)
            items.append({
                "item": "tendon (braided line, as long as the hand needs)",
                "diameter_mm": design.hand.tendon_diameter_mm, "count": 1,
                "note": f"it breaks at {10.0 * math.ceil(0.4 * held_n):.0f} N or more, four times its force at the "
                "grip: a knot takes half",
            })  # fmt: skip
        return items


def _joint_of(design: DesignTables) -> Joint:
    joint = design.dimensions.joint
    assert joint
    return joint


def _beside_stops_deg(joint: Joint) -> tuple[tuple[float, float], ...]:
    """Directions in the front view in which the eyes are not round: all but those between the stops."""
    if not joint.travel_deg:
        return ((-90.0, 90.0),)
    beside = ARROW_DEG - joint.ramp_deg
    return ((180.0 + joint.travel_deg - beside, 540.0 + beside),)


def tendon_force_per_n(design: DesignTables, load_z_mm: float) -> float:
    """Force of the tendon per newton of load on the pad or apex, by their levers about the pin; 0 without a tendon."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    return (load_z_mm - joint.axis_z) / anchor.distance if joint and anchor else 0.0


def anchor_pin_stress_mpa(design: DesignTables, force_n: float) -> float:
    """Bending stress of the anchor pin [MPa], whose tendon pulls by half its force at a knot beside each cheek [N]."""
    return 0.5 * force_n * design.hand.tendon_diameter_mm / (math.pi * _anchor_pin_mm(design) ** 3 / 32)


def _anchor_pin_mm(design: DesignTables) -> float:
    return round(design.bone.anchor_diameter_mm - _PIN_PLAY_MM, 1)


def _eye_thickness(dims: Dimensions, joint: Joint) -> float:
    """Thickness [mm] of both cheeks beside the pin, or of the tongue."""
    if not joint.is_fork:
        return 2 * joint.half_width
    edges = (joint.axis_y - joint.pin_radius, joint.axis_y + joint.pin_radius)
    return 2 * (min(dims.eyes.half_width_at(y) for y in edges) - joint.half_width)
