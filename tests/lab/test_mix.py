"""Signals of the robustness mix: what a board gives its controller, and seeds that stay in their range."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.lab.campaign.mix_signals import filter_as_board
from fingertip.lab.campaign.plan import HELD_OUT_FROM, check_first_seed


def test_filtered_signal_ends_at_the_limits_of_the_board() -> None:
    design = Design.load("fsr400")
    rate_hz = design.detector.sample_rate_hz
    tone_v = np.sin(2 * np.pi * 300.0 * np.arange(0.5 * rate_hz) / rate_hz)
    settled = slice(len(tone_v) // 2, None)
    peaks_v = []
    for volts in (0.01, 0.02, 50.0):
        filtered_v = filter_as_board(design, 1.6 + volts * tone_v)
        assert filtered_v is not None
        peaks_v.append(filtered_v[settled].max())
        assert filtered_v[settled].min() == pytest.approx(-peaks_v[-1], rel=0.02)
    assert peaks_v[1] == pytest.approx(2 * peaks_v[0])
    assert peaks_v[1] < peaks_v[2] < design.board.supply_v / 2


def test_the_last_seed_leaves_room_for_all_trials_in_32_bits() -> None:
    last = 2**31 - 1 - 20_000_000
    check_first_seed(HELD_OUT_FROM)
    check_first_seed(last)
    with pytest.raises(TraceError, match=f"is too large; choose {HELD_OUT_FROM} to {last}"):
        check_first_seed(last + 1)
