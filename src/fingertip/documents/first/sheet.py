"""Casting sheet of a first finger: what to buy, and twelve numbered steps, each with a picture.

The data are frozen dataclasses; report, page and pictures read them as the dictionary that `first_sheet` returns.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from fingertip.cad.printing.settings import FDM
from fingertip.casting import quantities
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.documents.first.items import Item, list_items
from fingertip.documents.template import render, render_page

SCALE_G, MIN_COMPONENT_G = 0.1, 2.0
"""Step of the scale, and least mass of the lighter component, of which half a step is 2.5 % [g]."""
PLUNGE_S = 30
"""Time in which the core is lowered [s]: five seconds take a thumb's whole force."""
EVENING_H = 2.0
"""Work on the first day besides printing [h]. An assumption: nobody has made one."""
_REFERENCE = re.compile(r"\[([^\]]+)\]\(#(\w+)\)")
"""Words of a step, and the thing to buy that they name."""


@dataclass(frozen=True)
class Mixture:
    in_cup_g: float
    a_g: float
    b_g: float
    total_g: float
    components: tuple[str, str]
    pot_life_min: float
    """Time from the start of stirring until the core must lie on its ridges [min]."""
    cure_h: float


@dataclass(frozen=True)
class SensorLimits:
    """Sizes between which a sensor lies down in this bone [mm]."""

    length: tuple[float, float]
    head: tuple[float, float]


@dataclass(frozen=True)
class FirstSheet:
    design: str
    method: str
    sensor: str
    silicone: str
    plate: str
    print_h: float | None
    """Time of printing [h]; None where it is not estimated."""
    printed_g: float
    days: int
    evening_h: float
    plunge_s: int
    divider_kohm: float
    batch: Mixture
    limits: SensorLimits
    items: tuple[Item, ...]
    check_warnings: tuple[str, ...]


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
    uses: tuple[str, ...] = ()
    """Keys of the things that it names."""


def first_sheet(
    design: Design, volumes: quantities.SiliconeVolumes, silicone: Silicone, warnings: Sequence[str] = ()
) -> dict[str, Any]:
    """Collect the data of the sheet, as a dictionary that JSON takes."""
    mixture, printed_g = _mix(silicone, volumes.total_cm3), 60.0
    sensor = design.dimensions.sensor
    sheet = FirstSheet(
        design=design.name,
        method=design.mold.method,
        sensor=sensor.label,
        silicone=silicone.label,
        plate=f"{PRINT_FOLDER}/{FDM.file_names(1)[0]}",
        print_h=None,
        printed_g=printed_g,
        days=1 + math.ceil(mixture.cure_h / 24.0),
        evening_h=EVENING_H,
        plunge_s=PLUNGE_S,
        divider_kohm=design.board.divider_ohm / 1e3,
        batch=mixture,
        limits=SensorLimits((18.0, 23.0), (7.4, 7.8)),
        items=tuple(list_items(design, silicone, math.ceil(mixture.total_g), SCALE_G, printed_g)),
        check_warnings=tuple(warnings),
    )
    return asdict(sheet)


def _mix(silicone: Silicone, in_cup_cm3: float) -> Mixture:
    """Compute one mixture: with waste, and so much that the scale weighs the lighter component well enough."""
    in_cup_g = quantities.mass_g(silicone, in_cup_cm3)
    share_b = quantities.split_by_mix_ratio(silicone, 1.0)[1]
    to_weigh_g = MIN_COMPONENT_G / min(share_b, 1.0 - share_b)
    total_g = max(in_cup_g * (1.0 + quantities.WASTE_FRACTION), quantities.MIN_MIX_G, to_weigh_g)
    a_g, b_g = (round(part, 1) for part in quantities.split_by_mix_ratio(silicone, total_g))
    first, second = silicone.components
    return Mixture(
        round(in_cup_g, 1), a_g, b_g, round(a_g + b_g, 1), (first, second), silicone.planned_pot_life_min,
        silicone.cure_h.high,
    )  # fmt: skip


def list_first_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps; a reference to a thing that is not in the list is a KeyError."""
    known = {item["key"] for item in data["items"]}
    _, *pages = render("first/steps.md", **data).split("## ")
    steps = []
    for name, _, text in (page.partition("\n") for page in pages):
        uses = tuple(dict.fromkeys(key for _, key in _REFERENCE.findall(text)))
        if unknown := set(uses) - known:
            raise KeyError(f"step {name} names {sorted(unknown)}, which are not in the list to buy")
        steps.append(Step(name, " ".join(_REFERENCE.sub(r"\1", text).split()), uses))
    return steps


def render_first_sheet(data: Mapping[str, Any], pictures: Sequence[str] = ()) -> str:
    return render_page("first/sheet.md", **data, steps=list_first_steps(data), pictures=pictures)
