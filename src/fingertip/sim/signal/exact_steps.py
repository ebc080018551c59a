"""Exact steps of linear state equations.

The steps are exact for x' = A x + b u + k with an input u that is linear in time over the step. The state is carried as
z = (x, u, slope of u, 1), so one matrix exponential of that larger system holds everything (C. Van Loan, IEEE Trans.
Automatic Control 23(3), 1978, doi:10.1109/TAC.1978.1101743). The shortest step's exponential is a Taylor series; each
longer one is the square of the one before (scaling and squaring).
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array

_TERMS = 10  # of the Taylor series, for a norm of at most 1/16: the next term is below 1e-20


def augment(A: Array, b: Array, k: Array) -> Array:
    """Matrix of z' = M z; leading dimensions are a batch. A: (..., n, n), b and k: (..., n)."""
    n = A.shape[-1]
    M = np.zeros((*A.shape[:-2], n + 3, n + 3))
    M[..., :n, :n] = A
    M[..., :n, n] = b
    M[..., :n, n + 2] = k
    M[..., n, n + 1] = 1.0
    return M


def exponentials(M: Array, step_s: float, levels: int) -> Array:
    """Matrix exponentials exp(M step / 2^l) for l = 0 .. levels - 1, in a new axis before the last two."""
    shortest = M * (step_s * 2.0 ** (1 - levels))
    norm = float(np.abs(shortest).sum(axis=-1).max())
    squarings = max(0, math.ceil(math.log2(norm * 16.0))) if norm > 0.0 else 0
    X = shortest * 2.0**-squarings
    # D = exp - 1 is squared as 2 D + D^2: so many squarings of exp itself would lose eight digits to the 1 in it.
    D = term = X
    for i in range(2, _TERMS + 1):
        term = term @ X / i
        D = D + term
    for _ in range(squarings):
        D = 2 * D + D @ D
    found = [D]
    for _ in range(levels - 1):
        D = 2 * D + D @ D
        found.append(D)
    return np.stack(found[::-1], axis=-3) + np.eye(M.shape[-1])
