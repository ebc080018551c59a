"""Parameters of mold and printer."""

from __future__ import annotations

from typing import Literal

from fingertip.catalogues.hardware import MIN_HOLE_MM
from fingertip.design.parameters.declaration import ParameterTable, choice, quantity


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
        0.05, "mm", "Gap between the bone's base and its recess in the mold.", minimum=0.01, maximum=1
    )
    recess_length_mm: float = quantity(
        8.0, "mm", "Length of the recess that holds the bone's base.", minimum=2, maximum=60
    )
    seat_tape_mm: float = quantity(
        0.06,
        "mm",
        "Thickness of the tape that is wound around the base or its collar and seals the recess; 0: none.",
        minimum=0,
        maximum=0.2,
    )
    chaplet_diameter_mm: float = quantity(
        7.0,
        "mm",
        "Diameter of the chaplet, the boss on the dorsal half that carries the bone near its tip; 0: none.",
        minimum=0,
        maximum=15,
    )
    chaplet_from_tip_mm: float = quantity(
        10.0, "mm", "Distance of the chaplet from the tip of the skin, along the finger.", minimum=1, maximum=100
    )
    chaplet_screw: Literal["M1.6", "M2", "M2.5", "M3"] = choice(
        "M2", "Screw that holds the bone on the chaplet; it cuts its own thread in the bone."
    )
    filling: Literal["syringe", "gravity"] = choice(
        "syringe",
        "syringe: from below, through a Luer cone in the dorsal half; gravity: poured into a funnel at the tip, for "
        "thin silicones.",
    )
    syringe: Literal["3ml", "5ml", "10ml"] = choice("5ml", "Syringe with a Luer slip tip (filling syringe).")
    thumb_force_n: float = quantity(
        30.0, "N", "Force of the thumb on the plunger; 20 to 40 are usual.", minimum=1, maximum=150
    )
    nozzle_bore_mm: float = quantity(
        2.1,
        "mm",
        "Bore of the syringe's nozzle: measure it, 0.1 mm changes the time by 20 %.",
        minimum=0.3,
        maximum=3.5,
        verified=False,
    )
    runner_width_mm: float = quantity(
        3.0, "mm", "Width of the runner from the sprue to the side of the cavity.", minimum=1, maximum=8
    )
    runner_depth_mm: float = quantity(2.5, "mm", "Depth of the runner, in the dorsal half.", minimum=0.8, maximum=8)
    gate_diameter_mm: float = quantity(
        3.0, "mm", "Diameter of the gate beside the vent at the tip (filling gravity).", minimum=0.8, maximum=12
    )
    funnel_diameter_mm: float = quantity(
        7.0, "mm", "Diameter of the sprue's funnel at its mouth (filling gravity).", minimum=1, maximum=30
    )
    funnel_depth_mm: float = quantity(4.0, "mm", "Depth of the funnel (filling gravity).", minimum=0.5, maximum=30)
    vent_diameter_mm: float = quantity(
        1.2, "mm", "Diameter of the mold's vents, and width of those in the parting plane.", minimum=0.4, maximum=5
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
    surface_error_mm: float = quantity(
        0.05, "mm", "Error of each printed surface that locates bone or core in the mold.", minimum=0, maximum=0.5
    )
    offset_mm: float = quantity(
        0.0,
        "mm",
        "Length by which printed solids are too long and hollows too short; gaps of the design close by as much.",
        minimum=-0.5,
        maximum=0.5,
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
