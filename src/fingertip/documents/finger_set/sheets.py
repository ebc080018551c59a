"""Sheets of a set of fingers as plain data, and the pages that show them.

Every figure is that of the forms' own sheets, multiplied or added up.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.cad.printing.orientations import print_orientations
from fingertip.casting.hardware import list_hardware
from fingertip.casting.quantities import Batch
from fingertip.casting.set_plan import CHANGE_S, CastingPlan, Cup
from fingertip.catalogues.silicones import Silicone
from fingertip.design.finger_set import FingerSet, Form
from fingertip.documents.casting.sheet import round_component_g
from fingertip.documents.template import lay_out_page, render, render_rows

PARTS_OF_A_FINGER = ("bone", "lid", "sensor_insert")
"""Printed parts that stay in a finger. The others are tools: a set needs each once for each form."""


@dataclass(frozen=True)
class FormSheets:
    """Form of a set with what was made for it."""

    form: Form
    casting: Mapping[str, Any]
    acceptance: Mapping[str, Any]
    volumes_cm3: Mapping[str, float]
    """Volume of each part by name."""

    def count_part(self, part: str) -> int:
        """Count how often a part of this form is printed for the set."""
        if part not in print_orientations(self.form.design):
            return 0
        return self.form.count if part in PARTS_OF_A_FINGER else 1


def set_data(
    fingers: FingerSet, sheets: Sequence[FormSheets], plan: CastingPlan, plates: Mapping[str, Sequence[str]],
    board: str,
) -> dict[str, Any]:  # fmt: skip
    """Collect the data of all sheets of a set. `board` is the folder of the board for all fingers; empty without."""
    rows = [
        {
            "finger": finger,
            "design": form.design.name,
            "width_mm": form.design.skin.width_mm,
            "length_mm": form.design.skin.length_mm,
            "shared": [other for other in form.fingers if other != finger],
        }
        for finger, form in fingers.fingers
    ]
    counts = {(each.form.design.name, part): each.count_part(part) for each in sheets for part in each.volumes_cm3}
    return {
        "name": fingers.name,
        "side": fingers.side,
        "board": board,
        "fingers": rows,
        "prints": [
            {"design": design, "part": part, "count": count} for (design, part), count in counts.items() if count
        ],
        "plates": {file: list(parts) for file, parts in plates.items()},
        "plan": _plan_data(plan),
        "parts": _list_parts(sheets),
        "acceptance": {each.form.design.name: dict(each.acceptance) for each in sheets},
        "totals": {
            "fingers": len(rows),
            "molds": len(sheets),
            "castings": sum(len(cup.castings) for cup in plan.cups),
            "mixtures": len(plan.mixtures),
            "silicone_g": {name: round(mass_g, 1) for name, mass_g in _sum_silicones(plan).items()},
            "cast_cm3": round(sum(each.form.count * each.casting["volumes_cm3"]["total"] for each in sheets), 2),
            "printed_cm3": round(
                sum(count * each.volumes_cm3[part] for each in sheets for part in each.volumes_cm3
                    if (count := each.count_part(part))), 2,
            ),
            "cure_h": plan.cure_h,
        },
    }  # fmt: skip


def _plan_data(plan: CastingPlan) -> dict[str, Any]:
    return {
        "rounds": [[_cup_data(cup) for cup in cups] for cups in plan.rounds],
        "change_min": CHANGE_S / 60.0,
        "tests": [_batch_data(*mixture) for mixture in plan.tests],
        "patches": [_batch_data(*mixture) for mixture in plan.patches],
    }


def _sum_silicones(plan: CastingPlan) -> dict[str, float]:
    sums: dict[str, float] = {}
    for silicone, batch in plan.mixtures:
        sums[silicone.label] = sums.get(silicone.label, 0.0) + batch.total_g
    return sums


def _batch_data(silicone: Silicone, batch: Batch) -> dict[str, Any]:
    masses = {
        name: round_component_g(part_g, batch.total_g)
        for name, part_g in zip(silicone.components, (batch.a_g, batch.b_g), strict=True)
    }
    return {"silicone": silicone.label, "components_g": masses}


def _cup_data(cup: Cup) -> dict[str, Any]:
    silicone = cup.silicone
    return _batch_data(silicone, cup.batch) | {
        "castings": [{"finger": casting.finger, "design": casting.mold.design.name} for casting in cup.castings],
        "load_cm3": [round(casting.mold.load_cm3, 1) for casting in cup.castings],
        "fill_min": round(cup.fill_s / 60.0, 1),
        "limit_min": round(silicone.filling_limit_s / 60.0, 1),
        "prepare_min": round(silicone.planned_pot_life_min - silicone.filling_limit_s / 60.0, 1),
        "cure_h": silicone.cure_h.high,
    }


def _list_parts(sheets: Sequence[FormSheets]) -> list[dict[str, Any]]:
    """List what to buy: equal items of all forms are added up, and what serves the bench is there once."""
    found: dict[str, dict[str, Any]] = {}
    for each in sheets:
        for use, item in list_hardware(each.form.design):
            key = repr({**item, "count": 0})
            row = found.setdefault(key, {**item, "count": 0, "use": use})
            many = each.form.count if use == "finger" else 1
            row["count"] = item["count"] if use == "bench" else row["count"] + many * item["count"]
    return list(found.values())


def render_casting_plan(data: Mapping[str, Any]) -> str:
    return lay_out_page(render("finger_set/casting_plan.md", **data))


def render_parts_list(data: Mapping[str, Any]) -> str:
    return lay_out_page(render("finger_set/parts_list.md", **data))


def write_parts_csv(data: Mapping[str, Any]) -> bytes:
    """Write the parts list as CSV, as shops and spreadsheets read it."""
    rows = render_rows("finger_set/parts_list.md", data)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()


def render_set_acceptance(data: Mapping[str, Any]) -> str:
    return lay_out_page(render("finger_set/acceptance.md", **data))


def render_overview(data: Mapping[str, Any]) -> str:
    return lay_out_page(render("finger_set/overview.md", **data))
