"""State of the sample loop of `fast`, by index, its limits, and the functions that update parts of it.

The `CompiledLoop` of `fast_loop` inlines these functions. The firmware's library has the same state and the same limits
(`fingertip.firmware.sources`).
"""

from __future__ import annotations

from fingertip.foundation.jit import Floats, MutableFloats
from fingertip.slip.detectors.analog_and_digital import SecondOrder
from fingertip.slip.detectors.fast_coefficients import DEPTH, FEATURES, NODES, FastCoefficients

COUNT = len(FEATURES)
RING = 26
"""Values of the slow voltage in the ring, every second tick: 100 ms and the present one."""
SLOPE_S = 0.01
"""Time by which slopes are multiplied, so that they compare with voltages [s]."""
MOVE_S = 0.0005
"""Time in which the total movement is expressed [s]."""
UPPER_LOUD, UPPER_LOUD_20 = 2.0, 1.6
"""Ratios of the energies of 6 and 20 ms to the floors below which a signal is quiet, and no tree is evaluated."""
LASTING_RATIO = 3.0
"""Ratio of the upper energy of 20 ms to its floor above which vibration lasts: a knock falls below it soon."""
NOISY_RATIO = 6.0
"""Ratio of the floor of the wide band, or of the slow force, to its lower bound above which there is more noise than
stated, and the threshold rises; at twice that ratio it has risen to its end. The stated noise has the ratio 4."""
MOVING_RATIO = 60.0
"""Ratio of the squared slope to the slow force's floor above which the force changes, so that floors do not adapt."""
CLIP_RATIO = 4.0
"""Ratio of an energy to its floor above which the floor takes it for no more: slip that is not found yet."""
STANDING_TICKS = 1000.0
"""Ticks of such vibration since the force moved last from which on the floors learn it all the same."""
HELD_TICKS = 15.0
"""Ticks of averaging for which a floor stands after the force has changed: it is learned again within 0.5 s."""
LOW_TICKS = 4.0
"""Ticks of a slot of the smallest energy, of which three are kept: 16 to 24 ms. A step ends within them, slip not."""
UNLEARNED_RATIO = 0.03
"""Squared coefficient of variation of the wide energy of a tone; noise in 100 Hz has 0.25 behind 20 ms."""
DECAY_RATIO = 0.02
"""Ratio of the wide energies of 6 and 20 ms below which the vibration has ended. After an abrupt end the ratio falls to
it within 34 ms, however strong the vibration was."""
FADE_RATIO = 0.02
"""Ratio of the upper energy of 6 ms to its peak of 80 to 120 ms below which vibration fades, as that of a knock."""
STEADY_TICKS, STEADY_RATIO = 20.0, 0.15
"""Ticks over which the energy of 6 ms is averaged, and its squared coefficient of variation below which it is a tone:
that of 50 Hz has 0.03, noise in 100 Hz 0.8."""
STEADY_ON_TICKS = 200.0
"""Ticks for which a tone must last before it ends ON: a slide is steady for shorter times."""
UNHEARD_TICKS = 80.0
"""Ticks without vibration that ON outlasts: a weak slide falls below `stay_ratio` at times."""
SURE_TICKS = 60.0
"""Ticks after which incipient slip is ON if its vibration lasts."""
HOLD_SCORE = -2.0
"""Smoothed score above which vibration that lasts stays slip: a lower one keeps a hand's tremor for longer."""
AFTER_TICKS = 250.0
"""Ticks after ON for which floors stand: a slide falters."""
JUMP_MOVES = 8.0
"""Ratio of a jump of the filtered signal to its mean movement between two samples, over 6 ms, that the next sample must
confirm. A jump of less adds some hundredths to the energies of slip, and noise does not reach it."""
TINY = 1e-30
IS_INCIPIENT, IS_ON, IS_REPLACED, IS_OUTSIDE = 1.0, 2.0, 4.0, 8.0
"""Flags, which are summed in the loop's last output: decisions, and faults of the input."""
USED, REPLACED_SAMPLE, CONFIRMED, GLITCH, BEGUN = range(5)
LASTS, SURE = 1, 2


