"""Loops over samples that carry their state: plain Python, or compiled by numba where that pays.

A loop is a function of ``(coefficients, state, ring, samples, *outputs)``: a tuple of numbers, two sequences that it
reads and leaves ready for the next chunk, the samples, and sequences it fills. Both forms take the same operations
in the same order, and neither contracts a product and a sum into one rounding, so their bits are the same: a stream
may change from one to the other midway (a test holds that).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import numpy as np

from fingertip.arrays import Array
from fingertip.jit import available, kept

__all__ = ["PAYS_AFTER", "Loop", "available"]

PAYS_AFTER = 3_000_000
"""Samples after which a stream fetches numba: importing it and loading a compiled loop takes about as long as plain
Python takes for so many."""
_MIN_CHUNK = 500
"""Shorter chunks are faster in plain Python, even where numba is loaded: lists must be copied into arrays and back."""


class Loop:
    """A loop in both forms.

    Parameters
    ----------
    function
        The loop, of floats and sequences only.
    outputs
        How many sequences it fills, each as long as the samples.
    """

    def __init__(self, function: Callable[..., None], outputs: int) -> None:
        self.plain = function
        self.outputs = outputs
        self._compiled: Callable[..., None] | None = None

    def compiled(self) -> Callable[..., None]:
        """The compiled form; compiling takes seconds, once: the result is kept beside the source or in a cache."""
        if self._compiled is None:
            self._compiled = kept(self.plain)
        return self._compiled

    def run(
        self, coefficients: tuple[float, ...], state: list[float], ring: list[float], samples: Sequence[float] | Array,
        seen: int,
    ) -> list[Array]:  # fmt: skip
        """Run it over a chunk.

        Parameters
        ----------
        coefficients
            Numbers that do not change.
        state, ring
            Changed in place.
        samples
            The chunk.
        seen
            Samples that went before it, for the decision whether compiling pays.

        Returns
        -------
        list of arrays
            Its outputs.
        """
        count = len(samples)
        if count >= _MIN_CHUNK and ("numba" in sys.modules or seen + count >= PAYS_AFTER) and available():
            arrays = [np.empty(count) for _ in range(self.outputs)]
            now, then = np.array(state), np.array(ring)
            self.compiled()(coefficients, now, then, np.ascontiguousarray(samples, dtype=np.float64), *arrays)
            state[:], ring[:] = now.tolist(), then.tolist()
            return arrays
        lists = [[0.0] * count for _ in range(self.outputs)]
        values = samples.tolist() if isinstance(samples, np.ndarray) else samples
        self.plain(coefficients, state, ring, values, *lists)
        return [np.array(values, dtype=np.float64) for values in lists]
