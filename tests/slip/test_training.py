"""Training of the detector `fast`: labels of ticks, and what the next round of a fit pays more attention to."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.lab.campaign.mix_signals import LabelledSignal, Slide
from fingertip.slip.detectors.fast import TICK_S
from fingertip.slip.traces.truth import Interval
from tools.detector_training import rows

MOTION_S, ONSET_S, END_S = 0.99, 1.0, 1.4
TICKS = 1000
T_S = (np.arange(TICKS) + 1) * TICK_S


def make_signal(kind: str = "slip") -> LabelledSignal:
    slide, event = Slide(MOTION_S, ONSET_S, END_S), Interval(0.6, 0.7)
    return LabelledSignal(kind, 2000.0, np.zeros(4 * TICKS), (slide,), (event,))


def at(time_s: float) -> int:
    return round(time_s / TICK_S) - 1


def test_ticks_are_labelled_by_the_slip_around_them():
    labels, weights = rows.label(make_signal(), TICKS)
    assert T_S[labels > 0.0][0] == pytest.approx(ONSET_S - rows.EARLY_S)
    assert T_S[labels > 0.0][-1] == pytest.approx(END_S - TICK_S)
    expected = {
        0.1: 0.0,  # the floors are learned
        0.5: rows.QUIET_WEIGHT,
        0.65: rows.EVENT_WEIGHT,
        0.992: rows.CREEP_WEIGHT,  # not slip yet
        1.05: rows.ONSET_WEIGHT,
        1.3: rows.SLIP_WEIGHT,
        1.45: 0.0,  # the energy decays
        1.6: rows.QUIET_WEIGHT,
    }
    assert {time_s: weights[at(time_s)] for time_s in expected} == expected
    assert np.array_equal(rows.label(make_signal("burst above 60 Hz"), TICKS)[1], rows.BURST_FACTOR * weights)