# Indices into the loop's state.
BOARD_STAGE, BOARD_1, BOARD_2, RESTORE_1_1, RESTORE_1, RESTORE_2 = range(6)
EDGE_1, EDGE_2, UPPER_1, UPPER_2, WIDE_1, WIDE_2, SLOW_1, SLOW_2 = range(6, 14)
UPPER_SHORT, UPPER_LONG, WIDE_SHORT, WIDE_LONG, INPUT_LONG = range(14, 19)
EDGE, SLOW, INPUT, FILTERED, NET_SHORT, TOTAL_SHORT, NET_LONG, TOTAL_LONG = range(19, 27)
SLOPE, SLOPE_1, SLOPE_2, PEAK, PEAK_1, PEAK_2, SLOT = range(27, 34)
STEP, FILTERED_STEP, REST, LIMITED, FLOOR, UPPER_FLOOR, INPUT_FLOOR, FLOOR_TICKS, SETTLING = range(34, 43)
ON, ON_TICKS, MEAN, MEAN_SQUARE, SMOOTH_SCORE, PHASE, RING_PHASE, RING_AT, CONFIDENCE = range(43, 52)
INCIPIENT, LOW, LOW_1, LOW_2, LOW_PHASE, ROUGH, STILL, LASTING_TICKS = range(52, 60)
REPLACED, OUTSIDE, MEAN_MOVE, INPUT_CHECK, FILTERED_CHECK, HELD = 60, 61, 62, 63, 66, 69
HEARD_TICKS, HEARD_MEAN, HEARD_SQUARE, STEADY, MEAN_SCORE, AFTER, LEVEL, STANDING, UNHEARD = range(70, 79)
RING_START = 79
STATES = RING_START + RING


def filter_second(section: SecondOrder, value: float, state: MutableFloats, at: int) -> float:
    """Filter a value in a section of second order, in transposed direct form II; its state begins at an index."""
    b0, b1, b2, a1, a2 = section
    filtered = b0 * value + state[at]
    state[at] = b1 * value - a1 * filtered + state[at + 1]
    state[at + 1] = b2 * value - a2 * filtered
    return filtered


def evaluate_trees(row: Floats, at: int, features: Floats, thresholds: Floats, leaves: Floats, offset: float) -> float:
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

    What is no voltage is replaced. A jump is replaced until the next sample confirms it; jumps that follow are trusted
    for a while, so that one sample of a fast movement is late. The state holds from `at` on: samples that were no
    voltage, whether the last one is suspected, and for how many samples jumps are trusted.
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
    """Keep the slow voltage in the ring; return it with its changes since the ring's beginning and its middle."""
    at = int(state[RING_AT])
    state[RING_PHASE] += 1.0
    if state[RING_PHASE] >= 2.0:
        state[RING_PHASE] = 0.0
        state[RING_START + at] = slow
        at += 1
        if at == RING:
            # Only differences count. The sum begins again, so that it never grows beyond the last movements.
            at = 0
            for j in range(RING):
                state[RING_START + j] -= slow
            slow = 0.0
        state[RING_AT] = float(at)
    middle = at + RING // 2
    middle = middle if middle < RING else middle - RING
    return slow, slow - state[RING_START + at], slow - state[RING_START + middle]


def hear(
    c: FastCoefficients, upper: float, wide: float, is_fading: bool, has_ended: bool, wide_now: float,
    state: MutableFloats,
) -> int:  # fmt: skip
    """Follow vibration from the moment it is heard: `LASTS` if it may be what made slip incipient, `SURE` if no knock.

    `upper` and `wide` are the energies of 20 ms over their floors.
    """
    is_heard = upper > c.stay_ratio and state[SETTLING] == 0.0
    if not is_heard and state[INCIPIENT] == 0.0:
        state[HEARD_TICKS] = state[HEARD_MEAN] = state[HEARD_SQUARE] = state[STEADY] = 0.0
        return 0
    state[HEARD_TICKS] += 1.0
    share = 1.0 / min(state[HEARD_TICKS], STEADY_TICKS)
    state[HEARD_MEAN] += share * (wide_now - state[HEARD_MEAN])
    state[HEARD_SQUARE] += share * (wide_now * wide_now - state[HEARD_SQUARE])
    mean = state[HEARD_MEAN]
    is_steady = state[HEARD_SQUARE] - mean * mean < STEADY_RATIO * mean * mean
    state[STEADY] = state[STEADY] + 1.0 if is_steady else 0.0
    is_on = state[ON] > 0.0
    state[UNHEARD] = 0.0 if is_heard or wide > c.stay_ratio else state[UNHEARD] + 1.0
    if has_ended or state[STEADY] > (STEADY_ON_TICKS if is_on else 0.0):
        return 0
    if is_heard and not is_fading:
        return SURE
    return LASTS if (is_on and state[UNHEARD] < UNHEARD_TICKS) or (wide > c.stay_ratio and not is_fading) else 0


