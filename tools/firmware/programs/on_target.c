/* Program for a bare controller: it runs the detector on the pairs of samples.bin, and writes the result of each.
 *
 * Each record of results.bin holds the decision, the evidence, and the time that the step took by the controller's
 * timer SysTick, without that of an empty step. stack.bin holds the bytes of stack that the deepest step used. Under
 * `qemu-system-arm -icount shift=10` an instruction takes 1.024 us, so the time is a number of instructions. */
#include "slip_detector.h"
#include "target.h"

enum { CHUNK = 64, STACK_WORDS = 512 };
static const uint32_t PATTERN = 0x51A9C0DEu;

typedef bool (*step_function)(slip_state *, float, float);

struct sample {
    float tactile_v, filtered_v;
};

struct record {
    float odds;
    uint32_t ticks;
    uint32_t on;
};

static bool do_nothing(slip_state *state, float tactile_v, float filtered_v) {
    (void)tactile_v;
    (void)filtered_v;
    return state->on;
}

/* Measure one call [ticks]. Not inlined, so that every step is called from the same place. */
static __attribute__((noinline)) uint32_t time_step(step_function step, slip_state *state, struct sample v,
                                                       bool *on) {
    uint32_t before = SYSTICK_VALUE;
    *on = step(state, v.tactile_v, v.filtered_v);
    return (before - SYSTICK_VALUE) & COUNTER;
}

/* Run a step on a stack that was painted, and return how many bytes of it were changed below this call. */
static __attribute__((noinline)) uint32_t measure_stack(slip_state *state, struct sample v) {
    volatile uint32_t *low = (volatile uint32_t *)__builtin_frame_address(0) - STACK_WORDS;
    uint32_t i;
    for (i = 0; i < STACK_WORDS - 32; i++) {
        low[i] = PATTERN;
    }
    slip_step(state, v.tactile_v, v.filtered_v);
    for (i = 0; i < STACK_WORDS - 32 && low[i] == PATTERN; i++) {
    }
    return (STACK_WORDS - i) * (uint32_t)sizeof(uint32_t);
}

int main(void) {
    static slip_state state, copy;
    static struct sample samples[CHUNK];
    static const struct sample none;
    static struct record records[CHUNK];
    volatile step_function empty = do_nothing, step = slip_step;
    intptr_t input = open_file("samples.bin", 11, MODE_READ_BINARY);
    intptr_t output = open_file("results.bin", 11, MODE_WRITE_BINARY);
    intptr_t stack = open_file("stack.bin", 9, MODE_WRITE_BINARY);
    uint32_t overhead, deepest = 0, depth;
    size_t count, i;
    bool on;

    start_counter();
    slip_init(&state);
    overhead = time_step(empty, &state, none, &on);
    while ((count = read_file(input, samples, sizeof samples) / sizeof samples[0]) > 0) {
        for (i = 0; i < count; i++) {
            copy = state;
            depth = measure_stack(&copy, samples[i]);
            deepest = depth > deepest ? depth : deepest;
            records[i].ticks = time_step(step, &state, samples[i], &on) - overhead;
            records[i].on = on;
            records[i].odds = state.odds;
        }
        write_file(output, records, count * sizeof records[0]);
    }
    write_file(stack, &deepest, sizeof deepest);
    quit(1);
    return 0;
}
