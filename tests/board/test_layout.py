"""The layout: KiCad's design rules check, parity with the schematic, tracks, silkscreen and pads."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values, write_board
from fingertip.board.circuit import Circuit
from fingertip.board.kicad.footprints import FOOTPRINTS, PIN_1_DOT_MM, pad_corner_ratio
from fingertip.board.kicad.project import CLEARANCE_MM, TRACK_MM, VIA_MM
from fingertip.board.layout.pcb_file import EDGE_CLEARANCE_MM
from fingertip.board.layout.placement import (
    PlacedPad,
    Placement,
    Position,
    courtyard_overlaps,
    load_placement,
    place_pads,
    rotate_offset,
)
from fingertip.board.layout.silkscreen import silkscreen_conflicts
from fingertip.board.layout.template import load_template
from fingertip.board.output import LAYOUT
from fingertip.board.variants import BOARD_CONFIGURATIONS
from fingertip.design import Design
from fingertip.errors import BoardError
from tests.board.conftest import BOARDS, BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.oracles.sexpressions import children, parse
from tests.tools import require_tool
from tools.routing.grid import DesignRules
from tools.routing.paths import split_at_junctions
from tools.routing.reroute import fill_ground_pour
from tools.routing.router import route

CIRCUIT = board_circuit(board_values(Design()))
ARTICLE_PLACEMENT = load_placement("article_split")


def load_board(name: str) -> tuple[Circuit, Placement]:
    """Circuit and placement of a board."""
    configuration = BOARD_CONFIGURATIONS[name]
    return board_circuit(board_values(Design.load(changes=configuration.changes))), configuration.placement


DESIGN_RULES = DesignRules(TRACK_MM, CLEARANCE_MM, VIA_MM, EDGE_CLEARANCE_MM)


def run_drc(folder: Path) -> dict[str, list[str]]:
    """Violations, unconnected items and differences from the schematic that KiCad's design rules check finds."""
    run = kicad_cli(
        folder, "pcb", "drc", LAYOUT, "--schematic-parity", "--severity-all", "--exit-code-violations",
        "--all-track-errors", "--format", "json", "-o", "drc.json",
    )  # fmt: skip
    report = json.loads((folder / "drc.json").read_text("utf-8"))
    found = {key: [v["type"] for v in report[key]] for key in ("violations", "unconnected_items", "schematic_parity")}
    assert (run.returncode == 0) == (not any(found.values()))
    return found


NO_VIOLATIONS: dict[str, list[str]] = {"violations": [], "unconnected_items": [], "schematic_parity": []}


@pytest.mark.slow
@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_board_passes_design_rules_check_and_matches_the_schematic(
    board_folder: BoardFolder, changes: tuple[str, ...]
) -> None:
    assert run_drc(board_folder(*changes)) == NO_VIOLATIONS


