/* Slip detector `fast` of fingertip, in C99, for a microcontroller.
 *
 * One sample in, one decision out. All of the detector's state is in one struct, nothing is allocated, and a step calls
 * no function but what the compiler itself needs for floating point. The operations and their order are those of
 * fingertip's Python: with SLIP_REAL defined as double, and without contraction (-ffp-contract=off), every decision and
 * every number has the same bits. The default, float, is made for controllers.
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

/* Type of all voltages and features: float or double. Define it for the whole program, not for one file. */
#ifndef SLIP_REAL
#define SLIP_REAL float
#endif
typedef SLIP_REAL slip_real;

#include "slip_constants.h"

/* Codes of the converter for T and S of a finger, S right after T. */
typedef struct slip_codes {
    uint16_t tactile, filtered;
} slip_codes;

/* Stands for S where a sample could not be taken. No converter of less than 16 bits gives it. */
#define SLIP_LOST_CODE 0xFFFFu

/* What the last samples of an input were. */
typedef struct slip_check {
    uint16_t wrong;    /* samples that were no voltage */
    uint16_t trusted;  /* samples for which no jump is suspected */
    bool is_suspected; /* the last sample jumped, and was not used yet */
} slip_check;

/* State of a detector. It is read after a step: `on`, `confidence`, `wide`, `floor`. */
typedef struct slip_state {
    /* Filters, in transposed direct form II. */
    slip_real board_stage, board_1, board_2, restore_1_1, restore_1, restore_2;
    slip_real edge_1, edge_2, upper_1, upper_2, wide_1, wide_2, slow_1, slow_2;
    slip_real wide;                                          /* present output of the wide band [V] */
    slip_real upper_short, upper_long, upper_mean;           /* energies of 6, 20 and 80 ms [V^2] */
    slip_real wide_short, wide_long, wide_mean, slope_mean;  /* the same, and squared slope of 80 ms [V^2] */
    slip_real input_long;                                    /* energy of the tactile voltage without slow force [V^2] */
    slip_real slow, rough;                                   /* sums of slopes since the ring's revolution, of the rest */
    slip_real last_filtered;                                 /* last filtered signal [V] */
    slip_real last_tactile_v, rest_v;                        /* last sample, and filtered signal at rest [V] */
    slip_real level;                                         /* mean code of the filtered signal, over 0.2 s */
    slip_real mean_move, held;                               /* of the filtered signal: mean of 6 ms, of a jump [V] */
    slip_real slopes[3], peaks[3];                           /* greatest squared slope and upper energy of each slot */
    slip_real lows[3];                                       /* smallest wide energy of each slot [V^2] */
    slip_real step, filtered_step;                           /* smallest step of the converter in both inputs [V] */
    slip_real floor, upper_floor, input_floor;               /* learned noise of bands and tactile voltage [V^2] */
    slip_real min_floor, min_upper_floor, noisy_floor;       /* lower bounds, and more noise than stated [V^2] */
    slip_real floor_ticks, on_ticks;                         /* time of learning, of ON [ticks] */
    slip_real lasting_ticks, weak_ticks;                     /* time of upper energy, and of a weaker one [ticks] */
    slip_real mean, mean_square;                             /* of the wide energy while ON */
    slip_real smooth_score, mean_score, confidence;          /* confidence: from 1 on, slip turns ON */
    slip_real heard_mean, heard_square;                      /* of the wide energy while heard */
    slip_real ring[SLIP_RING];                               /* `slow` at every second tick [V] */
    int32_t last_tactile_code, rest_code;                    /* last sample and rest as codes of the converter */
    uint16_t limited;                                        /* samples for which the filtered signal is not used */
    uint16_t still;                                          /* samples since its last change, up to SLIP_STILL_SAMPLES */
    uint16_t settling;                                       /* ticks for which the detector stays OFF at the start */
    uint16_t replaced;                                       /* samples for which a wrong one is reported */
    uint16_t outside;                                        /* samples with a voltage that no force gives */
    uint16_t heard_ticks, unheard, steady;                   /* ticks: vibration, since it, a tone */
    uint16_t after, standing;                                /* ticks: floors stand after ON; the force stands still */
    slip_check tactile_check, filtered_check;
    uint16_t phase, slot;                                    /* samples since the last tick, ticks of the slot */
    uint8_t ring_phase, ring_at, low_phase;
    bool on, incipient, has_filtered, is_started, is_recalled;
    bool is_busy;                                            /* a check or `replaced` is not 0 */
    bool is_off_level;                                       /* `level` is far from the middle of the supply */
    bool begins;                                             /* the filtered signal's rest is to be set anew */
} slip_state;

/* Prepare a detector for its first sample. */
void slip_init(slip_state *state);

/* Prepare the detector of one of several fingers that one controller samples: its trees are evaluated `finger` samples
 * sooner than those of finger 0, so that the fingers share the work of each sample. */
void slip_init_finger(slip_state *state, unsigned finger);

/* What a detector has learned while nothing moved [V^2]: store it, as in flash. */
typedef struct slip_floors {
    slip_real wide, upper, tactile;
} slip_floors;

/* Return the floors of a detector whose signal has rested for 0.5 s, in the air or in a held grasp. */
static inline slip_floors slip_learned(const slip_state *state) {
    const slip_floors floors = {state->floor, state->upper_floor, state->input_floor};
    return floors;
}

/* Prepare a detector with the floors of an earlier rest and of the same inputs, right after it was initialised: a start in
 * the middle of a slip is then decided after 40 ms. Without them it cannot be told until the signal has rested. Flash that
 * was never written changes nothing: it holds no numbers above 0. */
void slip_recall(slip_state *state, slip_floors floors);

/* Process one sample of the tactile voltage T and of the filtered signal S of the board's connector, S right
 * after T [V], and return whether slip is ON. A board that gives no filtered signal is judged by T alone. */
bool slip_step(slip_state *state, slip_real tactile_v, slip_real filtered_v);

/* Process one sample of T alone [V]. Use the same function for all samples of a detector. */
bool slip_step_tactile(slip_state *state, slip_real tactile_v);

/* Process samples as codes of the converter for which the library was made. Differences of codes are exact, those of
 * volts in single precision are not. */
bool slip_step_codes(slip_state *state, int32_t tactile_code, int32_t filtered_code);
bool slip_step_tactile_code(slip_state *state, int32_t tactile_code);

/* Process a sample that was lost: the last one takes its place. */
bool slip_step_lost(slip_state *state);

/* Process samples of T and S [V], any number of them, and write 1 for each at which slip is ON, else 0. Without
 * `filtered_v` (NULL) T alone is judged. */
void slip_process(slip_state *state, const slip_real *tactile_v, const slip_real *filtered_v, size_t count,
                  uint8_t *on);

/* Return the voltage that a code of the converter stands for [V]. */
static inline slip_real slip_volts(int32_t code) {
    return SLIP_ADC_LOW_V + SLIP_ADC_STEP_V * (slip_real)code;
}

/* Return whether S is not used because it does not change or its codes rest far from the middle of the supply: its wire
 * may be broken. T alone is judged then. */
static inline bool slip_filtered_is_still(const slip_state *state) {
    return state->has_filtered && state->still >= SLIP_STILL_SAMPLES && state->settling == 0;
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
    return state->incipient;
}

#ifdef __cplusplus
}
#endif

#endif
