"""The analysis as text."""

from __future__ import annotations

from fingertip.board.analysis import NETS, NOISE_BAND_HZ, Analysis, Contribution

_LABELS = {
    "cutoff_hz": "-3 dB overall [Hz]",
    "section_quality": "Sallen-Key Q",
    "passband_gain": "passband gain",
    "first_pole_hz": "first pole [Hz]",
    "section_hz": "Sallen-Key f0 [Hz]",
}
_LARGEST = 6


def analysis_text(analysis: Analysis) -> str:
    """Tables for a terminal."""
    low, high = NOISE_BAND_HZ
    lines = [f"{f'noise, {low:g} Hz to {high / 1e6:g} MHz':28}" + _heads()]
    lines += [_row(item, 1e6, "uV") for item in analysis.noise[:_LARGEST]]
    lines.append(_row(Contribution("all", analysis.noise_total_v), 1e6, "uV"))
    lines += ["", f"{'offset':28}" + _heads()]
    lines += [_row(item, 1e3, "mV") for item in analysis.offset]
    heads = ("nominal", "mean", "deviation", "95 % from", "to", "worst", "worst")
    lines += ["", f"{'tolerances':20}" + "".join(f"{head:>11}" for head in heads)]
    for name, s in analysis.spread.items():
        cells = (s.nominal, s.mean, s.deviation, s.low_95, s.high_95, s.worst_low, s.worst_high)
        lines.append(f"{_LABELS[name]:20}" + "".join(f"{cell:11.4g}" for cell in cells))
    parts = list(next(iter(analysis.sensitivity.values())))
    lines += ["", f"{'% for 1 % of':20}" + "".join(f"{part:>8}" for part in parts)]
    for name, row in analysis.sensitivity.items():
        lines.append(f"{_LABELS[name]:20}" + "".join(f"{row[part]:8.3f}" for part in parts))
    return "\n".join(lines)


def _heads() -> str:
    return "".join(f"{net.lower():>14}" for net in NETS)


def _row(item: Contribution, scale: float, unit: str) -> str:
    return f"  {item.cause:26}" + "".join(f"{scale * v:11.2f} {unit}" for v in item.volts)
