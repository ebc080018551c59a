"""Trials of a sliding finger and of a sliding object, over time (the article's figures 12, 13)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.campaign import Case
from fingertip.lab.report.plots import NOTE
from fingertip.pad.response import Pad
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.simulation import GRASPED_SURFACES, SPEEDS_M_S
from fingertip.slip.detectors.registry import make_detector
from fingertip.slip.plots import draw_bars
from fingertip.slip.traces.truth import Interval, intervals
from tools.article.pictures.figure import Figure, Statement
from tools.article.steps import generate_trials

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DETECTOR = "analog"
WINDOW_S = 0.03
"""Time over which the root mean square of the filtered signal is taken: the article's window [s].
"""
ALIKE = 0.8
"""Least correlation of an envelope that resembles a root mean square. Assumption."""
FORCES_N = (0.8, 1.3)
ARTICLE_V = (4.0, 3.85)
"""Forces of the article's figure 12 [N], and its voltages there [V]."""
VOLTAGE_TOLERANCE_V = 0.05
SHOWN_M_S = dict(zip(ARTICLE_SURFACES, (0.06, 0.04, 0.06, 0.04, 0.08, 0.08), strict=True))
"""Speed of the trial that is shown of each surface [m/s]: two of each speed, and wood at half that
of paper and plastic, as in the article's figure 12.
"""
_OUTPUTS = ["voltage_v", "force_n", "slip", "filtered_v", "envelope_v", "sampled_envelope_v"]
_TRIALS = 120


@dataclass(frozen=True, eq=False)
class TrialSignals:
    """Signals of one trial, and where the detector is ON."""

    case: Case
    time_s: Array
    voltage_v: Array
    force_n: Array
    filtered_v: Array
    envelope_v: Array
    slip: Interval
    """The slide of the trial; slip as the contact opens is none of it."""
    on: NDArray[np.bool_]

    @property
    def surface(self) -> str:
        return self.case.scene.contact.surface

    @property
    def speed_m_s(self) -> float:
        return self.case.scene.slide.speed_m_s

    @property
    def lasts(self) -> NDArray[np.bool_]:
        """True while the slip lasts."""
        return (self.time_s >= self.slip.onset_s) & (self.time_s < self.slip.end_s)

    @property
    def delay_s(self) -> float | None:
        """Time from the onset of gross slip to the first ON in it [s]; None without one."""
        on_s = self.time_s[self.lasts & self.on]
        return float(on_s[0]) - self.slip.onset_s if on_s.size else None

    @property
    def is_broken(self) -> bool:
        """True if ON breaks off before the slip ends."""
        found = self.on[self.lasts]
        return bool(np.any(~found[np.argmax(found) :]))

    @property
    def force_before_n(self) -> float:
        """Force at the onset of the slip [N]."""
        return float(self.force_n[self.time_s < self.slip.onset_s][-1])

    @property
    def least_force(self) -> float:
        """Least force in the slip, averaged over the window, over the force before it."""
        return float(_average(self.force_n, self.time_s)[self.lasts].min()) / self.force_before_n

    @property
    def mean_envelope_v(self) -> float:
        return float(self.envelope_v[self.lasts].mean())

    def rms_v(self) -> Array:
        """Root mean square of the filtered signal over the window that ends at each sample [V]."""
        return np.sqrt(_average(self.filtered_v**2, self.time_s))

    def compare_with_rms(self) -> tuple[float, float]:
        """Correlation of the envelope's window mean with that root mean square, and their ratio, in
        the slip.
        """
        mean_v = _average(self.envelope_v, self.time_s)[self.lasts]
        rms_v = self.rms_v()[self.lasts]
        return float(np.corrcoef(mean_v, rms_v)[0, 1]), float(mean_v.mean() / rms_v.mean())


def _average(values: Array, time_s: Array) -> Array:
    count = round(WINDOW_S / float(time_s[1] - time_s[0]))
    return np.convolve(values, np.full(count, 1 / count))[: len(values)]


def run_trials(design: Design) -> list[TrialSignals]:
    """Run the article's 120 trials with the design's finger and board."""
    with compiled():
        return [_run(design, case) for case in generate_trials(_TRIALS)]


