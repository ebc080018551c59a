"""Results of a validation as one JSON object and as text, with their assumptions."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

from fingertip.documents.template import WIDTH, lay_out_page, render, render_rows
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopSummary
from fingertip.lab.campaign.mix import MixSummary
from fingertip.lab.campaign.plan import REPORTED_SEPARATELY, TUNING_SEEDS
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, quantile_s, speed_m_s, surface
from fingertip.lab.report import robustness
from fingertip.lab.report.numbers import ONSETS, format_ms, to_data, to_number
from fingertip.lab.studies.article import DEVICES, MOVED_M, ProtocolStudy, Spectrum, WindowResult
from fingertip.lab.studies.boards import BoardResult
from fingertip.lab.studies.bounds import DiscriminationResult, KnockResult
from fingertip.lab.studies.previous_works import PLATE_FACTORS, PreviousWorks
from fingertip.lab.studies.sensitivity import ASSUMED_M_S2, AccelerationResult, VariationResult
from fingertip.lab.studies.steps import SamplingRateResult, StepSensitivity
from fingertip.slip.traces.truth import ENCODER_HZ, ENCODER_NOTE, INCIPIENT_S, encoder_delay_band_s, format_delay_band

BOUND_LABEL = (
    "estimate for the energy of one band alone (asymptotic); a detector that sees the slow force may be sooner"
)
"""Label of Lorden's bound (`fingertip.lab.studies.bounds`) in the tables."""
MATCHED_ALARMS_PER_MINUTE = 0.1
"""Rate of false alarms at which detectors are compared [1/min]."""
PROTOCOL_COLUMNS = tuple(device for device in DEVICES if device != "fft")
"""Devices that have a column in the table of the article's protocol."""
STATED: Mapping[str, Any] = {
    "onsets": ONSETS,
    "incipient_s": INCIPIENT_S,
    "acceleration_m_s2": ASSUMED_M_S2,
    "tuning_seeds": TUNING_SEEDS,
    "reported_separately": REPORTED_SEPARATELY,
}


@dataclass(frozen=True)
class StudyResults:
    bounds_s: Sequence[float]
    """Lower bound on the delay of each slip [s] (`fingertip.lab.studies.bounds`)."""
    variations: Sequence[VariationResult]
    steps: StepSensitivity
    patch_radius_m: float
    """Radius of the pad's contact patch at 1 N [m]."""
    windows: Sequence[WindowResult]
    spectra: Sequence[Spectrum]
    accelerations: Sequence[AccelerationResult]
    rates: Sequence[SamplingRateResult]
    boards: Sequence[BoardResult]
    article: Mapping[str, DetectorResult]
    """Detectors of the same finger on the article's board and converter; empty if the design has them."""
    protocol: ProtocolStudy
    previous: PreviousWorks
    motor: Sequence[DiscriminationResult]
    knocks: Sequence[KnockResult]
    closed_loop: Sequence[ClosedLoopSummary]
    """Manipulations, without control and with each detector."""
    seed_ranges: Sequence[DetectorResult]
    """The detector's campaign on several ranges of seeds, the reported one first."""
    wider_mix: Mapping[str, MixSummary]

    def bound_s(self, fraction: float) -> float:
        """Bound by which a fraction of the slips can be found [s]."""
        return quantile_s(self.bounds_s, len(self.bounds_s), fraction)


