/* Ring buffer of samples, between a timer interrupt that takes them and loop(), which runs the detector.
 *
 * A sample is taken on time whatever loop() does, and a step of the detector may take longer than a sample lasts: loop()
 * catches up in the many short steps that follow. Include it in one file of a sketch. */
#ifndef SLIP_BUFFER_H
#define SLIP_BUFFER_H

#include <stdbool.h>
#include <stdint.h>

/* Samples that may wait: a power of two, so that counting goes on when a count overflows. */
#define SLIP_BUFFER_SAMPLES 1024u

/* Sample as codes of the converter. */
typedef struct slip_sample {
    uint32_t number;            /* samples before it */
    uint16_t tactile, filtered; /* codes of T and S */
    bool is_after_gap;          /* samples before it were lost, as loop() did not fetch them in time */
} slip_sample;

static volatile uint16_t slip_buffer_tactile[SLIP_BUFFER_SAMPLES], slip_buffer_filtered[SLIP_BUFFER_SAMPLES];
static volatile uint32_t slip_stored; /* samples so far; slip_store alone writes it */

/* Store a sample. Call it in the interrupt. */
static inline void slip_store(uint16_t tactile_code, uint16_t filtered_code) {
    slip_buffer_tactile[slip_stored % SLIP_BUFFER_SAMPLES] = tactile_code;
    slip_buffer_filtered[slip_stored % SLIP_BUFFER_SAMPLES] = filtered_code;
    slip_stored = slip_stored + 1;
}

/* Fetch the oldest sample that waits, and return whether there was one. Call it in loop(). */
static inline bool slip_fetch(slip_sample *sample) {
    static uint32_t fetched = 0;
    static bool is_after_gap = false;
    const uint32_t stored = slip_stored;
    if (stored - fetched >= SLIP_BUFFER_SAMPLES) {
        /* The oldest is being overwritten: go on with the next sample. */
        fetched = stored;
        is_after_gap = true;
    }
    if (fetched == stored) {
        return false;
    }
    sample->number = fetched;
    sample->tactile = slip_buffer_tactile[fetched % SLIP_BUFFER_SAMPLES];
    sample->filtered = slip_buffer_filtered[fetched % SLIP_BUFFER_SAMPLES];
    sample->is_after_gap = is_after_gap;
    is_after_gap = false;
    fetched++;
    return true;
}

#endif
