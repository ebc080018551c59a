"""C sources of the library: the files of `c/`, with the constants of a design in place of two of their includes."""

from __future__ import annotations

from importlib import resources

from fingertip.design import Design
from fingertip.firmware.constants import render_constants
from fingertip.firmware.trees import render_trees
from fingertip.slip.detectors.fast_model import load_model

HEADER, SOURCE = "slip_detector.h", "slip_detector.c"


def read_template(name: str) -> str:
    """Read a file of the folder `c/`."""
    return resources.files(__package__).joinpath("c", name).read_text(encoding="utf-8")


def library_sources(design: Design) -> dict[str, bytes]:
    """Header and source of the detector of a design, by name."""
    header = _insert(read_template(HEADER), "slip_constants.h", render_constants(design))
    source = _insert(read_template(SOURCE), "slip_trees.h", render_trees(load_model()))
    return {HEADER: header.encode(), SOURCE: source.encode()}


def _insert(template: str, include: str, text: str) -> str:
    """Replace the line that includes a file by a text."""
    line = f'#include "{include}"'
    assert template.count(line) == 1, f"{line} must stand once in its template"
    return template.replace(line, text)
