"""Fabrication files: gerbers and drill file in one zip, placement and parts files for the assembly, and renderings.

KiCad's command-line program kicad-cli exports gerbers, drill file and renderings. The placement and parts files are
written from the circuit itself. A board that fails KiCad's own checks is not exported.
"""

from __future__ import annotations

import csv
import io
import re
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fingertip.board.circuit import Circuit
from fingertip.board.fabrication.bom import group_purchased, purchased_components
from fingertip.board.layout.placement import Placement
from fingertip.errors import BoardError, MissingLibraryError

PARTS_COLUMNS = ("Comment", "Designator", "Footprint", "Part Number")
PLACEMENT_COLUMNS = ("Designator", "Mid X", "Mid Y", "Layer", "Rotation")

_LAYERS = "F.Cu,B.Cu,F.Paste,F.SilkS,B.SilkS,F.Mask,B.Mask,Edge.Cuts"
_DATE = re.compile(rb"^(%TF\.CreationDate.*|G04 Created by KiCad.*|; DRILL file.*|; #@! TF\.CreationDate.*)\r?\n", re.M)
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files in a zip: the earliest that the format allows."""

Progress = Callable[[str], None]
RunKicad = Callable[..., None]
"""Runs kicad-cli: name of the step, for progress and errors, and the arguments."""


def find_kicad() -> str:
    """Find kicad-cli and return its path.

    Raises
    ------
    MissingLibraryError
        If it is not on the PATH. The message says how to install it.
    """
    if path := shutil.which("kicad-cli"):
        return path
    raise MissingLibraryError(
        "--fab: kicad-cli is not on the PATH; install KiCad 9 (on Debian 12 from backports: apt-get install "
        "-t bookworm-backports kicad kicad-symbols kicad-footprints), or remove --fab."
    )


def fabrication_files(
    board_files: dict[str, bytes],
    circuit: Circuit,
    placement: Placement,
    progress: Progress = lambda message: None,
) -> dict[str, bytes]:
    """Export the fabrication files of a board.

    Parameters
    ----------
    board_files
        Content of the board's files by name.
    circuit
        Circuit of the board.
    placement
        Placement of its components.
    progress
        Called with the name of each step.

    Returns
    -------
    dict
        Content of the fabrication files by name.

    Raises
    ------
    MissingLibraryError
        If KiCad is not installed.
    BoardError
        If KiCad's checks find an error, or its export fails.
    """
    name = circuit.name
    board, schematic = f"{name}.kicad_pcb", f"{name}.kicad_sch"
    with kicad_session(board_files, progress) as (folder, run):
        run(
            "electrical rules check",
            "sch", "erc", schematic, "--severity-error", "--exit-code-violations", "-o", "erc.rpt",
        )  # fmt: skip
        run(
            "design rules check",
            "pcb", "drc", board, "--schematic-parity", "--severity-error", "--exit-code-violations", "-o", "drc.rpt",
        )  # fmt: skip
        gerbers = export_gerbers(folder, run, name)
        for side, suffix in (("top", "front"), ("bottom", "back")):
            run(
                f"rendering of the {suffix}",
                "pcb", "render", board, "--side", side, "--width", "1600", "--height", "1100",
                "-o", f"{name}_{suffix}.png",
            )  # fmt: skip
        run("schematic as PDF", "sch", "export", "pdf", schematic, "-o", f"{name}_schematic.pdf")
        exported = (f"{name}_front.png", f"{name}_back.png", f"{name}_schematic.pdf")
        return {
            f"{name}_gerbers.zip": gerbers,
            f"{name}_parts.csv": parts_file(circuit),
            f"{name}_placement.csv": placement_file(circuit, placement),
            **{file: (folder / file).read_bytes() for file in exported},
        }


@contextmanager
def kicad_session(board_files: dict[str, bytes], progress: Progress) -> Iterator[tuple[Path, RunKicad]]:
    """Provide a temporary folder with the board's files, and a function that runs kicad-cli in it."""
    kicad = find_kicad()
    with tempfile.TemporaryDirectory(prefix="fingertip-") as name:
        folder = Path(name)
        for file, data in board_files.items():
            (folder / file).write_bytes(data)

        def run(step: str, *arguments: str) -> None:
            progress(step)
            process = subprocess.run([kicad, *arguments], cwd=folder, capture_output=True, text=True, check=False)
            if process.returncode:
                output = " ".join((process.stdout + process.stderr).split())[-400:]
                raise BoardError(f"KiCad's {step} failed ({output}); the files of the board itself are unchanged.")

        yield folder, run


def export_gerbers(folder: Path, run: RunKicad, name: str) -> bytes:
    """Export the gerbers and the drill file of the board in a folder as one zip, without dates."""
    board = f"{name}.kicad_pcb"
    run("gerber export", "pcb", "export", "gerbers", board, "-l", _LAYERS, "--use-drill-file-origin", "-o", "gerbers/")
    run("drill file export", "pcb", "export", "drill", board, "--drill-origin", "plot", "-o", "gerbers/")
    # The job file is left out: board houses do not need it, and it contains the date.
    exported = sorted(path for path in (folder / "gerbers").iterdir() if path.suffix != ".gbrjob")
    return _zip_files((path.name, _DATE.sub(b"", path.read_bytes())) for path in exported)


def parts_file(circuit: Circuit) -> bytes:
    """Bill of materials in the columns of assembly houses. The part numbers are left blank for whoever orders.

    The comment of a resistor, a capacitor or a trimmer includes the rating, because its value alone does not determine
    what to buy. The lines are those of `bom.csv`.
    """
    rows = []
    for (value, footprint, rating), references in group_purchased(circuit).items():
        has_type_name = references[0].rstrip("0123456789") not in ("R", "C", "RV")
        rows.append((value if has_type_name else f"{value}, {rating}", ",".join(references), footprint, ""))
    return _format_csv(PARTS_COLUMNS, rows)


def placement_file(circuit: Circuit, placement: Placement) -> bytes:
    """Positions [mm] and rotations [degree] of the surface-mount components.

    The origin is the lower left corner of the board, as in the gerbers.
    """
    rows = []
    for component in purchased_components(circuit):
        if "PinHeader" in component.footprint:
            continue  # pin headers are soldered by hand
        position = placement.positions[component.reference]
        y = placement.height - position.y
        rows.append((component.reference, f"{position.x:.4f}mm", f"{y:.4f}mm", "Top", str(position.angle)))
    return _format_csv(PLACEMENT_COLUMNS, rows)


def _format_csv(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return text.getvalue().encode()


def _zip_files(files: Iterable[tuple[str, bytes]]) -> bytes:
    """Zip files with a fixed date, so that the same gerbers give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files:
            archive.writestr(zipfile.ZipInfo(name, _ZIP_DATE), data, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
