/* Shared library for the tests: a detector that also returns its numbers, and the size of its state. */
#include "slip_detector.h"

size_t probe_state_bytes(void);
void probe_process(slip_state *state, const slip_real *volts, size_t count, slip_real *wide, slip_real *confidence,
                   slip_real *level, uint8_t *on);

void probe_process_codes(slip_state *state, const int32_t *codes, size_t count, uint8_t *on);

size_t probe_state_bytes(void) {
    return sizeof(slip_state);
}

void probe_process(slip_state *state, const slip_real *volts, size_t count, slip_real *wide, slip_real *confidence,
                   slip_real *level, uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = slip_step(state, volts[i]) ? 1u : 0u;
        wide[i] = state->wide;
        confidence[i] = state->confidence;
        level[i] = state->floor;
    }
}

void probe_process_codes(slip_state *state, const int32_t *codes, size_t count, uint8_t *on) {
    size_t i;
    for (i = 0; i < count; i++) {
        on[i] = slip_step_code(state, codes[i]) ? 1u : 0u;
    }
}
