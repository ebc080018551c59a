"""Effects that ideal formulas omit, compared with ngspice on the deck: offsets, bias current, ripple, passband."""

from __future__ import annotations

import itertools
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
from tests.conftest import run_fingertip
from tests.designs import ARTICLE, ARTICLE_OPTIONS, load_article

SUPPLIES = ["split", "single"]


def replace_elements(deck: str, **elements: str) -> str:
    """Return the deck with other lines in place of those of these elements."""
    for name, line in elements.items():
        old = next(candidate for candidate in deck.splitlines() if candidate.startswith(f"{name} "))
        deck = deck.replace(f"\n{old}\n", f"\n{line}\n")
    return deck


def simulate_envelope_offset_v(folder: Path, deck: str, ground: str, offsets: tuple[float, ...]) -> float:
    """Simulate the envelope offset [V] above signal ground, with offset sources at U1b, U3a and U3b."""
    inputs = {
        "XU1b": "stage2_in filtered filtered",
        "XU3a": f"{ground} rect_in rect_out",
        "XU3b": f"{ground} lp_in envelope",
    }
    lines = {}
    for i, ((name, pins), volt) in enumerate(zip(inputs.items(), offsets, strict=True)):
        plus, others = pins.split(" ", 1)
        assert f"{name} {pins} tlv2372" in deck
        lines[name] = f"VO{i} o{i} {plus} {volt:g}\n{name} o{i} {others} tlv2372"
    outputs = "v(envelope)" if ground == "0" else f"v(envelope) v({ground})"
    _, *volts = run_ngspice(folder, replace_elements(deck, **lines), f"op\nwrdata out {outputs}")[0]
    return volts[0] - sum(volts[1:])


@pytest.mark.full
@pytest.mark.parametrize("supply", SUPPLIES)
def test_envelope_offset_agrees_with_ngspice(tmp_path: Path, supply: str) -> None:
    changes = ["board.variant=comparator", f"board.supply={supply}", "board.amplifier=TLV2372"]
    design, deck = write_deck(tmp_path, changes)
    offset, ground = board_values(design).output_offset, "0" if supply == "split" else "vmid"
    assert offset is not None
    corners = itertools.product((-4.5e-3, 4.5e-3), repeat=3)
    envelopes = {corner: simulate_envelope_offset_v(tmp_path, deck, ground, corner) for corner in corners}
    assert min(envelopes.values()) == pytest.approx(offset.min_v, abs=2e-4)
    assert max(envelopes.values()) == pytest.approx(offset.max_v, abs=2e-4)
    assert envelopes[4.5e-3, -4.5e-3, 4.5e-3] == max(envelopes.values())
    # The worst case exceeds the threshold: without calibration such a board would report slip permanently.
    assert offset.max_v > design.detector.threshold_v > offset.typical_v
    assert simulate_envelope_offset_v(tmp_path, deck, ground, (0.0, 0.0, 0.0)) == pytest.approx(0, abs=2e-4)
    assert offset.max_low_offset_v < 0.05 * design.detector.threshold_v


def test_variant_article_has_no_envelope_offset() -> None:
    """It is below the diode's threshold."""
    assert board_values(ARTICLE).output_offset is None


@pytest.mark.full
@pytest.mark.parametrize("supply", SUPPLIES)
def test_bias_error_of_the_comparator_agrees_with_ngspice(tmp_path: Path, supply: str) -> None:
    design, deck = write_deck(tmp_path, ["board.variant=comparator", f"board.supply={supply}"])
    levels = board_values(design).comparator_levels
    assert levels is not None
    assert "C17 mean 0 1u" in deck or "C17 mean vmid 1u" in deck
    volts = [
        run_ngspice(tmp_path, deck.replace("\n.ac", f"\nIB 0 mean {bias:g}\n.ac"), "op\nwrdata out v(mean)")[0][1]
        for bias in (0.0, 25e-9, 250e-9)
    ]
    assert volts[1] - volts[0] == pytest.approx(levels.bias_v, rel=1e-3)
    assert volts[2] - volts[0] == pytest.approx(levels.max_bias_v, rel=1e-3)
    assert levels.max_bias_v < 0.25 * design.detector.threshold_v


