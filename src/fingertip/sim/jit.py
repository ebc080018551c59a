"""Loops that numba compiles where many of them are run; without numba, or for one run, they are plain Python.

A kernel is a function of floats and sequences that writes into the sequences it is given. Plain Python is fastest
on lists, compiled code on arrays, so `Kernel` converts. Both take the same operations in the same order.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fingertip import jit

_fast = False
_progress: Callable[[str], None] | None = None


@contextlib.contextmanager
def compiled(progress: Callable[[str], None] | None = None) -> Iterator[None]:
    """Run kernels compiled within this block, where numba is installed.

    Compiling takes seconds, once: the result is kept beside the source, or in the user's cache folder. `progress` is told
    before each loop is made ready.
    """
    global _fast, _progress
    before = _fast, _progress
    _fast, _progress = jit.available(), progress
    try:
        yield
    finally:
        _fast, _progress = before


class Kernel:
    """A function and, once it is wanted, its compiled form.

    Parameters
    ----------
    function
        The loop. Arrays among its arguments are sequences of floats to it.
    helpers
        Functions of the same module that it calls.
    outputs
        How many of its last arguments it writes into.
    """

    def __init__(self, function: Callable[..., Any], *helpers: Callable[..., Any], outputs: int) -> None:
        self.plain = function
        self._outputs = outputs
        self._helpers = helpers
        self._compiled: Callable[..., Any] | None = None

    def __call__(self, *arguments: Any) -> Any:
        """Call it, compiled within `compiled()`."""
        if _fast:
            return self._compile()(*arguments)
        lists = [a.tolist() if isinstance(a, np.ndarray) else a for a in arguments]
        result = self.plain(*lists)
        for array, values in list(zip(arguments, lists, strict=True))[len(lists) - self._outputs :]:
            array[...] = values
        return result

    def _compile(self) -> Callable[..., Any]:
        if self._compiled is None:
            if _progress:
                _progress(
                    f"preparing the loop of {self.plain.__module__.rpartition('.')[2]} (compiled once, then kept)"
                )
            self._compiled = jit.kept(self.plain, *self._helpers)
        return self._compiled
