#include "slip_detector.h"

#include <math.h> /* INFINITY, and fabs, which is one instruction */

/* A product and a sum must not be contracted into one rounding: numbers are then those of fingertip's Python. GCC knows
 * no such pragma and takes -ffp-contract=off instead, which is its default with -std=c99. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#define R(number) ((slip_real)(number))

#if defined(__GNUC__)
#define NOT_INLINED __attribute__((noinline))
#else
#define NOT_INLINED
#endif

/* Trees compare keys: integers in the order of the floats whose bits they hold, which a controller compares faster. A
 * double is its own key. */
#define IS_DOUBLE_float 0
#define IS_DOUBLE_double 1
#define PASTE(left, right) left##right
#define IS_DOUBLE(type) PASTE(IS_DOUBLE_, type)

#if IS_DOUBLE(SLIP_REAL)

#define MAGNITUDE fabs

typedef double slip_key;
#define KEY(number, bits) (number)

static slip_key key_of(slip_real value) {
    return value;
}

#else

#define MAGNITUDE fabsf

typedef uint32_t slip_key;
#define KEY(number, bits) (bits)

/* Key of a feature. Every threshold is less than infinity; NaN is above none of them. */
static slip_key key_of(slip_real value) {
    const union {
        slip_real real;
        uint32_t bits;
    } both = {value};
    if (value != value) {
        return 0;
    }
    return both.bits & 0x80000000u ? ~both.bits : both.bits | 0x80000000u;
}

#endif

enum { LEAVES = 1 << SLIP_DEPTH };

#include "slip_trees.h"

static slip_real greater(slip_real one, slip_real other) {
    return one > other ? one : other;
}

static slip_real lesser(slip_real one, slip_real other) {
    return one < other ? one : other;
}

/* Sum the leaves of all trees. Nodes count from 1: node k has the branches 2 k and 2 k + 1, and entry 0 is not used. */
static slip_real evaluate_trees(const slip_real *row) {
    slip_key keys[SLIP_COUNT];
    const uint8_t *feature = slip_features;
    const slip_key *threshold = slip_thresholds;
    const slip_real *leaf = slip_leaves;
    slip_real score = SLIP_OFFSET;
    unsigned i, tree, node, level;
    for (i = 0; i < SLIP_COUNT; i++) {
        keys[i] = key_of(row[i]);
    }
    for (tree = 0; tree < SLIP_TREES; tree++) {
        node = 1;
#if defined(__GNUC__)
#pragma GCC unroll 4
#endif
        for (level = 0; level < SLIP_DEPTH; level++) {
            node = 2 * node + (keys[feature[node]] > threshold[node] ? 1 : 0);
        }
        score += leaf[node - LEAVES];
        feature += LEAVES;
        threshold += LEAVES;
        leaf += LEAVES;
    }
    return score;
}

/* Move a floor towards an energy, which counts as no more than some times the floor: by one share up, another down. */
static slip_real adapt_floor(slip_real level, slip_real energy, slip_real rise, slip_real fall) {
    return level + (energy > level ? rise : fall) * (lesser(energy, SLIP_CLIP_RATIO * level) - level);
}

enum vibration { NONE, LASTS, SURE };

/* Follow vibration from the moment it is heard: whether it may be what made slip incipient, and is no knock. `upper` and
 * `wide` are the energies of 20 ms over their floors, `now` is the wide one of 6 ms. */