def _run(design: Design, case: Case) -> TrialSignals:
    scene = case.scene.model_copy(update={"outputs": _OUTPUTS})
    result = run_scene(design, scene, case.seed)
    columns = result.columns
    output = make_detector(DETECTOR, design).process(columns["sampled_envelope_v"])
    signals = {name: columns[name] for name in ("voltage_v", "force_n", "filtered_v", "envelope_v")}

    return TrialSignals(
        case=case,
        time_s=result.time_s,
        **signals,
        slip=intervals(result.time_s, columns["slip"].astype(np.bool_))[0],
        on=output.on,
    )


def draw_sliding_finger(design: Design, trials: Sequence[TrialSignals]) -> Figure:
    """Draw figure 12: the first trial of each surface at the speed that is shown."""
    flat = [one for one in trials if one.case.scene.hold.mode == "press"]
    shown = [
        next(one for one in flat if (one.surface, one.speed_m_s) == pair)
        for pair in SHOWN_M_S.items()
    ]
    found = sum(one.delay_s is not None for one in flat)
    early = sum(bool(one.on[one.time_s < one.slip.onset_s - WINDOW_S].any()) for one in flat)
    mean_mv = {name: 1e3 * _mean(flat, name, _find_envelope_v) for name in ARTICLE_SURFACES}
    slow_mv, fast_mv = (
        1e3 * _mean([one for one in flat if one.speed_m_s == speed], name, _find_envelope_v)
        for name, speed in (("wood", 0.04), ("paper", 0.08))
    )
    smooth, medium, gross = (mean_mv[name] for name in ARTICLE_SURFACES[:3])
    ranks = [
        _correlate_ranks(
            [one.force_before_n for one in group], [one.mean_envelope_v for one in group]
        )
        for name in ARTICLE_SURFACES
        for speed in SPEEDS_M_S
        if (group := [one for one in flat if (one.surface, one.speed_m_s) == (name, speed)])
    ]
    rank = float(np.mean(ranks))
    light, firm = (_read_voltage(flat, force_n) for force_n in FORCES_N)
    share = Pad.from_design(design).reference_share
    light_on_sensor, firm_on_sensor = (_read_voltage(flat, n / share) for n in FORCES_N)
    least = min(one.least_force for one in flat)

    statements = (
        Statement(
            "slip is found on each surface, ON where the vibrations are",
            f"found in {found} of {len(flat)}; ON before in {early}",
            found == len(flat) and not early,
        ),
        Statement(
            "4.0 V at 0.8 N, 3.85 V at 1.3 N",
            f"{light:.2f} V and {firm:.2f} V; with that force on the sensor itself, of which the "
            f"skin passes {100 * share:.0f} %, {light_on_sensor:.2f} V and {firm_on_sensor:.2f} V",
            _agree_in_part((light, firm), (light_on_sensor, firm_on_sensor)),
        ),
        Statement(
            "vibration grows in proportion to roughness, Ra 0.2 to 0.8 and 3.2 um",
            f"mean envelope {smooth:.0f}, {medium:.0f} and {gross:.0f} mV: it grows, by a factor "
            f"of {gross / smooth:.1f} where Ra grows by 16",
            None if smooth < medium < gross else False,
        ),
        Statement(
            "wood vibrates more than paper and rubber, at half their speed",
            f"mean envelope {mean_mv['wood']:.0f} mV on wood, {mean_mv['paper']:.0f} on paper, "
            f"{mean_mv['plastic']:.0f} on plastic; at 4 cm/s {slow_mv:.0f} on wood, at 8 cm/s "
            f"{fast_mv:.0f} on paper",
            slow_mv > fast_mv or (None if mean_mv["wood"] > mean_mv["paper"] else False),
        ),
        Statement(
            "a higher force gives a larger envelope",
            f"rank correlation {rank:.2f}, mean of {len(ranks)} groups of one surface and speed",
            rank > 0.5,
        ),
        Statement(
            "slip takes the contact away in some trials: the voltage rises, ON is short",
            f"the force, averaged over {1e3 * WINDOW_S:g} ms, never falls below "
            f"{100 * least:.0f} % of that before",
            least < 0.5,
        ),
    )
    return Figure(
        "article_surfaces.png",
        "Fig. 12: a sliding finger on each surface",
        "Tactile voltage above, envelope with ON (shaded) below; dot: touch, arrow: slip. The "
        "first trial of each surface at the speed that the title names.",
        _plot_surfaces(shown),
        statements,
    )


