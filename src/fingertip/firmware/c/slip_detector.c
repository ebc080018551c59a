#include "slip_detector.h"

#include <math.h> /* INFINITY, and fabsf, which is one instruction */

/* A product and a sum must not be contracted into one rounding: numbers are then those of fingertip's Python. GCC knows
 * no such pragma and takes -ffp-contract=off instead, which is its default with -std=c99. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

#include "slip_trees.h"

static float greater(float one, float other) {
    return one > other ? one : other;
}

static float lesser(float one, float other) {
    return one < other ? one : other;
}

/* Count down from `whole`, where it begins, to 0. */
static uint16_t count_down(uint16_t left, bool begins, uint16_t whole) {
    if (begins) {
        return whole;
    }
    return left > 0 ? (uint16_t)(left - 1) : 0;
}

/* Count up to `most`, and from 0 where it ends. */
static uint16_t count_up(uint16_t count, bool ends, uint16_t most) {
    if (ends) {
        return 0;
    }
    return count < most ? (uint16_t)(count + 1) : most;
}

/* -- Inputs: checks and filters ------------------------------------------------------------------------------------- */

/* Check a sample, and return by how much the one that is used differs from the one used before [V]. The last one takes
 * the place of what is no voltage, and of a jump far beyond the movement until then, unless the next sample confirms it. */
static float check_sample(slip_check *check, float sample, bool is_voltage, float unit_v, float jump_limit_v) {
    const bool is_first = check->missing > SLIP_GAP_SAMPLES;
    const bool was_suspected = check->is_suspected;
    const float limit_v = greater(jump_limit_v, SLIP_JUMP_MOVES * check->mean_move);
    const float value = is_voltage ? sample : check->last;
    const float move = is_first ? 0.0f : unit_v * (value - check->last);
    const bool is_jump = fabsf(move) > limit_v;
    /* Where the first sample was a glitch, the next one begins anew. */
    const bool begins = is_first || (is_jump && check->has_just_begun);
    float change = move;

    check->has_just_begun = is_first;
    check->missing = count_up(check->missing, is_voltage, SLIP_GAP_SAMPLES + 1);
    check->mean_move = SLIP_MOVE_SHARE * fabsf(move) + SLIP_MOVE_KEEP * check->mean_move;
    check->is_suspected = is_jump && !begins && !was_suspected;
    check->is_wrong = !is_voltage;

    if (begins) {
        change = 0.0f;
    } else if (check->is_suspected) {
        check->last_used = check->last;
        change = 0.0f;
    } else if (was_suspected) {
        change = unit_v * (value - check->last_used);
        if (fabsf(change) <= SLIP_GLITCH_SHARE * fabsf(unit_v * (check->last - check->last_used))) {
            check->is_wrong = true;
        }
    }

    check->last = value;
    return change;
}

/* Note a change [V]: how long the signal has stood still, and the smallest step of its converter. */
static void note_change(slip_check *check, float change) {
    const float size = fabsf(change);
    check->still = count_up(check->still, change != 0.0f, SLIP_STILL_SAMPLES);
    if (change != 0.0f && size < check->smallest_step) {
        check->smallest_step = size;
    }
}

/* Third-order high-pass filter at the board's cutoff: its section of second order, behind the first stage. */
static float filter_high(slip_section *memory, float input) {
    const float term = SLIP_HIGH_B * input;
    const float output = memory->first + term;
    memory->first = (memory->second - 2.0f * term) - SLIP_HIGH_A1 * output;
    memory->second = term - SLIP_HIGH_A2 * output;
    return output;
}

/* Low-pass filter of the slow force. */
static float filter_slow(slip_section *memory, float input) {
    const float term = SLIP_SLOW_B * input;
    const float output = memory->first + term;
    memory->first = (memory->second + 2.0f * term) - SLIP_SLOW_A1 * output;
    memory->second = term - SLIP_SLOW_A2 * output;
    return output;
}

/* Band-pass filter: a resonator. */
static float filter_band(slip_section *memory, float input, const float filter[3]) {
    const float term = filter[0] * input;
    const float output = memory->first + term;
    memory->first = memory->second - filter[1] * output;
    memory->second = -term - filter[2] * output;
    return output;
}

