"""Figures that the steps of the casting sheet state, by subject: print, silicone, connection to the
hand, seat of the core, and sensor.

Values are rounded here, once, so that page, pictures and report agree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.cad.printing.settings import PROFILE, Profile, choose_plate_kind, estimate_print
from fingertip.cad.verification.mold import palmar_limits
from fingertip.casting.mixture import Mixture
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.clevis import tendon_force_per_n
from fingertip.models.allowances import MATING_PLAY_MM
from fingertip.models.dimensions import HEAD_MM, LONGER_MM, SHORTER_MM
from fingertip.models.making import making_of

_WORK_H = (4.0, 3.0)
"""Work on both days besides printing, with what dries meanwhile [h]. An assumption: nobody has made
one.
"""
_FILAMENT_STEP_G = 5
"""Step to which the filament to buy is rounded up [g]."""
_LINE_STEP_N = 10.0
"""Step to which the strength of the line to buy is rounded up [N]."""
_KNOT_FACTOR = 4.0
"""Strength of the line over the force of a strand: a knot takes half of it."""
_LEAST_KNOT_MM = 8
"""Least distance of a knot from the joints of the solder at which fingers can tie it [mm]. An
assumption.
"""


@dataclass(frozen=True)
class Printing:
    """Print of all parts of a design."""

    design: str
    process: str
    material: str
    plate: str
    """Path of the plate to print; that of a folder if each part is printed alone."""
    profile: Profile
    brim_mm: float
    """Brim of the bone alone [mm]."""
    print_h: float
    printed_g: float


def describe_printing(design: Design) -> Printing:
    material = design.strength.material
    estimate = estimate_print(design)
    filament_g = estimate.filament_cm3 * material.density_g_cm3
    is_filament = material.process == "fdm"

    return Printing(
        design=design.name,
        process=material.process,
        material=f"{material.product} filament" if is_filament else material.product,
        plate=f"{PRINT_FOLDER}/{choose_plate_kind(design).file_names(1)[0]}",
        profile=PROFILE,
        brim_mm=PROFILE.brim_mm,
        print_h=round(estimate.minutes / 60.0, 1),
        printed_g=float(_FILAMENT_STEP_G * math.ceil(filament_g / _FILAMENT_STEP_G)),
    )


@dataclass(frozen=True)
class Pouring:
    """Silicone to mix, and the time that a finger takes."""

    work_h: tuple[float, float]
    """Work on the first and on the last day."""
    days: int
    batch: Mixture


def describe_pouring(batch: Mixture) -> Pouring:
    return Pouring(work_h=_WORK_H, days=1 + math.ceil(batch.cure_h / 24.0), batch=batch)


@dataclass(frozen=True)
class Mount:
    """Mount of the finger on the hand."""

    interface: str
    bolt: str
    """Bolt to buy; empty for a joint."""
    bolts: int
    post_mm: tuple[float, float]
    """Diameter and greatest length of the hand's post that a socket takes [mm]."""
    pin_mm: float
    """Diameter of a steel pin; 0 without one."""
    travel_deg: float
    """Travel of a joint from straight to bent; 0 without stops."""
    tendon_mm: float
    """Diameter of the tendon; 0 without one."""
    pull_n: float
    """Force of the tendon at the grip."""
    tendon_n: float
    """Force that the line to buy holds."""


@dataclass(frozen=True)
class Connection:
    """Connection of the finger to the hand, and to a divider or a board."""

    mount: Mount
    divider_kohm: float | None
    """Resistor of the divider; None for a sensor on a board [kohm]."""


def describe_connection(design: Design) -> Connection:
    board = design.board
    return Connection(
        mount=_describe_mount(design),
        divider_kohm=board.divider_ohm / 1e3 if board.variant == "divider" else None,
    )


def _describe_mount(design: Design) -> Mount:
    interface = interface_of(design)
    bone = design.bone
    hand = design.hand
    bolt = interface.bolt(design)
    has_steel_pin = design.dimensions.joint and hand.pin == "steel"
    has_tendon = design.dimensions.anchor is not None
    pull_n = 0.0
    if has_tendon:
        per_n = tendon_force_per_n(design, design.skin.length_mm)
        pull_n = design.strength.grip_force_n * per_n

    return Mount(
        interface=interface.name,
        bolt=f"M{bolt.thread_mm:g} x {bolt.length_mm:g} mm, with its nut" if bolt else "",
        bolts=bolt.count if bolt else 0,
        post_mm=(round(bone.socket_diameter_mm - MATING_PLAY_MM, 2), bone.socket_depth_mm),
        pin_mm=hand.pin_diameter_mm if has_steel_pin else 0.0,
        travel_deg=hand.travel_deg,
        tendon_mm=hand.tendon_diameter_mm if has_tendon else 0.0,
        pull_n=float(round(pull_n)),
        tendon_n=_LINE_STEP_N * math.ceil(_KNOT_FACTOR * pull_n / 2 / _LINE_STEP_N),
    )


@dataclass(frozen=True)
class CoreSeat:
    """Readings of calipers that tell that the core, or the holder of the bone, is seated in the
    cup.
    """

    made: str
    """Way to make the skin, as skin.made."""
    lowering_s: float
    height_mm: tuple[float, float]
    """Least and largest height from the foot of the cup to the top of the seated plate, or of the
    holder's tower [mm].
    """
    tilt_mm: float
    """Largest difference of this height between edge and edge, for a skin that is right to 10 %
    [mm].
    """


def describe_core_seat(design: Design) -> CoreSeat:
    seat = palmar_limits(design)
    return CoreSeat(
        made=design.skin.made,
        lowering_s=making_of(design).lowering_s,
        height_mm=(math.ceil(10 * seat.low) / 10, math.floor(10 * seat.high) / 10),
        tilt_mm=math.floor(100 * seat.tilt) / 100,
    )


@dataclass(frozen=True)
class SensorFit:
    """Sizes of the sensor that this bone takes, and of the skin over it."""

    length_mm: tuple[float, float]
    """Least and largest length of the sensor's film [mm]."""
    head_mm: tuple[float, float]
    """Least and largest width of its head [mm]."""
    knot_mm: int
    """Distance of the knot in both wires from the sensor's legs."""
    skin_mm: tuple[float, float]
    """Least and largest thickness of the skin over the sensor, its bump included."""


def describe_sensor_fit(design: Design) -> SensorFit:
    dims = design.dimensions
    body = dims.sensor
    # With some slack between the legs and the hole that the knot lies on.
    to_hole_mm = dims.tail_end_z - design.sensor.tab_length_mm - dims.channel_exit_z
    seat_mm = 0.1 * design.skin.thickness_palmar_mm  # as the heights of the seated core let it be
    skin_mm = (
        design.skin.thickness_palmar_mm + design.skin.bump_height_mm + design.mold.core_inset_mm
    )

    return SensorFit(
        length_mm=(body.length_mm - SHORTER_MM, body.length_mm + LONGER_MM),
        head_mm=(
            round(body.head_diameter_mm - HEAD_MM, 1),
            round(body.head_diameter_mm + HEAD_MM, 1),
        ),
        knot_mm=max(_LEAST_KNOT_MM, math.ceil(to_hole_mm + 1.0)),
        skin_mm=(round(skin_mm - seat_mm, 1), round(skin_mm + seat_mm, 1)),
    )
