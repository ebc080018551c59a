"""Features by which `fast` tells slip from a blow, a servo's step or a set-down.

All are ratios of energies of the last 64 ms, as logarithms to base 2, so that none depends on the
unit of the signal. A blow decays, and its force jumps; a step moves the force far for the vibration
that it leaves; slip vibrates on, in bands that hardly change.

    16 slices of 4 ms, the newest first:   | 0 | 1 | 2 | 3 | 4 | ... | 15 |
    halves of the last 16 ms:              |  new  |  old  |
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.slip.detectors.fast_inputs import ENERGIES, Singles

RING = 32
"""Ticks that the features look back on: 64 ms."""
SLICES = RING // 2
PEAK_SLICES = 15
"""Slices in which the greatest energy and the steepest change of force are looked for."""
BAND_NAMES = ("3-28 Hz", "28-60 Hz", "60-120 Hz", "120-250 Hz", "250-700 Hz")
SLOW = 0
MIDDLE = (2, 3)
"""Bands of 60 to 250 Hz, in which slip is strongest."""
WIDE = ENERGIES - 1
"""Places of the slow force and of all vibration among the energies."""
FORCE_TICKS = (2, 8, RING - 1)
"""Ticks over which the force's change is taken: 4, 16 and 62 ms."""
LOUD_RATIO = np.float32(4.0)
"""Ratio to its floor above which the vibration of a tick is loud."""
LONGEST_AGE = 40
"""Ticks since the crossing after which all are alike."""
TINY = np.float32(1e-30)
HALF = np.float32(0.5)
LEAST_REST = np.float32(1e-6)
"""Least share of the vibration that is taken for no tone."""

FEATURES = (
    *(f"vibration of slice {k} over its floor" for k in range(4)),
    *(f"{name}, share of the vibration" for name in BAND_NAMES),
    *(f"{name}, new over old half" for name in BAND_NAMES),
    *(f"{name} over its floor" for name in BAND_NAMES),
    "greatest slice over the last 16 ms",
    "change of force in 4 ms",
    "change of force in 16 ms",
    "change of force in 62 ms",
    "steepest change of force",
    "what is no tone in 16 ms",
    "ticks since the crossing",
    "least slice of 16 ms",
    "mean vibration over its floor",
    "greatest slice of the slow force",
    "last 12 ms over 12 ms that began 28 ms ago",
    "what is no tone in 32 ms",
    "product with 1 ms before",
    "least slice of 60-250 Hz",
    "loud ticks",
    "last 32 ms over the last 16 ms",
    "16 ms before over its floor",
)
"""Names of the features, in the order of their numbers."""


def log2_steps(ratios: NDArray[Any]) -> Singles:
    """Logarithm to base 2, linear between powers of 2: monotone, within 0.09 and the same bits
    everywhere.
    """
    mantissa, exponent = np.frexp(ratios)
    two = np.float32(2.0)
    return np.asarray(exponent.astype(np.float32) + two * mantissa - two, dtype=np.float32)


def measure(
    energy: Singles,
    tone: Singles,
    force: Singles,
    floors: Singles,
    level_ratio: np.float32,
    age: int,
) -> Singles:
    """Compute the features at the newest tick.

    Args:
        energy: (`RING`, `ENERGIES`) of the last ticks, the newest first [V^2].
        tone: (`RING`, 3) products of the vibration with itself, the newest first [V^2].
        force: (`RING`,) slow force at the ticks, the newest first [V].
        floors: (`ENERGIES`,) energies at rest [V^2].
        level_ratio: Mean vibration over its floor.
        age: Ticks since the crossing.

    Returns:
        (features,), in the order of `FEATURES`.
    """
    slices = HALF * (energy[0::2] + energy[1::2])
    quarters = HALF * (slices[0:8:2] + slices[1:8:2])  # 8 ms each, of 32 ms
    new = quarters[0] + TINY
    old = quarters[1] + TINY
    both = HALF * (new + old)
    total = both[WIDE]
    floor = floors + TINY
    wide = slices[:, WIDE]
    middle = slices[:4, MIDDLE[0]] + slices[:4, MIDDLE[1]]
    all_middle = ((middle[0] + middle[1]) + middle[2]) + middle[3]
    early = (wide[4] + wide[5]) + wide[6]
    late = (wide[0] + wide[1]) + wide[2]
    steepest = np.max(np.abs(force[0 : 2 * PEAK_SLICES : 2] - force[2 : 2 * PEAK_SLICES + 2 : 2]))
    moves = force[0] - force[list(FORCE_TICKS)]
    before = HALF * (quarters[2, WIDE] + quarters[3, WIDE])
    product, untoned = _judge_tone(energy[:, WIDE], tone)

    ratios = np.concatenate(
        (
            (wide[:4] + TINY) / floor[WIDE],
            both[:WIDE] / total,
            new[:WIDE] / old[:WIDE],
            both[:WIDE] / floor[:WIDE],
            [(np.max(wide[:PEAK_SLICES]) + TINY) / total],
            (moves * moves + TINY) / total,
            [
                (steepest * steepest + TINY) / total,
                untoned[0],
                np.float32(1.0),  # the age, which is no ratio
                (np.min(wide[:4]) + TINY) / total,
                level_ratio,
                (np.max(slices[:PEAK_SLICES, SLOW]) + TINY) / both[SLOW],
                (late + TINY) / (early + TINY),
                untoned[1],
                np.float32(1.0),  # the product, which has a sign
                (np.min(middle) + TINY) / (all_middle + TINY),
                np.float32(1.0),  # the number of loud ticks
                (HALF * (total + before) + TINY) / total,
                (before + TINY) / floor[WIDE],
            ],
        )
    )
    row = log2_steps(ratios)
    row[AGE] = min(age, LONGEST_AGE)
    row[PRODUCT] = product
    row[LOUD] = np.count_nonzero(energy[:, WIDE] > LOUD_RATIO * floors[WIDE])
    return row


AGE = FEATURES.index("ticks since the crossing")
PRODUCT = FEATURES.index("product with 1 ms before")
LOUD = FEATURES.index("loud ticks")


def _judge_tone(wide: Singles, tone: Singles) -> tuple[np.float32, list[np.float32]]:
    """Product with 1 ms before over 16 ms, and the share of the last 16 and 32 ms that is no tone.

    In a tone, a sample and the one of 2 ms before add up to a multiple of the one of 1 ms before:
    y(t) + y(t - 2) = k y(t - 1). What is left of the sum is no tone.
    """
    sums = np.column_stack((wide, tone))[:16]
    pairs = sums[0::2] + sums[1::2]
    fours = pairs[0::2] + pairs[1::2]
    eight = fours[0] + fours[1]
    sixteen = eight + (fours[2] + fours[3])
    product = eight[1] / (eight[0] + TINY)
    return product, [_find_rest(eight), _find_rest(sixteen)]


def _find_rest(sums: Singles) -> np.float32:
    square, one_before, two_before, square_before = sums
    square = square + TINY
    power = np.float32(2.0) * (square + two_before)
    cross = np.float32(2.0) * one_before
    left = power - cross * cross / (square_before + TINY)
    return np.float32(max(left / (np.float32(2.0) * square), LEAST_REST))
