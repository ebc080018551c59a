"""The README of a board's folder says what its board does: signals, supply, rest level, threshold."""

from __future__ import annotations

import pytest

from fingertip.board import board_files, board_values
from fingertip.board.variants import VARIANTS
from fingertip.design import Design


def readme(*changes: str) -> str:
    """As one line."""
    return " ".join(board_files(Design.load(changes=changes))["README.md"].decode().split())


@pytest.mark.parametrize("name", VARIANTS)
def test_every_board_says_what_its_supply_must_be(name: str) -> None:
    text, ripple = readme(*VARIANTS[name].changes), board_values(Design.load(changes=VARIANTS[name].changes)).ripple
    assert "Nothing protects the board from a supply the wrong way round" in text
    assert f"{ripple.gain:.0f} times as large" in text
    assert f"must stay below {1e3 * ripple.max_v:.2g} mV" in text
    assert "linear regulator" in text
    assert "A filter for the bridge's supply" in text.split("Known to be missing")[1]


@pytest.mark.parametrize("name", VARIANTS)
def test_the_passband_is_the_boards_own(name: str) -> None:
    changes = (*VARIANTS[name].changes, "board.band_limit_hz=210")
    achieved = board_values(Design.load(changes=changes)).achieved
    wanted = "67.25 Hz and 44347 Hz" if name.startswith("article") else "63.59 Hz and 293.28 Hz"
    assert f"3 dB less at {wanted}" in readme(*changes)
    assert f"gain {achieved.passband_gain:.2f}" in readme(*changes)


def test_only_the_tl082_is_said_to_end_early() -> None:
    for name, variant in VARIANTS.items():
        text = readme(*variant.changes)
        assert ("3.5 V up but only 2.0 V down (1.0 V to be sure)" in text) == (name == "article_split")
        assert ("TLV2372, whose inputs and outputs reach both rails" in text) == (name != "article_split")


@pytest.mark.parametrize("supply", ["split", "single"])
def test_a_converter_that_is_too_small_is_said(supply: str) -> None:
    assert "a converter for plus and minus 10 V takes all of it" in readme(f"board.supply={supply}")
    small = readme(f"board.supply={supply}", "detector.adc_range_v=3.3")
    assert "a converter for plus and minus 3.3 V cuts the last" in small
    assert "takes all of it" not in small


def test_the_rest_is_to_be_measured_where_no_diode_hides_it() -> None:
    assert "rest level" not in readme()
    for variant in ("precision", "comparator"):
        text = readme(f"board.variant={variant}")
        assert "rests anywhere between -6.0 and + 22.5 mV" in text
        assert "design's threshold is 17 mV" in text
    single = readme("board.variant=precision", "board.supply=single")
    assert "measure the rest, nothing touching the sensor: E against M" in single


def test_the_comparators_procedure() -> None:
    text = readme("board.variant=comparator")
    for words in (
        "S goes low where E's mean rises above 16.9 mV and high again below 12.4 mV", "RV1's middle pin",
        "against ground (TP5)", "counterclockwise", "that reading + 17 mV", "lifts the mean by 0.4 mV in R18 (3.8 mV",
        "S rests at + 5 V, through R21 (4.7k)", "S: low while it slips, else + 5 V", "level shifter",
    ):  # fmt: skip
        assert words in text
    assert "against M or TP5, not against ground" in readme("board.variant=comparator", "board.supply=single")
    assert "R21" not in readme("board.variant=precision")
