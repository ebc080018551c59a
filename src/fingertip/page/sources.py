"""Files of a design's folder that a page shows, if they are whole and of its parameters.

Parts and casting sheet must be there. Whatever else is missing or old leaves a remark with the
command that makes it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from pydantic import TypeAdapter

from fingertip.casting.sheet import CastingSheet
from fingertip.catalogues.output_files import (
    BOARD_FOLDER,
    PRINT_FOLDER,
    REPORT,
    SHEET,
    SIGNAL_FOLDER,
    STEPS_FOLDER,
)
from fingertip.catalogues.stated_errors import StatedError
from fingertip.design import Design
from fingertip.documents.finger_sheets import Loads
from fingertip.foundation.errors import Issue, OutputError, raise_issues
from fingertip.foundation.folder_swap import hash_content
from fingertip.foundation.input_files import OUTPUT_LIMIT, read_input
from fingertip.foundation.output_set import Manifest, hash_parameters, read_manifest
from fingertip.models.parts import parts_by_name
from fingertip.page.html import embed
from fingertip.page.parameters_and_checks import ReportedCheck

_MAKE = "fingertip make DESIGN"
COMMANDS = {
    STEPS_FOLDER: "fingertip build design.toml --out . --pictures",
    PRINT_FOLDER: "fingertip build design.toml --out .",
    BOARD_FOLDER: "fingertip board design.toml --out board --bringup",
    SIGNAL_FOLDER: "fingertip make design.toml --out .",
}
"""Folder of a set below the parts -> command that makes it in the folder of the page."""
_CHANGED = "were changed after they were written"
_SHOWN = (".md", ".json", ".svg", ".csv", ".png", ".stl", ".kicad_sch", ".kicad_pcb")
"""Ends of the names of files that a page may show."""


@dataclass(frozen=True)
class Report:
    """Part of report.json that a page shows."""

    checks: tuple[ReportedCheck, ...]
    prints: Mapping[str, tuple[str, ...]]
    """File for the printer -> parts that it holds."""
    casting: CastingSheet | None
    loads: Loads | None
    errors: tuple[StatedError, ...]

    @classmethod
    def read(cls, data: bytes) -> Report:
        """Read the report. Raises ValueError, LookupError or TypeError if it is none."""
        content = json.loads(data)
        prints = {path: tuple(entry["parts"]) for path, entry in content["print"].items()}
        casting = content.get("casting")
        strength = content.get("strength")
        loads = None
        if strength:
            loads = Loads(**{name: strength["loads"][name] for name in Loads.__match_args__})

        return cls(
            tuple(map(ReportedCheck.read, content["checks"])),
            prints,
            TypeAdapter(CastingSheet).validate_python(casting) if casting else None,
            loads,
            tuple(StatedError(key, **entry) for key, entry in content.get("errors", {}).items()),
        )


@dataclass(frozen=True)
class Sources:
    """Files of a design, by their path in its folder."""

    design: Design
    report: Report
    files: Mapping[str, bytes]
    """Path, such as "bone.stl" or "board/bom.csv" -> content."""
    remarks: Mapping[str, str]
    """Folder of a missing, old or changed set -> sentence with the command that makes it."""
    unread: frozenset[str] = frozenset()
    """Paths of the design's other files, which a page may link to."""

    @property
    def links(self) -> dict[str, str]:
        """Address of each file by its path; within the board's folder also by its name.

        Pictures are held here.
        """
        board = {
            path.partition("/")[2]: path
            for path in self.files
            if path.startswith(f"{BOARD_FOLDER}/")
        }
        addresses = {name: quote(path) for name, path in board.items()}
        addresses |= {path: quote(path) for path in (*self.files, *self.unread)}
        pictures = (
            path
            for path in self.files
            if path.startswith(f"{STEPS_FOLDER}/") and path.endswith(".png")
        )

        return addresses | {path: embed(self.files[path], "image/png") for path in pictures}

    def text(self, name: str) -> str | None:
        data = self.files.get(name)
        return None if data is None else data.decode("utf-8")


def read_sources(design: Design, folder: Path) -> Sources:
    """Read the files of a design from its folder. Raises OutputError."""
    parameters = hash_parameters(design.identity())
    manifest = read_manifest(folder)

    if manifest is None or manifest.kind != "parts":
        raise OutputError(
            Issue(str(folder), f"holds no parts of {design.name!r}; {_MAKE} makes them.")
        )

    if manifest.parameters != parameters:
        message = (
            f"holds parts of {manifest.design!r} that were made from other parameters; "
            f"{_MAKE} makes them again."
        )
        raise OutputError(Issue(str(folder), message))

    files = dict(_read_set(folder, manifest))
    required = (*(f"{part}.stl" for part in parts_by_name(design)), REPORT, SHEET)
    changed = [
        name
        for name in required
        if name in files and hash_content(files[name]) != manifest.files[name]
    ]
    issues = [
        Issue(str(folder / name), f"is missing; {_MAKE} makes it.")
        for name in required
        if name not in files
    ]
    message = f"was changed after it was written; {_MAKE} makes it again."
    issues += [Issue(str(folder / name), message) for name in changed]
    raise_issues(OutputError, issues)
    remarks = {}
    unread = set(manifest.files)

    for kind in (STEPS_FOLDER, BOARD_FOLDER, SIGNAL_FOLDER):
        contents = _read_current_set(folder, kind, parameters)
        if isinstance(contents, str):
            remedy = COMMANDS[kind]
            if contents.endswith(_CHANGED):
                remedy += " --force"

            remarks[kind] = f"{contents}; in the folder of the page, {remedy} makes them."
        else:
            files |= {f"{kind}/{name}": data for name, data in contents.items()}

    prints = read_manifest(folder / PRINT_FOLDER, folder)
    if prints and prints.parameters == parameters:
        unread |= {f"{PRINT_FOLDER}/{name}" for name in prints.files}

    present = frozenset(path for path in unread - files.keys() if os.path.lexists(folder / path))
    return Sources(
        design=design,
        report=Report.read(files[REPORT]),
        files=files,
        remarks=remarks,
        unread=present,
    )


def _read_current_set(top: Path, kind: str, parameters: str) -> dict[str, bytes] | str:
    """Read a set below the parts; a string says why it cannot be shown."""
    manifest = read_manifest(top / kind, top)
    name = f"The files in {kind}/"
    if manifest is None:
        return f"{name} are missing"
    if manifest.parameters != parameters:
        return f"{name} were made from other parameters"

    files = dict(_read_set(top / kind, manifest))
    if any(hash_content(data) != manifest.files[name] for name, data in files.items()):
        return f"{name} {_CHANGED}"

    return files


def _read_set(folder: Path, manifest: Manifest) -> Iterator[tuple[str, bytes]]:
    """Yield the present files of a set that a page may show, within a limit."""
    remaining = OUTPUT_LIMIT.value
    for name in sorted(manifest.files):
        if name.endswith(_SHOWN) and os.path.lexists(folder / name):
            data = read_input(folder / name, OUTPUT_LIMIT, below=folder)
            remaining -= len(data)
            if remaining < 0:
                message = (
                    "holds files that are too large together to be shown; raise "
                    f"{OUTPUT_LIMIT.variable}."
                )
                raise OutputError(Issue(str(folder), message))

            yield name, data
