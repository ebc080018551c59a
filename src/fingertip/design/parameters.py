"""The tables of a design file. Every parameter stands here once: default (FSR 400), unit, bounds, meaning."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from fingertip.design.threads import MIN_HOLE_MM


class ParameterTable(BaseModel):
    """A table of the design file: frozen, and strict about what it accepts."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def quantity(
    default: float,
    unit: str,
    meaning: str,
    *,
    minimum: float | None = None,
    above: float | None = None,
    maximum: float | None = None,
    verified: bool = True,
) -> Any:
    """A number with a unit.

    Parameters
    ----------
    default
        Value used when the file is silent.
    unit
        What the number counts ("mm", "Hz", "" for a ratio); the field's name carries it too.
    meaning
        One sentence for `fingertip params` and for editors.
    least, above, most
        Closed lower, open lower and closed upper bound, in `unit`.
    verified
        False marks a figure no document was found for.
    """
    if not verified:
        meaning += " (unverified figure)"
    return Field(default, ge=minimum, gt=above, le=maximum, description=meaning, json_schema_extra={"unit": unit})


def choice(default: str, meaning: str) -> Any:
    """A word out of a fixed list (the list stands in the field's Literal type)."""
    return Field(default, description=meaning)


class Sensor(ParameterTable):
    """Which force-sensing resistor, and how it is let into the bone."""

    model: Literal["fsr400", "fsr400_short", "fsr402", "fsr402_short", "custom"] = choice(
        "fsr400", "Force-sensing resistor of the catalogue, or custom: then [custom_sensor] holds its outline."
    )
    distance_from_tip_mm: float = quantity(
        11.5, "mm", "From the skin's tip to the middle of the active area.", minimum=3, maximum=60
    )
    clearance_mm: float = quantity(0.15, "mm", "Gap around the sensor in its pocket and slot.", minimum=0.02, maximum=1)
    adhesive_thickness_mm: float = quantity(
        0.13,
        "mm",
        "Adhesive film under the sensor; the pocket is deeper by this.",
        minimum=0,
        maximum=0.5,
        verified=False,
    )


class CustomSensor(ParameterTable):
    """Outline of a sensor that is not in the catalogue; read only where sensor.model is "custom"."""

    active_diameter_mm: float = quantity(5.08, "mm", "Diameter of the active area.", minimum=1, maximum=40)
    head_diameter_mm: float = quantity(7.62, "mm", "Diameter of the round head.", minimum=2, maximum=50)
    thickness_mm: float = quantity(0.3, "mm", "Thickness of head and tail.", minimum=0.05, maximum=3)
    length_mm: float = quantity(
        38.0, "mm", "From the far edge of the head to the end of the tail.", minimum=5, maximum=150
    )
    tail_width_mm: float = quantity(6.4, "mm", "Width of the tail.", minimum=1, maximum=30)


