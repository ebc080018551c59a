"""Parameters of the bone: its shape, the hand that it fits, and the loads that it carries."""

from __future__ import annotations

from typing import Literal

from fingertip.catalogues.hardware import MIN_HOLE_MM
from fingertip.design.parameters.declaration import ParameterTable, choice, quantity


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
