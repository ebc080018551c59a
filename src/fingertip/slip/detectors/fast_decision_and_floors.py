"""Decision and floors of `fast`: what is slip, and what the floors may learn.

A `CompiledLoop` inlines them.
"""

from __future__ import annotations

from fingertip.foundation.jit import MutableFloats
from fingertip.slip.detectors.fast_coefficients import FastCoefficients
from fingertip.slip.detectors.fast_state import (
    AFTER,
    FLOOR,
    FLOOR_TICKS,
    HEARD_MEAN,
    HEARD_SQUARE,
    HEARD_TICKS,
    INCIPIENT,
    INPUT_FLOOR,
    MEAN,
    MEAN_SCORE,
    MEAN_SQUARE,
    ON,
    ON_TICKS,
    SETTLING,
    SMOOTH_SCORE,
    STANDING,
    STEADY,
    UNHEARD,
    UPPER_FLOOR,
)

CLIP_RATIO = 4.0
"""Ratio of an energy to its floor above which the floor takes it
for no more: slip that is not found yet.
"""
STANDING_TICKS = 1000.0
"""Ticks of such vibration since the force moved last from which
on the floors learn it all the same.
"""
HELD_TICKS = 15.0
"""Ticks of averaging for which a floor stands after the force has
changed: it is learned again within 0.5 s.
"""
SILENT_RATIO = 25.0
"""Ratio of the floors of the stated noise, which hold where a
voltage stands still, to the lowest ones.
"""
FALL_TICKS = 100.0
"""Ticks over which a floor that falls averages: noise that has ended,
as that of a touch, hides slip no longer.
"""
UNLEARNED_RATIO = 0.03
"""Squared coefficient of variation of the wide energy of a tone;
noise in 100 Hz has 0.25 behind 20 ms.
"""
STEADY_TICKS = 20.0
STEADY_RATIO = 0.15
"""Ticks over which the energy of 6 ms is averaged, and its squared coefficient of variation below
which it is a tone: that of 50 Hz has 0.03, noise in 100 Hz 0.8.
"""
STEADY_ON_TICKS = 200.0
"""Ticks for which a tone must last before it ends ON: a slide is steady for shorter times."""
UNHEARD_TICKS = 80.0
"""Ticks without vibration that ON outlasts: a weak slide falls below `stay_ratio` at times."""
SURE_TICKS = 60.0
"""Ticks after which incipient slip is ON if its vibration lasts."""
HOLD_SCORE = -1.8
"""Smoothed score above which vibration that lasts stays slip: a
lower one keeps a hand's tremor for longer.
"""
AFTER_TICKS = 250.0
"""Ticks after ON for which floors stand: a slide falters."""
LASTS = 1
SURE = 2


