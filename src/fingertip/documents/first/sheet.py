"""Casting sheet of a first finger: what to buy, and at most twelve numbered steps, each with a picture.

Report, page and pictures read its data, which are frozen dataclasses, as the dictionary that `first_sheet` returns.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fingertip.cad.printing.estimate import estimate_print
from fingertip.cad.printing.settings import FDM, Profile, choose_profile
from fingertip.cad.verification.cup import LOWERING_S, palmar_limits
from fingertip.casting import quantities
from fingertip.casting.consumables import AIDS
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.catalogues.silicones import Silicone, find_example
from fingertip.design import Design
from fingertip.design.geometry.dimensions import HEAD_MM, LONGER_MM, SHORTER_MM
from fingertip.design.interfaces import interface_of
from fingertip.documents.template import render, render_page
from fingertip.foundation.tables import load_table, read_rows

_MIN_COMPONENT_G = 2.0
"""Least mass of the lighter component, of which half a step of a scale that reads 0.1 g is 2.5 % [g]."""
_WORK_H = (4.0, 3.0)
"""Work on both days besides printing, with what dries meanwhile [h]. An assumption: nobody has made one."""
_STEP_G = 5
"""Step to which filament is rounded up [g]."""
_ORDER_NUMBERS = {"fsr400_short": ", order number 34-00004"}
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
    plate: str
    profile: Profile
    brim_mm: float
    """Brim of the bone alone [mm]."""
    print_h: float
    printed_g: float
    work_h: tuple[float, float]
    days: int
    batch: Mixture
    divider_kohm: float | None
    """Resistor of the divider; None for a sensor on a board [kohm]."""
    lowering_s: float
    height_mm: tuple[float, float]
    """Least and largest height from the foot of the cup to the top of the seated core's plate [mm]."""
    tilts_mm: tuple[float, float]
    """Largest difference of this height between edge and edge, for a skin that is right to 5 % and to 10 % [mm]."""
    length_mm: tuple[float, float]
    head_mm: tuple[float, float]
    """Least and largest length of the sensor's film, and width of its head, that this bone takes [mm]."""
    items: tuple[Item, ...]


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
    uses: tuple[str, ...] = ()
    """Keys of the things that it names, on a first finger's sheet."""


def first_sheet(design: Design, volumes: quantities.SiliconeVolumes, silicone: Silicone) -> dict[str, Any]:
    """Collect the data of the sheet, as a dictionary that JSON takes."""
    batch, body, seat = _mix(silicone, volumes.total_cm3), design.dimensions.sensor, palmar_limits(design)
    sheet = FirstSheet(
        design.name, design.mold.method, f"{PRINT_FOLDER}/{FDM.file_names(1)[0]}", (profile := choose_profile(design)),
        profile.brim_mm, round(estimate_print(design).minutes / 60.0, 1), _find_printed_g(design), _WORK_H,
        days=1 + math.ceil(batch.cure_h / 24.0),
        batch=batch,
        divider_kohm=design.board.divider_ohm / 1e3 if design.board.variant == "divider" else None,
        lowering_s=LOWERING_S,
        height_mm=(math.ceil(10 * seat.low) / 10, math.floor(10 * seat.high) / 10),
        tilts_mm=(math.floor(100 * seat.tilts[0]) / 100, math.floor(100 * seat.tilts[1]) / 100),
        length_mm=(body.length_mm - SHORTER_MM, body.length_mm + LONGER_MM),
        head_mm=(round(body.head_diameter_mm - HEAD_MM, 1), round(body.head_diameter_mm + HEAD_MM, 1)),
        items=_list_items(design, silicone, batch),
    )  # fmt: skip
    return asdict(sheet)


def _find_printed_g(design: Design) -> float:
    density = PRINT_MATERIALS[design.strength.print_material].density_g_cm3
    return float(_STEP_G * math.ceil(estimate_print(design).filament_cm3 * density / _STEP_G))


def _list_items(design: Design, silicone: Silicone, batch: Mixture) -> tuple[Item, ...]:
    bolt, example = (interface_of(design).mounting(design) or {}).get("bolt"), find_example(silicone)
    words = {
        "sensor": f"{design.dimensions.sensor.label} with solder tabs{_ORDER_NUMBERS.get(design.sensor.model, '')}",
        "silicone": f"{silicone.label}, such as {example['label']}" if example else silicone.label,
        "lacquer": AIDS["lacquer"]["label"],
        "bolt": f"M{bolt['thread_mm']:g} x {bolt['length_mm']:g} mm" if bolt else "",
    }
    sizes = {
        "silicone_g": batch.total_g, "printed_g": _find_printed_g(design),
        "divider_kohm": design.board.divider_ohm / 1e3, "wire_mm": design.sensor.wire_diameter_mm,
    }  # fmt: skip
    others = () if design.board.variant == "divider" else ("controller", "resistor")
    rows = (row for row in read_rows(Path(__file__).with_name("items.csv")) if row["key"] not in others)
    return load_table(Item, ({name: cell.format(**words, **sizes) for name, cell in row.items()} for row in rows))


def _mix(silicone: Silicone, in_cup_cm3: float) -> Mixture:
    """Compute one mixture: with waste, and so much that the scale weighs the lighter component well enough."""
    in_cup_g = quantities.mass_g(silicone, in_cup_cm3)
    to_weigh_g = _MIN_COMPONENT_G / min(quantities.split_by_mix_ratio(silicone, 1.0))
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
