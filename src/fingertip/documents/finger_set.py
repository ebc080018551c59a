"""Plan and sheets of a set of fingers: every mold is filled once, all on one day.

Mixtures are as few as the pot life allows. Every other figure is that of the forms' own sheets, multiplied or added up.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

from fingertip.board.circuits.channels import describe_sockets, list_pins
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE
from fingertip.casting.sheet import CastingSheet, Mixture, Thing, mix
from fingertip.catalogues.controllers import NAMES
from fingertip.catalogues.output_files import BOARD_DESIGN, BOARD_FOLDER
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet, Form
from fingertip.documents.finger import list_steps
from fingertip.documents.template import render_page
from fingertip.foundation.errors import Issue
from fingertip.foundation.files import format_csv

STIR_MIN, MOLD_MIN = 4.0, 6.0
"""Time to stir a mixture, and to coat one mold, fill it and lower its core [min]. Assumptions: nobody has made one."""
_LONG_LIVED = "smooth_sil_940"
_SPLIT = ("mix", "open")
"""Steps of a casting sheet that begin the second and the third day of a set."""
_COLUMNS = ("amount", "label", "fingers", "price_usd", "where", "reason")


@dataclass(frozen=True)
class FormSheets:
    form: Form
    casting: CastingSheet
    acceptance: Mapping[str, Any] = field(default_factory=dict)
    verdict: str = ""
    calibrated: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Acceptance of each finger whose sensor has a force curve of its own."""


@dataclass(frozen=True)
class Pour:
    finger: str
    design: Design
    poured_cm3: float


@dataclass(frozen=True)
class Cup:
    """Silicone that is mixed at once, and the molds that it fills, in their order."""

    silicone: Silicone
    pours: tuple[Pour, ...]
    batch: Mixture


def plan_cups(pours: Sequence[Pour]) -> Iterator[Cup]:
    """Plan the mixtures of a set, none of which fills many more molds than another of its silicone."""
    silicones: dict[str, list[Pour]] = {}
    for pour in pours:
        silicones.setdefault(repr(pour.design.silicone), []).append(pour)
    for waiting in silicones.values():
        silicone = waiting[0].design.silicone.material
        count = math.ceil(len(waiting) / _count_molds(silicone))
        ends = [round(len(waiting) * number / count) for number in range(count + 1)]
        for start, end in pairwise(ends):
            taken = tuple(waiting[start:end])
            yield Cup(silicone, taken, mix(silicone, sum(pour.poured_cm3 for pour in taken)))


def find_short_pot_lives(designs: Iterable[Design]) -> Iterator[Issue]:
    """Report the silicones that thicken before they have filled one mold."""
    for design in designs:
        silicone = design.silicone.material
        if _count_molds(silicone) < 1:
            told = f"{silicone.name} thickens after {silicone.planned_pot_life_min:g} min, and to fill the mold of "
            told += (
                f"{design.name} takes {STIR_MIN + MOLD_MIN:g} min; it passes with --set silicone.product={_LONG_LIVED}."
            )
            yield Issue("silicone.product", told)


def _count_molds(silicone: Silicone) -> int:
    return max(0, math.floor((silicone.planned_pot_life_min - STIR_MIN) / MOLD_MIN))


@dataclass(frozen=True)
class SetPlan:
    cups: tuple[Cup, ...]
    print_h: float
    """Time of one printer for all plates [h]."""
    cast_day: int
    """Day of the mixtures: all is printed by then, on a printer that never waits."""
    days: int


def plan_set(sheets: Sequence[FormSheets]) -> SetPlan:
    """Plan printing and castings: one plate and one mold for each finger, all molds filled on one day."""
    pours = [
        Pour(finger, each.form.design, each.casting.batch.in_cup_g / each.casting.batch.density_g_cm3)
        for each in sheets
        for finger in each.form.fingers
    ]
    cups = tuple(plan_cups(pours))
    print_h = sum(each.form.count * each.casting.print_h for each in sheets)
    cast_day = 1 + math.ceil(print_h / 24.0)
    return SetPlan(
        cups, round(print_h, 1), cast_day, cast_day + max(math.ceil(cup.batch.cure_h / 24.0) for cup in cups)
    )


