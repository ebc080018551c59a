"""Voltage limits on both supplies, and why the bridge refers to VMID on a single supply."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_values
from fingertip.board.analysis.limits import (
    adc_range_warnings,
    describe_adc_range,
    describe_filter_swing,
)
from fingertip.board.analysis.loads import load_warnings
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.catalogues.amplifiers import (
    ARTICLE_AMPLIFIER,
    LOW_OFFSET_AMPLIFIER,
    LOW_VOLTAGE_AMPLIFIER,
    RAIL_TO_RAIL_AMPLIFIER,
)
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck
from tests.designs import load_article


def test_voltage_limits_of_both_supplies() -> None:
    split, single = (board_values(load_article([f"board.supply={s}"])).voltage_limits for s in ("split", "single"))
    assert (split.signal_ground_v, single.signal_ground_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert (split.filter_trough_v, single.filter_trough_v) == pytest.approx((2.0, 2.4))
    assert split.vibration_peak_v == pytest.approx(2.0 / 67.667, rel=1e-3)
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-3)
    for limits in (split, single):
        assert 0 < limits.min_tactile_v < 3.85 < 4.3 < limits.max_tactile_v < 4.5
        assert limits.max_tactile_v <= limits.clamp_high_rail_v


def test_an_adc_range_below_the_boards_signals_is_reported() -> None:
    """The rules refuse such a range, so it is put in here."""
    sufficient = board_values(load_article(["board.supply=single"])).voltage_limits
    insufficient = replace(sufficient, adc_range_v=3.3)
    assert sufficient.adc_overrange_v == 0
    assert describe_adc_range(sufficient) == "an ADC with a range of plus and minus 10 V covers all signals"
    maximum_v = max(insufficient.max_tactile_v, 2.5 + insufficient.max_envelope_v)
    assert insufficient.adc_overrange_v == pytest.approx(maximum_v - 3.3)
    assert "clips the top 1.06 V" in describe_adc_range(insufficient)
    assert "detector.adc_range_v to at least 4.36" in describe_adc_range(insufficient)
    assert list(adc_range_warnings(sufficient)) == []
    (warning,) = adc_range_warnings(insufficient)
    assert describe_adc_range(insufficient) in warning


def test_only_the_articles_board_has_an_amplifier_with_phase_reversal() -> None:
    """The TL082's input range ends 3 V above the negative rail (typical) or 4 V (guaranteed)."""
    for name, configuration in BOARD_CONFIGURATIONS.items():
        values = board_values(load_article(configuration.changes))
        limits, is_article = values.voltage_limits, name == "article_split"
        amplifier = RAIL_TO_RAIL_AMPLIFIER
        if name.startswith("comparator"):
            amplifier = LOW_VOLTAGE_AMPLIFIER if name.endswith("3v3") else LOW_OFFSET_AMPLIFIER
        assert values.amplifier == (ARTICLE_AMPLIFIER if is_article else amplifier)
        assert limits.has_phase_reversal == is_article == ("jumps up" in describe_filter_swing(limits))
        if is_article:
            assert (limits.filter_trough_v, limits.filter_guaranteed_trough_v) == (2.0, 1.0)
        else:
            below_v = limits.signal_ground_v if "single" in name else 5.0
            above_v = configuration.supply.nominal_v - limits.signal_ground_v
            assert limits.filter_trough_v == limits.filter_guaranteed_trough_v
            assert above_v - limits.filter_peak_v == pytest.approx(below_v - limits.filter_trough_v, rel=1e-3)
        assert f"{limits.filter_trough_v:.1f} V down" in describe_filter_swing(limits)
    higher_supply = board_values(load_article(["board.supply_v=5.5"])).voltage_limits
    assert (higher_supply.filter_peak_v, higher_supply.filter_trough_v) == (4.0, 2.5)


AMPLIFIER_OUTPUTS = {"U1a": "stage1_out", "U1b": "filtered", "U2": "tactile", "U3a": "rect_out", "U3b": "envelope"}


def measure_output(deck: str, amplifier: str) -> str:
    """Deck with a source of 0 V, VM, in the output of an amplifier, which measures its current.

    The inverting input stays where it was, at the output or behind the feedback.
    """
    (line,) = (line for line in deck.splitlines() if line.startswith(f"X{amplifier} "))
    output = AMPLIFIER_OUTPUTS[amplifier]
    *words, model = line.split()
    assert words[-1] == output
    return deck.replace(line, f"{' '.join([*words[:-1], 'metered', model])}\nVM metered {output} 0")


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_amplifier_loads_agree_with_the_currents_in_ngspice(tmp_path: Path, name: str) -> None:
    """A small signal around no bias, with 1 ohm in place of the diode D1, which then conducts all the time."""
    design, deck = write_deck(tmp_path, list(BOARD_CONFIGURATIONS[name].changes))
    values = board_values(design)
    # The comparator's switch, which drives none of these outputs, keeps ngspice from finding the operating point.
    deck = "\n".join(line for line in deck.splitlines() if not line.startswith("SU4 ")) + "\n"
    assert values.amplifier_loads[0].amplifier == "U1a"
    (diode,) = (line for line in deck.splitlines() if line.startswith("D1 "))
    blocked, conducting = (deck.replace(diode, f"RD1 {' '.join(diode.split()[1:3])} {ohm}") for ohm in ("1e12", "1"))
    for load in values.amplifier_loads:
        output = AMPLIFIER_OUTPUTS[load.amplifier]
        for variant, expected in ((conducting, load.min_ohm), (blocked, load.min_filter_ohm)):
            if expected is None or (variant is blocked and not name.startswith("article")):
                continue
            reference = "" if name.endswith("split") else "-v(vmid)"
            commands = (
                f"ac lin 60 67 201\nlet u = v({output}){reference}\nlet z = abs(u/i(vm))\n"
                f"let a = abs(i(vm)/(v(tactile){reference}))\nwrdata out z a"
            )
            rows = run_ngspice(tmp_path, measure_output(variant, load.amplifier), commands)
            assert expected == pytest.approx(min(ohm for _, ohm, *_ in rows), rel=0.02), load.amplifier
            if variant is conducting:
                current = values.voltage_limits.vibration_peak_v * max(row[-1] for row in rows)
                assert load.max_current_a == pytest.approx(current, rel=0.02)


@pytest.mark.full
@pytest.mark.parametrize("cutoff", ["40", "67", "150"])
@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
def test_load_below_that_of_the_data_sheets_is_warned_of_with_a_remedy(series: str, cutoff: str) -> None:
    changes = [f"board.series={series}", f"board.cutoff_hz={cutoff}", "board.variant=precision"]
    changes.append("board.amplifier=OPA2197")  # others cannot drive the load at all

    def warnings(*more: str) -> list[str]:
        design = load_article([*changes, *more])
        values = board_values(design)
        return list(load_warnings(design.board, values.filter_load_ohm, values.preferred.c_f))

    (warning,) = warnings("board.capacitor_uf=4.7")
    assert "may clip earlier than stated; set, for example, board.capacitor_uf=" in warning
    assert "at most" not in warning  # resistors are rounded, so a larger capacitor may pass
    assert warnings(warning.split()[-1].rstrip(".")) == []
    # A selected capacitor may take R1 down to 2k, and the load a little below that.
    for capacitors in ("E6", "E12"):
        for warning in warnings(f"board.capacitor_series={capacitors}"):
            _, first, _, second = warning.rstrip(".").rsplit(" ", 3)
            assert warnings(first, second) == []
