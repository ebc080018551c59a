"""Parameters of the fingertip fsr402.

Change numbers and choices, and all parts follow. Lengths are in mm; x is the width, y points to the
back, z to the tip. In brackets stands where the program's rules (walls, fit) allow a number while
all others stay, or what can be chosen. Scripts check bounds alone; `fingertip build` checks the
rules, walls and strength too.
"""

from fingertip_models.finger import Finger, Table

name = "fsr402"  # engraved into the mold

skin = Table(
    # Full width at the proximal end [24.6 to 27.4 mm]
    width_mm=27.0,
    # Height of the pad, at the apex of a crown, from the parting plane [6.76 to 7.5 mm]
    semi_axis_palmar_mm=7.4,
    # Height of the dorsal side, measured from the parting plane [8.08 to 8.88 mm]
    semi_axis_dorsal_mm=8.5,
    # Length from the proximal end to the tip [31.2 to 37.1 mm]
    length_mm=37.0,
    # Length of the rounded tip, part of the length [12.8 to 15.7 mm]
    tip_length_mm=14.0,
    # Size of the cross-section where the tip begins, relative to the proximal end [0.924 to 1]
    taper_ratio=0.97,
    # Width of the pulp at half its height, relative to the full width (0.5: triangle, 0.866:
    # ellipse, 1: box) [0.931 to 0.9925]
    pulp_fullness=0.934,
    # Width of the nail side at half its height, relative to the full width [0.793 to 0.951]
    nail_fullness=0.875,
    # Size of the cross-section halfway along the rounded tip, relative to where the tip begins
    # [0.89 to 0.956]
    tip_fullness=0.914,
    # Radius of the pad's crown along the finger; 0: a straight pad, without a crown [0 or 20.3
    # to 34.8 mm]
    crown_radius_mm=21.0,
    # Distance from the sensor's centre to the apex of the crown, towards the base [-0.53 to
    # 1.64 mm]
    crown_offset_mm=1.2,
    # Height by which the pad at its base lies below the apex of the crown [0 to 1.99 mm]
    crown_drop_mm=1.95,
    # Skin thickness at the sides [1.7 to 2.16 mm]
    thickness_side_mm=1.75,
    # Skin thickness over the centre of the sensor, from its platform or flat to the pad's
    # surface [3.99 to 5.91 mm]
    thickness_palmar_mm=4.0,
    # Skin thickness on the dorsal side [1.38 to 2.48 mm]
    thickness_dorsal_mm=1.43,
    # Skin thickness at the tip, distal to the bone [2.4 to 2.98 mm]
    thickness_tip_mm=2.5,
    # Minimum skin thickness anywhere, measured from bone to surface [0.2 to 0.917 mm]
    min_thickness_mm=0.8,
    # cast: the skin is cast around a core and pulled over the bone, on which it lies;
    # encapsulated: it is cast around the bone with its sensor, as in the article [cast,
    # encapsulated]
    made="cast",
    # Radius of the bump inside the skin, which presses on the sensor [1 to 30 mm]
    bump_radius_mm=7.0,
    # Height by which this bump is proud of the bone's shape; 0: no bump [0 to 1 mm]
    bump_height_mm=0.1,
)

sensor = Table(
    # Force-sensing resistor from the catalogue, or custom: [custom_sensor] then holds its
    # outline [fsr400, fsr400_short, fsr402, fsr402_short, fsr05, fsr04, fsr07, fsr06, rp_c7.6,
    # rp_c7.6_short, custom]
    model="fsr402_short",
    # Distance from the tip of the skin to the centre of the active area [14.2 to 14.9 mm]
    distance_from_tip_mm=14.53,
    # Length by which the crimped tabs stick out of the film. (unverified) [0 to 11.7 mm]
    tab_length_mm=4.3,
    # Outer diameter of the wires on the sensor's tabs [0.934 to 1.3 mm]
    wire_diameter_mm=1.0,
    # Gap around the sensor in its pocket and trough [0.25 to 0.569 mm]
    clearance_mm=0.3,
    # Thickness of the adhesive film under the sensor; it deepens the pocket. (unverified) [0 to
    # 0.5 mm]
    adhesive_thickness_mm=0.13,
)

