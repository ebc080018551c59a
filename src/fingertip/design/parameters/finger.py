"""Parameters of the printed parts: sensor, bone, skin, mold and printer. The defaults are the FSR 400 finger's."""

from __future__ import annotations

from typing import Literal

from fingertip.design.parameters.declaration import ParameterTable, choice, quantity
from fingertip.design.threads import MIN_HOLE_MM


class Sensor(ParameterTable):
    """Force-sensing resistor, and its pocket in the bone."""

    model: Literal["fsr400", "fsr400_short", "fsr402", "fsr402_short", "custom"] = choice(
        "fsr400", "Force-sensing resistor from the catalogue, or custom: [custom_sensor] then holds its outline."
    )
    distance_from_tip_mm: float = quantity(
        11.5, "mm", "Distance from the tip of the skin to the centre of the active area.", minimum=3, maximum=60
    )
    tail: Literal["straight", "folded"] = choice(
        "straight",
        "straight: out through the base; folded: once around the bone, its end in a trough under a lid.",
    )
    fold_radius_mm: float = quantity(
        2.5, "mm", "Radius at which a folded tail bends; Interlink allows no less than 2.5.", minimum=0.8, maximum=6
    )
    tab_length_mm: float = quantity(
        4.3, "mm", "Length by which the crimped tabs stick out of the film.", minimum=0, maximum=15, verified=False
    )
    crimp_height_mm: float = quantity(
        0.6,
        "mm",
        "Height of crimps and solder above the film, for the space of a folded tail.",
        minimum=0.2,
        maximum=5,
        verified=False,
    )
    wire_diameter_mm: float = quantity(
        0.5, "mm", "Outer diameter of the wires on the tabs of a folded tail.", minimum=0.1, maximum=3
    )
    clearance_mm: float = quantity(0.15, "mm", "Gap around the sensor in its pocket and slot.", minimum=0.02, maximum=1)
    adhesive_thickness_mm: float = quantity(
        0.13,
        "mm",
        "Thickness of the adhesive film under the sensor; it deepens the pocket.",
        minimum=0,
        maximum=0.5,
        verified=False,
    )


class CustomSensor(ParameterTable):
    """Outline of a sensor that is not in the catalogue; used only if sensor.model is "custom"."""

    active_diameter_mm: float = quantity(5.08, "mm", "Diameter of the active area.", minimum=1, maximum=40)
    head_diameter_mm: float = quantity(7.62, "mm", "Diameter of the round head.", minimum=2, maximum=50)
    thickness_mm: float = quantity(0.3, "mm", "Thickness of head and tail.", minimum=0.05, maximum=3)
    length_mm: float = quantity(
        38.0, "mm", "Length from the far edge of the head to the end of the tail.", minimum=5, maximum=150
    )
    tail_width_mm: float = quantity(6.4, "mm", "Width of the tail.", minimum=1, maximum=30)


