"""The board: KiCad's design rules, parity with the schematic, and the tracks without KiCad."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values, write_board
from fingertip.board.circuit import Circuit
from fingertip.board.kicad.footprints import DOT_MM, FOOTPRINTS, ROUND_RATIO
from fingertip.board.kicad.project import CLEARANCE_MM, TRACK_MM, VIA_MM
from fingertip.board.layout.file import EDGE_CLEARANCE_MM
from fingertip.board.layout.names import obscured
from fingertip.board.layout.placement import PlacedPad, Placement, Spot, crowded, placed_pads, turned
from fingertip.board.layout.placements import load_placement
from fingertip.board.layout.routing.grid import Rules
from fingertip.board.layout.routing.paths import cut
from fingertip.board.layout.routing.router import route
from fingertip.board.layout.tracks import load_template
from fingertip.board.output import LAYOUT
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from fingertip.errors import BoardError
from tests.board.conftest import BOARDS, Written
from tests.board.expressions import children, parse
from tests.board.kicad import HOW, kicad_cli
from tests.tools import require_tool

CIRCUIT = board_circuit(board_values(Design()))
ARTICLE_PLACEMENT = load_placement("article_split")


def made(name: str) -> tuple[Circuit, Placement]:
    """A variant's circuit and placement."""
    return board_circuit(board_values(Design.load(changes=VARIANTS[name].changes))), VARIANTS[name].placement


RULES = Rules(TRACK_MM, CLEARANCE_MM, VIA_MM, EDGE_CLEARANCE_MM)


def findings(folder: Path) -> dict[str, list[str]]:
    """What KiCad's check of the board finds: violations, unconnected items, differences from the schematic."""
    run = kicad_cli(
        folder, "pcb", "drc", LAYOUT, "--schematic-parity", "--severity-all", "--exit-code-violations",
        "--all-track-errors", "--format", "json", "-o", "drc.json",
    )  # fmt: skip
    report = json.loads((folder / "drc.json").read_text("utf-8"))
    found = {key: [v["type"] for v in report[key]] for key in ("violations", "unconnected_items", "schematic_parity")}
    assert (run.returncode == 0) == (not any(found.values()))
    return found


NOTHING: dict[str, list[str]] = {"violations": [], "unconnected_items": [], "schematic_parity": []}


@pytest.mark.parametrize("changes", BOARDS.values(), ids=BOARDS)
def test_design_rules_are_kept_and_the_schematic_is_matched(written: Written, changes: tuple[str, ...]) -> None:
    assert findings(written(*changes)) == NOTHING


SPOILED = {
    "reference": ('(property "Reference" "R4"', '(property "Reference" "R44"', "schematic_parity"),
    "pin": (r'\(pad "2" smd(.*?)\(pintype "passive"\)', r'(pad "7" smd\1(pintype "passive")', "schematic_parity"),
    "value": ('(property "Value" "4.7k"', '(property "Value" "47k"', "schematic_parity"),
    "footprint": ('(footprint "Diode_SMD:D_SOD-123"', '(footprint "Diode_SMD:D_SOD-323"', "schematic_parity"),
    "width": (r"\(width 0.2\)", "(width 0.6)", "violations"),
    "layer": (r'\(layer "B.Cu"\)', '(layer "F.Cu")', "violations"),
    "no tracks": (r'\n  \(segment.*?\(uuid "[^"]*"\)\)', "", "unconnected_items"),
}


@pytest.mark.parametrize(("right", "wrong", "key"), SPOILED.values(), ids=SPOILED)
def test_a_spoiled_board_is_noticed(tmp_path: Path, right: str, wrong: str, key: str) -> None:
    write_board(Design(), tmp_path / "pcb")
    path = tmp_path / "pcb" / LAYOUT
    pattern = right if "\\" in right else re.escape(right)
    maximum = 1 if right.startswith(r"\(pad") else 0
    text, count = re.subn(pattern, wrong, path.read_text("utf-8"), count=maximum, flags=re.DOTALL)
    assert count
    path.write_text(text, encoding="utf-8")
    assert findings(tmp_path / "pcb")[key]


@pytest.mark.parametrize("name", VARIANTS)
def test_size_and_holes(name: str) -> None:
    circuit, placement = made(name)
    assert (placement.width, placement.height) == (40.0, 25.0)
    assert sum(part.reference[0] == "H" for part in circuit.parts) == 4
    assert list(crowded(circuit, placement)) == []


