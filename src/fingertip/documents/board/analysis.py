"""Data of the analysis of a board as tables for a terminal, whose text is `analysis.txt`."""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.board.analysis import interference, limits, noise
from fingertip.board.analysis.report import Analysis
from fingertip.board.analysis.tolerance import ARTICLE_CAPACITOR_PERCENT, CUTOFF_CAPACITORS
from fingertip.board.components.bridge import LOW_NOISE_NAME
from fingertip.catalogues.amplifiers import CATALOGUE
from fingertip.design.formulas import filter as formulas
from fingertip.documents.template import render

_LABELS = {
    "cutoff_hz": "lower -3 dB [Hz]",
    "section_quality": "Sallen-Key Q",
    "passband_gain": "maximum gain",
    "first_pole_hz": "first pole [Hz]",
    "section_hz": "Sallen-Key f0 [Hz]",
}


def analysis_text(analysis: Analysis) -> str:
    text = render(
        "board/analysis.txt",
        analysis=analysis,
        labels=_LABELS,
        noise=noise,
        interference=interference,
        limits=limits,
        formulas=formulas,
        low_noise_name=LOW_NOISE_NAME,
        amplifier=CATALOGUE[analysis.amplifier],
        has_bridge=not analysis.voltage_limits.has_filtered_output,
        is_in_software=analysis.voltage_limits.max_envelope_v is None,
        tolerances=_group_tolerances(analysis.component_percent),
        cutoff_percent=max(analysis.component_percent[name] for name in CUTOFF_CAPACITORS),
        article_percent=ARTICLE_CAPACITOR_PERCENT,
    )
    return text.rstrip("\n")


def _group_tolerances(percent: Mapping[str, float]) -> str:
    """List the tolerances: the resistors' in one, the capacitors' one by one where they differ."""
    groups: dict[tuple[str, float], list[str]] = {}
    for name, value in percent.items():
        groups.setdefault(("filter resistors" if name.startswith("R") else "capacitors", value), []).append(name)
    kinds = [kind for kind, _ in groups]
    return ", ".join(
        f"{kind if kinds.count(kind) == 1 else ' '.join(names)} {value:g} %" for (kind, value), names in groups.items()
    )