def decide(
    c: FastCoefficients, score: float, on_score: float, is_strong: bool, vibration: int, state: MutableFloats
) -> None:
    """Decide whether slip is incipient or ON: not until the floors are learned; it stays while its vibration does."""
    if state[SETTLING] > 0.0:
        state[SETTLING] -= 1.0
        state[INCIPIENT] = 0.0
    elif state[INCIPIENT] > 0.0:
        if state[UNHEARD] == 0.0:  # silence says nothing, and a strong slip no more than a weak one
            state[SMOOTH_SCORE] += c.hold_smoothing * (min(score, c.stay_threshold) - state[SMOOTH_SCORE])
        smooth = state[SMOOTH_SCORE]
        stays = score > c.stay_threshold or (is_strong and smooth > c.stay_threshold)
        stays = stays or (vibration > 0 and smooth > HOLD_SCORE)
        state[INCIPIENT] = 1.0 if stays else 0.0
    else:
        state[SMOOTH_SCORE] = on_score - c.incipient_margin
        state[INCIPIENT] = 1.0 if score > state[SMOOTH_SCORE] or state[MEAN_SCORE] > on_score else 0.0
    is_sure = state[MEAN_SCORE] > on_score or (vibration == SURE and state[ON_TICKS] >= SURE_TICKS)
    is_on = state[INCIPIENT] > 0.0 and (state[ON] > 0.0 or is_sure)
    state[ON] = 1.0 if is_on else 0.0
    state[AFTER] = AFTER_TICKS if is_on else max(state[AFTER] - 1.0, 0.0)


def unlearn_tone(c: FastCoefficients, wide_long: float, upper_long: float, state: MutableFloats) -> None:
    """Let the floors follow a tone that is taken for slip: its energy is constant, and that of slip is not."""
    if state[INCIPIENT] == 0.0:
        state[ON_TICKS] = 0.0
        return
    state[ON_TICKS] += 1.0
    share = 1.0 / min(state[ON_TICKS], c.tone_ticks)
    state[MEAN] += share * (wide_long - state[MEAN])
    state[MEAN_SQUARE] += share * (wide_long * wide_long - state[MEAN_SQUARE])
    mean = state[MEAN]
    if state[ON_TICKS] > c.tone_ticks and state[MEAN_SQUARE] - mean * mean < UNLEARNED_RATIO * mean * mean:
        state[FLOOR] += c.unlearning * (wide_long - state[FLOOR])
        state[UPPER_FLOOR] += c.unlearning * (upper_long - state[UPPER_FLOOR])


def is_learned(upper: float, wide: float, is_moving: bool, state: MutableFloats) -> bool:
    """Judge whether the floors may learn what is heard: noise, a tone, or what lasts while the force stands still.

    `upper` and `wide` are the energies of 20 ms over their floors. The trees have no say in it.
    """
    is_loud = (upper > CLIP_RATIO or wide > CLIP_RATIO) and state[SETTLING] == 0.0
    if is_moving:
        state[STANDING] = 0.0
    elif is_loud:
        state[STANDING] += 1.0
    return not is_loud or state[STEADY] > 0.0 or state[STANDING] > STANDING_TICKS


def learn_floors(
    c: FastCoefficients, wide_long: float, upper_long: float, input_long: float, is_moving: bool, state: MutableFloats
) -> None:
    """Let the floors follow the energies, the more slowly the longer they have; they stand while the force changes."""
    floor, upper_floor, input_floor = state[FLOOR], state[UPPER_FLOOR], state[INPUT_FLOOR]
    if is_moving:
        state[FLOOR_TICKS] = HELD_TICKS
    elif state[FLOOR_TICKS] < 0.0:
        # Until the filters have settled, floors are what they show.
        state[FLOOR_TICKS] += 1.0
        floor, upper_floor, input_floor = wide_long, upper_long, input_long
    else:
        state[FLOOR_TICKS] += 1.0
        share = 1.0 / min(state[FLOOR_TICKS], c.max_floor_ticks)
        floor += share * (min(wide_long, CLIP_RATIO * floor) - floor)
        upper_floor += share * (min(upper_long, CLIP_RATIO * upper_floor) - upper_floor)
        input_floor += share * (min(input_long, CLIP_RATIO * input_floor) - input_floor)
    state[FLOOR] = max(floor, c.min_floor)
    state[UPPER_FLOOR] = max(upper_floor, c.min_upper_floor)
    state[INPUT_FLOOR] = max(input_floor, c.min_input_floor)