def test_crowded_parts_are_noticed() -> None:
    spots = ARTICLE_PLACEMENT.spots
    close = replace(ARTICLE_PLACEMENT, spots={**spots, "R1": Spot(spots["R4"].x, spots["R4"].y + 1.0)})
    assert ("R4", "R1") in list(crowded(CIRCUIT, close)) or ("R1", "R4") in list(crowded(CIRCUIT, close))
    outside = replace(ARTICLE_PLACEMENT, spots={**spots, "R1": Spot(39.5, 12.0)})
    assert ("R1", "edge") in list(crowded(CIRCUIT, outside))


def islands(pads: list[PlacedPad], tracks: object) -> int:
    """Groups of one net's pads that its tracks leave apart, with vias joining the layers."""
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


@pytest.mark.parametrize("name", VARIANTS)
def test_tracks_join_every_net(name: str) -> None:
    """Said again without KiCad; ground is joined by the pour, so there every pad has a via of its own."""
    circuit, placement = made(name)
    template = load_template(name, circuit, placement)
    pads = list(placed_pads(circuit, placement))
    for net in circuit.nets:
        mine = [p for p in pads if p.net == net.name]
        if net.name != "GND":
            assert islands(mine, template.tracks[net.name]) == 1, net.name
    front = [p for p in pads if p.net == "GND" and not p.pad.drill]
    assert len(template.tracks["GND"].vias) == len(front)
    assert set(template.fills) == {"F.Cu", "B.Cu"}
    assert len(template.fills["B.Cu"]) == 1  # one piece behind


def test_a_missing_track_is_noticed() -> None:
    tracks = load_template("article_split", CIRCUIT, ARTICLE_PLACEMENT).tracks
    behind = next(net for net, found in tracks.items() if found.vias and net != "GND")
    for net, less in ((behind, {"segments": tracks[behind].segments[1:]}), (behind, {"vias": ()})):
        pads = [p for p in placed_pads(CIRCUIT, ARTICLE_PLACEMENT) if p.net == net]
        assert islands(pads, tracks[net]) == 1
        assert islands(pads, replace(tracks[net], **less)) > 1  # type: ignore[arg-type]


def test_a_template_of_another_placement_is_refused() -> None:
    moved = replace(ARTICLE_PLACEMENT, spots={**ARTICLE_PLACEMENT.spots, "R1": Spot(11.4, 16.4)})
    with pytest.raises(BoardError, match=r"another placement: run python -m fingertip\.board\.layout\.rout"):
        load_template("article_split", CIRCUIT, moved)


@pytest.mark.parametrize("name", VARIANTS)
def test_every_part_has_its_name_on_the_board_and_it_can_be_read(name: str) -> None:
    circuit, placement = made(name)
    template = load_template(name, circuit, placement)
    vias = [via for tracks in template.tracks.values() for via in tracks.vias]
    assert list(obscured(circuit, placement, vias, VIA_MM)) == []
    assert set(placement.names) == {part.reference for part in circuit.parts if part.reference[0] != "H"}


@pytest.mark.parametrize("name", VARIANTS)
def test_the_print_says_which_board_it_is(name: str) -> None:
    assert VARIANTS[name].placement.words[-1][0].split()[-2:] == name.split("_")


@pytest.mark.parametrize("name", VARIANTS)
def test_a_dot_stands_at_pin_1_of_every_amplifier_clear_of_all_pads(name: str) -> None:
    circuit, placement = made(name)
    pads = list(placed_pads(circuit, placement))
    for part in circuit.parts:
        if part.reference[0] != "U":
            continue
        dot, spot = FOOTPRINTS[part.footprint].dot, placement.spots[part.reference]
        assert dot is not None
        x, y = (a + b for a, b in zip((spot.x, spot.y), turned(spot.angle, *dot), strict=True))

        def away(pad: PlacedPad, x: float = x, y: float = y) -> float:
            beside = max(abs(pad.x - x) - pad.half_width, 0.0), max(abs(pad.y - y) - pad.half_height, 0.0)
            return math.hypot(*beside) - DOT_MM / 2

        assert min(map(away, pads)) > 0.1
        nearest = min((pad for pad in pads if pad.reference == part.reference), key=away)
        assert nearest.pad.number == "1", part.reference


