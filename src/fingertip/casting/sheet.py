"""Data of a design's casting sheet: silicone to mix, what to buy, and every figure that its steps
and pictures state.

Values are rounded here, once, so that page, pictures and report agree.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import SENSOR_CONNECTOR
from fingertip.board.parts.table import find_plug_wire
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.settings import PROFILE, Profile, choose_plate_kind, estimate_print
from fingertip.cad.verification.mold import palmar_limits
from fingertip.catalogues.materials import Silicone, find_example
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.design import Design
from fingertip.design.geometry.casting_layout import POURED
from fingertip.design.geometry.plunge import LOWERING_S
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.clevis import tendon_force_per_n
from fingertip.foundation.tables import load_table, read_rows
from fingertip.models.core import core_within_skin
from fingertip.models.dimensions import HEAD_MM, KNOT_WIRES, LONGER_MM, SHORTER_MM
from fingertip.models.mold import cavity
from fingertip.models.outlines import MATING_PLAY_MM

WASTE_FRACTION = 0.25
"""Extra silicone, which stays on cup and stick, as a fraction of what is poured.
A project choice.
"""
MIN_COMPONENT_G = 2.0
"""Least mass of the lighter component, of which half a step of a
scale that reads 0.1 g is 2.5 % [g].
"""
MIN_MIX_G = 10.0
"""Minimum mass of a mixture [g].
Some 0.5 g stays unstirred on cup and stick, 5 % of this. An assumption.
"""


@dataclass(frozen=True)
class Mixture:
    """Quantities for one mixing cup, and what limits its use."""

    in_cup_g: float
    a_g: float
    b_g: float
    total_g: float
    """Mass to mix: with what stays on cup and stick, and enough to weigh and to stir."""
    components: tuple[str, str]
    density_g_cm3: float
    """Upper end of its range."""
    pot_life_min: float
    cure_h: float


def measure_poured_cm3(design: Design, evaluator: MeshEvaluator) -> float:
    """Measure the silicone to pour, with what overflows, on meshes. Raises GeometryError."""
    room, core = (evaluator.manifold(each(design)) for each in (cavity, core_within_skin))
    return POURED * float(room.volume() - (room ^ core).volume()) / 1000.0


def parts_by_weight(silicone: Silicone) -> tuple[float, float]:
    """Return the mix ratio by weight; one by volume is converted, or
    taken as it is if no densities are known.
    """
    a = silicone.parts_a.low
    b = silicone.parts_b.low
    densities = silicone.density_a_g_cm3, silicone.density_b_g_cm3
    if silicone.ratio_by != "volume" or None in densities:
        return a, b

    of_a, of_b = ((density.low + density.high) / 2 for density in densities if density)
    return a * of_a, b * of_b


def split_by_mix_ratio(silicone: Silicone, total_g: float) -> tuple[float, float]:
    """Split a total mass [g] into the masses of both components [g]."""
    a, b = parts_by_weight(silicone)
    fraction_b = b / (a + b)
    return total_g * (1.0 - fraction_b), total_g * fraction_b


def compute_batch(silicone: Silicone, volume_cm3: float) -> Mixture:
    """Compute what to mix for a volume [cm3]."""
    in_cup_g = silicone.density_g_cm3.high * volume_cm3
    to_weigh_g = MIN_COMPONENT_G / min(split_by_mix_ratio(silicone, 1.0))
    total_g = max(in_cup_g * (1.0 + WASTE_FRACTION), MIN_MIX_G, to_weigh_g)
    a_g, b_g = split_by_mix_ratio(silicone, total_g)

    return Mixture(
        in_cup_g=in_cup_g,
        a_g=a_g,
        b_g=b_g,
        total_g=total_g,
        components=silicone.components,
        density_g_cm3=silicone.density_g_cm3.high,
        pot_life_min=silicone.planned_pot_life_min,
        cure_h=silicone.cure_h.high,
    )


def mix(silicone: Silicone, volume_cm3: float) -> Mixture:
    """Compute what to mix for a volume [cm3], as a person weighs it."""
    exact = compute_batch(silicone, volume_cm3)
    a_g = round(exact.a_g, 1)
    b_g = round(exact.b_g, 1)

    return replace(
        exact,
        in_cup_g=round(exact.in_cup_g, 1),
        a_g=a_g,
        b_g=b_g,
        total_g=round(a_g + b_g, 1),
    )


_WORK_H = (4.0, 3.0)
"""Work on both days besides printing, with what dries meanwhile [h].
An assumption: nobody has made one.
"""
_FILAMENT_STEP_G = 5
_LINE_STEP_N = 10.0
_KNOT = 4.0
"""Steps to which filament and the line's strength are rounded up [g,
N], and that strength over a strand's force.
"""
_LEAST_KNOT_MM = 8
"""Least distance of a knot from the joints of the solder at which fingers can tie it [mm].
An assumption.
"""


@dataclass(frozen=True)
class Thing:
    """Thing to buy or to have at hand, a row of `shopping_list.csv`."""

    key: str
    amount: str
    label: str
    price_usd: str
    mail_days: str
    """Days until the parcel comes, estimated; empty for what is at hand."""
    where: str
    reason: str
    each: str
    """Item of a set that takes this amount: every finger, or every mixture; empty if all
    share it.
    """


class Priced(Protocol):
    """Thing whose price is known."""

    @property
    def price_usd(self) -> str: ...

    @property
    def reason(self) -> str: ...


def add_prices(things: Iterable[Priced]) -> tuple[int, int, int]:
    """Add the classes of prices: least and largest sum of what is
    to order, largest sum of all [US dollars].
    """
    priced = [
        ([int(price) for price in re.findall(r"\d+", thing.price_usd)], thing.reason)
        for thing in things
    ]
    order = [prices for prices, reason in priced if reason]
    least = sum(prices[0] for prices in order if len(prices) == 2)

    return least, sum(prices[-1] for prices in order), sum(prices[-1] for prices, _ in priced)


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
class CastingSheet:
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
    work_h: tuple[float, float]
    days: int
    batch: Mixture
    mount: Mount
    divider_kohm: float | None
    """Resistor of the divider; None for a sensor on a board [kohm]."""
    lowering_s: float
    height_mm: tuple[float, float]
    """Least and largest height from the foot of the cup to the top of the seated core's
    plate [mm].
    """
    tilt_mm: float
    """Largest difference of this height between edge and edge,
    for a skin that is right to 10 % [mm].
    """
    length_mm: tuple[float, float]
    head_mm: tuple[float, float]
    """Least and largest length of the sensor's film, and width
    of its head, that this bone takes [mm].
    """
    knot_mm: int
    """Distance of the knot in both wires from the sensor's legs."""
    skin_mm: tuple[float, float]
    """Least and largest thickness of the skin over the sensor, its bump included."""
    things: tuple[Thing, ...]
    mail_days: int
    """Days until the last parcel comes."""
    guessed_sizes: tuple[str, ...]


