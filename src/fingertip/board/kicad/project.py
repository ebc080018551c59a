"""KiCad projects of the boards, one for each variant, routed and stored as KiCad opens them.

The archives in `projects` hold the values of the default design. What a design changes is entered:
values, fields of the parts, symbols of another amplifier, and the values printed on the back.
`python -m tools.boards` in the repository unpacks a project for KiCad, and stores it again. The
project beside the layout holds design rules and severities of KiCad's checks, and names the folder
of the 3D models.
"""

from __future__ import annotations

import functools
import itertools
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.circuits.channels import PLACES, find_symbol, name_part, name_sheet, split_name
from fingertip.board.kicad import sexpr
from fingertip.board.kicad.back_print import print_values
from fingertip.board.kicad.netlist import symbol_fields
from fingertip.board.kicad.placement import Placement, read_placement, read_reference
from fingertip.board.parts.circuit import Circuit, Component, Symbol
from fingertip.catalogues.output_files import LAYOUT, PROJECT, SCHEMATIC
from fingertip.foundation.errors import BoardError

PROJECTS = Path(__file__).parent / "projects"
"""Folder of the archives."""
SEVERAL = "channels"
"""Name of the archive of the board for several fingers."""

IGNORED_IN_SCHEMATIC = {
    "lib_symbol_mismatch": "symbols have the pins of KiCad's libraries, but lines of their own",
    "lib_symbol_issues": "the libraries of the symbols need not be installed: the schematic holds "
    "its symbols",
    "footprint_link_issues": "nor need those of the footprints: the layout holds its footprints",
}
"""Electrical rules that the projects switch off, by KiCad's name, with the reason."""
IGNORED_ON_BOARD = {
    "lib_footprint_mismatch": "footprints have the pads of KiCad's libraries, but outlines and "
    "silkscreen of their own",
    "lib_footprint_issues": "the libraries of the footprints need not be installed",
}
"""Design rules that the projects switch off, by KiCad's name, with the reason."""

MODEL_FOLDER = "3d"
"""Folder of the 3D models, beside the board."""
MODEL_VARIABLE = "PARTS_3D"
"""Text variable of the project that names the folder of the models."""
MODEL_FOLDER_OF_KICAD = "${KICAD9_3DMODEL_DIR}"
"""Value of the variable that selects KiCad's own models."""


def read_archive(name: str) -> dict[str, bytes]:
    """Read the files of an archive in `projects`, by path."""
    with zipfile.ZipFile(PROJECTS / f"{name}.zip") as archive:
        return {path: archive.read(path) for path in archive.namelist()}


@functools.cache
def model_files() -> dict[str, bytes]:
    """Return the 3D model of every package, by its path below the folder of the models.

    Each is a STEP file of boxes with the outline and the height of the package. They stand in for
    the models of KiCad's own libraries, which take gigabytes and are often not installed. They have
    the folders and the names of KiCad's, so that one variable of the project selects the ones or
    the others.
    """
    return read_archive("models")


@dataclass(frozen=True)
class StoredProject:
    """Routed project of a board, with the values of the default design."""

    name: str
    layout: str
    schematics: Mapping[str, str]
    """Text of each sheet by the name of its file."""
    project: bytes
    """Content of the project file, which no design changes."""

    @functools.cached_property
    def board(self) -> sexpr.Node:
        """Lists of the layout without its zones, which come last and fill a third of the file."""
        return sexpr.read_expression(self.layout.partition("(zone")[0] + ")")

    @functools.cached_property
    def sheets(self) -> Mapping[str, sexpr.Node]:
        """Lists of each schematic by the name of its file."""
        return {file: sexpr.read_expression(text) for file, text in self.schematics.items()}

    @functools.cached_property
    def placement(self) -> Placement:
        """Positions of the parts on the layout."""
        return read_placement(self.board)

    @property
    def clearance_mm(self) -> float:
        """Least clearance of copper, which KiCad's design rules check requires."""
        return float(json.loads(self.project)["board"]["design_settings"]["rules"]["min_clearance"])

    @functools.cached_property
    def symbols(self) -> dict[str, str]:
        """Symbol of each component in the schematic, as library:name.

        A channel's sheet has those of the first one.
        """
        symbols = dict[str, str]()
        sheets = self.sheets.values()
        for part in itertools.chain.from_iterable(sheet.children("symbol") for sheet in sheets):
            reference = read_reference(part)
            if not reference.startswith("#"):
                channel, own = find_symbol(reference)
                names = [name_part(own, k + 1) for k in range(PLACES)] if channel else [own]
                symbols |= dict.fromkeys(names, part.word("lib_id"))

        return symbols

    def enter(self, circuit: Circuit) -> dict[str, bytes]:
        """Enter a circuit into its project, and return the files by name.

        Raises BoardError if a field is missing.
        """
        changes = _enter_fields(self.layout, self.board, circuit)
        changes |= print_values(self.layout, self.board, circuit, self.placement)
        files = {LAYOUT: sexpr.replace_spans(self.layout, changes).encode()}
        symbols = {part.reference: library_id(part.symbol) for part in circuit.components}
        empty_sheets = {
            name_sheet(split_name(part.reference)[0])
            for part in circuit.components
            if not part.is_fitted
        }

        for file, sheet in self.sheets.items():
            text = self.schematics[file]
            changes = _enter_fields(text, sheet, circuit)
            changes |= _mark_empty_sheets(text, sheet, empty_sheets)
            if symbols != self.symbols:
                references = [read_reference(part) for part in sheet.children("symbol")]
                drawn_as = {
                    symbols[reference]: self.symbols[reference]
                    for reference in references
                    if reference in symbols
                }
                changes |= _draw_symbols(text, sheet, drawn_as)

            files[file] = sexpr.replace_spans(text, changes).encode()

        return files | {PROJECT: self.project}


