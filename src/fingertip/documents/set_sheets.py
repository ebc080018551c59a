"""Plan and sheets of a set of fingers: every mold is filled once, all on one day.

Mixtures are as few as the pot life allows. Every other figure is that of the forms' own sheets,
multiplied or added up.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from fingertip.board.circuits.channels import describe_sockets, list_pins
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE
from fingertip.casting.mixture import mix
from fingertip.casting.sheet import CastingSheet
from fingertip.casting.shopping import Purchase, Thing, list_purchases
from fingertip.catalogues.electronics import NAMES
from fingertip.catalogues.materials import Silicone
from fingertip.catalogues.output_files import BOARD_DESIGN, BOARD_FOLDER
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet, Form
from fingertip.documents.acceptance import AcceptanceSheet
from fingertip.documents.finger_sheets import list_steps
from fingertip.documents.template import fill
from fingertip.foundation.errors import Issue
from fingertip.foundation.files import format_csv

STIR_MIN = 4.0
MOLD_MIN = 6.0
"""Time to stir a mixture, and to coat one mold, fill it and lower in what hangs in it [min].
Assumptions: nobody has made one.
"""
_LONG_LIVED = "smooth_sil_940"
_SPLIT = ("mix", "open")
"""Steps of a casting sheet that begin the second and the third day of a set."""
_NONE = ("", "", "")
"""Place on a board of each finger's own, which a set does not name."""


@dataclass(frozen=True)
class FormSheets:
    form: Form
    casting: CastingSheet
    acceptance: AcceptanceSheet
    verdict: str
    calibrated: Mapping[str, AcceptanceSheet]
    """Acceptance of each finger whose sensor has a force curve of its own."""


@dataclass(frozen=True)
class Pour:
    finger: str
    poured_g: float
    closed_min: float
    """Time after the first stir at which the cup must be finished."""


@dataclass(frozen=True)
class Cup:
    """Silicone that is mixed at once, and the molds that it fills, in their order."""

    silicone: str
    components_g: Mapping[str, float]
    pours: tuple[Pour, ...]
    pot_life_min: float

    @property
    def total_g(self) -> float:
        return round(sum(self.components_g.values()), 1)


@dataclass(frozen=True)
class SetPlan:
    print_h: float
    """Time of one printer for all plates [h]."""
    cast_day: int
    """Day of the mixtures: all is printed by then, on a printer that never waits."""
    days: int
    mold_min: float
    cure_h: float
    steps: tuple[str, ...]
    """Steps of the casting sheets on each day, such as "1 to 5"."""
    cups: tuple[Cup, ...]


@dataclass(frozen=True)
class SharedBoard:
    """Board for all fingers of a set."""

    folder: str
    design_file: str


@dataclass(frozen=True)
class FingerRow:
    finger: str
    design: str
    plate: str
    print_h: float
    acceptance: str
    """Key of its acceptance sheet."""
    width_mm: float
    length_mm: float
    socket: str
    pin: str
    slip_pin: str
    """Place on the shared board, and pins of T and S there; empty without one."""


@dataclass(frozen=True)
class FormVerdict:
    design: str
    fingers: tuple[str, ...]
    verdict: str


@dataclass(frozen=True)
class SharedThing(Thing):
    fingers: tuple[str, ...]
    """Fingers that take it; none if all do."""


@dataclass(frozen=True)
class Totals:
    fingers: int
    mixtures: int
    silicone_g: Mapping[str, float]
    printed_g: float


@dataclass(frozen=True)
class SetSheets:
    """Fields of the templates of a set, and content of its report."""

    name: str
    side: str
    board: SharedBoard | None
    fingers: tuple[FingerRow, ...]
    forms: tuple[FormVerdict, ...]
    plan: SetPlan
    things: tuple[SharedThing, ...]
    acceptance: Mapping[str, AcceptanceSheet]
    totals: Totals


def set_sheets(fingers: FingerSet, sheets: Sequence[FormSheets], has_board: bool) -> SetSheets:
    """Collect the data of all sheets of a set, which has one board for all its fingers or none."""
    castings = {each.form.design.name: each.casting for each in sheets}
    places = zip(describe_sockets(), list_pins(ADC_TACTILE), list_pins(ADC_FILTERED), strict=True)
    place_of = dict(zip(NAMES, places, strict=True)) if has_board else {}
    rows = []

    for finger, form in fingers.fingers:
        skin = form.design.skin
        casting = castings[form.design.name]
        name = form.design.name
        acceptance = f"sensor of {finger}" if finger in fingers.calibrated else name
        place = place_of.get(finger, _NONE)
        size_mm = skin.width_mm, skin.length_mm
        rows.append(
            FingerRow(finger, name, casting.plate, casting.print_h, acceptance, *size_mm, *place)
        )

    plan = plan_set([(each.form, each.casting) for each in sheets])
    silicone_g: dict[str, float] = {}
    for cup in plan.cups:
        silicone_g[cup.silicone] = round(silicone_g.get(cup.silicone, 0.0) + cup.total_g, 1)

    own = {
        f"sensor of {finger}": sheet for each in sheets for finger, sheet in each.calibrated.items()
    }
    printed_g = sum(each.form.count * each.casting.printed_g for each in sheets)
    return SetSheets(
        name=fingers.name,
        side=fingers.side,
        board=SharedBoard(BOARD_FOLDER, BOARD_DESIGN) if has_board else None,
        fingers=tuple(rows),
        forms=tuple(
            FormVerdict(each.form.design.name, each.form.fingers, each.verdict) for each in sheets
        ),
        plan=plan,
        things=tuple(_merge_things(sheets, plan.cups, has_board)),
        acceptance={each.form.design.name: each.acceptance for each in sheets} | own,
        totals=Totals(len(rows), len(plan.cups), silicone_g, printed_g),
    )


