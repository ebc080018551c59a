"""Firmware of a design: the detector `fast` as a C99 library for a controller, with examples, wiring and costs."""
