"""Ideal, preferred and achieved values of a design, and the rules between the board's parameters."""

from __future__ import annotations

import math
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.board_values import load_errata
from fingertip.board.analysis.interference import DEAD_ZONE_V
from fingertip.board.analysis.response import decibel
from fingertip.board.components.selection import compute_deviation_db
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import parse_component_value
from fingertip.catalogues.amplifiers import AmplifierName
from fingertip.design import Design
from fingertip.design.formulas.filter import MAX_OHM, MIN_OHM, FilterComponents, find_preferred_neighbours
from fingertip.design.rules.amplifiers import SUPPLY_RANGES_V
from fingertip.foundation.errors import DesignError
from tests.designs import ARTICLE, article_design, load_article
from tests.oracles.filter_formulas import (
    ideal_cutoff_hz,
    passband_gain,
    pole_hz,
    section_frequency_hz,
    section_quality,
)


def resistances(c: FilterComponents) -> tuple[float, ...]:
    """All resistances of the filter [ohm]."""
    return (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)


def test_default_values_are_the_articles() -> None:
    values = board_values(ARTICLE)
    assert values.preferred == FilterComponents(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
    c = values.preferred
    assert values.achieved_response.section_quality == pytest.approx(section_quality(c), rel=1e-12)
    # Computed from the circuit: the amplifier's finite gain reduces the gain by half a thousandth.
    assert values.achieved_response.passband_gain == pytest.approx(passband_gain(c), rel=1e-3)
    assert values.achieved_response.cutoff_hz == pytest.approx(ideal_cutoff_hz(c), rel=2e-4)
    assert values.target_response.cutoff_hz == pytest.approx(67, rel=1e-12)
    assert round(ideal_cutoff_hz(c), 2) == 67.26


def test_finer_series_come_nearer() -> None:
    cutoff = {s: board_values(load_article([f"board.series={s}"])).achieved_response for s in ("E12", "E24", "E96")}
    assert round(cutoff["E96"].cutoff_hz, 2) == 67.07
    assert round(cutoff["E96"].section_quality, 3) == 1.003
    error = [abs(math.log(cutoff[s].cutoff_hz / 67)) for s in ("E12", "E24", "E96")]
    assert error == sorted(error, reverse=True)


def test_errata_agree_with_the_computed_figures() -> None:
    values = board_values(ARTICLE)
    errata, limits = values.errata, values.voltage_limits
    assert errata == load_errata()  # all of them apply to the article's board
    assert len(errata) == len({erratum.subject for erratum in errata}) >= 7
    assert all(e.statement and e.correction and e.statement != e.correction for e in errata)
    corrections = " ".join(erratum.correction for erratum in errata)
    c = values.preferred
    for figure in (
        f"{passband_gain(c):.2f}",
        f"{decibel(passband_gain(c)):.2f} dB",
        f"{section_frequency_hz(c):.2f} Hz",
        f"{section_quality(c):.4f}",
        f"{pole_hz(c.r1_ohm, c.c_f):.2f} Hz",
        f"{ideal_cutoff_hz(c):.2f} Hz",
        f"{1e3 * values.achieved_response.envelope_decay_s:.2f} ms",
        f"{3 * passband_gain(c):.0f} mV",  # 3 mV of offset
        f"{1e3 * DEAD_ZONE_V / passband_gain(c):.1f} mV",  # the diode's dead zone, referred to the input
        f"-{limits.filter_trough_v:.0f} V (guaranteed: -{limits.filter_guaranteed_trough_v:.0f} V)",
    ):
        assert figure in corrections


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_errata_that_do_not_apply_to_a_board_say_so(name: str) -> None:
    errata = board_values(load_article(BOARD_CONFIGURATIONS[name].changes)).errata
    noted = {e.subject for e in errata if "does not apply to this board" in e.correction}
    expected = set() if name == "article_split" else {"input range of the amplifiers"}
    assert noted == expected | (set() if name.startswith("article") else {"envelope, eq. (11)", "offset", "rectifier"})


def validate(board: dict[str, object]) -> tuple[Design | None, set[str]]:
    """Return a design with this board, or the fields for which it is refused."""
    try:
        return article_design(board=board), set()
    except DesignError as error:
        return None, {issue.field for issue in error.issues}


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers from 10^low to 10^high, uniform in their logarithm."""
    return st.floats(low, high).map(lambda exponent: float(10.0**exponent))


PREFERRED_UF = decades(-6.0, 3.0).map(lambda value: find_preferred_neighbours(value)[0])
AMPLIFIERS = st.sampled_from(get_args(AmplifierName))


@pytest.mark.full
@given(
    decades(-2.0, 4.0), PREFERRED_UF, decades(-2.0, 3.0).map(lambda g: 1.0 + g), decades(3.0, 7.0),
    decades(-2.0, 4.0), PREFERRED_UF, AMPLIFIERS, st.sampled_from(["E12", "E24", "E96"]),
    st.sampled_from(["given", "E6", "E12"]), st.sampled_from(sorted(BOARD_CONFIGURATIONS)), decades(1.0, 5.0),
    st.floats(0.0, 1.0),
)  # fmt: skip
def test_every_valid_design_has_a_board(
    f: float, c: float, gain: float, r5: float, f_lp: float, c_lp: float, amplifier: str, series: str, capacitors: str,
    name: str, limit: float, share: float,
) -> None:  # fmt: skip
    variant, supply = name.split("_", 1)
    low_v, high_v = SUPPLY_RANGES_V[supply]
    board = {
        "cutoff_hz": f, "capacitor_uf": c, "passband_gain": gain, "r5_ohm": r5, "envelope_cutoff_hz": f_lp,
        "envelope_capacitor_uf": c_lp, "amplifier": amplifier, "series": series, "capacitor_series": capacitors,
        "variant": variant, "supply": supply, "band_limit_hz": limit,
        "supply_v": low_v + share * (high_v - low_v),
    }  # fmt: skip
    design, refused = validate(board)
    assert {field.split(".")[0] for field in refused} <= {"board", "detector"}
    if design is None:
        return
    values = board_values(design)
    assert all(MIN_OHM <= r <= MAX_OHM for r in resistances(values.ideal) + resistances(values.preferred))
    # Chosen together, E12 deviates by 0.8 dB at most, where no resistor leaves its range.
    ohm, ideal = ((c.r1_ohm, c.r2_ohm, c.r3_ohm) for c in (values.preferred, values.ideal))
    assert compute_deviation_db(ohm, ideal) < 0.8
    circuit = board_circuit(values)
    fitted = {c.reference: parse_component_value(c.value) for c in circuit.components if c.symbol.name in ("R", "C")}
    assert all(1e-12 <= v <= 1e-3 for reference, v in fitted.items() if reference[0] == "C")
    assert all(10 <= v <= 10e6 for reference, v in fitted.items() if reference[0] == "R")
    assert values.voltage_limits.bridge_amplifier_margin_v > 0
    assert BOARD_CONFIGURATIONS[name].project.enter(circuit)


# Change -> fields of the issues it causes, and a phrase of their messages.
REFUSED = {
    "board.capacitor_uf=1000": ("board.capacitor_uf", "at most 1 uF at this cutoff"),
    "board.capacitor_uf=12": ("board.capacitor_uf", "1206, X7R for 16 V); at most 1 uF"),
    "board.capacitor_uf=1.1": (
        "board.capacitor_uf",
        "no value of series E12, in which capacitors are made; 1 or 1.2 uF",
    ),
    "board.envelope_capacitor_uf=100": ("board.envelope_capacitor_uf", "footprint of C4 holds"),
    "board.capacitor_uf=1e-6": ("board.capacitor_uf", "at least 0.00056 uF"),
    "board.cutoff_hz=1e-9": ("board.capacitor_uf", "above 10 Mohm; set board.cutoff_hz=0.03"),
    "board.cutoff_hz=1e-310": ("board.capacitor_uf", "above 10 Mohm; set board.cutoff_hz=0.03"),
    "board.envelope_capacitor_uf=1e-6": ("board.envelope_capacitor_uf", "above 10 Mohm"),
    "board.envelope_cutoff_hz=10000": ("board.envelope_cutoff_hz board.envelope_capacitor_uf", "at most 382 Hz"),
    "board.passband_gain=1.001": ("board.passband_gain board.r5_ohm", "board.passband_gain="),
    "board.passband_gain=10000": ("board.passband_gain", "at most 300"),
    "board.cutoff_hz=0": ("board.cutoff_hz", "0"),
    "board.cutoff_hz=-67": ("board.cutoff_hz", "-67"),
    "board.capacitor_uf=0.9e-6": ("board.capacitor_uf", "1e-06"),
    "board.capacitor_uf=1001": ("board.capacitor_uf", "1000"),
    "board.series=E48": ("board.series", "E96"),
    "board.capacitor_series=E24": ("board.capacitor_series", "E12"),
    "board.supply=usb": ("board.supply", "single"),
    "board.variant=digital": ("board.variant", "precision"),
    "board.supply_v=3.3": ("board.supply_v", "5"),
    "board.gain_bandwidth_hz=10000": ("board.gain_bandwidth_hz", "name the amplifier with board.amplifier=auto"),
}


@pytest.mark.parametrize("change", REFUSED)
def test_invalid_parameters_are_refused_with_a_bound_and_a_remedy(change: str) -> None:
    fields, phrase = REFUSED[change]
    with pytest.raises(DesignError) as caught:
        load_article([change])
    messages = {issue.field: issue.message for issue in caught.value.issues if issue.field.startswith("board.")}
    assert list(messages) == fields.split()
    assert phrase in " ".join(messages.values())


@pytest.mark.parametrize(
    "change",
    ["board.capacitor_uf=1", "board.envelope_capacitor_uf=3.9", "board.capacitor_uf=0.00056",
     "board.passband_gain=300", "board.r5_ohm=2500"],
)  # fmt: skip
def test_printed_bounds_are_valid(change: str) -> None:
    assert board_values(load_article([change]))


def test_r4_below_its_range_is_refused() -> None:
    with pytest.raises(DesignError, match=r"R4 of 0\.1 ohm, below 10 ohm; at most 101 with"):
        load_article(["board.r5_ohm=1000", "board.passband_gain=1e4"])


@pytest.mark.full
def test_issues_of_the_parts_and_of_the_board_are_reported_together() -> None:
    with pytest.raises(DesignError) as caught:
        load_article(["board.capacitor_uf=1000", "skin.tip_length_mm=33", "board.series=E6"])
    fields = {issue.field for issue in caught.value.issues}
    assert {"board.capacitor_uf", "skin.tip_length_mm", "board.series"} <= fields


def test_precision_refuses_a_series_capacitor_above_the_largest() -> None:
    changes = ["board.variant=precision", "board.r5_ohm=10000"]
    with pytest.raises(
        DesignError, match=r"above 100 uF; at least 1\.584e\+04 ohm, or board\.variant=article"
    ) as caught:
        load_article(changes)
    assert [issue.field for issue in caught.value.issues] == ["board.r5_ohm"]
    assert load_article([changes[0], "board.r5_ohm=1.584e4"])
    assert load_article(changes[1:])


def test_threshold_beyond_a_split_supply_is_refused() -> None:
    with pytest.raises(DesignError, match=r"6 V is never reached by a board supplied with 5 V; at most 4\.95 V"):
        load_article(["detector.threshold_v=6"])


def test_threshold_beyond_a_single_supply_is_refused() -> None:
    with pytest.raises(DesignError, match=r"whose signals have a quiescent level of 2\.5 V; at most 2\.475 V"):
        load_article(["detector.threshold_v=2.5", "board.supply=single"])
    assert load_article(["detector.threshold_v=2.475", "board.supply=single"])
    assert load_article(["detector.threshold_v=2.5"])
    with pytest.raises(DesignError, match=r"between 0\.011 and 0\.625 V with this supply"):
        load_article(["detector.threshold_v=0.7", "board.supply=single", "board.variant=comparator"])


@pytest.mark.parametrize("variant", ["precision", "comparator"])
@pytest.mark.parametrize(
    ("changes", "message", "passing"),
    [
        (["board.band_limit_hz=200"], "3 cutoffs of 67 Hz; at least 201 Hz", "board.band_limit_hz=201"),
        (
            ["board.band_limit_hz=9000", "board.r5_ohm=10e6"],
            "requires 1.768 pF across it, below 10 pF; at most 1591 Hz with this r5_ohm",
            "board.band_limit_hz=1591",
        ),
        (
            ["board.band_limit_hz=31", "board.cutoff_hz=10", "board.r5_ohm=2000", "board.passband_gain=2"],
            "requires 2.567e+06 pF across it, above 1e+06 pF; at least 79.58 Hz with this r5_ohm",
            "board.band_limit_hz=79.58",
        ),
    ],
)
def test_impossible_band_limits_are_refused(variant: str, changes: list[str], message: str, passing: str) -> None:
    with pytest.raises(DesignError) as caught:
        load_article([f"board.variant={variant}", *changes])
    assert [issue.field for issue in caught.value.issues] == ["board.band_limit_hz"]
    assert message in str(caught.value)
    assert load_article([f"board.variant={variant}", *changes, passing])
    if "board.passband_gain=2" not in changes:
        assert load_article(changes)  # variant article has no band limit


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("board.supply_v=6", "board.supply_v: 6 V is too much for variant comparator's LMV331; at most 5.5 V."),
        ("detector.threshold_v=0.005", "between 0.011 and 0.625 V with this supply"),
        ("detector.threshold_v=2", "between 0.011 and 0.625 V with this supply"),
    ],
)
def test_bounds_of_the_comparator_apply_to_its_variant_only(change: str, message: str) -> None:
    with pytest.raises(DesignError) as caught:
        load_article(["board.variant=comparator", "board.supply=single", change])
    assert len(caught.value.issues) == 1
    assert message in str(caught.value)
    assert load_article([change, "board.supply=single", "board.variant=precision"])


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_split_supply_leaves_a_margin_below_the_bridge_amplifiers_maximum(variant: str) -> None:
    """Both halves of 6 V would put 12 V across the AD623. The comparator limits a single supply too."""
    changes = [f"board.variant={variant}", "board.supply_v=6"]
    with pytest.raises(DesignError) as caught:
        load_article(changes)
    message = str(caught.value)
    assert "board.supply_v: plus and minus 6 V put 12 V across the bridge's AD623" in message
    assert "at most 5.5 V" in message
    # Variant article would also need a smaller envelope capacitor there.
    assert ("or board.supply=single" in message) == (variant == "precision")
    assert load_article([*changes, "board.supply_v=5.5"])
    if variant != "comparator":
        assert load_article([*changes, "board.supply=single", "board.envelope_capacitor_uf=1.8"])


@pytest.mark.full
@pytest.mark.parametrize("threshold", ["0.011", "1.25"])
@pytest.mark.parametrize("series", ["E12", "E96"])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_comparator_thresholds_and_resistances_stay_within_range(threshold: str, series: str, supply: str) -> None:
    if supply == "single" and threshold == "1.25":
        threshold = "0.625"
    changes = ["board.variant=comparator", f"detector.threshold_v={threshold}", f"board.series={series}"]
    values = board_values(load_article([*changes, f"board.supply={supply}"]))
    stage, levels = values.comparator_stage, values.comparator_levels
    assert stage is not None
    assert levels is not None
    for ohm in (stage.averaging_ohm, stage.trimmer_top_ohm, stage.hysteresis_ohm):
        assert MIN_OHM <= ohm <= MAX_OHM
    # ON is the design's threshold to half a step of the series; OFF is a quarter lower, as far as the series permits.
    assert levels.on_v == pytest.approx(float(threshold), rel=0.06 if series == "E12" else 0.01)
    assert (levels.on_v - levels.off_v) / float(threshold) == pytest.approx(0.25, rel=0.25)
    assert levels.max_on_v > 1.7 * float(threshold)


@pytest.mark.full
@pytest.mark.parametrize("window", [1, 10, 60, 136])
def test_averaging_low_pass_has_half_the_window_as_time_constant_and_limits_the_bias_error(window: int) -> None:
    changes = ["board.variant=comparator", f"detector.window_samples={window}"]
    values = board_values(load_article(changes))
    stage, levels = values.comparator_stage, values.comparator_levels
    assert stage is not None
    assert levels is not None
    assert levels.averaging_tau_s == pytest.approx(window / 2000 / 2, rel=0.05)
    assert levels.max_bias_v == pytest.approx(250e-9 * stage.averaging_ohm, rel=1e-9)
    assert levels.max_bias_v < 0.55 * 0.017
    assert stage.averaging_f <= 1e-6
    if window == 60:
        assert (stage.averaging_ohm, stage.averaging_f) == (15e3, 1e-6)


def test_a_window_too_long_for_the_comparator_is_refused() -> None:
    changes = ["board.variant=comparator", "detector.window_samples=2000"]
    with pytest.raises(DesignError, match=r"resistor of 5e\+05 ohm, .* drops 125 mV, .* at most 136 samples") as caught:
        load_article(changes)
    assert [issue.field for issue in caught.value.issues] == ["detector.window_samples"]
    assert load_article([changes[0], "detector.window_samples=136"])
    with pytest.raises(DesignError, match="at most 136 samples"):
        load_article([changes[0], "detector.window_samples=137"])
    assert load_article([changes[0], "detector.window_samples=137", "detector.threshold_v=0.018"])
    assert load_article(changes[1:])
