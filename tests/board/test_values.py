"""From a design to ideal, preferred and achieved values, and the rules between the board's parameters."""

from __future__ import annotations

import functools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingertip.board import board_circuit, board_values
from fingertip.board.circuit import Circuit, farads_or_ohms
from fingertip.board.layout.tracks import fingerprint
from fingertip.board.values.filters import response
from fingertip.board.values.ripple import DEAD_ZONE_V
from fingertip.board.variants import VARIANTS
from fingertip.design import Design
from fingertip.design.filter_components import MAX_OHM, MIN_OHM, Components
from fingertip.errors import DesignError


def resistors(c: Components) -> tuple[float, ...]:
    return (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)


def test_defaults_are_the_articles() -> None:
    values = board_values(Design())
    assert values.preferred == Components(2400.0, 1200.0, 4700.0, 1500.0, 100e3, 2000.0, 1e-6, 2.2e-6)
    formulas = response(values.preferred, 3e6)
    assert values.achieved.section_quality == formulas.section_quality
    # From the circuit: the amplifier's finite gain takes half a thousandth.
    assert values.achieved.passband_gain == pytest.approx(formulas.passband_gain, rel=1e-3)
    assert values.achieved.cutoff_hz == pytest.approx(formulas.cutoff_hz, rel=2e-4)
    assert values.wanted.cutoff_hz == pytest.approx(67, rel=1e-12)
    assert round(formulas.cutoff_hz, 2) == 67.26


def test_finer_series_come_nearer() -> None:
    cutoff = {s: board_values(Design.load(changes=[f"board.series={s}"])).achieved for s in ("E12", "E24", "E96")}
    assert round(cutoff["E96"].cutoff_hz, 2) == 67.06
    assert round(cutoff["E96"].section_quality, 3) == 1.003
    error = [abs(math.log(cutoff[s].cutoff_hz / 67)) for s in ("E12", "E24", "E96")]
    assert error == sorted(error, reverse=True)


def test_findings_are_sentences_with_both_sides() -> None:
    findings = board_values(Design()).findings
    assert len(findings) == len({f.subject for f in findings}) >= 7
    assert all(f.says and f.right and f.says != f.right for f in findings)
    said = " ".join(f.right for f in findings)
    formulas, found = response(board_values(Design()).preferred, 3e6), board_values(Design()).limits
    for figure in (
        f"{formulas.passband_gain:.2f}",
        f"{formulas.passband_gain_db:.2f} dB",
        f"{formulas.section_hz:.2f} Hz",
        f"{formulas.section_quality:.4f}",
        f"{formulas.first_pole_hz:.2f} Hz",
        f"{formulas.cutoff_hz:.2f} Hz",
        f"{1e3 * formulas.envelope_decay_s:.2f} ms",
        f"{3 * formulas.passband_gain:.0f} mV",  # 3 mV of offset
        f"{1e3 * DEAD_ZONE_V / formulas.passband_gain:.1f} mV",  # the diode's at the input
        f"-{found.filter_trough_v:.0f} V (-{found.filter_sure_trough_v:.0f} V to be sure)",
    ):
        assert figure in said


def attempt(board: dict[str, object]) -> tuple[Design | None, set[str]]:
    """A design with this board, or the fields for which it is refused."""
    try:
        return Design(board=board), set()
    except DesignError as error:
        return None, {issue.field for issue in error.issues}


def decades(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: float(10.0**exponent))


@settings(deadline=None)
@given(
    decades(-2.0, 4.0), decades(-6.0, 3.0), decades(-2.0, 3.0).map(lambda g: 1.0 + g), decades(3.0, 7.0),
    decades(-2.0, 4.0), decades(-6.0, 3.0), decades(4.0, 9.0), st.sampled_from(["E12", "E24", "E96"]),
    st.sampled_from(["given", "E6", "E12"]), st.sampled_from(sorted(VARIANTS)), decades(1.0, 5.0), st.floats(5.0, 6.0),
)  # fmt: skip
def test_every_accepted_design_has_a_board(
    f: float, c: float, gain: float, r5: float, f_lp: float, c_lp: float, gbw: float, series: str, capacitors: str,
    name: str, limit: float, supply_v: float,
) -> None:  # fmt: skip
    variant, supply = name.split("_")
    board = {
        "cutoff_hz": f, "capacitor_uf": c, "passband_gain": gain, "r5_ohm": r5, "envelope_cutoff_hz": f_lp,
        "envelope_capacitor_uf": c_lp, "gain_bandwidth_hz": gbw, "series": series, "capacitor_series": capacitors,
        "variant": variant, "supply": supply, "band_limit_hz": limit, "supply_v": supply_v,
    }  # fmt: skip
    design, refused = attempt(board)
    assert {field.split(".")[0] for field in refused} <= {"board", "detector"}
    if design is None:
        return
    values = board_values(design)
    assert all(MIN_OHM <= r <= MAX_OHM for r in resistors(values.ideal) + resistors(values.preferred))
    # Half a step of E12 in every resistor is 10.6%, and the cutoff moves by no more.
    assert abs(math.log(values.achieved.section_hz / f)) < 0.12
    circuit = board_circuit(values)
    fitted = {p.reference: farads_or_ohms(p.value) for p in circuit.parts if p.symbol.name in ("R", "C")}
    assert all(1e-12 <= v <= 1e-3 for reference, v in fitted.items() if reference[0] == "C")
    assert all(10 <= v <= 10e6 for reference, v in fitted.items() if reference[0] == "R")
    assert values.limits.bridge_amplifier_margin_v > 0
    assert fingerprint(circuit, VARIANTS[name].placement) == fingerprint(nominal(name), VARIANTS[name].placement)