class Bone(ParameterTable):
    """Rigid part that carries the sensor, and its interface to the proximal phalanx."""

    base_length_mm: float = quantity(
        22.0,
        "mm",
        "Length of the base from the skin's proximal end to the interface, or to the joint axis of a clevis.",
        minimum=4,
        maximum=60,
    )
    palmar_fullness: float = quantity(
        0.9422,
        "",
        "Width of the bone at half its palmar height, before the flat is cut, relative to its full width.",
        minimum=0.8,
        maximum=0.998,
    )
    rim_mm: float = quantity(
        0.6,
        "mm",
        "Design width of the rim around the sensor; checks require 95 % of it or, if less, of printer.min_wall_mm.",
        minimum=0.2,
        maximum=5,
    )
    wall_mm: float = quantity(
        1.0,
        "mm",
        "Design wall between cable channel, sensor slot and outer surface; checks require printer.min_wall_mm.",
        minimum=0.4,
        maximum=5,
    )
    channel_diameter_mm: float = quantity(
        2.4,
        "mm",
        "Diameter of the cable channel from the solder relief to the dorsal side of the base.",
        minimum=0.8,
        maximum=10,
    )
    channel_bend_radius_mm: float = quantity(
        3.0, "mm", "Bend radius of the channel's centre line.", minimum=1, maximum=20
    )
    relief_length_mm: float = quantity(
        5.0,
        "mm",
        "Length of the solder relief, the recess for the solder joints at the end of the tail.",
        minimum=2,
        maximum=20,
    )
    tie_hole_diameter_mm: float = quantity(
        1.6,
        "mm",
        "Diameter of the hole for the cable tie (strain relief), across the base, proximal to the channel opening.",
        minimum=0.8,
        maximum=6,
    )
    collar_length_mm: float = quantity(
        2.0,
        "mm",
        "Length of the collar on which the skin ends, at the parting plane, where its drafted foot makes it longest.",
        minimum=0.8,
        maximum=10,
    )
    collar_inset_mm: float = quantity(
        0.3, "mm", "Inset of the collar from the outline of the skin.", minimum=0.1, maximum=5
    )
    groove_depth_mm: float = quantity(
        0.6, "mm", "Depth of the groove around the bone that retains the skin; 0: no groove.", minimum=0, maximum=3
    )
    groove_width_mm: float = quantity(3.0, "mm", "Width of the groove at its floor.", minimum=0.5, maximum=15)
    groove_distance_mm: float = quantity(2.0, "mm", "Distance from the collar to the groove.", minimum=0.5, maximum=60)
    interface: Literal["post", "socket", "flange", "clevis"] = choice(
        "post",
        "Interface to the proximal phalanx. post: a post on the bone, with two flats; socket: a hole for the phalanx's "
        "post; flange: a plate with bolt holes; clevis: a joint with a pin, whose sizes stand in [hand].",
    )
    post_width_mm: float = quantity(
        8.4, "mm", "Diameter of the post, which is its width (interface post).", minimum=2, maximum=40
    )
    post_height_mm: float = quantity(
        7.2,
        "mm",
        "Height of the post between its two flats, which lock rotation; from post_width_mm on it is round.",
        minimum=2,
        maximum=40,
    )
    post_length_mm: float = quantity(8.0, "mm", "Length of the post (interface post).", minimum=2, maximum=40)
    socket_diameter_mm: float = quantity(5.0, "mm", "Diameter of the socket (interface socket).", minimum=2, maximum=25)
    socket_depth_mm: float = quantity(8.0, "mm", "Depth of the socket (interface socket).", minimum=2, maximum=40)
    cross_bolt_diameter_mm: float = quantity(
        2.2, "mm", "Diameter of the cross bolt's hole through post or socket.", minimum=MIN_HOLE_MM, maximum=6
    )
    flange_width_mm: float = quantity(27.0, "mm", "Width of the flange (interface flange).", minimum=4, maximum=80)
    flange_height_mm: float = quantity(12.0, "mm", "Height of the flange.", minimum=4, maximum=80)
    flange_thickness_mm: float = quantity(
        4.0, "mm", "Thickness of the flange, the proximal part of the base.", minimum=1, maximum=15
    )
    flange_spacing_x_mm: float = quantity(
        20.0, "mm", "Distance between the flange's bolt holes across the finger.", minimum=4, maximum=70
    )
    flange_spacing_y_mm: float = quantity(
        0.0, "mm", "Distance of their two rows from dorsal to palmar; 0: one row of two holes.", minimum=0, maximum=70
    )
    flange_hole_diameter_mm: float = quantity(
        3.2, "mm", "Diameter of the flange's bolt holes (3.2: M3).", minimum=MIN_HOLE_MM, maximum=9
    )
    joint_clearance_mm: float = quantity(
        0.3, "mm", "Gap between bone and hand on every side of the joint (interface clevis).", minimum=0.05, maximum=2
    )
    anchor_diameter_mm: float = quantity(
        1.2, "mm", "Diameter of the hole for the pin or thread that holds the tendon.", minimum=0.8, maximum=4
    )


class Hand(ParameterTable):
    """Joint of the hand on which the fingertip turns (interface clevis), and the length that the hand allows."""

    knuckle: Literal["tongue", "fork"] = choice(
        "tongue", "The hand's part of the joint: a tongue between the cheeks of the bone, or a fork around its tongue."
    )
    width_mm: float = quantity(
        6.5, "mm", "Width of the hand's tongue, or between the cheeks of its fork.", minimum=2, maximum=30
    )
    axis_height_mm: float = quantity(
        7.0, "mm", "Height of the joint axis above the palmar side of the finger.", minimum=1, maximum=60
    )
    pin_diameter_mm: float = quantity(2.0, "mm", "Diameter of the bore for the joint's pin.", minimum=1, maximum=8)
    clearance_radius_mm: float = quantity(
        4.0,
        "mm",
        "Radius about the joint axis within which the hand's tongue or fork is round; its shoulder begins there.",
        minimum=1.5,
        maximum=20,
    )
    tendon_distance_mm: float = quantity(
        4.5,
        "mm",
        "Distance of the tendon from the joint axis, on the palmar side; 0: no tendon.",
        minimum=0,
        maximum=30,
    )
    tendon_diameter_mm: float = quantity(
        0.8, "mm", "Diameter of the tendon, which is knotted around its anchor.", minimum=0.1, maximum=3
    )
    travel_deg: float = quantity(
        80.0,
        "degree",
        "Travel of the joint from straight to bent, between hard stops; 0: no stops.",
        minimum=0,
        maximum=110,
    )
    length_limit_mm: float = quantity(
        0.0,
        "mm",
        "Maximum length from the tip to the joint axis, or to the shoulder of another interface; 0: no limit.",
        minimum=0,
        maximum=150,
    )


