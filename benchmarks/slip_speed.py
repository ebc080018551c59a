"""Time per sample of the detectors beside scipy's filter alone, in one run; memory of a long stream.

    python benchmarks/slip_speed.py [--samples 2000000] [--chunk 100000] [--stream 1000000000]

scipy.signal.sosfilt does the third-order high-pass only; `digital`, the article's whole chain in software, does that,
rectification, envelope, window and threshold; `fast` eight filters and two moving bars; `analog` window and threshold,
the rest being the board's. All take the same samples in the same chunks; the best of several rounds counts, with the
contenders taking turns, so that a busy machine is as busy for each.
"""

from __future__ import annotations

import argparse
import json
import pickle
import sys
import time
from collections.abc import Callable

import numpy as np

from fingertip.design import Design
from fingertip.slip import make

ROUNDS = 7


def main() -> None:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--samples", type=int, default=2_000_000)
    arguments.add_argument("--chunk", type=int, default=100_000)
    arguments.add_argument("--stream", type=int, default=1_000_000_000, help="samples of the memory test")
    given = arguments.parse_args()
    stream = memory(given.stream, given.chunk)  # first, before anything large was ever held
    print(json.dumps(measure(given.samples, given.chunk) | stream, indent=2))


def measure(samples: int, chunk: int) -> dict[str, object]:
    from scipy import signal

    design = Design()
    volts = np.random.default_rng(0).normal(4.0, 4e-4, samples)
    chunks = np.split(volts, range(chunk, samples, chunk))
    sos = signal.butter(3, design.board.cutoff_hz, "high", fs=design.detector.sample_rate_hz, output="sos")

    def by_scipy() -> None:
        state = signal.sosfilt_zi(sos) * volts[0]
        for part in chunks:
            _, state = signal.sosfilt(sos, part, zi=state)

    def by(name: str) -> Callable[[], None]:
        def run() -> None:
            detector = make(name, design)
            for part in chunks:
                detector.process(part)

        return run

    import numba  # noqa: F401  (streams as long as these fetch it by themselves; here it is there from the start)

    rivals = {"sosfilt": by_scipy, "digital": by("digital"), "fast": by("fast"), "analog": by("analog")}
    best = dict.fromkeys(rivals, float("inf"))
    for run in rivals.values():
        run()  # loads or compiles
    for _ in range(ROUNDS):
        for name, run in rivals.items():
            best[name] = min(best[name], timed(run))
    per_sample = {name: 1e9 * seconds / samples for name, seconds in best.items()}
    return {
        "ns_per_sample": {name: round(ns, 2) for name, ns in per_sample.items()},
        "times_sosfilt": {name: round(ns / per_sample["sosfilt"], 2) for name, ns in per_sample.items()},
        "step_us": {name: round(step_us(name, volts[:100_000]), 3) for name in ("digital", "fast", "analog", "fft")},
        "plain_python_ns": {
            name: round(plain_ns(name, volts[:100_000]), 1) for name in ("digital", "fast", "analog", "fft")
        },
    }


def timed(run: Callable[[], None]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def step_us(name: str, volts: np.ndarray) -> float:
    """Of one sample at a time [us]."""
    detector, samples = make(name, Design()), volts.tolist()

    def run() -> None:
        step = detector.step
        for x in samples:
            step(x)

    return 1e6 * min(timed(run) for _ in range(3)) / len(samples)


def plain_ns(name: str, volts: np.ndarray) -> float:
    """Of `process` without numba [ns]."""
    from fingertip.slip.detectors import kernel

    there, kernel.available = kernel.available, lambda: False
    try:
        return 1e9 * min(timed(lambda: make(name, Design()).process(volts)) for _ in range(3)) / len(volts)
    finally:
        kernel.available = there


def memory(samples: int, chunk: int) -> dict[str, object]:
    """Peak memory [MB] after the first chunk of a stream, after a tenth of it, and at its end."""
    import resource

    import numba  # noqa: F401

    def peak() -> float:
        kilo = 1 if sys.platform != "darwin" else 1024
        return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024 / kilo, 1)

    # The same noise again and again: drawing new would take longer than detecting in it.
    part, detector = np.random.default_rng(1).normal(4.0, 4e-4, chunk), make("fast", Design())
    detector.process(part)
    peaks, done = [peak()], chunk
    start = time.perf_counter()
    while done < samples:
        detector.process(part)
        done += chunk
        if len(peaks) == 1 and done >= samples / 10:
            peaks.append(peak())
            detector = pickle.loads(pickle.dumps(detector))  # and goes on
    seconds = time.perf_counter() - start
    return {
        "stream_samples": done,
        "stream_s": round(seconds, 2),
        "state_bytes": len(pickle.dumps(detector)),
        "peak_mb": [*peaks, peak()],
    }


if __name__ == "__main__":
    main()
