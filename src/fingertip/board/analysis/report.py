"""Analysis of a design's board: Bode table of each stage, noise, offsets and tolerances. Needs numpy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.interference import DEAD_ZONE_V, AliasAttenuation, SupplyRipple, describe_supply_ripple
from fingertip.board.analysis.limits import VoltageLimits, describe_adc_range, describe_filter_swing
from fingertip.board.analysis.noise import (
    NETS,
    NOISE_BAND_HZ,
    NOISE_FORCE_N,
    Contribution,
    NoiseAlternative,
    NoisyNetwork,
    add_noise,
    compare_noise_alternatives,
    noise_budget,
)
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.thresholds import (
    ComparatorLevels,
    OutputOffset,
    describe_comparator_levels,
    describe_output_offset,
)
from fingertip.board.analysis.tolerance import (
    ARTICLE_CAPACITOR_PERCENT,
    CUTOFF_CAPACITORS,
    Spread,
    TolerancedFilter,
    component_tolerances,
    compute_sensitivities,
    monte_carlo,
    state_capacitors,
)
from fingertip.board.circuits.network import Network, Value, build_network
from fingertip.board.circuits.signal_paths import board_circuit
from fingertip.board.components.bridge import LOW_NOISE_NAME
from fingertip.board.components.values import Tolerance, select_components
from fingertip.board.parts.circuit import ADC_TACTILE, FILTERED, STAGE1_OUT, TACTILE, VCC, VEE
from fingertip.catalogues.amplifiers import CATALOGUE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation.files import format_figure

BRIDGE_RESISTORS = ("R10", "R11", "R12", "R13", "R14")
BRIDGE_TOLERANCE = 1e-3
"""Tolerance of R10 to R14, as the bill of materials specifies it."""


@dataclass(frozen=True)
class Analysis:
    """Results of the analysis of one board."""

    noise: tuple[Contribution, ...]
    """RMS noise over `NOISE_BAND_HZ`, largest first; white noise only, typical data-sheet values."""
    noise_total_v: tuple[float, ...]
    noise_alternatives: tuple[NoiseAlternative, ...]
    """Total noise of this variant and with changes that affect it, and the mean envelope due to it."""
    threshold_v: float
    """Threshold of the detector, for comparison with the mean envelope due to noise."""
    amplifier: str
    """Dual amplifier of filter and rectifier."""
    aliasing: AliasAttenuation
    voltage_limits: VoltageLimits
    output_offset: OutputOffset | None
    """Envelope offset; None in variant article."""
    supply_ripple: SupplyRipple
    comparator_levels: ComparatorLevels | None
    tolerance: Tolerance
    """Tolerances that the design states."""
    offset: tuple[Contribution, ...]
    """Contribution of each amplifier's typical offset (TL082BC: its maximum) with `NOISE_FORCE_N` on the sensor, and of
    the bridge with the worst-case resistors of 0.1 % and no force. U3 is part of `output_offset`."""
    component_percent: dict[str, float]
    """Tolerance of each component [%], as it is bought."""
    boards: int
    """Number of boards for which `spread` is computed."""
    spread: dict[str, Spread]
    article_spread: dict[str, Spread]
    """Spread with C1 to C3 of the article's tolerance, for comparison."""
    sensitivity: dict[str, dict[str, float]]

    def as_data(self) -> dict[str, Any]:
        """Return plain mappings and lists for JSON."""
        return {"nets": NETS, **asdict(self)}


