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
        0.15, "mm", (0, 1), "Inset of the core from the bone on every side, so that a sleeve fits tightly."
    )
    max_stretch_percent: float = quantity(
        100.0, "%", (5, 500), "Maximum strain of a sleeve while it is pulled over the bone. (unverified)"
    )
    silicone_shrinkage_percent: float = quantity(
        0.2, "%", (0, 5), "Linear shrinkage of the silicone, by which the cavity and a sleeve's core are enlarged."
    )
    wall_mm: float = quantity(
        4.0, "mm", (1.2, 30), "Thickness of the mold on the palmar, dorsal and distal sides of the cavity."
    )
    land_mm: float = quantity(3.0, "mm", (1, 20), "Width of the flat land between the cavity and the bolts or keys.")
    draft_deg: float = quantity(
        3.0, "degree", (0, 15), "Draft angle of the registration keys and of the recess's walls."
    )
    fit_clearance_mm: float = quantity(0.05, "mm", (0.01, 1), "Gap between the bone's base and its recess in the mold.")
    recess_length_mm: float = quantity(8.0, "mm", (2, 60), "Length of the recess that holds the bone's base.")
    seat_tape_mm: float = quantity(
        0.06, "mm", (0, 0.2),
        "Thickness of the tape that is wound around the base or its collar and seals the recess; 0: none.",
    )  # fmt: skip
    chaplet_diameter_mm: float = quantity(
        7.0, "mm", (0, 15),
        "Diameter of the chaplet, the boss on the dorsal half that carries the bone near its tip; 0: none.",
    )  # fmt: skip
    chaplet_from_tip_mm: float = quantity(
        10.3, "mm", (1, 100), "Distance of the chaplet from the tip of the skin, along the finger."
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
    thumb_force_n: float = quantity(30.0, "N", (1, 150), "Force of the thumb on the plunger; 20 to 40 are usual.")
    nozzle_bore_mm: float = quantity(
        2.1, "mm", (0.3, 3.5), "Bore of the syringe's nozzle: measure it, 0.1 mm changes the time by 20 %. (unverified)"
    )
    runner_width_mm: float = quantity(
        3.0, "mm", (1, 8), "Width of the runner from the sprue to the side of the cavity."
    )
    runner_depth_mm: float = quantity(2.5, "mm", (0.8, 8), "Depth of the runner, in the dorsal half.")
    gate_diameter_mm: float = quantity(
        3.0, "mm", (0.8, 12), "Diameter of the gate beside the vent at the tip (filling gravity)."
    )
    funnel_diameter_mm: float = quantity(
        7.0, "mm", (1, 30), "Diameter of the sprue's funnel at its mouth (filling gravity)."
    )
    funnel_depth_mm: float = quantity(4.0, "mm", (0.5, 30), "Depth of the funnel (filling gravity).")
    vent_diameter_mm: float = quantity(
        1.2, "mm", (0.4, 5), "Diameter of the mold's vents, and width of those in the parting plane."
    )
    bolt_diameter_mm: float = quantity(
        3.4, "mm", (MIN_HOLE_MM, 9), "Diameter of the clamp bolts' clearance holes (3.4: M3)."
    )
    nut_width_mm: float = quantity(5.8, "mm", (2, 16), "Width of the nut traps across flats, with clearance.")
    nut_depth_mm: float = quantity(2.6, "mm", (0.5, 10), "Depth of the nut traps.")
    key_diameter_mm: float = quantity(5.0, "mm", (1.5, 20), "Diameter of the larger registration key at its root.")
    key_height_mm: float = quantity(2.5, "mm", (0.5, 10), "Height of the registration keys.")
    key_clearance_mm: float = quantity(0.15, "mm", (0.02, 1), "Gap around the registration keys.")
    pry_width_mm: float = quantity(8.0, "mm", (2, 40), "Width of the slots for prying the halves apart.")
    pry_depth_mm: float = quantity(2.5, "mm", (0.5, 15), "Depth of the pry slots.")
    pry_height_mm: float = quantity(1.2, "mm", (0.4, 6), "Height of the pry slots at their mouth.")
    engraving_height_mm: float = quantity(5.0, "mm", (3, 20), "Height of the engraved letters, where they fit.")
    engraving_depth_mm: float = quantity(0.5, "mm", (0, 2), "Depth of the engraved letters; 0: no engraving.")


class Printer(ParameterTable):
    """Printer: build volume, minimum wall and dimensional correction."""

    scale_percent: float = quantity(
        100.0, "%", (95, 105), "Scale of the printed parts in STL and 3MF, relative to the design; STEP stays at 100."
    )
    surface_error_mm: float = quantity(
        0.05, "mm", (0, 0.5), "Error of each printed surface that locates bone or core in the mold."
    )
    offset_mm: float = quantity(
        0.0, "mm", (-0.5, 0.5),
        "Length by which printed solids are too long and hollows too short; gaps of the design close by as much.",
    )  # fmt: skip
    bed_x_mm: float = quantity(120.0, "mm", (20, 2000), "Width of the bed.")
    bed_y_mm: float = quantity(68.0, "mm", (20, 2000), "Depth of the bed.")
    bed_z_mm: float = quantity(150.0, "mm", (20, 2000), "Maximum height of a print.")
    min_wall_mm: float = quantity(
        0.8, "mm", (0.1, 5),
        "Minimum wall that prints (SLA 0.6 to 0.8, FDM 0.8 to 1); checks of walls allow the mesh tolerance less.",
    )  # fmt: skip
