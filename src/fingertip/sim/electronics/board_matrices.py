"""The board's exact steps as the loop wants them: one flat array for each board."""

from __future__ import annotations

import numpy as np

from fingertip.arrays import Array
from fingertip.sim.electronics.circuit import Analog, system
from fingertip.sim.electronics.envelope_loop import ABSCISSAE, LEVELS, WIDTH
from fingertip.sim.electronics.linear import augmented, exponentials


def matrices(board: Analog, step_s: float) -> tuple[int, Array, Array, Array, Array]:
    """How many states; for each board, flat, rows of the state's steps and of the output within them, by mode of the
    rails and level of the step; and rows of the output and of the first amplifier's, free of rails, at one moment."""
    steps, rows = [], []
    outs = firsts = np.zeros(0)
    n = 0
    for mode in range(9 if board.rail_v else 1):
        A, b, k, out, first = system(board, mode)
        n = A.shape[-1]
        spare = max(0, WIDTH - n - 3)
        if mode == 0:
            outs, firsts = (np.pad(row, ((0, 0), (0, spare))) for row in (out, first))
        M = augmented(A, b, k)
        whole = exponentials(M, step_s, LEVELS + 2)
        odd = exponentials(M, step_s * 0.55, LEVELS)
        quarter, half, full = whole[:, 2:], whole[:, 1:-1], whole[:, :-2]
        at = {0.25: quarter, 0.5: half, 0.75: quarter @ half, 0.55: odd, 1.0: full}
        row = np.stack([(out[:, None, None, :] @ at[c])[:, :, 0] for c in ABSCISSAE], axis=2)
        pad = ((0, 0), (0, 0), (0, 0), (0, spare))
        steps.append(np.pad(full[:, :, :n], pad))
        rows.append(np.pad(row, pad))
    count = len(outs)
    return n, np.stack(steps, axis=1).reshape(count, -1), np.stack(rows, axis=1).reshape(count, -1), outs, firsts
