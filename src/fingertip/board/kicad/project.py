"""KiCad projects of the boards, one for each variant, routed and stored as KiCad opens them.

The archives in `projects` hold the values of the default design. What a design changes is entered: values, fields of
the parts, symbols of another amplifier, and the values printed on the back. `python -m tools.boards` in the repository
unpacks a project for KiCad, and stores it again. The project beside the layout holds design rules and severities of
KiCad's checks, and names the folder of the 3D models.
"""

from __future__ import annotations

import functools
import json
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.circuits.channels import PLACES, find_symbol, name_part, name_sheet, split_name
from fingertip.board.kicad.back_print import print_values
from fingertip.board.kicad.netlist import CircuitRecord, Part, describe_structure_changes
from fingertip.board.kicad.placement import Placement, read_placement
from fingertip.board.kicad.sexpr import MAX_LINE, quote, read_expression, unquote
from fingertip.board.parts.circuit import Circuit, Component, Symbol
from fingertip.board.parts.select_part import symbol_fields
from fingertip.board.parts.symbols import DUAL_AMPLIFIERS
from fingertip.catalogues.output_files import LAYOUT, PROJECT, SCHEMATIC
from fingertip.foundation.errors import BoardError

PROJECTS = Path(__file__).parent / "projects"
"""Folder of the archives."""
PROJECT_FILES = (LAYOUT, SCHEMATIC, PROJECT)
"""Files in the archive of a board; that of several fingers also has the sheet of a channel."""
SEVERAL = "channels"
"""Name of the archive of the board for several fingers."""