static enum vibration hear(slip_state *state, slip_real upper, slip_real wide, slip_real now, bool is_fading,
                           bool has_ended) {
    const bool is_heard = upper > SLIP_STAY_RATIO && state->settling == 0;
    slip_real share = R(1.0) / SLIP_STEADY_TICKS, mean;
    bool is_steady;
    if (!is_heard && !state->incipient) {
        state->heard_ticks = state->steady = 0;
        state->heard_mean = state->heard_square = R(0.0);
        return NONE;
    }
    if (state->heard_ticks < SLIP_STEADY_COUNT) {
        state->heard_ticks++;
        share = R(1.0) / (slip_real)(int32_t)state->heard_ticks;
    }
    state->heard_mean += share * (now - state->heard_mean);
    state->heard_square += share * (now * now - state->heard_square);
    mean = state->heard_mean;
    is_steady = state->heard_square - mean * mean < SLIP_STEADY_RATIO * mean * mean;
    if (!is_steady) {
        state->steady = 0;
    } else if (state->steady <= SLIP_STEADY_ON_TICKS) {
        state->steady++;
    }
    if (is_heard || wide > SLIP_STAY_RATIO) {
        state->unheard = 0;
    } else if (state->unheard < SLIP_UNHEARD_TICKS) {
        state->unheard++;
    }
    if (has_ended || state->steady > (state->on ? SLIP_STEADY_ON_TICKS : 0)) {
        return NONE;
    }
    if (is_heard && !is_fading) {
        return SURE;
    }
    return (state->on && state->unheard < SLIP_UNHEARD_TICKS) || (wide > SLIP_STAY_RATIO && !is_fading) ? LASTS : NONE;
}

/* Judge whether the floors may learn what is heard: noise, a tone, or what lasts while the force stands still. */
static bool is_learned(slip_state *state, slip_real upper, slip_real wide, bool is_moving) {
    const bool is_loud = (upper > SLIP_CLIP_RATIO || wide > SLIP_CLIP_RATIO) && state->settling == 0;
    if (is_moving) {
        state->standing = 0;
    } else if (is_loud && state->standing <= SLIP_STANDING_TICKS) {
        state->standing++;
    }
    return !is_loud || state->steady > 0 || state->standing > SLIP_STANDING_TICKS;
}

