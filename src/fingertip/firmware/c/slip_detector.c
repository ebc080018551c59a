#include "slip_detector.h"

#include <math.h> /* INFINITY alone */

/* A product and a sum must not be contracted into one rounding: numbers are then those of fingertip's Python. GCC knows
 * no such pragma and takes -ffp-contract=off instead, which is its default with -std=c99. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#define R(number) ((slip_real)(number))

/* Trees compare keys: integers in the order of the floats whose bits they hold, which a controller compares faster. A
 * double is its own key. */
#define IS_DOUBLE_float 0
#define IS_DOUBLE_double 1
#define PASTE(left, right) left##right
#define IS_DOUBLE(type) PASTE(IS_DOUBLE_, type)

#if IS_DOUBLE(SLIP_REAL)

typedef double slip_key;
#define KEY(number, bits) (number)

static slip_key key_of(slip_real value) {
    return value;
}

#else

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

/* Move a floor by a share towards an energy, which counts as no more than some times the floor. */
static slip_real adapt_floor(slip_real level, slip_real energy, slip_real share) {
    slip_real clipped = SLIP_CLIP_RATIO * level;
    return level + share * ((energy < clipped ? energy : clipped) - level);
}

/* Decide at a tick: features, trees, ON or OFF, floors. `slope` is the squared slope of this sample [V^2]. */
static void tick(slip_state *state, slip_real slope) {
    slip_real row[SLIP_COUNT];
    slip_real wide_floor, upper_floor, greatest, peak, change, half_change, step_noise, lowest, score, share;
    unsigned middle, i;
    bool is_strong;

    greatest = state->slopes[0] > state->slopes[1] ? state->slopes[0] : state->slopes[1];
    if (state->slopes[2] > greatest) {
        greatest = state->slopes[2];
    }
    peak = state->peaks[0] > state->peaks[1] ? state->peaks[0] : state->peaks[1];
    if (state->peaks[2] > peak) {
        peak = state->peaks[2];
    }
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
    half_change = state->slow - state->ring[middle < SLIP_RING ? middle : middle - SLIP_RING];

    /* Floors are at least the noise of a converter halfway between two codes. */
    step_noise = R(0.25) * state->step * state->step;
    lowest = step_noise * SLIP_WIDE_SHARE;
    wide_floor = state->floor > lowest ? state->floor : lowest;
    lowest = step_noise * SLIP_UPPER_SHARE;
    upper_floor = state->upper_floor > lowest ? state->upper_floor : lowest;
    greatest *= SLIP_SLOPE_GAIN;
    slope *= SLIP_SLOPE_GAIN;
    row[0] = state->upper_short / upper_floor;
    row[1] = state->upper_long / upper_floor;
    row[2] = state->wide_short / wide_floor;
    row[3] = state->wide_long / wide_floor;
    is_strong = (row[1] > SLIP_STAY_RATIO || row[3] > SLIP_STAY_RATIO)
        && state->wide_short > SLIP_DECAY_RATIO * state->wide_long;
    if (row[0] > SLIP_LOUD || row[2] > SLIP_LOUD || row[1] > SLIP_LOUD_20 || row[3] > SLIP_LOUD_20) {
        row[4] = greatest / wide_floor;
        row[5] = change * change / wide_floor;
        row[6] = half_change * (half_change > R(0.0) ? half_change : -half_change) / wide_floor;
        row[7] = state->net_short * state->net_short / (state->total_short * state->total_short + SLIP_TINY);
        row[8] = state->upper_short / (peak + SLIP_TINY);
        row[9] = state->wide_long / (greatest + SLIP_TINY);
        row[10] = state->upper_long / (greatest + SLIP_TINY);
        row[11] = state->upper_long / (state->wide_long + SLIP_TINY);
        row[12] = SLIP_MOVE_GAIN * state->total_short * state->total_short / wide_floor;
        row[13] = slope / (greatest + SLIP_TINY);
        row[14] = state->net_long * state->net_long / (state->total_long * state->total_long + SLIP_TINY);
        score = evaluate_trees(row);
    } else {
        score = SLIP_LOWEST_SCORE;
    }
    state->confidence = (score - SLIP_LOWEST_SCORE) / (SLIP_ON_SCORE - SLIP_LOWEST_SCORE);
    if (state->confidence < R(0.0)) {
        state->confidence = R(0.0);
    }

    /* Decision: OFF until the floors are learned; ON stays while the energy does. */
    if (state->settling > 0) {
        state->settling--;
        state->on = false;
    } else if (state->on) {
        state->smooth_score += SLIP_SCORE_SMOOTHING * (score - state->smooth_score);
        state->on = score > SLIP_STAY_SCORE || (is_strong && state->smooth_score > SLIP_STAY_SCORE);
    } else {
        state->on = score > SLIP_ON_SCORE;
        state->smooth_score = SLIP_ON_SCORE;
    }

    if (state->on) {
        /* A tone's energy is constant and that of slip is not: floors follow a tone. */
        state->on_ticks += R(1.0);
        share = R(1.0) / (state->on_ticks < SLIP_TONE_TICKS ? state->on_ticks : SLIP_TONE_TICKS);
        state->mean += share * (state->wide_long - state->mean);
        state->mean_square += share * (state->wide_long * state->wide_long - state->mean_square);
        if (state->on_ticks > SLIP_TONE_TICKS
            && state->mean_square - state->mean * state->mean < SLIP_UNLEARNED_RATIO * state->mean * state->mean) {
            state->floor += SLIP_UNLEARNING * (state->wide_long - state->floor);
            state->upper_floor += SLIP_UNLEARNING * (state->upper_long - state->upper_floor);
        }
        return;
    }
    state->on_ticks = R(0.0);
    state->mean = R(0.0);
    state->mean_square = R(0.0);
    if (greatest > SLIP_MOVING_RATIO * wide_floor && state->settling == 0) {
        state->floor_ticks = SLIP_HELD_TICKS;
    } else if (state->floor_ticks < R(0.0)) {
        /* Until the filters have settled, floors are what they show. */
        state->floor_ticks += R(1.0);
        state->floor = state->wide_long;
        state->upper_floor = state->upper_long;
    } else {
        state->floor_ticks += R(1.0);
        share = R(1.0) / (state->floor_ticks < SLIP_MAX_FLOOR_TICKS ? state->floor_ticks : SLIP_MAX_FLOOR_TICKS);
        state->floor = adapt_floor(state->floor, state->wide_long, share);
        state->upper_floor = adapt_floor(state->upper_floor, state->upper_long, share);
    }
    if (state->floor < SLIP_MIN_FLOOR) {
        state->floor = SLIP_MIN_FLOOR;
    }
    if (state->upper_floor < SLIP_MIN_UPPER_FLOOR) {
        state->upper_floor = SLIP_MIN_UPPER_FLOOR;
    }
}