def as_data(result: CampaignResult, studies: StudyResults) -> dict[str, Any]:
    """Return all results for JSON, in seconds and fractions; an infinite delay is null."""
    assumptions = lay_out_page(render("validation/assumptions.md", **STATED))
    return {
        "matched_alarms_per_minute": MATCHED_ALARMS_PER_MINUTE,
        "matched": {name: _summary(matched) if matched else None for name, matched in _matched(result).items()},
        "trials": result.plan.trials,
        "negative_minutes": result.plan.negative_minutes,
        "first_seed": result.first_seed,
        "detectors": {name: _detector(result, name) for name in result.detectors},
        "detection_bound": {"median_s": to_number(studies.bound_s(0.5)), "p90_s": to_number(studies.bound_s(0.9))},
        "assumption_sensitivity": robustness.variations_as_data(studies.variations),
        "step_sensitivity": robustness.steps_as_data(studies.steps),
        "windows": [
            to_data(row, {"threshold_v": 6, "found_share": 5, "contact_alarms_per_minute": 4})
            for row in studies.windows
        ],
        "spectra": [
            {"sensor": one.label, **{f"share_above_{f}_hz": round(one.share_above(f), 4) for f in (67, 100, 200)}}
            for one in studies.spectra
        ],
        "acceleration_sensitivity": list(map(to_data, studies.accelerations)),
        "sampling_rates": list(map(to_data, studies.rates)),
        "board_variants": list(map(to_data, studies.boards)),
        "article_board": [
            {
                "detector": name,
                "found_share": to_number(found.found_share),
                "median_s": to_number(found.delay_s(0.5)),
                "p90_s": to_number(found.delay_s(0.9)),
                "motion_p90_s": to_number(found.motion_delay_s(0.9)),
                "alarms_per_minute": to_number(found.alarms_per_minute),
            }
            for name, found in studies.article.items()
        ],
        "article_protocol": {
            "encoder_hz": ENCODER_HZ,
            "rows": [asdict(row) for row in list_protocol_rows(studies.protocol, studies.previous)],
            "results": list(map(to_data, studies.protocol.results)),
            "ridged_plates": list(map(to_data, studies.previous.plates)),
            "plain_fft": list(map(to_data, studies.previous.plain_fft)),
        },
        "motor_discrimination": list(map(to_data, studies.motor)),
        "knock_rejection": list(map(to_data, studies.knocks)),
        "closed_loop": [
            {
                **asdict(row),
                "reactions_s": [round(s, 7) for s in row.reactions_s],
                "slipped_m": round(row.slipped_m, 7),
                "force_ratio": to_number(row.force_ratio),
            }
            for row in studies.closed_loop
        ],
        "seed_ranges": robustness.ranges_as_data(studies.seed_ranges),
        "wider_mix": robustness.mix_as_data(studies.wider_mix),
        "assumptions": [line.removeprefix("- ") for line in assumptions.splitlines()],
    }


def _matched(result: CampaignResult) -> dict[str, DetectorResult | None]:
    return {name: result.at_alarm_rate(name, MATCHED_ALARMS_PER_MINUTE) for name in result.detectors}


def _detector(result: CampaignResult, name: str) -> dict[str, Any]:
    nominal = result.at_nominal_threshold(name)
    minutes = nominal.minutes()
    alarms: dict[str, dict[str, Any]] = {}
    for cause, count in nominal.alarms().items():
        if cause != "slip":
            duration, is_separate = round(minutes.get(cause, 0.0), 3), cause in REPORTED_SEPARATELY
            alarms[cause] = {"count": count, "minutes": duration, "reported_separately": is_separate}
    return {
        **_summary(nominal),
        "below_30_ms": round(nominal.share_within_30_ms, 4),
        "surfaces": {str(k): _group(v) for k, v in nominal.group_delays(surface).items()},
        "speeds_m_s": {str(k): _group(v) for k, v in nominal.group_delays(speed_m_s).items()},
        "alarms": alarms,
        "trial_minutes": round(minutes.get("slip", 0.0), 3),
        "delays_s": [round(d, 7) for d in nominal.delays_s],
        "trade_off": [_summary(r) for r in result.detectors[name]],
    }


