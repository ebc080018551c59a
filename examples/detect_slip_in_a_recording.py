"""Detect slip in a recording of your own, with two detectors side by side.

The recording is simulated here; `read_trace` takes your CSV, NPZ, NPY or TDMS file instead.
Run from a clone of the repository: .venv/bin/python examples/detect_slip_in_a_recording.py
"""

from fingertip import Design, Trial, detect, simulate

design = Design.load("params/fsr400.toml")
trace = simulate(design, Trial(surface="wood", speed_m_s=0.04, seed=3))
# trace = read_trace("recording.csv")

for detector in ("digital", "fast"):
    found = detect(trace, design, detector)
    print(f"{detector}: threshold {1000 * found.threshold_v:.2f} mV")
    for interval in found.intervals:
        print(f"  ON from {interval.onset_s:.4f} s to {interval.end_s:.4f} s")
