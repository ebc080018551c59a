"""Files of a board that somebody edited in KiCad: a change of values is entered into them, and nothing else.

The netlist in the folder states the circuit that the files were made from. Where the new circuit has the same parts,
footprints and nets, the fields that differ between both circuits are replaced in the edited file. Where it has not,
the edited file cannot follow, and nothing is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.kicad.sexpr import Node, Word, read_expression, replace_words
from fingertip.catalogues.output_files import LAYOUT, NETLIST, PROJECT, SCHEMATIC
from fingertip.foundation.errors import Issue, OutputError
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.output_set import Revision, read_manifest
from fingertip.foundation.output_set.writer import has_hash

_REMEDY = "write this design to another folder with --out, or add --force to overwrite your edits."
_MAX_NAMES = 6
"""Largest number of names in a sentence."""
Fields = Mapping[str, str]


@dataclass(frozen=True)
class Part:
    identifier: str
    """UUID by which KiCad's files refer to it; it stays when a user renumbers the parts."""
    kind: tuple[str, str]
    """Footprint and symbol."""
    fields: Fields


@dataclass(frozen=True)
class CircuitRecord:
    """Parts by reference and nets by name, as a netlist states them."""

    parts: Mapping[str, Part]
    nets: Mapping[str, frozenset[tuple[str, str]]]


@dataclass(frozen=True)
class EditedFiles:
    """Files that somebody edited, and their new content."""

    revisions: Mapping[str, Revision]
    """Present and new content by name."""
    notes: tuple[str, ...]
    """Sentence on each of them."""


def find_edited(folder: Path) -> list[str]:
    """Find the layout, the schematic and the project that were changed after they were written."""
    manifest = read_manifest(folder)
    if manifest is None or manifest.kind != "board":
        return []
    return [
        name
        for name in (LAYOUT, SCHEMATIC, PROJECT)
        if name in manifest.files and (folder / name).is_file() and not has_hash(folder / name, manifest.files[name])
    ]


def refuse_other_circuit(folder: Path, netlist: bytes, beside: Path) -> None:
    """Refuse a folder whose unedited board has other parts, footprints or nets. Raises OutputError."""
    manifest, path = read_manifest(folder), folder / NETLIST
    if manifest is None or manifest.kind != "board" or not has_hash(path, manifest.files.get(path.name)):
        return
    old = _read_circuit(path)
    if not find_edited(folder) and (found := list(describe_structure_changes(old, read_netlist(netlist)))):
        message = (
            f"holds a board of {manifest.design!r} with another circuit, and this one changes more than values "
            f"({'; '.join(found)}); write it beside with --out {beside}, or add --force to replace the one there."
        )
        raise OutputError(Issue(str(folder), message))


def revise_edited(
    folder: Path, contents: Mapping[str, bytes], make_layout: Callable[[Mapping[str, str]], bytes]
) -> EditedFiles:
    """Revise the edited files of a folder for new contents of the board.

    A project that KiCad or somebody changed is kept: it holds nothing of a design.

    Raises OutputError.
    """
    manifest = read_manifest(folder)
    present = {name: read_input(folder / name, PARSED_LIMIT, below=folder) for name in find_edited(folder)}
    present = {name: data for name, data in present.items() if data != contents[name]}
    revisions, notes, issues = {}, [], []
    if PROJECT in present:
        data = present.pop(PROJECT)
        revisions[PROJECT] = Revision(data, data)
        notes.append(f"{folder / PROJECT}: was changed in KiCad, and is kept as it is.")
    if present and manifest is not None:
        old_path = folder / NETLIST
        if not has_hash(old_path, manifest.files.get(NETLIST)):
            message = f"was edited, and {NETLIST}, which states its circuit, is missing or was changed; {_REMEDY}"
            raise OutputError([Issue(str(folder / name), message) for name in present])
        old, new = _read_circuit(old_path), read_netlist(contents[NETLIST])
        if found := list(describe_structure_changes(old, new)):
            message = f"was edited, and this design changes more than values ({'; '.join(found)}); {_REMEDY}"
            raise OutputError([Issue(str(folder / name), message) for name in present])
        for name, data in present.items():
            is_layout = name == LAYOUT
            try:
                after, changed, problems = enter_values(data, "footprint" if is_layout else "symbol", old, new)
                if is_layout and changed:
                    old_values = {reference: part.fields["Value"] for reference, part in old.parts.items()}
                    after, is_complete = enter_texts(after, make_layout(old_values), contents[name])
            except ValueError as error:  # a UnicodeDecodeError is one too
                issues.append(Issue(str(folder / name), f"was edited and cannot be read ({error}); {_REMEDY}"))
                continue
            issues += [Issue(str(folder / name), problem) for problem in problems]
            revisions[name] = Revision(data, after)
            what = f"the values of {_join(changed)} are updated" if changed else "it has the values of this design"
            notes.append(f"{folder / name}: was edited; {what}, and nothing else changes.")
            if is_layout and changed and not is_complete:
                notes[-1] += " This design prints more or fewer lines of values than it shows: compare them."
    if issues:
        raise OutputError(issues)
    return EditedFiles(revisions, tuple(notes))


