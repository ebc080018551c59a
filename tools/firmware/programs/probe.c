/* Shared library for the tests: a detector that also returns its numbers, and the size of its state. */
#include "slip_detector.h"

size_t probe_state_bytes(void);
void probe_process(slip_state *state, const float *tactile_v, const float *filtered_v, size_t count, float *vibration,
                   float *mean, float *level, uint8_t *incipient, uint8_t *faults, uint8_t *on);
void probe_process_codes(slip_state *state, const int32_t *tactile, const int32_t *filtered, size_t count, uint8_t *on);

size_t probe_state_bytes(void) {
    return sizeof(slip_state);
}

void probe_process(slip_state *state, const float *tactile_v, const float *filtered_v, size_t count, float *vibration,
                   float *mean, float *level, uint8_t *incipient, uint8_t *faults, uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        slip_process(state, tactile_v + i, filtered_v ? filtered_v + i : NULL, 1, on + i);
        vibration[i] = state->vibration;
        mean[i] = state->mean;
        level[i] = state->floor;
        incipient[i] = slip_is_incipient(state);
        faults[i] = (uint8_t)slip_faults(state);
    }
}

void probe_process_codes(slip_state *state, const int32_t *tactile, const int32_t *filtered, size_t count,
                         uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = filtered ? slip_step_codes(state, tactile[i], filtered[i]) : slip_step_tactile_code(state, tactile[i]);
    }
}
