"""Generated pictures of the site: bundled designs, and the casting steps of the default one."""

from __future__ import annotations

import functools
import re

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.design import Design
from fingertip.documents.finger_sheets import list_steps as steps_of
from fingertip.pictures.casting_scenes import draw_steps
from fingertip.pictures.design_picture import draw

WIDTH_PX = 1200
"""Width of a design's picture in the gallery [pixels]."""
_TOLERANCE_MM = 0.02
_STEPS = "steps"
_GALLERY = "gallery"


@functools.cache
def draw_all() -> dict[str, bytes]:
    """Draw all pictures: path on the site -> PNG."""
    designs = {
        f"{_GALLERY}/{name}.png": draw(Design.load(name), WIDTH_PX)
        for name in list_bundled_files(DESIGN)
    }
    return {**{f"{_STEPS}/{name}": png for name, (_, png) in _draw_steps().items()}, **designs}


def list_steps() -> str:
    """List the casting steps of the default design with their pictures."""
    return "\n\n".join(
        f"### {number}. "
        f"{name.partition('-')[2].removesuffix('.png').replace('_', ' ').capitalize()}\n\n"
        f"{text}\n\n![{_escape(text)}]({_STEPS}/{name})"
        for number, (name, (text, _)) in enumerate(_draw_steps().items(), 1)
    )


def list_designs() -> str:
    """List the bundled designs with their pictures."""
    return "\n\n".join(
        f"## {name}\n\n{_describe(name)}\n\n![{name}: exploded views and "
        f"section]({_GALLERY}/{name}.png)"
        for name in list_bundled_files(DESIGN)
    )


@functools.cache
def _draw_steps() -> dict[str, tuple[str, bytes]]:
    """File name -> text and picture of each casting step of the tutorial's design."""
    design = Design.load("adult_finger")
    sheet = casting_sheet(design, MeshEvaluator(_TOLERANCE_MM))
    listed = steps_of(sheet)
    drawn = draw_steps(design, sheet, [step.picture for step in listed])

    return {
        name: (" ".join(step.text.split()), png)
        for (name, png), step in zip(drawn.items(), listed, strict=True)
    }


def _escape(text: str) -> str:
    """Leave out of a text what would end the description of a picture."""
    return re.sub(r"[\[\]()!*`]", "", text)


def _describe(name: str) -> str:
    """First sentence of the comment at the top of a bundled design."""
    lines = list_bundled_files(DESIGN)[name].read_text(encoding="utf-8").splitlines()
    words = " ".join(line.removeprefix("#").strip() for line in lines if line.startswith("# "))
    return words.partition(". ")[0].removesuffix(".") + "."