CORRUPTIONS = {
    "reference": ('(property "Reference" "R4"', '(property "Reference" "R44"', "schematic_parity"),
    "pin": (r'\(pad "2" smd(.*?)\(pintype "passive"\)', r'(pad "7" smd\1(pintype "passive")', "schematic_parity"),
    "value": ('(property "Value" "4.7k"', '(property "Value" "47k"', "schematic_parity"),
    "footprint": ('(footprint "Diode_SMD:D_SOD-123"', '(footprint "Diode_SMD:D_SOD-323"', "schematic_parity"),
    "width": (r"\(width 0.2\)", "(width 0.6)", "violations"),
    "layer": (r'\(layer "B.Cu"\)', '(layer "F.Cu")', "violations"),
    "no tracks": (r'\n  \(segment.*?\(uuid "[^"]*"\)\)', "", "unconnected_items"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("original", "corrupted", "key"), CORRUPTIONS.values(), ids=CORRUPTIONS)
def test_design_rules_check_detects_a_corrupted_board(tmp_path: Path, original: str, corrupted: str, key: str) -> None:
    write_board(Design(), tmp_path / "pcb")
    path = tmp_path / "pcb" / LAYOUT
    pattern = original if "\\" in original else re.escape(original)
    maximum = 1 if original.startswith(r"\(pad") else 0
    text, count = re.subn(pattern, corrupted, path.read_text("utf-8"), count=maximum, flags=re.DOTALL)
    assert count
    path.write_text(text, encoding="utf-8")
    assert run_drc(tmp_path / "pcb")[key]


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_board_has_its_size_and_holes_and_no_overlapping_components(name: str) -> None:
    circuit, placement = load_board(name)
    size_mm = (52.0, 28.0) if BOARD_CONFIGURATIONS[name].supply.is_for_controller else (40.0, 25.0)
    assert (placement.width, placement.height) == size_mm
    assert sum(component.reference[0] == "H" for component in circuit.components) == 4
    assert list(courtyard_overlaps(circuit, placement)) == []


def test_overlapping_components_are_detected() -> None:
    positions = ARTICLE_PLACEMENT.positions

    def overlaps(r1: Position) -> list[tuple[str, str]]:
        return list(courtyard_overlaps(CIRCUIT, replace(ARTICLE_PLACEMENT, positions={**positions, "R1": r1})))

    close = overlaps(Position(positions["R4"].x, positions["R4"].y + 1.0))
    assert ("R4", "R1") in close or ("R1", "R4") in close
    assert ("R1", "edge") in overlaps(Position(39.5, 12.0))


def count_islands(pads: list[PlacedPad], tracks: object) -> int:
    """Number of groups of one net's pads that its tracks leave unconnected. Vias connect the layers."""
    segments, vias = tracks.segments, tracks.vias  # type: ignore[attr-defined]
    items: list[tuple[set[int], object]] = [({0, 1} if p.pad.drill else {0}, p) for p in pads]
    items += [({s[0]}, s) for s in segments] + [({0, 1}, v) for v in vias]
    parent = list(range(len(items)))

    def root(i: int) -> int:
        while parent[i] != i:
            i = parent[i]
        return i

    def touches(point: tuple[float, float], item: object) -> bool:
        if isinstance(item, PlacedPad):
            return abs(point[0] - item.x) <= item.half_width and abs(point[1] - item.y) <= item.half_height
        if len(item) == 2:  # type: ignore[arg-type]
            return math.dist(point, item) < 1e-6  # type: ignore[arg-type]
        _, a, b = item  # type: ignore[misc]
        along = math.dist(a, point) + math.dist(point, b) - math.dist(a, b)
        return along < 1e-6

    def ends(item: object) -> list[tuple[float, float]]:
        if isinstance(item, PlacedPad):
            return [(item.x, item.y)]
        return [item] if len(item) == 2 else list(item[1:])  # type: ignore[arg-type, list-item, index]

    for i, (layers, item) in enumerate(items):
        for j, (others, other) in enumerate(items[:i]):
            if layers & others and any(touches(p, other) for p in ends(item)) | any(
                touches(p, item) for p in ends(other)
            ):
                parent[root(i)] = root(j)
    return len({root(i) for i in range(len(pads))})


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_tracks_connect_all_pads_of_every_net(name: str) -> None:
    """An independent check without KiCad. The pour connects ground, so every ground pad has a via of its own."""
    circuit, placement = load_board(name)
    template = load_template(name, circuit, placement)
    pads = list(place_pads(circuit, placement))
    for net in circuit.nets:
        net_pads = [p for p in pads if p.net == net.name]
        if net.name != "GND":
            assert count_islands(net_pads, template.tracks[net.name]) == 1, net.name
    front_ground_pads = [p for p in pads if p.net == "GND" and not p.pad.drill]
    assert len(template.tracks["GND"].vias) == len(front_ground_pads)
    assert set(template.fills) == {"F.Cu", "B.Cu"}
    assert len(template.fills["B.Cu"]) == 1  # a single area on the back


def test_missing_track_or_via_is_detected() -> None:
    tracks = load_template("article_split", CIRCUIT, ARTICLE_PLACEMENT).tracks
    net = next(net for net, copper in tracks.items() if copper.vias and net != "GND")
    for change in ({"segments": tracks[net].segments[1:]}, {"vias": ()}):
        pads = [p for p in place_pads(CIRCUIT, ARTICLE_PLACEMENT) if p.net == net]
        assert count_islands(pads, tracks[net]) == 1
        assert count_islands(pads, replace(tracks[net], **change)) > 1  # type: ignore[arg-type]


def test_template_of_another_placement_is_refused() -> None:
    moved = replace(ARTICLE_PLACEMENT, positions={**ARTICLE_PLACEMENT.positions, "R1": Position(11.4, 16.4)})
    message = r"another placement or other nets; run python -m tools\.routing\.reroute article_split"
    with pytest.raises(BoardError, match=message):
        load_template("article_split", CIRCUIT, moved)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_component_has_a_legible_reference_on_the_board(name: str) -> None:
    circuit, placement = load_board(name)
    template = load_template(name, circuit, placement)
    vias = [via for tracks in template.tracks.values() for via in tracks.vias]
    assert list(silkscreen_conflicts(circuit, placement, vias, VIA_MM)) == []
    assert set(placement.reference_labels) == {
        component.reference for component in circuit.components if component.reference[0] != "H"
    }


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_silkscreen_names_the_board(name: str) -> None:
    words = name.split("_")
    assert BOARD_CONFIGURATIONS[name].placement.texts[-1][0].split()[-len(words) :] == words


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_amplifier_has_a_dot_at_pin_1_clear_of_all_pads(name: str) -> None:
    circuit, placement = load_board(name)
    pads = list(place_pads(circuit, placement))
    for component in circuit.components:
        if component.reference[0] != "U":
            continue
        dot, position = FOOTPRINTS[component.footprint].pin_1_dot, placement.positions[component.reference]
        assert dot is not None
        x, y = (a + b for a, b in zip((position.x, position.y), rotate_offset(position.angle, *dot), strict=True))

        def distance_to_dot(pad: PlacedPad, x: float = x, y: float = y) -> float:
            offset = max(abs(pad.x - x) - pad.half_width, 0.0), max(abs(pad.y - y) - pad.half_height, 0.0)
            return math.hypot(*offset) - PIN_1_DOT_MM / 2

        assert min(map(distance_to_dot, pads)) > 0.1
        nearest = min((pad for pad in pads if pad.reference == component.reference), key=distance_to_dot)
        assert nearest.pad.number == "1", component.reference


def test_illegible_silkscreen_is_detected() -> None:
    labels, amplifier = ARTICLE_PLACEMENT.reference_labels, ARTICLE_PLACEMENT.positions["U1"]
    dot = FOOTPRINTS[CIRCUIT.component("U1").footprint].pin_1_dot
    assert dot is not None
    dot_x, dot_y = rotate_offset(amplifier.angle, *dot)

    def conflicts(**moved: tuple[float, float]) -> str:
        placement = replace(ARTICLE_PLACEMENT, reference_labels={**labels, **moved})
        return "; ".join(silkscreen_conflicts(CIRCUIT, placement, [labels["R1"]], VIA_MM))

    assert "R1 overlaps via 1" in conflicts()
    assert "C1 overlaps the pin 1 dot of U1" in conflicts(C1=(amplifier.x + dot_x, amplifier.y + dot_y))
    assert "C1 overlaps component U1" in conflicts(C1=(amplifier.x, amplifier.y))
    close = conflicts(C1=labels["R8"])
    assert "C1 overlaps or nearly touches R8" in close or "R8 overlaps or nearly touches C1" in close
    assert "C1 is too close to the edge" in conflicts(C1=(20.0, 0.4))
    without = replace(ARTICLE_PLACEMENT, reference_labels={k: v for k, v in labels.items() if k != "C1"})
    assert "C1 has no label on the board" in list(silkscreen_conflicts(CIRCUIT, without))


@pytest.mark.parametrize("no_vias", [(), ((3.0, 0.0, 9.0, 12.0),)], ids=["vias anywhere", "no vias in a box"])
def test_router_connects_crossing_nets_without_vias_in_blocked_boxes(
    no_vias: tuple[tuple[float, float, float, float], ...],
) -> None:
    """The nets of four components cross on one layer, so one must change to the back, outside the boxes."""
    positions = {"R1": (2.0, 6.0), "R2": (10.0, 6.0), "R4": (6.0, 2.0), "R5": (6.0, 10.0)}
    nets = {"R1": "A", "R2": "A", "R4": "B", "R5": "B"}
    moved = [
        replace(p, x=positions[p.reference][0], y=positions[p.reference][1], net=nets[p.reference])
        for p in place_pads(CIRCUIT, ARTICLE_PLACEMENT)
        if p.reference in positions and p.pad.number == "1"
    ]
    routed = route(12.0, 12.0, moved, DESIGN_RULES, no_vias)
    assert set(routed) == {"A", "B"}
    for net, tracks in routed.items():
        assert count_islands([p for p in moved if p.net == net], tracks) == 1
    vias = routed["A"].vias + routed["B"].vias
    assert len(vias) in (0, 2)
    for left, top, right, bottom in no_vias:
        radius = VIA_MM / 2
        assert not any(left - radius < x < right + radius and top - radius < y < bottom + radius for x, y in vias)


def area(outline: tuple[tuple[float, float], ...]) -> float:
    """Area of a polygon, by the shoelace formula."""
    edges = zip(outline, outline[1:] + outline[:1], strict=True)
    return abs(math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in edges)) / 2


