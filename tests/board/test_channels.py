"""The board of several fingers: KiCad's checks, its channels against
the board of one, crosstalk, and the bring-up.
"""

from __future__ import annotations

import functools
import itertools
import json
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.analysis import interference
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.interference import compute_supply_current_a
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.channels import PLACES, list_sockets, name_part, split_name, split_net
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.fabrication.bom import list_bom, purchased_components
from fingertip.board.kicad.project import load_project
from fingertip.board.parts.circuit import HOST_CONNECTOR as HOST
from fingertip.board.parts.circuit import SENSOR_CONNECTOR
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE, GND, POWER_IN
from fingertip.catalogues.electronics import NAMES
from fingertip.catalogues.output_files import CHANNEL_SHEET, DECK, LAYOUT, SCHEMATIC
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.firmware.fingers import plan_fingers
from fingertip.foundation.errors import FingertipError
from fingertip.tasks.board_files import board_files, write_board
from tests.board.ngspice import run_ngspice
from tests.conftest import run_fingertip

ALL = ("board.channels=5",)


@functools.cache
def load(channels: int) -> Design:
    return Design.load("fsr400", changes=[f"board.channels={channels}"])


def test_each_channel_is_the_board_of_one_finger() -> None:
    values = board_values(load(PLACES))
    single = board_circuit(values)
    whole = board_circuit(values, PLACES)
    connectors = (SENSOR_CONNECTOR, HOST)
    for channel in range(1, PLACES + 1):
        named = [(part, *split_name(part.reference)) for part in whole.components]
        parts = {
            replace(part, reference=own) for part, number, own in named if number in (0, channel)
        }
        assert [
            part
            for part in single.components
            if part.reference not in connectors and part not in parts
        ] == []
        assert len(parts) == len(single.components)
        nets = [
            (*split_name(name), pin, split_net(net)[1])
            for (name, pin), net in whole.net_by_pin.items()
        ]
        by_pin = {(own, pin): net for number, own, pin, net in nets if number in (0, channel)}
        for (name, pin), net in single.net_by_pin.items():
            assert name in connectors or by_pin[name, pin] == net
        pins = [net for _, net in sorted_pins(whole) if split_net(net)[0] == channel]
        assert pins == [f"F{channel}/{ADC_TACTILE}", f"F{channel}/{ADC_FILTERED}"]
    for part in whole.components:
        channel, name = split_name(part.reference)
        assert part.reference == (name_part(name, channel) if channel else name)


def sorted_pins(circuit: Any) -> list[tuple[int, str]]:
    pins = (
        (int(pin), net)
        for (part, pin), net in circuit.net_by_pin.items()
        if part == HOST and pin.isdigit()
    )
    return sorted(pins)


def test_ground_separates_the_fingers_at_the_connector() -> None:
    nets = [net for _, net in sorted_pins(board_circuit(board_values(load(PLACES)), PLACES))]
    assert nets[2::3] == [*[GND] * (PLACES - 1), POWER_IN]
    assert all(f"F{k + 1}/" in net for k in range(PLACES) for net in nets[3 * k : 3 * k + 2])


def test_a_plug_connects_its_sensor_in_the_socket_of_its_finger_alone() -> None:
    circuit = board_circuit(board_values(load(PLACES)), PLACES)
    sockets = [circuit.component(name) for name in list_sockets()]
    assert sorted(Counter(socket.footprint for socket in sockets).values()) == [1, 1, 3]
    for own, other in itertools.permutations(sockets, 2):
        if own.footprint == other.footprint:
            plug, wired = (dict(circuit.list_wires(socket)) for socket in (own, other))
            assert len(plug.keys() & wired.keys()) < 2, (own.reference, other.reference)


def test_board_of_five_fingers_keeps_its_limits() -> None:
    values = board_values(load(PLACES))
    placement = load_project("precision", PLACES).placement
    circuit = board_circuit(values, PLACES)
    lines = list_bom(circuit)
    assert placement.width <= 60.0
    assert placement.height <= 46.5
    assert placement.fiducials == 3
    assert values.shared
    assert values.shared.supply_current_a <= 15e-3
    assert values.shared.crosstalk_db <= -60.0
    assert len(lines) <= 30
    assert all(line.selection.part and line.selection.part.number for line in lines)


