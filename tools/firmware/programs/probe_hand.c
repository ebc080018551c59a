/* Shared library for the tests: the detectors of a hand and the grip law, over many samples and periods. */
#include "slip_grip.h"
#include "slip_hand.h"

size_t probe_hand_bytes(void);
size_t probe_grip_bytes(void);
void probe_hand(slip_hand *hand, const slip_codes (*codes)[SLIP_FINGERS], const uint32_t *lost, size_t count, uint8_t *on,
                uint8_t (*faults)[SLIP_FINGERS]);
void probe_grip(slip_grip *grip, const uint32_t *now_us, const uint8_t *on, const uint8_t *usable,
                const slip_grip_input (*inputs)[SLIP_FINGERS], size_t count, float (*added_m)[SLIP_FINGERS],
                uint8_t *flags);

size_t probe_hand_bytes(void) {
    return sizeof(slip_hand);
}

size_t probe_grip_bytes(void) {
    return sizeof(slip_grip);
}

void probe_hand(slip_hand *hand, const slip_codes (*codes)[SLIP_FINGERS], const uint32_t *lost, size_t count, uint8_t *on,
                uint8_t (*faults)[SLIP_FINGERS]) {
    size_t i, k;
    slip_hand_init(hand);
    for (i = 0; i < count; i++) {
        on[i] = (uint8_t)slip_hand_step(hand, codes[i], lost[i]);
        for (k = 0; k < SLIP_FINGERS; k++) {
            faults[i][k] = (uint8_t)slip_faults(&hand->fingers[k]);
        }
    }
}

void probe_grip(slip_grip *grip, const uint32_t *now_us, const uint8_t *on, const uint8_t *usable,
                const slip_grip_input (*inputs)[SLIP_FINGERS], size_t count, float (*added_m)[SLIP_FINGERS],
                uint8_t *flags) {
    size_t i, k;
    slip_grip_init(grip);
    for (i = 0; i < count; i++) {
        slip_grip_step(grip, now_us[i], on[i], usable[i], inputs[i]);
        flags[i] = (uint8_t)(grip->is_suppressed + 2 * grip->has_tightened);
        for (k = 0; k < SLIP_FINGERS; k++) {
            added_m[i][k] = grip->added_m[k];
        }
    }
}
