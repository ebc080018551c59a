/* Slip detector `fast` of fingertip, in C99, for a microcontroller.
 *
 * One sample in, one decision out. All of the detector's state is in one struct, nothing is allocated, and a step calls
 * no function but what the compiler itself needs for floating point. The operations and their order are those of
 * fingertip's Python in single precision: without contraction (-ffp-contract=off), every decision and every number has
 * the same bits.
 *
 *     slip_state slip;
 *     slip_init(&slip);
 *     for (;;) { bool on = slip_step_codes(&slip, read_code(T), read_code(S)); ... }
 */
#ifndef SLIP_DETECTOR_H
#define SLIP_DETECTOR_H

#include <math.h> /* INFINITY */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "slip_constants.h"

/* Codes of the converter for T and S of a finger, S right after T. */
typedef struct slip_codes {
    uint16_t tactile, filtered;
} slip_codes;

/* Stands for S where a sample could not be taken. No converter of less than 16 bits gives it. */
#define SLIP_LOST_CODE 0xFFFFu

/* Check of one input: the last samples, volts or codes, and how they moved. */
typedef struct slip_check {
    float last, last_used;  /* last sample that was a voltage, and the one that was used in its place */
    float mean_move;        /* mean movement between samples, over 6 ms [V] */
    float smallest_step;    /* smallest change that was used: the step of the converter [V] */
    uint16_t missing;       /* samples since the last voltage, up to SLIP_GAP_SAMPLES + 1 */
    uint16_t still;         /* samples since the last change, up to SLIP_STILL_SAMPLES */
    bool is_suspected;      /* the last sample jumped, and was not used yet */
    bool has_just_begun;    /* the last sample was the first one, or the first after a gap */
    bool is_wrong;          /* the last sample was no voltage, or proved the one before it a glitch */
} slip_check;

/* Memory of a filter of second order, in transposed direct form II. */
typedef struct slip_section {
    float first, second;
} slip_section;

/* Energies of a tick: means of the squares of the slow force, of its bands and of all vibration [V^2]. */
typedef struct slip_energies {
    float slow, bands[SLIP_BANDS], wide;
} slip_energies;

/* Mean products of the vibration of a tick with itself before: one lag, two lags, and one lag before itself [V^2]. */
typedef struct slip_products {
    float one_before, two_before, square_before;
} slip_products;

/* Sums of a tick: at its end, means. */
typedef struct slip_sums {
    float level; /* size of the vibration [V] */
    slip_energies energies;
    slip_products products;
} slip_sums;

/* Ticks back to which the features look: all, and those of the bands and of the products. */
enum { SLIP_BAND_RING = SLIP_RING / 4, SLIP_PRODUCT_RING = SLIP_RING / 2 };

/* The last ticks. A ring holds its newest entry at `newest` modulo its length. */
typedef struct slip_ticks {
    float slow[SLIP_RING], wide[SLIP_RING];    /* energies [V^2] */
    float force[SLIP_RING];                    /* slow force [V] */
    float bands[SLIP_BANDS][SLIP_BAND_RING];   /* energies [V^2] */
    slip_products products[SLIP_PRODUCT_RING]; /* [V^2] */
    float level, twos[2], fours[4], eights[16]; /* size of the vibration: last tick, sums of 2, 4 and 8 of them [V] */
    uint8_t newest;
} slip_ticks;

/* What a detector has learned while nothing slipped: store it, as in flash. */
typedef struct slip_floors {
    float level;            /* below which four of five mean vibrations lie [V] */
    slip_energies energies; /* [V^2] */
} slip_floors;

/* State of a detector. It is read after a step: `on`, `odds`, `mean`, `floor`. */
typedef struct slip_state {
    slip_check tactile, filtered;
    float stage, slow_sum, filtered_sum;   /* memories of the filters of first order [V] */
    slip_section high, slow, bands[SLIP_BANDS];
    float filtered_level;                  /* mean of S about its rest, over 0.2 s [codes] */
    float past[2 * SLIP_LAG_SAMPLES];      /* last samples of the vibration [V] */
    float vibration;                       /* present one, behind the high-pass filter [V] */
    float unit_v;                          /* what the samples count in: 1 for volts, or the converter's step [V] */
    slip_sums sums;
    slip_ticks ticks;
    slip_floors learned;
    float mean, floor;                     /* mean vibration and its present floor [V]: ON is sought above SLIP_SHORT_RATIO */
    float odds;                            /* evidence of slip: log odds, and ON above SLIP_NEED */
    float lowest, highest;                 /* mean vibration since it was no tone [V] */
    uint16_t limited, blocked, replaced;   /* samples for which S is not used, all is OFF, a wrong sample is reported */
    uint16_t outside;                      /* samples with a voltage that no force gives, up to SLIP_FAULT_SAMPLES + 1 */
    uint16_t age_ticks, learning_ticks;    /* ticks since the start, and of the first learning */
    uint16_t crossing, missed;             /* ticks since the crossing, and since the mean lay below it */
    uint16_t vetoed, refused;              /* looks that found no slip: before ON, and on end in ON */
    uint16_t after, steady;                /* ticks for which floors stand after ON, and of a tone */
    uint16_t heard, calm;                  /* ticks of the first learning, and of a calm force */
    uint8_t past_at;
    uint16_t phase;                        /* samples of this tick */
    bool on, incipient;
    bool is_second;                        /* in ON every second tick is looked at */
    bool has_filtered, is_started, is_in_codes, is_recalled;
    bool is_alive, is_at_rest;             /* S moves about its rest; its mean lies there */
} slip_state;

