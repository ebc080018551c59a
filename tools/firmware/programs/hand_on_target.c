/* Program for a bare controller: it runs the detectors of a hand on the codes of samples.bin, and writes for each sample the
 * fingers that are ON, and the time that all of them took, as on_target.c does for one. */
#include "slip_hand.h"
#include "target.h"

enum { CHUNK = 64 };

struct record {
    uint32_t ticks;
    uint32_t on;
};

typedef unsigned (*hand_function)(slip_hand *, const slip_codes *, uint32_t);

static unsigned do_nothing(slip_hand *hand, const slip_codes *codes, uint32_t lost) {
    (void)codes;
    (void)lost;
    return hand->fingers[0].on;
}

static unsigned step_hand(slip_hand *hand, const slip_codes *codes, uint32_t lost) {
    return slip_hand_step(hand, codes, lost);
}

static __attribute__((noinline)) uint32_t time_step(hand_function step, slip_hand *hand, const slip_codes *codes,
                                                    uint32_t *on) {
    uint32_t before = SYSTICK_VALUE;
    *on = step(hand, codes, 0);
    return (before - SYSTICK_VALUE) & COUNTER;
}

int main(void) {
    static slip_hand hand;
    static slip_codes samples[CHUNK][SLIP_FINGERS];
    static struct record records[CHUNK];
    volatile hand_function empty = do_nothing, step = step_hand;
    intptr_t input = open_file("samples.bin", 11, MODE_READ_BINARY);
    intptr_t output = open_file("results.bin", 11, MODE_WRITE_BINARY);
    uint32_t overhead;
    size_t count, i;

    start_counter();
    slip_hand_init(&hand);
    overhead = time_step(empty, &hand, samples[0], &records[0].on);
    while ((count = read_file(input, samples, sizeof samples) / sizeof samples[0]) > 0) {
        for (i = 0; i < count; i++) {
            records[i].ticks = time_step(step, &hand, samples[i], &records[i].on) - overhead;
        }
        write_file(output, records, count * sizeof records[0]);
    }
    quit(1);
    return 0;
}
