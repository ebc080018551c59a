"""Sets of files that are made of a design: their kinds, their folders, and the names of their
files.

A new file has its name here; the task that writes it adds its content. Names that follow from
parts, formats or plates stand with these.
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
        """Folder that the set of a design is written to, or `out`.

        Raises DesignError if that is empty.
        """
        if out is not None and not str(out).strip():
            message = "is empty; give a folder, such as . for the current one, or leave it out."
            raise DesignError(Issue("--out", message))

        return Path("out", design.name, self.place) if out is None else Path(out)

    def writer(
        self,
        design: _Named,
        folder: Path,
        force: bool = False,
        top: Path | None = None,
    ) -> SetWriter:
        """Writer of the set of a design in a folder; the others as for `SetWriter`."""
        parameters = hash_parameters(design.identity())
        return SetWriter(
            folder=folder,
            kind=self.kind,
            design=design.name,
            parameters=parameters,
            force=force,
            top=top,
        )


PART_FILES = OutputSet("parts")
DESIGN = "design.toml"
REPORT = "report.json"
SHEET = "casting.md"
ASSEMBLY = "assembly.step"
ACCEPTANCE = "acceptance.md"
EXPLODED_VIEW = "exploded.png"
PAGE = "index.html"
PAD_VIEW = "pad.svg"
HAND_VIEW = "measure.svg"


PRINT_FOLDER = "print"
STEPS_FOLDER = "steps"
MODELS_FOLDER = "fingertip_models"
PRINTS = OutputSet("print", PRINT_FOLDER)
STEPS = OutputSet("steps", STEPS_FOLDER)
"""Pictures of the casting steps, beside the casting sheet."""
MODELS = OutputSet("models", MODELS_FOLDER)
"""Package that the CadQuery scripts beside it import."""
PARAMETERS = "parameters.py"

SET_FILES = OutputSet("set")
SET_REPORT = "set.json"
OVERVIEW = "set.md"
CASTING_PLAN = "casting_plan.md"
PARTS_LIST = "parts_list.md"
PARTS_CSV = "parts_list.csv"
BOARD_DESIGN = "board_design.toml"

BOARD_FOLDER = "board"
FAB_FOLDER = "fab"
BOARD = OutputSet("board", BOARD_FOLDER)
NETLIST = "slip_filter.net"
VALUES = "values.json"
DECK = "slip_filter.cir"
BOM = "bom.csv"
SCHEMATIC = "slip_filter.kicad_sch"
LAYOUT = "slip_filter.kicad_pcb"
PROJECT = "slip_filter.kicad_pro"
CHANNEL_SHEET = "channel.kicad_sch"
"""Sheet of the schematic that each channel of a board for several fingers uses."""
README = "README.md"
ASSEMBLY_DRAWING = "assembly.svg"
ASSEMBLY_PDF = "assembly.pdf"
"""Assembly drawing of the board, and the same for printing, among the fabrication files."""
BRING_UP = "bringup.md"
BRING_UP_SKETCH = "bringup.ino"
WIRING = "wiring.svg"
FABRICATION = OutputSet("fabrication", f"{BOARD_FOLDER}/{FAB_FOLDER}")
PROVENANCE = "made_from.sha256"

SIGNAL_FOLDER = "signal"
SIGNAL = OutputSet("signal", SIGNAL_FOLDER)
TRACE = "trace.csv"
PLOT = "slip.svg"
DETECTION = "detection.json"

ROBOT = OutputSet("robot", "robot")
ROBOT_FILES = {"mjcf": "finger.xml", "urdf": "finger.urdf"}
"""Format of a robot's model -> its file."""

FIRMWARE = OutputSet("firmware", "firmware")
PROPERTIES = "library.properties"
MANIFEST = "library.json"
TIMER = "slip_timer.h"
BUFFER = "slip_buffer.h"
HAND = "slip_hand.h"
SCAN = "slip_scan.h"
