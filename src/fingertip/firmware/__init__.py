"""Firmware of a design: the detector `fast` as a C99 library for a controller, with examples, wiring and costs."""

from fingertip.firmware.output import firmware_differences, firmware_files, firmware_folder, write_firmware

__all__ = ["firmware_differences", "firmware_files", "firmware_folder", "write_firmware"]
