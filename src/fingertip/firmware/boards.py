"""Controllers on which the examples are meant to run: supply of their inputs, converter, and what to watch for.

The facts are common knowledge of these boards, not checked against their makers' pages. None has run the library yet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.firmware import costs

CYCLES_PER_INSTRUCTION = 1.5
"""Mean clock cycles of an instruction, with waits for the flash. An assumption: most take one, loads and jumps two."""
_FLOATS, _NO_FLOATS = "with floats", "floats in software"


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
        return f"{self.processor} at {self.clock_mhz:g} MHz, {_FLOATS if self.has_floats else _NO_FLOATS}"

    def count_cycles(self) -> tuple[int, int]:
        """Count the cycles of a sample while slip lasts, in the mean, and of the longest step.

        Each processor takes as many instructions as the measured one of its kind. This overestimates a Cortex-M3, which
        has instructions that a Cortex-M0+ lacks.
        """
        target = costs.read_costs()["targets"]["Cortex-M4F" if self.has_floats else "Cortex-M0+"]
        counts = target["instructions"]["slip"], target["max_instructions"]
        mean, longest = (math.ceil(CYCLES_PER_INSTRUCTION * count / 100) * 100 for count in counts)
        return mean, longest

    def describe_load(self, sample_rate_hz: float) -> tuple[str, str, str]:
        """Describe the cycles of a sample, those that the detector takes of them, and what follows."""
        available = math.floor(1e4 * self.clock_mhz / sample_rate_hz) * 100
        mean, longest = self.count_cycles()
        if longest <= available:
            result = "each step ends within its sample"
        elif mean <= available:
            result = "the longest step takes more than a sample; loop() catches up"
        else:
            result = "too slow while slip lasts: lower `detector.sample_rate_hz`"
        return _group(available), f"{_group(mean)}; {_group(longest)}", result


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


def load_table(sample_rate_hz: float) -> str:
    """Table of the cycles that each controller has for a sample, and that the detector takes, in Markdown."""
    rows: list[tuple[str, ...]] = [
        ("controller", "cycles of a sample", "detector, while slip lasts; longest step", "so"),
        ("---", "---:", "---:", "---"),
    ]
    rows += [(each.name, *each.describe_load(sample_rate_hz)) for each in BOARDS]
    return _table(rows)


def _group(count: int) -> str:
    return f"{count:,}".replace(",", " ")


def port_table() -> str:
    """Table of serial ports by operating system, in Markdown."""
    rows: list[tuple[str, ...]] = [("system", "serial port", "before reading"), ("---",) * 3]
    rows += [(system, f"`{port}`", f"`{command}`") for system, port, command in PORTS]
    return _table(rows)


def _table(rows: list[tuple[str, ...]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
