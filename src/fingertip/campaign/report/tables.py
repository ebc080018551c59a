"""A study as one JSON object: what was tried, what came out, and what was taken for granted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from fingertip.campaign.closed_loop.manipulations import NONE, LoopTotal
from fingertip.campaign.plan import APART, TUNING_SEEDS
from fingertip.campaign.requirements import Check
from fingertip.campaign.studies.boards import Board
from fingertip.campaign.studies.rates import Rate
from fingertip.campaign.studies.sensitivity import Moved
from fingertip.campaign.studies.spectra import Spectrum
from fingertip.campaign.studies.starts import ASSUMED_M_S2, Start
from fingertip.campaign.studies.taps import Taps
from fingertip.campaign.studies.tones import Told
from fingertip.campaign.studies.windows import Row
from fingertip.campaign.study import Study, Total, speed_m_s, surface

MATCHED = 0.1
"""False alarms per minute at which detectors are compared."""
ASSUMPTIONS = (
    "All traces are simulated; friction, vibration, noise and what is not slip are assumptions marked in fingertip.sim "
    "and in params/scenes. A real finger will differ.",
    "Slip is gross, and its delay counts, from when the pad slides at 1 mm/s. What bends the bristles of the contact, "
    "and would spring back, is not sliding; with it the pad has moved at 1 mm/s for 5 to 7 ms by then, and the robot "
    "for some 13. What goes ON in the last 7 ms before gross slip has heard it, with a delay of 0. The surface starts "
    "with 1 m/s2: how much that matters stands in the table of starts.",
    "The detector analog takes the output of the design's simulated board. The variant article has a bare 1N4148; the "
    "article does not say which diode it had. The table of boards shows one without dead zone beside it.",
    f"The seeds from {TUNING_SEEDS.start} to {TUNING_SEEDS.stop - 1} tuned the detector fast; none of them is among "
    "those used here. Analog, digital and fft were not tuned. The thresholds of fft and fast follow from the noise; "
    "that of analog and digital is the design's detector.threshold_v, by default the one that digital's noise allows.",
    f"Counted apart: {', '.join(APART)}. They shake finger or wire in the band of slip.",
)


@dataclass(frozen=True)
class Grounds:
    """What a study is to be read beside."""

    limits_s: Sequence[float]
    """Bound on the delay of each slip (`fingertip.campaign.studies.limit`)."""
    moved: Sequence[Moved]
    """Of the detector's delay by the simulation's assumptions."""
    windows: Sequence[Row]
    """Of the article's chain by its window."""
    spectra: Sequence[Spectrum]
    """Of slip, by sensor."""
    starts: Sequence[Start]
    """Delays by how hard the surface starts."""
    rates: Sequence[Rate]
    """Delays by how often the converter is read."""
    boards: Sequence[Board]
    """The article's detector by its board."""
    tones: Sequence[Told]
    """How long motors look like slip."""
    taps: Sequence[Taps]
    """Knocks from weak to hard that are taken for slip."""
    loop: Sequence[LoopTotal]
    """The manipulations, without control and with each detector."""

    def limit_s(self, share: float) -> float:
        """Bound by which that share of the slips can be found [s]."""
        ranked = sorted(self.limits_s)
        return ranked[min(len(ranked) - 1, int(share * len(ranked)))]


def as_data(study: Study, detector: str, checked: Sequence[Check], grounds: Grounds) -> dict[str, Any]:
    """Everything that was found, in seconds and shares; what was never found is null."""
    return {
        "detector": detector,
        "passed": all(check.passed for check in checked),
        "requirements": [
            {
                "name": check.name,
                "value": _number(check.value),
                "bound": check.bound,
                "passed": check.passed,
                "sentence": check.message,
            }
            for check in checked
        ],
        "matched_alarms_per_minute": MATCHED,
        "matched": {name: _line(total) if total else None for name, total in _matched(study).items()},
        "trials": study.amount.trials,
        "quiet_minutes": study.amount.quiet_minutes,
        "first_seed": study.first_seed,
        "detectors": {name: _detector(study, name) for name in study.totals},
        "limit": {"median_s": _number(grounds.limit_s(0.5)), "p90_s": _number(grounds.limit_s(0.9))},
        "sensitivity": [
            {
                "change": m.label,
                "found_share": m.found_share,
                "median_s": _number(m.median_s),
                "by_s": _number(m.by_s),
                "alarms_per_minute": round(m.alarms_per_minute, 4),
            }
            for m in grounds.moved
        ],
        "windows": [
            {
                "window_s": row.window_s,
                "threshold_v": round(row.threshold_v, 6),
                "found_share": round(row.found_share, 5),
                "median_s": _number(row.median_s),
                "p90_s": _number(row.p90_s),
                "contact_alarms_per_minute": round(row.contact_alarms_per_minute, 4),
            }
            for row in grounds.windows
        ],
        "spectra": [
            {"sensor": one.label, **{f"beyond_{f}_hz": round(one.beyond(f), 4) for f in (67, 100, 200)}}
            for one in grounds.spectra
        ],
        "starts": [_plain(row) for row in grounds.starts],
        "rates": [_plain(row) for row in grounds.rates],
        "boards": [_plain(row) for row in grounds.boards],
        "tones": [_plain(row) for row in grounds.tones],
        "taps": [_plain(row) for row in grounds.taps],
        "closed_loop": [{**asdict(row), "reactions_s": [round(s, 7) for s in row.reactions_s]} for row in grounds.loop],
        "assumptions": list(ASSUMPTIONS),
    }


