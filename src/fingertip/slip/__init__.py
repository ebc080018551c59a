"""Slip detection on a sampled voltage: traces, detectors and intervals, independent of the simulation."""