@functools.cache
def load_project(variant: str, channels: int = 1) -> StoredProject:
    """Load the project of a board variant, or that of the board for several fingers."""
    name = variant if channels == 1 else SEVERAL
    return make_project(name, read_archive(name))


def make_project(name: str, files: Mapping[str, bytes]) -> StoredProject:
    sheets = {
        file: data.decode() for file, data in files.items() if file.endswith(Path(SCHEMATIC).suffix)
    }
    return StoredProject(name, files[LAYOUT].decode(), sheets, files[PROJECT])


def library_id(symbol: Symbol) -> str:
    """Return the name of a symbol as KiCad states it, library:name."""
    return f"{symbol.library}:{symbol.name}"


def _enter_fields(text: str, root: sexpr.Node, circuit: Circuit) -> dict[sexpr.Span, str]:
    """Enter the fields of all components into the parts of a layout or a schematic.

    Raises BoardError if a part lacks a field.
    """
    components = {component.reference: component for component in circuit.components}
    changes: dict[sexpr.Span, str] = {}

    for part in root.children("footprint", "symbol"):
        component = components.get(read_reference(part))
        if component:
            changes |= _enter_part(text, part, component)

    return changes


def _enter_part(text: str, part: sexpr.Node, component: Component) -> dict[sexpr.Span, str]:
    fields = {
        "Value": component.value,
        "Description": component.symbol.description,
        **symbol_fields(component),
    }
    changes: dict[sexpr.Span, str] = {}
    for entry in part.children("property"):
        if entry.words[1] in fields:
            changes |= sexpr.change_property(text, entry, fields.pop(entry.words[1]))

    if fields:
        raise BoardError(
            f"{component.reference} has no field {', '.join(sorted(fields))} in its KiCad project."
        )

    for item in part.children("descr"):
        changes[sexpr.find_word(text, item, 1)] = sexpr.quote(component.role)

    for item in part.children("lib_id"):
        changes[sexpr.find_word(text, item, 1)] = sexpr.quote(library_id(component.symbol))

    if not component.is_fitted:
        changes |= _mark_empty(text, part)
        changes |= {(item.end - 1, item.end - 1): " dnp" for item in part.children("attr")}

    return changes


def _mark_empty_sheets(text: str, schematic: sexpr.Node, names: set[str]) -> dict[sexpr.Span, str]:
    """Mark the sheets with these names as not fitted."""
    changes: dict[sexpr.Span, str] = {}
    for sheet in schematic.children("sheet"):
        properties = [entry.words[1:3] for entry in sheet.children("property")]
        if any(key == "Sheetname" and value in names for key, value in properties):
            changes |= _mark_empty(text, sheet)

    return changes


def _mark_empty(text: str, item: sexpr.Node) -> dict[sexpr.Span, str]:
    """Mark a symbol or a sheet as not fitted (KiCad: do not populate)."""
    return {sexpr.find_word(text, mark, 1): "yes" for mark in item.children("dnp")}


def _draw_symbols(
    text: str, schematic: sexpr.Node, drawn_as: dict[str, str]
) -> dict[sexpr.Span, str]:
    """Return a schematic's symbol library with the new symbols, each drawn as the stored one."""
    nodes = list(sexpr.first(schematic, "lib_symbols").children("symbol"))
    stored = {node.words[1]: text[node.start : node.end] for node in nodes}
    used = {name: symbol for name, symbol in stored.items() if name.startswith(_POWER)}

    for new, old in drawn_as.items():
        old_name = old.partition(":")[2]
        new_name = new.partition(":")[2]
        # The units and the value in the library bear the name too.
        used[new] = (
            stored[old].replace(f'"{old}"', f'"{new}"').replace(f'"{old_name}', f'"{new_name}')
        )

    # As in the stored projects, the power symbols come last.
    ordered = sorted(used, key=lambda name: (name.startswith(_POWER), name.split(":")))
    gap = text[nodes[0].end : nodes[1].start]
    return {(nodes[0].start, nodes[-1].end): gap.join(used[name] for name in ordered)}


_POWER = "power:"
