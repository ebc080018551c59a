"""Bounds of what is read from a trace file, so that no file, damaged or made to harm, fills the memory."""

from __future__ import annotations

import math
from collections.abc import Sequence

MAX_FILE_BYTES = 2**30
"""Maximum size of a trace file, and of one array within it [bytes]."""
MAX_SAMPLES = 2**25
"""Maximum number of samples: 4.6 hours at 2 kHz, 28 minutes at 20 kHz."""
_REMEDY = "cut the recording into parts"


def size_message(size_bytes: int) -> str | None:
    """Describe a file that is too large; None for any other."""
    if size_bytes <= MAX_FILE_BYTES:
        return None
    return f"has {size_bytes / 2**20:.0f} MB; at most {MAX_FILE_BYTES / 2**20:.0f} MB are read; {_REMEDY}."


def shape_message(shape: Sequence[int], item_bytes: int = 8) -> str | None:
    """Describe an array that is too large, by the shape that its file states; None for any other."""
    count = math.prod(shape)
    if 0 <= count <= MAX_SAMPLES and count * item_bytes <= MAX_FILE_BYTES:
        return None
    return f"claims to hold {count:.3g} values; at most {MAX_SAMPLES} are read; {_REMEDY}, or record again."