class Skin(ParameterTable):
    """Outer shape of the silicone skin, and its thickness over the bone."""

    width_mm: float = quantity(17.0, "mm", "Full width at the proximal end.", minimum=6, maximum=60)
    semi_axis_palmar_mm: float = quantity(
        6.0, "mm", "Height of the pad, measured from the parting plane.", minimum=2, maximum=40
    )
    semi_axis_dorsal_mm: float = quantity(
        7.0, "mm", "Height of the dorsal side, measured from the parting plane.", minimum=2, maximum=40
    )
    length_mm: float = quantity(34.0, "mm", "Length from the proximal end to the tip.", minimum=8, maximum=120)
    tip_length_mm: float = quantity(10.0, "mm", "Length of the rounded tip, part of the length.", minimum=2, maximum=60)
    taper_ratio: float = quantity(
        0.94,
        "",
        "Size of the cross-section where the tip begins, relative to the proximal end.",
        minimum=0.4,
        maximum=1,
    )
    pulp_fullness: float = quantity(
        0.8845,
        "",
        "Width of the pulp at half its height, relative to the full width (0.5: triangle, 0.866: ellipse, 1: box).",
        minimum=0.77,
        maximum=0.9925,
    )
    nail_fullness: float = quantity(
        0.875,
        "",
        "Width of the nail side at half its height, relative to the full width.",
        minimum=0.77,
        maximum=0.9925,
    )
    tip_fullness: float = quantity(
        0.875,
        "",
        "Size of the cross-section halfway along the rounded tip, relative to where the tip begins.",
        minimum=0.77,
        maximum=0.9925,
    )
    thickness_side_mm: float = quantity(2.0, "mm", "Skin thickness at the sides.", minimum=0.4, maximum=15)
    thickness_palmar_mm: float = quantity(
        3.0,
        "mm",
        "Skin thickness over the centre of the sensor, from the bone's flat to the pad's surface.",
        minimum=0.4,
        maximum=20,
    )
    thickness_dorsal_mm: float = quantity(1.5, "mm", "Skin thickness on the dorsal side.", minimum=0.4, maximum=15)
    thickness_tip_mm: float = quantity(
        2.5, "mm", "Skin thickness at the tip, distal to the bone.", minimum=0.4, maximum=20
    )
    min_thickness_mm: float = quantity(
        0.8, "mm", "Minimum skin thickness anywhere, measured from bone to surface.", minimum=0.2, maximum=10
    )