@pytest.mark.slow
def test_ground_pour_of_the_template_is_what_kicad_fills() -> None:
    """The vertices depend on KiCad's version, the areas do not."""
    require_tool("/usr/lib/python3/dist-packages/pcbnew.py", HOW_TO_INSTALL_KICAD)
    template = load_template("article_split", CIRCUIT, ARTICLE_PLACEMENT)
    fills = fill_ground_pour(CIRCUIT, ARTICLE_PLACEMENT, template.tracks, "/usr/bin/python3")
    assert set(fills) == set(template.fills)
    for layer, outlines in template.fills.items():
        assert [area(outline) for outline in fills[layer]] == pytest.approx([area(o) for o in outlines], rel=1e-3)


def test_segments_are_split_where_others_of_their_layer_end_on_them() -> None:
    """KiCad reports an end in the middle of another segment as dangling."""
    long, stub, back = (0, (1.0, 3.0), (3.0, 1.0)), (0, (2.0, 2.0), (2.0, 5.0)), (1, (1.4, 2.6), (9.0, 9.0))
    first_half, second_half = (0, (1.0, 3.0), (2.0, 2.0)), (0, (2.0, 2.0), (3.0, 1.0))
    assert split_at_junctions([long, stub, back]) == [first_half, second_half, stub, back]
    for name in BOARD_CONFIGURATIONS:
        circuit, placement = load_board(name)
        for tracks in load_template(name, circuit, placement).tracks.values():
            assert split_at_junctions(tracks.segments) == list(tracks.segments)


