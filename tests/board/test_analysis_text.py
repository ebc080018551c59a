"""Tables of the analysis: made-up figures that lie next to a rounding edge, as printed, under the right heading."""

from __future__ import annotations

import functools
import re
from dataclasses import replace

import pytest

from fingertip.board.analysis.noise import NETS, Contribution, NoiseAlternative
from fingertip.board.analysis.report import Analysis, analyse
from fingertip.catalogues.amplifiers import CATALOGUE
from fingertip.documents.board.analysis import analysis_text
from tests.designs import load_article


@functools.cache
def analysis_of(variant: str) -> Analysis:
    return analyse(load_article([f"board.variant={variant}", "board.supply=split"]), boards=20)


def lines_of(**changes: object) -> list[str]:
    """Lines of the precision board's analysis with some of its figures replaced."""
    return analysis_text(replace(analysis_of("precision"), **changes)).splitlines()  # type: ignore[arg-type]


def find_line(lines: list[str], start: str) -> str:
    (line,) = (line for line in lines if line.strip().startswith(start))
    return line


def test_noise_is_printed_in_microvolts_to_three_digits() -> None:
    """A millionth less or more would print the other of two neighbours."""
    volts = (12.349995e-6, 12.350005e-6, 0.0, 6.06e-3)
    lines = lines_of(noise=(Contribution("U9", volts),), noise_total_v=volts)
    row = [f"{cell:>11} uV" for cell in ("12.3", "12.4", "0", "6060")]
    assert lines[1:3] == [f"  {name:26}" + "".join(row) for name in ("U9", "total")]
    assert lines[0] == f"{'RMS noise, 0.1 Hz to 1 MHz':28}" + "".join(f"{net.lower():>14}" for net in NETS)
    assert {len(line) for line in lines[:3]} == {28 + 14 * len(NETS)}


def test_offsets_are_printed_in_millivolts_under_the_same_headings() -> None:
    lines = lines_of(offset=(Contribution("U9", (12.349e-3, 12.351e-3, -0.0, -2e-3)),))
    heading = next(i for i, line in enumerate(lines) if re.match("offset  ", line))
    assert lines[heading] == f"{'offset':28}" + "".join(f"{net.lower():>14}" for net in NETS)
    assert lines[heading + 1] == f"  {'U9':26}" + "".join(f"{cell:>11} mV" for cell in ("12.3", "12.4", "0", "-2.00"))
    assert lines[heading + 2].startswith("amplifiers: ")


def test_six_contributions_of_noise_are_printed() -> None:
    noise = tuple(Contribution(f"part{i}", (1e-3,) * len(NETS)) for i in range(9))
    names = [line.split()[0] for line in lines_of(noise=noise)[1:8]]
    assert names == [*(f"part{i}" for i in range(6)), "total"]


def test_noise_ahead_of_the_rectifier_is_compared_with_the_threshold() -> None:
    items = (NoiseAlternative("with", 12.3449e-3, 2.3451e-3), NoiseAlternative("less", 12.3451e-3, 12.3449e-3))
    lines = lines_of(noise_alternatives=(*items, NoiseAlternative("none", 1e-3, None)), threshold_v=12.3449e-3)
    start = next(i for i, line in enumerate(lines) if line.startswith("noise ahead of the rectifier"))
    assert [line.split() for line in lines[start + 1 : start + 4]] == [
        ["with", "12.34", "mV", "2.35", "mV"], ["less", "12.35", "mV", "12.34", "mV"], ["none", "1.00", "mV", "-"],
    ]  # fmt: skip
    assert lines[start + 4].split()[-2:] == ["12.34", "mV"]
    assert lines_of(threshold_v=12.3451e-3)[start + 5].split()[-2:] == ["12.35", "mV"]
    assert {len(line) for line in lines[start : start + 5]} == {75}


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_each_variant_has_the_sentences_of_its_rectifier(variant: str) -> None:
    analysis = analysis_of(variant)
    text = analysis_text(analysis)
    assert ("below the diode's threshold" in text) == (variant == "article")
    assert ("cause an envelope offset" in text) == (variant != "article")
    assert ("; U3: see the envelope offset above" in text) == (variant != "article")
    assert (analysis.comparator_levels is not None) == (variant == "comparator")
    assert ("slip is ON above 16.9 mV and OFF below 12.4 mV" in text) == (variant == "comparator")


