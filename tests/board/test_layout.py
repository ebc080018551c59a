"""The layout: KiCad's design rules check, parity with the schematic, tracks, silkscreen and pads."""

from __future__ import annotations

import itertools
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.footprints import FOOTPRINTS, PIN_1_DOT_MM, pad_corner_ratio
from fingertip.board.kicad.layout import EDGE_CLEARANCE_MM
from fingertip.board.kicad.placement import (
    Label,
    PlacedPad,
    Placement,
    Position,
    Tracks,
    courtyard_overlaps,
    load_placement,
    load_template,
    place_pads,
    rotate_offset,
)
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS, CLEARANCE_MM, TRACK_MM, VIA_MM
from fingertip.board.kicad.silkscreen import silkscreen_conflicts
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.symbols import M2_HOLE, R_0603
from fingertip.catalogues.output_files import LAYOUT
from fingertip.foundation.errors import BoardError
from fingertip.tasks.board import write_board
from tests.board.conftest import BOARDS, BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse
from tests.tools import require_tool
from tools.routing.copper import list_copper, segment_gap
from tools.routing.grid import DesignRules
from tools.routing.paths import split_at_junctions
from tools.routing.reroute import fill_ground_pour
from tools.routing.router import route
from tools.routing.stitch import is_inside
from tools.routing.widen import RAILS, WIDTHS_MM, rail_share, widen_rails

CIRCUIT = board_circuit(board_values(ARTICLE))
ARTICLE_PLACEMENT = load_placement("article_split")


def load_board(name: str) -> tuple[Circuit, Placement]:
    """Circuit and placement of a board."""
    configuration = BOARD_CONFIGURATIONS[name]
    return board_circuit(board_values(load_article(configuration.changes))), configuration.placement


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


@pytest.mark.full
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
    "text height": (r"\(size 1 1\)", "(size 0.9 0.9)", "violations"),
    "text line": (r"\(thickness 0.15\)", "(thickness 0.14)", "violations"),
    "mark": (r"\(clearance 0.6\)", "(clearance 9)", "violations"),
    "no tracks": (r'\n  \(segment.*?\(uuid "[^"]*"\)\)', "", "unconnected_items"),
}


@pytest.mark.full
@pytest.mark.parametrize(("original", "corrupted", "key"), CORRUPTIONS.values(), ids=CORRUPTIONS)
def test_design_rules_check_detects_a_corrupted_board(tmp_path: Path, original: str, corrupted: str, key: str) -> None:
    write_board(ARTICLE, tmp_path / "pcb")
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
    assert (placement.width, placement.height) == (40.0, 25.0)
    assert sum(component.footprint == M2_HOLE for component in circuit.components) == 2
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
        _, a, b, _ = item  # type: ignore[misc]
        along = math.dist(a, point) + math.dist(point, b) - math.dist(a, b)
        return along < 1e-6

    def ends(item: object) -> list[tuple[float, float]]:
        if isinstance(item, PlacedPad):
            return [(item.x, item.y)]
        return [item] if len(item) == 2 else list(item[1:3])  # type: ignore[arg-type, list-item, index]

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


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_component_has_a_legible_reference_on_the_board(name: str) -> None:
    circuit, placement = load_board(name)
    template = load_template(name, circuit, placement)
    vias = [*template.stitching, *(via for tracks in template.tracks.values() for via in tracks.vias)]
    assert list(silkscreen_conflicts(circuit, placement, vias, VIA_MM)) == []


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

    def conflicts(**moved: Label) -> str:
        placement = replace(ARTICLE_PLACEMENT, reference_labels={**labels, **moved})
        return "; ".join(silkscreen_conflicts(CIRCUIT, placement, [(labels["U2"].x, labels["U2"].y)], VIA_MM))

    assert "U2 overlaps via 1" in conflicts()
    assert "D1 overlaps the pin 1 dot of U1" in conflicts(D1=Label(amplifier.x + dot_x, amplifier.y + dot_y))
    assert "D1 overlaps U1" in conflicts(D1=Label(amplifier.x, amplifier.y))
    close = conflicts(D1=labels["TP1"])
    assert "D1 overlaps or nearly touches TP1" in close or "TP1 overlaps or nearly touches D1" in close
    assert "D1 is too close to the edge" in conflicts(D1=Label(20.0, 0.4))
    resistor = ARTICLE_PLACEMENT.positions["R14"]
    assert "TP1 is not nearer to its component than to R14" in conflicts(TP1=Label(resistor.x, resistor.y - 1.0))
    without = replace(ARTICLE_PLACEMENT, reference_labels={k: v for k, v in labels.items() if k != "D1"})
    assert "D1 has no label on the board" in list(silkscreen_conflicts(CIRCUIT, without))


@pytest.mark.full
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


