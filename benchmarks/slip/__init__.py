"""Benchmark of slip detectors: labelled recordings, detectors, and what they reach on them."""
