"""The analysis as text."""

from __future__ import annotations

from fingertip.board.analysis.analyse import Analysis
from fingertip.board.analysis.noise import NETS, Contribution
from fingertip.board.circuit import engineering
from fingertip.board.values.built import LARGE_PERCENT
from fingertip.board.values.converter import AliasFigures
from fingertip.board.values.decision import decision_lines
from fingertip.board.values.limits import Limits, converter_line, swing_line
from fingertip.board.values.rest import rest_line
from fingertip.board.values.ripple import ripple_line
from fingertip.board.values.white_noise import BAND_HZ
from fingertip.design.filter_components import MAX_FOOTPRINT_F

_LABELS = {
    "cutoff_hz": "-3 dB overall [Hz]",
    "section_quality": "Sallen-Key Q",
    "passband_gain": "largest gain",
    "first_pole_hz": "first pole [Hz]",
    "section_hz": "Sallen-Key f0 [Hz]",
}
_LARGEST = 6


def analysis_text(analysis: Analysis) -> str:
    """Tables for a terminal."""
    low, high = BAND_HZ
    lines = [f"{f'noise, {low:g} Hz to {high / 1e6:g} MHz':28}" + _heads()]
    lines += [_row(item, 1e6, "uV") for item in analysis.noise[:_LARGEST]]
    lines.append(_row(Contribution("all", analysis.noise_total_v), 1e6, "uV"))
    lines += ["", f"{'noise ahead of the rectifier':44}{'rms':>11}{'envelope rests at':>20}"]
    lines += [f"{r.change:44}{1e3 * r.filtered_v:8.2f} mV{1e3 * r.rest_v:17.2f} mV" for r in analysis.quieter]
    lines.append(f"{'threshold of the detector':44}{'':11}{1e3 * analysis.threshold_v:17.2f} mV")
    lines += ["", *_error_lines(analysis)]
    lines += ["", *_alias_lines(analysis.alias), "", *_limit_lines(analysis.limits)]
    lines += ["", f"{'offset':28}" + _heads()]
    lines += [_row(item, 1e3, "mV") for item in analysis.offset]
    heads = ("nominal", "mean", "deviation", "95 % from", "to", "worst", "worst")
    bought = analysis.tolerance
    resistors, capacitors = f"resistors {bought.resistor_percent:g} %", f"capacitors {bought.capacitor_percent:g} %"
    lines += ["", f"tolerances: {resistors}, {capacitors}{_large(analysis)}, as the bill of materials asks for"]
    lines += [f"{'':20}" + "".join(f"{head:>11}" for head in heads)]
    for name, s in analysis.spread.items():
        cells = (s.nominal, s.mean, s.deviation, s.low_95, s.high_95, s.worst_low, s.worst_high)
        lines.append(f"{_LABELS[name]:20}" + "".join(f"{cell:11.4g}" for cell in cells))
    parts = list(next(iter(analysis.sensitivity.values())))
    lines += ["", f"{'% for 1 % of':20}" + "".join(f"{part:>8}" for part in parts)]
    for name, row in analysis.sensitivity.items():
        lines.append(f"{_LABELS[name]:20}" + "".join(f"{row[part]:8.3f}" for part in parts))
    return "\n".join(lines)


def _large(analysis: Analysis) -> str:
    has = "C14" in analysis.sensitivity["cutoff_hz"]
    return f" (C14 above {engineering(MAX_FOOTPRINT_F)}: {LARGE_PERCENT:g} %)" if has else ""


def _heads() -> str:
    return "".join(f"{net.lower():>14}" for net in NETS)


def _row(item: Contribution, scale: float, unit: str) -> str:
    return f"  {item.cause:26}" + "".join(f"{scale * v:11.2f} {unit}" for v in item.volts)


def _error_lines(analysis: Analysis) -> list[str]:
    lines = [rest_line(analysis.rest, analysis.threshold_v)] if analysis.rest else []
    lines += decision_lines(analysis.decision) if analysis.decision else []
    return [*lines, ripple_line(analysis.ripple, diode=analysis.rest is None)]


def _alias_lines(a: AliasFigures) -> list[str]:
    return [
        f"{'ahead of the converter':44}{'tactile':>11}{'envelope':>11}",
        f"{f'gain at {a.band_hz:.4g} Hz, the end of the vibrations':44}{a.raw_band_db:8.1f} dB",
        f"{f'gain at {a.nyquist_hz:.4g} Hz, half the rate':44}{a.raw_nyquist_db:8.1f} dB"
        f"{a.envelope_nyquist_db:8.1f} dB",
        f"{f'gain at {a.alias_hz:.4g} Hz, which folds to that end':44}{a.raw_alias_db:8.1f} dB"
        f"{a.envelope_alias_db:8.1f} dB",
        f"A tone of full swing would need {a.needed_db:.0f} dB to vanish in a step of {1e3 * a.step_v:.3g} mV; "
        f"one of {1e3 * a.hidden_v:.2g} mV does at {a.alias_hz:.4g} Hz.",
    ]


def _limit_lines(v: Limits) -> list[str]:
    return [
        f"signals rest at {v.rest_v:.2f} V; tactile voltage {v.min_tactile_v:.2f} to {v.max_tactile_v:.2f} V "
        f"(20 N to none)",
        f"{swing_line(v)}; vibrations of {1e3 * v.vibration_peak_v:.1f} mV reach that; "
        f"envelope up to {v.max_envelope_v:.2f} V above its rest",
        f"converter's pins held between {v.clamp_low_v:.0f} and {v.clamp_high_v:g} V; bridge's amplifier has "
        f"{v.bridge_amplifier_margin_v:.2f} V left",
        converter_line(v),
    ]