custom_sensor = Table(
    # Diameter of the active area [1 to 40 mm]
    active_diameter_mm=5.08,
    # Diameter of the round head [2 to 50 mm]
    head_diameter_mm=7.62,
    # Thickness of head and tail [0.05 to 3 mm]
    thickness_mm=0.3,
    # Length from the far edge of the head to the end of the tail [5 to 150 mm]
    length_mm=38.0,
    # Width of the tail [1 to 30 mm]
    tail_width_mm=6.4,
)

bone = Table(
    # Length of the base from the skin's proximal end to the interface, or to the joint axis of
    # a clevis [6.6 to 60 mm]
    base_length_mm=9.0,
    # Width of the bone at half its palmar height, before the flat is cut, relative to its full
    # width [0.925 to 0.998]
    palmar_fullness=0.985,
    # Design width of the rim around the sensor; checks require 95 % of it or, if less, of
    # printer.min_wall_mm [0.2 to 0.786 mm]
    rim_mm=0.45,
    # Height of the platform under the sensor's head above the flat of the bone, down to which
    # the tail runs [0.921 to 2.21 mm]
    platform_mm=0.95,
    # Design wall between cable channel, trough and outer surface; checks require
    # printer.min_wall_mm [0.8 to 2 mm]
    wall_mm=0.8,
    # Diameter of the hole for both wires, from the trough of the tail to the back of the base
    # [2.2 to 3 mm]
    channel_diameter_mm=2.8,
    # Bend radius of the channel's centre line [1.7 to 8.89 mm]
    channel_bend_radius_mm=3.0,
    # Length of the collar on which the skin ends [0.8 to 4.4 mm]
    collar_length_mm=2.0,
    # Inset of the collar from the outline of the skin [0.1 to 0.827 mm]
    collar_inset_mm=0.3,
    # Depth of the groove around the bone that retains the skin; 0: no groove [0 to 3 mm]
    groove_depth_mm=0.8,
    # Width of the groove at its floor [0.5 to 7.4 mm]
    groove_width_mm=1.6,
    # Distance from the collar to the groove [0.5 to 7 mm]
    groove_distance_mm=1.2,
    # Interface to the proximal phalanx. post: a post on the bone, with two flats; socket: a
    # hole for the phalanx's post; flange: a plate with bolt holes; clevis: a joint with a pin,
    # whose sizes stand in [hand]; file: an adapter of your own [post, socket, flange, clevis]
    interface="post",
    # Diameter of the post, which is its width (interface post) [6.46 to 14.8 mm]
    post_width_mm=12.5,
    # Height of the post between its two flats, which lock rotation; from post_width_mm on it is
    # round [4.8 to 9.14 mm]
    post_height_mm=8.0,
    # Length of the post (interface post) [11.5 to 40 mm]
    post_length_mm=14.5,
    # Diameter of the socket (interface socket) [2 to 25 mm]
    socket_diameter_mm=5.0,
    # Depth of the socket (interface socket) [2 to 40 mm]
    socket_depth_mm=8.0,
    # Radius of the fillet where post, flange or eyes stand on the base; none where they are as
    # wide [0.2 to 5 mm]
    foot_radius_mm=2.5,
    # Diameter of the cross bolt's hole through post or socket [1.7 to 5.21 mm]
    cross_bolt_diameter_mm=3.2,
    # Width of the flange (interface flange) [4 to 80 mm]
    flange_width_mm=28.0,
    # Height of the flange [4 to 80 mm]
    flange_height_mm=12.0,
    # Thickness of the flange, the proximal part of the base [1 to 15 mm]
    flange_thickness_mm=4.0,
    # Distance between the flange's bolt holes across the finger [4 to 70 mm]
    flange_spacing_x_mm=22.0,
    # Distance of their two rows from dorsal to palmar; 0: one row of two holes [0 to 70 mm]
    flange_spacing_y_mm=0.0,
    # Diameter of the flange's bolt holes (3.2: M3) [1.7 to 9 mm]
    flange_hole_diameter_mm=3.2,
    # Gap between bone and hand on every side of the joint (interface clevis) [0.05 to 2 mm]
    joint_clearance_mm=0.3,
)

