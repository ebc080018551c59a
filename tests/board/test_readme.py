"""The README of a board's folder: supply, passband, amplifiers, ADC range, envelope offset and trimming procedure."""

from __future__ import annotations

import pytest

from fingertip.board import board_values
from fingertip.board.kicad.variants import BOARD_CONFIGURATIONS
from fingertip.foundation.files import format_figure
from fingertip.tasks.board import board_files
from tests.designs import load_article


def readme(*changes: str) -> str:
    """README of a board's folder, without line breaks."""
    return " ".join(board_files(load_article(changes))["README.md"].decode().split())


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_states_the_requirements_on_the_supply(name: str) -> None:
    text, ripple = (
        readme(*BOARD_CONFIGURATIONS[name].changes),
        board_values(load_article(BOARD_CONFIGURATIONS[name].changes)).supply_ripple,
    )
    if "3v3" in name:
        assert "Q1 blocks a reversed supply. It costs 85 uV per mA at most" in text
        assert f"multiplied by {ripple.gain:.2f} at most" in text
        assert "reversed" not in text.split("Known limitations")[1]
        return
    assert "a reversed supply destroys it" in text
    assert f"amplified up to {ripple.gain:.0f} times" in text
    assert "(sensor open). Between 30 Hz and 100 kHz its peak" in text
    assert f"must stay below {1e3 * ripple.max_v:.2g} mV" in text
    assert "linear regulator" in text
    assert "no filter for the bridge's supply" in text.split("Known limitations")[1]


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_states_the_passband_of_the_board(name: str) -> None:
    changes = (*BOARD_CONFIGURATIONS[name].changes, "board.band_limit_hz=210")
    achieved = board_values(load_article(changes)).achieved_response
    cutoffs = {
        "article_split": "67.25 Hz and 59390 Hz",
        "article_single": "67.25 Hz and 44490 Hz",
        "article_single_3v3": "67.25 Hz and 44490 Hz",
        "comparator_split": "63.61 Hz and 294.1 Hz",
        "comparator_single": "63.61 Hz and 294.1 Hz",
        "comparator_single_3v3": "63.60 Hz and 293.8 Hz",
    }.get(name, "63.59 Hz and 293.3 Hz")
    assert f"-3 dB at {cutoffs}" in readme(*changes)
    assert f"gain {achieved.passband_gain:.2f}" in readme(*changes)


@pytest.mark.full
def test_readme_states_the_limited_input_range_of_the_tl082_only() -> None:
    for name, variant in BOARD_CONFIGURATIONS.items():
        text = readme(*variant.changes)
        assert ("3.5 V up but only 2.0 V down (typical, into 10 kohm; 1.0 V down guaranteed)" in text) == (
            name == "article_split"
        )
        low_offset = "OPA2376AID" if name.endswith("3v3") else "OPA2197ID"
        dual = low_offset if name.startswith("comparator") else "TLV2372"
        assert (f"{dual}, with rail-to-rail inputs and outputs" in text) == (name != "article_split")


@pytest.mark.full
@pytest.mark.parametrize("supply", ["split", "single"])
def test_readme_states_whether_the_adc_range_is_sufficient(supply: str) -> None:
    assert "An ADC with a range of plus and minus 10 V covers all signals" in readme(f"board.supply={supply}")


@pytest.mark.parametrize(("supply", "signal_ground"), [("split", "GND"), ("single", "VMID")])
def test_readme_lists_the_test_points(supply: str, signal_ground: str) -> None:
    text = readme(f"board.supply={supply}")
    nets = ("TACTILE", "STAGE1_OUT", "FILTERED", "ENVELOPE", signal_ground)
    assert all(f"| TP{number} | {net} |" in text for number, net in enumerate(nets, start=1))


