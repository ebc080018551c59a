"""Results of the studies as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from fingertip.lab.campaign.run import DetectorResult
from fingertip.lab.report.results import format_ms
from fingertip.slip.traces.truth import ENCODER_NOTE
from tools.article import robustness
from tools.article.boards import BoardResult
from tools.article.previous_works import PreviousWorks
from tools.article.protocol import ProtocolStudy, WindowResult
from tools.article.protocol_table import protocol_as_lines
from tools.article.sensitivity import VariationResult
from tools.article.steps import SamplingRateResult, StepSensitivity


@dataclass(frozen=True)
class StudyResults:
    variations: Sequence[VariationResult]
    steps: StepSensitivity
    patch_radius_m: float
    """Radius of the pad's contact patch at 1 N [m]."""
    windows: Sequence[WindowResult]
    rates: Sequence[SamplingRateResult]
    boards: Sequence[BoardResult]
    article: Mapping[str, DetectorResult]
    """Detectors of the same finger on the article's board and
    converter; empty if the design has them.
    """
    protocol: ProtocolStudy
    previous: PreviousWorks


_ms = partial(format_ms, otherwise="  missed ", form="6.1f")


def as_text(detector: str, studies: StudyResults) -> str:
    lines = _study_tables(studies)
    lines += robustness.variation_table(studies.variations, detector)
    lines += robustness.step_table(studies.steps)
    lines += [
        "",
        "digital by window length: median delay, alarms per minute at contacts, releases and load "
        "changes:",
    ]
    lines += [
        f"{1000 * row.window_s:7.0f} ms {format_ms(row.median_s):>10} "
        f"{row.contact_alarms_per_minute:8.1f}"
        for row in studies.windows
    ]

    return "\n".join(lines)


def _study_tables(studies: StudyResults) -> list[str]:
    """Tables of board variants and sampling rates."""
    lines = [
        "analog by board and threshold; worst: mean delay on the worst surface:",
        f"{'board':10} {'threshold':18} {'found':>6} {'median':>9} {'p90':>9} {'< 30 ms':>7} "
        f"{'worst':>9} {'/min':>5}",
    ]
    lines += [
        f"{b.variant:10} {1000 * b.threshold_v:6.2f} mV {'(noise) ' if b.by_rule else '(design)'} "
        f"{100 * b.found_share:5.1f}% {_ms(b.median_s):>9} {_ms(b.p90_s):>9} "
        f"{100 * b.below_30_ms:6.1f}% "
        f"{_ms(b.worst_mean_s):>9} {b.alarms_per_minute:5.2f}"
        for b in studies.boards
    ]

    if studies.article:
        lines += [
            "",
            "the same finger on the article's board and converter (python -m tools.article "
            "article has the details);",
            f"{ENCODER_NOTE}:",
            f"{'detector':10} {'found':>8} {'median':>10} {'p90':>10} {'p90 from motion':>16} "
            f"{'alarms/min':>12}",
        ]

    lines += [
        f"{name:10} {100 * found.found_share:7.1f}% {_ms(found.delay_s(0.5)):>10} "
        f"{_ms(found.delay_s(0.9)):>10} "
        f"{_ms(found.motion_delay_s(0.9)):>16} {found.alarms_per_minute:12.2f}"
        for name, found in studies.article.items()
    ]
    lines += protocol_as_lines(studies.protocol, studies.previous)
    lines += [
        "",
        "detector fast by sampling rate:",
        f"{'rate':10}{'found':>7} {'median':>10} {'p90':>10} {'alarms/min':>11}",
    ]
    lines += [
        f"{r.sample_rate_hz:7g} Hz {100 * r.found_share:5.1f}% {_ms(r.median_s):>10} "
        f"{_ms(r.p90_s):>10} "
        f"{r.alarms_per_minute:11.2f}"
        for r in studies.rates
    ]

    return lines