/* Judge whether S moves about its rest: its wire is whole. Only codes tell where it rests. */
static bool is_alive(slip_state *state) {
    const slip_check *check = &state->filtered;
    if (state->is_in_codes) {
        state->filtered_level =
            SLIP_LEVEL_SHARE * (check->last - SLIP_REST_CODE) + SLIP_LEVEL_KEEP * state->filtered_level;
        state->is_at_rest = fabsf(state->filtered_level) <= SLIP_REST_CODES;
    }
    return check->still < SLIP_STILL_SAMPLES && check->missing <= SLIP_GAP_SAMPLES && state->is_at_rest;
}

/* Process a sample of S, and return its vibration at the filter's input where it can be believed, else that of T [V]: the
 * board's stages below their limits, its wire whole. */
static float use_filtered(slip_state *state, float sample, bool is_voltage, float tactile_vibration) {
    slip_check *const check = &state->filtered;
    const float change = SLIP_FILTERED_SHARE
        * check_sample(check, sample, is_voltage, state->unit_v, SLIP_FILTERED_JUMP_LIMIT_V);
    const float sum = change + SLIP_LEAK_KEEP * state->filtered_sum;
    const bool is_beyond = fabsf(sum) > SLIP_FILTERED_LIMIT_V || fabsf(state->stage) > SLIP_FILTERED_LIMIT_V;
    const bool was_limited = state->limited > 0;

    state->limited = count_down(state->limited, is_beyond, SLIP_LIMITED_SAMPLES);
    /* What a limit cuts off leaves an offset: the sum begins anew behind it. */
    state->filtered_sum = was_limited && state->limited == 0 ? 0.0f : sum;
    note_change(check, change);
    state->is_alive = is_alive(state);
    return state->is_alive && state->limited == 0 ? state->filtered_sum : tactile_vibration;
}

/* -- Ticks: sums of 2 ms, and means over the last ones --------------------------------------------------------------- */

/* Add a sample to the sums of its tick. */
static void sum_sample(slip_state *state, float vibration, float slow) {
    static const float filters[SLIP_BANDS][3] = SLIP_BAND_FILTERS;
    slip_sums *const sums = &state->sums;
    const unsigned at = state->past_at;
    const float one_before = state->past[at < SLIP_LAG_SAMPLES ? at + SLIP_LAG_SAMPLES : at - SLIP_LAG_SAMPLES];
    const float two_before = state->past[at];
    unsigned i;

    state->past[at] = vibration;
    state->past_at = at + 1 < 2 * SLIP_LAG_SAMPLES ? (uint8_t)(at + 1) : 0;
    sums->level += fabsf(vibration);
    sums->energies.slow += slow * slow;
    sums->energies.wide += vibration * vibration;
    sums->products.one_before += vibration * one_before;
    sums->products.two_before += vibration * two_before;
    sums->products.square_before += one_before * one_before;

    for (i = 0; i < SLIP_BANDS; i++) {
        const float in_band = filter_band(&state->bands[i], vibration, filters[i]);
        sums->energies.bands[i] += in_band * in_band;
    }
}

/* Take the mean of a sum, which begins anew. */
static float take_mean(float *sum) {
    const float mean = *sum * SLIP_TICK_SHARE;
    *sum = 0.0f;
    return mean;
}

/* Take the means of a tick, and begin the sums of the next one. */
static void take_means(slip_sums *sums, slip_sums *means) {
    unsigned i;
    means->level = take_mean(&sums->level);
    means->energies.slow = take_mean(&sums->energies.slow);
    means->energies.wide = take_mean(&sums->energies.wide);
    means->products.one_before = take_mean(&sums->products.one_before);
    means->products.two_before = take_mean(&sums->products.two_before);
    means->products.square_before = take_mean(&sums->products.square_before);
    for (i = 0; i < SLIP_BANDS; i++) {
        means->energies.bands[i] = take_mean(&sums->energies.bands[i]);
    }
}

/* Store the energies, products and force of a tick as the newest ones. */
static void store_tick(slip_ticks *ticks, const slip_sums *means, float force) {
    unsigned at, i;
    ticks->newest = (uint8_t)((ticks->newest + 1u) % SLIP_RING);
    at = ticks->newest;
    ticks->slow[at] = means->energies.slow;
    ticks->wide[at] = means->energies.wide;
    ticks->force[at] = force;
    ticks->products[at % SLIP_PRODUCT_RING] = means->products;
    for (i = 0; i < SLIP_BANDS; i++) {
        ticks->bands[i][at % SLIP_BAND_RING] = means->energies.bands[i];
    }
}