DECOUPLING_MM = 7.0
"""Greatest way from a decoupling capacitor to the supply pin of its amplifier, or to where the supply enters."""


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_decoupling_capacitors_are_at_the_supply_pins_and_at_the_entry(name: str) -> None:
    circuit, placement = load_board(name)
    pads = list(place_pads(circuit, placement))
    found = [(c, match[1]) for c in circuit.components if (match := re.search(r"at (U\d+|its entry)$", c.role))]
    assert len(found) >= 3
    for component, place in found:
        own = [p for p in pads if p.reference == component.reference and p.net != "GND"]
        owners = ("J2", "Q1") if place == "its entry" else (place,)
        pins = [p for p in pads if p.reference in owners and p.net == own[0].net]
        assert min(math.dist((a.x, a.y), (b.x, b.y)) for a in own for b in pins) < DECOUPLING_MM, component.reference


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_rails_are_wide_where_there_is_room_and_clear_of_other_copper(name: str) -> None:
    """Half of the rails' length is 0.5 mm wide or more. A gap is measured along each track, not at the grid's nodes."""
    circuit, placement = load_board(name)
    tracks = load_template(name, circuit, placement).tracks
    assert rail_share(tracks, 0.5) > 0.5
    assert {width for net, copper in tracks.items() if net not in RAILS for *_, width in copper.segments} == {TRACK_MM}
    copper = list(list_copper(list(place_pads(circuit, placement)), tracks, VIA_MM))
    for net in set(RAILS) & set(tracks):
        foreign = [c for c in copper if c.net != net]
        for segment in tracks[net].segments:
            room = min(segment_gap(segment, c) for c in foreign if c.layer == segment[0])
            # A diagonal of the router's grid may come nearer to a corner, which is round on the board.
            assert room - segment[3] / 2 > CLEARANCE_MM - 0.05


def test_rail_is_widened_only_where_there_is_room() -> None:
    pad = PlacedPad("R1", FOOTPRINTS[R_0603].pads[0], 5.0, 5.6, 0.4, 0.2, "A")
    rail = Tracks(((0, (1.0, 5.0), (20.0, 5.0), TRACK_MM),), ())
    wide = widen_rails({"VCC": rail, "A": rail}, [], ARTICLE_PLACEMENT, DESIGN_RULES)
    assert wide["VCC"] == wide["A"] == rail  # they lie on each other, and A is no rail
    (segment,) = widen_rails({"VCC": rail}, [], ARTICLE_PLACEMENT, DESIGN_RULES)["VCC"].segments
    assert segment[3] == WIDTHS_MM[0]
    segments = widen_rails({"VCC": rail}, [pad], ARTICLE_PLACEMENT, DESIGN_RULES)["VCC"].segments
    assert segments[0][1] == (1.0, 5.0)
    assert all(a[2] == b[1] for a, b in itertools.pairwise(segments))
    assert segments[-1][2] == (20.0, 5.0)
    narrow = min(segments, key=lambda s: s[3])
    assert narrow[1][0] < 5.0 < narrow[2][0]
    assert narrow[3] / 2 + CLEARANCE_MM <= 0.4 + 1e-9


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_stitching_vias_join_both_pours_and_touch_nothing_else(name: str) -> None:
    circuit, placement = load_board(name)
    template = load_template(name, circuit, placement)
    assert len(template.stitching) >= 10
    foreign = [c for c in list_copper(list(place_pads(circuit, placement)), template.tracks, VIA_MM) if c.net != "GND"]
    for via in template.stitching:
        assert all(any(is_inside(via, outline) for outline in outlines) for outlines in template.fills.values())
        assert min(segment_gap((c.layer, via, via, 0.0), c) for c in foreign) >= VIA_MM / 2 + CLEARANCE_MM


def area(outline: tuple[tuple[float, float], ...]) -> float:
    """Area of a polygon, by the shoelace formula."""
    edges = zip(outline, outline[1:] + outline[:1], strict=True)
    return abs(math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in edges)) / 2


@pytest.mark.full
def test_ground_pour_of_the_template_is_what_kicad_fills() -> None:
    """The vertices depend on KiCad's version, the areas do not."""
    require_tool("/usr/lib/python3/dist-packages/pcbnew.py", HOW_TO_INSTALL_KICAD)
    template = load_template("article_split", CIRCUIT, ARTICLE_PLACEMENT)
    fills = fill_ground_pour(CIRCUIT, ARTICLE_PLACEMENT, template, "/usr/bin/python3")
    assert set(fills) == set(template.fills)
    for layer, outlines in template.fills.items():
        assert [area(outline) for outline in fills[layer]] == pytest.approx([area(o) for o in outlines], rel=1e-3)


@pytest.mark.full
def test_segments_are_split_where_others_of_their_layer_end_on_them() -> None:
    """KiCad reports an end in the middle of another segment as dangling."""
    long, stub = (0, (1.0, 3.0), (3.0, 1.0), 0.5), (0, (2.0, 2.0), (2.0, 5.0), 0.2)
    back = (1, (1.4, 2.6), (9.0, 9.0), 0.2)
    first_half, second_half = (0, (1.0, 3.0), (2.0, 2.0), 0.5), (0, (2.0, 2.0), (3.0, 1.0), 0.5)
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