@pytest.mark.full
@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_supply_ripple_agrees_with_ngspice(tmp_path: Path, variant: str, supply: str) -> None:
    design, deck = write_deck(tmp_path, [f"board.variant={variant}", f"board.supply={supply}"])
    ripple = board_values(design).supply_ripple
    source = "VJ2a vcc 0 5" if supply == "split" else "VJ2 vcc 0 5"
    open_sensor = replace_elements(deck, RJ1=deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0] + " 1e12")
    assert f"\n{source}\n" in deck
    ripple_only = open_sensor.replace(f"\n{source}\n", f"\n{source} ac 1\n").replace("dc 0 ac 1u", "dc 0")
    ground = "" if supply == "split" else "-v(vmid)"
    rows = run_ngspice(tmp_path, ripple_only, f"ac dec 100 30 100k\nlet g = abs(v(filtered){ground})\nwrdata out g")
    gains = {f: g for f, g, *_ in rows}
    worst_hz = max(gains, key=gains.__getitem__)
    assert ripple.gain == pytest.approx(gains[worst_hz], rel=0.002)
    assert ripple.worst_hz == pytest.approx(worst_hz, rel=0.05)
    assert (ripple.low_hz, ripple.high_hz) == (30, 100e3)
    # Without a low-pass (variant article) ripple of a switching converter counts more than that of the mains.
    assert (worst_hz > 5000) == (variant == "article")
    peak = 0.45 if variant == "article" else math.pi * design.detector.threshold_v
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


def test_ripple_is_searched_from_half_of_a_low_cutoff() -> None:
    ripple = board_values(load_article(["board.cutoff_hz=5", "board.capacitor_uf=10"])).supply_ripple
    assert (ripple.low_hz, ripple.high_hz) == (2.5, 100e3)


@pytest.mark.full
@pytest.mark.parametrize(
    ("changes", "figures"),
    [
        ([], (67.25, 36.60, 59388.0)),
        (["board.variant=precision"], (66.77, 36.47, 1069.1)),
        (["board.variant=precision", "board.band_limit_hz=210"], (63.59, 35.49, 293.3)),
        (["board.variant=comparator", "board.supply=single", "board.cutoff_hz=30", "board.series=E12"], None),
        (["board.variant=precision", "board.passband_gain=8", "board.cutoff_hz=150"], None),
    ],
)
def test_passband_agrees_with_ngspice(tmp_path: Path, changes: list[str], figures: tuple[float, ...] | None) -> None:
    design, deck = write_deck(tmp_path, changes)
    achieved = board_values(design).achieved_response
    rows = run_ngspice(tmp_path, deck, "ac dec 1000 5 1meg\nlet h = db(v(filtered)/v(tactile))\nwrdata out h")
    maximum = max(h for _, h, *_ in rows)
    inside = [f for f, h, *_ in rows if h >= maximum - 3.0103]
    assert achieved.passband_gain_db == pytest.approx(maximum, abs=2e-3)
    assert achieved.passband_gain == pytest.approx(10 ** (maximum / 20), rel=1e-3)
    assert (achieved.cutoff_hz, achieved.upper_cutoff_hz) == pytest.approx((inside[0], inside[-1]), rel=3e-3)
    if figures:
        assert (achieved.cutoff_hz, achieved.passband_gain_db, achieved.upper_cutoff_hz) == pytest.approx(
            figures, abs=0.06
        )


@pytest.mark.full
def test_analysis_and_values_contain_these_effects(tmp_path: Path) -> None:
    text = run_fingertip(
        "board", *ARTICLE_OPTIONS, "--analysis", "--quiet", "--set", "board.variant=comparator", "--out", tmp_path,
        "--set", "board.capacitor_tolerance_percent=10",
    ).stdout  # fmt: skip
    for phrase in (
        "envelope offset between -0.2 and 0.5 mV", "measure the envelope offset",
        "ON above 16.9 mV and OFF below 12.4 mV",
        "raises the mean by 0.38 mV (at most 3.75 mV)", "multiplied by 59 at most", "a peak of 0.91 mV",
        "would raise the threshold by 0.12 mV", "INA821 for U2 is a comparison, not a drop-in replacement",
        "10000 boards with uniformly and independently distributed values", "not included: R_LP and C_LP",
        "U3: see the envelope offset above", "(4.9 V peak) needs 84 dB",
        "filter resistors 1 %, capacitors 10 %", "upper -3 dB",
    ):  # fmt: skip
        assert phrase in text
    values_text = (tmp_path / "values.json").read_text("utf-8")
    for key in ("on_v", "off_v", "max_bias_v", "upper_cutoff_hz", "max_low_offset_v", "filter_trough_v"):
        assert f'"{key}"' in values_text
