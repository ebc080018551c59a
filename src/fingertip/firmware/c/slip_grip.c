#include "slip_grip.h"

#include <math.h> /* cbrt and INFINITY */

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#include "slip_grip_curve.h"

static const uint32_t LONG_AGO = UINT32_MAX;

float slip_force_n(unsigned finger, float tactile_v) {
    const float *const curve_v = slip_curves_v[slip_curve_of[finger]];
    const float *const curve_n = slip_curves_n[slip_curve_of[finger]];
    unsigned low = 0, high = SLIP_CURVE - 1, middle;
    float slope;
    if (tactile_v <= curve_v[low]) {
        return curve_n[low];
    }
    if (tactile_v >= curve_v[high]) {
        return curve_n[high];
    }
    while (high - low > 1) {
        middle = (low + high) / 2;
        if (curve_v[middle] <= tactile_v) {
            low = middle;
        } else {
            high = middle;
        }
    }
    slope = (curve_n[high] - curve_n[low]) / (curve_v[high] - curve_v[low]);
    return slope * (tactile_v - curve_v[low]) + curve_n[low];
}

float slip_force_interval_n(unsigned finger, float tactile_v, float *low_n, float *high_n) {
    const float force_n = slip_force_n(finger, tactile_v);
    const float *const known_n = slip_known_n[finger];
    const float factor = slip_factors[finger];
    const float within_n = force_n < known_n[0] ? known_n[0] : force_n > known_n[1] ? known_n[1] : force_n;
    *low_n = force_n > known_n[0] ? within_n / (factor * SLIP_HYSTERESIS_FACTOR) : 0.0f;
    *high_n = force_n < known_n[1] ? within_n * factor : INFINITY;
    return force_n;
}

/* Travel of the hand beyond the touch for a force [m]. */
static float depth_m(unsigned finger, float force_n) {
    const float root = (float)cbrt((double)force_n);
    return force_n / SLIP_BACKING_N_PER_M + slip_pads_m_per_n23[slip_curve_of[finger]] * (root * root);
}

/* Closing that increases a force by the ratio, but not beyond the limit [m]. It never opens. */
static float further_m(unsigned finger, float force_n) {
    const float present = force_n > SLIP_GRIP_MIN_PRESENT_N ? force_n : SLIP_GRIP_MIN_PRESENT_N;
    const float wanted = present * SLIP_GRIP_FORCE_RATIO;
    const float target = wanted < SLIP_GRIP_MAX_FORCE_N ? wanted : SLIP_GRIP_MAX_FORCE_N;
    const float further = depth_m(finger, target) - depth_m(finger, present);
    return further > 0.0f ? further : 0.0f;
}

static uint32_t later(uint32_t since_us, uint32_t by_us) {
    return since_us > LONG_AGO - by_us ? LONG_AGO : since_us + by_us;
}

/* Drop what is older than the window, store this moment unless one was stored just before, and return the oldest. */
static const slip_grip_moment *remember(slip_grip *grip, const slip_grip_moment *now) {
    const slip_grip_moment *last;
    while (grip->count > 0 && now->time_us - grip->moments[grip->first].time_us > SLIP_GRIP_WINDOW_US) {
        grip->first = (uint8_t)((grip->first + 1u) % SLIP_GRIP_HISTORY);
        grip->count--;
    }
    last = &grip->moments[(grip->first + grip->count - 1u) % SLIP_GRIP_HISTORY];
    if (grip->count == 0 || now->time_us - last->time_us >= SLIP_GRIP_WINDOW_US / (SLIP_GRIP_HISTORY - 1u)) {
        if (grip->count == SLIP_GRIP_HISTORY) {
            grip->first = (uint8_t)((grip->first + 1u) % SLIP_GRIP_HISTORY);
            grip->count--;
        }
        grip->moments[(grip->first + grip->count) % SLIP_GRIP_HISTORY] = *now;
        grip->count++;
    }
    return &grip->moments[grip->first];
}