class Mold(ParameterTable):
    """Two-part mold, parted at the plane through the silhouette, and the casting method."""

    method: Literal["overmold", "sleeve"] = choice(
        "overmold",
        "overmold: cast in place around bone and sensor; sleeve: cast around a core, then pulled over the bone.",
    )
    sleeve_interference_mm: float = quantity(
        0.15,
        "mm",
        "Inset of the core from the bone on every side, so that a sleeve fits tightly.",
        minimum=0,
        maximum=1,
    )
    max_stretch_percent: float = quantity(
        100.0,
        "%",
        "Maximum strain of a sleeve while it is pulled over the bone.",
        minimum=5,
        maximum=500,
        verified=False,
    )
    silicone_shrinkage_percent: float = quantity(
        0.2,
        "%",
        "Linear shrinkage of the silicone, by which the cavity and a sleeve's core are enlarged.",
        minimum=0,
        maximum=5,
    )
    wall_mm: float = quantity(
        4.0,
        "mm",
        "Thickness of the mold on the palmar, dorsal and distal sides of the cavity.",
        minimum=1.2,
        maximum=30,
    )
    land_mm: float = quantity(
        3.0, "mm", "Width of the flat land between the cavity and the bolts or keys.", minimum=1, maximum=20
    )
    draft_deg: float = quantity(
        3.0, "degree", "Draft angle of the registration keys and of the recess's walls.", minimum=0, maximum=15
    )
    fit_clearance_mm: float = quantity(
        0.15, "mm", "Gap between the bone's base and its recess in the mold.", minimum=0.02, maximum=1
    )
    recess_length_mm: float = quantity(
        8.0, "mm", "Length of the recess that holds the bone's base.", minimum=2, maximum=60
    )
    gate_diameter_mm: float = quantity(
        3.0, "mm", "Diameter of the gate into the cavity, beside the vent at the tip.", minimum=0.8, maximum=12
    )
    funnel_diameter_mm: float = quantity(
        7.0, "mm", "Diameter of the sprue's funnel at its mouth.", minimum=1, maximum=30
    )
    funnel_depth_mm: float = quantity(4.0, "mm", "Depth of the funnel.", minimum=0.5, maximum=30)
    vent_diameter_mm: float = quantity(
        1.2, "mm", "Diameter of the mold vents, one at the tip and one opposite the gate.", minimum=0.4, maximum=5
    )
    bolt_diameter_mm: float = quantity(
        3.4, "mm", "Diameter of the clamp bolts' clearance holes (3.4: M3).", minimum=MIN_HOLE_MM, maximum=9
    )
    nut_width_mm: float = quantity(
        5.8, "mm", "Width of the nut traps across flats, with clearance.", minimum=2, maximum=16
    )
    nut_depth_mm: float = quantity(2.6, "mm", "Depth of the nut traps.", minimum=0.5, maximum=10)
    key_diameter_mm: float = quantity(
        5.0, "mm", "Diameter of the larger registration key at its root.", minimum=1.5, maximum=20
    )
    key_height_mm: float = quantity(2.5, "mm", "Height of the registration keys.", minimum=0.5, maximum=10)
    key_clearance_mm: float = quantity(0.15, "mm", "Gap around the registration keys.", minimum=0.02, maximum=1)
    pry_width_mm: float = quantity(8.0, "mm", "Width of the slots for prying the halves apart.", minimum=2, maximum=40)
    pry_depth_mm: float = quantity(2.5, "mm", "Depth of the pry slots.", minimum=0.5, maximum=15)
    pry_height_mm: float = quantity(1.2, "mm", "Height of the pry slots at their mouth.", minimum=0.4, maximum=6)
    engraving_height_mm: float = quantity(
        5.0, "mm", "Height of the engraved letters, where they fit.", minimum=3, maximum=20
    )
    engraving_depth_mm: float = quantity(
        0.5, "mm", "Depth of the engraved letters; 0: no engraving.", minimum=0, maximum=2
    )


class Printer(ParameterTable):
    """Printer: build volume, minimum wall and dimensional correction."""

    scale_percent: float = quantity(
        100.0,
        "%",
        "Scale of the printed parts in STL and 3MF, relative to the design; STEP stays at 100.",
        minimum=95,
        maximum=105,
    )
    bed_x_mm: float = quantity(120.0, "mm", "Width of the bed.", minimum=20, maximum=2000)
    bed_y_mm: float = quantity(68.0, "mm", "Depth of the bed.", minimum=20, maximum=2000)
    bed_z_mm: float = quantity(150.0, "mm", "Maximum height of a print.", minimum=20, maximum=2000)
    min_wall_mm: float = quantity(
        0.8,
        "mm",
        "Minimum wall that prints (SLA 0.6 to 0.8, FDM 0.8 to 1); checks of walls allow the mesh tolerance less.",
        minimum=0.1,
        maximum=5,
    )


class Strength(ParameterTable):
    """Loads that the bone must carry, and what it is printed from; for its safety factors."""

    grip_force_n: float = quantity(
        20.0, "N", "Force of a firm grip, at the pad, the apex and the side, in any direction.", minimum=1, maximum=200
    )
    shock_force_n: float = quantity(
        60.0, "N", "Force of a fall or a knock, at the same places.", minimum=1, maximum=500, verified=False
    )
    print_material: Literal["surgical_guide", "clear", "durable", "petg", "pa12"] = choice(
        "surgical_guide", "Material of the bone: three SLA resins, PETG or nylon 12."
    )
    print_direction: Literal["lying", "upright"] = choice(
        "upright", "Direction of the print: layers along the finger (lying) or across it (upright, as the sheet says)."
    )
    root_fillet_mm: float = quantity(
        0.5,
        "mm",
        "Radius that the print leaves at the root of a post or on a flange.",
        minimum=0.05,
        maximum=5,
        verified=False,
    )
    min_grip_factor: float = quantity(
        1.5, "", "Minimum safety factor of the bone at grip_force_n, for its check.", minimum=0, maximum=20
    )
    min_shock_factor: float = quantity(
        0.5, "", "Minimum safety factor of the bone at shock_force_n, for its check.", minimum=0, maximum=20
    )
