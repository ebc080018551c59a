from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip import Design, make
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh
from fingertip.catalogues.output_files import PAGE, PART_FILES
from fingertip.catalogues.stated_errors import list_mesh_errors
from fingertip.models.parts import parts_by_name
from fingertip.page.page import render_page
from fingertip.page.parameters_and_checks import ReportedCheck
from fingertip.page.sources import Report, Sources
from fingertip.tasks.views import write_page
from tests.conftest import design_file
from tests.slip.recordings import burst

INPUTS = Path(__file__).parent / "inputs"
DRAWING = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M1 1h7"/></svg>\n'
VOID = {"br", "col", "hr", "img", "input", "link", "meta", "wbr"}


class Page(HTMLParser):
    """Page as a browser reads it: elements in order, text by
    element, and whatever is not well-formed.
    """

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.source = text
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.faults: list[str] = []
        self.scripts: list[str] = []
        self.words: list[str] = []
        self._open: list[str] = []
        self.feed(text)
        self.close()
        self.faults += [f"<{name}> is not closed" for name in self._open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if len(dict(attrs)) < len(attrs):
            self.faults.append(f"<{tag}> repeats an attribute")
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")
        if tag not in VOID:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open.pop() != tag:
            self.faults.append(f"</{tag}> closes another element, at {self.getpos()}")

    def handle_data(self, data: str) -> None:
        if self._open and self._open[-1] == "script":
            self.scripts[-1] += data
        elif not (self._open and self._open[-1] == "style"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return "".join(self.words)

    def attributes(self, name: str) -> Iterator[str]:
        yield from (
            value or ""
            for _, attributes in self.elements
            for key, value in attributes.items()
            if key == name
        )

    @property
    def scene(self) -> list[dict[str, Any]]:
        data: list[dict[str, Any]] = json.loads(self.scripts[0])
        return data


def strip_elements(markup: str) -> str:
    return re.sub(r"<[^>]*>", "", markup)


def make_check(
    name: str,
    value: float,
    limit: float,
    relation: str = "at most",
    unit: str = "mm",
    *,
    passed: bool = True,
) -> ReportedCheck:
    return ReportedCheck(name, value, limit, unit, relation, passed)


CASTING: Any = SimpleNamespace(
    plate="print/plate_fdm.3mf",
    material="PETG filament",
    print_h=4.0,
    printed_g=35.0,
    work_h=(4.0, 3.0),
    days=2,
    mail_days=7,
    batch=SimpleNamespace(total_g=22.0, in_cup_g=3.5, cure_h=24.0),
    things=(
        SimpleNamespace(reason="", price_usd="below 5"),
        SimpleNamespace(reason="rare", price_usd="5 to 20"),
    ),
)
"""Casting sheet, as far as a page reads it."""


def make_report() -> Report:
    checks = (
        make_check("bone.safety_factor.grip", 1.25, 1.0, "at least", unit=""),
        make_check("mold.palmar_error", 0.1, 0.2),
        make_check("mold.triangles", 30.0, 31.0, "exactly", unit=""),
        make_check("skin.min_thickness", 2.0, 1.9, "at least"),
        *(make_check(f"bone.wall.pin_{i}", 0.1 * i, 2.0 + i) for i in range(8)),
    )
    plates = {"sla": ("bone", "mold_palmar"), "fdm": ("mold_palmar",), "lost": ("bone",)}
    prints = {f"print/plate_{kind}.3mf": names for kind, names in plates.items()}
    prints |= {f"print/{name}.stl": (name,) for name in ("bone", "mold_palmar")}
    return Report(checks, prints, CASTING, None, list_mesh_errors(0.01))


def make_sources(
    name: str = "fsr400",
    remarks: Mapping[str, str] | None = None,
    changes: Sequence[str] = (),
    replaced: Mapping[str, bytes | None] | None = None,
) -> Sources:
    """Files of a design: each part a corner of a box of its own
    size, and the smallest of all others.
    """
    design = Design.load(design_file(name), changes=changes)
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    files = {
        f"{part}.stl": stl.to_bytes(
            Mesh(np.vstack([np.zeros(3), np.diag([10.0 + i, 20.0, 30.0 + 2 * i])]), triangles), part
        )
        for i, part in enumerate(parts_by_name(design))
    }
    time_s, voltage_v = burst()
    samples = (
        f"{t:.4f},{v:.6f},{int(0.5 <= t < 0.7)}" for t, v in zip(time_s, voltage_v, strict=True)
    )
    trace = "\n".join(["time_s,voltage_v,slip", *samples])
    files |= {
        f"board/{path.name}": path.read_bytes()
        for path in INPUTS.iterdir()
        if path.name != "casting.md"
    }
    files |= {
        "casting.md": (INPUTS / "casting.md").read_bytes(),
        "acceptance.md": b"# Acceptance\n\nTest it.\n",
        "steps/01-print.png": b"PNG",
        "drawing_bone.svg": DRAWING,
        "signal/trace.csv": trace.encode(),
        "signal/detection.json": b'{"detector": "digital", "motion_s": 0.485}',
    }
    kept = {key: data for key, data in {**files, **(replaced or {})}.items() if data is not None}
    return Sources(
        design,
        make_report(),
        kept,
        remarks or {},
        frozenset(make_report().prints) - {"print/plate_lost.3mf"},
    )


@pytest.fixture(scope="session")
def design() -> Design:
    return Design.load("fsr400")


@pytest.fixture(scope="session")
def folder(design: Design, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Everything of a design, with a drawing in place of the one that takes a minute."""
    place = tmp_path_factory.mktemp("page") / "finger"
    made = make(design, place, formats=["stl", "3mf"])
    assert made.page == place / PAGE
    PART_FILES.writer(design, place).add({"drawing_bone.svg": DRAWING})
    write_page(design, place)
    return place


@pytest.fixture(scope="session")
def page() -> Page:
    """A page of small files."""
    return Page(render_page(make_sources()).decode())
