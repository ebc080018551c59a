"""Voltage limits on both supplies, and why the bridge refers to VMID on a single supply."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.limits import (
    adc_range_warnings,
    compute_output_swing,
    compute_voltage_limits,
    describe_adc_range,
    describe_filter_swing,
)
from fingertip.board.analysis.loads import load_warnings
from fingertip.board.components.amplifiers import (
    AMPLIFIERS,
    ARTICLE_AMPLIFIER,
    RAIL_TO_RAIL_AMPLIFIER,
    select_dual_amplifier,
)
from fingertip.board.supplies import SUPPLIES
from fingertip.board.variants import BOARD_CONFIGURATIONS
from fingertip.design import Design
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck


def test_voltage_limits_of_both_supplies() -> None:
    split, single = (
        board_values(Design.load(changes=[f"board.supply={s}"])).voltage_limits for s in ("split", "single")
    )
    assert (split.signal_ground_v, single.signal_ground_v) == (0.0, 2.5)
    assert (split.filter_peak_v, single.filter_peak_v) == pytest.approx((3.5, 2.4))
    assert (split.filter_trough_v, single.filter_trough_v) == pytest.approx((2.0, 2.4))
    assert split.vibration_peak_v == pytest.approx(2.0 / 67.667, rel=1e-3)
    assert single.vibration_peak_v == pytest.approx(2.4 / 67.667, rel=1e-3)
    for limits in (split, single):
        assert 0 < limits.min_tactile_v < 3.85 < 4.3 < limits.max_tactile_v < 4.5
        assert limits.max_tactile_v <= limits.clamp_high_rail_v


def test_an_adc_range_below_the_boards_signals_is_reported() -> None:
    sufficient, insufficient = (
        board_values(Design.load(changes=["board.supply=single", f"detector.adc_range_v={v}"])).voltage_limits
        for v in (10.0, 3.3)
    )
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
        values = board_values(Design.load(changes=configuration.changes))
        limits, is_article = values.voltage_limits, name == "article_split"
        amplifier = ARTICLE_AMPLIFIER if is_article else RAIL_TO_RAIL_AMPLIFIER
        assert values.amplifier == amplifier == select_dual_amplifier(*name.split("_"))
        assert limits.has_phase_reversal == is_article == ("jumps up" in describe_filter_swing(limits))
        if is_article:
            assert (limits.filter_trough_v, limits.filter_guaranteed_trough_v) == (2.0, 1.0)
        else:
            assert limits.filter_trough_v == limits.filter_guaranteed_trough_v == limits.filter_peak_v
        assert f"{limits.filter_trough_v:.1f} V down" in describe_filter_swing(limits)
    higher_supply = board_values(Design.load(changes=["board.supply_v=6"])).voltage_limits
    assert (higher_supply.filter_peak_v, higher_supply.filter_trough_v) == (4.5, 3.0)


@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize("supply_v", [5.0, 5.5, 6.0])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_bridge_amplifier_stays_within_its_limits(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    assert board_values(Design.load(changes=changes)).voltage_limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_violates_the_amplifiers_limits_on_a_single_supply() -> None:
    """The AD623's internal amplifiers would have to go below ground, so the bridge refers to VMID."""
    circuit = board_circuit(board_values(Design()))  # of a split supply: its bridge refers to ground
    for negative_rail, minimum, maximum in (("VEE", 0.0, 5.0), ("GND", -5.0, -1.0)):
        supply = replace(SUPPLIES["split"], negative_rail=negative_rail)
        swing = compute_output_swing(AMPLIFIERS[RAIL_TO_RAIL_AMPLIFIER], supply, 5.0)
        limits = compute_voltage_limits(circuit, supply, 5.0, swing, 67.7, True, 10.0)
        assert minimum < limits.bridge_amplifier_margin_v < maximum


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_filter_load_agrees_with_the_current_in_ngspice(tmp_path: Path, name: str) -> None:
    """A source of 0 V in the output of each amplifier measures its current."""
    design, deck = write_deck(tmp_path, list(BOARD_CONFIGURATIONS[name].changes))
    values, loads = board_values(design), []
    band = values.achieved_response.cutoff_hz, values.achieved_response.upper_cutoff_hz
    for element, output in (("XU1a", "stage1_out"), ("XU1b", "filtered")):
        (line,) = (line for line in deck.splitlines() if line.startswith(f"{element} "))
        words = line.split()
        assert words[3] == output
        # The inverting input stays where it was, at the output or behind the feedback.
        measured = deck.replace(line, f"{' '.join([*words[:3], 'metered', words[4]])}\nVM metered {output} 0")
        rows = run_ngspice(
            tmp_path, measured, f"ac dec 60 {band[0]} {band[1]}\nlet z = abs(v({output})/i(vm))\nwrdata out z"
        )
        loads.append(min(ohm for _, ohm, *_ in rows))
    assert values.filter_load_ohm == pytest.approx(min(loads), rel=0.01)


def test_filter_load_is_inverse_to_the_capacitors() -> None:
    ten_times = board_values(Design.load(changes=["board.capacitor_uf=10"])).filter_load_ohm
    assert ten_times == pytest.approx(board_values(Design()).filter_load_ohm / 10, rel=0.05)


@pytest.mark.parametrize("cutoff", ["40", "67", "150"])
@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
def test_load_below_that_of_the_data_sheets_is_warned_of_with_a_remedy(series: str, cutoff: str) -> None:
    changes = [f"board.series={series}", f"board.cutoff_hz={cutoff}"]

    def warnings(*more: str) -> list[str]:
        design = Design.load(changes=[*changes, *more])
        values = board_values(design)
        return list(load_warnings(design.board, values.filter_load_ohm, values.preferred.c_f))

    (warning,) = warnings("board.capacitor_uf=4.7")
    assert "may clip earlier than stated; set board.capacitor_uf to at most " in warning
    remedy = warning.split()[-1].rstrip(".")
    assert warnings(f"board.capacitor_uf={remedy}") == []
    # A selected capacitor may take R1 down to 2k, and the load a little below that.
    for capacitors in ("E6", "E12"):
        for warning in warnings(f"board.capacitor_series={capacitors}"):
            _, _, first, _, second = warning.rstrip(".").rsplit(" ", 4)
            assert warnings(first, second) == []