def analyse(design: Design, boards: int = 10_000, seed: int = 1) -> Analysis:
    """Analyse a design's board."""
    values, board = board_values(design), design.board
    circuit = board_circuit(values)
    bandwidth_hz, has_diode = find_gain_bandwidth_hz(board), board.variant == "article"
    network = build_network(circuit, bandwidth_hz)
    model, noisy = model_filter(circuit, has_diode), add_noise(circuit, bandwidth_hz)
    toleranced = TolerancedFilter(model, network.values)
    noise, total = noise_budget(noisy)
    percent = component_tolerances(circuit)
    return Analysis(
        noise=noise,
        noise_total_v=total,
        noise_alternatives=compare_noise_alternatives(
            circuit, bandwidth_hz, board.band_limit_hz,
            None if has_diode else float(model.envelope.gain(network.values)),
        ),
        threshold_v=design.detector.threshold_v,
        amplifier=values.amplifier,
        aliasing=values.aliasing,
        voltage_limits=values.voltage_limits,
        output_offset=values.output_offset,
        supply_ripple=values.supply_ripple,
        comparator_levels=values.comparator_levels,
        tolerance=values.tolerance,
        offset=(*_offsets(noisy), _bridge_offset(network, board.supply_v)),
        component_percent=percent,
        boards=boards,
        spread=monte_carlo(toleranced, percent, boards, seed),
        article_spread=monte_carlo(toleranced, state_capacitors(percent, ARTICLE_CAPACITOR_PERCENT), boards, seed),
        sensitivity=compute_sensitivities(toleranced),
    )  # fmt: skip


def bode_table(design: Design, low_hz: float = 1.0, high_hz: float = 1e5, per_decade: int = 40) -> str:
    """Tabulate the article's figure 4 as CSV: magnitude [dB] and phase [degree] of each stage and of the whole filter.

    The response starts at the tactile voltage. Amplifiers have one pole, so their gain falls with their gain-bandwidth
    product. The last column is that product over the frequency [dB], the asymptote of the amplifier's open-loop gain.
    """
    network = build_network(board_circuit(select_components(design)), find_gain_bandwidth_hz(design.board))
    f = np.logspace(math.log10(low_hz), math.log10(high_hz), round(per_decade * math.log10(high_hz / low_hz)) + 1)
    filter_network = network.drive(TACTILE).restrict(FILTERED)
    first, whole = filter_network.response(f, {TACTILE: 1.0}, STAGE1_OUT, FILTERED).T
    lines = ["frequency_hz,stage1_db,stage1_deg,stage2_db,stage2_deg,whole_db,whole_deg,gbw_over_f_db"]
    for i, hz in enumerate(f):
        cells = [f"{hz:.6g}"]
        for value in (first[i], whole[i] / first[i], whole[i]):
            cells += [f"{20 * math.log10(abs(value)):.4f}", f"{math.degrees(np.angle(value)):.3f}"]
        cells.append(f"{20 * math.log10(find_gain_bandwidth_hz(design.board) / hz):.4f}")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _offsets(board: NoisyNetwork) -> list[Contribution]:
    columns = zip(*(board.offsets_v(net) for net in NETS), strict=True)
    pairs = zip(board.sources, columns, strict=True)
    # The rectifier's amplifiers act behind these nets. The envelope offset contains theirs.
    return [Contribution(source.name, volts) for source, volts in pairs if source.offset and any(volts)]


def _bridge_offset(network: Network, supply_v: float) -> Contribution:
    """Offset of the bridge at TACTILE and its ADC pin, with the sensor open. C1 blocks it from the filter."""
    path = network.restrict(TACTILE)

    def tactile_v(values: Mapping[str, Value]) -> float:
        return path.with_values(values).operating_point({VCC: supply_v, VEE: -supply_v})[TACTILE]

    worst_v, nominal_v = 0.0, tactile_v({})
    for name in BRIDGE_RESISTORS:
        worst_v += abs(tactile_v({name: network.values[name] / (1 + BRIDGE_TOLERANCE)}) - nominal_v)
    return Contribution("R10 to R14", tuple(worst_v if net in (TACTILE, ADC_TACTILE) else 0.0 for net in NETS))


# The analysis of a board as text tables.


_LABELS = {
    "cutoff_hz": "lower -3 dB [Hz]",
    "section_quality": "Sallen-Key Q",
    "passband_gain": "maximum gain",
    "first_pole_hz": "first pole [Hz]",
    "section_hz": "Sallen-Key f0 [Hz]",
}
_LARGEST = 6
"""Number of noise contributions that are printed."""