/* Mean vibration of the last 16 and 24 ticks. Sums of 2, 4 and 8 ticks are each made of two of the one before: what stands
 * at the newest place of a ring is as old as the ring is long. */
static void mean_levels(slip_ticks *ticks, float level, float *short_mean, float *long_mean) {
    const unsigned at = ticks->newest;
    const float two = level + ticks->level;
    const float four = two + ticks->twos[at % 2];
    const float eight = four + ticks->fours[at % 4];
    const float sixteen = eight + ticks->eights[(at + 8) % 16];

    *short_mean = sixteen * (1.0f / 16.0f);
    *long_mean = (sixteen + ticks->eights[at % 16]) * (1.0f / 24.0f);
    ticks->level = level;
    ticks->twos[at % 2] = two;
    ticks->fours[at % 4] = four;
    ticks->eights[at % 16] = eight;
}

/* -- Features: ratios that tell slip from a blow --------------------------------------------------------------------- */

/* A feature, and its key: an integer in the order of these numbers, which a controller compares faster. A number that is
 * not negative is its own key. */
typedef union feature {
    float number;
    int32_t key;
} feature;

/* Places of the features. Of those that Python takes the logarithm of, the ratios stand here, and the table compares them
 * with the ratios of its thresholds. */
enum {
    SLICES = 0,      /* 4 slices of 4 ms, over the floor */
    SHARES = 4,      /* slow force and bands: share of the vibration, */
    CHANGES = 9,     /* new over old half of 16 ms, */
    OVER_FLOORS = 14, /* and over the floor */
    PEAK = 19,
    MOVES = 20, /* change of force in 4, 16 and 62 ms */
    STEEPEST = 23,
    UNTONED = 24,
    AGE,
    LEAST,
    LEVEL,
    SLOW_PEAK,
    LATE_OVER_EARLY,
    UNTONED_LONG,
    PRODUCT,
    LEAST_MIDDLE,
    LOUD,
    LONG_OVER_SHORT,
    BEFORE
};

/* Bands of 60 to 250 Hz, in which slip is strongest. */
enum { MIDDLE = 1, UPPER_MIDDLE = 2 };

/* Mean of a slice, two ticks of a ring, the newer of which is `newest`. The length is a power of 2. */
static inline float slice(const float *ring, unsigned length, unsigned newest) {
    return 0.5f * (ring[newest & (length - 1)] + ring[(newest - 1) & (length - 1)]);
}

/* Mean of a quarter, two slices. */
static inline float quarter(const float *ring, unsigned length, unsigned newest) {
    return 0.5f * (slice(ring, length, newest) + slice(ring, length, newest - 2));
}

/* Compare the halves of the last 16 ms of a band with each other, with all vibration and with the floor; return their
 * mean. */
static float compare_halves(feature *row, unsigned band, const float *ring, unsigned length, unsigned newest,
                            float total, float floor) {
    const float new_half = quarter(ring, length, newest) + SLIP_TINY;
    const float old_half = quarter(ring, length, newest - 4) + SLIP_TINY;
    const float both = 0.5f * (new_half + old_half);
    row[SHARES + band].number = both / total;
    row[CHANGES + band].number = new_half / old_half;
    row[OVER_FLOORS + band].number = both / (floor + SLIP_TINY);
    return both;
}

