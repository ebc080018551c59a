"""Catalogue of controllers on which the examples of the firmware are meant to run, read from `controllers.csv`."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

from fingertip.foundation.tables import load_table, read_rows

NAMES = ("thumb", "index", "middle", "ring", "little")
"""Names of the fingers that one controller reads, in the order of its inputs and of a board's channels."""


def split_finger(name: str) -> tuple[str, str]:
    """Split the parameter of one finger, such as fingers.thumb.skin.width_mm, into both; "" stands for all fingers."""
    words = name.split(".", 2)
    return (words[1], words[2]) if words[0] == "fingers" and len(words) == 3 else ("", name)


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
    """Answer to whether `slip_timer.h` has its timer, or the sketch for dividers alone."""
    note: str
    inputs: str
    """Analog inputs that are free, as its core names them, separated by spaces."""
    ram_kb: int
    convert_us: float
    """Time in which one input is converted [us]: by `analogRead`, or in a scan by DMA."""
    has_scan: bool
    """True if the converter scans all inputs by itself, and the interrupt waits for none."""

    @property
    def core(self) -> str:
        """Processor, its clock, and whether it computes floats itself."""
        floats = "with floats" if self.has_floats else "floats in software"
        return f"{self.processor} at {self.clock_mhz:g} MHz, {floats}"


@functools.cache
def load_controllers() -> tuple[ControllerBoard, ...]:
    return load_table(ControllerBoard, read_rows(Path(__file__).with_name("controllers.csv")))


def list_keys() -> tuple[str, ...]:
    return tuple(board.key for board in load_controllers())
