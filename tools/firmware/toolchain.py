"""Builds of the C library: for this machine, and for controllers that QEMU emulates.

Time is counted in instructions: under ``-icount shift=10`` QEMU's clock advances by 1.024 us for
each, and the controller's timer SysTick reads that clock. A step is timed alone, less an empty
call.
"""

from __future__ import annotations

import ctypes
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.electronics import NAMES, load_controllers
from fingertip.design import Design
from fingertip.firmware.c_sources import GRIP_SOURCE, SOURCE, library_sources
from fingertip.firmware.fingers import ONE_FINGER, Fingers
from fingertip.foundation.numerics import Array
from tools.firmware.signals import Recording

PROGRAMS = Path(__file__).parent / "programs"
"""Sources of the programs that run the library, and the linker script."""
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off")
"""Options with which the library must compile without a warning."""
INSTRUCTION_S = 1.024e-6
"""Emulated time of one instruction [s]."""


@dataclass(frozen=True)
class Target:
    """Controller that QEMU emulates."""

    name: str
    """Processor for which the library is compiled."""
    options: tuple[str, ...]
    """Options of the compiler that select the processor."""
    machine: str
    """Board of QEMU."""
    emulated: str
    """Processor of that board, which executes the same instructions."""
    clock_hz: float
    """Frequency at which its timer counts [Hz]."""