/* Decide at a tick: features, trees, ON or OFF, floors. `slope` is the squared slope of this sample [V^2]. */
static void tick(slip_state *state, slip_real slope) {
    slip_real row[SLIP_COUNT];
    slip_real wide_floor, upper_floor, slow_floor, greatest, peak, low, change, half_change, score, share, fall, excess;
    slip_real on_score, input_noise, step_noise, raised;
    unsigned middle, i;
    bool is_strong, is_moving, may_learn, is_held, has_ended, is_fading, is_silent;
    enum vibration vibration;

    greatest = greater(state->slopes[2], greater(state->slopes[0], state->slopes[1]));
    peak = greater(state->peaks[2], greater(state->peaks[0], state->peaks[1]));
    state->slot++;
    if (state->slot >= SLIP_SLOT_TICKS) {
        state->slot = 0;
        state->slopes[2] = state->slopes[1];
        state->slopes[1] = state->slopes[0];
        state->slopes[0] = R(0.0);
        state->peaks[2] = state->peaks[1];
        state->peaks[1] = state->peaks[0];
        state->peaks[0] = R(0.0);
    }
    /* Smallest energy of the last slots: of this one, what it has shown so far. */
    state->low_phase++;
    if (state->low_phase > SLIP_LOW_TICKS) {
        state->low_phase = 1;
        state->lows[2] = state->lows[1];
        state->lows[1] = state->lows[0];
        state->lows[0] = state->wide_short;
    }
    state->lows[0] = lesser(state->wide_short, state->lows[0]);
    low = lesser(state->lows[2], lesser(state->lows[0], state->lows[1]));
    state->ring_phase++;
    if (state->ring_phase >= 2) {
        state->ring_phase = 0;
        state->ring[state->ring_at] = state->slow;
        state->ring_at++;
        if (state->ring_at == SLIP_RING) {
            /* Only differences count. The sum begins again, so that it never grows beyond the last movements. */
            state->ring_at = 0;
            for (i = 0; i < SLIP_RING; i++) {
                state->ring[i] -= state->slow;
            }
            state->slow = R(0.0);
        }
    }
    change = state->slow - state->ring[state->ring_at];
    middle = state->ring_at + SLIP_RING / 2u;
    half_change = SLIP_DIRECTION * (state->slow - state->ring[middle < SLIP_RING ? middle : middle - SLIP_RING]);

    /* Floors are at least the noise of a converter halfway between two codes. */
    input_noise = R(0.25) * state->step * state->step;
    step_noise = state->has_filtered && state->still < SLIP_STILL_SAMPLES
        ? R(0.25) * state->filtered_step * state->filtered_step : input_noise;
    wide_floor = greater(state->floor, step_noise * SLIP_WIDE_SHARE);
    upper_floor = greater(state->upper_floor, step_noise * SLIP_UPPER_SHARE);
    slow_floor = SLIP_WIDE_SHARE * greater(state->input_floor, input_noise);
    greatest *= SLIP_SLOPE_GAIN;
    slope *= SLIP_SLOPE_GAIN;
    state->upper_mean += SLIP_WEAK_SMOOTHING * (state->upper_short - state->upper_mean);
    state->wide_mean += SLIP_WEAK_SMOOTHING * (state->wide_short - state->wide_mean);
    state->slope_mean += SLIP_WEAK_SMOOTHING * (slope - state->slope_mean);
    row[0] = state->upper_short / upper_floor;
    row[1] = state->upper_long / upper_floor;
    row[2] = state->wide_short / wide_floor;
    row[3] = state->wide_long / wide_floor;
    has_ended = !(state->wide_short > SLIP_DECAY_RATIO * state->wide_long);
    is_strong = (row[1] > SLIP_STAY_RATIO || row[3] > SLIP_STAY_RATIO) && !has_ended;
    state->lasting_ticks = row[1] > SLIP_LASTING_RATIO ? state->lasting_ticks + R(1.0) : R(0.0);
    state->weak_ticks = row[1] > SLIP_WEAK_RATIO ? state->weak_ticks + R(1.0) : R(0.0);
    if (row[0] > SLIP_LOUD || row[2] > SLIP_LOUD || row[1] > SLIP_LOUD_20 || row[3] > SLIP_LOUD_20) {
        row[4] = greatest / slow_floor;
        row[5] = change * change / slow_floor;
        row[6] = half_change * MAGNITUDE(half_change) / slow_floor;
        row[7] = state->upper_short / (peak + SLIP_TINY);
        row[8] = state->wide_long / (greatest + SLIP_TINY);
        row[9] = state->upper_long / (greatest + SLIP_TINY);
        row[10] = state->upper_long / (state->wide_long + SLIP_TINY);
        row[11] = slope / (greatest + SLIP_TINY);
        row[12] = low / wide_floor;
        row[13] = low / (state->wide_long + SLIP_TINY);
        row[14] = state->upper_mean / upper_floor;
        row[15] = state->wide_mean / wide_floor;
        row[16] = state->slope_mean / slow_floor;
        row[17] = state->slope_mean / (greatest + SLIP_TINY);
        row[18] = state->upper_mean / (state->wide_mean + SLIP_TINY);
        row[19] = state->upper_long / (state->upper_mean + SLIP_TINY);
        row[20] = state->lasting_ticks;
        row[21] = state->weak_ticks;
        score = evaluate_trees(row);
        is_fading = !(row[7] > SLIP_FADE_RATIO);
    } else { /* a quiet signal does not fade */
        is_fading = true;
        score = SLIP_LOWEST_SCORE;
    }

    /* In more noise or coarser steps than stated, more must speak for slip. */
    excess = greater(wide_floor / state->noisy_floor, slow_floor / SLIP_NOISY_SLOW_FLOOR) - R(1.0);
    on_score = SLIP_ON_SCORE + SLIP_NOISE_RISE * greater(R(0.0), lesser(excess, R(1.0)));
    state->mean_score += SLIP_MEAN_SMOOTHING * (score - state->mean_score);
    state->confidence = greater(R(0.0), (state->mean_score - SLIP_LOWEST_SCORE) / (on_score - SLIP_LOWEST_SCORE));

    vibration = hear(state, row[1], row[3], row[2], is_fading, has_ended);
    is_moving = greatest > SLIP_MOVING_RATIO * slow_floor && state->settling == 0;
    may_learn = is_learned(state, row[1], row[3], is_moving);
    /* Decision: OFF until the floors are learned; slip that has begun stays while its energy does. */
    if (state->settling > 0) {
        state->settling--;
        state->incipient = false;
    } else if (state->incipient) {
        if (state->unheard == 0) { /* silence says nothing, and a strong slip no more than a weak one */
            state->smooth_score += SLIP_HOLD_SMOOTHING * (lesser(score, SLIP_STAY_SCORE) - state->smooth_score);
        }
        state->incipient = score > SLIP_STAY_SCORE || (is_strong && state->smooth_score > SLIP_STAY_SCORE)
            || (vibration != NONE && state->smooth_score > SLIP_HOLD_SCORE);
    } else {
        state->smooth_score = on_score + SLIP_INCIPIENT_RISE;
        state->incipient = score > state->smooth_score || lesser(score, state->mean_score) > on_score;
    }
    state->on = state->incipient
        && (state->on || state->mean_score > on_score
            || (vibration == SURE && state->on_ticks >= SLIP_SURE_TICKS));
    if (state->on) {
        state->after = SLIP_AFTER_TICKS;
    } else if (state->after > 0) {
        state->after--;
    }

    /* No floor learns what the trees may take for slip, nor what follows a slide. */
    is_held = state->incipient || state->after > 0 || (score > SLIP_STAY_SCORE && state->settling == 0)
        || state->replaced > 0;

    if (state->incipient) {
        /* A tone's energy is constant and that of slip is not: floors follow a tone. */
        state->on_ticks += R(1.0);
        share = R(1.0) / lesser(state->on_ticks, SLIP_TONE_TICKS);
        state->mean += share * (state->wide_long - state->mean);
        state->mean_square += share * (state->wide_long * state->wide_long - state->mean_square);
        if (state->on_ticks > SLIP_TONE_TICKS
            && state->mean_square - state->mean * state->mean < SLIP_UNLEARNED_RATIO * state->mean * state->mean) {
            state->floor += SLIP_UNLEARNING * (state->wide_long - state->floor);
            state->upper_floor += SLIP_UNLEARNING * (state->upper_long - state->upper_floor);
        }
    } else {
        state->on_ticks = R(0.0);
    }

    if (is_held || !(may_learn || is_moving)) {
        return;
    }
    /* A voltage that stands still shows no noise to learn. */
    is_silent = has_ended && !state->has_filtered && state->input_long < SLIP_MIN_INPUT_FLOOR;
    if (is_moving) {
        state->floor_ticks = SLIP_HELD_TICKS;
    } else if (state->floor_ticks < R(0.0)) {
        /* Until the filters have settled, floors are what they show. */
        state->floor_ticks += R(1.0);
        state->floor = state->wide_long;
        state->upper_floor = state->upper_long;
        state->input_floor = state->input_long;
    } else if (is_silent) {
        state->floor_ticks += R(1.0);
    } else {
        state->floor_ticks += R(1.0);
        share = R(1.0) / lesser(state->floor_ticks, SLIP_MAX_FLOOR_TICKS);
        fall = R(1.0) / lesser(state->floor_ticks, SLIP_FALL_TICKS);
        state->floor = adapt_floor(state->floor, state->wide_long, share, fall);
        state->upper_floor = adapt_floor(state->upper_floor, state->upper_long, share, fall);
        state->input_floor = adapt_floor(state->input_floor, state->input_long, share, fall);
    }
    raised = is_silent ? SLIP_SILENT_RATIO : R(1.0);
    state->floor = greater(state->floor, raised * state->min_floor);
    state->upper_floor = greater(state->upper_floor, raised * state->min_upper_floor);
    state->input_floor = greater(state->input_floor, raised * SLIP_MIN_INPUT_FLOOR);
}

