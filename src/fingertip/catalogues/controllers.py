"""Catalogue of controllers on which the examples of the firmware are meant to run."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ControllerBoard:
    """Controller's board that can be bought, with its Arduino core where the examples need one."""

    name: str
    processor: str
    clock_mhz: float
    """Clock, of the slowest board of the row."""
    has_floats: bool
    """True if the processor computes floats itself."""
    converter: str
    """Resolution and range of the analog inputs."""
    timer: str
    """Answer to whether `slip_timer.h` has its timer."""
    note: str

    @property
    def core(self) -> str:
        """Processor, its clock, and whether it computes floats itself."""
        floats = "with floats" if self.has_floats else "floats in software"
        return f"{self.processor} at {self.clock_mhz:g} MHz, {floats}"


# The facts are common knowledge of these boards, not checked against their makers' pages. None has run the library yet.
BOARDS = (
    ControllerBoard(
        "Teensy 4.0, 4.1", "Cortex-M7", 600, True, "12 bits, 0 to 3.3 V", "yes", "its pins do not bear 5 V"
    ),
    ControllerBoard(
        "STM32 Nucleo-64 F446RE, F411RE", "Cortex-M4F", 100, True, "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino; serial port of the ST-Link",
    ),
    ControllerBoard(
        "STM32 Nucleo-64 F103RB", "Cortex-M3", 72, False, "12 bits, 0 to 3.3 V", "yes", "as the other Nucleo-64"
    ),
    ControllerBoard(
        "STM32 Blue Pill", "Cortex-M3", 72, False, "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino; its LED at PC13 lights while the pin is low: set `SLIP_PIN` to another GPIO such as PB12",
    ),
    ControllerBoard(
        "Arduino Due", "Cortex-M3", 84, False, "12 bits, 0 to 3.3 V", "no", "start a timer of your own"
    ),
    ControllerBoard(
        "Arduino UNO R4 Minima, WiFi", "Cortex-M4F", 48, True, "12 of 14 bits, 0 to 5 V", "yes",
        "make the library with `--set detector.adc_range_v=5`; feed the board from its 3.3 V",
    ),
    ControllerBoard(
        "Raspberry Pi Pico", "Cortex-M0+", 125, False, "12 bits, 0 to 3.3 V", "yes",
        "core of Earle Philhower; A0 is GP26, A1 is GP27; LED at GP25",
    ),
    ControllerBoard(
        "Raspberry Pi Pico W", "Cortex-M0+", 125, False, "12 bits, 0 to 3.3 V", "yes",
        "as the Pico, but its LED hangs on the radio and not on a GPIO: set `SLIP_PIN` to a GPIO such as 15",
    ),
    ControllerBoard("Raspberry Pi Pico 2", "Cortex-M33", 150, True, "12 bits, 0 to 3.3 V", "yes", "as the Pico"),
)  # fmt: skip
