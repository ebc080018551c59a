"""Parameters of the bone, the hand that it fits, the loads that it carries, mold and printer."""

from __future__ import annotations

from typing import Annotated, Literal

from fingertip.catalogues.hardware import MIN_HOLE_MM
from fingertip.catalogues.materials import PRINT_MATERIALS, PrintMaterial
from fingertip.design.parameters.declaration import (
    OWN,
    OneOf,
    ParameterTable,
    choice,
    quantity,
    text,
)

_OWN_G_CM3 = 1.2
"""Density of a printing material of one's own [g/cm3]; the others have 1.01 to 1.27."""


class Bone(ParameterTable):
    """Rigid part that carries the sensor, and its interface to the proximal phalanx."""

    base_length_mm: float = quantity(
        19.7,
        "mm",
        (4, 60),
        "Length of the base from the skin's proximal end to the interface, or to the joint axis "
        "of a clevis.",
        follows=(8, 40),
    )
    palmar_fullness: float = quantity(
        0.966,
        "",
        (0.8, 0.998),
        "Width of the bone at half its palmar height, before the flat is cut, relative to its "
        "full width.",
        follows=(0.92, 0.99),
    )
    rim_mm: float = quantity(
        0.6,
        "mm",
        (0.2, 5),
        "Design width of the rim around the sensor; checks require 95 % of it or, if less, of "
        "printer.min_wall_mm.",
        follows=(0.3, 0.6),
    )
    platform_mm: float = quantity(
        1.7,
        "mm",
        (0, 10),
        "Height of the platform under the sensor's head above the flat of the bone, down to which "
        "the tail runs.",
        follows=(0.5, 4),
    )
    wall_mm: float = quantity(
        0.8,
        "mm",
        (0.4, 5),
        "Design wall between cable channel, trough and outer surface; checks require "
        "printer.min_wall_mm.",
    )
    channel_diameter_mm: float = quantity(
        2.8,
        "mm",
        (0.8, 10),
        "Diameter of the hole for both wires, from the trough of the tail to the back of the base.",
        follows=(2.2, 2.8),
    )
    channel_bend_radius_mm: float = quantity(
        3.0, "mm", (1, 20), "Bend radius of the channel's centre line.", follows=(1, 4)
    )
    collar_length_mm: float = quantity(
        2.0,
        "mm",
        (0.8, 10),
        "Length of the collar on which the skin ends.",
        follows=(0.8, 8),
    )
    collar_inset_mm: float = quantity(
        0.3,
        "mm",
        (0.1, 5),
        "Inset of the collar from the outline of the skin.",
        follows=(0.25, 0.6),
    )
    groove_depth_mm: float = quantity(
        0.8,
        "mm",
        (0, 3),
        "Depth of the groove around the bone that retains the skin; 0: no groove.",
        follows=(0, 1),
    )
    groove_width_mm: float = quantity(1.6, "mm", (0.5, 15), "Width of the groove at its floor.")
    groove_distance_mm: float = quantity(
        1.2, "mm", (0.5, 60), "Distance from the collar to the groove.", follows=(0.6, 8)
    )
    interface: Literal["post", "socket", "flange", "clevis", "file"] = choice(
        "post",
        "Interface to the proximal phalanx. post: a post on the bone, with two flats; socket: a "
        "hole for the phalanx's "
        "post; flange: a plate with bolt holes; clevis: a joint with a pin, whose sizes stand in "
        "[hand]; file: an "
        "adapter of your own.",
    )
    post_width_mm: float = quantity(
        10.8,
        "mm",
        (2, 40),
        "Diameter of the post, which is its width (interface post).",
        follows=(6, 16),
    )
    post_height_mm: float = quantity(
        8.0,
        "mm",
        (2, 40),
        "Height of the post between its two flats, which lock rotation; from post_width_mm on it "
        "is round.",
        follows=(5, 14),
    )
    post_length_mm: float = quantity(14.5, "mm", (2, 40), "Length of the post (interface post).")
    socket_diameter_mm: float = quantity(
        5.0, "mm", (2, 25), "Diameter of the socket (interface socket)."
    )
    socket_depth_mm: float = quantity(8.0, "mm", (2, 40), "Depth of the socket (interface socket).")
    foot_radius_mm: float = quantity(
        2.5,
        "mm",
        (0.2, 5),
        "Radius of the fillet where post, flange or eyes stand on the base; none where they are "
        "as wide.",
        follows=(0.5, 4),
    )
    cross_bolt_diameter_mm: float = quantity(
        3.2, "mm", (MIN_HOLE_MM, 6), "Diameter of the cross bolt's hole through post or socket."
    )
    flange_width_mm: float = quantity(
        30.0, "mm", (4, 80), "Width of the flange (interface flange)."
    )
    flange_height_mm: float = quantity(12.0, "mm", (4, 80), "Height of the flange.")
    flange_thickness_mm: float = quantity(
        4.0, "mm", (1, 15), "Thickness of the flange, the proximal part of the base."
    )
    flange_spacing_x_mm: float = quantity(
        24.0, "mm", (4, 70), "Distance between the flange's bolt holes across the finger."
    )
    flange_spacing_y_mm: float = quantity(
        0.0,
        "mm",
        (0, 70),
        "Distance of their two rows from dorsal to palmar; 0: one row of two holes.",
    )
    flange_hole_diameter_mm: float = quantity(
        3.2, "mm", (MIN_HOLE_MM, 9), "Diameter of the flange's bolt holes (3.2: M3)."
    )
    adapter_file: str = choice(
        "",
        "STEP or STL file of the adapter, beside the design file; with --set, its path (interface "
        "file).",
    )
    adapter_x_mm: float = quantity(
        0.0,
        "mm",
        (-1000, 1000),
        "Point of the adapter, in its file, that meets the middle of the end of the base.",
    )
    adapter_y_mm: float = quantity(0.0, "mm", (-1000, 1000), "Second coordinate of this point.")
    adapter_z_mm: float = quantity(0.0, "mm", (-1000, 1000), "Third coordinate of this point.")
    adapter_axis: Literal["x", "-x", "y", "-y", "z", "-z"] = choice(
        "z",
        "Direction in the file that points to the tip; across it through the point, a plane meets "
        "the base.",
    )
    adapter_turn_deg: float = quantity(
        0.0,
        "degree",
        (-180, 180),
        "Turn of the adapter about this direction, counter-clockwise seen from the tip.",
    )
    adapter_free_mm: float = quantity(
        0.0, "mm", (0, 100), "Length of the adapter from the base on that the hand does not hold."
    )
    joint_clearance_mm: float = quantity(
        0.3,
        "mm",
        (0.05, 2),
        "Gap between bone and hand on every side of the joint (interface clevis).",
    )


