"""Voltage limits on both supplies, and why the bridge refers to VMID on a single supply."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.limits import (
    adc_range_warnings,
    compute_voltage_limits,
    describe_adc_range,
    describe_filter_swing,
)
from fingertip.board.analysis.loads import compute_amplifier_loads, load_warnings
from fingertip.board.components.bridge import (
    AMPLIFIERS,
)
from fingertip.board.components.values import SUPPLIES
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.catalogues.amplifiers import (
    ARTICLE_AMPLIFIER,
    LOW_OFFSET_AMPLIFIER,
    LOW_VOLTAGE_AMPLIFIER,
    RAIL_TO_RAIL_AMPLIFIER,
)
from fingertip.design.parameters import Detector
from tests.board.ngspice import run_ngspice
from tests.board.test_spice import write_deck
from tests.designs import ARTICLE, load_article


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


@pytest.mark.full
@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
@pytest.mark.parametrize(
    ("supply", "supply_v"),
    [("split", 5.0), ("split", 5.5), ("single", 5.0), ("single", 6.0), ("single_3v3", 3.1), ("single_3v3", 3.6)],
)
def test_bridge_amplifier_stays_within_its_limits(supply: str, supply_v: float, series: str) -> None:
    changes = [f"board.supply={supply}", f"board.supply_v={supply_v}", f"board.series={series}"]
    changes.append("board.variant=precision")
    assert board_values(load_article(changes)).voltage_limits.bridge_amplifier_margin_v > 0


def test_a_bridge_at_ground_violates_the_amplifiers_limits_on_a_single_supply() -> None:
    """The AD623's internal amplifiers would have to go below ground, so the bridge refers to VMID."""
    circuit = board_circuit(board_values(ARTICLE))  # of a split supply: its bridge refers to ground
    for negative_rail, minimum, maximum in (("VEE", 0.0, 5.0), ("GND", -5.0, -1.0)):
        supply = replace(SUPPLIES["split"], negative_rail=negative_rail)
        amplifier = AMPLIFIERS[RAIL_TO_RAIL_AMPLIFIER]
        limits = compute_voltage_limits(circuit, supply, 5.0, amplifier, 67.7, True, Detector())
        assert minimum < limits.bridge_amplifier_margin_v < maximum


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


@pytest.mark.parametrize("supply", ["split", "single"])
def test_charging_current_through_the_diode_stays_below_its_bound(tmp_path: Path, supply: str) -> None:
    """A vibration of 201 Hz at the clipping level charges C4 of variant article through D1."""
    design, deck = write_deck(tmp_path, [f"board.supply={supply}"])
    values, ground = board_values(design), "0" if supply == "split" else "vmid"
    load = next(load for load in values.amplifier_loads if load.amplifier == "U1b")
    metered = "\n".join(line for line in measure_output(deck, "U1b").splitlines() if not line.startswith("XU2 "))
    peak_v = values.voltage_limits.vibration_peak_v
    tone = metered.replace("\n.ac", f"\nVtest tactile {ground} sin(0 {peak_v} 201)\n.ac") + "\n"
    rows = run_ngspice(tmp_path, tone, "tran 10u 0.06 0.02 10u\nwrdata out i(vm)")
    assert 0.4 * load.max_current_a < max(current for _, current in rows) < load.max_current_a


def test_fast_amplifier_does_not_change_the_loads() -> None:
    """Its resonance with the input capacitance, at 12 MHz, lies outside the band of the vibrations."""
    design = ARTICLE
    values = board_values(design)
    vibration_v = values.voltage_limits.vibration_peak_v
    fast = compute_amplifier_loads(board_circuit(values), 1e9, design.board.cutoff_hz, vibration_v)
    for load, expected in zip(fast, values.amplifier_loads, strict=True):
        assert load.min_ohm == pytest.approx(expected.min_ohm, rel=1e-3)


@pytest.mark.full
@pytest.mark.parametrize("supply", ["split", "single"])
def test_envelope_ends_a_diode_drop_below_the_swing_of_the_rectifiers_amplifier(tmp_path: Path, supply: str) -> None:
    """U3a, whose output stops near the rails, goes to the rectified voltage and a drop beyond; VMID settles slowly."""
    design, deck = write_deck(tmp_path, ["board.variant=precision", f"board.supply={supply}"])
    limits, ground = board_values(design).voltage_limits, "0" if supply == "split" else "vmid"
    low_v, high_v = limits.signal_ground_v - limits.filter_trough_v, limits.signal_ground_v + limits.filter_peak_v
    head, model = deck.split(".subckt tlv2372 ")
    limited = model.replace("E1 out 0 pole 0 1", f"B1 out 0 V = min(max(V(pole), {low_v}), {high_v})", 1)
    lines = f"{head}.subckt tlv2372 {limited}".splitlines()
    driven = "\n".join(line for line in lines if not line.startswith(("XU1", "R2 ")))
    driven = driven.replace("\n.ac", f"\nVtest filtered {ground} pwl(0 0 0.02 {limits.filter_peak_v})\n.ac") + "\n"
    vectors = "v(envelope)" if supply == "split" else "v(envelope) v(vmid)"
    _, envelope, *reference = run_ngspice(tmp_path, driven, f"tran 50u 0.5 0 50u\nwrdata out {vectors}")[-1]
    assert limits.max_envelope_v == pytest.approx(envelope - sum(reference), abs=0.06)
    assert limits.max_envelope_v == pytest.approx(4.3 if supply == "split" else 1.8)


def test_filter_load_is_inverse_to_the_capacitors() -> None:
    tenth = board_values(load_article(["board.capacitor_uf=0.1"])).filter_load_ohm
    # R5 is a part of the load that does not change.
    parallel = 1 / (1 / (10 * board_values(ARTICLE).filter_load_ohm) + 0.9 / 100e3)
    assert tenth == pytest.approx(parallel, rel=0.05)


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
