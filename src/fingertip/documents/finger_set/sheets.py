"""Sheets of a set of fingers as plain data, and the pages that show them.

Every figure is that of the forms' own sheets, multiplied or added up.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from fingertip.board.circuits.channels import describe_sockets, list_pins
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.casting.quantities import Batch
from fingertip.casting.set_plan import CHANGE_S, CastingPlan, Cup, Mold
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues.controllers import NAMES
from fingertip.catalogues.output_files import BOARD_DESIGN, BOARD_FOLDER
from fingertip.catalogues.silicones import Silicone
from fingertip.design.finger_set import FingerSet, Form
from fingertip.documents.template import render_page, render_rows
from fingertip.firmware.fingers import find_controller
from fingertip.foundation.files import format_csv

_FILLED = "mix and fill"
"""Words of the stage of a casting sheet's plan that each round repeats."""
_PATCH_SYRINGE = "syringe of 1 ml without rubber on its plunger, with a blunt needle, for the patch"


@dataclass(frozen=True)
class FormSheets:
    form: Form
    casting: Mapping[str, Any]
    acceptance: Mapping[str, Any]
    volumes_cm3: Mapping[str, float]
    verdict: str = ""
    warnings: tuple[str, ...] = ()
    calibrated: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Acceptance of each finger whose sensor has a force curve of its own."""

    @property
    def mold(self) -> Mold:
        return Mold.of_sheet(self.form.design, self.form.fingers, self.casting)

    def count_part(self, part: str) -> int:
        """Count how often a part of this form is printed for the set: molds and other tools once."""
        if not PARTS[part].is_printed:
            return 0
        return self.form.count if PARTS[part].is_in_finger else 1


def measure_form(form: Form, evaluator: MeshEvaluator) -> FormSheets:
    """Measure printed parts and castings of a form, without its checks and its acceptance."""
    design = form.design
    casting = asdict(casting_sheet(design, evaluator))
    printed = {name: part for name, part in parts_by_name(design).items() if part.is_printed}
    volumes = {name: evaluator.mesh(part.solid(design)).volume() / 1000.0 for name, part in printed.items()}
    return FormSheets(form, casting, {}, volumes)


def set_data(
    fingers: FingerSet,
    sheets: Sequence[FormSheets],
    plan: CastingPlan,
    plates: Mapping[str, Sequence[str]],
    has_board: bool,
) -> dict[str, Any]:
    """Collect the data of all sheets of a set, which has one board for all its fingers or none."""
    sockets, pins, slip_pins = (
        dict(zip(NAMES, each if has_board else [""] * len(NAMES), strict=True))
        for each in (describe_sockets(), list_pins(ADC_TACTILE), list_pins(ADC_FILTERED))
    )
    rows = [
        {
            "finger": finger,
            "design": form.design.name,
            "acceptance": f"sensor of {finger}" if finger in fingers.calibrated else form.design.name,
            "width_mm": form.design.skin.width_mm,
            "length_mm": form.design.skin.length_mm,
            "shared": [other for other in form.fingers if other != finger],
            "socket": sockets[finger],
            "pin": pins[finger],
            "slip_pin": slip_pins[finger],
        }
        for finger, form in fingers.fingers
    ]
    acceptance = {each.form.design.name: dict(each.acceptance) for each in sheets}
    acceptance |= {f"sensor of {finger}": dict(own) for each in sheets for finger, own in each.calibrated.items()}
    counts = {(each.form.design.name, part): each.count_part(part) for each in sheets for part in each.volumes_cm3}
    first = sheets[0].form.design
    printer, controller = first.printer, find_controller(first)
    return {
        "name": fingers.name,
        "side": fingers.side,
        "board": {"folder": BOARD_FOLDER, "design_file": BOARD_DESIGN} if has_board else None,
        "controller": controller.name if controller else "",
        "bed_mm": [printer.bed_x_mm, printer.bed_y_mm, printer.bed_z_mm],
        "printing": {"settings": sheets[0].casting["printing"]["settings"]},
        "fingers": rows,
        "forms": [
            {"design": each.form.design.name, "fingers": list(each.form.fingers), "verdict": each.verdict,
             "warnings": list(each.warnings), "bone_material": each.casting["print_material"],
             "joint": each.casting["joint"], "from_tip_mm": each.form.design.sensor.distance_from_tip_mm}
            for each in sheets
        ],
        "prints": [
            {"design": design, "part": part, "count": count} for (design, part), count in counts.items() if count
        ],
        "plates": {file: list(parts) for file, parts in plates.items()},
        "plan": {
            "rounds": [[_cup_data(cup) for cup in cups] for cups in plan.rounds],
            "change_min": CHANGE_S / 60.0,
            "tests": [_batch_data(*mixture) for mixture in plan.tests],
            "patches": [_batch_data(silicone, batch) | {"fingers": list(names)}
                        for silicone, batch, names in plan.patches],
        },
        "calendar": list(plan_days(sheets, plan)),
        "parts": _list_parts(sheets, plan),
        "acceptance": acceptance,
        "totals": set_totals(sheets, plan),
    }  # fmt: skip


def set_totals(sheets: Sequence[FormSheets], plan: CastingPlan) -> dict[str, Any]:
    """Add up what the forms and the castings of a set take."""
    silicones_g: dict[str, float] = defaultdict(float)
    for silicone, batch in plan.mixtures:
        silicones_g[silicone.label] += batch.total_g
    return {
        "fingers": sum(each.form.count for each in sheets),
        "molds": len(sheets),
        "castings": sum(len(cup.castings) for cup in plan.cups),
        "mixtures": len(plan.mixtures),
        "silicone_g": {name: round(mass_g, 1) for name, mass_g in silicones_g.items()},
        "examples": {each.casting["silicone"]["label"]: each.casting["silicone"]["example"] for each in sheets},
        "cast_cm3": round(sum(each.form.count * each.casting["volumes_cm3"]["total"] for each in sheets), 2),
        "fingers_cm3": _sum_printed(sheets, in_finger=True),
        "molds_cm3": _sum_printed(sheets, in_finger=False),
        "cure_h": plan.cure_h,
    }


def plan_days(sheets: Sequence[FormSheets], plan: CastingPlan) -> Iterator[dict[str, Any]]:
    """Plan the days of the set: those of the longest casting sheet, with its filling once for each round."""
    stages = max((each.casting["plan"] for each in sheets), key=len)
    assert sum(_FILLED in stage["work"] for stage in stages) == 1, "casting/plan.md names the stage that is repeated"
    starts = [stage["day"] for stage in stages]
    day = 1
    for stage, start, after in zip(stages, starts, [*starts[1:], starts[-1]], strict=True):
        is_filled = _FILLED in stage["work"]
        for number in range(1, len(plan.rounds) + 1 if is_filled else 2):
            name = f"round {number}: " if is_filled and len(plan.rounds) > 1 else ""
            name += f"open and trim those of round {number - 1}; " if number > 1 else ""
            yield {"day": day, "work": name + stage["work"], "wait": stage["wait"]}
            day += after - start


def _sum_printed(sheets: Sequence[FormSheets], in_finger: bool) -> float:
    """Add up the volumes of the parts that stay in the fingers, or of the tools [cm3]."""
    volumes = (
        each.count_part(part) * volume
        for each in sheets
        for part, volume in each.volumes_cm3.items()
        if PARTS[part].is_in_finger is in_finger
    )
    return round(sum(volumes), 2)


def _batch_data(silicone: Silicone, batch: Batch) -> dict[str, Any]:
    masses = {name: round(part_g, 1) for name, part_g in zip(silicone.components, (batch.a_g, batch.b_g), strict=True)}
    return {"silicone": silicone.label, "components_g": masses}


def _cup_data(cup: Cup) -> dict[str, Any]:
    silicone = cup.silicone
    prepare_min = silicone.planned_pot_life_min - silicone.filling_limit_s / 60.0
    return _batch_data(silicone, cup.batch) | {
        "castings": [
            {"finger": casting.finger, "design": casting.mold.design.name, "load_cm3": round(casting.mold.load_cm3, 1),
             "full_min": round(prepare_min + full_s / 60.0, 1)}
            for casting, full_s in zip(cup.castings, cup.full_s, strict=True)
        ],
        "patched": list(cup.patched),
        "pot_life_min": silicone.planned_pot_life_min,
        "prepare_min": round(prepare_min, 1),
        "cure_h": silicone.cure_h.high,
    }  # fmt: skip


def _list_parts(sheets: Sequence[FormSheets], plan: CastingPlan) -> list[dict[str, Any]]:
    """List what to buy, sizes of an item together: equal items added up, what serves the bench as often as planned."""
    mixtures, patches = len(plan.mixtures), len(plan.patches) + sum(bool(cup.patched) for cup in plan.cups)
    counted = {"cups": mixtures + len(plan.cups), "stirrers": mixtures, _PATCH_SYRINGE: patches}
    counted["vise or stand"] = max(sum(len(cup.castings) for cup in cups) for cups in plan.rounds)
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for each in sheets:
        supplies = [
            ("bench", {"item": name, "count": counted.get(name, supply["count"] or ""), "note": supply["size"]})
            for supply in each.casting["supplies"]
            for name in (supply["item"],)
        ]
        for use, item in supplies:
            sizes = found.setdefault(item["item"], {})
            row = sizes.setdefault(repr(item), {**item, "count": 0, "use": use, "designs": []})
            many = each.form.count if use == "finger" else 1
            row["count"] = item["count"] if use == "bench" else row["count"] + many * item["count"]
            row["designs"].append(each.form.design.name)
    return [row for sizes in found.values() for row in sizes.values()]


def render_sheet(name: str, data: Mapping[str, Any]) -> str:
    """Render overview, casting_plan, parts_list or acceptance of a set as Markdown."""
    return render_page(f"finger_set/{name}.md", **data)


def write_parts_csv(data: Mapping[str, Any]) -> bytes:
    """Write the parts list as CSV, as shops and spreadsheets read it."""
    rows = render_rows("finger_set/parts_list.md", data)
    return format_csv(rows[0], (row.values() for row in rows))
