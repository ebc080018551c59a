"""The stored KiCad projects: each is that of its circuit, what a design
changes is entered, and KiCad can edit them.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.netlist import REVISION, SEVERAL_REVISION, symbol_fields
from fingertip.board.kicad.project import (
    IGNORED_IN_SCHEMATIC,
    IGNORED_ON_BOARD,
    MODEL_FOLDER,
    MODEL_VARIABLE,
    SEVERAL,
    load_project,
    make_project,
    read_archive,
)
from fingertip.board.parts.circuit import Circuit
from fingertip.catalogues.output_files import LAYOUT, SCHEMATIC
from fingertip.foundation.errors import BoardError
from tests.designs import load_article
from tests.oracles.sexpressions import Expression, children, parse
from tools import boards

AMPLIFIERS = {"article": "OPA2197", "precision": "OPA2376", "comparator": "MCP6022"}
"""Amplifier of each board that is not its default."""


def load_circuit(name: str, *changes: str) -> Circuit:
    return board_circuit(board_values(load_article((*VARIANT_CHANGES[name], *changes))))


def fields_of(tree: Expression, kind: str) -> list[tuple[Expression, dict[str, str]]]:
    items = (
        (item, {field[1]: field[2] for field in children(item, "property")})
        for item in children(tree, kind)
    )
    return [
        (item, fields)
        for item, fields in items
        if fields["Reference"][:3] not in ("#PW", "#FL", "FID")
    ]


@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_values_parts_and_amplifier_are_entered_everywhere(name: str) -> None:
    default = load_circuit(name)
    circuit = load_circuit(
        name, "board.cutoff_hz=90", "board.series=E96", f"board.amplifier={AMPLIFIERS[name]}"
    )
    files = load_project(name).enter(circuit)
    changed = {c.reference for c in circuit.components if c != default.component(c.reference)}
    assert {"R1", "R2", "R3", "U1"} <= changed
    for file, kind in ((LAYOUT, "footprint"), (SCHEMATIC, "symbol")):
        tree = parse(files[file].decode())
        entered = fields_of(tree, kind)
        assert {fields["Reference"] for _, fields in entered} == {
            c.reference for c in circuit.components
        }
        for item, fields in entered:
            part = circuit.component(fields["Reference"])
            wanted = {
                "Value": part.value,
                "Description": part.symbol.description,
                **symbol_fields(part),
            }
            assert {key: fields[key] for key in wanted} == wanted
            if kind == "symbol":
                assert (
                    next(children(item, "lib_id"))[1] == f"{part.symbol.library}:{part.symbol.name}"
                )
            else:
                assert next(children(item, "descr"))[1] == part.role
    library = [symbol[1] for symbol in children(next(children(tree, "lib_symbols")), "symbol")]
    used = {f"{c.symbol.library}:{c.symbol.name}" for c in circuit.components}
    assert {symbol for symbol in library if not symbol.startswith("power:")} == used


@pytest.mark.parametrize("name", [*VARIANT_CHANGES, SEVERAL])
def test_project_states_revision_title_rules_and_models(name: str) -> None:
    """KiCad's title block holds about 107 mm: 45 characters of 2 mm behind the word Title."""
    project = make_project(name, read_archive(name))
    for text in (project.layout, *project.schematics.values()):
        (block,) = children(parse(text), "title_block")
        assert next(children(block, "rev"))[1] == (
            SEVERAL_REVISION if name == SEVERAL else REVISION
        )
        assert 10 < len(next(children(block, "title"))[1]) <= 45
    data = json.loads(project.project)
    ignored = (data["erc"]["rule_severities"], data["board"]["design_settings"]["rule_severities"])
    assert [{rule for rule, level in rules.items() if level == "ignore"} for rules in ignored] == [
        set(IGNORED_IN_SCHEMATIC),
        set(IGNORED_ON_BOARD),
    ]
    assert data["text_variables"] == {MODEL_VARIABLE: f"${{KIPRJMOD}}/{MODEL_FOLDER}"}
    assert project.clearance_mm <= project.placement.narrowest_mm


@pytest.mark.full
@pytest.mark.parametrize("name", [*VARIANT_CHANGES, SEVERAL, "models"])
def test_archive_is_packed_again_to_the_same_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    stored = read_archive(name)
    boards.unpack(name, tmp_path / "project")
    monkeypatch.setattr(boards, "PROJECTS", tmp_path)
    for _ in range(2):
        assert boards.pack(name, tmp_path / "project") == ""
        packed = (tmp_path / f"{name}.zip").read_bytes()
        assert packed == boards.make_archive(stored)
    if name != "models":
        layout = tmp_path / "project" / LAYOUT
        part = "R404" if name == SEVERAL else "R4"
        layout.write_text(
            layout.read_text("utf-8").replace(f'"Reference" "{part}"', '"Reference" "R99"'),
            encoding="utf-8",
        )
        assert f"it adds {part}; it removes R99" in boards.pack(name, tmp_path / "project")
        assert (tmp_path / f"{name}.zip").read_bytes() == packed


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_project_has_parts_and_nets_of_its_circuit(name: str) -> None:
    """Each change of a circuit is described in `test_edited_files.py`."""
    circuit = load_circuit(name)
    project = load_project(name)
    assert list(boards.find_differences(project, circuit)) == []
    assert next(boards.find_differences(project, circuit.without("R4"))) == "it removes R4"


def test_project_without_a_field_is_refused_in_words() -> None:
    circuit = load_circuit("article")
    files = read_archive("article")
    for name in (LAYOUT, SCHEMATIC):
        changed = make_project(
            "article", files | {name: files[name].replace(b'"LCSC"', b'"House"')}
        )
        with pytest.raises(BoardError, match=r"[A-Z]+\d+ has no field LCSC in its KiCad project"):
            changed.enter(circuit)
