"""Bring-up of a board: readings against ngspice, limits against
random boards and faults, sheet, and its sketch.
"""

from __future__ import annotations

import functools
import math
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.bringup import stimulus
from fingertip.board.bringup.expected_readings import (
    PROBES,
    BoardUnderTest,
    BringUp,
    Limits,
    plan_bring_up,
)
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.project import load_project
from fingertip.board.parts.circuit import Circuit, parse_component_value
from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE, FILTERED, GND, STAGE1_OUT, TACTILE
from fingertip.design import Design
from fingertip.documents.board.bringup import list_unseen
from fingertip.tasks.board_files import bring_up_files
from tests.board.ngspice import run_ngspice
from tests.conftest import run_fingertip
from tests.designs import load_article
from tests.tools import require_tool

EACH = pytest.mark.parametrize("name", VARIANT_CHANGES)


@functools.cache
def plan_of(name: str) -> tuple[Design, BringUp]:
    design = load_article(VARIANT_CHANGES[name])
    values = board_values(design)
    return design, plan_bring_up(BoardUnderTest.of_design(design, board_circuit(values)), values)


def measure(board: BoardUnderTest, circuit: Circuit, net: str, samples: int) -> float:
    """Tone at a net of a circuit, with its parts as they are [V]."""
    path = stimulus.feed_tone(circuit, board.stimulus, board.gain_bandwidth_hz).restrict(net)
    level = stimulus.tone_level if board.is_sampled else stimulus.square_wave_level
    return stimulus.TONE_V * float(level(path, stimulus.SAMPLE_HZ / samples, net)[0])


def rest(board: BoardUnderTest, circuit: Circuit, net: str, ohm: float | None) -> float:
    """Constant voltage of a net above ground [V]."""
    return (
        build_network(circuit, sensor_s=1.0 / ohm if ohm else 0.0)
        .restrict(net)
        .operating_point(board.rails_v)[net]
    )


def allows(limits: Limits, reading: float) -> bool:
    return limits.low <= reading <= limits.high


@pytest.mark.full
@EACH
def test_expected_readings_are_those_of_ngspice(tmp_path: Path, name: str) -> None:
    design, plan = plan_of(name)
    board = plan.board
    deck = spice_deck(board.circuit, board.gain_bandwidth_hz, design.board.supply_v).decode()
    sensor = next(line for line in deck.splitlines() if line.startswith("RJ1 "))
    ground = "0" if board.signal_ground == GND else board.signal_ground.lower()

    def constant(net: str, ohm: float, reference: str) -> float:
        changed = deck.replace(sensor, f"RJ1 sensor 0 {ohm:g}")
        volts = f"v({net.lower()})" + (
            "" if reference in ("0", net.lower()) else f"-v({reference})"
        )
        return run_ngspice(tmp_path, changed, f"op\nlet found = {volts}\nwrdata out found")[0][1]

    light = board.stimulus.dummy_ohm[0]
    found = [(constant(net, 1e12, ground), limits) for net, limits in plan.open_v.items()]
    found += [(constant(TACTILE, ohm, ground), limits) for ohm, limits in plan.dummy_v.items()]
    found += [(constant(net, light, "0"), limits) for net, limits in plan.pins_v.items()]
    toned = (
        deck.replace(sensor, f"RJ1 sensor 0 {light:g}")
        .replace("dc 0 ac 1u", "dc 0 ac 0")
        .replace(
            "\n.ac ",
            f"\nVT tone 0 dc 0 ac {stimulus.TONE_V:.9g}\nCT tone tm {stimulus.COUPLING_FARAD:g}\n"
            f"RT tm sensor {board.stimulus.coupling_ohm:g}\n.ac ",
        )
    )
    for tone in plan.tones:
        squares = 0.0
        for k in (1,) if board.is_sampled else stimulus.HARMONICS:
            command = (
                f"ac lin 1 {k * tone.hz:.9g} {k * tone.hz:.9g}\nlet m = "
                f"abs(v({tone.net.lower()}))\nwrdata out m"
            )
            squares += (run_ngspice(tmp_path, toned, command)[0][1] / k) ** 2
        found.append((math.sqrt(squares), tone.limits))
    for volts, limits in found:
        assert volts == pytest.approx(limits.expected, rel=0.01, abs=2e-3)
        assert allows(limits, volts)


