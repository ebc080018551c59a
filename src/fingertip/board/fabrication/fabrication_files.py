"""Fabrication files: gerbers and drill files in a zip, parts and placement, renderings.

KiCad's command-line program kicad-cli exports gerbers, drill files and renderings. Parts and
placement are written from the circuit itself: in the columns of one assembly house, and a placement
file with KiCad's rotations for any other. A board that fails KiCad's own checks is not exported.
"""

from __future__ import annotations

import io
import shutil
import subprocess
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from fingertip.board.fabrication.bom import (
    ASSEMBLY_BOM,
    ASSEMBLY_PLACEMENT,
    assembly_bom_file,
    placement_file,
)
from fingertip.board.kicad.placement import Placement
from fingertip.board.parts.circuit import Circuit
from fingertip.foundation.errors import BoardError, InputFileError, MissingLibraryError
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.folder_swap import hash_content
from fingertip.foundation.input_files import OUTPUT_LIMIT, PARSED_LIMIT, read_input
from fingertip.foundation.progress import Work

_LAYERS = "F.Cu,B.Cu,F.Paste,F.SilkS,B.SilkS,F.Mask,B.Mask,Edge.Cuts"
_PICTURE = "--width 1600 --height 1100"
_DATED = (b"%TF.CreationDate", b"G04 Created by KiCad", b"; DRILL file", b"; #@! TF.CreationDate")
"""Beginnings of the lines of gerbers and drill files that hold a date."""
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of all files in a zip: the earliest that the format allows."""

Progress = Callable[[str], None]
RunKicad = Callable[[str, str], None]
"""Runs a step of the export, for a circuit of this name."""


def find_kicad() -> str:
    """Find kicad-cli and return its path. Raises MissingLibraryError."""
    path = shutil.which("kicad-cli")
    if path:
        return path

    raise MissingLibraryError(
        "--fab: kicad-cli is not on the PATH; install KiCad 9 (on Debian 12 from backports: "
        "apt-get install "
        "-t bookworm-backports kicad kicad-symbols kicad-footprints), or remove --fab."
    )


STEPS = {
    "electrical rules check": (
        2.0,
        "sch erc {0}.kicad_sch --severity-error --exit-code-violations -o erc.rpt",
    ),
    "design rules check": (
        3.0,
        "pcb drc {0}.kicad_pcb --schematic-parity --severity-error --exit-code-violations -o "
        "drc.rpt",
    ),
    "gerber export": (
        2.0,
        f"pcb export gerbers {{0}}.kicad_pcb -l {_LAYERS} --use-drill-file-origin -o gerbers/",
    ),
    "drill file export": (
        1.5,
        "pcb export drill {0}.kicad_pcb --drill-origin plot --excellon-separate-th -o gerbers/",
    ),
    "rendering of the front": (
        15.0,
        f"pcb render {{0}}.kicad_pcb --side top {_PICTURE} -o {{0}}_front.png",
    ),
    "rendering of the back": (
        15.0,
        f"pcb render {{0}}.kicad_pcb --side bottom {_PICTURE} -o {{0}}_back.png",
    ),
    "schematic as PDF": (2.0, "sch export pdf {0}.kicad_sch -o {0}_schematic.pdf"),
}
"""Steps of the export: relative duration, and arguments of kicad-cli with {0} for the circuit."""


def fabrication_files(
    board_files: dict[str, bytes],
    circuit: Circuit,
    placement: Placement,
    progress: Progress = lambda message: None,
) -> dict[str, bytes]:
    """Export the fabrication files of a board. Raises MissingLibraryError or BoardError."""
    name = circuit.name
    work = Work("KiCad", {step: duration for step, (duration, _) in STEPS.items()}, progress)

    with kicad_session(board_files, work.begin) as (folder, run):
        for check in ("electrical rules check", "design rules check"):
            run(check, name)

        gerbers = export_gerbers(folder, run, name)
        for step in ("rendering of the front", "rendering of the back", "schematic as PDF"):
            run(step, name)

        exported = (f"{name}_front.png", f"{name}_back.png", f"{name}_schematic.pdf")
        return {
            f"{name}_gerbers.zip": gerbers,
            ASSEMBLY_BOM: assembly_bom_file(circuit),
            ASSEMBLY_PLACEMENT: placement_file(circuit, placement, for_house=True),
            f"{name}_placement.csv": placement_file(circuit, placement, for_house=False),
            **{file: (folder / file).read_bytes() for file in exported},
        }


@contextmanager
def kicad_session(
    board_files: dict[str, bytes], progress: Progress
) -> Iterator[tuple[Path, RunKicad]]:
    """Provide a temporary folder of the board's files, and a function that runs kicad-cli there."""
    kicad = find_kicad()
    with temporary_folder() as folder:
        for file, data in board_files.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(data)

        def run(step: str, name: str) -> None:
            progress(step)
            command = [kicad, *STEPS[step][1].format(name).split()]
            process = subprocess.run(
                command,
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )

            if process.returncode:
                output = " ".join((process.stdout + process.stderr).split())[-400:]
                raise BoardError(
                    f"KiCad's {step} failed ({output}); the files of the board itself are "
                    "unchanged."
                )

        yield folder, run


