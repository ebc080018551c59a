"""README of the library: use, wiring, accuracy and costs."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.components.bridge import POWER_UP_S
from fingertip.board.components.values import SUPPLIES
from fingertip.catalogues.bundled import list_bundled_files
from fingertip.design import Design
from fingertip.documents.template import bullet_list, paragraph
from fingertip.firmware import packaging as costs
from fingertip.firmware.packaging import NAME
from fingertip.firmware.wiring import find_warnings, wiring_notes, wiring_table
from fingertip.foundation.toml_files import DESIGN
from fingertip.slip.detectors.fast import TICK_S, FilteredSignal
from fingertip.slip.detectors.fast_coefficients import load_model

# Controllers on which the examples are meant to run: supply of their inputs, converter, and what to watch for.
#
# The facts are common knowledge of these boards, not checked against their makers' pages. None has run the library
# yet.


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


BUFFER_SAMPLES = 1024
"""Samples that may wait in the ring buffer of `slip_buffer.h`."""


def render_readme(design: Design) -> str:
    """Render the README of a design's library, in Markdown."""
    return "\n\n".join(
        [
            f"# Slip detector of {design.name} for a controller",
            *_introduction(design),
            "## Use",
            *_use(design),
            "## Controllers",
            *_controllers(design),
            "## Wiring",
            *_wiring(design),
            "## Cost",
            *_cost(),
            "## Accuracy",
            *_accuracy(),
        ]
    ) + "\n"  # fmt: skip


def _introduction(design: Design) -> list[str]:
    d = design.detector
    return [
        paragraph(
            f"`src/slip_detector.c` and `src/slip_detector.h` are the detector `fast` of fingertip in C99, with the "
            f"constants of this design: {d.sample_rate_hz:g} samples per second, a converter of {d.adc_bits} bits over "
            f"{d.adc_range_text}. They allocate nothing, keep all state in one struct, and call no function in a step "
            "but the compiler's own routines for floating point. Made by `fingertip firmware`; make it again after a "
            "change of the design rather than edit it."
        ),
        *(paragraph(f"**Note:** {warning}") for warning in find_warnings(design)),
    ]


def _use(design: Design) -> list[str]:
    rate = f"{design.detector.sample_rate_hz:g}"
    return [
        "\n".join(
            [
                "```c",
                "slip_state slip;",
                "slip_init(&slip);",
                f"bool on = slip_step_codes(&slip, t, s); /* {rate} times a second: codes of T and S */",
                "```",
            ]
        ),
        bullet_list(
            [
                "`slip_step` takes volts instead, and `slip_process` many of them at once; codes are exact, volts in "
                "single precision are rounded.",
                "T is the tactile voltage, from which the slow force follows; S is the filtered signal, in which slip "
                f"is sought. Read S right after T. {_describe_second(design)}",
                "`slip_is_incipient` tells where slip may begin.",
                "After a step, `slip.confidence` tells how sure the detector is: from 1 on, slip turns ON.",
                _describe_start(design),
                "One detector per finger: a `slip_state` each, all of them sampled in the same interrupt.",
            ]
        ),
        paragraph(
            f"Arduino: copy this folder to `libraries/{NAME}` of the sketchbook. The examples take samples in a timer "
            "interrupt and store them in the ring buffer of `slip_buffer.h`; the detector runs in loop(), which may "
            f"lag by {BUFFER_SAMPLES / design.detector.sample_rate_hz:.2g} s before samples "
            "are lost. `slip_pin` switches a pin on while slip is detected, and needs no computer. `slip_stream` "
            f"waits for one, and writes time and both voltages over USB, for `fingertip detect` with "
            f"{_describe_file(design)}:"
        ),
        "```sh\nstty -F /dev/ttyACM0 2000000 raw -echo\n"
        f"fingertip detect - --detector fast --design {_name_file(design)} < /dev/ttyACM0\n```",
        paragraph(
            "The port has another name on other systems, see below. `fingertip detect -` ends at a line that is none "
            "of samples, and quotes it. `analogRead` must take a "
            "small part of the "
            f"{1e3 / design.detector.sample_rate_hz:g} ms between two samples; where it is slow, read the converter's "
            "registers instead."
        ),
        paragraph(
            "PlatformIO: copy it to `lib/` of the project. Elsewhere: compile the source with `-std=c99 -O2 "
            "-ffp-contract=off`."
        ),
    ]


