"""Sample loop of the detector `fast`: filters and energies at every sample; features, floors,
decision at every tick.

A tick follows every few samples, 2 ms apart. The loop needs no buffer of samples: energies are
exponential means, peaks are kept in three slots of 40 ms, and the slow voltage in a ring of one
value for every second tick.

The filters of the tactile voltage take the differences between samples, so they hold no voltage but
its changes. A high-pass filter has a zero at 0 Hz, which the difference is. The slow voltage is the
sum of its filtered differences since the last revolution of the ring, the rough voltage the sum of
what the slow one lacks. The constant part of the input thus costs no digits, and single precision
suffices (`fingertip.firmware`): rounding lets the rough voltage walk by less than 1 uV in an hour,
and every leak against that would leave a trace of each contact in it.
"""

from __future__ import annotations

import math

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats
from fingertip.slip.detectors.fast_coefficients import FastCoefficients
from fingertip.slip.detectors.fast_decision_and_floors import (
    decide,
    hear,
    is_learned,
    learn_floors,
    unlearn_tone,
)
from fingertip.slip.detectors.fast_state import (
    AFTER,
    BEGUN,
    BOARD_1,
    BOARD_STAGE,
    CONFIDENCE,
    CONFIRMED,
    DECAY_RATIO,
    EDGE_1,
    FADE_RATIO,
    FILTERED,
    FILTERED_CHECK,
    FILTERED_STEP,
    FLOOR,
    GLITCH,
    HELD,
    INCIPIENT,
    INPUT,
    INPUT_CHECK,
    INPUT_FLOOR,
    INPUT_LONG,
    IS_ON,
    IS_OUTSIDE,
    IS_REPLACED,
    JUMP_MOVES,
    LASTING_RATIO,
    LASTING_TICKS,
    LEVEL,
    LIMITED,
    MEAN_MOVE,
    MEAN_SCORE,
    MOVING_RATIO,
    ON,
    OUTSIDE,
    PEAK,
    PEAK_1,
    PEAK_2,
    PHASE,
    REPLACED,
    REPLACED_SAMPLE,
    REST,
    RESTORE_1,
    RESTORE_1_1,
    ROUGH,
    SETTLING,
    SLOPE,
    SLOPE_1,
    SLOPE_2,
    SLOPE_MEAN,
    SLOPE_S,
    SLOT,
    SLOW,
    SLOW_1,
    STEP,
    STILL,
    TINY,
    UPPER_1,
    UPPER_FLOOR,
    UPPER_LONG,
    UPPER_LOUD,
    UPPER_LOUD_20,
    UPPER_MEAN,
    UPPER_SHORT,
    WEAK_RATIO,
    WEAK_TICKS,
    WIDE_1,
    WIDE_LONG,
    WIDE_MEAN,
    WIDE_SHORT,
    check_sample,
    evaluate_trees,
    filter_second,
    find_lowest,
    measure_changes,
)


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
    p_b, _, p_a1 = c.board_1
    q_b0, q_b1, q_a1 = c.restore_1
    board = c.board
    restore = c.restore
    edge = c.edge
    upper = c.upper
    wide = c.wide
    slow_band = c.slow
    short_smoothing = c.short_smoothing
    long_smoothing = c.long_smoothing
    tick_samples = c.tick_samples
    number_limit = c.number_limit
    jump_limit = c.jump_limit
    middle_input = c.middle_input
    half_range = c.half_range
    trusted_samples = c.trusted_samples
    gap_samples = c.gap_samples
    fault_samples = c.fault_samples
    filtered_gain = c.filtered_gain
    still_samples = c.still_samples
    p = state[BOARD_STAGE]
    q1 = state[RESTORE_1_1]
    upper_short = state[UPPER_SHORT]
    upper_long = state[UPPER_LONG]
    wide_short = state[WIDE_SHORT]
    wide_long = state[WIDE_LONG]
    input_long = state[INPUT_LONG]
    last_input = state[INPUT]
    last_filtered = state[FILTERED]
    slow = state[SLOW]
    rough = state[ROUGH]
    still = state[STILL]
    slope_0 = state[SLOPE]
    slope_1 = state[SLOPE_1]
    slope_2 = state[SLOPE_2]
    peak_0 = state[PEAK]
    peak_1 = state[PEAK_1]
    peak_2 = state[PEAK_2]
    slot = state[SLOT]
    step = state[STEP]
    filtered_step = state[FILTERED_STEP]
    rest = state[REST]
    limited = state[LIMITED]
    confidence = state[CONFIDENCE]
    lasting_ticks = state[LASTING_TICKS]
    phase = state[PHASE]
    replaced = state[REPLACED]
    outside = state[OUTSIDE]
    mean_move = state[MEAN_MOVE]
    held = state[HELD]
    slope_gain = SLOPE_S * SLOPE_S * c.sample_rate_hz * c.sample_rate_hz
    at = 0
    level = c.statistic_gain * math.sqrt(state[FLOOR])

    for i in range(len(samples)):
        x = samples[i]
        change = x - last_input
        is_off_level = False

        if filtered_gain > 0.0:
            if abs(filtered_samples[i]) <= number_limit:
                state[LEVEL] += c.level_smoothing * (filtered_samples[i] - state[LEVEL])

            is_off_level = not -c.rest_limit <= state[LEVEL] - c.filtered_rest <= c.rest_limit
            if is_off_level and still < still_samples:
                state[SETTLING] = max(state[SETTLING], c.restart_ticks)

        found = check_sample(
            x,
            jump=change,
            number_limit=number_limit,
            jump_limit=jump_limit,
            trusted_samples=trusted_samples,
            gap_samples=gap_samples,
            state=state,
            at=INPUT_CHECK,
        )
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

        # The board's own filtered signal has finer steps and less noise, unless it stands still or
        # a stage is at its limit.
        if filtered_gain > 0.0:
            y = filtered_gain * (filtered_samples[i] - rest)
            move = y - last_filtered
            # A jump is one where the signal stood nearly still: in slip, what is far beyond its
            # movement until then.
            limit = max(JUMP_MOVES * mean_move, c.filtered_jump_limit)
            found = check_sample(
                y,
                jump=move,
                number_limit=number_limit,
                jump_limit=limit,
                trusted_samples=trusted_samples,
                gap_samples=gap_samples,
                state=state,
                at=FILTERED_CHECK,
            )
            late = 0.0

            if found == REPLACED_SAMPLE:
                held = move
                y = last_filtered
                move = 0.0
            elif found == CONFIRMED and state[SETTLING] > 0.0:
                rest = filtered_samples[i]
                y = move = 0.0
            elif found == CONFIRMED and move * held > 0.5 * held * held:
                # r adds its input up for 10 ms: it gets what was held back, unless that was a
                # glitch
                late = held

            last_filtered = y
            if found == GLITCH or state[FILTERED_CHECK] > 0.0:
                replaced = fault_samples

            if state[FILTERED_CHECK] > gap_samples and still < still_samples:
                still = (
                    still_samples  # T alone is judged, and what the change of signals leaves is not
                )
                state[SETTLING] = max(state[SETTLING], c.restart_ticks)

            move = abs(move)
            mean_move += short_smoothing * (move - mean_move)
            if 0.0 < move < filtered_step:
                filtered_step = move

            still = 0.0 if move > 0.0 else still + 1.0
            if is_off_level:
                still = still_samples
            if abs(p) > c.filtered_limit or abs(y) > c.filtered_limit:
                limited = c.limited_samples

            if limited > 0.0:
                limited -= 1.0
            elif still < still_samples:
                h = y + late

        # r has the cutoff of the bands, e lies below their upper edge; u upper band, w wide band;
        # slope is the difference of the slow voltage.
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
                slope_2 = slope_1
                slope_1 = slope_0
                slope_0 = 0.0
                peak_2 = peak_1
                peak_1 = peak_0
                peak_0 = 0.0

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
            state[UPPER_MEAN] += c.weak_smoothing * (upper_short - state[UPPER_MEAN])
            state[WIDE_MEAN] += c.weak_smoothing * (wide_short - state[WIDE_MEAN])
            state[SLOPE_MEAN] += c.weak_smoothing * (slope - state[SLOPE_MEAN])
            upper_mean = state[UPPER_MEAN]
            wide_mean = state[WIDE_MEAN]
            slope_mean = state[SLOPE_MEAN]
            rows[at] = upper_short / high_floor
            rows[at + 1] = upper_long / high_floor
            rows[at + 2] = wide_short / wide_floor
            rows[at + 3] = wide_long / wide_floor
            rows[at + 4] = greatest / slow_floor
            rows[at + 5] = change * change / slow_floor
            rows[at + 6] = half_change * abs(half_change) / slow_floor
            rows[at + 7] = upper_short / (peak + TINY)
            rows[at + 8] = wide_long / (greatest + TINY)
            rows[at + 9] = upper_long / (greatest + TINY)
            rows[at + 10] = upper_long / (wide_long + TINY)
            rows[at + 11] = slope / (greatest + TINY)
            rows[at + 12] = low / wide_floor
            rows[at + 13] = low / (wide_long + TINY)
            rows[at + 14] = upper_mean / high_floor
            rows[at + 15] = wide_mean / wide_floor
            rows[at + 16] = slope_mean / slow_floor
            rows[at + 17] = slope_mean / (greatest + TINY)
            rows[at + 18] = upper_mean / (wide_mean + TINY)
            rows[at + 19] = upper_long / (upper_mean + TINY)
            lasting_ticks = lasting_ticks + 1.0 if rows[at + 1] > LASTING_RATIO else 0.0
            state[WEAK_TICKS] = state[WEAK_TICKS] + 1.0 if rows[at + 1] > WEAK_RATIO else 0.0
            rows[at + 20] = lasting_ticks
            rows[at + 21] = state[WEAK_TICKS]
            is_loud = (
                rows[at] > UPPER_LOUD
                or rows[at + 2] > UPPER_LOUD
                or rows[at + 1] > UPPER_LOUD_20
                or rows[at + 3] > UPPER_LOUD_20
            )
            score = (
                evaluate_trees(
                    rows,
                    at=at,
                    features=features,
                    thresholds=thresholds,
                    leaves=leaves,
                    offset=c.offset,
                )
                if is_loud
                else c.lowest_score
            )
            # In more noise or coarser steps than stated, more must speak for slip.
            excess = max(wide_floor / c.noisy_floor, slow_floor / c.noisy_slow_floor) - 1.0
            on_score = c.threshold + c.noise_rise * min(max(excess, 0.0), 1.0)
            mean_score = state[MEAN_SCORE] + c.mean_smoothing * (score - state[MEAN_SCORE])
            state[MEAN_SCORE] = mean_score
            confidence = max((mean_score - c.lowest_score) / (on_score - c.lowest_score), 0.0)
            has_ended = not wide_short > DECAY_RATIO * wide_long
            is_strong = (
                rows[at + 1] > c.stay_ratio or rows[at + 3] > c.stay_ratio
            ) and not has_ended
            is_fading = not rows[at + 7] > FADE_RATIO
            vibration = hear(
                c,
                upper=rows[at + 1],
                wide=rows[at + 3],
                is_fading=is_fading,
                has_ended=has_ended,
                wide_now=rows[at + 2],
                state=state,
            )
            is_moving = greatest > MOVING_RATIO * slow_floor and state[SETTLING] == 0.0
            may_learn = is_learned(rows[at + 1], rows[at + 3], is_moving, state)
            at += stride

            decide(
                c,
                score=score,
                on_score=on_score,
                is_strong=is_strong,
                vibration=vibration,
                state=state,
            )
            unlearn_tone(c, wide_long, upper_long, state)
            is_settled = state[SETTLING] == 0.0
            # No floor learns what the trees may take for slip, nor what follows a slide.
            is_held = (
                state[INCIPIENT] > 0.0
                or state[AFTER] > 0.0
                or (score > c.stay_threshold and is_settled)
            )

            if not is_held and replaced == 0.0 and (may_learn or is_moving):
                learn_floors(
                    c,
                    wide_long=wide_long,
                    upper_long=upper_long,
                    input_long=input_long,
                    is_moving=is_moving,
                    has_ended=has_ended,
                    state=state,
                )

            level = c.statistic_gain * math.sqrt(state[FLOOR])

        filtered[i] = w
        confidences[i] = confidence
        levels[i] = level
        flags[i] = state[INCIPIENT] + IS_ON * state[ON]
        if replaced > 0.0:
            flags[i] += IS_REPLACED
        if outside > fault_samples:
            flags[i] += IS_OUTSIDE

    state[BOARD_STAGE] = p
    state[RESTORE_1_1] = q1
    state[UPPER_SHORT] = upper_short
    state[UPPER_LONG] = upper_long
    state[WIDE_SHORT] = wide_short
    state[WIDE_LONG] = wide_long
    state[INPUT_LONG] = input_long
    state[INPUT] = last_input
    state[FILTERED] = last_filtered
    state[SLOW] = slow
    state[ROUGH] = rough
    state[STILL] = still
    state[SLOPE] = slope_0
    state[SLOPE_1] = slope_1
    state[SLOPE_2] = slope_2
    state[PEAK] = peak_0
    state[PEAK_1] = peak_1
    state[PEAK_2] = peak_2
    state[SLOT] = slot
    state[STEP] = step
    state[FILTERED_STEP] = filtered_step
    state[REST] = rest
    state[LIMITED] = limited
    state[CONFIDENCE] = confidence
    state[LASTING_TICKS] = lasting_ticks
    state[PHASE] = phase
    state[REPLACED] = replaced
    state[OUTSIDE] = outside
    state[MEAN_MOVE] = mean_move
    state[HELD] = held


LOOP = CompiledLoop(
    _fast_loop,
    evaluate_trees,
    check_sample,
    filter_second,
    find_lowest,
    measure_changes,
    hear,
    decide,
    unlearn_tone,
    is_learned,
    learn_floors,
    samples="samples",
    plain_us=4.0,
)
