/* Detectors of the fingers of a hand, whose samples one controller takes at the same time.
 *
 * The trees of each finger are evaluated in another sample, as far as there are as many samples between two evaluations,
 * so the work of a sample is that of one finger's longest step and of the other fingers' shortest ones. */
#ifndef SLIP_HAND_H
#define SLIP_HAND_H

#include "slip_detector.h"

typedef struct slip_hand {
    slip_state fingers[SLIP_FINGERS];
    uint16_t last[SLIP_FINGERS]; /* code of T */
    uint16_t flat[SLIP_FINGERS]; /* samples since its last change, up to SLIP_STILL_SAMPLES */
} slip_hand;

/* Another fault of the inputs: a converter of 12 bits or more has given one code of T, not 0, for 0.2 s. T is at a
 * limit, as of an amplifier's supply, and slip is not visible there. */
#define SLIP_IS_FLAT 8u

/* Prepare the detectors of all fingers. */
static inline void slip_hand_init(slip_hand *hand) {
    unsigned i;
    for (i = 0; i < SLIP_FINGERS; i++) {
        slip_init_finger(&hand->fingers[i], i);
        hand->last[i] = hand->flat[i] = 0;
    }
}

/* Process the codes of T and S of all fingers, after `lost` samples that are missing, and return the fingers at which
 * slip is ON: bit i for finger i. */
static inline unsigned slip_hand_step(slip_hand *hand, const slip_codes *codes, uint32_t lost) {
    /* After a gap the next sample begins anew. How much longer it was does not matter. */
    uint32_t missing = lost < SLIP_GAP_SAMPLES + 1u ? lost : SLIP_GAP_SAMPLES + 1u;
    unsigned i, on = 0;
    for (; missing > 0; missing--) {
        for (i = 0; i < SLIP_FINGERS; i++) {
            slip_step_lost(&hand->fingers[i]);
        }
    }
    for (i = 0; i < SLIP_FINGERS; i++) {
        const bool is_flat = SLIP_ADC_BITS >= 12 && codes[i].tactile == hand->last[i] && hand->last[i] > 0;
        const bool is_lost = SLIP_ADC_BITS < 16 && codes[i].filtered == SLIP_LOST_CODE;
        if (is_lost ? slip_step_lost(&hand->fingers[i])
                    : slip_step_codes(&hand->fingers[i], codes[i].tactile, codes[i].filtered)) {
            on |= 1u << i;
        }
        hand->flat[i] = !is_flat ? 0 : hand->flat[i] < SLIP_STILL_SAMPLES ? hand->flat[i] + 1 : SLIP_STILL_SAMPLES;
        hand->last[i] = codes[i].tactile;
    }
    return on;
}

/* Return the fingers whose inputs have one of the faults, a sum of their numbers: bit i for finger i. */
static inline unsigned slip_hand_faults(const slip_hand *hand, unsigned faults) {
    unsigned i, found = 0;
    for (i = 0; i < SLIP_FINGERS; i++) {
        if ((slip_faults(&hand->fingers[i]) | (hand->flat[i] < SLIP_STILL_SAMPLES ? 0u : SLIP_IS_FLAT)) & faults) {
            found |= 1u << i;
        }
    }
    return found;
}

#endif