void slip_init(slip_state *state) {
    *state = (slip_state){0};
    /* Energies and floors start at those of the stated noise. */
    state->wide_short = state->wide_long = state->floor = SLIP_STATED_WIDE;
    state->upper_short = state->upper_long = state->upper_floor = SLIP_STATED_UPPER;
    state->step = R(INFINITY);
    state->settling = SLIP_SETTLING_TICKS;
    state->floor_ticks = -SLIP_SETTLE_TICKS;
}

bool slip_step_change(slip_state *state, slip_real change) {
    slip_real move, edge, driven, upper, wide, slope;

    /* Smallest step of the converter: the smallest difference between two samples. */
    move = change < R(0.0) ? -change : change;
    if (R(0.0) < move && move < state->step) {
        state->step = move;
    }

    /* Filters of the difference: difference below the upper edge, upper band, wide band, slope of the slow voltage. */
    edge = SLIP_EDGE_B0 * change + state->edge_1;
    state->edge_1 = SLIP_EDGE_B1 * change - SLIP_EDGE_A1 * edge + state->edge_2;
    state->edge_2 = SLIP_EDGE_B2 * change - SLIP_EDGE_A2 * edge;
    driven = SLIP_UPPER_B * edge;
    upper = driven + state->upper_1;
    state->upper_1 = state->upper_2 - driven - SLIP_UPPER_A1 * upper;
    state->upper_2 = -SLIP_UPPER_A2 * upper;
    driven = SLIP_WIDE_B * edge;
    wide = driven + state->wide_1;
    state->wide_1 = state->wide_2 - driven - SLIP_WIDE_A1 * wide;
    state->wide_2 = -SLIP_WIDE_A2 * wide;
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

    /* Net and total movement, which are equal while the force goes one way. */
    state->net_short += SLIP_SHORT * (edge - state->net_short);
    state->net_long += SLIP_LONG * (edge - state->net_long);
    move = edge < R(0.0) ? -edge : edge;
    state->total_short += SLIP_SHORT * (move - state->total_short);
    state->total_long += SLIP_LONG * (move - state->total_long);

    /* Squared slope and upper energy, the greatest of each slot. */
    slope *= slope;
    if (slope > state->slopes[0]) {
        state->slopes[0] = slope;
    }
    if (state->upper_short > state->peaks[0]) {
        state->peaks[0] = state->upper_short;
    }

    state->phase++;
    if (state->phase >= SLIP_TICK_SAMPLES) {
        state->phase = 0;
        tick(state, slope);
    }
    return state->on;
}

bool slip_step_voltage(slip_state *state, slip_real voltage_v) {
    /* Until the first sample the input was constant: there is no difference, and nothing in the bands. */
    slip_real change = state->started ? voltage_v - state->last_input : voltage_v - voltage_v;
    state->started = true;
    state->last_input = voltage_v;
    return slip_step_change(state, change);
}

bool slip_step_code(slip_state *state, int32_t tactile_code) {
    slip_real change = state->started ? SLIP_ADC_STEP_V * (slip_real)(tactile_code - state->last_code) : R(0.0);
    state->started = true;
    state->last_code = tactile_code;
    return slip_step_change(state, change);
}

bool slip_step(slip_state *state, slip_real tactile_v) {
    /* The tactile voltage is what the detector judges. Whatever joins other signals to it belongs here. */
    return slip_step_voltage(state, tactile_v);
}

void slip_process(slip_state *state, const slip_real *tactile_v, size_t count, uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = slip_step(state, tactile_v[i]) ? 1u : 0u;
    }
}
