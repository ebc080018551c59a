"""Recording over a pseudo terminal: labels, lost samples,
interruptions, and the folder that is given away.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.drivers import Port, SampleReader
from fingertip.foundation.errors import FingertipError
from fingertip.recorded_trials.record import Plan, Recorded, Recorder
from fingertip.recorded_trials.trials import (
    KINDS,
    PAUSE_S,
    check_recordings,
    kind_of,
    list_trials,
    prepare_folder,
    read_recordings,
)
from tests.conftest import ROOT, run_fingertip
from tests.recorded_trials.player import HEADER, format_line

DESIGN = Design.load("first_finger")
PACE = 0.05


def record_over_a_terminal(
    folder: Path, lines: list[bytes], plan: Plan
) -> tuple[Recorded, list[str]]:
    """Record what a thread writes to a pseudo terminal, and return it with what the
    person is told.
    """
    main, other = os.openpty()
    tty.setraw(other)
    port = Port(os.ttyname(other), stale_s=0.0)
    told = list[str]()

    def write() -> None:
        with suppress(OSError):  # the recorder has all, and the terminal is closed
            for line in lines:
                os.write(main, line)

    threading.Thread(target=write, daemon=True).start()
    prepare_folder(folder, DESIGN)
    try:
        recorder = Recorder(
            DESIGN, folder, plan, lambda number, phase, line: told.append(line), told.append
        )
        return recorder.run(SampleReader(port)), told
    finally:
        port.close()
        for each in (main, other):
            os.close(each)


def test_trials_have_their_labels_and_lost_samples_are_counted(tmp_path: Path) -> None:
    """Three lines are lost in the first trial, one is damaged in
    the second, and a gap repeats the third.
    """
    count = [round(2000 * PACE * sum(KINDS[kind_of(number)].values())) for number in (1, 2, 3)]
    pause = round(2000 * PACE * PAUSE_S)  # before each force
    lines = [
        format_line(i, 1.0 + 1e-4 * (i % 7), pause + 500 <= i < pause + 600)
        for i in range(9 * count[0] + 9 * pause)
    ]
    lines[2 * pause + count[0] + 10] = b"0.4\xff05,1.0\n"
    late = 3 * pause + sum(count[:2]) + 100
    kept = [*lines[: pause + 200], *lines[pause + 203 : late], *lines[late + 60 :]]
    found, told = record_over_a_terminal(
        tmp_path, [HEADER, *kept], Plan(3, (0.5, 1.0, 2.0), "paper", pace=PACE)
    )
    assert found == Recorded((1, 2, 3), lost=4, repeated=1, samples=sum(count))
    trials = read_recordings(tmp_path)
    assert [trial.labels.lost for trial in trials] == [3, 1, 0]
    assert [trial.labels.force_n for trial in trials] == [0.5, 1.0, 2.0]
    assert {(t.labels.firmware, t.labels.surface, t.labels.design) for t in trials} == {
        ("9.9.9", "paper", "first_finger")
    }
    for trial, expected in zip(trials, count, strict=True):
        assert len(trial.trace.time_s) == expected
        assert np.diff(trial.trace.time_s) == pytest.approx(5e-4)
    assert np.flatnonzero(trials[0].trace.slip)[[0, -1]].tolist() == [500, 599]
    assert trials[0].trace.voltage_v[200:203] == pytest.approx(trials[0].trace.voltage_v[199]), (
        "as in the firmware"
    )
    assert any("trial 1 of 3, slide: let the slide go" in text for text in told)
    assert [text for text in told if "moved" in text][:1] == ["trial 1: moved for 50 ms"], "at once"


def test_a_folder_is_given_away_when_all_is_filled_in_and_somebody_agreed(tmp_path: Path) -> None:
    lines = b"".join([HEADER, *(format_line(i, 1.0 + 1e-4 * (i % 7), 0) for i in range(4000))])
    words = (
        "--trials",
        "1",
        "--force-n",
        "1.5",
        "--surface",
        "paper",
        "--stroke-mm",
        "25",
        "--onset-error-ms",
        "3",
    )
    record = (
        "record",
        "first_finger",
        "--port",
        "-",
        "--pace",
        str(PACE),
        "--temperature-c",
        "21",
        *words,
    )
    assert run_fingertip(*record, given=lines.decode(), PWD=str(tmp_path)).returncode == 0
    (tmp_path / "measured").mkdir()
    (tmp_path / "measured/recordings.txt").write_text("of somebody else")
    compare = ("validate", "--recordings", "out/first_finger/recordings", "--out", "measured")
    assert "measured/recordings.txt" in run_fingertip(*compare, PWD=str(tmp_path)).stderr
    tmp_path /= "out/first_finger/recordings"
    labels = read_recordings(tmp_path)[0].labels
    assert (labels.force_n, labels.surface, labels.temperature_c) == (1.5, "paper", 21.0)
    assert (labels.stroke_m, labels.onset_error_s) == (0.025, 0.003)
    done = run_fingertip("check", str(tmp_path))
    assert done.returncode == 1
    assert "nobody agrees" in done.stdout
    assert "is open in line" in done.stdout
    for name in ("README.md", "CONSENT.md"):
        text = (
            (tmp_path / name).read_text().replace("agrees: FILL IN with yes or no", "agrees: yes")
        )
        (tmp_path / name).write_text(text.replace("FILL IN", "somebody"))
    assert check_recordings(tmp_path) == (1, [], [])
    trial = (tmp_path / "trial_0001.csv").read_bytes()
    (tmp_path / "trial_0001.csv").write_bytes(
        trial.replace(b'"simulated":false', b'"simulated":true')
    )
    assert ["1 trials are simulated" in note for note in check_recordings(tmp_path)[2]] == [True]
    damaged = (
        (tmp_path / "trial_0001.csv").read_bytes().replace(b'"kind":"slide"', b'"kind":"glide"')
    )
    (tmp_path / "trial_0001.csv").write_bytes(damaged)
    assert [
        "(kind: input should be 'slide', " in fault for fault in check_recordings(tmp_path)[1]
    ] == [True]


@pytest.mark.parametrize(
    "words",
    [("--port", "/dev/no_such"), ("--force-n", "1,-2"), ("--trials", "0"), ("--pace", "9e9")],
)
def test_what_cannot_be_is_refused_before_a_folder_is_made(
    words: tuple[str, str], tmp_path: Path
) -> None:
    done = run_fingertip(
        "record", "first_finger", "--port", "/dev/null", *words, "--out", str(tmp_path / "new")
    )
    assert done.returncode == 2
    assert not (tmp_path / "new").exists()


def test_a_silent_port_and_a_stream_that_ends_are_named(tmp_path: Path) -> None:
    read, write = os.pipe()
    with pytest.raises(FingertipError, match=r"sends nothing for 0\.1 s"):
        list(Port(f"/dev/fd/{read}", 0.1))
    os.close(write)
    words = ("record", "first_finger", "--port", "-", "--out", str(tmp_path))
    done = run_fingertip(*words, given="time_s,voltage_v\n0,1\n")
    assert done.returncode == 2
    assert "ended in trial 1, which is not kept" in done.stderr


@contextmanager
def playing(folder: Path, volts: np.ndarray | None = None) -> Iterator[str]:
    """Process that plays the firmware's stream at 2 kHz; yields the name of its terminal."""
    volts = np.linspace(0.5, 1.5, 4001) if volts is None else volts
    np.save(folder / "samples.npy", np.column_stack([volts, np.arange(len(volts)) % 3 == 0]))
    command = [
        sys.executable,
        "-m",
        "tests.recorded_trials.player",
        str(folder / "samples.npy"),
        "2000",
    ]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    ) as player:
        assert player.stdout
        try:
            yield player.stdout.readline().strip()
        finally:
            player.kill()