class Bone(ParameterTable):
    """The rigid core that carries the sensor, and its interface to the proximal phalanx."""

    base_length_mm: float = quantity(
        22.0, "mm", "Bone between the skin's end and the interface.", minimum=4, maximum=60
    )
    squareness_palmar: float = quantity(
        1.3, "", "Conic weight of the palmar edges: 0.71 round, 2 nearly a box.", minimum=0.5, maximum=8
    )
    rim_mm: float = quantity(0.6, "mm", "Flat bone left around the sensor's head.", minimum=0.2, maximum=5)
    wall_mm: float = quantity(
        1.0, "mm", "Thinnest bone left between channel, slot and outside.", minimum=0.4, maximum=5
    )
    channel_diameter_mm: float = quantity(
        2.4, "mm", "Cable channel from the solder tabs to the back.", minimum=0.8, maximum=10
    )
    channel_bend_radius_mm: float = quantity(
        3.0, "mm", "Bend radius of the channel's centre line.", minimum=1, maximum=20
    )
    relief_length_mm: float = quantity(
        5.0, "mm", "Recess around the end of the tail for the solder joints.", minimum=2, maximum=20
    )
    tie_hole_diameter_mm: float = quantity(
        1.6,
        "mm",
        "Hole across the back below the posterior hole: a tie through it takes the pull off the cables.",
        minimum=0.8,
        maximum=6,
    )
    collar_length_mm: float = quantity(
        2.0,
        "mm",
        "Collar on which the skin ends, at the parting plane; the draft shortens it elsewhere.",
        minimum=0.8,
        maximum=10,
    )
    collar_inset_mm: float = quantity(
        0.3, "mm", "How far the collar stays inside the skin's outline.", minimum=0.1, maximum=5
    )
    groove_depth_mm: float = quantity(
        0.6, "mm", "Groove around the bone that holds the skin; 0: none.", minimum=0, maximum=3
    )
    groove_width_mm: float = quantity(3.0, "mm", "Width of the groove at its floor.", minimum=0.5, maximum=15)
    groove_distance_mm: float = quantity(2.0, "mm", "From the collar to the groove.", minimum=0.5, maximum=60)
    interface: Literal["plain", "socket"] = choice(
        "plain", "To the proximal phalanx: plain, a post that enters it; socket, a hole that takes its post."
    )
    post_diameter_mm: float = quantity(7.0, "mm", "Diameter of the post (plain).", minimum=2, maximum=25)
    post_length_mm: float = quantity(8.0, "mm", "Length of the post (plain).", minimum=2, maximum=40)
    socket_diameter_mm: float = quantity(5.0, "mm", "Diameter of the socket (socket).", minimum=2, maximum=25)
    socket_depth_mm: float = quantity(8.0, "mm", "Depth of the socket (socket).", minimum=2, maximum=40)
    cross_bolt_diameter_mm: float = quantity(
        2.2, "mm", "Hole through post or socket for the cross bolt.", minimum=MIN_HOLE_MM, maximum=6
    )


class Skin(ParameterTable):
    """The silicone's outer form and its thickness over the bone."""

    width_mm: float = quantity(17.0, "mm", "Full width where the skin begins.", minimum=6, maximum=60)
    semi_axis_palmar_mm: float = quantity(
        6.0, "mm", "Height of the pad below the parting plane.", minimum=2, maximum=40
    )
    semi_axis_dorsal_mm: float = quantity(
        7.0, "mm", "Height of the back above the parting plane.", minimum=2, maximum=40
    )
    length_mm: float = quantity(34.0, "mm", "From the skin's end to its tip.", minimum=8, maximum=120)
    tip_length_mm: float = quantity(10.0, "mm", "Length of the rounded tip within the length.", minimum=2, maximum=60)
    taper_ratio: float = quantity(
        0.94, "", "Scale of the section where the tip begins, against the skin's end.", minimum=0.4, maximum=1
    )
    squareness_palmar: float = quantity(
        0.8, "", "Conic weight of the pad's arcs (0.71: ellipse).", minimum=0.4, maximum=4
    )
    squareness_dorsal: float = quantity(
        0.75, "", "Conic weight of the back's arcs (0.71: ellipse).", minimum=0.4, maximum=4
    )
    squareness_tip: float = quantity(
        0.75, "", "Conic weight of the tip's profile (0.71: ellipse).", minimum=0.4, maximum=4
    )
    thickness_side_mm: float = quantity(2.0, "mm", "Silicone at the sides.", minimum=0.4, maximum=15)
    thickness_palmar_mm: float = quantity(
        3.0,
        "mm",
        "Silicone over the middle of the sensor, from the bone's flat to the pad.",
        minimum=0.4,
        maximum=20,
    )
    thickness_dorsal_mm: float = quantity(1.5, "mm", "Silicone on the back.", minimum=0.4, maximum=15)
    thickness_tip_mm: float = quantity(2.5, "mm", "Silicone in front of the bone.", minimum=0.4, maximum=20)
    min_thickness_mm: float = quantity(
        0.8, "mm", "Thinnest place allowed, measured between bone and surface.", minimum=0.2, maximum=10
    )