def plan_set(castings: Sequence[tuple[Form, CastingSheet]]) -> SetPlan:
    """Plan printing and castings: one plate and one mold for
    each finger, all molds filled on one day.
    """
    cups = plan_cups(
        [
            (form.design.silicone.material, finger, casting.batch.in_cup_g)
            for form, casting in castings
            for finger in form.fingers
        ]
    )
    print_h = sum(form.count * casting.print_h for form, casting in castings)
    cure_h = max(casting.batch.cure_h for _, casting in castings)
    cast_day = 1 + math.ceil(print_h / 24.0)
    pictures = [step.picture for step in list_steps(castings[0][1])]
    starts = [0, *(pictures.index(name) for name in _SPLIT), len(pictures)]
    steps = tuple(f"{start + 1} to {end}" for start, end in pairwise(starts))

    return SetPlan(
        print_h=round(print_h, 1),
        cast_day=cast_day,
        days=cast_day + math.ceil(cure_h / 24.0),
        mold_min=MOLD_MIN,
        cure_h=cure_h,
        steps=steps,
        cups=tuple(cups),
    )


def plan_cups(molds: Iterable[tuple[Silicone, str, float]]) -> Iterator[Cup]:
    """Plan the mixtures of a set for molds, each with its finger and the mass [g] that is poured
    into it.

    None fills many more molds than another of its silicone.
    """
    silicones: dict[Silicone, list[tuple[str, float]]] = {}
    for silicone, finger, poured_g in molds:
        silicones.setdefault(silicone, []).append((finger, poured_g))

    for silicone, waiting in silicones.items():
        count = math.ceil(len(waiting) / _count_molds(silicone))
        for start, end in pairwise(
            round(len(waiting) * number / count) for number in range(count + 1)
        ):
            taken = waiting[start:end]
            batch = mix(
                silicone, sum(poured_g / silicone.density_g_cm3.high for _, poured_g in taken)
            )
            pours = (Pour(*mold, STIR_MIN + MOLD_MIN * i) for i, mold in enumerate(taken, 1))
            masses = dict(zip(batch.components, (batch.a_g, batch.b_g), strict=True))
            yield Cup(silicone.label, masses, tuple(pours), batch.pot_life_min)


def find_short_pot_lives(designs: Iterable[Design]) -> Iterator[Issue]:
    """Report the silicones that thicken before they have filled one mold."""
    for design in designs:
        silicone = design.silicone.material
        if _count_molds(silicone) < 1:
            message = (
                f"{silicone.name} thickens after {silicone.planned_pot_life_min:g} min, and to "
                "fill the mold of "
                f"{design.name} takes {STIR_MIN + MOLD_MIN:g} min; it passes with --set "
                f"silicone.product={_LONG_LIVED}."
            )
            yield Issue("silicone.product", message)


def _count_molds(silicone: Silicone) -> int:
    return max(0, math.floor((silicone.planned_pot_life_min - STIR_MIN) / MOLD_MIN))


def _merge_things(
    sheets: Sequence[FormSheets], cups: Sequence[Cup], has_board: bool
) -> Iterator[SharedThing]:
    """Add up what to buy: what each finger takes, what each mixture takes, and tools once."""
    by_key: dict[str, dict[str, list[tuple[Form, Purchase]]]] = {}
    for sheet in sheets:
        casting = sheet.casting
        design = sheet.form.design
        for purchase in list_purchases(design, casting.batch, casting.mount, casting):
            by_label = by_key.setdefault(purchase.thing.key, {})
            by_label.setdefault(purchase.thing.label, []).append((sheet.form, purchase))

    for by_label in by_key.values():  # sizes of one thing stand together
        for alike in by_label.values():
            form, purchase = alike[0]
            thing = purchase.thing
            number = purchase.number
            if thing.key == "silicone":
                label = form.design.silicone.material.label
                number = sum(cup.total_g for cup in cups if cup.silicone == label)
            elif thing.each == "mixture":
                number *= len(cups)
            elif thing.each or (thing.key == "board" and not has_board):
                number = sum(own.number * form.count for form, own in alike)

            names = [name for form, _ in alike for name in form.fingers]
            is_for_all = len(alike) == len(sheets)
            yield SharedThing(
                **{**vars(thing), "amount": purchase.amount(number)},
                fingers=() if is_for_all else tuple(names),
            )


def render_sheet(name: str, sheets: SetSheets) -> str:
    """Render start, overview, plan, parts or acceptance of a set as Markdown."""
    return fill(f"set_{name}.md", sheets)


def write_parts_csv(things: Iterable[SharedThing]) -> bytes:
    """Write the list to buy as CSV, as shops and spreadsheets read it."""
    rows = (
        (each.amount, each.label, " ".join(each.fingers), each.price_usd, each.where, each.reason)
        for each in things
    )
    return format_csv(("amount", "label", "fingers", "price_usd", "where", "reason"), rows)