class Hand(ParameterTable):
    """Joint of the hand on which the fingertip turns (interface
    clevis), and the length that the hand allows.
    """

    knuckle: Literal["tongue", "fork"] = choice(
        "tongue",
        "The hand's part of the joint: a tongue between the cheeks of the bone, or a fork around "
        "its tongue.",
    )
    width_mm: float = quantity(
        6.5, "mm", (2, 30), "Width of the hand's tongue, or between the cheeks of its fork."
    )
    axis_height_mm: float = quantity(
        7.0,
        "mm",
        (1, 60),
        "Height of the joint axis above the palmar side of the finger, at the base of its pad.",
    )
    pin: Literal["steel", "printed"] = choice(
        "steel",
        "Pin of the joint: of steel, such as a dowel pin; or printed of the bone's material, "
        "which is weaker.",
    )
    pin_diameter_mm: float = quantity(
        2.0, "mm", (1, 8), "Diameter of the bore for the joint's pin."
    )
    clearance_radius_mm: float = quantity(
        4.0,
        "mm",
        (1.5, 20),
        "Radius about the joint axis within which the hand's tongue or fork is round; its "
        "shoulder begins there.",
    )
    tendon_distance_mm: float = quantity(
        4.5,
        "mm",
        (0, 30),
        "Distance of the tendon from the joint axis, on the palmar side; 0: no tendon.",
    )
    tendon_diameter_mm: float = quantity(
        0.8, "mm", (0.1, 3), "Diameter of the tendon, a loop around the bone."
    )
    travel_deg: float = quantity(
        80.0,
        "degree",
        (0, 110),
        "Travel of the joint from straight to bent, between hard stops; 0: no stops.",
    )
    length_limit_mm: float = quantity(
        0.0,
        "mm",
        (0, 150),
        "Maximum length from the tip to the joint axis, or to the shoulder of another interface; "
        "0: no limit.",
    )


