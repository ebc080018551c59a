"""Process that plays the firmware's stream: the lines of `slip_line.h` on a pseudo terminal, of
simulated trials.

`python -m tests.recorded_trials.player FILE.npy RATE_HZ` opens a pseudo terminal, prints its name,
and writes the samples of FILE (columns voltage_v, moving), again and again, at that rate; at 0 as
fast as they are read.
"""

from __future__ import annotations

import os
import sys
import time
import tty
from contextlib import suppress
from pathlib import Path

import numpy as np

from fingertip.design import Design
from fingertip.recorded_trials.trials import KINDS, PAUSE_S, kind_of
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile

RING = 1024
HEADER = b"# fingertip 9.9.9\ntime_s,voltage_v,moving\n"


def format_line(number: int, volts: float, moving: float, rate_hz: float = 2000.0) -> bytes:
    """Line of a sample, as `slip_format_line` of the firmware writes it."""
    return b"%d.%06d,%.6f,%d\n" % (*divmod(round(number * 1e6 / rate_hz), 1_000_000), volts, moving)


def slide_scene(surface: str, force_n: float, speed_m_s: float, felt_um: float = 0.0) -> SceneFile:
    return SceneFile(
        scene="sliding_finger",
        contact={"surface": surface},
        surface={"felt_um": felt_um},
        hold={"min_force_n": force_n, "max_force_n": force_n},
        slide={"distance_m": 0.04, "speed_m_s": speed_m_s},
    )


def simulate_person(
    design: Design,
    trials: int,
    forces_n: tuple[float, ...],
    surface: str,
    felt_um: float = 0.0,
    speed_m_s: float = 0.06,
) -> np.ndarray:
    """Samples (n, 2) of a person who follows the schedule of `trials` trials to the moment."""
    rate = design.detector.sample_rate_hz
    parts = []
    for number in range(1, trials + 1):
        phases = KINDS[kind_of(number)]
        kind = kind_of(number)
        force_n = forces_n[(number - 1) * len(forces_n) // trials]
        scene = slide_scene(surface, force_n, speed_m_s, felt_um)
        if kind != "slide":
            scene = SceneFile(
                scene="contact", hold={"min_force_n": force_n, "max_force_n": force_n, "min_s": 5.0}
            )
        done = run_scene(design, scene, number)
        trace = done.trace
        count = round(rate * sum(phases.values()))
        start_s = (
            trace.origin.motion_s
            if kind == "slide"
            else trace.time_s[np.argmax(trace.force_n > 0.9 * force_n)]
        )
        told_s = (
            phases["away"] + phases["press"] + (phases["wait"] + 0.2 if kind == "slide" else -0.2)
        )
        shift = round(rate * (told_s - start_s))
        volts = np.full(count, np.median(trace.voltage_v[:200]))
        moving = np.zeros(count)
        volts += np.random.default_rng(number).normal(0.0, design.detector.noise_v, count)
        place = slice(max(0, shift), min(count, shift + len(trace.voltage_v)))
        volts[place] = trace.voltage_v[place.start - shift : place.stop - shift]
        if kind == "slide":
            lasts_s = 0.04 / speed_m_s + speed_m_s / 1.0
            moving[round(rate * told_s) : round(rate * (told_s + lasts_s))] = 1
        if number == 1 or force_n != forces_n[(number - 2) * len(forces_n) // trials]:
            parts.append(np.zeros((round(PAUSE_S * rate), 2)))
        parts.append(np.column_stack([np.clip(volts, 0.0, design.detector.adc_range_v), moving]))
    return np.concatenate(parts)


def play(samples: np.ndarray, rate_hz: float) -> None:
    """Write samples as a controller does: those that nobody reads
    wait in a ring of 1024, as in slip_buffer.h.
    """
    main, other = os.openpty()
    tty.setraw(other)
    print(os.ttyname(other), flush=True)
    os.set_blocking(main, rate_hz == 0)
    start = time.monotonic()
    number = 0
    waiting = b""
    while True:
        due = number + 200 if rate_hz == 0 else int((time.monotonic() - start) * rate_hz)
        if waiting and due - number > RING:  # nobody reads: this process may be late itself
            number = due
        while not waiting and number < due:
            waiting = HEADER * (number % 2000 == 0) + format_line(
                number, *samples[number % len(samples)]
            )
            number += 1
            try:
                waiting = waiting[os.write(main, waiting) :]
            except BlockingIOError:
                break
        else:
            time.sleep(0.005 * (rate_hz > 0))
        if waiting:
            time.sleep(0.002)
            with suppress(BlockingIOError):
                waiting = waiting[os.write(main, waiting) :]


if __name__ == "__main__":
    play(np.load(Path(sys.argv[1])), float(sys.argv[2]))