def _matched(study: Study) -> dict[str, Total | None]:
    return {name: study.matched(name, MATCHED) for name in study.totals}


def _detector(study: Study, name: str) -> dict[str, Any]:
    total = study.at_design(name)
    minutes = total.minutes()
    return {
        **_line(total),
        "below_30_ms": round(sum(d < 0.03 for d in total.delays_s) / max(1, total.slips), 4),
        "surfaces": {str(k): _group(v) for k, v in total.by(surface).items()},
        "speeds_m_s": {str(k): _group(v) for k, v in total.by(speed_m_s).items()},
        "alarms": {
            cause: {"count": count, "minutes": round(minutes.get(cause, 0.0), 3), "apart": cause in APART}
            for cause, count in total.alarms().items()
            if cause != "slip"
        },
        "trial_minutes": round(minutes.get("slip", 0.0), 3),
        "delays_s": [round(d, 7) for d in total.delays_s],
        "trade_off": [_line(t) for t in study.totals[name]],
    }


def _line(total: Total) -> dict[str, Any]:
    return {
        "scale": total.scale,
        "found_share": round(total.found_share, 5),
        "median_s": _number(total.delay_s(0.5)),
        "p90_s": _number(total.delay_s(0.9)),
        "on_share": round(total.on_share, 4),
        "alarms_per_minute": round(total.alarms_per_minute, 4),
    }


def _group(values: tuple[float, float, int]) -> dict[str, Any]:
    mean, deviation, count = values
    return {"mean_s": _number(mean), "deviation_s": _number(deviation), "found": count}


def _plain(row: Start | Rate | Board | Told | Taps) -> dict[str, Any]:
    """A row's fields by name, rounded; what was never reached is null."""
    return {k: _number(v) if isinstance(v, float) else v for k, v in asdict(row).items()}


def _number(value: float) -> float | None:
    return round(value, 7) if math.isfinite(value) else None


def _ms(seconds: float) -> str:
    return f"{1000 * seconds:6.1f} ms" if math.isfinite(seconds) else "    never"


def as_text(study: Study, detector: str, checked: Sequence[Check], grounds: Grounds) -> str:
    """For people: a line for each detector, the bound, what moves the delay, then the requirements."""
    lines = ["detector   found   median      p90   < 30 ms   ON    alarms/min   " + "   ".join(APART)]
    for name in study.totals:
        t = study.at_design(name)
        alarms, minutes = t.alarms(), t.minutes()
        apart = "   ".join(f"{alarms[c] / minutes[c]:{len(c)}.1f}" for c in APART if c in minutes)
        below = sum(d < 0.03 for d in t.delays_s) / max(1, t.slips)
        lines.append(
            f"{name:8} {100 * t.found_share:6.1f}% {_ms(t.delay_s(0.5))} {_ms(t.delay_s(0.9))} "
            f"{100 * below:6.1f}% {100 * t.on_share:6.1f}% {t.alarms_per_minute:10.2f}   {apart}"
        )
    lines.append(
        f"limit      {'':6} {1000 * grounds.limit_s(0.5):6.1f} ms {1000 * grounds.limit_s(0.9):6.1f} ms   "
        "for any detector in this band, on average over the noise (Lorden's bound)"
    )
    lines += ["", f"each at its lowest threshold that keeps {MATCHED:g} alarms per minute:"]
    for name, total in _matched(study).items():
        if total is None:
            lines.append(f"{name:8} none of the thresholds tried is that quiet")
        else:
            lines.append(
                f"{name:8} {100 * total.found_share:6.1f}% {_ms(total.delay_s(0.5))} "
                f"{_ms(total.delay_s(0.9))}   threshold times {total.scale:g}"
            )
    lines += _tables(grounds)
    own = _per_minute(grounds.moved[0])
    lines += ["", f"what moves the median of {detector}, and its alarms per minute ({own} as it is):"]
    moved = sorted(grounds.moved[1:], key=lambda m: -abs(m.by_s) if math.isfinite(m.by_s) else -math.inf)
    lines += [f"{_moved(m, grounds.moved[0])} {_per_minute(m):>8}  {m.label}" for m in moved]
    lines += ["", "window of digital, median delay, alarms per minute at contacts, releases and changes of grip:"]
    lines += [
        f"{1000 * row.window_s:7.0f} ms {1000 * row.median_s:7.1f} ms {row.contact_alarms_per_minute:8.1f}"
        for row in grounds.windows
    ]
    lines.append("")
    lines += [f"{'met   ' if check.passed else 'MISSED'}  {check.message}" for check in checked]
    return "\n".join(lines)