enum check { USED, REPLACED_SAMPLE, CONFIRMED, GLITCH, BEGUN };

/* Return whether a value is at most as large as a limit. NaN is not. */
static bool is_within(slip_real value, slip_real limit) {
    return MAGNITUDE(value) <= limit;
}

/* Judge a sample by its value and by its distance from the last one that was used. What is no voltage is replaced. A
 * jump is replaced until the next sample confirms it; jumps that follow are trusted for a while. Where nothing is wrong
 * and the sample does not jump, which is nearly always so, the callers need not ask. */
static NOT_INLINED enum check check_sample(slip_check *check, slip_real value, slip_real jump, slip_real limit) {
    bool is_gap, is_suspected, is_jump;
    if (!is_within(value, SLIP_NUMBER_LIMIT)) {
        if (check->wrong < UINT16_MAX) {
            check->wrong++;
        }
        return REPLACED_SAMPLE;
    }
    is_gap = check->wrong > SLIP_GAP_SAMPLES;
    is_suspected = check->is_suspected;
    /* What comes back half the way is vibration, and no glitch. */
    is_jump = !is_within(jump, is_suspected ? R(0.5) * limit : limit);
    check->wrong = 0;
    if (is_jump && !is_suspected && !is_gap && check->trusted == 0) {
        check->is_suspected = true;
        return REPLACED_SAMPLE;
    }
    check->is_suspected = false;
    if (is_jump) {
        check->trusted = SLIP_TRUSTED_SAMPLES;
    } else if (check->trusted > 0) {
        check->trusted--;
    }
    if (is_gap) {
        return BEGUN;
    }
    return !is_suspected ? USED : is_jump ? CONFIRMED : GLITCH;
}

