"""ON and OFF of a trial for windows of different length (the article's figure 5).

The article found its threshold empirically. So does this figure: it is the lowest with which the
article's window takes no touch for slip. The finger touches within a tenth of a second; in the
trials it takes half a second, and the board's diode hides that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.campaign import Case
from fingertip.lab.campaign.run import simulate_trace
from fingertip.lab.report.plots import NOTE
from fingertip.slip.detectors.analog_and_digital import AnalogDetector
from fingertip.slip.plots import draw_bars
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import intervals
from tools.article.pictures.figure import Figure, Statement
from tools.article.steps import generate_trials

WINDOWS_S = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1)
"""Window lengths [s]; the article shows 10 ms and more, and uses 30 ms."""
SHORT_S = 0.01
LEAST_S = 0.02
USED_S = 0.03
TOUCH_S = 0.1
"""Time in which the force of a touch rises [s]. Assumption."""
FEW = 0.05
"""Share of touches whose report the article's figure would not show. Assumption."""
_TRIALS = 120


@dataclass(frozen=True, eq=False)
class Touch:
    """Trial, and the mean of its envelope by the length of the window."""

    trace: Trace
    means_v: Mapping[float, Array]

    def before(self) -> NDArray[np.bool_]:
        """True before the surface moves."""
        assert self.trace.origin.motion_s is not None
        return self.trace.time_s < self.trace.origin.motion_s

    def highest_v(self, window_s: float) -> float:
        """Highest mean before the surface moves [V]."""
        return float(self.means_v[window_s][self.before()].max())

    def is_found(self, window_s: float, threshold_v: float) -> bool:
        """True if the first slip is reported while it lasts."""
        assert self.trace.slip is not None
        first = intervals(self.trace.time_s, self.trace.slip)[0]
        time_s = self.trace.time_s
        lasts = (time_s >= first.onset_s) & (time_s < first.end_s)
        return bool((self.means_v[window_s][lasts] > threshold_v).any())


def simulate_touch(design: Design, case: Case) -> Touch:
    """Simulate a trial of the article whose finger touches fast."""
    hold = case.scene.hold.model_copy(update={"mode": "grasp", "close_s": TOUCH_S})
    fast = replace(case, scene=case.scene.model_copy(update={"hold": hold}))
    trace = simulate_trace(design, fast, ["analog"])
    rate_hz = design.detector.sample_rate_hz
    assert trace.envelope_v is not None

    return Touch(
        trace,
        {
            window_s: AnalogDetector(rate_hz, round(window_s * rate_hz), 1.0)
            .process(trace.envelope_v)
            .statistic_v
            for window_s in WINDOWS_S
        },
    )


def draw_windows(design: Design) -> Figure:
    """Draw figure 5: the first trial whose touch the short window alone takes for slip."""
    with compiled():
        touches = [
            simulate_touch(design, case)
            for case in generate_trials(_TRIALS)
            if case.scene.hold.mode == "press"
        ]

    threshold_v = max(touch.highest_v(USED_S) for touch in touches)
    wrong = {w: sum(one.highest_v(w) > threshold_v for one in touches) for w in WINDOWS_S}
    found = {w: sum(one.is_found(w, threshold_v) for one in touches) for w in WINDOWS_S}
    shown = next(
        one for one in touches if one.highest_v(SHORT_S) > threshold_v > one.highest_v(LEAST_S)
    )
    count = len(touches)
    longer = [w for w in WINDOWS_S if w >= LEAST_S]

    statements = (
        Statement(
            "L = 10 ms takes a contact for slip",
            f"{wrong[SHORT_S]} of {count} touches, each a press within {1e3 * TOUCH_S:g} ms",
            wrong[SHORT_S] > FEW * count,
        ),
        Statement(
            "a longer L avoids that; acceptable from 20 ms on",
            ", ".join(f"{wrong[w]} with {1e3 * w:g} ms" for w in longer),
            max(wrong[w] for w in longer) <= FEW * count,
        ),
        Statement(
            "the slip is found with each",
            f"at least {min(found.values())} of {count}",
            min(found.values()) >= (1 - FEW) * count,
        ),
    )
    return Figure(
        "article_windows.png",
        "Fig. 5: ON and OFF by length of the window",
        "Envelope of the board and the ON of each window, over a trial in which 10 ms report the "
        f"touch. The threshold, {1e3 * threshold_v:.0f} mV, is the lowest with which 30 ms report "
        "no touch; at the threshold from the noise, windows differ little.",
        _plot(shown, threshold_v),
        statements,
    )


def _plot(touch: Touch, threshold_v: float) -> bytes:
    trace = touch.trace
    assert trace.slip is not None
    assert trace.force_n is not None
    assert trace.envelope_v is not None
    figure = style.new_figure(7, 4.8)
    voltage, envelope, bars = figure.subplots(3, 1, sharex=True, height_ratios=(1, 1, 1.8))
    voltage.plot(trace.time_s, trace.voltage_v, color=style.BLUE, linewidth=0.7)
    touched = int(np.flatnonzero(trace.force_n > 0.0)[0])
    voltage.plot(trace.time_s[touched], trace.voltage_v[touched], "o", color=style.RED)
    voltage.set_ylabel("tactile\nvoltage [V]")
    voltage.set_title("dot: touch", loc="left", fontsize=10)
    envelope.plot(trace.time_s, trace.envelope_v, color=style.ORANGE, linewidth=0.7)
    envelope.set_ylabel("envelope\n[V]")

    rows = [("true slip", intervals(trace.time_s, trace.slip), style.TRUTH)]
    for window_s, mean_v in touch.means_v.items():
        on = intervals(trace.time_s, mean_v > threshold_v)
        colour = style.RED if touch.highest_v(window_s) > threshold_v else style.BLUE
        rows.append((f"L = {1e3 * window_s:g} ms", on, colour))

    for axes in (voltage, envelope, bars):
        style.style_axes(axes, "both")

    draw_bars(bars, rows)
    bars.tick_params(axis="y", length=0)
    bars.set_xlabel(f"time [s]; red: ON at the touch too ({NOTE})")
    bars.set_xlim(float(trace.time_s[0]), float(trace.time_s[-1]))
    figure.align_ylabels()
    return style.to_png(figure)
