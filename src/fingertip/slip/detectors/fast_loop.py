"""Sample loop of the detector `fast`: filters and energies at every sample; features, floors, decision at every tick.

A tick follows every few samples, 2 ms apart. The loop needs no buffer of samples: energies are exponential means, peaks
are kept in three slots of 40 ms, and the slow voltage in a ring of one value for every second tick.

The filters of the tactile voltage take the differences between samples, so they hold no voltage but its changes. A
high-pass filter has a zero at 0 Hz, which the difference is. The slow voltage is the sum of its filtered differences
since the last revolution of the ring, the rough voltage the sum of what the slow one lacks. The constant part of the
input thus costs no digits, and single precision suffices (`fingertip.firmware`): rounding lets the rough voltage walk
by less than 1 uV in an hour, and every leak against that would leave a trace of each contact in it.
"""

from __future__ import annotations

import math

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
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
HELD_TICKS = 15.0
"""Ticks of averaging for which a floor stands after the force has changed: it is learned again within 0.5 s."""
LOW_TICKS = 4.0
"""Ticks of a slot of the smallest energy, of which three are kept: 16 to 24 ms. A step ends within them, slip not."""
UNLEARNED_RATIO = 0.03
"""Squared coefficient of variation of the wide energy of a tone; noise in 100 Hz has 0.25 behind 20 ms."""
DECAY_RATIO = 0.02
"""Ratio of the wide energies of 6 and 20 ms below which the vibration has ended. After an abrupt end the ratio falls to
it within 34 ms, however strong the vibration was."""
JUMP_MOVES = 8.0
"""Ratio of a jump of the filtered signal to its mean movement between two samples, over 6 ms, that the next sample must
confirm. A jump of less adds some hundredths to the energies of slip, and noise does not reach it."""
TINY = 1e-30
IS_INCIPIENT, IS_ON, IS_REPLACED, IS_OUTSIDE = 1.0, 2.0, 4.0, 8.0
"""Flags, which are summed in the loop's last output: decisions, and faults of the input."""
USED, REPLACED_SAMPLE, CONFIRMED, GLITCH, BEGUN = range(5)


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
RING_START = 70
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


def decide(c: FastCoefficients, score: float, on_score: float, is_strong: bool, state: MutableFloats) -> None:
    """Decide whether slip is incipient or ON: not until the floors are learned; it stays while its energy does."""
    if state[SETTLING] > 0.0:
        state[SETTLING] -= 1.0
        state[INCIPIENT] = 0.0
    elif state[INCIPIENT] > 0.0:
        state[SMOOTH_SCORE] += c.score_smoothing * (score - state[SMOOTH_SCORE])
        stays = score > c.stay_threshold or (is_strong and state[SMOOTH_SCORE] > c.stay_threshold)
        state[INCIPIENT] = 1.0 if stays else 0.0
    else:
        state[SMOOTH_SCORE] = on_score - c.incipient_margin
        state[INCIPIENT] = 1.0 if score > state[SMOOTH_SCORE] else 0.0
    is_on = state[INCIPIENT] > 0.0 and (state[ON] > 0.0 or score > on_score)
    state[ON] = 1.0 if is_on else 0.0


def unlearn_tone(c: FastCoefficients, wide_long: float, upper_long: float, state: MutableFloats) -> None:
    """Let the floors follow a tone that is taken for slip: its energy is constant, and that of slip is not."""
    if state[INCIPIENT] == 0.0:
        state[ON_TICKS] = state[MEAN] = state[MEAN_SQUARE] = 0.0
        return
    state[ON_TICKS] += 1.0
    share = 1.0 / min(state[ON_TICKS], c.tone_ticks)
    state[MEAN] += share * (wide_long - state[MEAN])
    state[MEAN_SQUARE] += share * (wide_long * wide_long - state[MEAN_SQUARE])
    mean = state[MEAN]
    if state[ON_TICKS] > c.tone_ticks and state[MEAN_SQUARE] - mean * mean < UNLEARNED_RATIO * mean * mean:
        state[FLOOR] += c.unlearning * (wide_long - state[FLOOR])
        state[UPPER_FLOOR] += c.unlearning * (upper_long - state[UPPER_FLOOR])


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


