"""Intervals of flags, and their score: delays, missed slips and false intervals."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.slip import Interval, Trace, detect
from fingertip.slip.detection import UsedThreshold
from fingertip.slip.report import format_delay
from fingertip.slip.traces.truth import SlipCollector, intervals, measure_false_on_s, merge, score

TIME = np.arange(10) / 10


def to_flags(text: str) -> np.ndarray:
    return np.array([c == "1" for c in text])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0000000000", []),
        ("0011100000", [(0.2, 0.5)]),
        ("1100000011", [(0.0, 0.2), (0.8, 0.9)]),
        ("1111111111", [(0.0, 0.9)]),
        ("0101000000", [(0.1, 0.2), (0.3, 0.4)]),
    ],
)
def test_intervals_of_flags(text, expected):
    assert [(i.onset_s, i.end_s) for i in intervals(TIME, to_flags(text))] == expected


@pytest.mark.parametrize("sizes", [(10,), (1,) * 10, (3, 0, 4, 3), (5, 5), (9, 1)])
def test_chunks_give_the_intervals_of_the_whole(sizes):
    for text in ("0000000000", "0011100000", "1100000011", "1111111111", "0101000000", "0000000001"):
        flags, at, collector = to_flags(text), 0, SlipCollector()
        for size in sizes:
            collector.add(TIME[at : at + size], flags[at : at + size])
            at += size
        assert collector.close() == intervals(TIME, flags), text
        assert collector.close() == intervals(TIME, flags), "nothing is added twice"


def test_intervals_with_small_gaps_are_merged():
    parts = [Interval(0.0, 0.1), Interval(0.12, 0.2), Interval(0.3, 0.4)]
    assert merge(parts, 0.03) == (Interval(0.0, 0.2), Interval(0.3, 0.4))


def test_a_gap_of_exactly_the_limit_is_merged_in_every_group():
    # Powers of two, so that the gaps have no rounding errors.
    parts = [Interval(1.0, 2.0), Interval(2.25, 3.0), Interval(8.0, 9.0), Interval(9.25, 10.0), Interval(20.0, 21.0)]
    assert merge(parts, 0.25) == (Interval(1.0, 3.0), Interval(8.0, 10.0), Interval(20.0, 21.0))
    assert merge(parts, 0.125) == tuple(parts)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ((1.0, 2.0), (1.5, 3.0), True),
        ((1.0, 2.0), (2.0, 3.0), False),  # they touch
        ((2.0, 3.0), (1.0, 2.0), False),
        ((1.0, 2.0), (3.0, 4.0), False),
        ((3.0, 4.0), (1.0, 2.0), False),
        ((2.0, 2.0), (1.0, 2.0), True),  # one sample at the end of a trace
        ((1.0, 2.0), (2.0, 2.0), True),
        ((2.5, 2.5), (1.0, 2.0), False),
        ((1.0, 2.0), (0.5, 0.5), False),
    ],
)
def test_overlap_of_two_intervals(first, second, expected):
    assert Interval(*first).overlaps(Interval(*second)) == expected


def test_score_of_detected_missed_and_false_intervals():
    truth = [Interval(1.0, 2.0), Interval(3.0, 3.5), Interval(5.0, 6.0)]
    found = [
        Interval(0.2, 0.3),  # false
        Interval(1.025, 2.03), Interval(2.02, 2.04),  # the slip, and a second interval within the window after it
        Interval(2.5, 2.6),  # false
        Interval(4.9, 5.5),  # ON before the slip
    ]  # fmt: skip
    scored = score(found, truth, 0.03)
    assert scored.delays_s == (pytest.approx(0.025), None, pytest.approx(-0.1))
    assert scored.missed == (truth[1],)
    assert scored.false_intervals == (found[0], found[3])


def test_an_alarm_that_ends_at_the_onset_does_not_detect_the_slip():
    scored = score([Interval(0.9, 1.0), Interval(1.02, 1.4)], [Interval(1.0, 1.5)], 0.03)
    assert scored.delays_s == (pytest.approx(0.02),)
    assert scored.false_intervals == (Interval(0.9, 1.0),)
    # An interval of one last sample has no length but is detected.
    assert score([Interval(1.5, 1.5)], [Interval(1.5, 1.5)], 0.03).delays_s == (0.0,)


def test_description_distinguishes_incipient_slip_from_already_on():
    assert format_delay(None) == "missed"
    assert format_delay(0.0123) == "detected after 12.3 ms"
    assert format_delay(-0.006) == "detected 6.0 ms before onset, in incipient slip"
    assert format_delay(-0.01) == "already ON 10 ms before onset"


def test_an_interval_that_began_long_before_a_slip_is_on_without_slip():
    detected = [Interval(0.0, 1.2), Interval(2.0, 2.25), Interval(3.0, 3.5)]
    assert measure_false_on_s(detected, [Interval(1.0, 1.5), Interval(2.1, 2.2)]) == pytest.approx(1.0 + 0.15 + 0.5)
    assert measure_false_on_s(detected, []) == pytest.approx(1.95)


def test_number_of_slips_does_not_depend_on_the_detector():
    truth = [Interval(1.0, 1.5), Interval(1.52, 1.523), Interval(2.0, 2.1)]
    assert score([], truth, 0.001).slips == score([], truth, 0.5).slips == (Interval(1.0, 1.523), truth[2])


def make_burst(length: int = 4000, start: int = 2000, stop: int = 3000) -> Trace:
    time = np.arange(length) / 2000
    slip = (np.arange(length) >= start) & (np.arange(length) < stop)
    voltage = 2.3 + np.where(slip, 0.01 * np.sin(2 * np.pi * 90 * time), 0.0)
    return Trace(time, voltage, None, slip)


def test_a_burst_is_detected_within_the_window():
    found = detect(make_burst(), Design())
    assert len(found.intervals) == 1
    (delay,) = found.score.delays_s
    assert 0.0 < delay < 0.030
    assert found.intervals[0].onset_s == pytest.approx(1.0 + delay)
    assert 1.5 < found.intervals[0].end_s < 1.55
    assert not found.score.missed
    assert not found.score.false_intervals


def test_a_trace_without_true_slip_has_no_score():
    trace = make_burst()
    assert detect(Trace(trace.time_s, trace.voltage_v), Design()).score is None


def test_a_trace_in_memory_is_validated():
    trace = make_burst()
    invalid = Trace(trace.time_s * 2, np.where(np.arange(4000) == 7, np.nan, trace.voltage_v))
    with pytest.raises(TraceError) as caught:
        detect(invalid, Design())
    assert [issue.field for issue in caught.value.issues] == ["trace, voltage_v", "trace, time_s"]
    assert "at sample 7 is not a finite number" in str(caught.value)
    assert "--rate-hz 1000" in str(caught.value)


def test_thresholds_are_told_in_millivolts() -> None:
    constant, adapting = (UsedThreshold("statistic", 0.0123, last, 0.004, last) for last in (0.004, 0.015))
    assert constant.describe() == "threshold 4 mV"
    assert adapting.describe() == "threshold 4 to 15 mV, 12.3 at the first ON"
