"""What a board house and an assembly house take: gerbers and drill in one zip, placement and parts files, pictures.

KiCad makes gerbers, drill file and pictures (its command line program kicad-cli); placement and parts come from the
circuit itself. Nothing is exported from a board that KiCad's own checks refuse.
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
from fingertip.board.fabrication.bom import bought, grouped
from fingertip.board.layout.placement import Placement
from fingertip.errors import BoardError, MissingLibraryError

PARTS_COLUMNS = ("Comment", "Designator", "Footprint", "Part Number")
PLACEMENT_COLUMNS = ("Designator", "Mid X", "Mid Y", "Layer", "Rotation")

_LAYERS = "F.Cu,B.Cu,F.Paste,F.SilkS,B.SilkS,F.Mask,B.Mask,Edge.Cuts"
_DATE = re.compile(rb"^(%TF\.CreationDate.*|G04 Created by KiCad.*|; DRILL file.*|; #@! TF\.CreationDate.*)\r?\n", re.M)
_LONG_AGO = (1980, 1, 1, 0, 0, 0)

Progress = Callable[[str], None]
Run = Callable[..., None]
"""What it is called, and KiCad's arguments."""


def find_kicad() -> str:
    """Path of kicad-cli.

    Raises
    ------
    MissingLibraryError
        With how to install it.
    """
    if found := shutil.which("kicad-cli"):
        return found
    raise MissingLibraryError(
        "--fab needs kicad-cli, which is not on the PATH: install KiCad 9 (on Debian 12 from its backports suite: "
        "apt-get install -t bookworm-backports kicad kicad-symbols kicad-footprints), or leave --fab out."
    )


def fabrication_files(
    files: dict[str, bytes], circuit: Circuit, placement: Placement, progress: Progress = lambda _words: None
) -> dict[str, bytes]:
    """File name -> content of all fabrication files, for the board's files.

    Raises
    ------
    MissingLibraryError
        If KiCad is not installed.
    BoardError
        If KiCad's checks find something, or its export fails.
    """
    name = circuit.name
    board, sheet = f"{name}.kicad_pcb", f"{name}.kicad_sch"
    with _bench(files, progress) as (here, run):
        run(
            "electrical rules check", "sch", "erc", sheet, "--severity-error", "--exit-code-violations", "-o", "erc.rpt"
        )
        run(
            "design rules check", "pcb", "drc", board, "--schematic-parity", "--severity-error",
            "--exit-code-violations", "-o", "drc.rpt",
        )  # fmt: skip
        zipped = _gerbers(here, run, name)
        for side, word in (("top", "front"), ("bottom", "back")):
            picture = f"{name}_{word}.png"
            run(f"picture of the {word}", "pcb", "render", board, "--side", side, "--width", "1600", "--height", "1100",
                "-o", picture)  # fmt: skip
        run("schematic as PDF", "sch", "export", "pdf", sheet, "-o", f"{name}_schematic.pdf")
        return {
            f"{name}_gerbers.zip": zipped,
            f"{name}_parts.csv": parts_file(circuit),
            f"{name}_placement.csv": placement_file(circuit, placement),
            **{f: (here / f).read_bytes() for f in (f"{name}_front.png", f"{name}_back.png", f"{name}_schematic.pdf")},
        }


def gerbers(files: dict[str, bytes], name: str) -> bytes:
    """Gerbers and drill file of the board's files as one zip, unchecked. Raises as `fabrication_files` does."""
    with _bench(files, lambda _words: None) as (here, run):
        return _gerbers(here, run, name)


@contextmanager
def _bench(files: dict[str, bytes], progress: Progress) -> Iterator[tuple[Path, Run]]:
    """A folder with the board's files, and KiCad to be run in it."""
    kicad = find_kicad()
    with tempfile.TemporaryDirectory(prefix="fingertip-") as folder:
        here = Path(folder)
        for file, data in files.items():
            (here / file).write_bytes(data)

        def run(what: str, *arguments: str) -> None:
            progress(what)
            done = subprocess.run([kicad, *arguments], cwd=here, capture_output=True, text=True, check=False)
            if done.returncode:
                said = " ".join((done.stdout + done.stderr).split())[-400:]
                raise BoardError(
                    f"KiCad's {what} failed ({said}); the files of the board itself are not touched by this."
                )

        yield here, run


def _gerbers(here: Path, run: Run, name: str) -> bytes:
    board = f"{name}.kicad_pcb"
    run("gerbers", "pcb", "export", "gerbers", board, "-l", _LAYERS, "--use-drill-file-origin", "-o", "gerbers/")
    run("drill file", "pcb", "export", "drill", board, "--drill-origin", "plot", "-o", "gerbers/")
    # The job file is left out: no house needs it, and it is dated.
    found = sorted(path for path in (here / "gerbers").iterdir() if path.suffix != ".gbrjob")
    return _zipped((path.name, _DATE.sub(b"", path.read_bytes())) for path in found)


def parts_file(circuit: Circuit) -> bytes:
    """Bill of materials in assembly houses' columns; the part numbers are left for whoever orders.

    The comment of a resistor, a capacitor or a trimmer carries what to look for, as only its value would be bought
    otherwise; the lines are those of `bom.csv`.
    """
    rows = []
    for (value, footprint, rating), references in grouped(circuit).items():
        named = references[0].rstrip("0123456789") not in ("R", "C", "RV")
        rows.append((value if named else f"{value}, {rating}", ",".join(references), footprint, ""))
    return _table(PARTS_COLUMNS, rows)


def placement_file(circuit: Circuit, placement: Placement) -> bytes:
    """Places of the surface-mounted parts [mm, degree] from the lower left corner, as the gerbers have it."""
    rows = []
    for part in bought(circuit):
        if "PinHeader" in part.footprint:
            continue  # soldered by hand
        spot = placement.spots[part.reference]
        y = placement.height - spot.y
        rows.append((part.reference, f"{spot.x:.4f}mm", f"{y:.4f}mm", "Top", str(spot.angle)))
    return _table(PLACEMENT_COLUMNS, rows)


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return text.getvalue().encode()


def _zipped(files: Iterable[tuple[str, bytes]]) -> bytes:
    """A zip with fixed dates, so that the same gerbers give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files:
            archive.writestr(zipfile.ZipInfo(name, _LONG_AGO), data, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
