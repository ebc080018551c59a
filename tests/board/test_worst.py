"""What ideal figures leave out, against ngspice on the deck: offsets, input current, ripple, ends of the passband."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.values.amplifiers import AMPLIFIERS, PAPERS
from fingertip.board.values.rest import rest_of
from fingertip.board.values.ripple import RIPPLE_BAND_HZ
from fingertip.design import Design
from tests.board.ngspice import simulate
from tests.board.test_spice import deck_of
from tests.conftest import run_fingertip

SUPPLIES = ["split", "single"]


def replaced(deck: str, **parts: str) -> str:
    """The deck with other lines in place of those of these elements."""
    for name, line in parts.items():
        old = next(found for found in deck.splitlines() if found.startswith(f"{name} "))
        deck = deck.replace(f"\n{old}\n", f"\n{line}\n")
    return deck


def resting_v(folder: Path, deck: str, zero: str, offsets: tuple[float, ...]) -> float:
    """The envelope [V] above where signals rest, with a source at the inputs of U1b, U3a and U3b."""
    inputs = {
        "XU1b": "stage2_in filtered filtered",
        "XU3a": f"{zero} rect_in rect_out",
        "XU3b": f"{zero} lp_in envelope",
    }
    lines = {}
    for i, ((name, pins), volt) in enumerate(zip(inputs.items(), offsets, strict=True)):
        plus, others = pins.split(" ", 1)
        assert f"{name} {pins} tlv2372" in deck
        lines[name] = f"VO{i} o{i} {plus} {volt:g}\n{name} o{i} {others} tlv2372"
    shown = "v(envelope)" if zero == "0" else f"v(envelope) v({zero})"
    _, *volts = simulate(folder, replaced(deck, **lines), f"op\nwrdata out {shown}")[0]
    return volts[0] - sum(volts[1:])


@pytest.mark.parametrize("supply", SUPPLIES)
def test_where_the_envelope_rests_is_ngspices(tmp_path: Path, supply: str) -> None:
    design, deck = deck_of(tmp_path, ["board.variant=comparator", f"board.supply={supply}"])
    rest, zero = board_values(design).rest, "0" if supply == "split" else "vmid"
    assert rest is not None
    corners = itertools.product((-4.5e-3, 4.5e-3), repeat=3)
    found = {corner: resting_v(tmp_path, deck, zero, corner) for corner in corners}
    assert min(found.values()) == pytest.approx(rest.min_v, abs=2e-4)
    assert max(found.values()) == pytest.approx(rest.max_v, abs=2e-4)
    assert found[4.5e-3, -4.5e-3, 4.5e-3] == max(found.values())
    # Above the threshold: such a board would say slip for ever, if nobody measured it.
    assert rest.max_v > design.detector.threshold_v > rest.typical_v
    assert resting_v(tmp_path, deck, zero, (0.0, 0.0, 0.0)) == pytest.approx(0, abs=2e-4)
    assert rest.max_finer_v < 0.05 * design.detector.threshold_v


def test_the_rest_of_other_amplifiers() -> None:
    """The TL082's grade BC: 3 mV each; without a grade it would be five times that."""
    rest = rest_of(AMPLIFIERS[PAPERS], 2e3)
    assert (rest.min_v, rest.max_v) == pytest.approx((-4e-3, 15e-3))
    assert board_values(Design()).rest is None  # a bare diode hides it


