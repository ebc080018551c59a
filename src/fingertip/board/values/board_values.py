"""The board's values: from a design to ideal, preferred and achieved."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.amplifiers import AMPLIFIERS, dual_amplifier
from fingertip.board.values.bridge import Bridge, fit_bridge
from fingertip.board.values.built import FirstStage, fit_first_stage, network
from fingertip.board.values.capacitors import fitted
from fingertip.board.values.converter import AliasFigures, Converter, alias_figures, fit_converter
from fingertip.board.values.decision import Decision, fit_decision
from fingertip.board.values.filters import Response, response
from fingertip.board.values.findings import FINDINGS, Finding
from fingertip.board.values.limits import Limits, limits, swing_of
from fingertip.board.values.passband import built_response
from fingertip.board.values.preferred import preferred_components
from fingertip.board.values.rest import Rest, rest_of
from fingertip.board.values.ripple import Ripple, ripple_of
from fingertip.board.values.white_noise import WhiteNoise, white_noise
from fingertip.design import Design
from fingertip.design.filter_components import Components, ideal_components
from fingertip.design.sections import Board


@dataclass(frozen=True)
class Tolerance:
    """Of the filter's parts: what is bought, and what the analysis reckons with."""

    resistor_percent: float
    capacitor_percent: float


@dataclass(frozen=True)
class BoardValues:
    """Component values of one design's board and what they do."""

    variant: str
    """Name of the board's variant."""
    supply: str
    """split or single."""
    amplifier: str
    """The dual amplifier of filter and rectifier."""
    ideal: Components
    """What the formulas give (article, eqs. 2, 5, 6, 7, 11)."""
    preferred: Components
    """What is fitted: resistors of the design's series; capacitors as in the design, or of their own series."""
    tolerance: Tolerance
    wanted: Response
    """The response of the ideal values."""
    achieved: Response
    """The response of the preferred values; gain and both ends of the passband from the circuit with all its parts."""
    bridge: Bridge
    """What is fitted ahead of the filter, preferred values."""
    first_stage: FirstStage | None
    """Capacitors that variant article has not; None there."""
    rest: Rest | None
    """Where the envelope rests for its amplifiers' offsets; None in variant article, whose diode hides them."""
    ripple: Ripple
    """What ripple on the supply does."""
    noise: WhiteNoise
    """What the bridge's amplifier leaves, and where the envelope rests for it."""
    decision: Decision | None
    """Around the comparator; None in variants without."""
    converter: Converter
    """Ahead of the converter."""
    alias: AliasFigures
    """What that keeps from folding back."""
    limits: Limits
    """How far the voltages go."""
    findings: tuple[Finding, ...] = FINDINGS
    """Slips of the article; the same for every design."""

    def as_data(self) -> dict[str, Any]:
        """Plain mappings and lists, for JSON. Keys carry their units."""
        plain: dict[str, Any] = _settled(asdict(self))
        return plain


def _settled(data: Any) -> Any:
    """Plain data with its numbers as they are written down: their last bits differ between processors."""
    if isinstance(data, dict):
        return {key: _settled(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_settled(value) for value in data]
    return float(f"{data:.10g}") if isinstance(data, float) else data


def filter_values(board: Board) -> tuple[Components, Components, Response]:
    """The filter alone: ideal components, those fitted, and what these achieve. Raises as `board_values` does."""
    ideal = ideal_components(fitted(board))
    preferred = preferred_components(ideal, board.series)
    return ideal, preferred, built_response(preferred, board.gain_bandwidth_hz, _first_stage(board, preferred))


def _first_stage(board: Board, preferred: Components) -> FirstStage | None:
    return None if board.variant == "article" else fit_first_stage(preferred, board.band_limit_hz)


def _wanted(board: Board, ideal: Components) -> Response:
    found = response(ideal, board.gain_bandwidth_hz)
    return found if board.variant == "article" else replace(found, upper_cutoff_hz=board.band_limit_hz)


def board_values(design: Design) -> BoardValues:
    """Compute the board's values.

    Raises
    ------
    BoardError
        If a resistor has no preferred value; a validated design does not come to that.
    """
    board, detector = design.board, design.detector
    supply, supply_v = SUPPLIES[board.supply], board.supply_v
    diameter_mm = design.dimensions.sensor.active_diameter_mm
    ideal, preferred, achieved = filter_values(board)
    bridge = fit_bridge(supply_v, board.series, diameter_mm, supply.zero_share)
    plain = board.variant == "article"
    amplifier = dual_amplifier(board.variant, board.supply)
    swing = swing_of(AMPLIFIERS[amplifier], supply, supply_v)
    found = limits(bridge, supply, supply_v, swing, achieved.passband_gain, plain, detector.adc_range_v)
    converter = fit_converter(detector.sample_rate_hz, board.series)
    extra = _first_stage(board, preferred)

    def passed(f_hz: float) -> complex:
        return network(f_hz, preferred, board.gain_bandwidth_hz, extra)

    def unlimited(f_hz: float) -> complex:
        return network(f_hz, preferred, board.gain_bandwidth_hz, extra and replace(extra, limit_f=0.0))

    decision = None
    if board.variant == "comparator":
        window_s = detector.window_samples / detector.sample_rate_hz
        decision = fit_decision(detector.threshold_v, window_s, supply_v, board.series, supply.zero_share)
    return BoardValues(
        variant=board.variant,
        supply=supply.name,
        amplifier=amplifier,
        ideal=ideal,
        preferred=preferred,
        tolerance=Tolerance(board.resistor_tolerance_percent, board.capacitor_tolerance_percent),
        wanted=_wanted(board, ideal),
        achieved=achieved,
        bridge=bridge,
        first_stage=extra,
        rest=None if plain else rest_of(AMPLIFIERS[amplifier], preferred.r_lp_ohm),
        ripple=ripple_of(bridge, passed, detector.threshold_v, plain),
        noise=white_noise(bridge, passed, unlimited, plain),
        decision=decision,
        converter=converter,
        alias=alias_figures(
            converter, detector.sample_rate_hz, detector.adc_bits, detector.adc_range_v, board.cutoff_hz,
            found.filter_peak_v, None if plain else achieved.envelope_pole_hz,
        ),
        limits=found,
    )  # fmt: skip
