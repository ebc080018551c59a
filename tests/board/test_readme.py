"""The README of a board's folder: supply, passband, amplifiers, ADC range, envelope offset and trimming procedure."""

from __future__ import annotations

import pytest

from fingertip.board import board_files, board_values
from fingertip.board.variants import BOARD_CONFIGURATIONS
from fingertip.design import Design


def readme(*changes: str) -> str:
    """README of a board's folder, without line breaks."""
    return " ".join(board_files(Design.load(changes=changes))["README.md"].decode().split())


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_states_the_requirements_on_the_supply(name: str) -> None:
    text, ripple = (
        readme(*BOARD_CONFIGURATIONS[name].changes),
        board_values(Design.load(changes=BOARD_CONFIGURATIONS[name].changes)).supply_ripple,
    )
    assert "a reversed supply destroys it" in text
    assert f"amplified {ripple.gain:.0f} times" in text
    assert f"must stay below {1e3 * ripple.max_v:.2g} mV" in text
    assert "linear regulator" in text
    assert "no filter for the bridge's supply" in text.split("Known limitations")[1]


@pytest.mark.slow
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_states_the_passband_of_the_board(name: str) -> None:
    changes = (*BOARD_CONFIGURATIONS[name].changes, "board.band_limit_hz=210")
    achieved = board_values(Design.load(changes=changes)).achieved_response
    cutoffs = "67.25 Hz and 44494 Hz" if name.startswith("article") else "63.59 Hz and 293.28 Hz"
    assert f"-3 dB at {cutoffs}" in readme(*changes)
    assert f"gain {achieved.passband_gain:.2f}" in readme(*changes)


@pytest.mark.slow
def test_readme_states_the_limited_input_range_of_the_tl082_only() -> None:
    for name, variant in BOARD_CONFIGURATIONS.items():
        text = readme(*variant.changes)
        assert ("3.5 V up but only 2.0 V down (typical; 1.0 V guaranteed)" in text) == (name == "article_split")
        assert ("TLV2372, with rail-to-rail inputs and outputs" in text) == (name != "article_split")


@pytest.mark.parametrize("supply", ["split", "single"])
def test_readme_states_whether_the_adc_range_is_sufficient(supply: str) -> None:
    assert "An ADC with a range of plus and minus 10 V covers all signals" in readme(f"board.supply={supply}")
    small = readme(f"board.supply={supply}", "detector.adc_range_v=3.3")
    assert "An ADC with a range of plus and minus 3.3 V clips the top" in small
    assert "covers all signals" not in small


@pytest.mark.parametrize(("supply", "signal_ground"), [("split", "GND"), ("single", "VMID")])
def test_readme_lists_the_test_points(supply: str, signal_ground: str) -> None:
    text = readme(f"board.supply={supply}")
    nets = ("TACTILE", "STAGE1_OUT", "FILTERED", "ENVELOPE", signal_ground)
    assert all(f"| TP{number} | {net} |" in text for number, net in enumerate(nets, start=1))


@pytest.mark.slow
def test_readme_describes_the_envelope_offset_except_in_variant_article() -> None:
    assert "Envelope offset" not in readme()
    for variant in ("precision", "comparator"):
        text = readme(f"board.variant={variant}")
        assert "envelope offset lies between -6.0 and +22.5 mV" in text
        assert "design's threshold is 17 mV" in text
    single = readme("board.variant=precision", "board.supply=single")
    assert "Measure the envelope offset with nothing touching the sensor: E against M" in single


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
        "R21 (4.7k) pulls S up to +5 V",
        "S: slip output, low (asserted) while slip is detected, else +5 V",
        "level shifter",
    ):
        assert expected in text
    assert "against M or TP5, not against ground" in readme("board.variant=comparator", "board.supply=single")
    assert "R21" not in readme("board.variant=precision")