@pytest.mark.full
def test_readme_describes_the_envelope_offset_except_in_variant_article() -> None:
    assert "Envelope offset" not in readme()
    for variant in ("precision", "comparator"):
        text = readme(f"board.variant={variant}")
        ends = "-6.0 and +22.5" if variant == "precision" else "-0.2 and +0.5"
        assert f"envelope offset lies between {ends} mV" in text
        assert ("With an OPA2197 (`board.amplifier`)" in text) == (variant == "precision")
        assert "design's threshold is 17 mV" in text
    single = readme("board.variant=precision", "board.supply=single")
    assert "nothing touching the sensor: the mean of E against M." in single
    # TP4 lies ahead of R7, in which the clamp's reverse current shifts E.
    assert "Measure the idle level of the envelope at pin E of J3, with the ADC connected" in single
    assert "the mean due to noise (2.1 mV)" in single
    assert "TP4 against TP5" not in single


@pytest.mark.full
def test_readme_describes_the_trimming_procedure_of_the_comparator() -> None:
    text = readme("board.variant=comparator")
    for expected in (
        "S goes low when the mean of E rises above 16.9 mV, and high again when it falls below 12.4 mV",
        "raises the mean by 0.4 mV in R18 (at most 3.8 mV",
        "RV1's wiper",
        "against ground (TP5)",
        "anticlockwise",
        "the noted level + 17 mV",
        "the hysteresis lowers the reading by about 4 mV",
        "of which 0.1 mV are compensated at the threshold if both inputs draw the same current",
        "If S is still high at the end stop, this level is negative: note the reading at the end stop",
        "S is an active-low logic output: low while slip is detected, and pulled up to +5 V by R21 (4.7k)",
        "S: slip output, low (asserted) while slip is detected, else +5 V",
        "level shifter",
    ):
        assert expected in text
    assert "against M or TP5, not against ground" in readme("board.variant=comparator", "board.supply=single")
    assert "R21" not in readme("board.variant=precision")


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_states_the_load_of_each_amplifier(name: str) -> None:
    changes = BOARD_CONFIGURATIONS[name].changes
    text, loads = readme(*changes), board_values(load_article(changes)).amplifier_loads
    is_article = name.startswith("article")
    assert [load.amplifier for load in loads] == ["U1a", "U1b", "U2", *(() if is_article else ("U3a", "U3b"))]
    for load in loads:
        figures = f"{format_figure(load.min_ohm, 3)} ohm ({format_figure(1e3 * load.max_current_a, 2)} mA)"
        assert f"{load.amplifier} {figures}" in text
    assert ("U1b also charges C4 through D1" in text) == is_article
    assert ("U3a drives R16 and R17 through D1" in text) != is_article
    assert ("The load of U5, which buffers VMID, is not included." in text) == name.endswith("single")
    assert ("The loads of U5 and U6, which buffer VMID and VREF, are not included." in text) == name.endswith("3v3")
    assert "2 kohm" not in text  # the output swing is that into 10 kohm


@pytest.mark.full
def test_readme_states_the_leakage_of_both_clamps() -> None:
    text, precision = readme(), readme("board.variant=precision")
    assert "D2 shifts E in R7 and R6, and D3 shifts T in R8 and R9" in text
    assert "at most 1.2 mV and 1.1 mV, with 2 uA (maximum of a BAT54; unverified) 24 mV and 22 mV" in text
    assert "D2 shifts E in R7, and D3 shifts T in R8 and R9" in precision
    assert "at most 1.0 mV and 1.1 mV, with 2 uA (maximum of a BAT54; unverified) 20 mV and 22 mV" in precision
    assert "E, which lies near ground, is shifted upwards. At T both diodes block" in text
    assert "Both diodes of each clamp block" in readme("board.supply=single")


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_roles_name_what_the_connectors_and_capacitors_of_a_board_do(name: str) -> None:
    text = readme(*BOARD_CONFIGURATIONS[name].changes)
    slip, signal_ground = name.startswith("comparator"), "single" in name
    assert ("bridge's supply: buffer" in text) == ("3v3" in name)
    if "3v3" in name:
        signals = "tactile voltage, filtered signal, envelope, signal ground" + ", slip output" * slip
        assert f"to the controller: {signals}; ground between |" in text
        return
    signals = "tactile voltage, envelope, ground" + ", slip output" * slip + ", signal ground" * signal_ground
    assert f"to the ADC: {signals} |" in text
    assert ("plus supply, at U" in text) == (not signal_ground)
    assert "anti-aliasing filter, envelope" in text
    assert ("mid-supply: buffer" in text) == signal_ground
