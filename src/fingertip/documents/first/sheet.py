"""Casting sheet of a first finger: what to buy, and at most twelve numbered steps, each with a picture.

Report, page and pictures read the data, which are frozen dataclasses, as the dictionary that `first_sheet` returns.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.printing.settings import FDM
from fingertip.casting import quantities
from fingertip.casting.consumables import AIDS
from fingertip.casting.hardware import size_wires
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.catalogues.silicones import Silicone, find_example
from fingertip.design import Design
from fingertip.design.geometry.dimensions import HEAD_MM, LONGER_MM, SHORTER_MM, TIE_WIDTH_MM
from fingertip.design.interfaces import interface_of
from fingertip.documents.template import render, render_page
from fingertip.foundation.tables import load_table, read_rows

MIN_COMPONENT_G = 2.0
"""Least mass of the lighter component, of which half a step of a scale that reads 0.1 g is 2.5 % [g]."""
_ORDER_NUMBERS = {"fsr400_short": "34-00004"}
_REFERENCE = re.compile(r"\[([^\]]+)\]\(#(\w+)\)")
"""Words of a step, and the key of the thing that they name."""


@dataclass(frozen=True)
class Item:
    """Thing to buy or to have at hand, a row of `items.csv`."""

    key: str
    amount: str
    label: str
    price_usd: str
    where: str
    reason: str


@dataclass(frozen=True)
class Mixture:
    in_cup_g: float
    a_g: float
    b_g: float
    total_g: float
    components: tuple[str, str]
    density_g_cm3: float
    pot_life_min: float
    cure_h: float


@dataclass(frozen=True)
class FirstSheet:
    design: str
    method: str
    sensor: str
    order_number: str
    silicone: str
    lacquer: str
    wire_mm: float
    bolt: str
    tie_mm: float
    plate: str
    print_h: float | None
    printed_g: float
    days: int
    evening_h: float
    """Work on the first day besides printing [h]. An assumption: nobody has made one."""
    plunge_s: int
    """Time in which the core is lowered [s]: five seconds would take a thumb's whole force."""
    divider_kohm: float
    batch: Mixture
    height_mm: tuple[float, float]
    """Least and largest height from the foot of the cup to the top of the seated core's plate [mm]."""
    tilt_mm: float
    """Largest difference of this height between its corners [mm]."""
    length_mm: tuple[float, float]
    head_mm: tuple[float, float]
    """Least and largest length of the sensor's film and width of its head that this bone takes [mm]."""
    check_warnings: tuple[str, ...]


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
    uses: tuple[str, ...] = ()
    """Keys of the things that it names, on a first finger's sheet."""


def first_sheet(
    design: Design, volumes: quantities.SiliconeVolumes, silicone: Silicone, warnings: Sequence[str] = ()
) -> dict[str, Any]:
    """Collect the data of the sheet, as a dictionary that JSON takes."""
    mixture, example = _mix(silicone, volumes.total_cm3), find_example(silicone)
    bolt = (interface_of(design).mounting(design) or {}).get("bolt")
    body, height_mm = design.dimensions.sensor, round(design.cup_layout.overall_height, 1)
    number = _ORDER_NUMBERS.get(design.sensor.model)
    sheet = FirstSheet(
        design=design.name,
        method=design.mold.method,
        sensor=body.label,
        order_number=f", order number {number}" if number else "",
        silicone=f"{silicone.label}, such as {example['label']}" if example else silicone.label,
        lacquer=AIDS["lacquer"]["label"],
        wire_mm=round(size_wires(design).max_diameter_mm, 2),
        tie_mm=TIE_WIDTH_MM,
        bolt=f"M{bolt['thread_mm']:g} x {bolt['length_mm']:g} mm" if bolt else "",
        plate=f"{PRINT_FOLDER}/{FDM.file_names(1)[0]}",
        print_h=None,
        printed_g=60.0,
        days=1 + math.ceil(mixture.cure_h / 24.0),
        evening_h=2.0,
        plunge_s=30,
        divider_kohm=design.board.divider_ohm / 1e3,
        batch=mixture,
        height_mm=(height_mm, round(height_mm + 0.5, 1)),
        tilt_mm=0.15,
        length_mm=(body.length_mm - SHORTER_MM, body.length_mm + LONGER_MM),
        head_mm=(round(body.head_diameter_mm - HEAD_MM, 1), round(body.head_diameter_mm + HEAD_MM, 1)),
        check_warnings=tuple(warnings),
    )
    data, rows = asdict(sheet), read_rows(Path(__file__).with_name("items.csv"))
    filled = ({column: cell.format(**data) for column, cell in row.items()} for row in rows)
    return data | {"items": [asdict(item) for item in load_table(Item, filled)]}


def _mix(silicone: Silicone, in_cup_cm3: float) -> Mixture:
    """Compute one mixture: with waste, and so much that the scale weighs the lighter component well enough."""
    in_cup_g = quantities.mass_g(silicone, in_cup_cm3)
    share_b = quantities.split_by_mix_ratio(silicone, 1.0)[1]
    to_weigh_g = MIN_COMPONENT_G / min(share_b, 1.0 - share_b)
    total_g = max(in_cup_g * (1.0 + quantities.WASTE_FRACTION), quantities.MIN_MIX_G, to_weigh_g)
    a_g, b_g = (round(part, 1) for part in quantities.split_by_mix_ratio(silicone, total_g))
    first, second = silicone.components
    return Mixture(
        round(in_cup_g, 1), a_g, b_g, round(a_g + b_g, 1), (first, second), silicone.density_g_cm3.high,
        silicone.planned_pot_life_min, silicone.cure_h.high,
    )  # fmt: skip


def list_first_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps. Raises KeyError if one names a thing that is not in the list to buy."""
    known = {item["key"]: item for item in data["items"]}
    _, *pages = render("first/steps.md", **data).split("## ")
    steps = []
    for name, _, text in (page.partition("\n") for page in pages):
        uses = dict.fromkeys(known[key]["key"] for _, key in _REFERENCE.findall(text))
        steps.append(Step(name, " ".join(_REFERENCE.sub(r"\1", text).split()), tuple(uses)))
    return steps


def render_first_sheet(data: Mapping[str, Any], pictures: Sequence[str] = ()) -> str:
    return render_page("first/sheet.md", **data, steps=list_first_steps(data), pictures=pictures)
