"""Calibration: of a printer from caliper readings of two printed parts, and of a sensor from weighings."""