@pytest.mark.parametrize("channels", [2, pytest.param(4, marks=pytest.mark.full)])
def test_empty_places_are_neither_bought_nor_counted(channels: int) -> None:
    values = board_values(load(channels))
    circuit = board_circuit(values, channels)
    bought = [split_name(part.reference) for part in purchased_components(circuit)]
    assert {channel for channel, _ in bought} == {*range(channels + 1)}
    files = board_files(load(channels))
    assert files[SCHEMATIC].count(b"(dnp yes)") == 2 * (PLACES - channels)  # a sheet and its socket
    touching = re.findall(r"^C\d\d f(\d)_\S+ f(\d)_", files[DECK].decode(), re.MULTILINE)
    assert touching == [(str(k), str(k + 1)) for k in range(1, channels) for _ in range(5)], (
        "wires side by side"
    )
    empty = [part for part in circuit.components if not part.is_fitted]
    assert files[LAYOUT].count(b" dnp)") == len(empty)
    single = board_circuit(values)
    per_finger = compute_supply_current_a(single, 3.3)
    assert values.shared
    shared_a = (channels * per_finger - values.shared.supply_current_a) / (channels - 1)
    assert 0.0 < shared_a < 0.1e-3, "what is there once counts once"


@pytest.mark.parametrize(
    ("wire_f", "least_db", "most_db"),
    [(interference.WIRE_F_PER_M, -69.0, -68.0), (1e-18, -110.0, -95.0)],
)
def test_crosstalk_is_that_of_ngspice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, wire_f: float, least_db: float, most_db: float
) -> None:
    """With wires that touch, and with supply, ground and references alone."""
    monkeypatch.setattr(interference, "WIRE_F_PER_M", wire_f)
    circuit = board_circuit(board_values(load(PLACES)), PLACES)
    board = load(PLACES).board
    bandwidth_hz = find_gain_bandwidth_hz(board)
    deck = spice_deck(interference.connect_cables(circuit, board), bandwidth_hz, 3.3).decode()
    pins = " ".join(f"vm(f{k}_adc_filtered,host_ground)" for k in range(1, PLACES + 1))
    found_db, hz = interference.find_crosstalk(circuit, board, bandwidth_hz)
    (row,) = run_ngspice(tmp_path, deck, f"ac lin 1 {hz} {hz}\nwrdata out {pins}")
    levels = np.array(row[1:])
    # The deck has one force on the sensors, between those that are searched.
    assert 20.0 * np.log10((levels[1:] / levels[0]).max()) == pytest.approx(found_db, abs=1.0)
    assert least_db < found_db < most_db


def test_long_cables_warn_with_a_length_that_does_not() -> None:
    def warn(*changes: str) -> str:
        design = Design.load("fsr400", changes=["board.channels=5", *changes])
        values = board_values(design)
        assert values.shared
        return interference.crosstalk_warning(values.shared, design.board)

    assert not warn()
    warning = warn("board.cable_m=5")
    found = re.search(r"with -49 dB, above -60 dB; give board.cable_m of ([\d.]+) or less", warning)
    assert found, warning
    assert not warn(f"board.cable_m={found[1]}")
    assert warn(f"board.cable_m={float(found[1]) + 0.03}")


@pytest.mark.full
def test_edited_sheet_of_a_channel_keeps_its_edits(tmp_path: Path) -> None:
    write_board(load(2), tmp_path)
    sheet = tmp_path / CHANNEL_SHEET
    moved = sheet.read_text("utf-8").replace(
        '"Reference" "R101" (at ', '"Reference" "R101" (at 1', 1
    )
    sheet.write_text(moved, encoding="utf-8")
    notes: list[str] = []
    changed = Design.load("fsr400", changes=["board.channels=2", "board.cutoff_hz=80"])
    write_board(changed, tmp_path, progress=notes.append)
    now = sheet.read_text("utf-8")
    assert '"Reference" "R101" (at 1' in now
    assert now != moved
    assert any("the values of R101, R102 and R103 are updated" in note for note in notes)
    wanted = board_circuit(board_values(changed), 2).component("R201").value
    assert f'"Value" "{wanted}"' in now
    assert (tmp_path / LAYOUT).read_bytes() == board_files(changed)[LAYOUT]


def test_commands_say_how_many_fingers_and_firmware_takes_them_from_the_board(
    tmp_path: Path,
) -> None:
    assert plan_fingers(load(3)).names == NAMES[:3]
    with pytest.raises(
        FingertipError,
        match=r"5 are more than the 3 .*give fingers=3, or changes=\{.board.channels.: 5\}",
    ):
        plan_fingers(load(3), "5")
    said = run_fingertip(
        "board", "params/fsr400.toml", "--set", *ALL, "--out", str(tmp_path / "b")
    ).stdout
    assert "5 fingers: 11.0 mA at rest, crosstalk at most -69 dB (at 201 Hz)" in said
    run_fingertip("firmware", "params/fsr400.toml", "--set", *ALL, "--out", str(tmp_path / "f"))
    text = (tmp_path / "f/README.md").read_text("utf-8")
    assert (
        "| 14 | S5 | analog in: S of little | analog input PB1: the detector reads it |"
        in " ".join(text.split())
    )


def test_other_variants_are_refused() -> None:
    with pytest.raises(FingertipError, match=r"board.channels: 2 fingers are more than one"):
        Design.load("article", changes=["board.channels=2"])
    assert json.loads(board_files(load(PLACES))["values.json"])["amplifier"] == "TLV2372"