def draw_sliding_object(trials: Sequence[TrialSignals]) -> Figure:
    """Draw figure 13: the first trial with each object."""
    grasped = [one for one in trials if one.case.scene.hold.mode == "grasp"]
    shown = [next(one for one in grasped if one.surface == name) for name in GRASPED_SURFACES]
    delays_s = [one.delay_s for one in grasped if one.delay_s is not None]
    compared = np.array([one.compare_with_rms() for one in trials])
    alike, ratio = np.median(compared, axis=0)
    low, high = np.quantile(compared[:, 0], (0.05, 0.95))
    broken = sum(one.is_broken for one in grasped)
    highest_n = max(one.force_before_n for one in grasped)

    statements = (
        Statement(
            "forces even higher than 3 N",
            f"up to {highest_n:.1f} N",
            highest_n > 3.0,
        ),
        Statement(
            "slip is promptly found",
            f"in {len(delays_s)} of {len(grasped)}, {1e3 * float(np.median(delays_s)):.0f} ms "
            "after gross slip (median)",
            len(delays_s) == len(grasped) and float(np.median(delays_s)) < WINDOW_S,
        ),
        Statement(
            "small vibrations, so that ON is not continuous",
            f"ON breaks off within the slip in {broken} of {len(grasped)}",
            broken > len(grasped) / 2,
        ),
        Statement(
            "the envelope resembles a root mean square (III.A)",
            f"mean of 30 ms against the filtered signal's root mean square over 30 ms, in the slip "
            f"of all {len(trials)} trials: correlation {alike:.2f} ({low:.2f} to {high:.2f} in 90 "
            f"%), ratio {ratio:.2f}",
            bool(alike > ALIKE),
        ),
    )
    return Figure(
        "article_objects.png",
        "Fig. 13: a sliding object",
        "Force, filtered signal, envelope with its mean and with the filtered signal's root mean "
        "square over 30 ms, and ON, over the first trial with each object.",
        _plot_objects(shown),
        statements,
    )


def _agree_in_part(on_finger_v: Sequence[float], on_sensor_v: Sequence[float]) -> bool | None:
    """Compare voltages with the article's: True on the finger, None on the sensor alone."""

    def agree(voltages: Sequence[float]) -> bool:
        return bool(np.max(np.abs(np.subtract(voltages, ARTICLE_V))) < VOLTAGE_TOLERANCE_V)

    return True if agree(on_finger_v) else None if agree(on_sensor_v) else False


def _find_envelope_v(one: TrialSignals) -> float:
    return one.mean_envelope_v


def _mean(
    trials: Sequence[TrialSignals], surface: str, figure: Callable[[TrialSignals], float]
) -> float:
    return float(np.mean([figure(one) for one in trials if one.surface == surface]))


def _correlate_ranks(first: Sequence[float], second: Sequence[float]) -> float:
    """Correlation of the ranks of two lists without equal values (Spearman)."""
    one, other = (np.argsort(np.argsort(values)) for values in (first, second))
    return float(np.corrcoef(one, other)[0, 1])


def _read_voltage(trials: Sequence[TrialSignals], force_n: float) -> float:
    """Interpolate the voltage at a force between the trials' last seconds before slip [V]."""
    ordered = sorted(trials, key=lambda one: one.force_before_n)
    voltages = [
        float(one.voltage_v[one.time_s < one.slip.onset_s][-200:].mean()) for one in ordered
    ]
    return float(np.interp(force_n, [one.force_before_n for one in ordered], voltages))


