"""Sets of files that are made of a design: their kinds, their folders, and the names of their files.

A new file has its name here; the task that writes it adds its content. Names that follow from parts, formats or plates
stand with these.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from fingertip.foundation.errors import DesignError, Issue
from fingertip.foundation.output_set import SetWriter, hash_parameters


class _Named(Protocol):
    @property
    def name(self) -> str: ...

    def identity(self) -> dict[str, Any]: ...


@dataclass(frozen=True)
class OutputSet:
    """Files that are written together, or removed together where they are of another design."""

    kind: str
    """Kind in the manifest of the set."""
    place: str = ""
    """Folder below that of the design."""

    def folder(self, design: _Named, out: str | Path | None = None) -> Path:
        """Folder that the set of a design is written to, or `out`. Raises DesignError if that is empty."""
        if out is not None and not str(out).strip():
            message = "is empty; give a folder, such as . for the current one, or leave it out."
            raise DesignError(Issue("--out", message))
        return Path("out", design.name, self.place) if out is None else Path(out)

    def writer(self, design: _Named, folder: Path, force: bool = False, top: Path | None = None) -> SetWriter:
        """Writer of the set of a design in a folder; the others as for `SetWriter`."""
        parameters = hash_parameters(design.identity())
        return SetWriter(folder, self.kind, design.name, parameters, force, top=top)


PART_FILES = OutputSet("parts")
DESIGN, REPORT, SHEET, ASSEMBLY = "design.toml", "report.json", "casting.md", "assembly.step"
ACCEPTANCE, EXPLODED_VIEW, PAGE = "acceptance.md", "exploded.png", "index.html"
PAD_VIEW, HAND_VIEW = "pad.svg", "measure.svg"


@dataclass(frozen=True)
class PartFormat:
    suffix: str
    code: str = ""
    """Module that writes a mesh with `to_bytes(mesh, name, note)` and reads it with `from_bytes`; none for a solid."""
    is_default: bool = True
    """False if it is written only where it is named."""


PART_FORMATS = {
    "stl": PartFormat(".stl", "fingertip.cad.files.stl"),
    "3mf": PartFormat(".3mf", "fingertip.cad.files.threemf"),
    "step": PartFormat(".step"),
    "cq": PartFormat(".cq.py", is_default=False),
}
"""Formats of a part's files."""


def part_file(part: str, file_format: str) -> str:
    return f"{part}{PART_FORMATS[file_format].suffix}"


def default_formats() -> tuple[str, ...]:
    return tuple(name for name, each in PART_FORMATS.items() if each.is_default)


PRINT_FOLDER, STEPS_FOLDER = "print", "steps"
PRINTS = OutputSet("print", PRINT_FOLDER)
STEPS = OutputSet("steps", STEPS_FOLDER)
"""Pictures of the casting steps, beside the casting sheet."""

SET_FILES = OutputSet("set")
SET_REPORT, OVERVIEW, CASTING_PLAN = "set.json", "set.md", "casting_plan.md"
PARTS_LIST, PARTS_CSV, BOARD_DESIGN = "parts_list.md", "parts_list.csv", "board_design.toml"

BOARD_FOLDER, FAB_FOLDER = "board", "fab"
BOARD = OutputSet("board", BOARD_FOLDER)
NETLIST, VALUES, DECK, BOM = "slip_filter.net", "values.json", "slip_filter.cir", "bom.csv"
SCHEMATIC, LAYOUT, PROJECT = "slip_filter.kicad_sch", "slip_filter.kicad_pcb", "slip_filter.kicad_pro"
CHANNEL_SHEET = "channel.kicad_sch"
"""Sheet of the schematic that each channel of a board for several fingers uses."""
README = "README.md"
ASSEMBLY_DRAWING, ASSEMBLY_PDF = "assembly.svg", "assembly.pdf"
"""Assembly drawing of the board, and the same for printing, among the fabrication files."""
BRING_UP, BRING_UP_SKETCH, WIRING = "bringup.md", "bringup.ino", "wiring.svg"
FABRICATION = OutputSet("fabrication", f"{BOARD_FOLDER}/{FAB_FOLDER}")
PROVENANCE = "made_from.sha256"

SIGNAL_FOLDER = "signal"
SIGNAL = OutputSet("signal", SIGNAL_FOLDER)
TRACE, PLOT, DETECTION = "trace.csv", "slip.png", "detection.json"

ROBOT = OutputSet("robot", "robot")
ROBOT_FILES = {"mjcf": "finger.xml", "urdf": "finger.urdf"}
"""Format of a robot's model -> its file."""

FIRMWARE = OutputSet("firmware", "firmware")
PROPERTIES, MANIFEST = "library.properties", "library.json"
TIMER, BUFFER, HAND, SCAN = "slip_timer.h", "slip_buffer.h", "slip_hand.h", "slip_scan.h"