/* Features of the slices of all vibration; return the mean of the last 16 ms. */
static float measure_slices(feature *row, const slip_ticks *ticks, float floor) {
    enum { COUNT = SLIP_RING / 2 };
    float wide[COUNT], peak = 0.0f, least, total, before;
    unsigned i;
    for (i = 0; i < COUNT; i++) {
        wide[i] = slice(ticks->wide, SLIP_RING, ticks->newest - 2 * i);
    }
    for (i = 0; i < SLIP_PEAK_SLICES; i++) {
        peak = greater(peak, wide[i]);
    }

    least = lesser(lesser(wide[0], wide[1]), lesser(wide[2], wide[3]));
    total = 0.5f * ((0.5f * (wide[0] + wide[1]) + SLIP_TINY) + (0.5f * (wide[2] + wide[3]) + SLIP_TINY));
    before = 0.5f * (0.5f * (wide[4] + wide[5]) + 0.5f * (wide[6] + wide[7]));
    for (i = 0; i < 4; i++) {
        row[SLICES + i].number = (wide[i] + SLIP_TINY) / (floor + SLIP_TINY);
    }

    row[PEAK].number = (peak + SLIP_TINY) / total;
    row[LEAST].number = (least + SLIP_TINY) / total;
    row[LATE_OVER_EARLY].number =
        ((wide[0] + wide[1]) + wide[2] + SLIP_TINY) / ((wide[4] + wide[5]) + wide[6] + SLIP_TINY);
    row[LONG_OVER_SHORT].number = (0.5f * (total + before) + SLIP_TINY) / total;
    row[BEFORE].number = (before + SLIP_TINY) / (floor + SLIP_TINY);
    return total;
}

/* Number of loud ticks. */
static void count_loud(feature *row, const slip_ticks *ticks, float floor) {
    const float loud = SLIP_LOUD_RATIO * floor;
    const float *wide;
    int32_t count = 0;
    for (wide = ticks->wide; wide < ticks->wide + SLIP_RING; wide++) {
        if (*wide > loud) {
            count++;
        }
    }
    row[LOUD].number = (float)count;
}

/* Features of the slow force: its energy, and how far it moves for the vibration. */
static void measure_force(feature *row, const slip_ticks *ticks, float total, float floor) {
    static const unsigned back[3] = {2, 8, SLIP_RING - 1};
    const unsigned newest = ticks->newest;
    const float both = compare_halves(row, 0, ticks->slow, SLIP_RING, newest, total, floor);
    float steepest = 0.0f, peak = 0.0f;
    unsigned i, at;
    for (i = 0; i < SLIP_PEAK_SLICES; i++) {
        at = newest - 2 * i;
        peak = greater(peak, slice(ticks->slow, SLIP_RING, at));
        steepest = greater(steepest, fabsf(ticks->force[at % SLIP_RING] - ticks->force[(at - 2) % SLIP_RING]));
    }

    row[SLOW_PEAK].number = (peak + SLIP_TINY) / both;
    row[STEEPEST].number = (steepest * steepest + SLIP_TINY) / total;
    for (i = 0; i < 3; i++) {
        const float move = ticks->force[newest] - ticks->force[(newest - back[i]) % SLIP_RING];
        row[MOVES + i].number = (move * move + SLIP_TINY) / total;
    }
}

/* Features of the bands. */
static void measure_bands(feature *row, const slip_ticks *ticks, float total, const float *floors) {
    float middle[4];
    unsigned i;
    for (i = 0; i < SLIP_BANDS; i++) {
        compare_halves(row, 1 + i, ticks->bands[i], SLIP_BAND_RING, ticks->newest, total, floors[i]);
    }
    for (i = 0; i < 4; i++) {
        middle[i] = slice(ticks->bands[MIDDLE], SLIP_BAND_RING, ticks->newest - 2 * i)
            + slice(ticks->bands[UPPER_MIDDLE], SLIP_BAND_RING, ticks->newest - 2 * i);
    }
    row[LEAST_MIDDLE].number =
        (lesser(lesser(middle[0], middle[1]), lesser(middle[2], middle[3])) + SLIP_TINY)
        / (((middle[0] + middle[1]) + middle[2]) + middle[3] + SLIP_TINY);
}

/* What a tone is judged by: the energy of all vibration, and its products with itself. */
typedef struct tone {
    float square, one_before, two_before, square_before;
} tone;

static tone add_tones(tone one, tone other) {
    const tone sum = {one.square + other.square, one.one_before + other.one_before, one.two_before + other.two_before,
                      one.square_before + other.square_before};
    return sum;
}

/* Sum over 4 ticks. */
static tone sum_tones(const slip_ticks *ticks, unsigned newest) {
    tone ones[4];
    unsigned i;
    for (i = 0; i < 4; i++) {
        const slip_products *const products = &ticks->products[(newest - i) % SLIP_PRODUCT_RING];
        ones[i].square = ticks->wide[(newest - i) % SLIP_RING];
        ones[i].one_before = products->one_before;
        ones[i].two_before = products->two_before;
        ones[i].square_before = products->square_before;
    }
    return add_tones(add_tones(ones[0], ones[1]), add_tones(ones[2], ones[3]));
}

