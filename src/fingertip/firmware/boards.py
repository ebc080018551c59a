"""Controllers on which the examples are meant to run: supply of their inputs, converter, and what to watch for.

The facts are common knowledge of these boards, not checked against their makers' pages. None has run the library yet.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ControllerBoard:
    """Controller's board that can be bought, with its Arduino core where the examples need one."""

    name: str
    core: str
    """Processor, and whether it computes floats itself."""
    converter: str
    """Resolution and range of the analog inputs."""
    timer: str
    """Answer to whether `slip_timer.h` has its timer."""
    note: str


BOARDS = (
    ControllerBoard(
        "Teensy 4.0, 4.1", "Cortex-M7, with floats", "12 bits, 0 to 3.3 V", "yes", "its pins do not bear 5 V"
    ),
    ControllerBoard(
        "STM32 Nucleo-64 F446RE, F411RE", "Cortex-M4F, with floats", "12 bits, 0 to 3.3 V", "yes",
        "core STM32duino; serial port of the ST-Link",
    ),
    ControllerBoard(
        "STM32 Nucleo-64 F103RB, Blue Pill", "Cortex-M3, floats in software", "12 bits, 0 to 3.3 V", "yes",
        "like a Cortex-M0+ in the table of costs: run the detector in loop()",
    ),
    ControllerBoard(
        "Arduino Due", "Cortex-M3, floats in software", "12 bits, 0 to 3.3 V", "no", "start a timer of your own"
    ),
    ControllerBoard(
        "Arduino UNO R4 Minima, WiFi", "Cortex-M4F, with floats", "12 of 14 bits, 0 to 5 V", "yes",
        "make the library with `--set detector.adc_range_v=5`; feed the board from its 3.3 V",
    ),
    ControllerBoard(
        "Raspberry Pi Pico", "Cortex-M0+, floats in software", "12 bits, 0 to 3.3 V", "yes",
        "core of Earle Philhower; A0 is GP26, A1 is GP27; LED at GP25",
    ),
    ControllerBoard(
        "Raspberry Pi Pico W", "Cortex-M0+, floats in software", "12 bits, 0 to 3.3 V", "yes",
        "as the Pico, but its LED hangs on the radio and not on a GPIO, too slow for an interrupt: set `SLIP_PIN` to "
        "a GPIO such as 15",
    ),
    ControllerBoard(
        "Raspberry Pi Pico 2", "Cortex-M33, with floats", "12 bits, 0 to 3.3 V", "yes", "as the Pico"
    ),
)  # fmt: skip

PORTS = (
    ("Linux", "/dev/ttyACM0", "stty -F /dev/ttyACM0 2000000 raw -echo"),
    ("macOS", "/dev/cu.usbmodem...", "stty -f /dev/cu.usbmodem... 2000000 raw -echo"),
    ("Windows", "COM3", "mode COM3 BAUD=2000000 DATA=8 PARITY=n"),
)
"""System, how it names the serial port of a controller, and the command that prepares it."""


def board_table() -> str:
    """Table of controllers, in Markdown."""
    rows: list[tuple[str, ...]] = [
        ("controller", "processor", "converter", "timer in `slip_timer.h`", "note"),
        ("---",) * 5,
    ]
    rows += [(each.name, each.core, each.converter, each.timer, each.note) for each in BOARDS]
    return _table(rows)


def port_table() -> str:
    """Table of serial ports by operating system, in Markdown."""
    rows: list[tuple[str, ...]] = [("system", "serial port", "before reading"), ("---",) * 3]
    rows += [(system, f"`{port}`", f"`{command}`") for system, port, command in PORTS]
    return _table(rows)


def _table(rows: list[tuple[str, ...]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
