"""Calibration: of a printer from readings of the fit coupon, and of a sensor from weighings."""