static bool is_wrong(const slip_check *check) {
    return check->wrong > 0 || check->trusted > 0 || check->is_suspected;
}

/* Note whether the checks must be asked for the next sample. */
static void note_busy(slip_state *state) {
    state->is_busy = is_wrong(&state->tactile_check) || is_wrong(&state->filtered_check) || state->replaced > 0;
}

/* Stay OFF for a while, until the filters have settled after a gap. */
static void restart(slip_state *state) {
    if (state->settling < SLIP_RESTART_TICKS) {
        state->settling = SLIP_RESTART_TICKS;
    }
}

/* Judge a sample of T by its voltage and its change [V], note its faults, and return whether it is used. If not, or
 * where it begins anew, the change is 0. */
static NOT_INLINED bool use_tactile(slip_state *state, slip_real tactile_v, slip_real *change) {
    const enum check found = check_sample(&state->tactile_check, tactile_v, *change, SLIP_JUMP_LIMIT);
    /* After a gap much may have happened; and before the detector has settled, the first sample may be a glitch. */
    if (found == REPLACED_SAMPLE || found == BEGUN || (found == CONFIRMED && state->settling > 0)) {
        *change = R(0.0);
    }
    if (found == GLITCH || state->tactile_check.wrong > 0) {
        state->replaced = SLIP_FAULT_SAMPLES;
    } else if (state->replaced > 0) {
        state->replaced--;
    }
    if (state->tactile_check.wrong > SLIP_GAP_SAMPLES) {
        restart(state);
    }
    note_busy(state);
    return found != REPLACED_SAMPLE;
}

/* Judge a sample of the filtered signal, as a voltage at the filter's input [V], by its distance from the last one that
 * was used. Return it, or the last one in its place; where its rest is to be set anew, that is its place. `late` becomes
 * what was held back of the sample before it. */
static NOT_INLINED slip_real use_filtered(slip_state *state, slip_real filtered, slip_real limit, slip_real *late) {
    const slip_real move = filtered - state->last_filtered;
    const enum check found = check_sample(&state->filtered_check, filtered, move, limit);
    if (found == GLITCH || state->filtered_check.wrong > 0) {
        state->replaced = SLIP_FAULT_SAMPLES;
    }
    if (state->filtered_check.wrong > SLIP_GAP_SAMPLES && state->still < SLIP_STILL_SAMPLES) {
        /* T alone is judged, and what the change of signals leaves is not. */
        state->still = SLIP_STILL_SAMPLES;
        restart(state);
    }
    note_busy(state);
    if (found == REPLACED_SAMPLE) {
        state->held = move;
        return state->last_filtered;
    }
    if (found == CONFIRMED && state->settling > 0) {
        state->begins = true;
        state->last_filtered = R(0.0);
        return R(0.0);
    }
    /* The restoring filter adds its input up for 10 ms: it gets what was held back, unless that was a glitch. */
    if (found == CONFIRMED && move * state->held > R(0.5) * state->held * state->held) {
        *late = state->held;
    }
    return filtered;
}