def analysis_text(analysis: Analysis) -> str:
    """Format the analysis as tables for a terminal."""
    low, high = NOISE_BAND_HZ
    lines = [f"{f'RMS noise, {low:g} Hz to {high / 1e6:g} MHz':28}" + _net_headings()]
    lines += [_contribution_row(item, 1e6, "uV") for item in analysis.noise[:_LARGEST]]
    lines.append(_contribution_row(Contribution("total", analysis.noise_total_v), 1e6, "uV"))
    lines += ["", f"{'noise ahead of the rectifier':44}{'RMS':>11}{'mean envelope':>20}"]
    for item in analysis.noise_alternatives:
        envelope = "-" if item.mean_envelope_v is None else f"{1e3 * item.mean_envelope_v:.2f} mV"
        lines.append(f"{item.change:44}{1e3 * item.filtered_v:8.2f} mV{envelope:>20}")
    lines.append(f"{'threshold of the detector':44}{'':11}{1e3 * analysis.threshold_v:17.2f} mV")
    lines.append(
        f"- {LOW_NOISE_NAME} for U2 is a comparison, not a drop-in replacement: it requires another footprint and, for "
        "the same gain, another R14."
    )
    lines.append("- Noise: typical, white noise only. Noise and offsets are voltages against supply ground.")
    if analysis.output_offset is None:
        lines.append(f"- The noise is below the diode's threshold of {DEAD_ZONE_V:g} V, so the envelope stays at 0.")
    lines += ["", *_error_lines(analysis)]
    lines += ["", *_alias_lines(analysis.aliasing), "", *_limit_lines(analysis.voltage_limits)]
    lines += ["", f"{'offset':28}" + _net_headings()]
    lines += [_contribution_row(item, 1e3, "mV") for item in analysis.offset]
    lines.append(_offset_note(analysis.amplifier, has_rectifier=analysis.output_offset is not None))
    lines += ["", *_spread_lines(analysis), "", *_sensitivity_lines(analysis)]
    return "\n".join(lines)


def _offset_note(amplifier: str, *, has_rectifier: bool) -> str:
    """State which offsets are typical and which are maximum, and where that of the rectifier is."""
    data = CATALOGUE[amplifier]
    is_maximum = data.offset_v == data.max_offset_v
    exception = f" ({data.order_name}: {1e3 * data.offset_v:g} mV, its maximum)" if is_maximum else ""
    rectifier = "; U3: see the envelope offset above" if has_rectifier else ""
    return (
        f"amplifiers: typical offsets{exception}, {NOISE_FORCE_N:g} N on the sensor; R10 to R14: worst case of "
        f"{100 * BRIDGE_TOLERANCE:g} % resistors, no force{rectifier}"
    )


def _spread_lines(analysis: Analysis) -> list[str]:
    headings = ("nominal", "mean", "std. dev.", "2.5 %", "97.5 %", "corner min", "corner max")
    lines = [f"tolerances: {_tolerance_list(analysis)}, as in the bill of materials"]
    lines.append(
        f"percentiles of {analysis.boards} boards with uniformly and independently distributed values; minimum and "
        "maximum over all corners of the tolerances"
    )
    lines.append(
        "not included: R_LP and C_LP, the amplifiers' bandwidth, temperature, and capacitance lost to direct voltage"
    )
    lines.append(f"{'':20}" + "".join(f"{heading:>11}" for heading in headings))
    for name, spread in analysis.spread.items():
        cells = (
            spread.nominal,
            spread.mean,
            spread.deviation,
            spread.low_95,
            spread.high_95,
            spread.worst_low,
            spread.worst_high,
        )
        lines.append(f"{_LABELS[name]:20}" + "".join(f"{cell:11.4g}" for cell in cells))
    return [*lines, *_cost_lines(analysis)]


def _cost_lines(analysis: Analysis) -> list[str]:
    """State what the tolerance of C1 to C3 costs, compared with the article's."""
    bought = max(analysis.component_percent[name] for name in CUTOFF_CAPACITORS)
    if bought == ARTICLE_CAPACITOR_PERCENT:
        return []
    own, article = (spread["cutoff_hz"] for spread in (analysis.spread, analysis.article_spread))
    return [
        f"95 % of the boards have their lower -3 dB from {own.low_95:.1f} to {own.high_95:.1f} Hz with C1 to C3 of "
        f"{bought:g} %; with the article's {ARTICLE_CAPACITOR_PERCENT:g} % it would be {article.low_95:.1f} to "
        f"{article.high_95:.1f} Hz"
    ]


