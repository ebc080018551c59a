"""Skin that creeps on the bone in jumps: what they do to the force
on the sensor, and what `fast` answers.
"""

from __future__ import annotations

import pytest

from tools.figures.creep import CLOSE_S, RARE_S, count_alarms


@pytest.mark.full
def test_jumps_are_slip_to_the_detector_when_they_follow_each_other_closely() -> None:
    rare = count_alarms(RARE_S)
    close = count_alarms(CLOSE_S)
    assert sum(rare) <= 6  # of some 60 jumps
    assert sum(count > 0 for count in close) >= 2
    assert max(close) > 20