def _tables(grounds: Grounds) -> list[str]:
    """The article's detector by its board, delays by the surface's start, and how long motors look like slip."""
    lines = ["", "analog by board and threshold:       found     median        p90   < 30 ms   worst mean   alarms/min"]
    lines += [
        f"{b.variant:10} {1000 * b.threshold_v:6.2f} mV {'(rule)  ' if b.by_rule else '(design)'} "
        f"{100 * b.found_share:9.1f}% {_ms(b.median_s):>10} {_ms(b.p90_s):>10} {100 * b.below_30_ms:7.1f}% "
        f"{_ms(b.worst_mean_s):>12} {b.alarms_per_minute:12.2f}"
        for b in grounds.boards
    ]
    who = list(dict.fromkeys(s.who for s in grounds.starts))
    lines += ["", "median delay and that of nine in ten by the surface's start:"]
    lines.append("m/s2    " + "".join(f"{name:>18}" for name in who))
    for a in dict.fromkeys(s.acceleration_m_s2 for s in grounds.starts):
        start = {s.who: s for s in grounds.starts if s.acceleration_m_s2 == a}
        cells = "".join(f"{_short(start[name].median_s)} /{_short(start[name].p90_s)} ms" for name in who)
        lines.append(f"{a:4g}{'*' if a == ASSUMED_M_S2 else ' '}   {cells}")
    lines += ["", "fast by the converter's readings:  found     median        p90   limit, median and p90   alarms/min"]
    lines += [
        f"{r.sample_rate_hz:7g} Hz {100 * r.found_share:28.1f}% {_ms(r.median_s):>10} {_ms(r.p90_s):>10} "
        f"{_ms(r.limit_median_s):>11} {_ms(r.limit_p90_s):>11} {r.alarms_per_minute:12.2f}"
        for r in grounds.rates
    ]
    lines += ["", "slips that can be told from a motor's tones by what the best pair of tones leaves:"]
    lines += [f"{1000 * t.stretch_s:7.0f} ms {100 * t.told_share:6.0f}%" for t in grounds.tones]
    forces = list(dict.fromkeys(t.force_n for t in grounds.taps))
    lines += ["", "knocks taken for slip, by their force [N]: " + "".join(f"{force:7g}" for force in forces)]
    for name, rise_s in dict.fromkeys((t.detector, t.rise_s) for t in grounds.taps):
        row = [t for t in grounds.taps if (t.detector, t.rise_s) == (name, rise_s)]
        said = f"{name}, in {1000 * rise_s:g} ms"
        lines.append(f"{said:43}" + "".join(f"{100 * t.taken_share:6.0f}%" for t in row))
    lines += ["", "closed loop, four objects:      held   reaction median, slowest   false grips   claims discarded"]
    for total in grounds.loop:
        said = f"{total.detector:26} {total.held:4} of {total.count}"
        if total.detector != NONE:
            ranked = total.reactions_s
            times = f"{_ms(ranked[len(ranked) // 2])} {_ms(ranked[-1])}" if ranked else "no slip"
            said += f"   {times} {total.false_grips:17} {total.discarded:13}"
        lines.append(said)
    return lines


def _per_minute(moved: Moved) -> str:
    return f"{moved.alarms_per_minute:.2f}"


def _moved(moved: Moved, base: Moved) -> str:
    """By how much; where a median was infinite, before or after the change, a word for it."""
    if math.isfinite(moved.by_s):
        return f"{1000 * moved.by_s:+7.1f} ms"
    return "  found   " if math.isfinite(moved.median_s) > math.isfinite(base.median_s) else "  never   "


def _short(seconds: float) -> str:
    return f"{1000 * seconds:6.1f}" if math.isfinite(seconds) else " never"