def start(port: str, folder: Path, *words: str) -> subprocess.Popen[str]:
    command = [
        sys.executable,
        "-m",
        "fingertip",
        "record",
        "first_finger",
        "--port",
        port,
        "--out",
        str(folder),
    ]
    return subprocess.Popen(
        [*command, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.full
def test_forty_trials_at_two_kilohertz_lose_nothing(tmp_path: Path) -> None:
    with playing(tmp_path) as port:
        said, errors = start(port, tmp_path / "out", "--pace", str(PACE)).communicate(timeout=300)
    assert "40 trials, " in said, errors
    assert " 0 lost, 0 trials repeated" in said, errors
    assert {trial.labels.lost for trial in read_recordings(tmp_path / "out")} == {0}


@pytest.mark.full
def test_fifty_interruptions_leave_no_damaged_file(tmp_path: Path) -> None:
    ended = []
    with playing(tmp_path) as port:
        for number in range(50):
            process = start(port, tmp_path / "out", "--pace", "0.02", "--trials", "9999")
            assert process.stderr
            while " of 9999, " not in process.stderr.readline():  # until it records
                assert process.poll() is None
            time.sleep(0.1 + 0.011 * number)
            process.send_signal(signal.SIGINT if number % 2 else signal.SIGKILL)
            process.communicate(timeout=60)
            ended.append(process.returncode)
            assert [path.name for path in list_trials(tmp_path / "out")] == [
                f"trial_{i:04}.csv" for i in range(1, 1 + len(list_trials(tmp_path / "out")))
            ]
    assert set(ended) == {-signal.SIGKILL, 128 + signal.SIGINT}
    count, faults, _ = check_recordings(tmp_path / "out")
    assert count >= 50
    assert [fault for fault in faults if fault.startswith("trial")] == []


@pytest.mark.long
def test_thirty_minutes_lose_nothing(tmp_path: Path) -> None:
    with playing(tmp_path) as port:
        words = ("--pace", "4.9", "--trials", "45")
        said, errors = start(port, tmp_path / "out", *words).communicate(timeout=2400)
    assert " 0 lost, 0 trials repeated" in said, errors
    assert (
        sum(len(trial.trace.time_s) for trial in read_recordings(tmp_path / "out"))
        >= 30 * 60 * 2000
    )
