"""Effects that ideal formulas omit, compared with ngspice on the deck: offsets, bias current, ripple, passband."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.circuits.network import build_network
from fingertip.board.components.bridge import sensor_conductance_s
from fingertip.board.components.values import SUPPLIES as SUPPLY_NETS
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck
from tests.designs import load_article

SUPPLIES = ["split", "single"]


def replace_elements(deck: str, **elements: str) -> str:
    """Return the deck with other lines in place of those of these elements."""
    for name, line in elements.items():
        old = next(candidate for candidate in deck.splitlines() if candidate.startswith(f"{name} "))
        deck = deck.replace(f"\n{old}\n", f"\n{line}\n")
    return deck


@pytest.mark.every_case
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_supply_ripple_agrees_with_ngspice(tmp_path: Path, name: str) -> None:
    design, deck = write_deck(tmp_path, [*BOARD_CONFIGURATIONS[name].changes])
    ripple, is_article = board_values(design).supply_ripple, name.startswith("article")
    sensor = deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0]
    deck = replace_elements(deck, RJ1=f"{sensor} {1 / (sensor_conductance_s(ripple.force_n) or 1e-12):.10g}")
    (source,) = (line for line in deck.splitlines() if line.startswith(("VJ2a ", "VJ2 ")))
    ripple_only = deck.replace(f"\n{source}\n", f"\n{source} ac 1\n").replace("dc 0 ac 1u", "dc 0")
    ground = "" if name.endswith("split") else "-v(vmid)"
    rows = run_ngspice(tmp_path, ripple_only, f"ac dec 100 30 100k\nlet g = abs(v(filtered){ground})\nwrdata out g")
    gains = {f: g for f, g, *_ in rows}
    worst_hz = max(gains, key=gains.__getitem__)
    assert ripple.gain == pytest.approx(gains[worst_hz], rel=0.01 if "3v3" in name else 0.002)
    assert ripple.worst_hz == pytest.approx(worst_hz, rel=0.05)
    assert (ripple.low_hz, ripple.high_hz) == (30, 100e3)
    # Without a low-pass (variant article) ripple of a switching converter counts more than that of the mains.
    assert (worst_hz > 5000) == (is_article and "3v3" not in name)
    peak = 0.45 if is_article else math.pi * design.detector.threshold_v
    assert ripple.max_v == pytest.approx(peak / gains[worst_hz], rel=0.01)


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_supply_ripple_is_worst_at_the_stated_force(name: str) -> None:
    design = load_article(BOARD_CONFIGURATIONS[name].changes)
    values = board_values(design)
    for force_n in {0.0, 0.3, 1.0, 5.0, 20.0} - {values.supply_ripple.force_n}:
        network = build_network(board_circuit(values), 3e6, sensor_s=sensor_conductance_s(force_n))
        part = network.restrict("FILTERED", SUPPLY_NETS[design.board.supply].signal_ground)
        nets = [net for net in ("FILTERED", "VMID") if net in part.nets]
        volts = part.response(np.geomspace(30, 1e5, 300), {"VCC": 1.0}, *nets)
        assert np.abs(volts @ np.array([1.0, -1.0][: len(nets)])).max() < values.supply_ripple.gain


@pytest.mark.parametrize("variant", ["article", "precision"])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_clamps_shift_both_pins_by_at_most_the_stated_voltage(tmp_path: Path, variant: str, supply: str) -> None:
    """Reverse currents of 2 uA, compared with none, for an open sensor and without a signal."""
    design, deck = write_deck(tmp_path, [f"board.variant={variant}", f"board.supply={supply}"])
    limits = board_values(design).voltage_limits
    sensor = deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0]
    (model,) = (line for line in deck.splitlines() if line.startswith(".model DBAT54"))
    deck = replace_elements(deck, RJ1=f"{sensor} 1e12")
    leaky, ideal = (
        run_ngspice(
            tmp_path,
            deck.replace(model, model.replace("Is=1e-07", f"Is={current}")),
            "op\nwrdata out v(adc_envelope) v(adc_tactile)",
        )[0][1:]
        for current in ("2e-6", "1e-15")
    )
    shifts = [a - b for a, b in zip(leaky, ideal, strict=True)]
    stated = [2e-6 * ohm for ohm in (limits.envelope_pin_ohm, limits.tactile_pin_ohm)]
    assert all(abs(shift) < 1.001 * limit for shift, limit in zip(shifts, stated, strict=True))
    # On a split supply E is at ground, where the lower diode of D2 does not block. Elsewhere equal currents cancel.
    assert (shifts[0] > 0.5 * stated[0]) == (supply == "split")
    assert abs(shifts[1]) < 0.01 * stated[1]
