"""Origin of a trace: whether it is simulated, and when the robot moved. Its columns do not say that."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from fingertip.catalogues.output_files import DETECTION, SIGNAL, TRACE
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.output_set import read_manifest
from fingertip.foundation.output_set.writer import has_hash


@dataclass(frozen=True)
class Origin:
    """Facts about a trace beside its columns."""

    is_simulated: bool = False
    motion_s: float | None = None
    """Moment at which the robot begins to slide [s]; None if there is no slide, or it is not known."""

    @property
    def truth(self) -> str:
        """Name of the true slip for people: simulated, or as whoever recorded it stated."""
        return f"true slip ({'simulated' if self.is_simulated else 'column slip'})"


UNKNOWN = Origin()
"""Origin of a recording of which nothing is known."""


def read_origin(path: Path) -> Origin:
    """Read what the set beside a trace says of it: a file that is listed there, and unchanged, is simulated.

    Where the set holds the detection of this trace too, that says when the robot moved.
    """
    manifest = read_manifest(path.parent)
    if manifest is None or manifest.kind != SIGNAL.kind or not has_hash(path, manifest.files.get(path.name)):
        return UNKNOWN
    detection = path.parent / DETECTION
    if path.name != TRACE or not has_hash(detection, manifest.files.get(DETECTION)):
        return Origin(is_simulated=True)
    return parse_origin(read_input(detection, PARSED_LIMIT, below=path.parent))


def parse_origin(detection: bytes | None) -> Origin:
    """Read the origin of a simulated trial from the detection beside it; None if there is none."""
    try:
        motion_s = json.loads(detection)["motion_s"] if detection else None
    except (ValueError, KeyError, TypeError, RecursionError):
        motion_s = None
    return Origin(True, motion_s if isinstance(motion_s, float) and math.isfinite(motion_s) else None)


# Start of a robot's motion, and how well encoders know it: the article reads its robot's at 100 Hz (section III.C).

ENCODER_HZ = 100.0
"""Rate at which the encoders are read [Hz] (article, section III.C)."""


def encoder_band_s(motion_s: float) -> tuple[float, float]:
    """Interval in which encoders first show a motion that begins at `motion_s` [s]: one of their periods.

    Every picture and table takes the article's uncertainty from here. Friction in the robot and the encoders' step make
    it later still.
    """
    return motion_s, motion_s + 1 / ENCODER_HZ


def encoder_delay_band_s(delay_s: float) -> tuple[float, float]:
    """Shortest and longest delay that encoders show for a true delay since the motion [s]."""
    first_s, last_s = encoder_band_s(0.0)
    return delay_s - last_s, delay_s - first_s


def format_delay_band(delay_s: float) -> str:
    """Format the delays that encoders show for a true delay since the motion, such as ``15.5-25.5 ms``."""
    low_s, high_s = encoder_delay_band_s(delay_s)
    return f"{1000 * low_s:.1f}-{1000 * high_s:.1f} ms"


ENCODER_NOTE = (
    f"encoders at {ENCODER_HZ:g} Hz, as the article's, know when it moved to {1000 / ENCODER_HZ:g} ms: their delays "
    "are up to so much shorter"
)
"""Note of tables below delays since the robot moved."""
BAND_LABEL = f"robot starts, known to {1000 / ENCODER_HZ:g} ms (encoders, {ENCODER_HZ:g} Hz)"
"""Name of the band in the legends of pictures."""