@EACH
def test_good_boards_pass(name: str) -> None:
    """Boards of components within their tolerances read within the limits."""
    plan = plan_of(name)[1]
    board = plan.board
    for seed in range(12):
        random = np.random.default_rng(seed)
        circuit = board.circuit
        for part in circuit.components:
            if part.requirement:
                ratio = part.requirement.tolerance_percent / 100 * random.uniform(-1, 1)
                circuit = circuit.replace(
                    part.reference, f"{parse_component_value(part.value) * (1 + ratio):.10g}"
                )
        for tone in plan.tones:
            assert allows(tone.limits, measure(board, circuit, tone.net, tone.samples)), (
                seed,
                tone,
            )
        for net, limits in plan.pins_v.items():
            assert allows(limits, rest(board, circuit, net, board.stimulus.dummy_ohm[0])), (
                seed,
                net,
            )


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("R27", "1e10"),
        ("C1", "47n"),
        ("C2", "47n"),
        ("R5", "47k"),
        ("R4", "1e10"),
        ("R2", "1e-2"),
        ("R3", "100k"),
    ],
)
def test_faults_show_in_a_tone(part: str, value: str) -> None:
    """Parts that are open, bridged, or of another value."""
    plan = plan_of("precision")[1]
    circuit = plan.board.circuit.replace(part, value)
    assert not all(
        allows(t.limits, measure(plan.board, circuit, t.net, t.samples)) for t in plan.tones
    )
    assert all(
        allows(t.limits, measure(plan.board, plan.board.circuit, t.net, t.samples))
        for t in plan.tones
    )


@EACH
def test_capacitors_that_no_tone_shows_when_open_are_those_to_look_at(name: str) -> None:
    plan = plan_of(name)[1]
    board = plan.board
    for reference in (
        part.reference for part in board.circuit.components if part.symbol.name == "C"
    ):
        circuit = board.circuit.replace(reference, "1e-16")
        is_hidden = all(
            allows(t.limits, measure(board, circuit, t.net, t.samples)) for t in plan.tones
        )
        assert is_hidden == (reference in list_unseen(plan)), reference


def test_limits_of_a_constant_voltage_hold_the_supply_of_a_meter_and_not_of_a_converter() -> None:
    plan = plan_of("precision")[1]
    lower = replace(
        plan.board, rails_v={name: 0.97 * volts for name, volts in plan.board.rails_v.items()}
    )
    half_v = rest(lower, lower.circuit, "VMID", None)
    assert not allows(plan.open_v["VMID"], half_v - 0.02)
    assert allows(plan.open_v["VMID"], half_v / 0.97 * 0.985)
    assert not allows(plan.pins_v[ADC_FILTERED], half_v)
    assert plan.pins_v.keys() == {ADC_TACTILE, ADC_FILTERED}


def test_limits_hold_the_offset_that_a_data_sheet_allows() -> None:
    """A TL082 has 3 mV at most, a meter 3 mV and 0.5 % of them: the
    first stage has a gain of 203 / 3, the second 1.
    """
    for net, gain in ((STAGE1_OUT, 1 + 1e5 / 1500), (FILTERED, 1.0)):
        limits = plan_of("article")[1].open_v[net]
        most_v = 1.005 * gain * 3e-3 + 3e-3
        assert (-limits.low, limits.high) == pytest.approx((most_v, most_v), rel=0.01)


@EACH
def test_each_net_is_measured_where_the_sheet_says(name: str) -> None:
    """The side of a part that the sheet names has the pad of the net in the layout."""
    design, plan = plan_of(name)
    circuit = plan.board.circuit
    for net in plan.board.nets:
        assert circuit.net_by_pin[PROBES[net]["point"], "1"] == net
    assert plan.board.signal_ground == circuit.net_by_pin["TP5", "1"]
    if "J2" in {part.reference for part in circuit.components}:
        assert circuit.net_by_pin["J2", "2"] == GND, "the sheet names this pin for the black probe"
    # The tone is well above a meter's error, and its edges stay below clipping.
    high = next(tone for tone in plan.tones if tone.samples == plan.board.stimulus.periods[2])
    assert 0.2 < high.limits.expected < 0.6 * (1.0 if plan.board.is_sampled else 3.0)
    parts = load_project(name).placement.parts.items()
    pads = {
        reference: [(*pad.centre, pad.net.removeprefix("/")) for pad in part.pads]
        for reference, part in parts
    }
    nets = {"R13": "REFERENCE"}
    sheet = bring_up_files(design)["bringup.md"].decode()
    for part in (part for part in circuit.components if part.symbol.name == "BAT54S"):
        diodes = {
            pin.name: circuit.net_by_pin[part.reference, pin.number] for pin in part.symbol.pins
        }
        assert (diodes["A"], diodes["K"]) == (GND, "VCC")
    stated = np.array(re.findall(r"\| (-?[\d.]+) to (-?[\d.]+) V \|", sheet), dtype=float)
    for limits in (*plan.open_v.values(), *plan.dummy_v.values()):
        assert abs(stated - (limits.low, limits.high)).max(axis=1).min() < 6e-4, (
            "rounded to a millivolt"
        )
    found = set(re.findall(r"(left|right|upper|lower) end of (\w+)", sheet))
    assert {reference for _, reference in found} >= {"R13"} & {*pads}
    for side, reference in found:
        (x, y, _), (ox, oy, _) = sorted(
            pads[reference], key=lambda pad: pad[2] != nets.get(reference, GND)
        )
        assert {"left": x < ox, "right": x > ox, "upper": y < oy, "lower": y > oy}[side], reference
        assert sum(net == nets.get(reference, GND) for *_, net in pads[reference]) == 1