def _read_circuit(path: Path) -> CircuitRecord:
    try:
        return read_netlist(read_input(path, PARSED_LIMIT, below=path.parent))
    except (ValueError, StopIteration):
        raise OutputError(Issue(str(path), f"states no circuit; {_REMEDY}")) from None


def read_netlist(data: bytes) -> CircuitRecord:
    """Read parts and nets of a netlist that this program wrote."""
    root = read_expression(data.decode())
    parts, nets = {}, {}
    for component in next(root.children("components")).children("comp"):
        fields = {"Value": component.word("value")}
        for entry in next(component.children("fields")).children("field"):
            # A field without text is a name alone.
            fields[entry.word("name")] = entry.words[1] if len(entry.words) > 1 else ""
        symbol = next(component.children("libsource"))
        kind = component.word("footprint"), f"{symbol.word('lib')}:{symbol.word('part')}"
        parts[component.word("ref")] = Part(component.word("tstamps"), kind, fields)
    for net in next(root.children("nets")).children("net"):
        nets[net.word("name")] = frozenset((node.word("ref"), node.word("pin")) for node in net.children("node"))
    return CircuitRecord(parts, nets)


def describe_structure_changes(old: CircuitRecord, new: CircuitRecord) -> Iterator[str]:
    """Describe the differences of two circuits in parts, footprints and nets."""
    if added := sorted(new.parts.keys() - old.parts.keys()):
        yield f"it adds {_join(added)}"
    if removed := sorted(old.parts.keys() - new.parts.keys()):
        yield f"it removes {_join(removed)}"
    both = old.parts.keys() & new.parts.keys()
    if others := sorted(name for name in both if old.parts[name].kind != new.parts[name].kind):
        yield f"it changes the symbol or the footprint of {_join(others)}"
    if nets := sorted(n for n in old.nets.keys() | new.nets.keys() if old.nets.get(n) != new.nets.get(n)):
        yield f"it changes the nets {_join(nets)}"


def enter_values(data: bytes, kind: str, old: CircuitRecord, new: CircuitRecord) -> tuple[bytes, list[str], list[str]]:
    """Enter the fields that differ between two circuits of the same structure into a layout or a schematic."""
    text = data.decode()
    root = read_expression(text)
    by_identifier = {part.identifier: name for name, part in old.parts.items()}
    # Further units of a symbol have identifiers of their own, but the reference of the first.
    items = list(root.children(kind))
    known = [item for item in items if _identifier(item) in by_identifier]
    references = {by_identifier[_identifier(item)]: _reference(item) for item in known}
    changes: dict[Word, str] = {}
    changed, problems = [], []
    for name, part in new.parts.items():
        before = old.parts[name].fields
        wanted = {field: value for field, value in part.fields.items() if value != before.get(field, "")}
        if not wanted:
            continue
        if name not in references:
            problems.append(f"lacks {name}, whose {_join(sorted(wanted))} this design changes; {_REMEDY}")
            continue
        changed.append(references[name])
        words = [
            (field, words[2])
            for item in items
            if _reference(item) == references[name]
            for field, words in _properties(item)
            if field in wanted
        ]
        for field, word in words:
            if word.text not in (before.get(field, ""), wanted[field]):
                problems.append(
                    f"{references[name]} has {field} {word.text!r} by hand, and this design changes it from "
                    f"{before.get(field, '')!r} to {wanted[field]!r}; enter either in KiCad, or {_REMEDY}"
                )
            elif word.text != wanted[field]:
                changes[word] = wanted[field]
    return replace_words(text, changes).encode(), changed, problems


def enter_texts(data: bytes, old_layout: bytes, new_layout: bytes) -> tuple[bytes, bool]:
    """Enter printed texts that differ between two layouts, such as values, into an edited one."""
    text = data.decode()
    old, new = (_printed_texts(read_expression(layout.decode())) for layout in (old_layout, new_layout))
    changes = {
        word: new[identifier].text
        for identifier, word in _printed_texts(read_expression(text)).items()
        if identifier in old and identifier in new and word.text == old[identifier].text != new[identifier].text
    }
    return replace_words(text, changes).encode(), old.keys() == new.keys()


def _printed_texts(root: Node) -> dict[str, Word]:
    """Texts of a layout apart from those of its footprints, by UUID."""
    found = {}
    for item in root.children("gr_text"):
        words = [word for word in item.items if isinstance(word, Word)]
        if len(words) > 1:
            found[item.word("uuid")] = words[1]
    return found


def _identifier(item: Node) -> str:
    return item.word("path").rpartition("/")[2] if item.head == "footprint" else item.word("uuid")


def _reference(item: Node) -> str:
    return next((words[2].text for field, words in _properties(item) if field == "Reference"), "")


def _properties(item: Node) -> Iterator[tuple[str, list[Word]]]:
    for entry in item.children("property"):
        words = [word for word in entry.items if isinstance(word, Word)]
        if len(words) > 2:
            yield words[1].text, words


def _join(names: list[str]) -> str:
    """Join names for a sentence; of many, the first."""
    if len(names) > _MAX_NAMES:
        return f"{', '.join(names[:_MAX_NAMES])} and {len(names) - _MAX_NAMES} more"
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
