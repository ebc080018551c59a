"""Public sets of recordings, read as their authors publish them.

None is part of this project: download it yourself.

Each layout was written from the authors' documents and code; `docs/slip_benchmark.md` says which of
them were read from the published files themselves. Slip is where finger and surface move while they
touch, as the position says that the set records: none of these sets states the moment of gross
slip.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip.recordings import (
    MIN_QUIET_S,
    QUIET,
    SLIP,
    Recording,
    RecordingSet,
    Stretch,
    collect_recordings,
    label_trace,
    read_folder,
)
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.input_files import RECORDING_LIMIT, read_input
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.trace import ColumnMap, RawTrace, Trace
from fingertip.slip.traces.truth import intervals

SPEED_S = 0.05
"""Time over which a speed is taken from positions [s]."""
MOVING_MM_S = 2.0
"""Speed from which finger and surface move [mm/s]."""


@dataclass(frozen=True)
class Layout:
    words: str
    source: str
    read: Callable[[Path], RecordingSet]


def read_layout(name: str, folder: Path) -> RecordingSet:
    """Read a public set from the folder that holds it. Raises TraceError."""
    try:
        return LAYOUTS[name].read(folder)
    except OSError as error:
        raise TraceError(
            Issue(str(error.filename or folder), f"cannot be read ({error.strerror or error}).")
        ) from None


def label_motion(time_s: Array, speed_mm_s: Array, touches: Any) -> list[Stretch]:
    """Label a recording by its motion: slip where it moves in
    contact, quiet where it rests in contact.
    """
    moves = np.abs(speed_mm_s) > MOVING_MM_S
    found = [
        Stretch(SLIP, one.onset_s, one.end_s, one.onset_s)
        for one in intervals(time_s, moves & touches)
    ]
    found += [
        Stretch("vibration", one.onset_s, one.end_s) for one in intervals(time_s, moves & ~touches)
    ]

    # A rest begins and ends with the transients of touch and motion, which are no quiet.
    for rest in intervals(time_s, ~moves & touches):
        start_s = rest.onset_s + SPEED_S
        end_s = rest.end_s - SPEED_S
        if end_s - start_s >= MIN_QUIET_S:
            found.append(Stretch(QUIET, start_s, end_s))

    return [one for one in found if one.end_s > one.start_s]


def find_speed(position_mm: Array, rate_hz: float) -> Array:
    """Speed over the time `SPEED_S` around each sample [mm/s]."""
    reach = max(1, round(SPEED_S * rate_hz / 2))
    padded = np.pad(position_mm, reach, mode="edge")
    return np.asarray((padded[2 * reach :] - padded[: -2 * reach]) * rate_hz / (2 * reach))


# One fingertip on wood, slid by a stage: R. V. Grigorii, J. E. Colgate, IEEE Transactions on
# Haptics, 2021.

_STAGE_HZ = 10_000.0
_LATERAL_N_PER_V = 4 / 9
_NORMAL_N_PER_V = 0.31
_MM_PER_COUNT = 5 / 10_000
_PRESS_N = 0.2
"""Difference of the normal force from that in air from which the
finger touches [N]: half of its press there.
"""


@dataclass(frozen=True, eq=False)
class Run:
    """One signal of a public set beside what its set says of the motion."""

    name: str
    rate_hz: float
    values: Array
    speed_mm_s: Array
    touches: NDArray[np.bool_]

    def label(self) -> Iterator[Recording]:
        time_s = np.arange(len(self.values)) / self.rate_hz
        stretches = label_motion(time_s, self.speed_mm_s, self.touches)
        raw = RawTrace(self.name, Trace(time_s, self.values), in_volts=False)
        yield label_trace(raw, stretches, rises_with_force=True)


def read_stage_run(path: Path) -> Run:
    """Read the lateral force on the fingertip [N]. Raises TraceError."""
    from scipy.io import loadmat

    table = np.asarray(
        loadmat(path, variable_names=["dataQ"]).get("dataQ", np.zeros((0, 0))), dtype=np.float64
    )

    if table.ndim != 2 or table.shape[1] != 5 or len(table) < _STAGE_HZ:
        raise TraceError(
            Issue(str(path), f"has no variable dataQ of 5 columns and at least {_STAGE_HZ:g} rows.")
        )

    counts = np.where(table[:, 4] > 2.0**31, table[:, 4] - 2.0**32, table[:, 4])
    normal_n = _smooth(table[:, 1] * _NORMAL_N_PER_V, round(SPEED_S * _STAGE_HZ))
    touches = np.abs(normal_n - normal_n[round(SPEED_S * _STAGE_HZ)]) > _PRESS_N
    speed = find_speed(counts * _MM_PER_COUNT, _STAGE_HZ)

    return Run(
        name=path.name,
        rate_hz=_STAGE_HZ,
        values=table[:, 0] * _LATERAL_N_PER_V,
        speed_mm_s=speed,
        touches=touches,
    )


def _read_stage(folder: Path) -> RecordingSet:
    paths = sorted(folder.glob("*.mat"))
    return collect_recordings(
        LAYOUTS["natural_texture"].words, paths, lambda path: read_stage_run(path).label(), folder
    )


def _smooth(values: Array, width: int) -> Array:
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1 / width), "valid")


# BioTac on 20 materials: R. Gao et al., Supervised Autoencoder Joint Learning on Heterogeneous
# Tactile Sensory Data.

_ROW_S = 0.01
_PER_ROW = 22


def read_biotac_run(path: Path) -> Run:
    """Read the pressure of a run, unfolded, and its motion; without static pressure it is in air.

    Raises TraceError.
    """
    table = _read_table(path)
    folded = np.stack([table[f"pac{i}"] for i in range(1, _PER_ROW + 1)], axis=1).ravel()
    place = _read_table(path.with_name(path.name.replace("_bio.csv", "_cp.csv")))
    rate_hz = _PER_ROW / _ROW_S
    begun_s = place["timestamp"] - table["timestamp"][0]
    position_mm = 1000 * np.interp(np.arange(len(folded)) / rate_hz, begun_s, place["posx"])
    touches = np.repeat(table["pdc"] > 0.0, _PER_ROW)

    return Run(
        name=path.name,
        rate_hz=rate_hz,
        values=unfold(folded),
        speed_mm_s=find_speed(position_mm, rate_hz),
        touches=touches,
    )


def unfold(values: Array) -> Array:
    """Undo ``|x - tare|``, as which the set stores its pressure: the
    signs with the least sum of second differences.
    """
    signs = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))  # of a sample and the one before
    costs = [0.0] * 4
    steps = list[tuple[bool, ...]]()
    x = values.tolist()

    for i in range(2, len(x)):
        ways = []
        for now, last in signs:
            ahead = now * x[i] - 2 * last * x[i - 1]
            at = 0 if last > 0 else 2
            plus = costs[at] + abs(ahead + x[i - 2])
            minus = costs[at + 1] + abs(ahead - x[i - 2])
            ways.append((min(plus, minus), minus < plus))

        costs = [cost for cost, _ in ways]
        steps.append(tuple(is_minus for _, is_minus in ways))

    state = costs.index(min(costs))
    found = [state // 2, state % 2]
    for step in reversed(steps):  # the sign before the last two, back to the first
        state = 2 * (state % 2) + step[state]
        found.append(state % 2)

    return values * np.where(np.array(found[::-1]) == 0, 1.0, -1.0)


def _read_biotac(folder: Path) -> RecordingSet:
    paths = sorted(folder.glob("raw_data/mat*/mat*_bio.csv"))
    words = LAYOUTS["biotac_slide"].words
    return collect_recordings(words, paths, lambda path: read_biotac_run(path).label(), folder)


def _read_table(path: Path) -> dict[str, Array]:
    """Read a table with a line of names; lines may end with one
    comma too many, and names begin with spaces.
    """
    text = read_input(path, RECORDING_LIMIT, below=path.parent).decode("utf-8", errors="replace")
    rows = csv.reader(io.StringIO(text))
    names = [name.strip() for name in next(rows, [])]
    values = [row[: len(names)] for row in rows if row]

    try:
        table = np.array(values, dtype=np.float64)
    except ValueError as error:
        raise TraceError(
            Issue(str(path), f"is not a table of numbers below one line of names ({error}).")
        ) from None

    if table.ndim != 2 or table.shape[1] != len(names):
        raise TraceError(
            Issue(
                str(path), f"has lines without {len(names)} numbers, as its first line has names."
            )
        )

    return dict(zip(names, table.T, strict=True))


# Cluster Haptic Texture Dataset: M. Eguchi, T. Hayase, Y. Hiroi, T. Hiraki, arXiv:2407.16206.

_CLUSTER_HZ = 6000.0
_NAME = re.compile(r"\d+_\d+_\d+_\d+_\d+\.(csv|parquet)")


def _read_cluster(folder: Path) -> RecordingSet:
    def load(path: Path) -> dict[str, Array]:
        if path.suffix == ".csv":
            return _read_table(path)

        from pyarrow import parquet

        table = parquet.read_table(path)
        return {
            name: table.column(name).to_numpy().astype(np.float64) for name in table.column_names
        }

    def read(path: Path) -> Iterator[Any]:
        force = load(path)
        place = load(folder / "sensor_data" / "position" / path.parent.name / path.name)
        # The times of the published rows are uneven.
        time_s = np.arange(force["time"][0], force["time"][-1], 1 / _CLUSTER_HZ)
        force_n = np.interp(time_s, force["time"], force["force"])
        x_mm, y_mm = (np.interp(time_s, place["time"], place[axis]) for axis in "XY")
        speed = np.hypot(find_speed(x_mm, _CLUSTER_HZ), find_speed(y_mm, _CLUSTER_HZ))
        begun_s = time_s - time_s[0]
        stretches = label_motion(begun_s, speed, np.full(len(time_s), True))
        raw = RawTrace(path.name, Trace(begun_s, force_n), in_volts=False)
        yield label_trace(raw, stretches, rises_with_force=True)

    paths = [
        path for path in sorted(folder.glob("sensor_data/force/*/*")) if _NAME.fullmatch(path.name)
    ]
    return collect_recordings(LAYOUTS["cluster_texture"].words, paths, read, folder)


# Piezoelectric fingertip on a robot: Contact Events and Slip Onset Detection Based on a
# Piezoelectric Sensing System.


def _read_piezo(folder: Path) -> RecordingSet:
    return read_folder(
        folder, ColumnMap({"voltage_v": "1"}, rate_hz=2000.0), LAYOUTS["piezo_onset"].words
    )


LAYOUTS = {
    "natural_texture": Layout(
        "a fingertip on a stage, lateral force, 10 kHz, MAT",
        "R. V. Grigorii, J. E. Colgate, IEEE Transactions on Haptics, 2021, "
        "doi:10.1109/TOH.2021.3130091",
        _read_stage,
    ),
    "biotac_slide": Layout(
        "BioTac on 20 materials, pressure, 2.2 kHz, CSV",
        "R. Gao et al., Supervised Autoencoder Joint Learning on Heterogeneous Tactile Sensory "
        "Data, 2020",
        _read_biotac,
    ),
    "cluster_texture": Layout(
        "Cluster Haptic Texture Dataset, normal force, 6 kHz, CSV or Parquet",
        "M. Eguchi, T. Hayase, Y. Hiroi, T. Hiraki, arXiv:2407.16206, "
        "doi:10.6084/m9.figshare.29438288",
        _read_cluster,
    ),
    "piezo_onset": Layout(
        "piezoelectric fingertip on a robot, first of 8 channels, 2 kHz, LVM, with your labels.csv",
        "Contact Events and Slip Onset Detection Based on a Piezoelectric Sensing System and "
        "Embedded Machine Learning",
        _read_piezo,
    ),
}
"""Name of a layout -> what it holds, who published it, and how it is read."""
