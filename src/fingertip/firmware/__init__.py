"""Firmware of a design: the detector `fast` as a C99 library for a microcontroller, with examples and wiring."""