@pytest.mark.parametrize("supply", SUPPLIES)
def test_what_the_comparators_input_current_does_is_ngspices(tmp_path: Path, supply: str) -> None:
    design, deck = deck_of(tmp_path, ["board.variant=comparator", f"board.supply={supply}"])
    decision = board_values(design).decision
    assert decision is not None
    assert "C17 mean 0 1u" in deck or "C17 mean vmid 1u" in deck
    volts = [
        simulate(tmp_path, deck.replace("\n.ac", f"\nIB 0 mean {bias:g}\n.ac"), "op\nwrdata out v(mean)")[0][1]
        for bias in (0.0, 25e-9, 250e-9)
    ]
    assert volts[1] - volts[0] == pytest.approx(decision.bias_v, rel=1e-3)
    assert volts[2] - volts[0] == pytest.approx(decision.max_bias_v, rel=1e-3)
    assert decision.max_bias_v < 0.25 * design.detector.threshold_v


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
@pytest.mark.parametrize("supply", SUPPLIES)
def test_ripple_on_the_supply_is_ngspices(tmp_path: Path, variant: str, supply: str) -> None:
    design, deck = deck_of(tmp_path, [f"board.variant={variant}", f"board.supply={supply}"])
    ripple = board_values(design).ripple
    source = "VJ2a vcc 0 5" if supply == "split" else "VJ2 vcc 0 5"
    open_ = replaced(deck, RJ1=deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0] + " 1e12")
    assert f"\n{source}\n" in deck
    alone = open_.replace(f"\n{source}\n", f"\n{source} ac 1\n").replace("dc 0 ac 1u", "dc 0")
    rest = "" if supply == "split" else "-v(vmid)"
    low, high = RIPPLE_BAND_HZ
    rows = simulate(tmp_path, alone, f"ac dec 100 {low} {high}\nlet g = abs(v(filtered){rest})\nwrdata out g")
    gains = [g for _, g, *_ in rows]
    assert max(gains) == pytest.approx(ripple.gain, rel=0.01)
    peak = 0.45 if variant == "article" else math.pi * design.detector.threshold_v
    assert ripple.max_v == pytest.approx(peak / max(gains), rel=0.01)


@pytest.mark.parametrize(
    ("changes", "figures"),
    [
        ([], (67.25, 36.60, 44346.7)),
        (["board.variant=precision"], (66.77, 36.47, 1069.1)),
        (["board.variant=precision", "board.band_limit_hz=210"], (63.59, 35.49, 293.3)),
        (["board.variant=comparator", "board.supply=single", "board.cutoff_hz=30", "board.series=E12"], None),
        (["board.variant=precision", "board.passband_gain=8", "board.cutoff_hz=150"], None),
    ],
)
def test_both_ends_of_the_passband_are_ngspices(
    tmp_path: Path, changes: list[str], figures: tuple[float, ...] | None
) -> None:
    design, deck = deck_of(tmp_path, changes)
    achieved = board_values(design).achieved
    rows = simulate(tmp_path, deck, "ac dec 1000 5 1meg\nlet h = db(v(filtered)/v(tactile))\nwrdata out h")
    maximum = max(h for _, h, *_ in rows)
    inside = [f for f, h, *_ in rows if h >= maximum - 3.0103]
    assert achieved.passband_gain_db == pytest.approx(maximum, abs=2e-3)
    assert achieved.passband_gain == pytest.approx(10 ** (maximum / 20), rel=1e-3)
    assert (achieved.cutoff_hz, achieved.upper_cutoff_hz) == pytest.approx((inside[0], inside[-1]), rel=3e-3)
    if figures:
        assert (achieved.cutoff_hz, achieved.passband_gain_db, achieved.upper_cutoff_hz) == pytest.approx(
            figures, abs=0.06
        )


def test_the_analysis_and_values_say_it(tmp_path: Path) -> None:
    text = run_fingertip(
        "board", "--analysis", "--quiet", "--set", "board.variant=comparator", "--out", tmp_path,
        "--set", "board.capacitor_tolerance_percent=10",
    ).stdout  # fmt: skip
    for words in (
        "rest between -6.0 and 22.5 mV", "measure the rest", "ON above 16.9 mV and OFF below 12.4 mV",
        "lifts the mean by 0.38 mV (3.75 mV at most)", "reaches the rectifier 59 times", "a peak of 0.91 mV",
        "resistors 1 %, capacitors 10 %", "upper -3 dB",
    ):  # fmt: skip
        assert words in text
    kept = (tmp_path / "values.json").read_text("utf-8")
    for key in ("on_v", "off_v", "max_bias_v", "upper_cutoff_hz", "max_finer_v", "filter_trough_v"):
        assert f'"{key}"' in kept
