"""Origin of a trace: whether it is simulated, and when the robot moved. Its columns do not say that."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from fingertip.input_files import PARSED_LIMIT, read_input
from fingertip.output_set import read_manifest
from fingertip.output_set.manifest import has_hash

TRACE, PLOT, DETECTION = "trace.csv", "slip.png", "detection.json"
"""Names of the files of a simulated trial."""
SIGNAL_FOLDER = "signal"
"""Folder of simulated traces within the output folder of a design, and kind of their set."""


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
    if manifest is None or manifest.kind != SIGNAL_FOLDER or not has_hash(path, manifest.files.get(path.name)):
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