/* Count how long the tactile voltage has been one that no force gives. */
static void note_outside(slip_state *state, bool is_outside) {
    if (!is_outside) {
        state->outside = 0;
    } else if (state->outside <= SLIP_FAULT_SAMPLES) {
        state->outside++;
    }
}

/* Process one sample: the change of the tactile voltage [V], and the filtered signal's deviation from its rest [V]. */
static void step(slip_state *state, slip_real change, slip_real deviation) {
    slip_real move, limit, late, board, filtered, restored, edge, upper, wide, slope;

    /* Smallest step of the converter: the smallest difference between two samples. */
    move = MAGNITUDE(change);
    if (R(0.0) < move && move < state->step) {
        state->step = move;
    }

    /* The stages of the board's filter, driven by the voltage. */
    state->board_stage = SLIP_BOARD_1_B * change - SLIP_BOARD_1_A1 * state->board_stage;
    board = SLIP_BOARD_B0 * state->board_stage + state->board_1;
    state->board_1 = SLIP_BOARD_B1 * state->board_stage - SLIP_BOARD_A1 * board + state->board_2;
    state->board_2 = SLIP_BOARD_B2 * state->board_stage - SLIP_BOARD_A2 * board;

    /* The board's own filtered signal has finer steps and less noise, unless it stands still or a stage is at its
     * limit. */
    if (state->has_filtered) {
        filtered = SLIP_FILTERED_GAIN * deviation;
        move = filtered - state->last_filtered;
        late = R(0.0);
        /* A jump is one where the signal stood nearly still: in slip, what is far beyond its movement until then. */
        limit = greater(SLIP_JUMP_MOVES * state->mean_move, SLIP_FILTERED_JUMP_LIMIT);
        if (state->is_busy || !is_within(move, limit)) {
            filtered = use_filtered(state, filtered, limit, &late);
            move = filtered - state->last_filtered;
        }
        state->last_filtered = filtered;
        move = MAGNITUDE(move);
        state->mean_move += SLIP_SHORT * (move - state->mean_move);
        if (R(0.0) < move && move < state->filtered_step) {
            state->filtered_step = move;
        }
        if (move > R(0.0)) {
            state->still = 0;
        } else if (state->still < SLIP_STILL_SAMPLES) {
            state->still++;
        }
        if (state->is_off_level) {
            state->still = SLIP_STILL_SAMPLES;
        }
        if (!is_within(state->board_stage, SLIP_FILTERED_LIMIT) || !is_within(filtered, SLIP_FILTERED_LIMIT)) {
            state->limited = SLIP_LIMITED_SAMPLES;
        }
        if (state->limited > 0) {
            state->limited--;
        } else if (state->still < SLIP_STILL_SAMPLES) {
            board = filtered + late;
        }
    }

    /* Filters: the board's with a lower cutoff, below the upper edge, upper band, wide band, slope of the slow voltage. */
    move = SLIP_RESTORE_1_B0 * board + state->restore_1_1;
    state->restore_1_1 = SLIP_RESTORE_1_B1 * board - SLIP_RESTORE_1_A1 * move;
    restored = SLIP_RESTORE_B0 * move + state->restore_1;
    state->restore_1 = SLIP_RESTORE_B1 * move - SLIP_RESTORE_A1 * restored + state->restore_2;
    state->restore_2 = SLIP_RESTORE_B2 * move - SLIP_RESTORE_A2 * restored;
    edge = SLIP_EDGE_B0 * restored + state->edge_1;
    state->edge_1 = SLIP_EDGE_B1 * restored - SLIP_EDGE_A1 * edge + state->edge_2;
    state->edge_2 = SLIP_EDGE_B2 * restored - SLIP_EDGE_A2 * edge;
    upper = SLIP_UPPER_B0 * edge + state->upper_1;
    state->upper_1 = SLIP_UPPER_B1 * edge - SLIP_UPPER_A1 * upper + state->upper_2;
    state->upper_2 = SLIP_UPPER_B2 * edge - SLIP_UPPER_A2 * upper;
    wide = SLIP_WIDE_B0 * edge + state->wide_1;
    state->wide_1 = SLIP_WIDE_B1 * edge - SLIP_WIDE_A1 * wide + state->wide_2;
    state->wide_2 = SLIP_WIDE_B2 * edge - SLIP_WIDE_A2 * wide;
    slope = SLIP_SLOW_B0 * change + state->slow_1;
    state->slow_1 = SLIP_SLOW_B1 * change - SLIP_SLOW_A1 * slope + state->slow_2;
    state->slow_2 = SLIP_SLOW_B2 * change - SLIP_SLOW_A2 * slope;
    state->slow += slope;
    state->wide = wide;

    /* Energies: exponential means of the squares. */
    state->upper_short += SLIP_SHORT * (upper * upper - state->upper_short);
    state->upper_long += SLIP_LONG * (upper * upper - state->upper_long);
    state->wide_short += SLIP_SHORT * (wide * wide - state->wide_short);
    state->wide_long += SLIP_LONG * (wide * wide - state->wide_long);
    state->rough += change - slope;
    state->input_long += SLIP_LONG * (state->rough * state->rough - state->input_long);

    /* Squared slope and upper energy, the greatest of each slot. */
    slope *= slope;
    state->slopes[0] = greater(slope, state->slopes[0]);
    state->peaks[0] = greater(state->upper_short, state->peaks[0]);

    state->phase++;
    if (state->phase >= SLIP_TICK_SAMPLES) {
        state->phase = 0;
        tick(state, slope);
    }
}

