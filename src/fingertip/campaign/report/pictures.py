"""A study as pictures like the article's: delays (figure 14), surfaces and velocities (figure 15), and a comparison."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fingertip.campaign.studies.spectra import Spectrum
from fingertip.campaign.studies.windows import Row
from fingertip.campaign.study import Study, speed_m_s, surface
from fingertip.drawing import BLUE, INK, ORANGE, RED, plain, png, sheet

COLORS = {"analog": BLUE, "digital": "#5b8fb9", "fft": ORANGE, "fast": RED}
_SPEED_COLORS = ("#9ecae1", "#4292c6", "#08519c")
NOTE = "simulated, on seeds that tuned nothing"


def delays(study: Study) -> bytes:
    """Histogram of the delays in bins of 5 ms centred on multiples of 5, one row for each detector: a PNG."""
    figure = sheet(10, 2.4 * len(study.totals) + 0.8)
    rows = figure.subplots(len(study.totals), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(rows, study.totals, strict=True):
        total = study.at_design(name)
        ms = [1000 * d for d in total.delays_s]
        counts: dict[int, int] = {}
        for d in ms:
            at = min(5 * math.floor(d / 5 + 0.5), 155)
            counts[at] = counts.get(at, 0) + 1
        axes.bar(list(counts), list(counts.values()), width=4.4, color=COLORS.get(name, "#555555"))
        below = sum(d < 30 for d in ms)
        said = (
            f"{name}: {len(ms)} of {total.slips} found, {below} below 30 ms, median {1000 * total.delay_s(0.5):.1f} ms"
        )
        axes.set_title(said, loc="left", fontsize=10)
        axes.axvline(30, color=INK, linestyle="--", linewidth=1)
        axes.set_ylabel("trials")
        plain(axes)
    rows[-1].set_xlim(-2.5, 160)
    rows[-1].set_xlabel(f"delay [ms], the last bin holds all beyond ({NOTE})")
    return png(figure)


def surfaces(study: Study, detector: str) -> bytes:
    """Mean delay by surface and velocity, and by surface with its standard deviation: a PNG."""
    total = study.at_design(detector)
    figure = sheet(10, 7)
    top, bottom = figure.subplots(2, 1, sharex=True)
    names = list(total.by(surface))
    speeds = sorted({speed_m_s(v) for v in total.verdicts if v.slips})
    both = total.by(lambda v: (surface(v), speed_m_s(v)))
    for i, speed in enumerate(speeds):
        values = [1000 * both[(name, speed)][0] if (name, speed) in both else math.nan for name in names]
        x = [n + 0.25 * (i - (len(speeds) - 1) / 2) for n in range(len(names))]
        label = f"{100 * speed:g} cm/s"
        top.bar(x, [v if math.isfinite(v) else 0 for v in values], 0.22, label=label, color=_SPEED_COLORS[i % 3])
    groups = total.by(surface)
    found = [(n, 1000 * groups[name][0], 1000 * groups[name][1]) for n, name in enumerate(names) if groups[name][2]]
    means, spread = [mean for _, mean, _ in found], [deviation for _, _, deviation in found]
    bottom.errorbar([n for n, _, _ in found], means, spread, fmt="o", capsize=5, color=COLORS.get(detector, "#555555"))
    for n, name in enumerate(names):
        if not groups[name][2]:
            bottom.annotate("none found", (n, 2), ha="center", fontsize=9, color=INK)
    bottom.axhline(60, color=INK, linestyle="--", linewidth=1, label="60 ms (article)")
    bottom.set_ylim(0, max(70.0, 1.1 * max((m + s for m, s in zip(means, spread, strict=True)), default=0.0)))
    bottom.set_xticks(range(len(names)), names, rotation=20, ha="right")
    top.set_title(f"{detector}: delay by surface and velocity ({NOTE})", loc="left", fontsize=10)
    for axes, what in ((top, "mean delay [ms]"), (bottom, "mean and deviation [ms]")):
        axes.set_ylabel(what)
        axes.legend(frameon=False, ncols=3, fontsize=9)
        plain(axes)
    return png(figure)


def comparison(study: Study, limit_s: float) -> bytes:
    """Median (line) and 90th percentile (dashed) of the delay against false alarms per minute, and the limit on it
    [s]: a PNG."""
    figure = sheet(10, 6)
    axes = figure.subplots()
    minimum = 0.02  # where none was counted
    for name, totals in study.totals.items():
        color = COLORS.get(name, "#555555")
        # Where nothing is counted any more, a higher threshold only adds delay: the first such one is drawn.
        silent = [t for t in totals if not t.alarms_per_minute][:1]
        totals = tuple([t for t in totals if t.alarms_per_minute] + silent)
        rates = [max(t.alarms_per_minute, minimum) for t in totals]
        for share, style in ((0.5, "-"), (0.9, "--")):
            values = [1000 * t.delay_s(share) for t in totals]
            kept = [(r, v) for r, v in zip(rates, values, strict=True) if math.isfinite(v)]
            label = f"{name}, {'median' if share == 0.5 else 'nine in ten'}"
            axes.plot([r for r, _ in kept], [v for _, v in kept], style, marker=".", color=color, label=label)
        own = study.at_design(name)
        if math.isfinite(own.delay_s(0.5)):
            at = (max(own.alarms_per_minute, minimum), 1000 * own.delay_s(0.5))
            axes.plot(*at, "o", markersize=11, markerfacecolor="none", color=color)
    axes.axhline(1000 * limit_s, color="#2e7d5b", linewidth=1, label="limit on average (Lorden), median")
    axes.axvline(0.1, color=INK, linewidth=1, linestyle=":")
    axes.set_xscale("log")
    axes.set_ylim(0, 160)
    axes.set_xlabel(f"false alarms per minute of contact, release, load change and drift; {minimum:g}: none ({NOTE})")
    axes.set_ylabel("delay of all slips [ms]")
    axes.set_title("Each line: one detector at thresholds from noisy to deaf; circle: its own", loc="left", fontsize=10)
    axes.legend(frameon=False, ncols=3, fontsize=9)
    plain(axes)
    return png(figure)


def windows(rows: Sequence[Row]) -> bytes:
    """Delay and alarms of the article's chain by its window: a PNG."""
    figure = sheet(10, 5)
    left, right = figure.subplots(1, 2)
    ms = [1000 * row.window_s for row in rows]
    for share, style, color in (("median", "-", BLUE), ("nine in ten", "--", BLUE)):
        delays_s = [row.median_s if share == "median" else row.p90_s for row in rows]
        kept = [(w, 1000 * d) for w, d in zip(ms, delays_s, strict=True) if math.isfinite(d)]
        left.plot([w for w, _ in kept], [d for _, d in kept], style, marker=".", color=color, label=share)
    right.plot(ms, [row.contact_alarms_per_minute for row in rows], marker=".", color=RED)
    left.set_ylabel("delay [ms]")
    left.legend(frameon=False, fontsize=9)
    right.set_ylabel("false alarms per minute of contact, release, load change")
    left.set_title(f"digital, by its window ({NOTE})", loc="left", fontsize=10)
    for axes in (left, right):
        axes.axvline(30, color=INK, linestyle=":", linewidth=1)
        axes.set_ylim(bottom=0)
        axes.set_xlabel("window [ms]; dotted: the article's")
        plain(axes)
    return png(figure)


def spectra(found: Sequence[Spectrum]) -> bytes:
    """Power spectral densities, one row for each sensor: a PNG."""
    figure = sheet(10, 6)
    rows = figure.subplots(len(found), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for axes, one in zip(rows, found, strict=True):
        axes.semilogy(one.frequency_hz, one.power_v2_hz, color=BLUE, linewidth=1)
        shares = ", ".join(f"{100 * one.beyond(f):.1f} % beyond {f} Hz" for f in (67, 100, 200))
        axes.set_title(f"{one.label}: of the power from 20 Hz on {shares}", loc="left", fontsize=10)
        axes.set_ylabel("voltage [V\u00b2/Hz]")
        axes.axvline(67, color=INK, linestyle=":", linewidth=1)
        plain(axes)
    rows[-1].set_xlim(0, 400)
    rows[-1].set_xlabel(f"frequency [Hz]; dotted: the article's cutoff ({NOTE})")
    return png(figure)