def set_data(fingers: FingerSet, sheets: Sequence[FormSheets], has_board: bool) -> dict[str, Any]:
    """Collect the data of all sheets of a set, which has one board for all its fingers or none."""
    sockets, pins, slip_pins = (
        dict(zip(NAMES, each if has_board else [""] * len(NAMES), strict=True))
        for each in (describe_sockets(), list_pins(ADC_TACTILE), list_pins(ADC_FILTERED))
    )
    castings = {each.form.design.name: each.casting for each in sheets}
    rows = [
        {
            "finger": finger,
            "design": form.design.name,
            "plate": castings[form.design.name].plate,
            "print_h": castings[form.design.name].print_h,
            "acceptance": f"sensor of {finger}" if finger in fingers.calibrated else form.design.name,
            "width_mm": form.design.skin.width_mm,
            "length_mm": form.design.skin.length_mm,
            "socket": sockets[finger],
            "pin": pins[finger],
            "slip_pin": slip_pins[finger],
        }
        for finger, form in fingers.fingers
    ]
    acceptance = {each.form.design.name: dict(each.acceptance) for each in sheets}
    acceptance |= {f"sensor of {finger}": dict(own) for each in sheets for finger, own in each.calibrated.items()}
    plan = plan_set(sheets)
    things = list(merge_things(sheets, plan.cups, has_board))
    silicone_g: dict[str, float] = defaultdict(float)
    for cup in plan.cups:
        silicone_g[cup.silicone.label] = round(silicone_g[cup.silicone.label] + cup.batch.total_g, 1)
    return {
        "name": fingers.name,
        "side": fingers.side,
        "board": {"folder": BOARD_FOLDER, "design_file": BOARD_DESIGN} if has_board else None,
        "fingers": rows,
        "forms": [
            {"design": each.form.design.name, "fingers": list(each.form.fingers), "verdict": each.verdict}
            for each in sheets
        ],
        "plan": {
            "print_h": plan.print_h, "cast_day": plan.cast_day, "days": plan.days, "mold_min": MOLD_MIN,
            "cure_h": max(cup.batch.cure_h for cup in plan.cups),
            "steps": _split_steps(sheets[0].casting),
            "cups": [_cup_data(cup) for cup in plan.cups],
        },
        "things": things,
        "acceptance": acceptance,
        "totals": {
            "fingers": len(rows),
            "mixtures": len(plan.cups),
            "silicone_g": dict(silicone_g),
            "printed_g": sum(each.form.count * each.casting.printed_g for each in sheets),
        },
    }  # fmt: skip


def merge_things(sheets: Sequence[FormSheets], cups: Sequence[Cup], has_board: bool) -> Iterator[dict[str, Any]]:
    """Add up what to buy: what each finger takes, what each mixture takes, and tools once."""
    rows: dict[tuple[str, str], list[tuple[Form, Thing]]] = {}
    for each in sheets:
        for thing in each.casting.things:
            rows.setdefault((thing.key, thing.label), []).append((each.form, thing))
    for key in dict.fromkeys(key for key, _ in rows):  # sizes of one thing stand together
        for found in (found for (other, _), found in rows.items() if other == key):
            form, thing = found[0]
            number, unit = _read_amount(thing.amount)
            if key == "silicone":
                number = sum(cup.batch.total_g for cup in cups if cup.silicone == form.design.silicone.material)
            elif thing.each == "mixture":
                number *= len(cups)
            elif thing.each or (key == "board" and not has_board):
                number = sum(_read_amount(own.amount)[0] * form.count for form, own in found)
            names = [finger for form, _ in found for finger in form.fingers]
            told = [] if len(found) == len(sheets) else names
            yield asdict(thing) | {"amount": f"{number:.4g}{unit}" if number else thing.amount, "fingers": told}


def _read_amount(amount: str) -> tuple[float, str]:
    """Read an amount such as "2" or "5 g"; 0 without a number."""
    found = re.fullmatch(r"(\d+(?:\.\d+)?)(.*)", amount)
    return (float(found[1]), found[2]) if found else (0.0, amount)


def _split_steps(casting: CastingSheet) -> list[str]:
    """Name the steps of a casting sheet for each day, such as "1 to 5"."""
    pictures = [step.picture for step in list_steps(casting)]
    starts = [0, *(pictures.index(name) for name in _SPLIT), len(pictures)]
    return [f"{start + 1} to {end}" for start, end in pairwise(starts)]


def _cup_data(cup: Cup) -> dict[str, Any]:
    masses = zip(cup.batch.components, (cup.batch.a_g, cup.batch.b_g), strict=True)
    return {
        "silicone": cup.silicone.label,
        "components_g": dict(masses),
        "pours": [
            {"finger": pour.finger, "poured_g": round(cup.batch.density_g_cm3 * pour.poured_cm3, 1),
             "closed_min": STIR_MIN + MOLD_MIN * number}
            for number, pour in enumerate(cup.pours, 1)
        ],
        "pot_life_min": cup.batch.pot_life_min,
    }  # fmt: skip


def render_sheet(name: str, data: Mapping[str, Any]) -> str:
    """Render overview, plan, parts or acceptance of a set as Markdown."""
    return render_page(f"set_{name}.md", **data)


def write_parts_csv(data: Mapping[str, Any]) -> bytes:
    """Write the list to buy as CSV, as shops and spreadsheets read it."""
    rows = ([" ".join(row[name]) if name == "fingers" else row[name] for name in _COLUMNS] for row in data["things"])
    return format_csv(_COLUMNS, rows)
