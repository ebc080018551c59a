"""True slip: intervals of flags, their score against the truth, and
which recordings are known to be simulated.
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip import Design, Trace, detect, detect_file
from fingertip.catalogues.output_files import SIGNAL
from fingertip.foundation.errors import TraceError
from fingertip.slip.traces.truth import (
    STICK_S,
    Interval,
    Origin,
    SlipCollector,
    intervals,
    measure_false_on_s,
    merge,
    read_origin,
    score,
)
from fingertip.tasks.make import simulate_and_detect
from tests.slip.recordings import T, V

STEP_S = 1 / 64  # times and gaps are exact
FLAGS = st.lists(st.booleans(), min_size=1, max_size=60)


def find_runs(flags: list[bool], gap: int = 0) -> list[range]:
    """Runs of True as ranges of samples; runs no further apart than a gap are one."""
    runs: list[range] = []
    for is_on, group in groupby(enumerate(flags), key=lambda pair: pair[1]):
        at = [number for number, _ in group]
        if is_on and runs and at[0] - runs[-1].stop <= gap:
            runs[-1] = range(runs[-1].start, at[-1] + 1)
        elif is_on:
            runs.append(range(at[0], at[-1] + 1))
    return runs


def as_intervals(runs: list[range]) -> tuple[Interval, ...]:
    return tuple(Interval(run.start * STEP_S, run.stop * STEP_S) for run in runs)


@given(FLAGS, FLAGS, st.integers(0, 6), st.lists(st.integers(0, 61), max_size=5))
def test_detections_are_scored_as_sets_of_samples_say(
    detected: list[bool], truth: list[bool], memory: int, cuts: list[int]
) -> None:
    """Against runs of samples; the times are cut into chunks anywhere.

    Slips 50 ms apart are one.
    """
    count = max(len(detected), len(truth)) + 1
    time_s = np.arange(count) * STEP_S
    on, slip = (np.array([*flags, *[False] * (count - len(flags))]) for flags in (detected, truth))
    collector = SlipCollector()
    for part, times in zip(np.split(on, sorted(cuts)), np.split(time_s, sorted(cuts)), strict=True):
        collector.add(times, part)
    runs = find_runs(on.tolist())
    slips = find_runs(slip.tolist(), int(STICK_S / STEP_S))
    found = collector.close()
    assert found == intervals(time_s, on) == as_intervals(runs) == collector.close()
    assert merge(intervals(time_s, slip), STICK_S) == as_intervals(slips)
    scored = score(found, intervals(time_s, slip), memory * STEP_S)
    assert scored.slips == as_intervals(slips)
    first = [next((run for run in runs if set(run) & set(one)), None) for one in slips]
    delays = [
        None if run is None else (run.start - one.start) * STEP_S
        for run, one in zip(first, slips, strict=True)
    ]
    assert list(scored.delays_s) == delays
    assert scored.missed == as_intervals(
        [one for one, run in zip(slips, first, strict=True) if run is None]
    )
    false = [
        run
        for run in runs
        if not any(set(run) & set(range(one.start, one.stop + memory)) for one in slips)
    ]
    assert scored.false_intervals == as_intervals(false)
    slipping = {number for one in slips for number in one}
    assert (
        measure_false_on_s(found, scored.slips)
        == sum(number not in slipping for run in runs for number in run) * STEP_S
    )


def test_an_interval_of_the_last_sample_has_no_length_but_counts() -> None:
    """An interval that is open at the end of a trace ends at its last sample."""
    (last,) = intervals(np.array([1.0, 1.25, 1.5]), np.array([False, False, True]))
    assert last == Interval(1.5, 1.5)
    assert score([last], [last], 0.03).delays_s == (0.0,)
    assert last.overlaps(Interval(1.0, 1.5))
    assert Interval(1.0, 1.5).overlaps(last)
    assert not Interval(2.5, 2.5).overlaps(Interval(1.0, 2.0))


def test_a_trace_in_memory_is_validated() -> None:
    invalid = Trace(T * 2, np.where(np.arange(len(T)) == 7, np.nan, V))
    with pytest.raises(TraceError, match="at sample 7 is not a finite number") as caught:
        detect(invalid, Design.load(changes={"detector.sample_rate_hz": 2000}))
    assert [issue.field for issue in caught.value.issues] == ["trace, voltage_v", "trace, time_s"]
    assert "rate_hz=1000" in str(caught.value)


@pytest.mark.full
def test_files_of_a_set_are_simulated_unless_they_were_changed(tmp_path: Path) -> None:
    trial = simulate_and_detect(Design())
    contents = trial.files
    made = trial.detection
    folder = tmp_path / "signal"
    SIGNAL.writer(Design(), folder).write(contents)
    origin = read_origin(folder / "trace.csv")
    assert origin.is_simulated
    assert origin.motion_s == pytest.approx(made.trace.origin.motion_s, abs=1e-7)
    assert detect_file(folder / "trace.csv").trace.origin == origin
    (tmp_path / "own.csv").write_bytes(contents["trace.csv"])
    assert read_origin(tmp_path / "own.csv") == Origin()
    (folder / "detection.json").write_text("{}")  # no longer what was written
    assert read_origin(folder / "trace.csv") == Origin(is_simulated=True)
    with (folder / "trace.csv").open("a") as file:
        file.write("\n")
    assert read_origin(folder / "trace.csv") == Origin()