def _fast_loop(
    c: FastCoefficients,
    features: Floats,
    thresholds: Floats,
    leaves: Floats,
    stride: int,
    samples: Floats,
    filtered_samples: Floats,
    state: MutableFloats,
    rows: MutableFloats,
    filtered: MutableFloats,
    confidences: MutableFloats,
    levels: MutableFloats,
    flags: MutableFloats,
) -> None:
    (p_b, _, p_a1), (q_b0, q_b1, q_a1) = c.board_1, c.restore_1
    board, restore, edge, upper, wide, slow_band = c.board, c.restore, c.edge, c.upper, c.wide, c.slow
    short_smoothing, long_smoothing, tick_samples = c.short_smoothing, c.long_smoothing, c.tick_samples
    number_limit, jump_limit, middle_input, half_range = c.number_limit, c.jump_limit, c.middle_input, c.half_range
    trusted_samples, gap_samples, fault_samples = c.trusted_samples, c.gap_samples, c.fault_samples
    filtered_gain, still_samples = c.filtered_gain, c.still_samples
    p, q1 = state[BOARD_STAGE], state[RESTORE_1_1]
    upper_short, upper_long = state[UPPER_SHORT], state[UPPER_LONG]
    wide_short, wide_long = state[WIDE_SHORT], state[WIDE_LONG]
    input_long = state[INPUT_LONG]
    last_edge, last_input, last_filtered = state[EDGE], state[INPUT], state[FILTERED]
    slow, rough, still = state[SLOW], state[ROUGH], state[STILL]
    net_short, total_short = state[NET_SHORT], state[TOTAL_SHORT]
    net_long, total_long = state[NET_LONG], state[TOTAL_LONG]
    slope_0, slope_1, slope_2 = state[SLOPE], state[SLOPE_1], state[SLOPE_2]
    peak_0, peak_1, peak_2, slot = state[PEAK], state[PEAK_1], state[PEAK_2], state[SLOT]
    step, filtered_step, rest, limited = state[STEP], state[FILTERED_STEP], state[REST], state[LIMITED]
    confidence, lasting_ticks, phase = state[CONFIDENCE], state[LASTING_TICKS], state[PHASE]
    replaced, outside, mean_move, held = state[REPLACED], state[OUTSIDE], state[MEAN_MOVE], state[HELD]
    slope_gain = SLOPE_S * SLOPE_S * c.sample_rate_hz * c.sample_rate_hz
    move_gain = MOVE_S * MOVE_S * c.sample_rate_hz * c.sample_rate_hz
    at = 0
    level = c.statistic_gain * math.sqrt(state[FLOOR])
    for i in range(len(samples)):
        x = samples[i]
        change = x - last_input
        found = check_sample(x, change, number_limit, jump_limit, trusted_samples, gap_samples, state, INPUT_CHECK)
        if found == REPLACED_SAMPLE:
            change = 0.0
        else:
            last_input = x
            outside = 0.0 if -half_range <= x - middle_input <= half_range else outside + 1.0
            if found == BEGUN or (found == CONFIRMED and state[SETTLING] > 0.0):
                change = 0.0  # much may have happened in the gap, or the first sample was a glitch
        if found == GLITCH or state[INPUT_CHECK] > 0.0:
            replaced = fault_samples
        elif replaced > 0.0:
            replaced -= 1.0
        if state[INPUT_CHECK] > gap_samples:
            state[SETTLING] = max(state[SETTLING], c.restart_ticks)

        # Smallest step of the converter: the smallest difference between two samples.
        if 0.0 < abs(change) < step:
            step = abs(change)

        # Filters. p and h are the stages of the board's filter, driven by the voltage.
        p = p_b * change - p_a1 * p
        h = filter_second(board, p, state, BOARD_1)

        # The board's own filtered signal has finer steps and less noise, unless it stands still or a stage is at its
        # limit.
        if filtered_gain > 0.0:
            y = filtered_gain * (filtered_samples[i] - rest)
            move = y - last_filtered
            # A jump is one where the signal stood nearly still: in slip, what is far beyond its movement until then.
            limit = max(JUMP_MOVES * mean_move, c.filtered_jump_limit)
            found = check_sample(y, move, number_limit, limit, trusted_samples, gap_samples, state, FILTERED_CHECK)
            late = 0.0
            if found == REPLACED_SAMPLE:
                held, y, move = move, last_filtered, 0.0
            elif found == CONFIRMED and state[SETTLING] > 0.0:
                rest = filtered_samples[i]
                y = move = 0.0
            elif found == CONFIRMED and move * held > 0.5 * held * held:
                late = held  # r adds its input up for 10 ms: it gets what was held back, unless that was a glitch
            last_filtered = y
            if found == GLITCH or state[FILTERED_CHECK] > 0.0:
                replaced = fault_samples
            if state[FILTERED_CHECK] > gap_samples and still < still_samples:
                still = still_samples  # T alone is judged, and what the change of signals leaves is not
                state[SETTLING] = max(state[SETTLING], c.restart_ticks)
            move = abs(move)
            mean_move += short_smoothing * (move - mean_move)
            if 0.0 < move < filtered_step:
                filtered_step = move
            still = 0.0 if move > 0.0 else still + 1.0
            if abs(p) > c.filtered_limit or abs(y) > c.filtered_limit:
                limited = c.limited_samples
            if limited > 0.0:
                limited -= 1.0
            elif still < still_samples:
                h = y + late

        # r has the cutoff of the bands, e lies below their upper edge; u upper band, w wide band; slope is the
        # difference of the slow voltage.
        q = q_b0 * h + q1
        q1 = q_b1 * h - q_a1 * q
        r = filter_second(restore, q, state, RESTORE_1)
        e = filter_second(edge, r, state, EDGE_1)
        u = filter_second(upper, e, state, UPPER_1)
        w = filter_second(wide, e, state, WIDE_1)
        slope = filter_second(slow_band, change, state, SLOW_1)
        slow += slope

        # Energies: exponential means of the squares.
        upper_short += short_smoothing * (u * u - upper_short)
        upper_long += long_smoothing * (u * u - upper_long)
        wide_short += short_smoothing * (w * w - wide_short)
        wide_long += long_smoothing * (w * w - wide_long)
        rough += change - slope
        input_long += long_smoothing * (rough * rough - input_long)

        # Net and total movement, which are equal while the force goes one way.
        move = e - last_edge
        last_edge = e
        net_short += short_smoothing * (move - net_short)
        net_long += long_smoothing * (move - net_long)
        total_short += short_smoothing * (abs(move) - total_short)
        total_long += long_smoothing * (abs(move) - total_long)

        # Squared slope and upper energy, the greatest of each slot.
        slope *= slope
        slope_0 = max(slope_0, slope)
        peak_0 = max(peak_0, upper_short)

        phase += 1.0
        if phase >= tick_samples:
            phase = 0.0
            greatest = max(slope_0, slope_1, slope_2)
            peak = max(peak_0, peak_1, peak_2)
            slot += 1.0
            if slot >= c.slot_ticks:
                slot = 0.0
                slope_2, slope_1, slope_0 = slope_1, slope_0, 0.0
                peak_2, peak_1, peak_0 = peak_1, peak_0, 0.0
            low = find_lowest(wide_short, state)
            slow, change, half_change = measure_changes(slow, state)
            half_change *= c.direction

            # Floors are at least the noise of a converter halfway between two codes.
            input_noise = 0.25 * step * step
            is_filtered = filtered_gain > 0.0 and still < still_samples
            step_noise = 0.25 * filtered_step * filtered_step if is_filtered else input_noise
            wide_floor = max(state[FLOOR], step_noise * c.wide_share)
            high_floor = max(state[UPPER_FLOOR], step_noise * c.upper_share)
            slow_floor = c.wide_share * max(state[INPUT_FLOOR], input_noise)
            greatest *= slope_gain
            slope *= slope_gain
            rows[at] = upper_short / high_floor
            rows[at + 1] = upper_long / high_floor
            rows[at + 2] = wide_short / wide_floor
            rows[at + 3] = wide_long / wide_floor
            rows[at + 4] = greatest / slow_floor
            rows[at + 5] = change * change / slow_floor
            rows[at + 6] = half_change * abs(half_change) / slow_floor
            rows[at + 7] = net_short * net_short / (total_short * total_short + TINY)
            rows[at + 8] = upper_short / (peak + TINY)
            rows[at + 9] = wide_long / (greatest + TINY)
            rows[at + 10] = upper_long / (greatest + TINY)
            rows[at + 11] = upper_long / (wide_long + TINY)
            rows[at + 12] = move_gain * total_short * total_short / wide_floor
            rows[at + 13] = slope / (greatest + TINY)
            rows[at + 14] = net_long * net_long / (total_long * total_long + TINY)
            lasting_ticks = lasting_ticks + 1.0 if rows[at + 1] > LASTING_RATIO else 0.0
            rows[at + 15] = lasting_ticks
            rows[at + 16] = low / wide_floor
            rows[at + 17] = low / (wide_long + TINY)
            is_loud = (
                rows[at] > UPPER_LOUD
                or rows[at + 2] > UPPER_LOUD
                or rows[at + 1] > UPPER_LOUD_20
                or rows[at + 3] > UPPER_LOUD_20
            )
            score = evaluate_trees(rows, at, features, thresholds, leaves, c.offset) if is_loud else c.lowest_score
            # In more noise or coarser steps than stated, more must speak for slip.
            excess = wide_floor / (NOISY_RATIO * c.min_floor) - 1.0
            input_excess = slow_floor / (NOISY_RATIO * c.wide_share * c.min_input_floor) - 1.0
            on_score = c.threshold + c.noise_rise * min(max(excess, input_excess, 0.0), 1.0)
            confidence = max((score - c.lowest_score) / (on_score - c.lowest_score), 0.0)
            is_strong = (
                rows[at + 1] > c.stay_ratio or rows[at + 3] > c.stay_ratio
            ) and wide_short > DECAY_RATIO * wide_long
            at += stride

            decide(c, score, on_score, is_strong, state)
            unlearn_tone(c, wide_long, upper_long, state)
            is_settled = state[SETTLING] == 0.0
            # No floor learns what the trees may take for slip, however long it lasts and whatever came before it.
            if state[INCIPIENT] == 0.0 and not (score > c.stay_threshold and is_settled) and replaced == 0.0:
                is_moving = greatest > MOVING_RATIO * slow_floor and is_settled
                learn_floors(c, wide_long, upper_long, input_long, is_moving, state)
            level = c.statistic_gain * math.sqrt(state[FLOOR])

        filtered[i] = w
        confidences[i] = confidence
        levels[i] = level
        flags[i] = state[INCIPIENT] + IS_ON * state[ON]
        if replaced > 0.0:
            flags[i] += IS_REPLACED
        if outside > fault_samples:
            flags[i] += IS_OUTSIDE
    state[BOARD_STAGE], state[RESTORE_1_1] = p, q1
    state[UPPER_SHORT], state[UPPER_LONG] = upper_short, upper_long
    state[WIDE_SHORT], state[WIDE_LONG] = wide_short, wide_long
    state[INPUT_LONG] = input_long
    state[EDGE], state[INPUT], state[FILTERED] = last_edge, last_input, last_filtered
    state[SLOW], state[ROUGH], state[STILL] = slow, rough, still
    state[NET_SHORT], state[TOTAL_SHORT] = net_short, total_short
    state[NET_LONG], state[TOTAL_LONG] = net_long, total_long
    state[SLOPE], state[SLOPE_1], state[SLOPE_2] = slope_0, slope_1, slope_2
    state[PEAK], state[PEAK_1], state[PEAK_2], state[SLOT] = peak_0, peak_1, peak_2, slot
    state[STEP], state[FILTERED_STEP], state[REST], state[LIMITED] = step, filtered_step, rest, limited
    state[CONFIDENCE], state[LASTING_TICKS], state[PHASE] = confidence, lasting_ticks, phase
    state[REPLACED], state[OUTSIDE], state[MEAN_MOVE], state[HELD] = replaced, outside, mean_move, held


LOOP = CompiledLoop(
    _fast_loop, evaluate_trees, check_sample, filter_second, find_lowest, measure_changes, decide, unlearn_tone,
    learn_floors, outputs=6, samples="samples", plain_us=4.0,
)  # fmt: skip
