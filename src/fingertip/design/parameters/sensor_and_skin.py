"""Parameters of the finger: sensor with its force curve, skin with its silicone.

Defaults are the FSR 400 finger's.
"""

from __future__ import annotations

from typing import Annotated, Literal

from fingertip.catalogues.electronics import PART_TO_PART, SENSORS, explain_sensor
from fingertip.catalogues.materials import MaterialProperty, Silicone, load_silicones
from fingertip.design.parameters.declaration import (
    OWN,
    Above,
    OneOf,
    ParameterTable,
    choice,
    quantity,
    text,
)


class Sensor(ParameterTable):
    """Force-sensing resistor, and its pocket in the bone."""

    model: Annotated[str, OneOf(*SENSORS, "custom", explain=explain_sensor)] = choice(
        "fsr400",
        "Force-sensing resistor from the catalogue, or custom: [custom_sensor] then holds its "
        "outline.",
    )
    distance_from_tip_mm: float = quantity(
        11.5,
        "mm",
        (3, 60),
        "Distance from the tip of the skin to the centre of the active area.",
        follows=(6.5, 20),
    )
    tab_length_mm: float = quantity(
        4.3, "mm", (0, 15), "Length by which the crimped tabs stick out of the film. (unverified)"
    )
    wire_diameter_mm: float = quantity(
        1.0, "mm", (0.1, 3), "Outer diameter of the wires on the sensor's tabs."
    )
    clearance_mm: float = quantity(
        0.3, "mm", (0.02, 1), "Gap around the sensor in its pocket and trough."
    )
    adhesive_thickness_mm: float = quantity(
        0.13,
        "mm",
        (0, 0.5),
        "Thickness of the adhesive film under the sensor; it deepens the pocket. (unverified)",
    )


class CustomSensor(ParameterTable):
    """Outline of a sensor that is not in the catalogue; used only if sensor.model is "custom"."""

    active_diameter_mm: float = quantity(5.08, "mm", (1, 40), "Diameter of the active area.")
    head_diameter_mm: float = quantity(7.62, "mm", (2, 50), "Diameter of the round head.")
    thickness_mm: float = quantity(0.3, "mm", (0.05, 3), "Thickness of head and tail.")
    length_mm: float = quantity(
        38.0, "mm", (5, 150), "Length from the far edge of the head to the end of the tail."
    )
    tail_width_mm: float = quantity(6.4, "mm", (1, 30), "Width of the tail.")