/* Share that is no tone. In a tone, a sample and the one of two lags before add up to a multiple of the one between. */
static float find_rest(tone sum) {
    const float square = sum.square + SLIP_TINY;
    const float cross = 2.0f * sum.one_before;
    const float left = 2.0f * (square + sum.two_before) - cross * cross / (sum.square_before + SLIP_TINY);
    return greater(left / (2.0f * square), SLIP_LEAST_REST);
}

/* Features of a tone in the last 16 and 32 ms. */
static void measure_tone(feature *row, const slip_ticks *ticks) {
    const unsigned newest = ticks->newest;
    const tone eight = add_tones(sum_tones(ticks, newest), sum_tones(ticks, newest - 4));
    const tone earlier = add_tones(sum_tones(ticks, newest - 8), sum_tones(ticks, newest - 12));
    feature product;
    product.number = eight.one_before / (eight.square + SLIP_TINY);
    row[UNTONED].number = find_rest(eight);
    row[UNTONED_LONG].number = find_rest(add_tones(eight, earlier));
    /* The only one that may be negative: the bits of negative floats stand in the reverse order. */
    row[PRODUCT].key = product.key < 0 ? product.key ^ INT32_MAX : product.key;
}

/* Sum the leaves of all trees. Nodes count from 1: node k has the branches 2 k and 2 k + 1, and entry 0 is not used. */
static float evaluate_trees(const feature *row) {
    const uint8_t *feature_of = slip_features;
    const int32_t *threshold = slip_thresholds;
    const float *leaf = slip_leaves;
    float odds = SLIP_OFFSET;
    unsigned tree, node, level;
    for (tree = 0; tree < SLIP_TREES; tree++) {
        node = 1;
#if defined(__GNUC__)
#pragma GCC unroll 4
#endif
        for (level = 0; level < SLIP_DEPTH; level++) {
            node = 2 * node + (row[feature_of[node]].key > threshold[node] ? 1 : 0);
        }
        odds += leaf[node - LEAVES];
        feature_of += LEAVES;
        threshold += LEAVES;
        leaf += LEAVES;
    }
    return odds;
}

/* Whether the vibration comes from S. */
static bool is_from_filtered(const slip_state *state) {
    return state->is_alive && state->limited == 0;
}

/* Log odds that the vibration of the last 64 ms is slip. */
static float look(const slip_state *state, float short_mean) {
    static const slip_energies steps = SLIP_STEP_ENERGIES, least = SLIP_LEAST_ENERGIES;
    static const slip_energies none = {0};
    const slip_energies *const learned = &state->learned.energies;
    const float slow_step = state->tactile.smallest_step;
    const float step = state->is_alive ? state->filtered.smallest_step : slow_step;
    const float step_square = step * step;
    const slip_energies *const noise = is_from_filtered(state) ? &none : &least;
    const float wide_floor = greater(learned->wide, greater(step_square * steps.wide, noise->wide));
    const float slow_floor = greater(learned->slow, greater(slow_step * slow_step * steps.slow, least.slow));
    feature row[SLIP_FEATURES];
    float floors[SLIP_BANDS], total;
    unsigned i;
    for (i = 0; i < SLIP_BANDS; i++) {
        floors[i] = greater(learned->bands[i], greater(step_square * steps.bands[i], noise->bands[i]));
    }

    total = measure_slices(row, &state->ticks, wide_floor);
    count_loud(row, &state->ticks, wide_floor);
    measure_force(row, &state->ticks, total, slow_floor);
    measure_bands(row, &state->ticks, total, floors);
    measure_tone(row, &state->ticks);
    row[AGE].number = (float)state->crossing;
    row[LEVEL].number = short_mean / state->floor + SLIP_TINY;
    return evaluate_trees(row);
}

/* -- Decision: floor and flags --------------------------------------------------------------------------------------- */

/* Least floor: of the converter's steps, and of the noise. */
static float find_least(const slip_state *state) {
    const float step = state->is_alive ? state->filtered.smallest_step : state->tactile.smallest_step;
    return greater(is_from_filtered(state) ? SLIP_LEAST_FILTERED_V : SLIP_LEAST_V, step * SLIP_STEP_LEVEL);
}