TARGETS = (
    Target(
        name="Cortex-M4F",
        options=("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
        machine="mps2-an386",
        emulated="Cortex-M4F",
        clock_hz=25e6,
    ),
    Target(
        name="Cortex-M0+",
        options=("-mcpu=cortex-m0plus",),
        machine="microbit",
        emulated="Cortex-M0",
        clock_hz=16e6,
    ),
)


Singles = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class TargetRun:
    """Results of a run on an emulated controller, one value per sample."""

    on: NDArray[np.bool_]
    odds: Array
    instructions: Array
    stack_bytes: int
    """Bytes of stack that the deepest step used, by the pattern that it left."""


FIVE = Fingers(
    NAMES, tuple((f"A{2 * i}", f"A{2 * i + 1}") for i in range(len(NAMES))), load_controllers()[0]
)
"""Fingers of a hand."""


def write_sources(design: Design, folder: Path, fingers: Fingers = ONE_FINGER) -> None:
    """Write headers and sources of a design's library into a folder."""
    for name, data in library_sources(design, fingers).items():
        (folder / name).write_bytes(data)


HOST_LIBRARY = "slip.so"


def compile_host(folder: Path, *options: str) -> Path:
    """Compile the library in a folder as a shared library for this machine."""
    library = folder / HOST_LIBRARY
    program = [str(PROGRAMS / "probe.c"), str(PROGRAMS / "probe_hand.c")]
    program += [str(folder / SOURCE), str(folder / GRIP_SOURCE)]
    flags = [*STRICT, "-O2", "-shared", "-fPIC", f"-I{folder}", *options]
    _run("gcc", *flags, *program, "-lm", "-o", str(library))

    return library


def compile_target(
    folder: Path, target: Target, level: str = "-O2", program: str = "on_target.c"
) -> Path:
    """Compile a program for a controller with the library in a folder."""
    image = folder / f"{target.name}{level}.elf"
    link = [
        "-nostartfiles",
        "--specs=nano.specs",
        "-Wl,--gc-sections",
        f"-T{PROGRAMS / 'target.ld'}",
    ]
    flags = [
        *target.options,
        "-mthumb",
        level,
        *STRICT,
        "-ffunction-sections",
        "-fdata-sections",
        f"-I{folder}",
    ]
    _run(
        "arm-none-eabi-gcc",
        *flags,
        *link,
        str(folder / SOURCE),
        str(PROGRAMS / program),
        "-o",
        str(image),
    )

    return image


def compile_object(folder: Path, target: Target, level: str = "-O2") -> tuple[Path, dict[str, int]]:
    """Compile the library alone for a controller; the object,
    and the stack of each function [byte].
    """
    image = folder / f"{target.name}{level}.o"
    flags = [*target.options, "-mthumb", level, *STRICT, "-fstack-usage", f"-I{folder}"]
    _run("arm-none-eabi-gcc", *flags, "-c", str(folder / SOURCE), "-o", str(image))
    rows = (line.split("\t") for line in image.with_suffix(".su").read_text().splitlines())

    return image, {row[0].rpartition(":")[2]: int(row[1]) for row in rows}


def measure_flash(folder: Path, target: Target, level: str = "-O2", with_grip: bool = False) -> int:
    """Measure code and tables of the library, with the routines
    of the compiler that it needs [byte].
    """
    image, _ = compile_object(folder, target, level)
    linked = image.with_suffix(".linked")
    needed = ["-Wl,--gc-sections", "-Wl,-eslip_process", "-Wl,-uslip_init"]

    if with_grip:
        options = [
            *target.options,
            "-mthumb",
            level,
            *STRICT,
            f"-I{folder}",
            "-c",
            str(folder / GRIP_SOURCE),
        ]
        _run("arm-none-eabi-gcc", *options, "-o", str(folder / "grip.o"))
        needed += ["-Wl,-uslip_grip_step", str(folder / "grip.o")]

    _run(
        "arm-none-eabi-gcc",
        *target.options,
        "-mthumb",
        "-nostartfiles",
        "--specs=nano.specs",
        *needed,
        str(image),
        "-o",
        str(linked),
        "-lm",
    )
    sizes = _run("arm-none-eabi-size", str(linked)).splitlines()[1].split()
    return int(sizes[0]) + int(sizes[1])


def run_target(image: Path, target: Target, recording: Recording) -> TargetRun:
    """Run the program of `compile_target` on a recording.

    A board without a filtered signal does not read it.
    """
    folder = image.parent
    filtered = (
        np.zeros(len(recording.tactile_v)) if recording.filtered_v is None else recording.filtered_v
    )
    _emulate(image, target, np.column_stack((recording.tactile_v, filtered)).astype("<f4"))
    kinds = np.dtype([("odds", "<f4"), ("ticks", "<u4"), ("on", "<u4")])
    results = np.fromfile(folder / "results.bin", kinds)
    (stack,) = np.fromfile(folder / "stack.bin", "<u4").tolist()
    instructions = np.round(results["ticks"] / (target.clock_hz * INSTRUCTION_S))

    return TargetRun(results["on"] > 0, results["odds"], instructions, stack)


def run_hand_on_target(
    image: Path, target: Target, codes: NDArray[np.uint16]
) -> tuple[NDArray[np.uint32], Array]:
    """Run the program `hand_on_target.c` on codes, (samples, fingers,
    2); the fingers that are ON, and instructions.
    """
    _emulate(image, target, codes.astype("<u2"))
    results = np.fromfile(image.parent / "results.bin", np.dtype([("ticks", "<u4"), ("on", "<u4")]))
    return results["on"], np.round(results["ticks"] / (target.clock_hz * INSTRUCTION_S))


def _emulate(image: Path, target: Target, samples: NDArray[Any]) -> None:
    folder = image.parent
    samples.tofile(folder / "samples.bin")
    for name in ("results.bin", "stack.bin"):
        (folder / name).unlink(missing_ok=True)

    _run(
        "qemu-system-arm",
        "-M",
        target.machine,
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "none",
        "-semihosting-config",
        "enable=on,target=native",
        "-icount",
        "shift=10,sleep=off",
        "-kernel",
        image.name,
        folder=folder,
    )


def tool_version(tool: str) -> str:
    """Version that a compiler or emulator reports."""
    found = re.search(
        r"\d+\.\d+(\.\d+)?", _run(tool, "--version").splitlines()[0].rpartition(")")[2]
    )
    found = found or re.search(r"\d+\.\d+(\.\d+)?", _run(tool, "--version").splitlines()[0])
    assert found

    return found[0]


class HostDetector:
    """Detector of a library that `compile_host` made, with its state."""

    def __init__(self, library: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        self._library.probe_state_bytes.restype = ctypes.c_size_t
        self._state = ctypes.create_string_buffer(self.state_bytes)
        self._library.slip_init(self._state)

    @property
    def state_bytes(self) -> int:
        """Size of the state [byte]."""
        return int(self._library.probe_state_bytes())

    def process(
        self, tactile_v: Array, filtered_v: Array | None = None
    ) -> tuple[Singles, Singles, Singles, NDArray[np.bool_], NDArray[np.bool_], NDArray[np.uint8]]:
        """Process samples [V]; vibration, mean and floor [V], incipient slip, ON and faults of
        each.
        """
        given = [
            None if volts is None else volts.astype(np.float32) for volts in (tactile_v, filtered_v)
        ]
        numbers = [np.zeros(len(tactile_v), np.float32) for _ in range(3)]
        incipient, faults, on = (np.zeros(len(tactile_v), np.uint8) for _ in range(3))
        count = ctypes.c_size_t(len(tactile_v))
        outputs = [*map(_point, numbers), *map(_point, (incipient, faults, on))]
        self._library.probe_process(self._state, *map(_point, given), count, *outputs)
        vibration, mean, floor = numbers

        return vibration, mean, floor, incipient > 0, on > 0, faults

    def process_codes(
        self, tactile: NDArray[np.int32], filtered: NDArray[np.int32] | None = None
    ) -> NDArray[np.bool_]:
        """Process codes of the converter; ON of each."""
        on = np.zeros(len(tactile), np.uint8)
        self._library.probe_process_codes(
            self._state, _point(tactile), _point(filtered), ctypes.c_size_t(len(on)), _point(on)
        )
        return on > 0


class HostHand:
    """Detectors of a hand and grip law of a library that `compile_host` made for
    several fingers.
    """

    def __init__(self, library: Path, fingers: int) -> None:
        self._library = ctypes.CDLL(str(library))
        self._fingers = fingers
        for name in ("probe_hand_bytes", "probe_grip_bytes"):
            getattr(self._library, name).restype = ctypes.c_size_t

        self.hand_bytes = self._library.probe_hand_bytes()
        self.grip_bytes = self._library.probe_grip_bytes()

    def process(
        self, codes: NDArray[np.uint16], lost: NDArray[np.uint32]
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """Process codes, (samples, fingers, 2); fingers that are ON
        as bits, and faults, (samples, fingers).
        """
        on = np.zeros(len(codes), np.uint8)
        faults = np.zeros((len(codes), self._fingers), np.uint8)
        state = ctypes.create_string_buffer(self.hand_bytes)
        count = ctypes.c_size_t(len(codes))
        self._library.probe_hand(
            state, _point(codes), _point(lost), count, _point(on), _point(faults)
        )

        return on, faults

    def grip(
        self,
        now_us: NDArray[np.uint32],
        on: NDArray[np.uint8],
        usable: NDArray[np.uint8],
        inputs: Array,
    ) -> tuple[Singles, NDArray[np.bool_], NDArray[np.bool_]]:
        """Run the grip law over periods, with voltages and closings (periods, fingers, 2).

        Returns closings that were added, (periods, fingers), and whether it was suppressed and
        tightened.
        """
        added = np.zeros((len(now_us), self._fingers), np.float32)
        flags = np.zeros(len(now_us), np.uint8)
        state = ctypes.create_string_buffer(self.grip_bytes)
        given = np.ascontiguousarray(inputs, np.float32)
        count = ctypes.c_size_t(len(now_us))
        self._library.probe_grip(
            state,
            _point(now_us),
            _point(on),
            _point(usable),
            _point(given),
            count,
            _point(added),
            _point(flags),
        )

        return added, flags % 2 > 0, flags > 1

    def read_force(self, finger: int, tactile_v: float) -> tuple[float, float, float]:
        """Force that a voltage of a finger means, and the ends of its interval [N]."""
        read = self._library.slip_force_interval_n
        low = ctypes.c_float()
        high = ctypes.c_float()
        read.restype = ctypes.c_float
        read.argtypes = (ctypes.c_uint, ctypes.c_float, *[ctypes.c_void_p] * 2)

        return read(finger, tactile_v, ctypes.byref(low), ctypes.byref(high)), low.value, high.value


def _point(array: NDArray[Any] | None) -> ctypes.c_void_p:
    """Pointer to the numbers of an array, which must live on; NULL for None."""
    if array is None:
        return ctypes.c_void_p(None)

    assert array.flags.c_contiguous
    return ctypes.c_void_p(array.ctypes.data)


def _run(*command: str, folder: Path | None = None) -> str:
    """Run a program and return its output; raise with its messages if it fails."""
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        cwd=folder,
        timeout=600,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed:\n{done.stdout}{done.stderr}")

    return done.stdout