def hear(
    c: FastCoefficients,
    upper: float,
    wide: float,
    is_fading: bool,
    has_ended: bool,
    wide_now: float,
    state: MutableFloats,
) -> int:
    """Follow vibration from the moment it is heard: `LASTS` if it may be what made slip incipient,
    `SURE` if no knock.

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

    return (
        LASTS
        if (is_on and state[UNHEARD] < UNHEARD_TICKS) or (wide > c.stay_ratio and not is_fading)
        else 0
    )


def decide(
    c: FastCoefficients,
    score: float,
    on_score: float,
    is_strong: bool,
    vibration: int,
    state: MutableFloats,
) -> None:
    """Decide whether slip is incipient or ON: not until the floors are
    learned; it stays while its vibration does.
    """
    if state[SETTLING] > 0.0:
        state[SETTLING] -= 1.0
        state[INCIPIENT] = 0.0
    elif state[INCIPIENT] > 0.0:
        if state[UNHEARD] == 0.0:  # silence says nothing, and a strong slip no more than a weak one
            state[SMOOTH_SCORE] += c.hold_smoothing * (
                min(score, c.stay_threshold) - state[SMOOTH_SCORE]
            )

        smooth = state[SMOOTH_SCORE]
        stays = score > c.stay_threshold or (is_strong and smooth > c.stay_threshold)
        stays = stays or (vibration > 0 and smooth > HOLD_SCORE)
        state[INCIPIENT] = 1.0 if stays else 0.0
    else:
        state[SMOOTH_SCORE] = on_score + c.incipient_rise
        is_begun = score > state[SMOOTH_SCORE] or min(score, state[MEAN_SCORE]) > on_score
        state[INCIPIENT] = 1.0 if is_begun else 0.0

    is_sure = state[MEAN_SCORE] > on_score or (vibration == SURE and state[ON_TICKS] >= SURE_TICKS)
    is_on = state[INCIPIENT] > 0.0 and (state[ON] > 0.0 or is_sure)
    state[ON] = 1.0 if is_on else 0.0
    state[AFTER] = AFTER_TICKS if is_on else max(state[AFTER] - 1.0, 0.0)


def unlearn_tone(
    c: FastCoefficients, wide_long: float, upper_long: float, state: MutableFloats
) -> None:
    """Let the floors follow a tone that is taken for slip: its
    energy is constant, and that of slip is not.
    """
    if state[INCIPIENT] == 0.0:
        state[ON_TICKS] = 0.0
        return

    state[ON_TICKS] += 1.0
    share = 1.0 / min(state[ON_TICKS], c.tone_ticks)
    state[MEAN] += share * (wide_long - state[MEAN])
    state[MEAN_SQUARE] += share * (wide_long * wide_long - state[MEAN_SQUARE])
    mean = state[MEAN]

    if (
        state[ON_TICKS] > c.tone_ticks
        and state[MEAN_SQUARE] - mean * mean < UNLEARNED_RATIO * mean * mean
    ):
        state[FLOOR] += c.unlearning * (wide_long - state[FLOOR])
        state[UPPER_FLOOR] += c.unlearning * (upper_long - state[UPPER_FLOOR])


def is_learned(upper: float, wide: float, is_moving: bool, state: MutableFloats) -> bool:
    """Judge whether the floors may learn what is heard: noise, a tone, or what lasts while the
    force stands still.

    `upper` and `wide` are the energies of 20 ms over their floors. The trees have no say in it.
    """
    is_loud = (upper > CLIP_RATIO or wide > CLIP_RATIO) and state[SETTLING] == 0.0
    if is_moving:
        state[STANDING] = 0.0
    elif is_loud:
        state[STANDING] += 1.0

    return not is_loud or state[STEADY] > 0.0 or state[STANDING] > STANDING_TICKS


def learn_floors(
    c: FastCoefficients,
    wide_long: float,
    upper_long: float,
    input_long: float,
    is_moving: bool,
    has_ended: bool,
    state: MutableFloats,
) -> None:
    """Let the floors follow the energies, the more slowly the longer
    they have; they stand while the force changes.
    """
    is_silent = has_ended and c.filtered_gain == 0.0 and input_long < c.silent_floor
    ticks = state[FLOOR_TICKS] + 1.0
    state[FLOOR_TICKS] = HELD_TICKS if is_moving else ticks
    rise = 1.0 / min(max(ticks, 1.0), c.max_floor_ticks)
    fall = 1.0 / min(max(ticks, 1.0), FALL_TICKS)
    bands = (FLOOR, wide_long, c.min_floor), (UPPER_FLOOR, upper_long, c.min_upper_floor)

    for at, energy, least in (*bands, (INPUT_FLOOR, input_long, c.min_input_floor)):
        floor = state[at]
        if ticks <= 0.0 and not is_moving:
            floor = energy  # until the filters have settled
        elif not is_moving and not is_silent:
            floor += (rise if energy > floor else fall) * (min(energy, CLIP_RATIO * floor) - floor)

        state[at] = max(floor, SILENT_RATIO * least if is_silent else least)