/* Forget the crossing, which has ended. */
static void forget_crossing(slip_state *state) {
    state->crossing = state->vetoed = 0;
    state->odds = 0.0f;
}

/* Follow the crossing and, in ON, the hold; return whether the table is to be asked. */
static bool follow(slip_state *state, float short_mean, float long_mean) {
    const float hold = SLIP_HOLD_RATIO * state->floor;
    if (state->blocked > 0 || state->age_ticks <= state->learning_ticks) {
        state->on = state->incipient = false;
        forget_crossing(state);
        return false;
    }

    state->incipient = short_mean > SLIP_SHORT_RATIO * state->floor || long_mean > SLIP_LONG_RATIO * state->floor;
    if (state->incipient) {
        state->crossing = (uint16_t)(state->crossing > 0 ? state->crossing + 1 + state->missed : 1);
        state->crossing = state->crossing < SLIP_LONGEST_AGE ? state->crossing : SLIP_LONGEST_AGE;
        state->missed = 0;
    } else {
        state->missed = count_up(state->missed, false, SLIP_UNHEARD_TICKS + 1);
    }
    if (state->missed > SLIP_GAP_TICKS) {
        forget_crossing(state);
    }
    if (!state->on) {
        return state->incipient && state->crossing >= SLIP_MIN_AGE_TICKS;
    }

    state->is_second = !state->is_second;
    state->on = state->missed <= SLIP_UNHEARD_TICKS && (short_mean > hold || long_mean > hold);
    if (!state->on) {
        state->odds = 0.0f;
    }
    return state->on && state->is_second;
}

/* Take the log odds of a look: towards ON, or for staying ON. */
static void judge(slip_state *state, float odds) {
    if (!state->on) {
        state->odds = greater(state->odds + lesser(odds, SLIP_MOST_ODDS), SLIP_LEAST_SUM);
        state->on = state->odds > SLIP_NEED;
        state->vetoed = count_up(state->vetoed, false, SLIP_VETOED_TICKS);
        state->refused = 0;
        state->is_second = false;
        return;
    }

    state->refused = count_up(state->refused, !(odds < SLIP_STAY_ODDS), SLIP_STAY_LOOKS + 1);
    if (state->refused > SLIP_STAY_LOOKS) {
        state->on = false;
        state->odds = 0.0f;
    }
}

/* Count the time since ON. */
static void wait_after(slip_state *state) {
    state->after = count_down(state->after, state->on, SLIP_AFTER_TICKS);
    if (state->on) {
        state->vetoed = 0;
    }
}

/* End ON, and learn the vibration as rest, where it has hardly varied for two seconds: a tone. */
static void end_tone(slip_state *state, const slip_energies *energies, float short_mean) {
    state->steady++;
    state->lowest = lesser(state->lowest, short_mean);
    state->highest = greater(state->highest, short_mean);
    if (!state->on || state->highest > SLIP_TONE_RATIO * state->lowest) {
        state->steady = 0;
        state->lowest = state->highest = short_mean;
    }
    if (state->steady >= SLIP_TONE_TICKS) {
        state->on = state->incipient = false;
        state->after = state->steady = 0;
        forget_crossing(state);
        state->learned.level = short_mean * SLIP_QUANTILE_RATIO;
        state->learned.energies = *energies;
    }
}

/* Move an energy at rest towards the one of this tick by a share. */
static void approach(float *learned, float energy, float share) {
    *learned += share * (energy - *learned);
}

/* Learn the floors from the first ticks: means of all. */
static void learn_first(slip_state *state, const slip_sums *means) {
    slip_floors *const learned = &state->learned;
    float share;
    unsigned i;
    if (state->age_ticks <= SLIP_SETTLING_TICKS) {
        return;
    }
    state->heard++;
    share = 1.0f / (float)state->heard;
    approach(&learned->level, means->level * SLIP_QUANTILE_RATIO, share);
    approach(&learned->energies.slow, means->energies.slow, share);
    approach(&learned->energies.wide, means->energies.wide, share);
    for (i = 0; i < SLIP_BANDS; i++) {
        approach(&learned->energies.bands[i], means->energies.bands[i], share);
    }
}

