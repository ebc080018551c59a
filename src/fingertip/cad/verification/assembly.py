"""Checks of the assembly: overlaps, demolding, volume balances between the parts, and the joint of a clevis.

A volume balance states that volumes which must add up do so, such as core + skin = cavity. The balances are checked on
the meshes, and again on the volumes of the B-rep solids, which involve no mesh. The joint is moved: the finger is
rotated about the pin against the hand's part of the joint as `[hand]` describes it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations
from types import ModuleType

from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.shapes import cup, insert, mold
from fingertip.cad.shapes.bridged_ceiling import ceiling_steps_volume_mm3, disc_slot_area_mm2, hexagon_slot_area_mm2
from fingertip.cad.shapes.engraving import signed_area
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check, complement, search_distance
from fingertip.design import Design
from fingertip.design.geometry.cup_layout import RIDGE_HEIGHT_MM
from fingertip.design.geometry.features import Joint
from fingertip.design.geometry.solids import Box, Cone, Prism, Solid, cylinder, difference, intersection, scaled, union
from fingertip.design.interfaces.clevis_solids import eye_profile, knuckle, pin_bore, space
from fingertip.filling.mold_filling import place_vents

HALVES = ("mold_palmar", "mold_dorsal")
_PULL_DISTANCES_MM = (0.02, 0.2, 1.0, 4.0, 12.0)
LIFT_MM = RIDGE_HEIGHT_MM + 0.5
"""Height by which a core is lifted out of its grooves before the dorsal half comes off [mm]."""
_BREP_VOLUME_ERROR = 2e-6
"""Relative error allowed in volumes of the B-rep kernel, whose quadrature has a tolerance of 1e-6."""


def _form(design: Design) -> ModuleType:
    """Choose the module whose halves a design has: a cup, or a mold that is closed before it is filled."""
    return cup if design.mold.method == "plunge" else mold


def check_assembly(design: Design, evaluator: MeshEvaluator, parts: Mapping[str, Solid]) -> Iterator[Check]:
    parts = {name: solid for name, solid in parts.items() if not PARTS[name].is_tool}
    if "skin" in parts:
        yield Check.zero_volume("volume_balance.cavity", _cavity_imbalance(design, evaluator, parts["skin"]))
    inside = {name: solid for name, solid in parts.items() if name not in HALVES}
    if design.is_cast_apart:
        # The bone does not lie in the mold, and the skin is smaller than it by the interference.
        inside.pop("bone", None)
        inside.pop("lid", None)
        if "skin" in inside:
            inside["skin"] = scaled(inside["skin"], design.dimensions.shrinkage)
    filled = dict(inside)
    if "skin" in inside and design.mold.method == "overmold":
        # Before it shrinks, the silicone fills the cavity, which is not larger everywhere: a crown has a hollow base.
        cast = scaled(inside["skin"], design.dimensions.shrinkage)
        filled["skin"] = difference(cast, insert.mold_insert(design), *insert.boss(design))
    halves = {name: solid for name, solid in parts.items() if name in HALVES}
    yield from _check_overlaps(evaluator, inside, filled, halves)
    if inside:
        whole = evaluator.manifold(union(*filled.values()))
        for name, half in halves.items():
            solid, direction = evaluator.manifold(half), -1.0 if name == HALVES[0] else 1.0
            # The palmar half comes off first. Then core and skin are lifted, and the third ridge leaves its groove.
            lift = LIFT_MM if design.mold.method == "plunge" and name == HALVES[1] else 0.0
            pulled = (solid.translate((0.0, direction * distance, lift)) for distance in _PULL_DISTANCES_MM)
            overlap = max(float((position ^ whole).volume()) for position in pulled)
            yield Check.zero_volume(f"demolding_overlap.{name}", overlap)
    if len(halves) == 2:
        yield Check.zero_volume("volume_balance.mold", _mold_imbalance(design, evaluator, halves.values()))


def brep_balance_solids(design: Design, parts: Collection[str]) -> tuple[tuple[str, Solid], ...]:
    """List the solids, besides the parts, whose volumes `check_brep_assembly` needs, by name."""
    solids: list[tuple[str, Solid]] = []
    if "skin" in parts:
        cavity = insert.cavity(design)
        solids += [("cavity", cavity), ("core_in_cavity", intersection(cavity, insert.mold_insert(design)))]
        if design.mold.method == "overmold":
            for name, outline in (("skin", insert.skin_outline(design)), ("cavity", insert.cavity_outline(design))):
                solids += [(f"boss_in_{name}", intersection(outline, solid)) for solid in insert.boss(design)]
    if set(HALVES) <= set(parts):
        form = _form(design)
        solids.append(("hollow", intersection(form.hollow(design), form.block(design))))
    return tuple(solids)


def check_brep_assembly(
    design: Design, parts: Mapping[str, BrepMeasurements], volumes_mm3: Mapping[str, float]
) -> Iterator[Check]:
    if "cavity" in volumes_mm3:
        growth = design.dimensions.shrinkage**3
        skin, whole = parts["skin"].volume_mm3, volumes_mm3["cavity"]
        expected = growth * skin
        if design.mold.method == "overmold":
            # Bone and boss do not shrink, so silicone also fills what the cavity is larger than the skin around them.
            expected += (growth - 1.0) * volumes_mm3["core_in_cavity"]
            expected += growth * volumes_mm3.get("boss_in_skin", 0.0) - volumes_mm3.get("boss_in_cavity", 0.0)
        imbalance = abs(whole - volumes_mm3["core_in_cavity"] - expected)
        yield Check("step.volume_balance.cavity", imbalance, _BREP_VOLUME_ERROR * whole, "mm3")
    if "hollow" in volumes_mm3:
        outline = _form(design).block(design)
        assert isinstance(outline, Box)
        block = math.prod(high - low for low, high in zip(outline.low, outline.high, strict=True))
        filled = volumes_mm3["hollow"] + _cutout_volume_mm3(design) + sum(parts[half].volume_mm3 for half in HALVES)
        filled += sum(map(_volume_below_parting_plane_mm3, _form(design).key_sockets(design)))
        filled -= sum(map(_volume_below_parting_plane_mm3, _form(design).key_frustums(design)))
        yield Check("step.volume_balance.mold", abs(block - filled), _BREP_VOLUME_ERROR * block, "mm3")


def _check_overlaps(
    evaluator: MeshEvaluator, inside: Mapping[str, Solid], filled: Mapping[str, Solid], halves: Mapping[str, Solid]
) -> Iterator[Check]:
    """Check that no two parts overlap: those inside the mold at their own sizes, and as they are cast with a half.

    Parts inside the mold share surfaces. The intersection of such solids takes four times as long as their union, so
    their overlap is computed as |A & B| = |A| + |B| - |A + B|. Against a half they are tested all at once in the same
    way, and one by one only if the union overlaps it.
    """

    def volume(solid: Solid) -> float:
        return float(evaluator.manifold(solid).volume())

    for (first, one), (second, other) in combinations(inside.items(), 2):
        yield Check.zero_volume(f"overlap.{first}.{second}", volume(one) + volume(other) - volume(union(one, other)))
    cast = union(*filled.values()) if filled else None
    for half, solid in halves.items():
        together = volume(cast) + volume(solid) - volume(union(cast, solid)) if cast else 0.0
        for name, one in filled.items():
            alone = together if together <= VOLUME_TOLERANCE_MM3 else volume(intersection(one, solid))
            yield Check.zero_volume(f"overlap.{name}.{half}", alone)
    if len(halves) == 2:
        yield Check.zero_volume(f"overlap.{'.'.join(halves)}", volume(intersection(*halves.values())))


def _cavity_imbalance(design: Design, evaluator: MeshEvaluator, skin: Solid) -> float:
    """Compute |cavity - core - silicone that shrinks to the skin| [mm3].

    A core and the skin around it are enlarged by the same factor. Overmolded silicone is not: the bone keeps its size,
    so silicone also fills the space by which the cavity is enlarged around it. With the boss, the cavity then is the
    enlarged outline of the skin and of what does not shrink within it.
    """
    growth, silicone = design.dimensions.shrinkage**3, evaluator.manifold(skin).volume()
    room = evaluator.manifold(insert.cavity(design)).volume()
    if design.is_cast_apart:
        core = evaluator.manifold(intersection(insert.cavity(design), insert.mold_insert(design))).volume()
        return abs(float(room - core - growth * silicone))
    bosses = insert.boss(design)
    if bosses:
        room += evaluator.manifold(intersection(insert.cavity_outline(design), union(*bosses))).volume()
    finished = evaluator.manifold(insert.skin_outline(design))
    rigid = (finished ^ evaluator.manifold(union(insert.mold_insert(design), *bosses))).volume()
    return abs(float(room - growth * (silicone + rigid)))


def _mold_imbalance(design: Design, evaluator: MeshEvaluator, halves: Iterable[Solid]) -> float:
    """Compute |block - halves - hollow - cut-outs| [mm3]; hollow and cut-outs are evaluated apart from the halves."""
    form = _form(design)
    block = form.block(design)
    # The hole of the chaplet's screw reaches into the hollow, so both are united first.
    hollow = union(form.hollow(design), form.outer_cutouts_and_screw(design))
    filled = sum(evaluator.manifold(solid).volume() for solid in (intersection(hollow, block), *halves))
    below = evaluator.manifold(block).trim_by_plane((0.0, -1.0, 0.0), 0.0)
    for socket, key in zip(form.key_sockets(design), form.key_frustums(design), strict=True):
        filled += (evaluator.manifold(socket) ^ below).volume() - (evaluator.manifold(key) ^ below).volume()
    return abs(float(evaluator.manifold(block).volume() - filled))


def _cutout_volume_mm3(design: Design) -> float:
    """Compute bolt holes, traps, slots and letters [mm3] in closed form: exact, and forty B-rep booleans less."""
    if design.mold.method == "plunge":
        return _letters_mm3(design, cup.label(design))
    d, m = design.mold, design.mold_layout
    radius = d.bolt_diameter_mm / 2
    bolt, slot = math.pi * radius**2, hexagon_slot_area_mm2(d.nut_width_mm, radius)
    fastener = (
        bolt * (m.palmar_height + m.dorsal_height) + (math.sqrt(0.75) * d.nut_width_mm**2 - bolt) * d.nut_depth_mm
    ) + ceiling_steps_volume_mm3(slot, radius)
    pry_slot = d.pry_width_mm * d.pry_depth_mm * 2.0 * d.pry_height_mm
    letters = (prism for half in ("palmar", "dorsal") for prism in mold.engraved_text(design, half))
    engraved = _letters_mm3(design, letters)
    pried = 2.0 * pry_slot - _vents_in_pry_slots_mm3(design)
    return len(m.bolts) * fastener + pried + engraved + _screw_hole_volume_mm3(design)


def _letters_mm3(design: Design, letters: Iterable[Prism]) -> float:
    rings = (ring for letter in letters for ring in (letter.corners, *letter.holes))
    return design.mold.engraving_depth_mm * sum(map(signed_area, rings))  # holes run clockwise, and count as negative


def _vents_in_pry_slots_mm3(design: Design) -> float:
    """Compute the volume [mm3] that grooves of side vents share with the pry slots in which they end."""
    d, m, total = design.mold, design.mold_layout, 0.0
    for vent in place_vents(design):
        if vent.kind == "side":
            apart = abs(m.clear_side_z(vent.point_mm[2], vent.diameter_mm) - mold.pry_slots_z(design))
            along = min(vent.diameter_mm, d.pry_width_mm, (vent.diameter_mm + d.pry_width_mm) / 2 - apart)
            total += d.pry_depth_mm * max(0.0, along) * min(vent.diameter_mm / 2, d.pry_height_mm)
    return total


def _screw_hole_volume_mm3(design: Design) -> float:
    """Compute the volume [mm3] of the chaplet's screw hole above the hollow, with its counterbore."""
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return 0.0
    head, top = insert.head_y(design), design.mold_layout.dorsal_height
    hole, counterbore, radius = head - insert.contact_y(design), top - head, chaplet.hole_radius
    steps = ceiling_steps_volume_mm3(disc_slot_area_mm2(chaplet.head_radius, radius), radius)
    return math.pi * (radius**2 * hole + chaplet.head_radius**2 * counterbore) + steps


