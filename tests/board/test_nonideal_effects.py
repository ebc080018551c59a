"""Effects that ideal formulas omit, compared with ngspice on the deck: offsets, bias current, ripple, passband."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.analysis.supply_ripple import RIPPLE_BAND_HZ
from fingertip.design import Design
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck
from tests.conftest import run_fingertip

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


@pytest.mark.parametrize("supply", SUPPLIES)
def test_envelope_offset_agrees_with_ngspice(tmp_path: Path, supply: str) -> None:
    design, deck = write_deck(tmp_path, ["board.variant=comparator", f"board.supply={supply}"])
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
    assert board_values(Design()).output_offset is None


@pytest.mark.slow
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
    low, high = RIPPLE_BAND_HZ
    rows = run_ngspice(
        tmp_path, ripple_only, f"ac dec 100 {low} {high}\nlet g = abs(v(filtered){ground})\nwrdata out g"
    )
    gains = [g for _, g, *_ in rows]
    assert max(gains) == pytest.approx(ripple.gain, rel=0.01)
    peak = 0.45 if variant == "article" else math.pi * design.detector.threshold_v
    assert ripple.max_v == pytest.approx(peak / max(gains), rel=0.01)


@pytest.mark.parametrize(
    ("changes", "figures"),
    [
        ([], (67.25, 36.60, 44493.6)),
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


@pytest.mark.slow
def test_analysis_and_values_contain_these_effects(tmp_path: Path) -> None:
    text = run_fingertip(
        "board", "--analysis", "--quiet", "--set", "board.variant=comparator", "--out", tmp_path,
        "--set", "board.capacitor_tolerance_percent=10",
    ).stdout  # fmt: skip
    for phrase in (
        "envelope offset between -6.0 and 22.5 mV", "measure the envelope offset",
        "ON above 16.9 mV and OFF below 12.4 mV",
        "raises the mean by 0.38 mV (at most 3.75 mV)", "amplified 59 times", "a peak of 0.91 mV",
        "filter resistors 1 %, capacitors 10 %", "upper -3 dB",
    ):  # fmt: skip
        assert phrase in text
    values_text = (tmp_path / "values.json").read_text("utf-8")
    for key in ("on_v", "off_v", "max_bias_v", "upper_cutoff_hz", "max_low_offset_v", "filter_trough_v"):
        assert f'"{key}"' in values_text
