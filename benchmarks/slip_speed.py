"""Time per sample of the detectors beside scipy's filter, break-even of compiled code, and memory
of a long stream.

    python benchmarks/slip_speed.py [--samples 2000000] [--chunk 100000] [--stream 1000000000]

scipy.signal.sosfilt applies the third-order high-pass only. `digital`, the article's whole chain in
software, applies that, rectification, envelope, window and threshold. `fast` applies four filters
and, every 2 ms, 160 trees. `analog` applies window and threshold only, because the board does the
rest. All take the same samples in the same chunks. The best of several rounds counts, and the
contenders take turns, so that other load on the machine affects all alike.
"""

from __future__ import annotations

import argparse
import json
import pickle
import statistics
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np

from fingertip.design import Design
from fingertip.foundation import jit
from fingertip.slip.detectors import analog_and_digital
from fingertip.slip.detectors.registry import make_detector

ROUNDS = 7
COLD_ROUNDS = 5
COMPILED_DETECTORS = ("digital", "fast", "analog")
DETECTORS = (*COMPILED_DETECTORS, "fft")
_LOAD = """
import json, time
import numpy as np
from fingertip.foundation import jit
from fingertip.design import Design
from fingertip.slip.detectors.registry import make_detector
detectors = [make_detector(name, Design()) for name in ("digital", "fast")]
moments = [time.process_time()]
import numba
for detector in detectors:
    moments.append(time.process_time())
    with jit.compiled():
        detector.process(np.full(1000, 4.0))
moments.append(time.process_time())
print(json.dumps([after - before for before, after in zip(moments, moments[1:])]))
"""


def main() -> None:
    """Print all measurements as JSON."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--samples", type=int, default=2_000_000)
    parser.add_argument("--chunk", type=int, default=100_000)
    parser.add_argument(
        "--stream", type=int, default=1_000_000_000, help="samples of the memory test"
    )
    arguments = parser.parse_args()

    with jit.compiled():
        # First, before the process holds large arrays.
        memory = measure_memory(arguments.stream, arguments.chunk)

    speed = measure_speed(arguments.samples, arguments.chunk)
    print(json.dumps(speed | measure_break_even(arguments.samples) | memory, indent=2))


def measure_speed(samples: int, chunk: int) -> dict[str, object]:
    """Time per sample of each detector and of scipy's filter,
    compiled, in plain Python, and one sample at a time.
    """
    from scipy import signal

    design = Design()
    volts = np.random.default_rng(0).normal(4.0, 4e-4, samples)
    chunks = np.split(volts, range(chunk, samples, chunk))
    sos = signal.butter(
        3, design.board.cutoff_hz, "high", fs=design.detector.sample_rate_hz, output="sos"
    )

    def run_scipy() -> None:
        state = signal.sosfilt_zi(sos) * volts[0]
        for part in chunks:
            _, state = signal.sosfilt(sos, part, zi=state)

    def detector_run(name: str) -> Callable[[], None]:
        def run() -> None:
            detector = make_detector(name, design)
            for part in chunks:
                detector.process(part)

        return run

    contenders = {"sosfilt": run_scipy} | {name: detector_run(name) for name in COMPILED_DETECTORS}
    best = dict.fromkeys(contenders, float("inf"))
    with jit.compiled():
        for run in contenders.values():
            run()  # loads or compiles

        for _ in range(ROUNDS):
            for name, run in contenders.items():
                best[name] = min(best[name], timed(run))

    per_sample = {name: 1e9 * seconds / samples for name, seconds in best.items()}
    return {
        "ns_per_sample": {name: round(ns, 2) for name, ns in per_sample.items()},
        "times_sosfilt": {
            name: round(ns / per_sample["sosfilt"], 2) for name, ns in per_sample.items()
        },
        "step_us": {name: round(measure_step_us(name, volts[:100_000]), 3) for name in DETECTORS},
        "plain_python_ns": {
            name: round(measure_plain_ns(name, volts[:100_000]), 1) for name in DETECTORS
        },
    }


def timed(run: Callable[[], None]) -> float:
    """Elapsed time of one run [s]."""
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def measure_step_us(name: str, volts: np.ndarray) -> float:
    """Time of `step` per sample [us]."""
    detector = make_detector(name, Design())
    samples = volts.tolist()

    def run() -> None:
        step = detector.step
        for x in samples:
            step(x)

    return 1e6 * min(timed(run) for _ in range(3)) / len(samples)


def measure_plain_ns(name: str, volts: np.ndarray) -> float:
    """Time of `process` per sample without numba [ns]."""
    original = jit.available
    jit.available = lambda: False

    try:
        return (
            1e9
            * min(timed(lambda: make_detector(name, Design()).process(volts)) for _ in range(3))
            / len(volts)
        )
    finally:
        jit.available = original


def measure_break_even(samples: int) -> dict[str, object]:
    """Preparation that compiled code costs a process, samples from which it is used, and the time
    of one long call.

    The long call runs in a fresh process without a `compiled()` block: the policy decides.
    """
    from fingertip.slip.detectors import fast_inputs

    loads = [json.loads(run_python(_LOAD)) for _ in range(COLD_ROUNDS)]
    imported, first, second = (
        round(statistics.median(column), 3) for column in zip(*loads, strict=True)
    )
    call = (
        "import time; import numpy as np; from fingertip.design import Design; "
        "from fingertip.slip.detectors.registry import make_detector; volts = np.full({samples}, "
        "4.0); "
        "detector = make_detector('{name}', Design()); start = time.process_time(); "
        "detector.process(volts); print(time.process_time() - start)"
    )
    loops = {
        "digital": analog_and_digital._FILTER,
        "fast": fast_inputs._FILTER,
        "analog": analog_and_digital._AVERAGE,
    }

    return {
        "load_s": {
            "import_numba": imported,
            "first_loop": first,
            "next_loop": second,
            "policy": jit.LOAD_S,
        },
        "break_even_samples": {name: loop.break_even for name, loop in loops.items()},
        "one_call_s": {
            name: {
                count: round(
                    min(float(run_python(call.format(samples=count, name=name))) for _ in range(3)),
                    3,
                )
                for count in (12_000, round(0.9 * loop.break_even), loop.break_even, samples)
            }
            for name, loop in loops.items()
        },
    }


def run_python(code: str) -> str:
    """Output of a program in a fresh process."""
    return subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout


def measure_memory(samples: int, chunk: int) -> dict[str, object]:
    """Peak memory [MB] after the first chunk of a stream, after a tenth of it, and at its end."""
    import resource

    def peak() -> float:
        kilo = 1 if sys.platform != "darwin" else 1024
        return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024 / kilo, 1)

    # One chunk of noise is repeated, because drawing noise would take longer than processing it.
    part = np.random.default_rng(1).normal(4.0, 4e-4, chunk)
    detector = make_detector("fast", Design())
    detector.process(part)
    peaks = [peak()]
    done = chunk
    start = time.perf_counter()

    while done < samples:
        detector.process(part)
        done += chunk
        if len(peaks) == 1 and done >= samples / 10:
            peaks.append(peak())
            detector = pickle.loads(pickle.dumps(detector))

    seconds = time.perf_counter() - start
    return {
        "stream_samples": done,
        "stream_s": round(seconds, 2),
        "state_bytes": len(pickle.dumps(detector)),
        "peak_mb": [*peaks, peak()],
    }


if __name__ == "__main__":
    main()