def casting_sheet(design: Design, evaluator: MeshEvaluator) -> CastingSheet:
    """Collect the data of the sheet. Raises GeometryError."""
    batch = mix(design.silicone.material, measure_poured_cm3(design, evaluator))
    mount = _mount(design)
    dims = design.dimensions
    body = design.dimensions.sensor
    seat = palmar_limits(design)
    material = design.strength.material
    printing = estimate_print(design)
    name, _, _ = material.label.partition(" (")
    printed = f"{name} filament" if material.process == "fdm" else name
    printed_g = float(
        _FILAMENT_STEP_G
        * math.ceil(printing.filament_cm3 * material.density_g_cm3 / _FILAMENT_STEP_G)
    )
    # With some slack between the legs and the hole that the knot lies on.
    to_hole_mm = dims.tail_end_z - design.sensor.tab_length_mm - dims.channel_exit_z
    seat_mm = 0.1 * design.skin.thickness_palmar_mm  # as the heights of the seated core let it be
    skin_mm = (
        design.skin.thickness_palmar_mm + design.skin.bump_height_mm + design.mold.core_inset_mm
    )
    things = _list_things(
        design,
        batch=batch,
        mount=mount,
        printed=printed,
        printed_g=printed_g,
    )

    return CastingSheet(
        design=design.name,
        process=material.process,
        material=printed,
        plate=f"{PRINT_FOLDER}/{choose_plate_kind(design).file_names(1)[0]}",
        profile=PROFILE,
        brim_mm=PROFILE.brim_mm,
        print_h=round(printing.minutes / 60.0, 1),
        printed_g=printed_g,
        work_h=_WORK_H,
        days=1 + math.ceil(batch.cure_h / 24.0),
        batch=batch,
        mount=mount,
        divider_kohm=design.board.divider_ohm / 1e3 if design.board.variant == "divider" else None,
        lowering_s=LOWERING_S,
        height_mm=(math.ceil(10 * seat.low) / 10, math.floor(10 * seat.high) / 10),
        tilt_mm=math.floor(100 * seat.tilt) / 100,
        length_mm=(body.length_mm - SHORTER_MM, body.length_mm + LONGER_MM),
        head_mm=(
            round(body.head_diameter_mm - HEAD_MM, 1),
            round(body.head_diameter_mm + HEAD_MM, 1),
        ),
        knot_mm=max(_LEAST_KNOT_MM, math.ceil(to_hole_mm + 1.0)),
        skin_mm=(round(skin_mm - seat_mm, 1), round(skin_mm + seat_mm, 1)),
        things=things,
        mail_days=max(
            int(days) for thing in things for days in re.findall(r"\d+", thing.mail_days)
        ),
        guessed_sizes=tuple(name for name in design.provisional if name.startswith("hand.")),
    )


