"""Slip detectors: analog, digital, FFT and fast, behind one interface."""