def _volume_below_parting_plane_mm3(key: Solid) -> float:
    """Compute the volume [mm3] of the frustum of a key below the parting plane."""
    assert isinstance(key, Cone)
    top, height = key.low_radius, -key.low
    root = top + (key.high_radius - top) * height / (key.high - key.low)
    return math.pi * height / 3.0 * (top * top + top * root + root * root)


_FREE_ANGLES = 8
"""Angles at which the joint is tried, besides straight."""
_BEYOND_STOP_DEG = 4.0
"""Angle beyond a stop at which it must block [degrees]."""
_FINGER = ("bone", "lid", "skin")


def check_joint(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    if joint is None:
        return
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    yield from _check_eyes(design, joint, evaluator, wall)
    if anchor:
        length = max(wall, design.printer.min_wall_mm / 2)  # a coarse mesh leaves nothing of the wall
        inner, outside = anchor.inner_half_width, complement(evaluator, insert.filled_bone(design))
        hole = evaluator.manifold(cylinder("x", (anchor.y, anchor.z), inner, inner + length, anchor.radius))
        yield Check.min_distance("bone.wall.anchor_to_outside", hole, outside, wall)
        # The tendon leaves its anchor straight along the finger.
        radius = min(design.hand.tendon_diameter_mm / 2, anchor.radius)
        tendon = evaluator.manifold(cylinder("z", (0.0, anchor.y), joint.low_z - joint.radius, anchor.z, radius))
        bone = evaluator.manifold(PARTS["bone"].solid(design))
        yield Check.zero_volume("joint.tendon_overlap", (tendon ^ bone).volume())
    yield from _check_travel(design, joint, evaluator)


def _check_eyes(design: Design, joint: Joint, evaluator: MeshEvaluator, wall: float) -> Iterator[Check]:
    dims, half_length = design.dimensions, 1.0
    reach = 2 * (joint.radius + dims.collar.section.dorsal + dims.collar.section.palmar)
    heights = Box(
        (-reach, -dims.base_flat_depth, -reach + joint.axis_z), (reach, dims.bone_outline.section.dorsal, reach)
    )
    around = complement(evaluator, intersection(eye_profile(joint, 2 * reach), heights))
    bore = evaluator.manifold(pin_bore(joint, half_length))
    yield Check.min_distance("bone.wall.pin_to_outside", bore, around, wall)
    # Cheeks, or a tongue, beside the pin.
    edge = joint.pin_radius + wall
    beside = Box(
        (-reach, joint.axis_y - edge, joint.axis_z), (reach, joint.axis_y + edge, joint.shoulder_z - joint.clearance)
    )
    if joint.is_fork:
        gap = evaluator.manifold(intersection(space(design, joint), beside))
        gap = gap.trim_by_plane((1.0, 0.0, 0.0), -joint.half_width).trim_by_plane((-1.0, 0.0, 0.0), -joint.half_width)
        outside = complement(evaluator, insert.filled_bone(design)) ^ evaluator.manifold(beside)
        yield Check.min_distance("bone.wall.cheek", gap, outside, wall)
    else:
        box = (evaluator.manifold(PARTS["bone"].solid(design)) ^ evaluator.manifold(beside)).bounding_box()
        yield Check("bone.wall.tongue", box[3] - box[0], wall, "mm", "at least")


def _check_travel(design: Design, joint: Joint, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that the finger turns freely from straight to bent, and that the stops block it beyond both ends."""
    hand = evaluator.manifold(knuckle(design, joint))
    present = parts_by_name(design)
    finger = [evaluator.manifold(present[name].solid(design)) for name in _FINGER if name in present]
    travel = design.hand.travel_deg
    angles = [travel * i / _FREE_ANGLES for i in range(_FREE_ANGLES + 1)] if travel else [0.0]
    worst = max(_overlap(finger, hand, joint, angle) for angle in angles)
    # Surfaces in contact may share a volume, because meshes deviate by up to the tolerance.
    contact_mm2 = 4 * joint.radius * design.dimensions.bone_outline.section.half_width
    allowed = VOLUME_TOLERANCE_MM3 + 0.05 * contact_mm2 * evaluator.tolerance_mm
    yield Check("joint.travel_overlap", worst, allowed, "mm3")
    halfway = [turn_about_pin(part, joint, travel / 2) for part in finger]
    ahead = hand.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z)  # without the shoulder, which the stops meet
    clearance = search_distance(lambda reach: min(part.min_gap(ahead, reach) for part in halfway), 2 * joint.clearance)
    yield Check("joint.clearance", clearance, 0.9 * joint.clearance - evaluator.tolerance_mm, "mm", "at least")
    if travel:
        for name, angle in (("straight", -_BEYOND_STOP_DEG), ("bent", travel + _BEYOND_STOP_DEG)):
            blocked = _overlap(finger[:1], hand, joint, angle)
            yield Check(f"joint.stop_{name}_overlap", blocked, _wedge(design, joint), "mm3", "at least")


def _overlap(finger: list[Manifold], hand: Manifold, joint: Joint, angle_deg: float) -> float:
    return float(sum((turn_about_pin(part, joint, angle_deg) ^ hand).volume() for part in finger))


def turn_about_pin(part: Manifold, joint: Joint, angle_deg: float) -> Manifold:
    """Turn a part of the finger about the pin: its tip (+z) to the palmar side (-y), a positive rotation about x."""
    at_origin = part.translate((0.0, -joint.axis_y, -joint.axis_z))
    return at_origin.rotate((angle_deg, 0.0, 0.0)).translate((0.0, joint.axis_y, joint.axis_z))


def _wedge(design: Design, joint: Joint) -> float:
    """Half the volume of a stop as long as the pin's radius, pressed past the shoulder by the angle beyond it [mm3]."""
    section = design.dimensions.bone_outline.section
    width = 2 * (section.half_width - joint.half_width if joint.is_fork else joint.half_width)
    depth = math.tan(math.radians(_BEYOND_STOP_DEG))
    return 0.25 * width * depth * joint.pin_radius**2
