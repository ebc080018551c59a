/* Ring buffer of samples, between a timer interrupt that takes them and loop(), which runs the detectors.
 *
 * A sample is taken on time whatever loop() does, and a step of a detector may take longer than a sample lasts: loop()
 * catches up in the many short steps that follow. Include it in one file of a sketch. */
#ifndef SLIP_BUFFER_H
#define SLIP_BUFFER_H

#include "slip_detector.h"

/* Samples that may wait: a power of two, so that counting goes on when a count overflows. */
#ifndef SLIP_BUFFER_SAMPLES
#define SLIP_BUFFER_SAMPLES 1024u
#endif

/* Codes of all fingers, taken at the same time. */
typedef struct slip_sample {
    uint32_t number; /* samples before it: its time is that over the sampling rate */
    uint32_t lost;   /* samples just before it that loop() did not fetch in time */
    slip_codes codes[SLIP_FINGERS];
} slip_sample;

static volatile slip_codes slip_buffer[SLIP_BUFFER_SAMPLES][SLIP_FINGERS];
static volatile uint32_t slip_stored; /* samples so far; slip_store alone writes it */

/* Store a sample. Call it in the interrupt. */
static inline void slip_store(const slip_codes *codes) {
    unsigned i;
    for (i = 0; i < SLIP_FINGERS; i++) {
        slip_buffer[slip_stored % SLIP_BUFFER_SAMPLES][i].tactile = codes[i].tactile;
        slip_buffer[slip_stored % SLIP_BUFFER_SAMPLES][i].filtered = codes[i].filtered;
    }
    slip_stored = slip_stored + 1;
}

/* Fetch the oldest sample that waits, and return whether there was one. Call it in loop(). */
static inline bool slip_fetch(slip_sample *sample) {
    static uint32_t fetched = 0, lost = 0;
    const uint32_t stored = slip_stored;
    unsigned i;
    if (stored - fetched >= SLIP_BUFFER_SAMPLES) {
        /* The oldest is being overwritten: go on with the next sample. */
        lost += stored - fetched;
        fetched = stored;
    }
    if (fetched == stored) {
        return false;
    }
    sample->number = fetched;
    sample->lost = lost;
    for (i = 0; i < SLIP_FINGERS; i++) {
        sample->codes[i].tactile = slip_buffer[fetched % SLIP_BUFFER_SAMPLES][i].tactile;
        sample->codes[i].filtered = slip_buffer[fetched % SLIP_BUFFER_SAMPLES][i].filtered;
    }
    lost = 0;
    fetched++;
    return true;
}

#endif
