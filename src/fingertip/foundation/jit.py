"""Loops over samples that run in plain Python or, where that is faster overall, compiled by numba.

Compiled code is some hundred times faster per sample, but a process that uses it first imports
numba and loads the loop. Which form runs depends on whether numba is installed, and on how much
work is asked for.

1. A call whose work in plain Python would take less than `CALL_S` runs plain: converting its
   arguments costs more.
2. Within a `compiled()` block every other call runs compiled. Campaigns, sweeps and benchmarks use
   such a block.
3. Elsewhere each loop runs plain until the time that its calls in this process would take in plain
   Python reaches `LOAD_S`, and compiled from then on: with a loop in the cache, at most twice as
   long as the better form.
4. Within an `interpreted()` block every call runs plain: a live stream cannot wait for numba.

The time in plain Python is a constant per sample times the number of samples, so that the same
calls always take the same decisions. Both forms execute the same operations in the same order, and
neither contracts a product and a sum into one rounding: their results have the same bits. Compiled
loops are cached beside the source, or in the user's folder.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import math
import os
from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.foundation import extras
from fingertip.foundation.numerics import Array

Function = Callable[..., Any]
Floats = Sequence[float]
MutableFloats = MutableSequence[float]

LOAD_S = 0.5
"""Time to import numba and load one cached loop [s]: 0.16 s and 0.32 s of CPU time, measured by
``benchmarks/slip_speed.py``. Every further loop loads in 0.01 s."""
CALL_S = 5e-6
"""Time that converting lists to arrays and back adds to a compiled call of a detector [s]."""

_FLOAT64 = np.dtype(np.float64)
_always_compile = False
_never_compile = False


@functools.cache
def available() -> bool:
    """Return whether numba is installed, without importing it, and may be used.

    From the current folder it would read its settings, such as the place of its cache, whose files
    can run any code.
    """
    return extras.is_installed("numba") and not os.path.lexists(".numba_config.yaml")


@contextlib.contextmanager
def compiled() -> Iterator[None]:
    """Run every loop compiled within this block, where numba is installed."""
    global _always_compile
    before = _always_compile
    _always_compile = available()

    try:
        yield
    finally:
        _always_compile = before


@contextlib.contextmanager
def interpreted() -> Iterator[None]:
    """Run every loop plain within this block: samples that arrive do not wait for numba."""
    global _never_compile
    before = _never_compile
    _never_compile = True

    try:
        yield
    finally:
        _never_compile = before


def as_samples(voltage_v: Iterable[float]) -> list[float] | Array:
    """Convert samples to a sequence that loops accept: an array, or else a list."""
    return voltage_v if isinstance(voltage_v, np.ndarray) else list(voltage_v)


class CompiledLoop:
    """A loop over samples in both forms: plain Python and compiled.

    The loop is a function of numbers, tuples of numbers, and sequences of floats. It returns
    nothing and writes its results into its last arguments, which are declared mutable. Plain Python
    is fastest on lists and compiled code on arrays, so a call converts sequences either way and
    copies the results back.
    """

    def __init__(
        self, function: Function, *helpers: Function, samples: str, plain_us: float
    ) -> None:
        self.plain = function
        self.outputs = sum(
            "Mutable" in str(declared) for declared in function.__annotations__.values()
        )
        self._helpers = helpers
        self._samples = function.__code__.co_varnames.index(samples)
        self._plain_s = 1e-6 * plain_us
        self._asked_s = 0.0
        self._compiled: Function | None = None

    @property
    def break_even(self) -> int:
        """Number of samples in one process from which compiled code is faster, loading included."""
        return round(LOAD_S / self._plain_s)

    def __call__(self, *arguments: Any) -> None:
        """Run the loop over one chunk, in the form that the module's policy selects."""
        work_s = self._plain_s * len(arguments[self._samples])
        self._asked_s += work_s
        is_long = _always_compile or (self._asked_s >= LOAD_S and available())

        if is_long and work_s >= CALL_S and not _never_compile:
            self._run_compiled(arguments)
            return

        lists = [a.tolist() if isinstance(a, np.ndarray) else a for a in arguments]
        self.plain(*lists)
        for argument, values in list(zip(arguments, lists, strict=True))[-self.outputs :]:
            if argument is not values:
                argument[...] = values

    def _run_compiled(self, arguments: tuple[Any, ...]) -> None:
        first_output = len(arguments) - self.outputs
        arrays = [_as_compiled(a, copy=i < first_output) for i, a in enumerate(arguments)]
        if self._compiled is None:
            self._run_first(arrays)
        else:
            self._compiled(*arrays)

        for argument, values in zip(arguments[first_output:], arrays[first_output:], strict=True):
            if argument is not values:
                argument[:] = values.tolist()

    def _run_first(self, arrays: list[Any]) -> None:
        """Load the loop, and run it.

        If its cache is damaged or the disk full, it is compiled for this process.
        """
        try:
            loop = _compile(self.plain, *self._helpers, cache=True)
            # numba notices changes in the function's own file; a helper may be in another one.
            last_change_s = max(map(_find_change_s, self._helpers), default=0.0)
            self._forget_cache(loop, last_change_s)
        except RuntimeError:  # no folder can be written
            loop = _compile(self.plain)

        try:
            loop(*arrays)
        except Exception:  # what a damaged file raises depends on the damage
            self._forget_cache(loop, math.inf)  # the next process writes it anew
            loop = _compile(self.plain)
            loop(*arrays)

        self._compiled = loop

    def _forget_cache(self, loop: Any, before_s: float) -> None:
        """Delete the indices of this loop's cache that were written before a time."""
        for index in Path(loop.stats.cache_path).glob(f"*.{self.plain.__qualname__}-*.nbi"):
            with contextlib.suppress(OSError):
                if index.stat().st_mtime < before_s:
                    index.unlink()


def _find_change_s(function: Function) -> float:
    """Return when a function's source file was last changed; 0 in a program without sources."""
    try:
        return os.stat(function.__code__.co_filename).st_mtime
    except OSError:
        return 0.0


def _as_compiled(argument: Any, copy: bool) -> Any:
    """Return an argument as compiled code takes it: lists as arrays, and inputs contiguous."""
    if type(argument) is np.ndarray and argument.dtype is _FLOAT64 and argument.flags.c_contiguous:
        return argument  # nearly all of them; short chunks are fast by this
    if isinstance(argument, list):
        return np.array(argument, dtype=np.float64)
    if copy and isinstance(argument, np.ndarray):
        return np.ascontiguousarray(
            argument, dtype=np.float64 if argument.dtype.kind in "iuf" else None
        )

    return argument


def _compile(function: Function, *helpers: Function, cache: bool = False) -> Function:
    """Compile a function and its helpers; a division by 0 gives infinity or NaN, as in arrays."""
    for helper in helpers:
        importlib.import_module("numba.extending").register_jitable(helper)

    compile_loop = importlib.import_module("numba").njit(cache=cache, error_model="numpy")
    result: Function = compile_loop(function)
    return result


def compile_for_process(function: Function, *loops: CompiledLoop) -> Function:
    """Return the function compiled for this process only, or itself where numba is not installed.

    It may call the plain form of `loops` of other files, whose changes a cache would not notice.
    """
    if not available():
        return function

    helpers = list[Function]()
    for loop in loops:
        helpers += [loop.plain, *loop._helpers]

    return _compile(function, *helpers)
