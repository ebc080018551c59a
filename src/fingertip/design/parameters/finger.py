"""Parameters of the finger: sensor and skin. The defaults are the FSR 400 finger's."""

from __future__ import annotations

from typing import Literal

from fingertip.design.parameters.declaration import ParameterTable, choice, quantity


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