class Skin(ParameterTable):
    """Outer shape of the silicone skin, and its thickness over the bone."""

    width_mm: float = quantity(17.0, "mm", (6, 60), "Full width at the proximal end.")
    semi_axis_palmar_mm: float = quantity(
        7.4, "mm", (2, 40), "Height of the pad, at the apex of a crown, from the parting plane."
    )
    semi_axis_dorsal_mm: float = quantity(
        8.1,
        "mm",
        (2, 40),
        "Height of the dorsal side, measured from the parting plane.",
        follows=(5, 14),
    )
    length_mm: float = quantity(34.0, "mm", (8, 120), "Length from the proximal end to the tip.")
    tip_length_mm: float = quantity(
        10.0, "mm", (2, 60), "Length of the rounded tip, part of the length.", follows=(6, 16)
    )
    taper_ratio: float = quantity(
        0.94,
        "",
        (0.4, 1),
        "Size of the cross-section where the tip begins, relative to the proximal end.",
        follows=(0.9, 1),
    )
    pulp_fullness: float = quantity(
        0.91,
        "",
        (0.77, 0.9925),
        "Width of the pulp at half its height, relative to the full width (0.5: triangle, 0.866: "
        "ellipse, 1: box).",
        follows=(0.86, 0.95),
    )
    nail_fullness: float = quantity(
        0.875,
        "",
        (0.77, 0.9925),
        "Width of the nail side at half its height, relative to the full width.",
    )
    tip_fullness: float = quantity(
        0.875,
        "",
        (0.77, 0.9925),
        "Size of the cross-section halfway along the rounded tip, relative to where the tip "
        "begins.",
        follows=(0.85, 0.92),
    )
    crown_radius_mm: float = quantity(
        10.0,
        "mm",
        (0, 100),
        "Radius of the pad's crown along the finger; 0: a straight pad, without a crown.",
        follows=(8, 25),
    )
    crown_offset_mm: float = quantity(
        0.9,
        "mm",
        (-10, 20),
        "Distance from the sensor's centre to the apex of the crown, towards the base.",
        follows=(-2, 4),
    )
    crown_drop_mm: float = quantity(
        2.0,
        "mm",
        (0, 20),
        "Height by which the pad at its base lies below the apex of the crown.",
        follows=(0.5, 4),
    )
    thickness_side_mm: float = quantity(
        1.9, "mm", (0.4, 15), "Skin thickness at the sides.", follows=(1, 2.5)
    )
    thickness_palmar_mm: float = quantity(
        3.0,
        "mm",
        (0.4, 20),
        "Skin thickness over the centre of the sensor, from its platform or flat to the pad's "
        "surface.",
    )
    thickness_dorsal_mm: float = quantity(
        1.5, "mm", (0.4, 15), "Skin thickness on the dorsal side.", follows=(0.8, 2)
    )
    thickness_tip_mm: float = quantity(
        2.6, "mm", (0.4, 20), "Skin thickness at the tip, distal to the bone.", follows=(1.4, 3)
    )
    min_thickness_mm: float = quantity(
        0.8, "mm", (0.2, 10), "Minimum skin thickness anywhere, measured from bone to surface."
    )
    made: Literal["cast", "encapsulated"] = choice(
        "cast",
        "cast: the skin is cast around a core and pulled over the bone, on which it lies; "
        "encapsulated: it is cast around the bone with its sensor, as in the article.",
    )
    bump_radius_mm: float = quantity(
        3.2, "mm", (1, 30), "Radius of the bump inside the skin, which presses on the sensor."
    )
    bump_height_mm: float = quantity(
        0.2,
        "mm",
        (0, 1),
        "Height by which this bump is proud of the bone's shape; 0: no bump.",
        follows=(0.05, 0.3),
    )


_COMPONENTS = {"addition": ("part A", "part B"), "condensation": ("base", "catalyst")}
"""Names of the components of a silicone of one's own, by its cure system."""
_STATED = (
    "parts_a",
    "parts_b",
    "viscosity_pa_s",
    "density_g_cm3",
    "shore_a",
    "modulus_mpa",
    "shrinkage_percent",
    "pot_life_min",
    "cure_h",
    "elongation_percent",
)
"""Properties of a silicone of one's own, which the table states by the same names."""