@pytest.mark.parametrize(
    ("amplifier", "exception"), [("TL082", " (TL082BC: 3 mV, its maximum)"), ("OPA2197", "")], ids=["TL082", "OPA2197"]
)
def test_offset_is_marked_where_only_its_maximum_is_known(amplifier: str, exception: str) -> None:
    assert (CATALOGUE[amplifier].offset_v == CATALOGUE[amplifier].max_offset_v) == bool(exception)
    line = find_line(lines_of(amplifier=amplifier), "amplifiers: ")
    assert line.startswith(
        f"amplifiers: typical offsets{exception}, 0.8 N on the sensor; R10 to R14: worst case of 0.1 %"
    )


def test_spread_has_a_row_for_each_quantity_and_a_column_for_each_figure() -> None:
    spread = analysis_of("precision").spread
    row = replace(
        next(iter(spread.values())), nominal=66.774, mean=67.106, deviation=2.25, low_95=62.92, high_95=71.216,
        worst_low=60.0, worst_high=75.0,
    )  # fmt: skip
    lines = lines_of(spread=dict.fromkeys(spread, row))
    start = next(i for i, line in enumerate(lines) if line.lstrip().startswith("nominal"))
    cells = ("66.77", "67.11", "2.25", "62.92", "71.22", "60", "75")
    labels = ("lower -3 dB [Hz]", "Sallen-Key Q", "maximum gain", "first pole [Hz]", "Sallen-Key f0 [Hz]")
    for label, line in zip(labels, lines[start + 1 : start + 6], strict=True):
        assert line == f"{label:20}" + "".join(f"{cell:>11}" for cell in cells)
    assert len(lines[start]) == 20 + 7 * 11


def test_cost_of_the_capacitors_is_stated_unless_they_are_the_articles() -> None:
    analysis = analysis_of("precision")
    for percent, stated in ((10.0, True), (5.0, False), (2.0, True)):
        own = {**analysis.component_percent, "C1": percent, "C2": percent, "C3": percent}
        lines = lines_of(component_percent=own)
        assert any(line.startswith("95 % of the boards") for line in lines) == stated
        assert not stated or f"with C1 to C3 of {percent:g} %; with the article's 5 %" in "\n".join(lines)


def test_sensitivities_are_printed_to_a_thousandth_and_zero_has_no_sign() -> None:
    row = {"R1": -0.2274, "R2": 0.1235, "C1": -0.0004, "C2": 1.0}
    lines = lines_of(sensitivity={"cutoff_hz": row, "passband_gain": dict.fromkeys(row, -0.0)})
    assert lines[-3:] == [
        f"{'sensitivity [%/%]':20}" + "".join(f"{name:>8}" for name in row),
        f"{'lower -3 dB [Hz]':20}" + "  -0.227   0.123   0.000   1.000",
        f"{'maximum gain':20}" + 4 * "   0.000",
    ]


def test_tolerances_are_grouped_where_they_are_alike() -> None:
    for percent, words in (
        ((1.0, 1.0, 10.0, 10.0, 10.0), "filter resistors 1 %, capacitors 10 %"),
        ((1.0, 1.0, 10.0, 5.0, 10.0), "filter resistors 1 %, C1 C3 10 %, C2 5 %"),
        ((1.0, 0.1, 5.0, 5.0, 5.0), "R1 1 %, R2 0.1 %, capacitors 5 %"),
    ):
        bought = dict(zip(("R1", "R2", "C1", "C2", "C3"), percent, strict=True))
        line = find_line(lines_of(component_percent=bought), "tolerances: ")
        assert line == f"tolerances: {words}, as in the bill of materials"


@pytest.mark.parametrize(("part", "tone", "least"), [(0.99991, "12", "0.123"), (1.00009, "13", "0.124")])
def test_tone_that_aliases_to_one_bit_is_stated_in_millivolts(part: float, tone: str, least: str) -> None:
    aliasing = replace(
        analysis_of("precision").aliasing, one_lsb_tone_v=12.5e-3 * part, lsb_v=0.1235e-3 * part, alias_hz=1799.0
    )
    line = find_line(lines_of(aliasing=aliasing), "A tone as large")
    assert (
        f"to alias to 1 LSB of the ADC ({least} mV). A tone of {tone} mV (peak) in the tactile voltage at 1799 Hz"
        in line
    )


@pytest.mark.parametrize(("volts", "figure"), [(12.3495e-3, "12.3"), (12.3505e-3, "12.4")])
def test_vibration_that_reaches_the_limits_is_stated_in_millivolts(volts: float, figure: str) -> None:
    limits = replace(analysis_of("precision").voltage_limits, vibration_peak_v=volts)
    assert f"; vibrations of {figure} mV in the tactile voltage (peak" in "\n".join(lines_of(voltage_limits=limits))