hand = Table(
    # The hand's part of the joint: a tongue between the cheeks of the bone, or a fork around
    # its tongue [tongue, fork]
    knuckle="tongue",
    # Width of the hand's tongue, or between the cheeks of its fork [2 to 30 mm]
    width_mm=6.5,
    # Height of the joint axis above the palmar side of the finger, at the base of its pad [1 to
    # 60 mm]
    axis_height_mm=7.0,
    # Pin of the joint: of steel, such as a dowel pin; or printed of the bone's material, which
    # is weaker [steel, printed]
    pin="steel",
    # Diameter of the bore for the joint's pin [1 to 8 mm]
    pin_diameter_mm=2.0,
    # Radius about the joint axis within which the hand's tongue or fork is round; its shoulder
    # begins there [1.5 to 20 mm]
    clearance_radius_mm=4.0,
    # Distance of the tendon from the joint axis, on the palmar side; 0: no tendon [0 to 30 mm]
    tendon_distance_mm=4.5,
    # Diameter of the tendon, a loop around the bone [0.1 to 3 mm]
    tendon_diameter_mm=0.8,
    # Travel of the joint from straight to bent, between hard stops; 0: no stops [0 to 110
    # degrees]
    travel_deg=80.0,
    # Maximum length from the tip to the joint axis, or to the shoulder of another interface; 0:
    # no limit [0 or 46 to 150 mm]
    length_limit_mm=0.0,
)

mold = Table(
    # Inset of the core from the bone on every side, so that the skin fits tightly [0 to 1 mm]
    core_inset_mm=0.0,
    # Linear shrinkage of the silicone, by which cavity and core are enlarged [0 to 0.653 %]
    silicone_shrinkage_percent=0.1,
    # Thickness of the mold on the palmar, dorsal and distal sides of the cavity [1.8 to 4.58
    # mm]
    wall_mm=4.0,
    # Height of the engraved letters, where they fit [3 to 20 mm]
    engraving_height_mm=5.0,
    # Depth of the engraved letters; 0: no engraving [0 to 2 mm]
    engraving_depth_mm=0.5,
)

printer = Table(
    # Scale of the printed parts in STL and 3MF, relative to the design; STEP stays at 100 [95
    # to 105 %]
    scale_percent=100.0,
    # Error of each printed surface that locates bone or core in the mold [0 to 0.5 mm]
    surface_error_mm=0.05,
    # Length by which printed solids are too long and hollows too short; gaps of the design
    # close by as much [-0.5 to 0.5 mm]
    offset_mm=0.0,
    # Width of the bed [20 to 2000 mm]
    bed_x_mm=180.0,
    # Depth of the bed [20 to 2000 mm]
    bed_y_mm=180.0,
    # Maximum height of a print [20 to 2000 mm]
    bed_z_mm=180.0,
    # Minimum wall that prints (SLA 0.6 to 0.8, FDM 0.8 to 1); checks of walls allow the mesh
    # tolerance less [0.1 to 0.8 mm]
    min_wall_mm=0.8,
)

strength = Table(
    # Force of a firm grip, at the pad, the apex and the side, in any direction [1 to 200 N]
    grip_force_n=15.0,
    # Minimum safety factor of the bone at grip_force_n [0 to 20]
    min_grip_factor=2.0,
    # Mass that moves with the fingertip when it knocks against something hard [0.01 to 10 kg]
    hand_mass_kg=0.4,
    # Speed of that knock, at the same places [0.01 to 10 m/s]
    knock_speed_m_s=0.168,
    # Minimum safety factor of the bone at that knock [0 to 20]
    min_knock_factor=1.5,
    # Material of the bone: three SLA resins, PETG, nylon 12, or own: the figures below then
    # describe it [surgical_guide, clear, durable, petg, pa12, own]
    print_material="petg",
    # Its printer: filament, resin or powder bed [fdm, sla, powder]
    own_process="fdm",
    # Tensile strength across the layers [1 to 500 MPa]
    own_strength_mpa=25.0,
    # Young's modulus [50 to 50000 MPa]
    own_modulus_mpa=2000.0,
)

finger = Finger(
    name,
    skin=skin,
    sensor=sensor,
    custom_sensor=custom_sensor,
    bone=bone,
    hand=hand,
    mold=mold,
    printer=printer,
    strength=strength,
)
