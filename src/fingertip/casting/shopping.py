"""Things to buy for a finger, or to have at hand, and what they cost."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol

from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import SENSOR_CONNECTOR
from fingertip.board.parts.table import find_plug_wire
from fingertip.casting.figures import Mount, Printing
from fingertip.casting.mixture import Mixture
from fingertip.catalogues.materials import find_example
from fingertip.design import Design
from fingertip.foundation.tables import load_table, read_rows
from fingertip.models.dimensions import KNOT_WIRES

PriceClass = Literal["below 5", "5 to 20", "20 to 50"]
PRICES_USD: Mapping[str, tuple[int, int]] = {
    "below 5": (0, 5),
    "5 to 20": (5, 20),
    "20 to 50": (20, 50),
}
"""Class of prices, as lists name it -> least and largest price [US dollar]."""
DeliveryClass = Literal["", "0 to 3", "2 to 7", "7 to 21"]
_LONGEST_DELIVERY_DAYS: Mapping[DeliveryClass, int] = {
    "": 0,
    "0 to 3": 3,
    "2 to 7": 7,
    "7 to 21": 21,
}
"""Class of delivery times, as lists name it -> days until the last of its parcels comes."""


@dataclass(frozen=True)
class Thing:
    """Thing to buy or to have at hand, as sheets and report state it."""

    key: str
    amount: str
    label: str
    price_usd: PriceClass
    mail_days: DeliveryClass
    """Days until the parcel comes, estimated; empty for what is at hand."""
    where: str
    reason: str
    """Reason why it is ordered; empty for what lies in an ordinary maker's drawer."""
    each: str
    """Item of a set that takes this amount: every finger, or every mixture.
    Empty if all share it.
    """


@dataclass(frozen=True)
class Purchase:
    """Thing for one finger, with its amount as a number."""

    thing: Thing
    number: float
    """Number of pieces or units; 0 where only words tell the amount."""
    unit: str

    def amount(self, number: float) -> str:
        """Return another number of them as text."""
        return f"{number:.4g} {self.unit}".rstrip() if number else self.thing.amount


class Priced(Protocol):
    """Thing whose price is known."""

    @property
    def price_usd(self) -> str:
        """Class of `PRICES_USD`."""

    @property
    def reason(self) -> str:
        """Reason why it is ordered; empty for what is at hand."""


def add_prices(things: Iterable[Priced]) -> tuple[int, int, int]:
    """Add up the classes of prices [US dollar].

    Returns the least and the largest sum of what is to order, and the largest sum of all things.
    """
    least = 0
    most = 0
    in_all = 0

    for thing in things:
        low, high = PRICES_USD.get(thing.price_usd, (0, 0))
        in_all += high
        if thing.reason:
            least += low
            most += high

    return least, most, in_all


def find_longest_delivery_days(things: Iterable[Thing]) -> int:
    """Return the days until the last parcel comes."""
    return max(_LONGEST_DELIVERY_DAYS[thing.mail_days] for thing in things)


def list_purchases(
    design: Design, batch: Mixture, mount: Mount, printing: Printing
) -> Iterator[Purchase]:
    """Yield what a finger takes: the rows of `shopping_list.csv` that its design needs."""
    words = _describe_things(design, mount, printing)
    sizes = {
        "silicone_g": batch.total_g,
        "printed_g": printing.printed_g,
        "divider_kohm": design.board.divider_ohm / 1e3,
        "bolts": mount.bolts,
        "pin_mm": mount.pin_mm,
        "pin_length_mm": 2 * math.ceil(design.dimensions.pin_length / 2),
        "tendon_mm": mount.tendon_mm,
        "tendon_n": mount.tendon_n,
    }
    needs = _list_needs(design, mount)

    for row in read_rows(Path(__file__).with_name("shopping_list.csv")):
        needed_by = set(row.pop("needed_by").split())
        if not needed_by or needed_by & needs:
            cells = {column: cell.format(**words, **sizes) for column, cell in row.items()}
            number = cells.pop("number")
            unit = cells.pop("unit")
            cells["amount"] = f"{number} {unit}".strip()
            (thing,) = load_table(Thing, [cells])
            yield Purchase(thing, float(number or 0), unit)


def _list_needs(design: Design, mount: Mount) -> set[str]:
    """List the words of the column `needed_by` that fit a design."""
    needs = {"board" if design.board.has_filter else "divider", mount.interface}
    if mount.tendon_mm:
        needs.add("tendon")
    if mount.pin_mm:
        needs.add("pin")

    return needs


def _describe_things(design: Design, mount: Mount, printing: Printing) -> dict[str, str]:
    """Describe the things that depend on the design, by their names in `shopping_list.csv`."""
    silicone = design.silicone.material
    example = find_example(silicone)
    sensor = design.dimensions.sensor
    number = f", order number {sensor.order_number}" if sensor.order_number else ""

    return {
        "sensor": f"{sensor.maker} {sensor.label} with solder tabs{number}".lstrip(),
        "silicone": f"{silicone.label}, such as {example.label}" if example else silicone.label,
        "material": printing.material,
        "wire": _describe_wire(design),
        "bolt": f"bolt {mount.bolt}",
    }


def _describe_wire(design: Design) -> str:
    """Describe wires that pass the bone, and enter the plug of the board's sensor connector if it
    has one.
    """
    widest_mm = design.sensor.wire_diameter_mm
    if design.board.has_filter:
        plug = find_plug_wire(board_circuit(select_components(design)).component(SENSOR_CONNECTOR))
        # A knot of thinner wires slips into the hole.
        least_mm = design.bone.channel_diameter_mm / KNOT_WIRES
        if plug and widest_mm >= max(least_mm, plug.min_insulation_mm):
            thickness_mm = min(widest_mm, plug.max_insulation_mm)
            return f"AWG {plug.min_awg}, {thickness_mm:g} mm with insulation"

    return f"{widest_mm:g} mm with insulation"