/* Prepare a detector for its first sample. */
void slip_init(slip_state *state);

/* Prepare the detector of one of several fingers that one controller samples: it decides `finger` samples
 * sooner than those of finger 0, so that the fingers share the work of each sample. */
void slip_init_finger(slip_state *state, unsigned finger);

/* Return the floors of a detector whose signal has rested for 0.3 s, in the air or in a held grasp. */
static inline slip_floors slip_learned(const slip_state *state) {
    return state->learned;
}

/* Prepare a detector with the floors of an earlier rest and of the same inputs, right after it was initialised: a start in
 * the middle of a slip is then decided after 40 ms. Without them it cannot be told until the signal has rested. Flash that
 * was never written changes nothing: it holds no numbers above 0. */
void slip_recall(slip_state *state, slip_floors floors);

/* Process one sample of the tactile voltage T and of the filtered signal S of the board's connector, S right
 * after T [V], and return whether slip is ON. A board that gives no filtered signal is judged by T alone. */
bool slip_step(slip_state *state, float tactile_v, float filtered_v);

/* Process one sample of T alone [V]. Use the same function for all samples of a detector. */
bool slip_step_tactile(slip_state *state, float tactile_v);

/* Process samples as codes of the converter for which the library was made. Differences of codes are exact, those of
 * volts in single precision are not. */
bool slip_step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code);
bool slip_step_tactile_code(slip_state *state, int32_t tactile_code);

/* Process a sample that was lost: the last one takes its place. */
bool slip_step_lost(slip_state *state);

/* Process samples of T and S [V], any number of them, and write 1 for each at which slip is ON, else 0. Without
 * `filtered_v` (NULL) T alone is judged. */
void slip_process(slip_state *state, const float *tactile_v, const float *filtered_v, size_t count,
                  uint8_t *on);

/* Return the voltage that a code of the converter stands for [V]. */
static inline float slip_volts(int32_t code) {
    return SLIP_ADC_LOW_V + SLIP_ADC_STEP_V * (float)code;
}

/* Return whether S is not used because it does not change or its codes rest far from the middle of the supply: its wire
 * may be broken. T alone is judged then. */
static inline bool slip_filtered_is_still(const slip_state *state) {
    return state->has_filtered && state->age_ticks > SLIP_LEARNING_TICKS
        && (state->filtered.still >= SLIP_STILL_SAMPLES || !state->is_at_rest);
}

/* Faults of the inputs. They end by themselves. */
#define SLIP_IS_REPLACED 1u /* in the last 50 ms a sample was lost, no voltage or a glitch: the last one was used */
#define SLIP_IS_OUTSIDE 2u  /* for 50 ms T has been a voltage that no force gives: no supply, or a shorted sensor */
#define SLIP_IS_STILL 4u    /* S has not changed for 0.2 s, or its codes rest far from the middle of the supply: its wire
                             * may be broken, and T alone is judged */

/* Return the faults of the inputs as a sum of the numbers above: 0 if there is none. */
static inline unsigned slip_faults(const slip_state *state) {
    return (state->replaced > 0 ? SLIP_IS_REPLACED : 0u)
        | (state->outside > SLIP_FAULT_SAMPLES ? SLIP_IS_OUTSIDE : 0u)
        | (slip_filtered_is_still(state) ? SLIP_IS_STILL : 0u);
}

/* Return whether slip may have begun: earlier than `on`, with more false alarms, and true as long as `on` is. */
static inline bool slip_is_incipient(const slip_state *state) {
    return state->incipient || state->on;
}

#ifdef __cplusplus
}
#endif

#endif