class Mold(ParameterTable):
    """Two halves parted at the plane through the silhouette, and how the skin is cast in them."""

    method: Literal["overmold", "sleeve"] = choice(
        "overmold", "overmold: cast around bone and sensor; sleeve: around a dummy core, then pulled over the bone."
    )
    sleeve_interference_mm: float = quantity(
        0.15,
        "mm",
        "How much smaller than the bone the core is all round, so that a sleeve sits tight.",
        minimum=0,
        maximum=1,
    )
    max_stretch_percent: float = quantity(
        100.0,
        "%",
        "Most a sleeve may stretch while it is pulled over the bone.",
        minimum=5,
        maximum=500,
        verified=False,
    )
    silicone_shrinkage_percent: float = quantity(
        0.2,
        "%",
        "Linear shrinkage of the silicone; the cavity (and a sleeve's core) is larger by it.",
        minimum=0,
        maximum=5,
    )
    wall_mm: float = quantity(4.0, "mm", "Mold below, above and behind the cavity.", minimum=1.2, maximum=30)
    land_mm: float = quantity(3.0, "mm", "Flat left between the cavity and bolts or keys.", minimum=1, maximum=20)
    draft_deg: float = quantity(
        3.0, "degree", "Draft of the registration keys and of the recess's walls.", minimum=0, maximum=15
    )
    fit_clearance_mm: float = quantity(
        0.15, "mm", "Gap between the bone's base and its recess.", minimum=0.02, maximum=1
    )
    recess_length_mm: float = quantity(
        8.0, "mm", "Length of the recess that holds the bone's base.", minimum=2, maximum=60
    )
    gate_diameter_mm: float = quantity(3.0, "mm", "Gate into the cavity, beside the apex.", minimum=0.8, maximum=12)
    funnel_diameter_mm: float = quantity(7.0, "mm", "Mouth of the sprue's funnel.", minimum=1, maximum=30)
    funnel_depth_mm: float = quantity(4.0, "mm", "Depth of the funnel.", minimum=0.5, maximum=30)
    vent_diameter_mm: float = quantity(1.2, "mm", "Vent at the apex and opposite the gate.", minimum=0.4, maximum=5)
    bolt_diameter_mm: float = quantity(
        3.4, "mm", "Clearance hole of the clamp bolts (M3).", minimum=MIN_HOLE_MM, maximum=9
    )
    nut_width_mm: float = quantity(5.8, "mm", "Nut trap across flats, with clearance.", minimum=2, maximum=16)
    nut_depth_mm: float = quantity(2.6, "mm", "Depth of the nut trap.", minimum=0.5, maximum=10)
    key_diameter_mm: float = quantity(5.0, "mm", "Root of the larger registration key.", minimum=1.5, maximum=20)
    key_height_mm: float = quantity(2.5, "mm", "Height of the registration keys.", minimum=0.5, maximum=10)
    key_clearance_mm: float = quantity(0.15, "mm", "Gap around the registration keys.", minimum=0.02, maximum=1)
    pry_width_mm: float = quantity(8.0, "mm", "Width of the slots to pry the halves apart.", minimum=2, maximum=40)
    pry_depth_mm: float = quantity(2.5, "mm", "Depth of the pry slots.", minimum=0.5, maximum=15)
    pry_height_mm: float = quantity(1.2, "mm", "Height of the pry slots at their mouth.", minimum=0.4, maximum=6)
    engraving_height_mm: float = quantity(
        5.0, "mm", "Height of the engraved letters, where they find room.", minimum=3, maximum=20
    )
    engraving_depth_mm: float = quantity(0.5, "mm", "Depth of the letters; 0: none.", minimum=0, maximum=2)


class Printer(ParameterTable):
    """The printer: what it can hold, what it can draw, and how far off its prints are."""

    scale_percent: float = quantity(
        100.0,
        "%",
        "Scale of the printed parts' STL and 3MF against the design; STEP stays at 100.",
        minimum=95,
        maximum=105,
    )
    bed_x_mm: float = quantity(120.0, "mm", "Width of the bed.", minimum=20, maximum=2000)
    bed_y_mm: float = quantity(68.0, "mm", "Depth of the bed.", minimum=20, maximum=2000)
    bed_z_mm: float = quantity(150.0, "mm", "Height that can be printed.", minimum=20, maximum=2000)
    min_wall_mm: float = quantity(
        0.8, "mm", "Thinnest wall that prints (SLA 0.6 to 0.8, FDM 0.8 to 1).", minimum=0.1, maximum=5
    )