void slip_grip_init(slip_grip *grip) {
    *grip = (slip_grip){0};
    grip->since_growth_us = grip->since_tightening_us = LONG_AGO;
}

void slip_grip_release(slip_grip *grip) {
    unsigned i;
    for (i = 0; i < SLIP_FINGERS; i++) {
        grip->target_m[i] = 0.0f;
    }
}

/* Move towards a target by a step at most. */
static float approach(float from, float to, float step) {
    if (to > from + step) {
        return from + step;
    }
    return to < from - step ? from - step : to;
}

bool slip_grip_step(slip_grip *grip, uint32_t now_us, unsigned on, unsigned usable, const slip_grip_input *inputs) {
    const uint32_t elapsed_us = grip->is_started ? now_us - grip->last_us : 0;
    const bool is_late = elapsed_us > SLIP_GRIP_WATCHDOG_US;
    const slip_grip_moment *then;
    slip_grip_moment now;
    float max_step_m, seconds, target;
    bool is_growing = is_late;
    unsigned i;

    grip->last_us = now_us;
    grip->is_late = false;
    grip->is_started = true;
    grip->since_growth_us = later(grip->since_growth_us, elapsed_us);
    grip->since_tightening_us = later(grip->since_tightening_us, elapsed_us);
    now.time_us = now_us;
    for (i = 0; i < SLIP_FINGERS; i++) {
        now.force_n[i] = slip_force_n(i, inputs[i].tactile_v);
        now.closing_m[i] = inputs[i].closing_m;
    }
    if (is_late) {
        grip->count = 0;
    }
    then = remember(grip, &now);
    seconds = 1e-6f * (float)(now_us == then->time_us ? 1u : now_us - then->time_us);
    for (i = 0; i < SLIP_FINGERS; i++) {
        if ((usable >> i & 1u)
            && ((now.force_n[i] - then->force_n[i]) / seconds > SLIP_GRIP_MAX_GROWTH_N_S
                || (now.closing_m[i] - then->closing_m[i]) / seconds > SLIP_GRIP_MAX_CLOSING_M_S)) {
            is_growing = true;
        }
    }
    if (is_growing) {
        grip->since_growth_us = 0;
    }
    grip->is_suppressed = grip->since_growth_us <= SLIP_GRIP_SUPPRESSION_US;
    grip->has_tightened =
        (on & usable) != 0 && !grip->is_suppressed && grip->since_tightening_us >= SLIP_GRIP_REFRACTORY_US;
    if (grip->has_tightened) {
        grip->since_tightening_us = 0;
    }
    max_step_m = is_late ? 0.0f : SLIP_GRIP_MAX_COMMAND_M_S
        * (1e-6f * (float)(elapsed_us < SLIP_GRIP_LONGEST_STEP_US ? elapsed_us : SLIP_GRIP_LONGEST_STEP_US));
    for (i = 0; i < SLIP_FINGERS; i++) {
        if (grip->has_tightened) {
            target = grip->target_m[i] + ((usable >> i & 1u) ? further_m(i, now.force_n[i]) : 0.0f);
            grip->target_m[i] = target < SLIP_GRIP_MAX_ADDED_M ? target : SLIP_GRIP_MAX_ADDED_M;
        }
        /* In a hand that is stiffer than assumed the measured force comes to its limit first: go no further. */
        if (now.force_n[i] >= SLIP_GRIP_MAX_FORCE_N && grip->target_m[i] > grip->added_m[i]) {
            grip->target_m[i] = grip->added_m[i];
        }
        grip->added_m[i] = approach(grip->added_m[i], grip->target_m[i], max_step_m);
    }
    return grip->has_tightened;
}

bool slip_grip_is_alive(slip_grip *grip, uint32_t now_us) {
    /* Signed, as the step may have come just after `now_us` was read. */
    if ((int32_t)(now_us - grip->last_us) > (int32_t)SLIP_GRIP_WATCHDOG_US) {
        grip->is_late = true; /* and stays so when the counter of microseconds comes round */
    }
    return grip->is_started && !grip->is_late;
}