def _plot_surfaces(trials: Sequence[TrialSignals]) -> bytes:
    """Plot the trials in two rows of three, each as two panels."""
    columns = 3
    figure = style.new_figure(10, 6)
    ratios = (1.0, 1.0) * (len(trials) // columns)
    grid = figure.subplots(len(ratios), columns, height_ratios=ratios, sharey="row", sharex="col")

    for i, one in enumerate(trials):
        row, column = divmod(i, columns)
        voltage, envelope = grid[2 * row, column], grid[2 * row + 1, column]
        title = f"{one.surface}, {100 * one.speed_m_s:g} cm/s, {one.force_before_n:.1f} N"
        voltage.set_title(title, loc="left", fontsize=10)
        voltage.plot(one.time_s, one.voltage_v, color=style.BLUE, linewidth=0.5)
        touched = int(np.flatnonzero(one.force_n > 0.0)[0])
        voltage.plot(one.time_s[touched], one.voltage_v[touched], "o", color=style.RED)
        ends = ((one.slip.onset_s, 4.25), (one.slip.end_s, 4.25))
        voltage.annotate("", *ends, arrowprops={"arrowstyle": "<->", "color": style.TEXT_COLOUR})
        _shade_on(envelope, one)
        envelope.plot(one.time_s, one.envelope_v, color=style.ORANGE, linewidth=0.5)

    for axes in grid[::2, 0]:
        axes.set_ylabel("tactile\nvoltage [V]")
    for axes in grid[1::2, 0]:
        axes.set_ylabel("envelope\n[V]")
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    for axes in grid.flat:
        style.style_axes(axes, "both")

    figure.align_ylabels()
    return style.to_png(figure)


def _shade_on(axes: Axes, one: TrialSignals) -> None:
    for part in intervals(one.time_s, one.on):
        axes.axvspan(part.onset_s, part.end_s, color=style.PALE_BLUE, alpha=0.6, linewidth=0)


def _plot_objects(trials: Sequence[TrialSignals]) -> bytes:
    figure = style.new_figure(8, 5.4)
    grid = figure.subplots(
        4, len(trials), sharex="col", sharey="row", height_ratios=(1, 1, 1.2, 0.6)
    )
    for column, one in enumerate(trials):
        force, filtered, envelope, bars = grid[:, column]
        name = f"object, {one.surface}, {100 * one.speed_m_s:g} cm/s"
        force.set_title(name, loc="left", fontsize=10)
        force.plot(one.time_s, one.force_n, color=style.TEAL, linewidth=0.6)
        filtered.plot(one.time_s, one.filtered_v, color=style.BLUE, linewidth=0.5)
        envelope.plot(
            one.time_s, one.envelope_v, color=style.ORANGE, linewidth=0.5, label="envelope"
        )
        mean_v = _average(one.envelope_v, one.time_s)
        envelope.plot(one.time_s, mean_v, color=style.BLUE, linewidth=1, label="its mean, 30 ms")
        rms_label = "RMS of the filtered signal, 30 ms"
        envelope.plot(one.time_s, one.rms_v(), color=style.RED, linewidth=1, label=rms_label)
        draw_bars(
            bars,
            [
                ("true slip", [one.slip], style.TRUTH),
                ("ON", intervals(one.time_s, one.on), style.BLUE),
            ],
        )
        bars.tick_params(axis="y", length=0)
        bars.set_xlabel(f"time [s] ({NOTE})")
        bars.set_xlim(float(one.time_s[0]), float(one.time_s[-1]))

    labels = ("normal\nforce [N]", "filtered\nsignal [V]", "envelope\n[V]")
    for axes, label in zip(grid[:, 0], labels, strict=False):
        axes.set_ylabel(label)
    for axes in grid.flat:
        style.style_axes(axes, "both")

    grid[2, 0].legend(frameon=False, fontsize=8, loc="upper left")
    figure.align_ylabels()
    return style.to_png(figure)


def draw_trials(design: Design) -> tuple[Figure, Figure]:
    """Draw figures 12 and 13 from the same trials."""
    trials = run_trials(design)
    return draw_sliding_finger(design, trials), draw_sliding_object(trials)