class Strength(ParameterTable):
    """Loads that the bone must carry, and what it is printed from. The figures named own are
    used only with "own".
    """

    grip_force_n: float = quantity(
        8.0,
        "N",
        (1, 200),
        "Force of a firm grip, at the pad, the apex and the side, in any direction.",
    )
    min_grip_factor: float = quantity(
        2.0, "", (0, 20), "Minimum safety factor of the bone at grip_force_n."
    )
    hand_mass_kg: float = quantity(
        0.4,
        "kg",
        (0.01, 10),
        "Mass that moves with the fingertip when it knocks against something hard.",
    )
    knock_speed_m_s: float = quantity(
        0.145, "m/s", (0.01, 10), "Speed of that knock, at the same places."
    )
    min_knock_factor: float = quantity(
        1.5, "", (0, 20), "Minimum safety factor of the bone at that knock."
    )
    print_material: Annotated[str, OneOf(*PRINT_MATERIALS, OWN)] = choice(
        "petg",
        "Material of the bone: three SLA resins, PETG, nylon 12, or own: the figures below then "
        "describe it.",
    )
    own_label: str = text("own material", "Name of the material, for the sheets.")
    own_source: str = text("own test", "Where its figures come from.")
    own_process: Literal["fdm", "sla", "powder"] = choice(
        "fdm", "Its printer: filament, resin or powder bed."
    )
    own_strength_mpa: float = quantity(25.0, "MPa", (1, 500), "Tensile strength across the layers.")
    own_modulus_mpa: float = quantity(2000.0, "MPa", (50, 50000), "Young's modulus.")

    @property
    def material(self) -> PrintMaterial:
        """Material of the catalogue, or the one that the user's own figures describe."""
        if self.print_material != OWN:
            return PRINT_MATERIALS[self.print_material]

        return PrintMaterial(
            name=OWN,
            product=self.own_label,
            remark="",
            process=self.own_process,
            strength_mpa=self.own_strength_mpa,
            modulus_mpa=self.own_modulus_mpa,
            density_g_cm3=_OWN_G_CM3,
            source=self.own_source,
            verified=(),
        )


class Mold(ParameterTable):
    """Cup of two halves, parted at the plane through the
    silhouette, and the core that is lowered into it.
    """

    core_inset_mm: float = quantity(
        0.0,
        "mm",
        (0, 1),
        "Inset of the core from the bone on every side, so that the skin fits tightly.",
    )
    silicone_shrinkage_percent: float = quantity(
        0.1, "%", (0, 5), "Linear shrinkage of the silicone, by which cavity and core are enlarged."
    )
    wall_mm: float = quantity(
        4.0,
        "mm",
        (1.2, 30),
        "Thickness of the mold on the palmar, dorsal and distal sides of the cavity.",
    )
    engraving_height_mm: float = quantity(
        5.0, "mm", (3, 20), "Height of the engraved letters, where they fit."
    )
    engraving_depth_mm: float = quantity(
        0.5, "mm", (0, 2), "Depth of the engraved letters; 0: no engraving."
    )


class Printer(ParameterTable):
    """Printer: build volume, minimum wall and dimensional correction."""

    scale_percent: float = quantity(
        100.0,
        "%",
        (95, 105),
        "Scale of the printed parts in STL and 3MF, relative to the design; STEP stays at 100.",
    )
    surface_error_mm: float = quantity(
        0.05, "mm", (0, 0.5), "Error of each printed surface that locates bone or core in the mold."
    )
    offset_mm: float = quantity(
        0.0,
        "mm",
        (-0.5, 0.5),
        "Length by which printed solids are too long and hollows too short; gaps of the design "
        "close by as much.",
    )
    bed_x_mm: float = quantity(180.0, "mm", (20, 2000), "Width of the bed.")
    bed_y_mm: float = quantity(180.0, "mm", (20, 2000), "Depth of the bed.")
    bed_z_mm: float = quantity(180.0, "mm", (20, 2000), "Maximum height of a print.")
    min_wall_mm: float = quantity(
        0.8,
        "mm",
        (0.1, 5),
        "Minimum wall that prints (SLA 0.6 to 0.8, FDM 0.8 to 1); checks of walls allow the mesh "
        "tolerance less.",
    )