/* Begin with the first sample: whether it has a filtered signal decides what noise is stated. */
static void start(slip_state *state, bool has_filtered) {
    state->is_started = true;
    state->has_filtered = has_filtered && SLIP_FILTERED_GAIN > R(0.0);
    if (state->has_filtered) {
        state->wide_short = state->wide_long = state->wide_mean = SLIP_FILTERED_STATED_WIDE;
        state->upper_short = state->upper_long = state->upper_mean = SLIP_FILTERED_STATED_UPPER;
        if (!state->is_recalled) {
            state->floor = state->wide_long;
            state->upper_floor = state->upper_long;
        }
        state->min_floor = SLIP_FILTERED_MIN_FLOOR;
        state->noisy_floor = SLIP_FILTERED_NOISY_FLOOR;
        state->min_upper_floor = SLIP_FILTERED_MIN_UPPER_FLOOR;
    }
    if (state->is_recalled) {
        state->floor = greater(state->floor, state->min_floor);
        state->upper_floor = greater(state->upper_floor, state->min_upper_floor);
        state->input_floor = greater(state->input_floor, SLIP_MIN_INPUT_FLOOR);
    }
}

void slip_recall(slip_state *state, slip_floors floors) {
    if (!(floors.wide > R(0.0) && floors.upper > R(0.0) && floors.tactile > R(0.0))) {
        return;
    }
    state->is_recalled = true;
    state->floor = floors.wide;
    state->upper_floor = floors.upper;
    state->input_floor = floors.tactile;
    state->settling = (uint16_t)SLIP_SETTLE_TICKS;
    state->floor_ticks = SLIP_MAX_FLOOR_TICKS;
}

void slip_init_finger(slip_state *state, unsigned finger) {
    slip_init(state);
    state->phase = (uint16_t)(finger % SLIP_TICK_SAMPLES);
}

void slip_init(slip_state *state) {
    *state = (slip_state){0};
    /* Energies and floors start at those of the stated noise. */
    state->wide_short = state->wide_long = state->wide_mean = state->floor = SLIP_STATED_WIDE;
    state->upper_short = state->upper_long = state->upper_mean = state->upper_floor = SLIP_STATED_UPPER;
    state->input_long = state->input_floor = SLIP_STATED_INPUT;
    state->min_floor = SLIP_MIN_FLOOR;
    state->noisy_floor = SLIP_NOISY_FLOOR;
    state->min_upper_floor = SLIP_MIN_UPPER_FLOOR;
    state->step = state->filtered_step = R(INFINITY);
    state->still = SLIP_STILL_SAMPLES;
    state->mean_move = SLIP_FILTERED_JUMP_LIMIT;
    state->mean_score = SLIP_LOWEST_SCORE;
    state->settling = SLIP_SETTLING_TICKS;
    state->floor_ticks = -SLIP_SETTLE_TICKS;
}

