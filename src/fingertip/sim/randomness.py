"""Random numbers of the simulation: one independent stream for each seed and purpose.

The generator is numpy's `RandomState`, whose streams are frozen, so that the same seed gives the same numbers with any
version (NEP 19).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array

Stream = np.random.RandomState
OpenStream = Callable[[str], Stream]
"""Function from a purpose to its stream."""


def open_stream(seed: int, *purpose: str) -> Stream:
    """Open the stream of a seed and a purpose, so that one purpose never changes the numbers of another."""
    name = ":".join((str(seed), *purpose))
    return np.random.RandomState(np.frombuffer(hashlib.sha256(name.encode()).digest(), dtype="<u4"))


def draw_noise(stream: Stream, deviation: float, count: int) -> Array:
    """Draw white Gaussian noise."""
    return np.asarray(deviation * stream.standard_normal(count))