@functools.cache
def nominal(name: str) -> Circuit:
    return board_circuit(board_values(Design.load(changes=VARIANTS[name].changes)))


REFUSED = {
    "board.capacitor_uf=1000": ("board.capacitor_uf", "at most 10 uF"),
    "board.capacitor_uf=10.1": ("board.capacitor_uf", "1206, X7R for 16 V); at most 10 uF"),
    "board.envelope_capacitor_uf=100": ("board.envelope_capacitor_uf", "place of C4 holds"),
    "board.capacitor_uf=1e-6": ("board.capacitor_uf", "at least 0.0004751 uF"),
    "board.cutoff_hz=1e-9": ("board.capacitor_uf", "raise board.cutoff_hz"),
    "board.cutoff_hz=1e-310": ("board.capacitor_uf", "raise board.cutoff_hz"),
    "board.envelope_capacitor_uf=1e-6": ("board.envelope_capacitor_uf", "above 10 Mohm"),
    "board.envelope_cutoff_hz=10000": ("board.envelope_capacitor_uf", "below 10 ohm"),
    "board.passband_gain=1.001": ("board.passband_gain", "at least 1.01"),
    "board.passband_gain=10000": ("board.gain_bandwidth_hz", "at least 6.7e+06 Hz"),
    "board.cutoff_hz=0": ("board.cutoff_hz", "0"),
    "board.cutoff_hz=-67": ("board.cutoff_hz", "-67"),
    "board.cutoff_hz=5000": ("board.gain_bandwidth_hz", "at least 3.384e+06 Hz"),
    "board.capacitor_uf=0.9e-6": ("board.capacitor_uf", "1e-06"),
    "board.capacitor_uf=1001": ("board.capacitor_uf", "1000"),
    "board.series=E48": ("board.series", "E96"),
    "board.capacitor_series=E24": ("board.capacitor_series", "E12"),
    "board.supply=usb": ("board.supply", "single"),
    "board.variant=digital": ("board.variant", "precision"),
    "board.supply_v=3.3": ("board.supply_v", "5"),
    "board.gain_bandwidth_hz=10000": ("board.gain_bandwidth_hz", "lower board.passband_gain"),
}


@pytest.mark.parametrize("change", REFUSED)
def test_refused_with_bound_and_remedy(change: str) -> None:
    field, remedy = REFUSED[change]
    with pytest.raises(DesignError) as caught:
        Design.load(changes=[change])
    sentences = {issue.field: issue.message for issue in caught.value.issues if issue.field.startswith("board.")}
    assert list(sentences) == [field]
    assert remedy in sentences[field]


@pytest.mark.parametrize(
    "change",
    ["board.capacitor_uf=10", "board.envelope_capacitor_uf=10", "board.capacitor_uf=0.0004751",
     "board.passband_gain=1.01", "board.gain_bandwidth_hz=4.534e4"],
)  # fmt: skip
def test_printed_bounds_pass(change: str) -> None:
    assert board_values(Design.load(changes=[change]))


def test_gain_of_a_small_r5() -> None:
    with pytest.raises(DesignError, match=r"R4 of 0\.1 ohm, below 10 ohm; at most 101 with"):
        Design.load(changes=["board.r5_ohm=1000", "board.passband_gain=1e4"])


def test_faults_of_the_parts_and_of_the_board_come_together() -> None:
    with pytest.raises(DesignError) as caught:
        Design.load(changes=["board.capacitor_uf=1000", "skin.tip_length_mm=33", "board.series=E6"])
    fields = {issue.field for issue in caught.value.issues}
    assert {"board.capacitor_uf", "skin.tip_length_mm", "board.series"} <= fields


def test_precision_needs_a_series_capacitor_that_exists() -> None:
    changes = ["board.variant=precision", "board.r5_ohm=10000"]
    with pytest.raises(
        DesignError, match=r"above 100 uF; at least 1\.584e\+04 ohm, or board\.variant=article"
    ) as caught:
        Design.load(changes=changes)
    assert [issue.field for issue in caught.value.issues] == ["board.r5_ohm"]
    assert Design.load(changes=[changes[0], "board.r5_ohm=1.584e4"])
    assert Design.load(changes=changes[1:])


def test_threshold_outside_the_supply() -> None:
    with pytest.raises(DesignError, match=r"6 V is never reached by a board supplied with 5 V; at most 4\.95 V"):
        Design.load(changes=["detector.threshold_v=6"])