def _summary(result: DetectorResult) -> dict[str, Any]:
    return {
        "scale": result.scale,
        "found_share": round(result.found_share, 5),
        "median_s": to_number(result.delay_s(0.5)),
        "p90_s": to_number(result.delay_s(0.9)),
        "worst_s": to_number(result.worst_s),
        "median_since_motion_s": to_number(result.motion_delay_s(0.5)),
        "p90_since_motion_s": to_number(result.motion_delay_s(0.9)),
        "p90_since_motion_by_encoders_s": [to_number(s) for s in encoder_delay_band_s(result.motion_delay_s(0.9))],
        "on_share": round(result.on_share, 4),
        "alarms_per_minute": round(result.alarms_per_minute, 4),
        "alarms_per_minute_95": [to_number(rate) for rate in result.alarm_interval],
    }


def _group(values: tuple[float, float, int]) -> dict[str, Any]:
    mean, deviation, count = values
    return {"mean_s": to_number(mean), "deviation_s": to_number(deviation), "found": count}


_ms = partial(format_ms, otherwise="  missed ", form="6.1f")
_short_ms = partial(format_ms, otherwise=" missed", form="7.1f", unit="")


def as_text(result: CampaignResult, detector: str, studies: StudyResults) -> str:
    lines = [
        f"{'':17}{'since gross slip':>27} {'since motion':>21} {'p90 since motion,':>18}",
        f"{'detector':8} {'found':>7} {'median':>9} {'p90':>9} {'worst':>9} {'median':>9} {'p90':>9} "
        f"{f'encoders {ENCODER_HZ:g} Hz':>18} {'< 30 ms':>7}",
    ]
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        p90_s = nominal.motion_delay_s(0.9)
        band = format_delay_band(p90_s) if math.isfinite(p90_s) else "missed"
        lines.append(
            f"{name:8} {100 * nominal.found_share:6.1f}% {_ms(nominal.delay_s(0.5))} {_ms(nominal.delay_s(0.9))} "
            f"{_ms(nominal.worst_s)} {_ms(nominal.motion_delay_s(0.5))} {_ms(p90_s)} "
            f"{band:>18} {100 * nominal.share_within_30_ms:6.1f}%"
        )
    lines.append(f"{'bound':8} {'':7} {_ms(studies.bound_s(0.5))} {_ms(studies.bound_s(0.9))} {BOUND_LABEL}")
    lines += [
        "found, median, p90, worst: slips found, percentiles of the delay, longest found.",
        "Since gross slip: the pad slides at 1 mm/s. Since motion: the robot moved;",
        f"{ENCODER_NOTE}.",
        "< 30 ms: slips found within 30 ms of gross slip.",
        "",
        f"{'detector':8} {'ON':>7} {'alarms/min (95 %)':>20}   " + "   ".join(REPORTED_SEPARATELY),
    ]
    for name in result.detectors:
        nominal = result.at_nominal_threshold(name)
        alarms, minutes = nominal.alarms(), nominal.minutes()
        separate = "   ".join(f"{alarms[c] / minutes[c]:{len(c)}.1f}" for c in REPORTED_SEPARATELY if c in minutes)
        low, high = nominal.alarm_interval
        rate = f"{nominal.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"
        lines.append(f"{name:8} {100 * nominal.on_share:6.1f}% {rate:>20}   {separate}".rstrip())
    lines += [
        "ON: share of a slip, after its detection, in which the detector is ON.",
        f"{', '.join(REPORTED_SEPARATELY)}: false alarms per minute in these scenes;",
        "alarms/min excludes them.",
        "",
        f"each detector at its lowest threshold with at most {MATCHED_ALARMS_PER_MINUTE:g} alarms per minute:",
    ]
    for name, matched in _matched(result).items():
        if matched is None:
            lines.append(f"{name:8} none of the thresholds has so few alarms")
        else:
            lines.append(
                f"{name:8} {100 * matched.found_share:6.1f}% {_ms(matched.delay_s(0.5))} "
                f"{_ms(matched.delay_s(0.9))}   at {matched.scale:g} times its nominal threshold"
            )
    lines += robustness.mix_table(studies.seed_ranges, studies.wider_mix, detector)
    lines += _study_tables(studies)
    lines += robustness.variation_table(studies.variations, detector)
    lines += robustness.step_table(studies.steps)
    lines += ["", "digital by window length: median delay, alarms per minute at contacts, releases and load changes:"]
    lines += [
        f"{1000 * row.window_s:7.0f} ms {format_ms(row.median_s):>10} {row.contact_alarms_per_minute:8.1f}"
        for row in studies.windows
    ]
    return "\n".join(lines)