/* The same for an energy that counts as no more than some times the one at rest. */
static void approach_clipped(float *learned, float energy, float share) {
    approach(learned, lesser(energy, SLIP_CLIP_RATIO * *learned), share);
}

/* Halve the slow force's energy at rest where the force has been far calmer for a while: it was learned from a contact. */
static void forget_contact(slip_state *state, float slow_energy) {
    float *const learned = &state->learned.energies.slow;
    state->calm = count_up(state->calm, SLIP_CALM_RATIO * slow_energy >= *learned, SLIP_CALM_TICKS + 1);
    if (state->calm > SLIP_CALM_TICKS) {
        *learned *= 0.5f;
    }
}

/* Let the floor and the energies at rest follow what is no slip. */
static void learn(slip_state *state, const slip_energies *energies, float short_mean) {
    slip_floors *const learned = &state->learned;
    const bool may_be_slip = state->incipient || state->on || state->after > 0;
    const bool is_far_below = short_mean < 0.5f * learned->level;
    const float share = is_far_below ? SLIP_BAND_DROP_SHARE : SLIP_BAND_SHARE;
    unsigned i;
    if (may_be_slip && state->vetoed < SLIP_VETOED_TICKS) {
        return;
    }

    approach_clipped(&learned->energies.slow, energies->slow, share);
    approach_clipped(&learned->energies.wide, energies->wide, share);
    for (i = 0; i < SLIP_BANDS; i++) {
        approach_clipped(&learned->energies.bands[i], energies->bands[i], share);
    }
    forget_contact(state, energies->slow);
    if (short_mean > learned->level) {
        learned->level *= SLIP_RISE;
    } else {
        learned->level *= is_far_below ? SLIP_DROP : SLIP_FALL;
    }
}

/* Decide at a tick. `force` is the slow force [V]. */
static void tick(slip_state *state, float force) {
    const slip_check *const vibrating = state->is_alive ? &state->filtered : &state->tactile;
    slip_sums means;
    float short_mean, long_mean;
    take_means(&state->sums, &means);
    store_tick(&state->ticks, &means, force);
    mean_levels(&state->ticks, means.level, &short_mean, &long_mean);
    state->mean = greater(short_mean, long_mean * (SLIP_SHORT_RATIO / SLIP_LONG_RATIO));
    state->floor = greater(state->learned.level, find_least(state));
    state->age_ticks = count_up(state->age_ticks, false, SLIP_LEARNING_TICKS + 1);

    if (follow(state, short_mean, long_mean)) {
        judge(state, look(state, short_mean));
    }
    wait_after(state);
    end_tone(state, &means.energies, short_mean);

    /* A signal that stands still teaches nothing. */
    if (vibrating->still <= SLIP_GAP_SAMPLES && state->blocked == 0) {
        if (state->age_ticks <= state->learning_ticks) {
            learn_first(state, &means);
        } else {
            learn(state, &means.energies, short_mean);
        }
    }
}

/* -- Samples ---------------------------------------------------------------------------------------------------------- */

/* Process a sample of T, and of S where there is one. */
static bool step(slip_state *state, float tactile, bool is_voltage, float filtered, bool is_filtered_voltage) {
    const bool was_alive = state->is_alive;
    const float change = check_sample(&state->tactile, tactile, is_voltage, state->unit_v, SLIP_JUMP_LIMIT_V);
    float slow;
    bool is_wrong = state->tactile.is_wrong;

    state->stage = SLIP_STAGE_SHARE * change + SLIP_STAGE_KEEP * state->stage;
    state->vibration = filter_high(&state->high, state->stage);
    state->slow_sum = change + SLIP_LEAK_KEEP * state->slow_sum;
    slow = filter_slow(&state->slow, state->slow_sum);
    note_change(&state->tactile, change);
    if (state->has_filtered) {
        state->vibration = use_filtered(state, filtered, is_filtered_voltage, state->vibration);
        is_wrong = is_wrong || state->filtered.is_wrong;
    }

    state->replaced = count_down(state->replaced, is_wrong, SLIP_FAULT_SAMPLES);
    state->blocked = count_down(state->blocked,
                                state->tactile.missing > SLIP_GAP_SAMPLES || (was_alive && !state->is_alive),
                                SLIP_BLOCKED_SAMPLES);
    sum_sample(state, state->vibration, slow);
    state->phase++;
    if (state->phase >= SLIP_TICK_SAMPLES) {
        state->phase = 0;
        tick(state, slow);
    }
    return state->on;
}

