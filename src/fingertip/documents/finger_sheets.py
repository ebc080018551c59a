"""Documents of one finger: casting sheet with its steps, first screen of its page, and where its
figures come from.

The templates hold no figure. Every figure is that of the casting sheet, of the report, or of the
function that the board's README asks.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from fingertip.casting.sheet import CastingSheet
from fingertip.casting.shopping import add_prices
from fingertip.design import Design
from fingertip.design.hand_sizes import SIZES
from fingertip.documents.template import render, render_page

_REFERENCE = re.compile(r"\[([^\]]+)\]\(#(\w+)\)")
"""Words of a step, and the key of the thing that they name."""


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `pictures.casting_scenes` that shows the step."""
    text: str
    uses: tuple[str, ...]
    """Keys of the things that it names."""


def list_steps(sheet: CastingSheet) -> list[Step]:
    """List the steps. Raises KeyError if one names a thing that is not in the list to buy."""
    known = {thing.key: thing for thing in sheet.things}
    _, *pages = render("casting_steps.md", **vars(sheet)).split("## ")
    steps = []

    for name, _, text in (page.partition("\n") for page in pages):
        uses = dict.fromkeys(known[key].key for _, key in _REFERENCE.findall(text))
        steps.append(Step(name, " ".join(_REFERENCE.sub(r"\1", text).split()), tuple(uses)))

    return steps


def render_sheet(sheet: CastingSheet, pictures: Sequence[str] = ()) -> str:
    steps = list_steps(sheet)
    number = {step.picture: index for index, step in enumerate(steps, 1)}
    usd = add_prices(sheet.things)
    return render_page(
        "casting.md",
        **vars(sheet),
        steps=steps,
        number=number,
        usd=usd,
        pictures=pictures,
    )


def draw_hand_sizes(design: Design | None = None) -> bytes:
    """Draw where to put the calipers at the joint of a hand, a cell for
    each size, as SVG; with a design its values.
    """
    names = {f"hand.{name}": size for name, size in SIZES.items()}
    cells = [
        (
            size["letter"],
            f"{name} = {design.value(name):g}" if design else name,
            textwrap.wrap(size["place"], 42),
        )
        for name, size in (*[*names.items()][:1], *names.items())  # of a tongue, and of a fork
    ]
    guessed = [
        size["letter"] for name, size in names.items() if design and name in design.provisional
    ]

    return render("hand_sizes.svg", cells=cells, guessed=guessed).encode()


@dataclass(frozen=True)
class Loads:
    """Loads that break the bone, as the report states them."""

    breaks_n: float
    pin_first: bool
    """True if the printed pin of the joint breaks before the bone."""
    grip_n: float


@dataclass(frozen=True)
class FirstScreen:
    """Fields of `start.md`."""

    design: Design
    casting: CastingSheet | None
    loads: Loads | None
    size_mm: Sequence[float]
    files: Collection[str]
    """Paths that it may name."""
    steps: int
    """Number of steps to cast the skin."""
    verdict: str


def render_start(screen: FirstScreen) -> str:
    usd = add_prices(screen.casting.things) if screen.casting else None
    return render_page("start.md", **vars(screen), usd=usd)


def render_basis_table(design: Design) -> str:
    """Render where each kind of figure of a page comes from, as a table."""
    return render_page(
        "basis.md", design=design, curve=design.force_curve, model=design.sensor.model
    )
