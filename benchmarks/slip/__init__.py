"""Benchmark of slip detectors, `fingertip bench slip`: labelled recordings, detectors, and what they reach on them."""