def test_print_that_cannot_be_read_is_noticed() -> None:
    names, spots = ARTICLE_PLACEMENT.names, ARTICLE_PLACEMENT.spots
    dot = FOOTPRINTS[CIRCUIT.part("U1").footprint].dot
    assert dot is not None
    x, y = turned(spots["U1"].angle, *dot)
    close = replace(ARTICLE_PLACEMENT, names={**names, "C1": (spots["U1"].x + x, spots["U1"].y + y)})
    assert "C1 lies on the dot of U1" in list(obscured(CIRCUIT, close))

    def found(**moved: tuple[float, float]) -> str:
        return "; ".join(obscured(CIRCUIT, replace(ARTICLE_PLACEMENT, names={**names, **moved}), [names["R1"]], VIA_MM))

    assert "R1 lies on via 1" in found()
    assert "C1 lies on part U1" in found(C1=(spots["U1"].x, spots["U1"].y))
    assert "C1 lies on R8" in found(C1=names["R8"]) or "R8 lies on C1" in found(C1=names["R8"])
    assert "C1 lies at the edge" in found(C1=(20.0, 0.4))
    without = replace(ARTICLE_PLACEMENT, names={k: v for k, v in names.items() if k != "C1"})
    assert "C1 has no name on the board" in list(obscured(CIRCUIT, without))


@pytest.mark.parametrize("no_vias", [(), ((3.0, 0.0, 9.0, 12.0),)], ids=["free", "print"])
def test_the_router_joins_and_keeps_clear(no_vias: tuple[tuple[float, float, float, float], ...]) -> None:
    """Four parts whose nets cross on one layer: one must go behind, and not through what is printed."""
    names = {"R1": (2.0, 6.0), "R2": (10.0, 6.0), "R4": (6.0, 2.0), "R5": (6.0, 10.0)}
    pads = [p for p in placed_pads(CIRCUIT, ARTICLE_PLACEMENT) if p.reference in names and p.pad.number == "1"]
    moved = [
        replace(p, x=names[p.reference][0], y=names[p.reference][1], net="A" if p.reference in ("R1", "R2") else "B")
        for p in pads
    ]
    found = route(12.0, 12.0, moved, RULES, no_vias)
    assert set(found) == {"A", "B"}
    for net, tracks in found.items():
        assert islands([p for p in moved if p.net == net], tracks) == 1
    vias = found["A"].vias + found["B"].vias
    assert len(vias) in (0, 2)
    for left, top, right, bottom in no_vias:
        reach = VIA_MM / 2
        assert not any(left - reach < x < right + reach and top - reach < y < bottom + reach for x, y in vias)


def test_tracks_are_cut_where_others_of_their_layer_end_on_them() -> None:
    """KiCad takes an end in the middle of another track for a loose one."""
    long, stub, behind = (0, (1.0, 3.0), (3.0, 1.0)), (0, (2.0, 2.0), (2.0, 5.0)), (1, (1.4, 2.6), (9.0, 9.0))
    assert cut([long, stub, behind]) == [(0, (1.0, 3.0), (2.0, 2.0)), (0, (2.0, 2.0), (3.0, 1.0)), stub, behind]
    for name in VARIANTS:
        circuit, placement = made(name)
        for tracks in load_template(name, circuit, placement).tracks.values():
            assert cut(tracks.segments) == list(tracks.segments)


@pytest.mark.parametrize("footprint", sorted(FOOTPRINTS))
def test_pads_are_those_of_kicads_library(footprint: str) -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW)
    library, name = footprint.split(":")
    module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
    theirs = set()
    for pad in children(module, "pad"):
        x, y = (float(word) for word in next(children(pad, "at"))[1:3])
        w, h = (float(word) for word in next(children(pad, "size"))[1:3])
        drill = next((float(d[1]) for d in children(pad, "drill")), 0.0)
        ratio = next((float(r[1]) for r in children(pad, "roundrect_rratio")), 0.0)
        paste = any("Paste" in layer for layer in next(children(pad, "layers")))
        theirs.add((pad[1], pad[3], x, y, w, h, drill, ratio, paste))
    shape = FOOTPRINTS[footprint]
    ratio = ROUND_RATIO.get(footprint, 0.25)
    ours = {
        (p.number, p.shape, p.x, p.y, p.width, p.height, p.drill, ratio if p.shape == "roundrect" else 0.0,
         shape.paste and not p.drill)
        for p in shape.pads
    }  # fmt: skip
    rounded = [{tuple(round(v, 4) if isinstance(v, float) else v for v in pad) for pad in s} for s in (ours, theirs)]
    assert rounded[0] == rounded[1]


def test_turning_left_moves_a_pad_on_the_right_to_the_top() -> None:
    """y runs downwards."""
    assert turned(0, 1.0, 0.5) == (1.0, 0.5)
    assert turned(90, 1.0, 0.5) == (0.5, -1.0)
    assert turned(180, 1.0, 0.5) == (-1.0, -0.5)
    assert turned(270, 1.0, 0.5) == (-0.5, 1.0)