class Board(ParameterTable):
    """The analog slip filter (article, eqs. 1 to 11 and figure 3)."""

    variant: Literal["article", "precision", "comparator"] = choice(
        "article", "article: the article's circuit; precision: no dead zone, one pole; comparator: also an ON/OFF pin."
    )
    cutoff_hz: float = quantity(67.0, "Hz", "Cutoff of the third-order Butterworth high-pass.", above=0, maximum=10000)
    capacitor_uf: float = quantity(1.0, "uF", "C1 = C2 = C3 of both filters.", minimum=1e-6, maximum=1000)
    passband_gain: float = quantity(
        1 + 100 / 1.5,
        "",
        "G = 1 + R5/R4; the article prints 66.7, which is R5/R4 alone.",
        above=1,
        maximum=10000,
    )
    r5_ohm: float = quantity(100e3, "ohm", "Feedback resistor of the first stage.", minimum=1000, maximum=10e6)
    envelope_cutoff_hz: float = quantity(36.17, "Hz", "1 / (2 pi R_LP C_LP) of the envelope.", above=0, maximum=10000)
    envelope_capacitor_uf: float = quantity(2.2, "uF", "C_LP of the envelope.", minimum=1e-6, maximum=1000)
    capacitor_series: Literal["given", "E6", "E12"] = choice(
        "given", "given: the capacitors above; E6, E12: chosen from this series by cutoff, jointly with the resistors."
    )
    series: Literal["E12", "E24", "E96"] = choice("E24", "Preferred values for resistors (IEC 60063).")
    resistor_tolerance_percent: float = quantity(
        1.0, "%", "Tolerance of the filter's resistors, for the analysis.", minimum=0, maximum=20
    )
    capacitor_tolerance_percent: float = quantity(
        5.0, "%", "Tolerance of its capacitors, for the analysis.", minimum=0, maximum=20
    )
    band_limit_hz: float = quantity(
        1000.0,
        "Hz",
        "Low-pass in the first stage that keeps the amplifier's noise out (precision, comparator); article has none.",
        minimum=10,
        maximum=1e5,
    )
    gain_bandwidth_hz: float = quantity(
        3e6,
        "Hz",
        "Gain-bandwidth product of the amplifier: a TLV2372's; variant article on a split supply has a TL082, 4e6.",
        minimum=1e4,
        maximum=1e9,
    )
    supply: Literal["split", "single"] = choice(
        "split", "split: plus and minus supply_v; single: supply_v alone, signals around a buffered half of it."
    )
    supply_v: float = quantity(5.0, "V", "The supply, or each half of the split one.", minimum=5, maximum=6)


class Detector(ParameterTable):
    """From the enveloped signal to ON and OFF (article, eq. 12)."""

    sample_rate_hz: float = quantity(2000.0, "Hz", "Sampling rate of the traces.", minimum=1000, maximum=20000)
    window_samples: int = quantity(60, "samples", "Length L of the averaging window.", minimum=1, maximum=10000)
    threshold_v: float = quantity(
        0.017,
        "V",
        "Mean of the envelope above which slip is ON; default: six deviations above digital's noise.",
        above=0,
        maximum=10,
    )
    noise_v: float = quantity(
        0.4e-3,
        "V",
        "Noise of sampled voltages, rms, without the converter's steps: an NI 6002's (the article's).",
        minimum=0,
        maximum=1,
        verified=False,
    )
    adc_bits: int = quantity(16, "bit", "Resolution of the converter.", minimum=8, maximum=24)
    adc_range_v: float = quantity(10.0, "V", "The converter takes plus and minus this.", above=0, maximum=100)


class DesignTables(BaseModel):
    """What a design file holds."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip design")

    name: str = Field("fsr400", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the output folder.")
    sensor: Sensor = Sensor()
    custom_sensor: CustomSensor = CustomSensor()
    bone: Bone = Bone()
    skin: Skin = Skin()
    mold: Mold = Mold()
    printer: Printer = Printer()
    board: Board = Board()
    detector: Detector = Detector()