def _controllers(design: Design) -> list[str]:
    rate_hz = design.detector.sample_rate_hz
    return [
        board_table(),
        paragraph(
            "What a controller's inputs bear must be at least the supply of the board, so feed both from the same "
            "3.3 V. The table was not checked against the makers' pages; the examples were compiled against a stand-in "
            "for Arduino's headers, not run on these boards. On another board, call a function as often from a timer "
            "of your own."
        ),
        load_table(rate_hz),
        paragraph(
            f"The cycles are those between two samples at {rate_hz:g} Hz, and {CYCLES_PER_INSTRUCTION:g} times the "
            "instructions of the table of costs, a factor that is an assumption; a Cortex-M3 is counted as a "
            "Cortex-M0+. Two calls of `analogRead` come on top. Nothing ran on a real controller."
        ),
        port_table(),
        paragraph(
            "The number or the end of the port's name differs: list the ports before and after plugging the controller "
            "in. On Windows, read from the port with a terminal program that writes its lines to the standard output, "
            "such as `plink -serial COM3 -sercfg 2000000`, and pipe them into `fingertip detect -`."
        ),
    ]


def _is_bundled(design: Design) -> bool:
    return design.name in list_bundled_files(DESIGN)


def _name_file(design: Design) -> str:
    """Name a bundled design as commands take it, and the file of another one."""
    return design.name if _is_bundled(design) else f"{design.name}.toml"


def _describe_file(design: Design) -> str:
    return "this design" if _is_bundled(design) else f"the file of this design, here `{_name_file(design)}`"


def _describe_second(design: Design) -> str:
    if FilteredSignal.from_design(design) is None:
        return "The board of this design gives no S at its connector: give 0, or use `slip_step_tactile_code`."
    return (
        "Where S is at its limit, T alone is judged until S has recovered, and so it is where S does not change for "
        "0.2 s: `slip_filtered_is_still` then tells that its wire may be broken."
    )


def _describe_start(design: Design) -> str:
    """Say when the detector may start, and when it can first find slip."""
    off = "The detector is OFF for its first 0.2 s, in which it learns the noise: begin with a steady force."
    if not SUPPLIES[design.board.supply].is_for_controller:
        return off
    return (
        f"Start it {POWER_UP_S:g} s after the board's power, when the board's voltages have settled (see the board's "
        f"README); the examples wait that long. {off}"
    )


def _wiring(design: Design) -> list[str]:
    return [wiring_table(design), bullet_list(wiring_notes(design))]


def _cost() -> list[str]:
    measured = costs.read_costs()
    emulated = " and ".join(target["emulated"] for target in measured["targets"].values())
    samples = measured["samples"]["campaign"]
    return [
        costs.cost_table(),
        paragraph(
            f"Measured on the library of {measured['design']} with the board {measured['board']} at "
            f"{measured['sample_rate_hz']:g} Hz, by {measured['compiler']} with {measured['options']}, on the "
            f"{emulated} of {measured['emulator']}. Flash holds code, trees and the floating-point routines; stack is "
            "what the deepest step left behind. Instructions are means per sample: at a constant force, over "
            f"{samples} samples of simulated trials and scenes without slip, and while slip lasts. Most take few. "
            f"The longest ones, one each {1e3 * TICK_S:g} ms, evaluate the {load_model().trees} trees, if anything "
            "vibrates. A controller without a floating-point unit spends its time in the compiler's routines. Its "
            "longest step may take more than a sample, so let the interrupt store samples, and run the detector in "
            "loop(), as the examples do."
        ),
    ]


def _accuracy() -> list[str]:
    return [
        paragraph(
            "The operations and their order are those of the Python detector. With `-DSLIP_REAL=double` every number "
            "has the same bits. With float, the default, the filters take differences between samples, so that a "
            "constant force costs no digits, and the intervals of slip found in codes are those of the Python detector "
            "within one sample. For the same bits on every compiler, forbid it to contract a product and a sum "
            "(`-ffp-contract=off`); the source asks GCC and Clang for it."
        ),
    ]