IGNORED_IN_SCHEMATIC = {
    "lib_symbol_mismatch": "symbols have the pins of KiCad's libraries, but lines of their own",
    "lib_symbol_issues": "the libraries of the symbols need not be installed: the schematic holds its symbols",
    "footprint_link_issues": "nor need those of the footprints: the layout holds its footprints",
}
"""Electrical rules that the projects switch off, by KiCad's name, with the reason."""
IGNORED_ON_BOARD = {
    "lib_footprint_mismatch": "footprints have the pads of KiCad's libraries, but outlines and silkscreen of their own",
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
    """3D model of every package, by its path below the folder of the models.

    Each is a STEP file of boxes with the outline and the height of the package. They stand in for the models of KiCad's
    own libraries, which take gigabytes and are often not installed. They have the folders and the names of KiCad's, so
    that one variable of the project selects the ones or the others.
    """
    return read_archive("models")


# A field of a footprint or a symbol. In a stored schematic it stands on one line, which is divided where it is long.
_WORD = r'"(?:[^"\\]|\\.)*"'
_PROPERTY = re.compile(rf"\(property ({_WORD}) ({_WORD})(?:( \(at [^()]*\))( \(effects .*))?")
_FOOTPRINT = re.compile(r'(?=\(footprint ")')
_SYMBOL = re.compile(r'(?=\(symbol\s+\(lib_id ")')
_REFERENCE = re.compile(r'\(property "Reference" "([^"]*)"')
_ROLE = re.compile(rf"\(descr {_WORD}\)")
_SHEET = re.compile(r"(?=\(sheet\s+\(at )")
_SHEET_NAME = re.compile(r'\(property "Sheetname" "([^"]*)"')
_ATTRIBUTES = re.compile(r"\(attr ([^()]*)\)")
_LIBRARY_ID = re.compile(r'\(lib_id "([^"]*)"\)')


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
    def placement(self) -> Placement:
        """Positions of the parts on the layout."""
        return read_placement(self.layout)

    @property
    def clearance_mm(self) -> float:
        """Least clearance of copper, which KiCad's design rules check requires."""
        return float(json.loads(self.project)["board"]["design_settings"]["rules"]["min_clearance"])

    @functools.cached_property
    def symbols(self) -> dict[str, str]:
        """Symbol of each component in the schematic, as library:name. A channel's sheet has those of the first one."""
        symbols = dict[str, str]()
        for piece in (piece for text in self.schematics.values() for piece in _SYMBOL.split(text)[1:]):
            if not (reference := _find(_REFERENCE, piece)).startswith("#"):
                symbol, (channel, own) = _find(_LIBRARY_ID, piece), find_symbol(reference)
                names = [name_part(own, k + 1) for k in range(PLACES)] if channel else [own]
                symbols |= dict.fromkeys(names, symbol)
        return symbols

    def enter(self, circuit: Circuit) -> dict[str, bytes]:
        """Enter a circuit into the project, and return its files by name.

        Raises BoardError if the project has other parts or nets, or lacks a field.
        """
        if found := list(self.find_differences(circuit)):
            raise BoardError(
                f"the stored KiCad project {self.name} is not that of its circuit ({'; '.join(found)}). Unpack it with "
                "python -m tools.boards in the repository, edit it in KiCad, and store it again."
            )
        layout = print_values(_enter_fields(self.layout, _FOOTPRINT, circuit), circuit, self.placement)
        drawn = {component.reference: _library_id(component.symbol) for component in circuit.components}
        files = {LAYOUT: layout.encode()}
        for file, stored in self.schematics.items():
            text = _leave_out(_enter_fields(stored, _SYMBOL, circuit), circuit)
            if drawn != self.symbols:
                parts = [name for piece in _SYMBOL.split(stored) if (name := _find(_REFERENCE, piece)) in drawn]
                text = _draw_symbols(text, {drawn[part]: self.symbols[part] for part in parts})
            files[file] = text.encode()
        return files | {PROJECT: self.project}

    def find_differences(self, circuit: Circuit) -> Iterator[str]:
        """Describe how the circuit differs from the layout in parts, footprints and nets, or from the schematic.

        A dual amplifier may be another one: their symbols have the same pins and lines.
        """
        wanted = {component.reference: component for component in circuit.components}
        amplifiers = set(map(_library_id, DUAL_AMPLIFIERS.values()))
        stored, nets = {}, dict[str, set[tuple[str, str]]]()
        for reference, part in self.placement.parts.items():
            symbol = self.symbols.get(reference, "")
            if reference in wanted and {symbol, _library_id(wanted[reference].symbol)} <= amplifiers:
                symbol = _library_id(wanted[reference].symbol)
            stored[reference] = Part("", (part.footprint, symbol), {})
            for pad in part.pads:
                if pad.net:
                    nets.setdefault(pad.net, set()).add((reference, pad.name))
        parts = {name: Part("", (c.footprint, _library_id(c.symbol)), {}) for name, c in wanted.items()}
        yield from describe_structure_changes(
            CircuitRecord(stored, {net: frozenset(nodes) for net, nodes in nets.items()}),
            CircuitRecord(parts, {net.name: frozenset(net.nodes) for net in circuit.nets}),
        )
        if undrawn := sorted(wanted.keys() ^ self.symbols.keys()):
            yield f"the schematic and the circuit do not both have {', '.join(undrawn)}"


@functools.cache
def load_project(variant: str, channels: int = 1) -> StoredProject:
    """Load the project of a board variant, or that of the board for several fingers."""
    name = variant if channels == 1 else SEVERAL
    return make_project(name, read_archive(name))


def make_project(name: str, files: Mapping[str, bytes]) -> StoredProject:
    """Make a project of its files."""
    sheets = {file: data.decode() for file, data in files.items() if file.endswith(Path(SCHEMATIC).suffix)}
    return StoredProject(name, files[LAYOUT].decode(), sheets, files[PROJECT])


def _find(pattern: re.Pattern[str], piece: str) -> str:
    match = pattern.search(piece)
    return match[1] if match else ""


def _library_id(symbol: Symbol) -> str:
    return f"{symbol.library}:{symbol.name}"


def _enter_fields(text: str, part: re.Pattern[str], circuit: Circuit) -> str:
    """Enter the fields of all components into the parts of a layout or a schematic, each of which begins with `part`.

    Raises BoardError if a part lacks a field.
    """
    components = {component.reference: component for component in circuit.components}
    head, *pieces = part.split(text)
    for i, piece in enumerate(pieces):
        if component := components.get(_find(_REFERENCE, piece)):
            pieces[i] = _enter_part(piece, component)
    return "".join((head, *pieces))


def _enter_part(piece: str, component: Component) -> str:
    fields = {
        "Value": component.value, "Description": component.symbol.description, **symbol_fields(component)
    }  # fmt: skip
    missing = set(fields)

    def enter(match: re.Match[str]) -> str:
        name = unquote(match[1])
        if name not in fields:
            return match[0]
        missing.discard(name)
        words, at, effects = f"(property {match[1]} {quote(fields[name])}", match[3], match[4]
        if not effects:
            return words
        indent = match.start() - piece.rfind("\n", 0, match.start()) - 1
        if indent + len(words + at + effects) > MAX_LINE:
            line = "\n" + " " * (indent + 1)
            return f"{words}{line}{at}{line}{effects}"
        return f"{words}{at}{effects}"

    entered = _PROPERTY.sub(enter, piece)
    if missing:
        raise BoardError(f"{component.reference} has no field {', '.join(sorted(missing))} in its KiCad project.")
    if not component.is_fitted:
        entered = _ATTRIBUTES.sub(lambda match: f"(attr {match[1]} dnp)", entered, count=1)
        entered = entered.replace("(dnp no)", "(dnp yes)", 1)
    entered = _ROLE.sub(lambda match: f"(descr {quote(component.role)})", entered, count=1)
    return _LIBRARY_ID.sub(lambda match: f"(lib_id {quote(_library_id(component.symbol))})", entered, count=1)


def _leave_out(schematic: str, circuit: Circuit) -> str:
    """Mark the sheets of the channels that are not fitted."""
    empty = {name_sheet(split_name(part.reference)[0]) for part in circuit.components if not part.is_fitted}
    head, *sheets = _SHEET.split(schematic)
    for i, sheet in enumerate(sheets):
        if _find(_SHEET_NAME, sheet) in empty:
            sheets[i] = sheet.replace("(dnp no)", "(dnp yes)", 1)
    return "".join((head, *sheets))


def _draw_symbols(schematic: str, drawn_as: dict[str, str]) -> str:
    """Draw the symbols that a schematic uses in its library: each as the stored one that it stands in for."""
    start = schematic.index("(lib_symbols")
    nodes = list(read_expression(schematic[start:]).children("symbol"))
    texts = {node.words[1]: schematic[start + node.start : start + node.end] for node in nodes}
    used = {new: _rename_symbol(texts[old], old, new) for new, old in drawn_as.items()}
    used |= {name: text for name, text in texts.items() if name.startswith(_POWER)}
    # As in the stored projects, the power symbols come last.
    ordered = sorted(used, key=lambda name: (name.startswith(_POWER), name.split(":")))
    gap = schematic[start + nodes[0].end : start + nodes[1].start]
    first, last = start + nodes[0].start, start + nodes[-1].end
    return schematic[:first] + gap.join(used[name] for name in ordered) + schematic[last:]


_POWER = "power:"


def _rename_symbol(text: str, old: str, new: str) -> str:
    """Rename a symbol with its units and the value that it has in the library."""
    old_name, new_name = old.partition(":")[2], new.partition(":")[2]
    return text.replace(f'"{old}"', f'"{new}"').replace(f'"{old_name}', f'"{new_name}')