def _mount(design: Design) -> Mount:
    interface = interface_of(design)
    bone = design.bone
    hand = design.hand
    bolt = interface.bolt(design)
    anchor = design.dimensions.anchor
    pull_n = (
        design.strength.grip_force_n * tendon_force_per_n(design, design.skin.length_mm)
        if anchor
        else 0.0
    )

    return Mount(
        interface=interface.name,
        bolt=f"M{bolt.thread_mm:g} x {bolt.length_mm:g} mm, with its nut" if bolt else "",
        bolts=bolt.count if bolt else 0,
        post_mm=(round(bone.socket_diameter_mm - MATING_PLAY_MM, 2), bone.socket_depth_mm),
        pin_mm=hand.pin_diameter_mm if design.dimensions.joint and hand.pin == "steel" else 0.0,
        travel_deg=hand.travel_deg,
        tendon_mm=hand.tendon_diameter_mm if anchor else 0.0,
        pull_n=float(round(pull_n)),
        tendon_n=_LINE_STEP_N * math.ceil(_KNOT * pull_n / 2 / _LINE_STEP_N),
    )


def _list_things(
    design: Design,
    batch: Mixture,
    mount: Mount,
    printed: str,
    printed_g: float,
) -> tuple[Thing, ...]:
    silicone = design.silicone.material
    example = find_example(silicone)
    sensor = design.dimensions.sensor
    number = f", order number {sensor.order_number}" if sensor.order_number else ""
    words = {
        "sensor": f"{sensor.maker} {sensor.label} with solder tabs{number}".lstrip(),
        "silicone": f"{silicone.label}, such as {example['label']}" if example else silicone.label,
        "material": printed,
        "wire": _describe_wire(design),
        "bolt": f"bolt {mount.bolt}",
    }
    sizes = {
        "silicone_g": batch.total_g,
        "printed_g": printed_g,
        "divider_kohm": design.board.divider_ohm / 1e3,
        "bolts": mount.bolts,
        "pin_mm": mount.pin_mm,
        "pin_length_mm": 2 * math.ceil(design.dimensions.pin_length / 2),
        "tendon_mm": mount.tendon_mm,
        "tendon_n": mount.tendon_n,
    }
    needs = {"board" if design.board.has_filter else "divider", mount.interface}
    needs |= {name for name, size in (("tendon", mount.tendon_mm), ("pin", mount.pin_mm)) if size}
    rows = []

    for row in read_rows(Path(__file__).with_name("shopping_list.csv")):
        needed_by = set(row.pop("needed_by").split())
        if not needed_by or needed_by & needs:
            rows.append({name: cell.format(**words, **sizes) for name, cell in row.items()})

    return load_table(Thing, rows)


def _describe_wire(design: Design) -> str:
    """Describe wires that pass the bone, and enter the plug of the
    board's sensor connector if it has one.
    """
    widest = design.sensor.wire_diameter_mm
    if design.board.has_filter:
        plug = find_plug_wire(board_circuit(select_components(design)).component(SENSOR_CONNECTOR))
        least = (
            design.bone.channel_diameter_mm / KNOT_WIRES
        )  # a knot of thinner ones slips into the hole
        if plug and widest >= max(least, plug.min_insulation_mm):
            return f"AWG {plug.min_awg}, {min(widest, plug.max_insulation_mm):g} mm with insulation"

    return f"{widest:g} mm with insulation"
