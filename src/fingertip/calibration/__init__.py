"""Calibration of a printer: lengths of the fit coupon, their readings, and the parameters that follow from them."""