def test_threshold_outside_a_single_supply() -> None:
    with pytest.raises(DesignError, match=r"supplied with 5 V, whose signals rest at 2\.5 V; at most 2\.475 V"):
        Design.load(changes=["detector.threshold_v=2.5", "board.supply=single"])
    assert Design.load(changes=["detector.threshold_v=2.475", "board.supply=single"])
    assert Design.load(changes=["detector.threshold_v=2.5"])
    with pytest.raises(DesignError, match=r"0\.011 to 0\.625 V with this supply"):
        Design.load(changes=["detector.threshold_v=0.7", "board.supply=single", "board.variant=comparator"])


@pytest.mark.parametrize("variant", ["precision", "comparator"])
@pytest.mark.parametrize(
    ("changes", "sentence", "passing"),
    [
        (["board.band_limit_hz=200"], "3 cutoffs of 67 Hz; at least 201 Hz", "board.band_limit_hz=201"),
        (
            ["board.band_limit_hz=9000", "board.r5_ohm=10e6"],
            "asks for 1.768 pF across it, below 10 pF; at most 1591 Hz with this r5_ohm",
            "board.band_limit_hz=1591",
        ),
        (
            ["board.band_limit_hz=31", "board.cutoff_hz=10", "board.r5_ohm=2000", "board.passband_gain=2"],
            "asks for 2.567e+06 pF across it, above 1e+06 pF; at least 79.58 Hz with this r5_ohm",
            "board.band_limit_hz=79.58",
        ),
    ],
)
def test_band_limits_that_cannot_be(variant: str, changes: list[str], sentence: str, passing: str) -> None:
    with pytest.raises(DesignError) as caught:
        Design.load(changes=[f"board.variant={variant}", *changes])
    assert [issue.field for issue in caught.value.issues] == ["board.band_limit_hz"]
    assert sentence in str(caught.value)
    assert Design.load(changes=[f"board.variant={variant}", *changes, passing])
    assert Design.load(changes=changes)  # variant article has none


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("board.supply_v=6", "board.supply_v: 6 V is too much for variant comparator's LMV331; at most 5.5 V."),
        ("detector.threshold_v=0.005", "0.011 to 1.25 V with this supply"),
        ("detector.threshold_v=2", "0.011 to 1.25 V with this supply"),
    ],
)
def test_comparators_bounds(change: str, sentence: str) -> None:
    with pytest.raises(DesignError) as caught:
        Design.load(changes=["board.variant=comparator", change])
    assert len(caught.value.issues) == 1
    assert sentence in str(caught.value)
    assert Design.load(changes=[change])


@pytest.mark.parametrize("threshold", ["0.011", "1.25"])
@pytest.mark.parametrize("series", ["E12", "E96"])
@pytest.mark.parametrize("supply", ["split", "single"])
def test_comparator_values_stay_within_range(threshold: str, series: str, supply: str) -> None:
    if supply == "single" and threshold == "1.25":
        threshold = "0.625"
    changes = ["board.variant=comparator", f"detector.threshold_v={threshold}", f"board.series={series}"]
    decision = board_values(Design.load(changes=[*changes, f"board.supply={supply}"])).decision
    assert decision is not None
    for ohm in (decision.mean_ohm, decision.top_ohm, decision.hysteresis_ohm):
        assert MIN_OHM <= ohm <= MAX_OHM
    # ON is the design's threshold, to half the series' step; OFF a quarter below, as the series lets it.
    assert decision.on_v == pytest.approx(float(threshold), rel=0.06 if series == "E12" else 0.01)
    assert (decision.on_v - decision.off_v) / float(threshold) == pytest.approx(0.25, rel=0.25)
    assert decision.max_on_v > 1.7 * float(threshold)


@pytest.mark.parametrize("window", [1, 10, 60, 136])
def test_the_mean_lags_half_the_window_and_bears_the_comparators_current(window: int) -> None:
    changes = ["board.variant=comparator", f"detector.window_samples={window}"]
    decision = board_values(Design.load(changes=changes)).decision
    assert decision is not None
    assert decision.mean_s == pytest.approx(window / 2000 / 2, rel=0.05)
    assert decision.max_bias_v == 250e-9 * decision.mean_ohm < 0.55 * 0.017
    assert decision.mean_f <= 1e-6
    if window == 60:
        assert (decision.mean_ohm, decision.mean_f) == (15e3, 1e-6)


def test_a_window_too_long_for_the_comparator() -> None:
    changes = ["board.variant=comparator", "detector.window_samples=2000"]
    with pytest.raises(DesignError, match=r"mean of 5e\+05 ohm, .* make 125 mV, .* at most 136 samples") as caught:
        Design.load(changes=changes)
    assert [issue.field for issue in caught.value.issues] == ["detector.window_samples"]
    assert Design.load(changes=[changes[0], "detector.window_samples=136"])
    with pytest.raises(DesignError, match="at most 136 samples"):
        Design.load(changes=[changes[0], "detector.window_samples=137"])
    assert Design.load(changes=[changes[0], "detector.window_samples=137", "detector.threshold_v=0.018"])
    assert Design.load(changes=changes[1:])