def _sensitivity_lines(analysis: Analysis) -> list[str]:
    components = list(next(iter(analysis.sensitivity.values())))
    lines = [f"{'sensitivity [%/%]':20}" + "".join(f"{component:>8}" for component in components)]
    for name, row in analysis.sensitivity.items():
        cells = (f"{round(row[component], 3) + 0.0:8.3f}" for component in components)  # 0 has no sign
        lines.append(f"{_LABELS[name]:20}" + "".join(cells))
    return lines


def _tolerance_list(analysis: Analysis) -> str:
    """List the tolerances: the resistors' in one, the capacitors' one by one where they differ."""
    percent = analysis.component_percent
    groups: dict[tuple[str, float], list[str]] = {}
    for name, value in percent.items():
        groups.setdefault(("filter resistors" if name.startswith("R") else "capacitors", value), []).append(name)
    kinds = [kind for kind, _ in groups]
    return ", ".join(
        f"{kind if kinds.count(kind) == 1 else ' '.join(names)} {value:g} %" for (kind, value), names in groups.items()
    )


def _net_headings() -> str:
    return "".join(f"{net.lower():>14}" for net in NETS)


def _contribution_row(item: Contribution, scale: float, unit: str) -> str:
    return f"  {item.cause:26}" + "".join(f"{format_figure(scale * v, 3):>11} {unit}" for v in item.volts)


def _error_lines(analysis: Analysis) -> list[str]:
    lines = []
    if analysis.output_offset:
        lines.append(describe_output_offset(analysis.output_offset, analysis.threshold_v))
    if analysis.comparator_levels:
        lines += describe_comparator_levels(analysis.comparator_levels)
    return [*lines, describe_supply_ripple(analysis.supply_ripple, has_diode=analysis.output_offset is None)]


def _alias_lines(aliasing: AliasAttenuation) -> list[str]:
    return [
        f"{'ahead of the ADC':44}{'tactile':>11}{'envelope':>11}",
        f"{f'gain at {aliasing.band_hz:.4g} Hz, upper end of vibrations':44}{aliasing.tactile_band_db:8.1f} dB",
        f"{f'gain at {aliasing.nyquist_hz:.4g} Hz, half the sampling rate':44}{aliasing.tactile_nyquist_db:8.1f} dB"
        f"{aliasing.envelope_nyquist_db:8.1f} dB",
        f"{f'gain at {aliasing.alias_hz:.4g} Hz, which aliases to that end':44}{aliasing.tactile_alias_db:8.1f} dB"
        f"{aliasing.envelope_alias_db:8.1f} dB",
        f"A tone as large as the filtered signal can be ({aliasing.swing_v:.1f} V peak) needs "
        f"{aliasing.required_db:.0f} dB of attenuation to alias to 1 LSB of the ADC ({1e3 * aliasing.lsb_v:.3g} mV). A "
        f"tone of {format_figure(1e3 * aliasing.one_lsb_tone_v, 2)} mV (peak) in the tactile voltage at "
        f"{aliasing.alias_hz:.4g} Hz aliases to 1 LSB.",
    ]


def _limit_lines(limits: VoltageLimits) -> list[str]:
    return [
        f"signal ground {limits.signal_ground_v:.2f} V; tactile voltage {limits.min_tactile_v:.2f} V (20 N) to "
        f"{limits.max_tactile_v:.2f} V (no force), both above supply ground",
        f"{describe_filter_swing(limits)}; vibrations of {1e3 * limits.vibration_peak_v:.1f} mV in the tactile voltage "
        "(peak, where the gain is largest) reach these limits; envelope up to about "
        f"{limits.max_envelope_v:.1f} V above signal ground",
        f"ADC pins clamped to within a diode drop of {limits.clamp_low_rail_v:.0f} V and "
        f"{limits.clamp_high_rail_v:g} V; the bridge amplifier's internal nodes and output stay "
        f"{limits.bridge_amplifier_margin_v:.2f} V within their limits",
        describe_adc_range(limits),
    ]