def export_gerbers(folder: Path, run: RunKicad, name: str) -> bytes:
    """Export the gerbers and the drill files of the board in a folder as one zip, without dates.

    Plated and unplated holes have drill files of their own: a board house plates all holes of one
    file.
    """
    run("gerber export", name)
    run("drill file export", name)
    # The job file is left out: board houses do not need it, and it contains the date.
    exported = sorted(path for path in (folder / "gerbers").iterdir() if path.suffix != ".gbrjob")
    buffer = io.BytesIO()

    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in exported:
            lines = path.read_bytes().splitlines(keepends=True)
            data = b"".join(line for line in lines if not line.startswith(_DATED))
            archive.writestr(zipfile.ZipInfo(path.name, _ZIP_DATE), data, zipfile.ZIP_DEFLATED)

    return buffer.getvalue()


def panel_command(layout: Path, panel: Path, rows: int, columns: int) -> list[str]:
    """Return KiKit's command for a panel of a board: V-cuts, rails, fiducials and tooling holes.

    No pad but those of the sockets lies within a millimetre of an edge, which a V-cut takes.
    """
    return [
        "kikit",
        "panelize",
        "--layout",
        f"grid; rows: {rows}; cols: {columns}; space: 0mm",
        "--tabs",
        "full",
        "--cuts",
        "vcuts",
        "--framing",
        "railstb; width: 5mm; space: 0mm",
        "--fiducials",
        "3fid; hoffset: 5mm; voffset: 2.5mm; coppersize: 1mm; opening: 2mm",
        "--tooling",
        "3hole; hoffset: 2.5mm; voffset: 2.5mm; size: 1.5mm",
        str(layout),
        str(panel),
    ]


def run_kikit(command: list[str]) -> bool:
    """Run the command where KiKit is installed, and return whether it is. Raises BoardError."""
    kikit = shutil.which(command[0])
    if not kikit:
        return False

    process = subprocess.run([kikit, *command[1:]], capture_output=True, text=True, check=False)
    if process.returncode:
        output = " ".join((process.stdout + process.stderr).split())[-400:]
        raise BoardError(f"KiKit failed ({output}); the files of the board itself are unchanged.")

    return True


# Provenance of fabrication files: hashes of the board they were made from.
#
# They reveal gerbers of an earlier board before anybody sends them to a board house.

_SOURCES = (".kicad_pcb", ".kicad_sch", "bom.csv")
"""Endings of the names of the board files that the fabrication files depend on."""
_PARENT = "../"


def provenance_record(
    board_files: Mapping[str, bytes], fabrication_files: Mapping[str, bytes]
) -> bytes:
    """Return the record, for `sha256sum --check`: board files, and fabrication files."""
    lines = [
        f"{hash_content(data)}  {_PARENT}{name}"
        for name, data in board_files.items()
        if name.endswith(_SOURCES)
    ]
    lines += [f"{hash_content(data)}  {name}" for name, data in fabrication_files.items()]
    return ("\n".join(lines) + "\n").encode()


def find_outdated_files(folder: Path, record: str, board_files: Mapping[str, bytes]) -> list[str]:
    """Describe how a fabrication folder differs from the board's files; empty if it does not."""
    remedy = "write it again with --fab"
    try:
        text = read_input(folder / record, PARSED_LIMIT, below=folder.parent).decode()
        lines = [line.split("  ", 1) for line in text.splitlines()]
        recorded = {name: digest for digest, name in lines}
    except (InputFileError, ValueError):  # a UnicodeDecodeError is a ValueError
        return [
            f"{folder}: has no valid {record} that names the board its files were made from; "
            f"{remedy}."
        ]

    sources = {
        f"{_PARENT}{name}": data for name, data in board_files.items() if name.endswith(_SOURCES)
    }
    differences = [
        f"{folder}: was made from another {name.removeprefix(_PARENT)} than this design gives; "
        f"{remedy}."
        for name, data in sources.items()
        if recorded.get(name) != hash_content(data)
    ]
    for name, digest in recorded.items():
        if not name.startswith(_PARENT):
            path = folder / name
            try:
                if hash_content(read_input(path, OUTPUT_LIMIT, below=folder)) != digest:
                    differences.append(f"{path}: was changed after it was made.")
            except InputFileError as error:
                differences += [issue.typed for issue in error.issues]

    return differences
