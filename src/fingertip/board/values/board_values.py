"""All component values of a board, computed from a design: ideal and preferred values, and what they achieve."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from fingertip.board.errata import ERRATA, Erratum
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.adc_interface import (
    AdcInterface,
    AliasAttenuation,
    compute_alias_attenuation,
    size_adc_interface,
)
from fingertip.board.values.amplifiers import AMPLIFIERS, select_dual_amplifier
from fingertip.board.values.bridge import Bridge, size_bridge
from fingertip.board.values.comparator_stage import ComparatorStage, size_comparator
from fingertip.board.values.component_selection import select_capacitors, select_resistors
from fingertip.board.values.ideal_response import FrequencyResponse, ideal_response
from fingertip.board.values.noise_and_ripple import (
    NoiseLevels,
    SupplyRipple,
    compute_noise_levels,
    compute_supply_ripple,
)
from fingertip.board.values.nonideal_response import (
    FirstStageCapacitors,
    filter_transfer,
    nonideal_response,
    select_first_stage_capacitors,
)
from fingertip.board.values.output_offset import OutputOffset, compute_output_offset
from fingertip.board.values.voltage_limits import VoltageLimits, compute_output_swing, compute_voltage_limits
from fingertip.design import Design
from fingertip.design.filter_components import FilterComponents, ideal_components
from fingertip.design.parameters import Board


@dataclass(frozen=True)
class Tolerance:
    """Tolerances of the filter's components, for the bill of materials and the analysis."""

    resistor_percent: float
    capacitor_percent: float


@dataclass(frozen=True)
class BoardValues:
    """Component values of one design's board, and the resulting response, noise and limits."""

    variant: str
    """Name of the board's variant."""
    supply: str
    """Name of the supply: split or single."""
    amplifier: str
    """Dual amplifier of filter and rectifier."""
    ideal: FilterComponents
    """Values by the formulas (article, eqs. 2, 5, 6, 7, 11)."""
    preferred: FilterComponents
    """Values that are fitted: resistors of the design's series; capacitors as in the design, or of their own series."""
    tolerance: Tolerance
    target_response: FrequencyResponse
    """Response of the ideal values."""
    achieved_response: FrequencyResponse
    """Response of the preferred values; gain and both cutoffs from the circuit with all its components."""
    bridge: Bridge
    """Preferred values of the bridge ahead of the filter."""
    first_stage_capacitors: FirstStageCapacitors | None
    """Capacitors of the first stage that variant article does not have; None there."""
    output_offset: OutputOffset | None
    """Envelope offset due to the amplifiers' offsets; None in variant article: it is below the diode's threshold."""
    supply_ripple: SupplyRipple
    """Effect of ripple on the supply."""
    noise: NoiseLevels
    """Noise of the bridge and its amplifier, and the mean envelope due to it."""
    comparator_stage: ComparatorStage | None
    """Values around the comparator; None in variants without one."""
    adc_interface: AdcInterface
    """Values of the anti-aliasing poles."""
    aliasing: AliasAttenuation
    """Attenuation of the frequencies that alias."""
    voltage_limits: VoltageLimits
    """Levels at which the signals clip."""
    errata: tuple[Erratum, ...] = ERRATA
    """Errata of the article; the same for every design."""

    def as_data(self) -> dict[str, Any]:
        """Return plain mappings and lists for JSON. Keys contain their units."""
        plain: dict[str, Any] = _round_to_ten_digits(asdict(self))
        return plain


def _round_to_ten_digits(data: Any) -> Any:
    """Round all numbers of plain data to ten significant digits: their last bits differ between processors."""
    if isinstance(data, dict):
        return {key: _round_to_ten_digits(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_round_to_ten_digits(value) for value in data]
    return float(f"{data:.10g}") if isinstance(data, float) else data


def filter_values(board: Board) -> tuple[FilterComponents, FilterComponents, FrequencyResponse]:
    """Compute the filter alone: ideal components, preferred components and the response these achieve.

    Raises as `board_values` does.
    """
    ideal = ideal_components(select_capacitors(board))
    preferred = select_resistors(ideal, board.series)
    capacitors = _first_stage_capacitors(board, preferred)
    return ideal, preferred, nonideal_response(preferred, board.gain_bandwidth_hz, capacitors)


def _first_stage_capacitors(board: Board, preferred: FilterComponents) -> FirstStageCapacitors | None:
    return None if board.variant == "article" else select_first_stage_capacitors(preferred, board.band_limit_hz)


def _target_response(board: Board, ideal: FilterComponents) -> FrequencyResponse:
    response = ideal_response(ideal, board.gain_bandwidth_hz)
    return response if board.variant == "article" else replace(response, upper_cutoff_hz=board.band_limit_hz)


def board_values(design: Design) -> BoardValues:
    """Compute the board's values.

    Raises
    ------
    BoardError
        If a resistor has no preferred value, which does not occur for a validated design.
    """
    board, detector = design.board, design.detector
    supply, supply_v = SUPPLIES[board.supply], board.supply_v
    has_diode = board.variant == "article"

    ideal, preferred, achieved = filter_values(board)
    capacitors = _first_stage_capacitors(board, preferred)
    bridge = size_bridge(
        supply_v, board.series, design.dimensions.sensor.active_diameter_mm, supply.signal_ground_ratio
    )
    adc_interface = size_adc_interface(detector.sample_rate_hz, board.series)
    amplifier = select_dual_amplifier(board.variant, board.supply)
    swing = compute_output_swing(AMPLIFIERS[amplifier], supply, supply_v)
    limits = compute_voltage_limits(
        bridge, supply, supply_v, swing, achieved.passband_gain, has_diode, detector.adc_range_v
    )

    def transfer(f_hz: float) -> complex:
        return filter_transfer(f_hz, preferred, board.gain_bandwidth_hz, capacitors)

    def transfer_without_limit(f_hz: float) -> complex:
        return filter_transfer(
            f_hz, preferred, board.gain_bandwidth_hz, capacitors and replace(capacitors, limiting_capacitor_f=0.0)
        )

    comparator_stage = None
    if board.variant == "comparator":
        window_s = detector.window_samples / detector.sample_rate_hz
        comparator_stage = size_comparator(
            detector.threshold_v, window_s, supply_v, board.series, supply.signal_ground_ratio
        )
    return BoardValues(
        variant=board.variant,
        supply=supply.name,
        amplifier=amplifier,
        ideal=ideal,
        preferred=preferred,
        tolerance=Tolerance(board.resistor_tolerance_percent, board.capacitor_tolerance_percent),
        target_response=_target_response(board, ideal),
        achieved_response=achieved,
        bridge=bridge,
        first_stage_capacitors=capacitors,
        output_offset=None if has_diode else compute_output_offset(AMPLIFIERS[amplifier], preferred.r_lp_ohm),
        supply_ripple=compute_supply_ripple(bridge, transfer, detector.threshold_v, has_diode),
        noise=compute_noise_levels(bridge, transfer, transfer_without_limit, has_diode),
        comparator_stage=comparator_stage,
        adc_interface=adc_interface,
        aliasing=compute_alias_attenuation(
            adc_interface, detector.sample_rate_hz, detector.adc_bits, detector.adc_range_v, board.cutoff_hz,
            limits.filter_peak_v, None if has_diode else achieved.envelope_pole_hz,
        ),
        voltage_limits=limits,
    )  # fmt: skip