/* Process volts. The inputs were constant until the first sample, so nothing is in the bands then. */
static bool step_volts(slip_state *state, slip_real tactile_v, slip_real filtered_v, bool has_filtered) {
    slip_real change;
    if (!state->is_started) {
        start(state, has_filtered);
        state->last_tactile_v = is_within(tactile_v, SLIP_NUMBER_LIMIT) ? tactile_v : R(0.0);
        state->rest_v = is_within(filtered_v, SLIP_NUMBER_LIMIT) ? filtered_v : R(0.0);
    }
    change = tactile_v - state->last_tactile_v;
    if ((!state->is_busy && is_within(change, SLIP_JUMP_LIMIT)) || use_tactile(state, tactile_v, &change)) {
        state->last_tactile_v = tactile_v;
        note_outside(state, !is_within(tactile_v - SLIP_MIDDLE_INPUT, SLIP_HALF_RANGE));
    }
    step(state, change, filtered_v - state->rest_v);
    if (state->is_busy && state->begins) {
        state->begins = false;
        state->rest_v = filtered_v;
    }
    return state->on;
}

bool slip_step(slip_state *state, slip_real tactile_v, slip_real filtered_v) {
    return step_volts(state, tactile_v, filtered_v, true);
}

bool slip_step_tactile(slip_state *state, slip_real tactile_v) {
    return step_volts(state, tactile_v, R(0.0), false);
}

/* Note whether S rests far from the middle of the supply, as where its wire is open: then T alone is judged, and what
 * the change of signals leaves is not. */
static void note_level(slip_state *state, int32_t filtered_code) {
    state->level += SLIP_LEVEL_SHARE * ((slip_real)filtered_code - state->level);
    state->is_off_level = !is_within(state->level - SLIP_REST_CODE, SLIP_REST_CODES);
    if (state->is_off_level && state->still < SLIP_STILL_SAMPLES && state->settling < SLIP_RESTART_TICKS) {
        state->settling = SLIP_RESTART_TICKS;
    }
}

/* Process codes in the same way. */
static bool step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code, bool has_filtered) {
    slip_real change;
    if (!state->is_started) {
        start(state, has_filtered);
        state->last_tactile_code = tactile_code;
        state->rest_code = filtered_code;
        state->level = (slip_real)filtered_code;
    }
    if (state->has_filtered) {
        note_level(state, filtered_code);
    }
    change = SLIP_ADC_STEP_V * (slip_real)(tactile_code - state->last_tactile_code);
    /* Every code is a voltage. */
    if ((!state->is_busy && is_within(change, SLIP_JUMP_LIMIT)) || use_tactile(state, R(0.0), &change)) {
        state->last_tactile_code = tactile_code;
        note_outside(state, tactile_code < SLIP_LOWEST_CODE || tactile_code > SLIP_HIGHEST_CODE);
    }
    step(state, change, SLIP_ADC_STEP_V * (slip_real)(filtered_code - state->rest_code));
    if (state->is_busy && state->begins) {
        state->begins = false;
        state->rest_code = filtered_code;
    }
    return state->on;
}

bool slip_step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code) {
    return step_codes(state, tactile_code, filtered_code, true);
}

bool slip_step_tactile_code(slip_state *state, int32_t tactile_code) {
    return step_codes(state, tactile_code, 0, false);
}

bool slip_step_lost(slip_state *state) {
    slip_real change = R(0.0);
    if (state->is_started) {
        use_tactile(state, R(INFINITY), &change);
        step(state, change, R(INFINITY));
    }
    return state->on;
}

void slip_process(slip_state *state, const slip_real *tactile_v, const slip_real *filtered_v, size_t count,
                  uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = step_volts(state, tactile_v[i], filtered_v ? filtered_v[i] : R(0.0), filtered_v != NULL) ? 1u : 0u;
    }
}
