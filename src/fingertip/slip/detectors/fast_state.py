"""State of the sample loop of `fast`, by index, its limits, and the functions that update parts of
it.

The `CompiledLoop` of `fast_loop` inlines these functions. The firmware's library has the same state
and the same limits (`fingertip.firmware.c_sources`).
"""

from __future__ import annotations

from fingertip.foundation.jit import Floats, MutableFloats
from fingertip.slip.detectors.analog_and_digital import SecondOrder
from fingertip.slip.detectors.fast_coefficients import DEPTH, FEATURES, NODES

COUNT = len(FEATURES)
RING = 26
"""Values of the slow voltage in the ring, every second tick: 100 ms and the present one."""
SLOPE_S = 0.01
"""Time by which slopes are multiplied, so that they compare with voltages [s]."""
UPPER_LOUD = 2.0
UPPER_LOUD_20 = 1.6
"""Ratios of the energies of 6 and 20 ms to the floors below which a
signal is quiet, and no tree is evaluated.
"""
LASTING_RATIO = 3.0
WEAK_RATIO = 1.5
"""Ratios of the upper energy of 20 ms to its floor above which
vibration lasts: a knock falls below them soon.
"""
MOVING_RATIO = 60.0
"""Ratio of the squared slope to the slow force's floor above which the
force changes, so that floors do not adapt.
"""
LOW_TICKS = 4.0
"""Ticks of a slot of the smallest energy, of which three are kept: 16 to 24 ms.
A step ends within them, slip not.
"""
DECAY_RATIO = 0.02
"""Ratio of the wide energies of 6 and 20 ms below which the vibration has ended. After an abrupt
end the ratio falls to it within 34 ms, however strong the vibration was.
"""
FADE_RATIO = 0.02
"""Ratio of the upper energy of 6 ms to its peak of 80 to 120 ms below
which vibration fades, as that of a knock.
"""
JUMP_MOVES = 8.0
"""Ratio of a jump of the filtered signal to its mean movement between two samples, over 6 ms, that
the next sample must confirm. A jump of less adds some hundredths to the energies of slip, and noise
does not reach it.
"""
TINY = 1e-30
IS_INCIPIENT = 1.0
IS_ON = 2.0
IS_REPLACED = 4.0
IS_OUTSIDE = 8.0
"""Flags, which are summed in the loop's last output: decisions, and faults of the input."""
USED, REPLACED_SAMPLE, CONFIRMED, GLITCH, BEGUN = range(5)


# Indices into the loop's state.
BOARD_STAGE, BOARD_1, BOARD_2, RESTORE_1_1, RESTORE_1, RESTORE_2 = range(6)
EDGE_1, EDGE_2, UPPER_1, UPPER_2, WIDE_1, WIDE_2, SLOW_1, SLOW_2 = range(6, 14)
UPPER_SHORT, UPPER_LONG, UPPER_MEAN, WIDE_SHORT, WIDE_LONG, WIDE_MEAN, INPUT_LONG, SLOPE_MEAN = (
    range(14, 22)
)
SLOW, INPUT, FILTERED, SLOPE, SLOPE_1, SLOPE_2, PEAK, PEAK_1, PEAK_2, SLOT = range(22, 32)
STEP, FILTERED_STEP, REST, LIMITED, FLOOR, UPPER_FLOOR, INPUT_FLOOR, FLOOR_TICKS, SETTLING = range(
    32, 41
)
ON, ON_TICKS, MEAN, MEAN_SQUARE, SMOOTH_SCORE, PHASE, RING_PHASE, RING_AT, CONFIDENCE = range(
    41, 50
)
INCIPIENT, LOW, LOW_1, LOW_2, LOW_PHASE, ROUGH, STILL, LASTING_TICKS, WEAK_TICKS = range(50, 59)
REPLACED = 59
OUTSIDE = 60
MEAN_MOVE = 61
INPUT_CHECK = 62
FILTERED_CHECK = 65
HELD = 68
HEARD_TICKS, HEARD_MEAN, HEARD_SQUARE, STEADY, MEAN_SCORE, AFTER, LEVEL, STANDING, UNHEARD = range(
    69, 78
)
RING_START = 78
STATES = RING_START + RING