/* Count how long T has been a voltage that no force gives. */
static void note_outside(slip_state *state, bool is_inside) {
    state->outside = count_up(state->outside, is_inside, SLIP_FAULT_SAMPLES + 1);
}

/* Begin with the first sample: whether it has a filtered signal decides what noise is stated, and least learned. */
static void start(slip_state *state, bool has_filtered, bool is_in_codes) {
    static const slip_floors stated = SLIP_STATED_FLOORS, filtered_stated = SLIP_FILTERED_STATED_FLOORS;
    state->is_started = true;
    state->has_filtered = has_filtered && SLIP_HAS_FILTERED;
    state->is_in_codes = is_in_codes;
    state->unit_v = is_in_codes ? SLIP_ADC_STEP_V : 1.0f;
    if (!state->is_recalled) {
        state->learned = state->has_filtered ? filtered_stated : stated;
    }
}

static void init_check(slip_check *check) {
    check->smallest_step = SLIP_NO_STEP;
    check->missing = SLIP_GAP_SAMPLES + 1;
    check->still = SLIP_STILL_SAMPLES;
}

void slip_init(slip_state *state) {
    *state = (slip_state){0};
    init_check(&state->tactile);
    init_check(&state->filtered);
    state->learning_ticks = SLIP_LEARNING_TICKS;
    state->is_at_rest = true;
}

void slip_init_finger(slip_state *state, unsigned finger) {
    slip_init(state);
    state->phase = (uint16_t)(finger % SLIP_TICK_SAMPLES);
}

void slip_recall(slip_state *state, slip_floors floors) {
    bool is_learned = floors.level > 0.0f && floors.energies.slow > 0.0f && floors.energies.wide > 0.0f;
    unsigned i;
    for (i = 0; i < SLIP_BANDS; i++) {
        is_learned = is_learned && floors.energies.bands[i] > 0.0f;
    }
    if (is_learned) {
        state->is_recalled = true;
        state->learned = floors;
        state->learning_ticks = SLIP_SETTLING_TICKS;
    }
}

/* So written that NaN is no voltage. */
static bool is_voltage(float sample_v) {
    return fabsf(sample_v) <= SLIP_NUMBER_LIMIT_V;
}

static bool step_volts(slip_state *state, float tactile_v, float filtered_v, bool has_filtered) {
    const bool is_used = is_voltage(tactile_v);
    const float used_v = is_used ? tactile_v : state->tactile.last;
    if (!state->is_started) {
        start(state, has_filtered, false);
    }
    note_outside(state, used_v >= SLIP_LOWEST_V && used_v <= SLIP_HIGHEST_V);
    return step(state, tactile_v, is_used, filtered_v, is_voltage(filtered_v));
}

bool slip_step(slip_state *state, float tactile_v, float filtered_v) {
    return step_volts(state, tactile_v, filtered_v, true);
}

bool slip_step_tactile(slip_state *state, float tactile_v) {
    return step_volts(state, tactile_v, 0.0f, false);
}

/* Every code is a voltage. */
static bool step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code, bool has_filtered) {
    if (!state->is_started) {
        start(state, has_filtered, true);
    }
    note_outside(state, tactile_code >= SLIP_LOWEST_CODE && tactile_code <= SLIP_HIGHEST_CODE);
    return step(state, (float)tactile_code, true, (float)filtered_code, true);
}

bool slip_step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code) {
    return step_codes(state, tactile_code, filtered_code, true);
}

bool slip_step_tactile_code(slip_state *state, int32_t tactile_code) {
    return step_codes(state, tactile_code, 0, false);
}

bool slip_step_lost(slip_state *state) {
    if (state->is_started) {
        note_outside(state, state->outside == 0);
        step(state, 0.0f, false, 0.0f, false);
    }
    return state->on;
}

void slip_process(slip_state *state, const float *tactile_v, const float *filtered_v, size_t count, uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = step_volts(state, tactile_v[i], filtered_v ? filtered_v[i] : 0.0f, filtered_v != NULL) ? 1u : 0u;
    }
}