@pytest.mark.parametrize("footprint", sorted(FOOTPRINTS))
def test_pads_equal_those_of_kicads_library(footprint: str) -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    library, name = footprint.split(":")
    module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
    kicad_pads = set()
    for pad in children(module, "pad"):
        x, y = (float(word) for word in next(children(pad, "at"))[1:3])
        w, h = (float(word) for word in next(children(pad, "size"))[1:3])
        drill = next((float(d[1]) for d in children(pad, "drill")), 0.0)
        ratio = next((float(r[1]) for r in children(pad, "roundrect_rratio")), 0.0)
        paste = any("Paste" in layer for layer in next(children(pad, "layers")))
        kicad_pads.add((pad[1], pad[3], x, y, w, h, drill, ratio, paste))
    own = FOOTPRINTS[footprint]
    own_pads = {
        (p.number, p.shape, p.x, p.y, p.width, p.height, p.drill,
         pad_corner_ratio(footprint, p) if p.shape == "roundrect" else 0.0, own.has_paste and not p.drill)
        for p in own.pads
    }  # fmt: skip
    rounded = [
        {tuple(round(v, 4) if isinstance(v, float) else v for v in pad) for pad in s} for s in (own_pads, kicad_pads)
    ]
    assert rounded[0] == rounded[1]


def test_anticlockwise_rotation_moves_a_pad_on_the_right_to_the_top() -> None:
    """The y axis points down."""
    assert rotate_offset(0, 1.0, 0.5) == (1.0, 0.5)
    assert rotate_offset(90, 1.0, 0.5) == (0.5, -1.0)
    assert rotate_offset(180, 1.0, 0.5) == (-1.0, -0.5)
    assert rotate_offset(270, 1.0, 0.5) == (-0.5, 1.0)
