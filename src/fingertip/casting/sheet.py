"""Data of a design's casting sheet: things to buy, and the figures of its steps and pictures."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.figures import (
    Connection,
    CoreSeat,
    Pouring,
    Printing,
    SensorFit,
    describe_connection,
    describe_core_seat,
    describe_pouring,
    describe_printing,
    describe_sensor_fit,
)
from fingertip.casting.mixture import measure_poured_cm3, mix
from fingertip.casting.shopping import Thing, find_longest_delivery_days, list_purchases
from fingertip.design import Design


@dataclass(frozen=True)
class CastingSheet(SensorFit, CoreSeat, Connection, Pouring, Printing):
    """Figures of all subjects side by side, as templates and report name them.

    The report lists them from the last of these classes to the first.
    """

    things: tuple[Thing, ...]
    mail_days: int
    """Days until the last parcel comes."""
    guessed_sizes: tuple[str, ...]
    """Parameters of the hand that nobody measured."""


def casting_sheet(design: Design, evaluator: MeshEvaluator) -> CastingSheet:
    """Collect the data of the sheet. Raises GeometryError."""
    batch = mix(design.silicone.material, measure_poured_cm3(design, evaluator))
    printing = describe_printing(design)
    connection = describe_connection(design)
    purchases = list_purchases(design, batch, connection.mount, printing)
    things = tuple(purchase.thing for purchase in purchases)

    return CastingSheet(
        **vars(printing),
        **vars(describe_pouring(batch)),
        **vars(connection),
        **vars(describe_core_seat(design)),
        **vars(describe_sensor_fit(design)),
        things=things,
        mail_days=find_longest_delivery_days(things),
        guessed_sizes=tuple(name for name in design.provisional if name.startswith("hand.")),
    )