@pytest.mark.full
def test_command_writes_the_sheet_and_another_design_takes_it_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run_fingertip("board", "--out", "b", "--bringup", "-q")
    assert done.returncode == 0, done.stderr
    assert {"bringup.md", "bringup.ino", "wiring.svg"} <= {
        path.name for path in Path("b").iterdir()
    }
    assert run_fingertip("board", "--out", "b", "--check").returncode == 0
    other = run_fingertip("board", "--set", "board.cutoff_hz=80", "--out", "b")
    assert (
        "removed files of another design: bringup.ino, bringup.md, wiring.svg; --bringup"
        in other.stderr
    )
    assert not Path("b/bringup.md").exists()


_STAND_IN = r"""
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
enum { LOW, HIGH, OUTPUT, A0 = 14, A1 };
#define TWO_PI 6.283185307179586
static double now_us, level, state, tap_us = -1e9, taps;
// A low-pass of 300 Hz between the pin and both inputs, at a converter of 12 bits; a tap at the second request.
static void pass(double us) { state += (level - state) * (1.0 - exp(-us * 1e-6 * TWO_PI * 300.0)); now_us += us; }
void pinMode(int, int) {}
void analogReadResolution(int) {}
void digitalWrite(int, int value) { level = value ? 3.3 : 0.0; }
int analogRead(int) { return (int)lround((state + (now_us - tap_us < 1e3 ? 0.01 : 0.0)) / 3.3 * 4096.0); }
uint32_t micros() { pass(1.0); return (uint32_t)now_us; }
struct Port {
  void begin(unsigned long) {}
  void print(const char *text) { fputs(text, stdout); }
  void print(float value, int digits) { printf("%.*f", digits, value); }
  void println(const char *text) { puts(text); if (*text == 'T' && taps++) tap_us = now_us; if (now_us > 9e7) exit(0); }
} Serial;
#include "bringup.ino"
int main() { setup(); for (;;) loop(); }
"""  # noqa: E501


@pytest.mark.full
@pytest.mark.parametrize("name", ["precision", "article"])
def test_sketch_measures_the_tone_behind_a_low_pass(tmp_path: Path, name: str) -> None:
    """The fundamental of a square wave behind a pole, in closed
    form: TONE_V / sqrt(1 + (f / f0)^2).
    """
    compiler = require_tool("g++", "install g++")
    design, plan = plan_of(name)
    (tmp_path / "bringup.ino").write_bytes(bring_up_files(design)["bringup.ino"])
    (tmp_path / "Arduino.h").touch()
    (tmp_path / "main.cpp").write_text(_STAND_IN)
    command = [compiler, "-O2", "-Wall", "-Wextra", "-Werror", "-I.", "main.cpp", "-o", "run"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=120)
    said = subprocess.run(
        [tmp_path / "run"], capture_output=True, text=True, check=True, timeout=120
    ).stdout
    if name == "article":
        assert [f"{tone.hz:.1f} Hz: TP3" in said for tone in plan.tones] == [True] * 3
        return
    found = re.findall(
        r"([ST]) with ([\d.]+) Hz, RMS: ([\d.]+) V, ([\d.]+) to ([\d.]+) (ok|FAILS)", said
    )
    assert len(found) >= len(plan.tones) == 5
    for (letter, hz, volts, low, high, verdict), tone in zip(found, plan.tones, strict=False):
        assert (letter, float(hz)) == (
            "T" if tone.net == ADC_TACTILE else "S",
            pytest.approx(tone.hz, abs=0.06),
        )
        expected = stimulus.TONE_V / math.hypot(1.0, tone.hz / 300.0)
        # With 6 samples a period the fifth harmonic appears as the first, and each sample follows
        # the edge.
        assert float(volts) == pytest.approx(expected, rel=0.02 if tone.samples > 6 else 0.1)
        assert verdict == ("ok" if float(low) <= float(volts) <= float(high) else "FAILS")
        assert (float(low), float(high)) == pytest.approx(
            (tone.limits.low, tone.limits.high), abs=6e-5
        )
    assert (re.findall(r"S tapped, .* (ok|FAILS)", said), "too slow" in said) == (
        ["FAILS", "ok"],
        False,
    )
    (tmp_path / "main.cpp").write_text(
        _STAND_IN.replace("A0 = 14", f"A0 = {stimulus.TONE_PIN - 1}")
    )
    refused = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120
    )
    assert "take another pin" in refused.stderr
    assert re.search(r"S quiet, RMS: 0.0000 V, 0.0000 to [\d.]+  ?ok", said)
