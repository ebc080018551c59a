"""Catalogue of controllers on which the examples of the firmware are meant to run."""

from __future__ import annotations

from dataclasses import dataclass

NAMES = ("thumb", "index", "middle", "ring", "little")
"""Names of the fingers that one controller reads, in the order of its inputs and of a board's channels."""


@dataclass(frozen=True)
class ControllerBoard:
    """Controller's board that can be bought, with its Arduino core where the examples need one."""

    key: str
    """Name for the command line."""
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
    inputs: str
    """Analog inputs that are free, as its core names them, separated by spaces."""
    ram_kb: int
    convert_us: float
    """Time in which one input is converted [us]: by `analogRead`, or in a scan by DMA."""
    has_scan: bool = False
    """True if the converter scans all inputs by itself, and the interrupt waits for none."""

    @property
    def core(self) -> str:
        """Processor, its clock, and whether it computes floats itself."""
        floats = "with floats" if self.has_floats else "floats in software"
        return f"{self.processor} at {self.clock_mhz:g} MHz, {floats}"


# The facts are common knowledge of these boards, not checked against their makers' pages. None has run the library yet.
# The times of `analogRead` are orders of magnitude; those of a scan follow from 96 cycles of the converter's clock.
BOARDS = (
    ControllerBoard(
        "teensy40", "Teensy 4.0, 4.1", "Cortex-M7", 600, True, "12 bits, 0 to 3.3 V", "yes",
        "its pins do not bear 5 V",
        "A0 A1 A2 A3 A4 A5 A6 A7 A8 A9 A10 A11 A12 A13", 512, 10,
    ),
    ControllerBoard(
        "nucleo_f446re", "STM32 Nucleo-64 F446RE, F411RE", "Cortex-M4F", 100, True, "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino; serial port of the ST-Link",
        "PA0 PA1 PA4 PB0 PC1 PC0 PC2 PC3 PC4 PC5", 128, 4, True,
    ),
    ControllerBoard(
        "black_pill_f411", "STM32 Black Pill F411CE", "Cortex-M4F", 100, True, "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino, BlackPill F411CE with USB as serial port; its button KEY grounds PA0; its LED at PC13 lights "
        "while the pin is low: set `SLIP_PIN` to another GPIO such as PB12",
        "PA0 PA1 PA2 PA3 PA4 PA5 PA6 PA7 PB0 PB1", 128, 4, True,
    ),
    ControllerBoard(
        "nucleo_f103rb", "STM32 Nucleo-64 F103RB", "Cortex-M3", 72, False, "12 bits, 0 to 3.3 V", "yes",
        "as the other Nucleo-64",
        "PA0 PA1 PA4 PB0 PC1 PC0 PC2 PC3 PC4 PC5", 20, 50,
    ),
    ControllerBoard(
        "blue_pill", "STM32 Blue Pill", "Cortex-M3", 72, False, "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino; its LED at PC13 lights while the pin is low: set `SLIP_PIN` to another GPIO such as PB12",
        "PA0 PA1 PA2 PA3 PA4 PA5 PA6 PA7 PB0 PB1", 20, 50,
    ),
    ControllerBoard(
        "due", "Arduino Due", "Cortex-M3", 84, False, "12 bits, 0 to 3.3 V", "no", "start a timer of your own",
        "A0 A1 A2 A3 A4 A5 A6 A7 A8 A9 A10 A11", 96, 5,
    ),
    ControllerBoard(
        "uno_r4", "Arduino UNO R4 Minima, WiFi", "Cortex-M4F", 48, True, "12 of 14 bits, 0 to 5 V", "yes",
        "make the library with `--set detector.adc_range_v=5`; feed the board from its 3.3 V",
        "A0 A1 A2 A3 A4 A5", 32, 22,
    ),
    ControllerBoard(
        "pico", "Raspberry Pi Pico", "Cortex-M0+", 125, False, "12 bits, 0 to 3.3 V", "yes",
        "core of Earle Philhower; A0 is GP26, A1 is GP27; LED at GP25",
        "A0 A1 A2", 264, 5,
    ),
    ControllerBoard(
        "pico_w", "Raspberry Pi Pico W", "Cortex-M0+", 125, False, "12 bits, 0 to 3.3 V", "yes",
        "as the Pico, but its LED hangs on the radio and not on a GPIO: set `SLIP_PIN` to a GPIO such as 15",
        "A0 A1 A2", 264, 5,
    ),
    ControllerBoard(
        "pico_2", "Raspberry Pi Pico 2", "Cortex-M33", 150, True, "12 bits, 0 to 3.3 V", "yes", "as the Pico",
        "A0 A1 A2", 520, 5,
    ),
)  # fmt: skip
