"""Files of a board that were edited in KiCad: a new design's values are entered into them.

The netlist in the folder states the circuit that the files were made from. Where the new circuit
has the same parts, footprints and nets, the fields that differ between both circuits are replaced
in the edited file. Where it has not, the edited file cannot follow, and nothing is written.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from fingertip.board.circuits.channels import find_symbol
from fingertip.board.kicad.netlist import (
    CircuitRecord,
    describe_structure_changes,
    join_names,
    read_netlist,
)
from fingertip.board.kicad.placement import read_reference
from fingertip.board.kicad.sexpr import Node, Span, find_word, quote, read_expression, replace_spans
from fingertip.catalogues.output_files import (
    ASSEMBLY_DRAWING,
    BOM,
    CHANNEL_SHEET,
    DECK,
    LAYOUT,
    NETLIST,
    PROJECT,
    SCHEMATIC,
    VALUES,
)
from fingertip.foundation.errors import Issue, OutputError, raise_issues
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.output_set import Manifest, Revision, has_hash, read_manifest

_REMEDY = "write this design to another folder with --out, or add --force to overwrite your edits."


def find_edited(folder: Path) -> list[str]:
    """Find the layout, the schematic and the project that were changed after they were written."""
    manifest = read_manifest(folder)
    if manifest is None or manifest.kind != "board":
        return []

    return [
        name
        for name in (LAYOUT, SCHEMATIC, CHANNEL_SHEET, PROJECT)
        if name in manifest.files
        and (folder / name).is_file()
        and not has_hash(folder / name, manifest.files[name])
    ]


def refuse_other_circuit(folder: Path, netlist: bytes, beside: Path) -> None:
    """Refuse a folder whose unedited board has other parts, footprints or nets.

    Raises OutputError.
    """
    manifest = read_manifest(folder)
    path = folder / NETLIST

    if manifest is None or manifest.kind != "board":
        return
    if not has_hash(path, manifest.files.get(path.name)):
        return

    old = _read_circuit(path)
    if find_edited(folder):
        return

    differences = list(describe_structure_changes(old, read_netlist(netlist)))
    if differences:
        message = (
            f"holds a board of {manifest.design!r} with another circuit, and this one changes "
            "more than values "
            f"({'; '.join(differences)}); write it beside with --out {beside}, or add --force to "
            "replace the one there."
        )
        raise OutputError(Issue(str(folder), message))


def revise_edited(
    folder: Path, contents: Mapping[str, bytes], make_layout: Callable[[Mapping[str, str]], bytes]
) -> tuple[dict[str, Revision], list[str]]:
    """Revise the edited files for a board's new contents; return a note on each too.

    A project that KiCad or somebody changed is kept: it holds nothing of a design. Raises
    OutputError.
    """
    manifest = read_manifest(folder)
    present = {
        name: read_input(folder / name, PARSED_LIMIT, below=folder) for name in find_edited(folder)
    }
    present = {name: data for name, data in present.items() if data != contents[name]}
    revisions = {}
    notes = []
    issues = []

    if PROJECT in present:
        data = present.pop(PROJECT)
        revisions[PROJECT] = Revision(data, data)
        notes.append(f"{folder / PROJECT}: was changed in KiCad, and is kept as it is.")

    if present and manifest is not None:
        old, new = _read_both_circuits(folder, manifest, present, contents[NETLIST])
        for name, data in present.items():
            layouts = None
            if name == LAYOUT:
                values = {reference: part.fields["Value"] for reference, part in old.parts.items()}
                layouts = functools.partial(make_layout, values), contents[name]

            try:
                after, note, problems = _revise_file(
                    data,
                    select_drawn(old, name),
                    select_drawn(new, name),
                    layouts=layouts,
                )
            except ValueError as error:  # a UnicodeDecodeError is one too
                problems = [f"was edited and cannot be read ({error}); {_REMEDY}"]
            else:
                revisions[name] = Revision(data, after)
                notes.append(f"{folder / name}: {note}")

            issues += [Issue(str(folder / name), problem) for problem in problems]

    raise_issues(OutputError, issues)
    return revisions, notes


def _read_both_circuits(
    folder: Path, manifest: Manifest, edited: Iterable[str], netlist: bytes
) -> tuple[CircuitRecord, CircuitRecord]:
    """Read the circuit of a folder and a new one, which differ in values alone.

    Raises OutputError.
    """
    path = folder / NETLIST
    if not has_hash(path, manifest.files.get(NETLIST)):
        message = (
            f"was edited, and {NETLIST}, which states its circuit, is missing or was "
            f"changed; {_REMEDY}"
        )
        raise OutputError([Issue(str(folder / name), message) for name in edited])

    old = _read_circuit(path)
    new = read_netlist(netlist)
    differences = list(describe_structure_changes(old, new))
    if differences:
        message = (
            "was edited, and this design changes more than values "
            f"({'; '.join(differences)}); {_REMEDY}"
        )
        raise OutputError([Issue(str(folder / name), message) for name in edited])

    return old, new


def _revise_file(
    data: bytes,
    old: CircuitRecord,
    new: CircuitRecord,
    layouts: tuple[Callable[[], bytes], bytes] | None,
) -> tuple[bytes, str, list[str]]:
    """Return an edited file with the new values, a note on it, and its problems.

    Of a layout the generated ones are given too: what makes that of the old circuit, and the new
    one. Raises ValueError.
    """
    kind = "footprint" if layouts else "symbol"
    data, changed, problems = enter_values(data, kind, old, new)
    is_complete = True
    if layouts and changed:
        make_old, new_layout = layouts
        data, is_complete = enter_texts(data, make_old(), new_layout)

    result = "it has the values of this design"
    if changed:
        result = f"the values of {join_names(changed)} are updated"

    note = f"was edited; {result}, and nothing else changes."
    own = list_own_values(data, kind, new)
    if own:
        note += (
            f" Your values of {join_names(own)} are in it alone: {BOM}, {NETLIST}, {DECK}, "
            f"{VALUES} and {ASSEMBLY_DRAWING} have those of the design."
        )
    if not is_complete:
        note += " This design prints more or fewer lines of values than it shows: compare them."

    return data, note, problems


def _read_circuit(path: Path) -> CircuitRecord:
    try:
        return read_netlist(read_input(path, PARSED_LIMIT, below=path.parent))
    except (ValueError, StopIteration):
        raise OutputError(Issue(str(path), f"states no circuit; {_REMEDY}")) from None


def select_drawn(circuit: CircuitRecord, file: str) -> CircuitRecord:
    """Select the parts that a file shows, each with the identifier that it has there.

    The sheet of a channel shows those of the first one, and all channels have their values.
    """
    if file == LAYOUT:
        return circuit

    channel = 1 if file == CHANNEL_SHEET else 0
    parts = {
        name: replace(part, identifier=part.identifier.rpartition("/")[2])
        for name, part in circuit.parts.items()
        if find_symbol(name)[0] == channel
    }
    return replace(circuit, parts=parts)


def enter_values(
    data: bytes, kind: str, old: CircuitRecord, new: CircuitRecord
) -> tuple[bytes, list[str], list[str]]:
    """Enter the fields that differ between two circuits into a layout or a schematic."""
    text = data.decode()
    root = read_expression(text)
    by_identifier = {part.identifier: name for name, part in old.parts.items()}
    # Further units of a symbol have identifiers of their own, but the reference of the first.
    items = list(root.children(kind))
    references = {
        by_identifier[_identifier(item)]: read_reference(item)
        for item in items
        if _identifier(item) in by_identifier
    }
    changes: dict[Span, str] = {}
    changed = []
    problems = []

    for name, part in new.parts.items():
        before = old.parts[name].fields
        new_values = {
            field: value for field, value in part.fields.items() if value != before.get(field, "")
        }
        if not new_values:
            continue

        if name not in references:
            problems.append(
                f"lacks {name}, whose {join_names(sorted(new_values))} this design changes; "
                f"{_REMEDY}"
            )
            continue

        changed.append(references[name])
        units = (item for item in items if read_reference(item) == references[name])
        for field, value, entry in itertools.chain.from_iterable(map(_properties, units)):
            new_value = new_values.get(field, value)
            if value == new_value:
                continue

            old_value = before.get(field, "")
            if value == old_value:
                changes[find_word(text, entry, 2)] = quote(new_value)
            else:
                problems.append(
                    f"{references[name]} has {field} {value!r} by hand, and this design changes "
                    f"it from {old_value!r} to {new_value!r}; enter either in KiCad, or "
                    f"{_REMEDY}"
                )

    return replace_spans(text, changes).encode(), changed, problems


def list_own_values(data: bytes, kind: str, circuit: CircuitRecord) -> list[str]:
    """List the parts of a layout or a schematic whose values are not those of a circuit."""
    parts = {part.identifier: part for part in circuit.parts.values()}
    own = []
    for item in read_expression(data.decode()).children(kind):
        part = parts.get(_identifier(item))
        for field, text, _ in _properties(item) if part else ():
            if part and field == "Value" and text != part.fields["Value"]:
                own.append(read_reference(item))

    return own


def enter_texts(data: bytes, old_layout: bytes, new_layout: bytes) -> tuple[bytes, bool]:
    """Enter printed texts that differ between two layouts, such as values, into an edited one."""
    text = data.decode()
    old, new = (
        _printed_texts(read_expression(layout.decode())) for layout in (old_layout, new_layout)
    )
    changes = {
        find_word(text, item, 1): quote(new[identifier].words[1])
        for identifier, item in _printed_texts(read_expression(text)).items()
        if identifier in old
        and identifier in new
        and item.words[1] == old[identifier].words[1] != new[identifier].words[1]
    }

    return replace_spans(text, changes).encode(), old.keys() == new.keys()


def _printed_texts(root: Node) -> dict[str, Node]:
    """Texts of a layout apart from those of its footprints, by UUID."""
    return {item.word("uuid"): item for item in root.children("gr_text") if len(item.words) > 1}


def _identifier(item: Node) -> str:
    return item.word("path") if item.head == "footprint" else item.word("uuid")


def _properties(item: Node) -> Iterator[tuple[str, str, Node]]:
    """Yield the fields of a part: name, text, and the list that holds them."""
    for entry in item.children("property"):
        if len(entry.words) > 2:
            yield entry.words[1], entry.words[2], entry
