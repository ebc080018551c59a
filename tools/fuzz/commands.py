"""Commands that are interrupted: their words, what stands in their folder before, and the inputs that they share."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tools.fuzz import originals

SWEEP = """
name = "boards"
outputs = ["q", "cutoff_3db_hz", "gain"]
[axes]
board.cutoff_hz = { low = 20, high = 2000, steps = 400, spacing = "logarithmic" }
board.series = ["E12", "E24", "E96"]
"""


@dataclass(frozen=True)
class Command:
    """A command that writes files."""

    name: str
    new: tuple[str, ...]
    """Words of the command that is interrupted."""
    old: tuple[str, ...]
    """Words of the command that wrote what stands in the folder before."""
    share: int
    """Number of interruptions of this command in a hundred."""
    next: tuple[str, ...] = ()
    """Words of the next run, if they differ from `new`."""
    is_sweep: bool = False
    keeps_file: bool = False
    """True if the command never overwrites its file: it is removed before the next run if it is complete."""


def _of_design(name: str, share: int, *options: str, change: str = "board.cutoff_hz=80") -> Command:
    words = (name, "fsr400", *options)
    return Command(name, words, (*words, "--set", change), share)


_BUILD = ("build", "fsr400", "--formats", "stl")
_TRACE = "../../../inputs/trace.csv"
"""A command works three folders below the one with the inputs."""
_PLOTTED = ("detect", _TRACE, "--scale", "0.5", "--plot", "out/slip.png")
_CALIBRATED = ("calibrate", "sensor", "../../../inputs/weighings.csv", "--out", "out/mine.toml", "--force")
_SWEEP = ("sweep", "../../../inputs/sweep.toml", "--out", "out/boards", "--jobs", "2")
COMMANDS = (
    _of_design("make", 3, "--formats", "stl"),
    _of_design("build", 4, "--formats", "stl,step", "--parts", "bone,skin", change="skin.width_mm=18"),
    _of_design("board", 15),
    Command("simulate", ("simulate", "fsr400"), ("simulate", "fsr400", "--seed", "3"), 12),
    Command("detect", _PLOTTED, (*_PLOTTED, "--detector", "fast"), 13),
    _of_design("validate", 2, "--trials", "2", "--minutes", "0.5"),
    Command("sweep", _SWEEP, (), 16, next=(*_SWEEP, "--resume"), is_sweep=True),
    Command("page", ("page", "fsr400"), _BUILD, 4),
    _of_design("firmware", 13),
    Command("calibrate", _CALIBRATED, (*_CALIBRATED, "--set", "board.passband_gain=60"), 9),
    Command("new", ("new", "tip", "--out", "out/tip.toml"), (), 9, keeps_file=True),
)


def write_inputs(folder: Path) -> None:
    """Write the inputs that the commands share."""
    folder.mkdir(parents=True)
    (folder / "sweep.toml").write_text(SWEEP)
    (folder / "weighings.csv").write_bytes(originals.weighings())
    time_s, voltage_v = originals.recording()
    rows = (f"{t:.5f},{v:.6f}" for t, v in zip(time_s, voltage_v, strict=True))
    (folder / "trace.csv").write_text("\n".join(["time_s,voltage_v", *rows]) + "\n")