def filter_second(section: SecondOrder, value: float, state: MutableFloats, at: int) -> float:
    """Filter a value in a section of second order, in transposed
    direct form II; its state begins at an index.
    """
    b0, b1, b2, a1, a2 = section
    filtered = b0 * value + state[at]
    state[at] = b1 * value - a1 * filtered + state[at + 1]
    state[at + 1] = b2 * value - a2 * filtered

    return filtered


def evaluate_trees(
    row: Floats,
    at: int,
    features: Floats,
    thresholds: Floats,
    leaves: Floats,
    offset: float,
) -> float:
    """Sum the leaves of all trees for the features that begin at an index of a sequence."""
    score = offset
    for tree in range(len(leaves) // (NODES + 1)):
        node = 0
        base = tree * NODES
        for _ in range(DEPTH):
            above = row[at + int(features[base + node])] > thresholds[base + node]
            node = 2 * node + (2 if above else 1)

        score += leaves[base + tree + node - NODES]

    return score


def check_sample(
    value: float,
    jump: float,
    number_limit: float,
    jump_limit: float,
    trusted_samples: float,
    gap_samples: float,
    state: MutableFloats,
    at: int,
) -> int:
    """Judge a sample by its value and by its distance from the last one that was used.

    What is no voltage is replaced. A jump is replaced until the next sample confirms it; jumps that
    follow are trusted for a while, so that one sample of a fast movement is late. The state holds
    from `at` on: samples that were no voltage, whether the last one is suspected, and for how many
    samples jumps are trusted.
    """
    if -jump_limit <= jump <= jump_limit and state[at] == state[at + 1] == state[at + 2] == 0.0:
        return USED

    # So written that NaN is no voltage.
    if not -number_limit <= value <= number_limit:
        state[at] += 1.0
        return REPLACED_SAMPLE

    is_gap = state[at] > gap_samples
    is_suspected = state[at + 1] > 0.0
    # What comes back half the way is vibration, and no glitch.
    limit = 0.5 * jump_limit if is_suspected else jump_limit
    is_jump = not -limit <= jump <= limit
    state[at] = 0.0

    if is_jump and not is_suspected and not is_gap and state[at + 2] == 0.0:
        state[at + 1] = 1.0
        return REPLACED_SAMPLE

    state[at + 1] = 0.0
    if is_jump:
        state[at + 2] = trusted_samples
    elif state[at + 2] > 0.0:
        state[at + 2] -= 1.0

    if is_gap:
        return BEGUN
    if is_suspected:
        return CONFIRMED if is_jump else GLITCH

    return USED


def find_lowest(wide_short: float, state: MutableFloats) -> float:
    """Find the smallest energy of the last slots: of the present one, what it has shown so far."""
    state[LOW_PHASE] += 1.0
    if state[LOW_PHASE] > LOW_TICKS:
        state[LOW_PHASE] = 1.0
        state[LOW_2], state[LOW_1], state[LOW] = state[LOW_1], state[LOW], wide_short
    else:
        state[LOW] = min(state[LOW], wide_short)

    return min(state[LOW], state[LOW_1], state[LOW_2])


def measure_changes(slow: float, state: MutableFloats) -> tuple[float, float, float]:
    """Keep the slow voltage in the ring; return it with its changes
    since the ring's beginning and its middle.
    """
    at = int(state[RING_AT])
    state[RING_PHASE] += 1.0

    if state[RING_PHASE] >= 2.0:
        state[RING_PHASE] = 0.0
        state[RING_START + at] = slow
        at += 1

        if at == RING:
            # Only differences count. The sum begins again, so that it never grows beyond the last
            # movements.
            at = 0
            for j in range(RING):
                state[RING_START + j] -= slow

            slow = 0.0

        state[RING_AT] = float(at)

    middle = at + RING // 2
    middle = middle if middle < RING else middle - RING
    return slow, slow - state[RING_START + at], slow - state[RING_START + middle]
