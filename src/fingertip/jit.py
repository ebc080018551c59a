"""numba, where it is installed: whether it is, and a loop compiled once and kept.

When a loop is compiled is decided where loops are run: `fingertip.sim.jit` compiles within a block that asks for it,
`fingertip.slip.detectors.kernel` where a stream is long enough.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from typing import Any

Function = Callable[..., Any]


def available() -> bool:
    """Whether numba is installed; looking does not import it."""
    return importlib.util.find_spec("numba") is not None


def kept(function: Function, *helpers: Function) -> Function:
    """The function compiled, as it will be again: kept beside its source, or in the user's cache folder.

    Where neither can be written it is compiled all the same. A division by 0 gives what the processor gives, as in
    arrays; nothing is contracted or reordered, so that plain Python has the same bits.

    Parameters
    ----------
    function
        Of numbers, tuples and arrays.
    helpers
        Functions of the same module that it calls (numba's cache looks at that file only).
    """
    for helper in helpers:
        importlib.import_module("numba.extending").register_jitable(helper)
    njit = importlib.import_module("numba").njit
    compiled: Function
    try:
        compiled = njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # nowhere to keep it
        compiled = njit(error_model="numpy")(function)
    return compiled


def once(function: Function) -> Function:
    """The function compiled for this process, where numba is installed; else itself."""
    compiled: Function = function
    if available():
        compiled = importlib.import_module("numba").njit(function)
    return compiled