def _study_tables(studies: StudyResults) -> list[str]:
    """Tables of board variants, accelerations, sampling rates, motor tones, knocks and the closed loop."""
    lines = [
        "",
        "analog by board and threshold; worst: mean delay on the worst surface:",
        f"{'board':10} {'threshold':18} {'found':>6} {'median':>9} {'p90':>9} {'< 30 ms':>7} {'worst':>9} {'/min':>5}",
    ]
    lines += [
        f"{b.variant:10} {1000 * b.threshold_v:6.2f} mV {'(noise) ' if b.by_rule else '(design)'} "
        f"{100 * b.found_share:5.1f}% {_ms(b.median_s):>9} {_ms(b.p90_s):>9} {100 * b.below_30_ms:6.1f}% "
        f"{_ms(b.worst_mean_s):>9} {b.alarms_per_minute:5.2f}"
        for b in studies.boards
    ]
    if studies.article:
        lines += [
            "",
            "the same finger on the article's board and converter (fingertip validate article has the details);",
            f"{ENCODER_NOTE}:",
            f"{'detector':10} {'found':>8} {'median':>10} {'p90':>10} {'p90 from motion':>16} {'alarms/min':>12}",
        ]
    lines += [
        f"{name:10} {100 * found.found_share:7.1f}% {_ms(found.delay_s(0.5)):>10} {_ms(found.delay_s(0.9)):>10} "
        f"{_ms(found.motion_delay_s(0.9)):>16} {found.alarms_per_minute:12.2f}"
        for name, found in studies.article.items()
    ]
    lines += protocol_as_lines(studies.protocol, studies.previous)
    detectors = list(dict.fromkeys(row.detector for row in studies.accelerations))
    lines += ["", "median / 90th percentile of the delay [ms] by acceleration of the surface (* assumed);"]
    lines.append(f"bound: {BOUND_LABEL}:")
    lines.append("m/s2    " + "".join(f"{name:>19}" for name in detectors))
    for a in dict.fromkeys(row.acceleration_m_s2 for row in studies.accelerations):
        rows = {row.detector: row for row in studies.accelerations if row.acceleration_m_s2 == a}
        cells = "".join(f"  {_short_ms(rows[name].median_s)} / {_short_ms(rows[name].p90_s)}" for name in detectors)
        lines.append(f"{a:4g}{'*' if a == ASSUMED_M_S2 else ' '}   {cells}")
    lines += [
        "",
        f"detector fast by sampling rate; bound: {BOUND_LABEL}:",
        f"{'rate':10}{'found':>7} {'median':>10} {'p90':>10} {'bound median':>13} {'bound p90':>11} {'alarms/min':>11}",
    ]
    lines += [
        f"{r.sample_rate_hz:7g} Hz {100 * r.found_share:5.1f}% {_ms(r.median_s):>10} {_ms(r.p90_s):>10} "
        f"{_ms(r.bound_median_s):>13} {_ms(r.bound_p90_s):>11} {r.alarms_per_minute:11.2f}"
        for r in studies.rates
    ]
    lines += ["", "slips that can be distinguished from a motor's tones, by length of the segment:"]
    lines += [f"{1000 * row.segment_s:7.0f} ms {100 * row.distinguished_share:6.0f}%" for row in studies.motor]
    forces = list(dict.fromkeys(row.force_n for row in studies.knocks))
    lines += ["", f"{'knocks reported as slip, by force [N]:':38}" + "".join(f"{force:6g}" for force in forces)]
    for name, rise_s in dict.fromkeys((row.detector, row.rise_s) for row in studies.knocks):
        group = [row for row in studies.knocks if (row.detector, row.rise_s) == (name, rise_s)]
        label = f"{name}, rise time {1000 * rise_s:g} ms"
        lines.append(f"{label:38}" + "".join(f"{100 * row.false_alarm_share:5.0f}%" for row in group))
    lines += [
        "",
        "closed loop: four objects, each hit by a robot's pin. False grips: grip increases",
        "without slip. Suppressed: detections without slip that did not tighten the grip,",
        "because the hand was closing or its force was growing.",
        "Slipped: median way of the object. Force: at the end, over the planned one, of objects held.",
        f"{'detector':18} {'held':>9} {'slipped':>9} {'force':>6}   {'reaction median, slowest':>24} "
        f"{'false grips':>11} {'suppressed':>10}",
    ]
    for row in studies.closed_loop:
        text = f"{row.detector:18} {f'{row.held} of {row.count}':>9} {1000 * row.slipped_m:6.1f} mm"
        text += f" {row.force_ratio:6.2f}" if row.held else f" {'-':>6}"
        if row.detector != NO_CONTROL:
            ranked = row.reactions_s
            times = f"{_ms(ranked[len(ranked) // 2])} {_ms(ranked[-1])}" if ranked else "no slip"
            text += f"   {times:>24} {row.false_grips:11} {row.suppressed:10}"
        lines.append(text)
    return lines


