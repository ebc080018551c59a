"""Casting sheet of a design as a page: what to buy, and numbered steps, each with a picture.

The templates `casting.md` and `steps.md` hold no figure.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from fingertip.casting.sheet import CastingSheet
from fingertip.documents.template import render, render_page

_REFERENCE = re.compile(r"\[([^\]]+)\]\(#(\w+)\)")
"""Words of a step, and the key of the thing that they name."""


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
    uses: tuple[str, ...]
    """Keys of the things that it names."""


def list_steps(sheet: CastingSheet) -> list[Step]:
    """List the steps. Raises KeyError if one names a thing that is not in the list to buy."""
    known = {thing.key: thing for thing in sheet.things}
    _, *pages = render("steps.md", **vars(sheet)).split("## ")
    steps = []
    for name, _, text in (page.partition("\n") for page in pages):
        uses = dict.fromkeys(known[key].key for _, key in _REFERENCE.findall(text))
        steps.append(Step(name, " ".join(_REFERENCE.sub(r"\1", text).split()), tuple(uses)))
    return steps


def render_sheet(sheet: CastingSheet, pictures: Sequence[str] = ()) -> str:
    return render_page("casting.md", **vars(sheet), steps=list_steps(sheet), pictures=pictures)