class ChosenSilicone(ParameterTable):
    """Silicone of the skin. All figures below product are used only if it is "own"; copy them from
    your data sheet.
    """

    product: Annotated[str, OneOf(*load_silicones(), OWN)] = choice(
        "smooth_sil_940", "Silicone from the catalogue, or own: the figures below then describe it."
    )
    label: str = text("own silicone", "Name of the product, for the casting sheet.")
    cure: Literal["addition", "condensation"] = choice(
        "addition",
        "Cure system: addition (platinum; inhibited by uncured resin) or condensation (tin).",
    )
    ratio_by: Literal["weight", "volume"] = choice(
        "weight", "Whether the container states the mix ratio by weight or by volume."
    )
    parts_a: float = quantity(
        10.0, "", (0.1, 1000), "Parts of part A, or base, in the mix ratio on the container."
    )
    parts_b: float = quantity(
        1.0, "", (0.1, 1000), "Parts of part B, catalyst or curing agent, in the same ratio."
    )
    viscosity_pa_s: float = quantity(
        25.0, "Pa s", (0.05, 500), "Viscosity of the mixture; 1000 cps or mPa s are 1 Pa s."
    )
    density_g_cm3: float = quantity(
        1.08, "g/cm3", (0.8, 2.5), "Density of the mixture, or specific gravity."
    )
    pot_life_min: float = quantity(
        30.0, "min", (1, 1440), "Pot life at room temperature, from the start of stirring."
    )
    cure_h: float = quantity(
        24.0, "h", (0.1, 336), "Time at room temperature until the skin can be demolded."
    )
    shore_a: float = quantity(40.0, "", (1, 95), "Hardness of the cured silicone, Shore A.")
    modulus_mpa: float = quantity(
        1.0,
        "MPa",
        (0.01, 50),
        "Young's modulus at small strain; without one, 1.7 times the stress at 100 % strain (145 "
        "psi are 1 MPa).",
    )
    elongation_percent: float = quantity(300.0, "%", (10, 2000), "Elongation at break.")
    shrinkage_percent: float = quantity(
        0.2, "%", (0, 5), "Linear shrinkage; 0.001 in/in are 0.1 %."
    )

    @property
    def material(self) -> Silicone:
        """Silicone of the catalogue, or the one that the user's own figures describe."""
        if self.product != OWN:
            return load_silicones()[self.product]

        stated = {}
        for name in _STATED:
            value = getattr(self, name)
            stated[name] = MaterialProperty(value, value, "design")

        return Silicone(
            name=OWN,
            label=self.label,
            cure=self.cure,
            components=_COMPONENTS[self.cure],
            ratio_by=self.ratio_by,
            **stated,
        )


TURN_ON_N = 0.2
"""Force [N] below which a typical sensor is open: 20 gram force (Interlink), a light contact in the
article.
"""


class ForceCurve(ParameterTable):
    """Conductance of the sensor over force; the figures are used only if curve is "calibrated"."""

    curve: Literal["typical", "calibrated"] = choice(
        "typical",
        "typical: Interlink's curve, from which real sensors differ by factors; calibrated: the "
        "figures below, which "
        "`fingertip calibrate sensor` finds.",
    )
    turn_on_n: float = quantity(
        TURN_ON_N, "N", (0, 5), "Force at which the sensor begins to conduct."
    )
    conductance_us: float = quantity(
        190.0, "uS", (Above(0), 1e5), "Conductance at a force of 1 N above turn_on_n."
    )
    exponent: float = quantity(
        0.52, "", (0.1, 3), "Exponent of the conductance over the force above turn_on_n."
    )
    min_force_n: float = quantity(0.5, "N", (Above(0), 100), "Smallest force of the calibration.")
    max_force_n: float = quantity(10.0, "N", (Above(0), 1000), "Largest force of the calibration.")
    interval_factor: float = quantity(
        8.0,
        "",
        (1, 1000),
        "Factor within which a force read off the curve lies with 95 % probability, between these "
        "two forces.",
    )

    def find_doubt(self, model: str) -> list[str]:
        """Find why no voltage under a weight is known, in a
        sentence; nothing for a sensor that has the curve.
        """
        if self.curve == "calibrated" or (model in SENSORS and SENSORS[model].maker == "Interlink"):
            return []

        return [
            "forces hold for Interlink's sensors; calibrate this one first: fingertip calibrate "
            "sensor"
        ]

    def describe(self, model: str) -> str:
        """Describe in a sentence how far forces can be trusted for
        a sensor, for wherever a force is shown.
        """
        if self.curve == "calibrated":
            return (
                "forces hold for the calibrated sensor, within a factor of "
                f"{self.interval_factor:.3g} (95 %) between "
                f"{self.min_force_n:g} and {self.max_force_n:g} N"
            )

        doubt = self.find_doubt(model)
        if doubt:
            return doubt[0]

        usual, bad = PART_TO_PART
        return (
            "forces hold for a typical sensor; the readings of real ones differ by a factor of "
            f"{usual:g} to {bad:g} "
            "at the same force, so calibrate yours: fingertip calibrate sensor"
        )