@dataclass(frozen=True)
class ProtocolRow:
    """One figure of the article, ours beside it."""

    figure: str
    article: str
    ours: dict[str, str]
    """Device -> value; a device that the figure does not apply to is left out."""
    differs: str


def list_protocol_rows(study: ProtocolStudy, previous: PreviousWorks) -> list[ProtocolRow]:
    """List the article's figures (sections IV.A, IV.B and V) beside ours."""
    data = {
        "columns": PROTOCOL_COLUMNS,
        "devices": [study.find(name) for name in PROTOCOL_COLUMNS],
        "later": [(moved_m, [study.find(name, moved_m) for name in PROTOCOL_COLUMNS]) for moved_m in MOVED_M[1:]],
        "fft": study.find("fft"),
        "plates": [(factor, previous.means_s(factor)) for factor in PLATE_FACTORS],
        "plain_fft": previous.plain_fft,
        "boards": list(study.manipulations.values()),
        "motion_ms": ONSETS["motion_ms"],
        "encoders_ms": [1000 * delay_s for delay_s in encoder_delay_band_s(ONSETS["motion_ms"] / 1000)],
        "ms": lambda seconds: format_ms(seconds, "none found"),
    }
    rows = []
    for row in render_rows("validation/protocol.md", data):
        ours = {name: row[name] for name in PROTOCOL_COLUMNS if row[name]}
        rows.append(ProtocolRow(row["figure"], row["article"], ours, row["differs"]))
    return rows


def protocol_as_lines(study: ProtocolStudy, previous: PreviousWorks) -> list[str]:
    """Format the table as text; what differs stands below each row."""
    head = "".join(f"{name:>18}" for name in PROTOCOL_COLUMNS)
    lines = [
        "",
        "the article's own protocol beside its figures. Zero: first reading of encoders at "
        f"{ENCODER_HZ:g} Hz that shows the",
        "robot's motion. Window and converter: those of the design article. Threshold: what the noise of each board's",
        "output allows. Nothing was tuned to the article's figures:",
        f"{'':34} {'article':>29}{head}",
    ]
    for row in list_protocol_rows(study, previous):
        cells = "".join(f"{row.ours.get(name, ''):>18}" for name in PROTOCOL_COLUMNS)
        lines.append(f"{row.figure:34} {row.article:>29}{cells}".rstrip())
        lines += textwrap.wrap(row.differs, WIDTH, initial_indent="    ", subsequent_indent="    ")
    return lines
