/* Program for a bare controller: it runs the detector on the pairs of samples.bin, and writes the result of each.
 *
 * Each record of results.bin holds the decision, the confidence, and the time that the step took by the controller's
 * timer SysTick, without that of an empty step. stack.bin holds the bytes of stack that the deepest step used. Under
 * `qemu-system-arm -icount shift=10` an instruction takes 1.024 us, so the time is a number of instructions. */
#include "semihosting.h"
#include "slip_detector.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)
#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88u)

enum { CHUNK = 64, STACK_WORDS = 512 };
static const uint32_t PATTERN = 0x51A9C0DEu, COUNTER = 0xFFFFFFu;

typedef bool (*step_function)(slip_state *, slip_real, slip_real);

struct sample {
    slip_real tactile_v, filtered_v;
};

struct record {
    slip_real confidence;
    uint32_t ticks;
    uint32_t on;
};

extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];
int main(void);

static bool do_nothing(slip_state *state, slip_real tactile_v, slip_real filtered_v) {
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

    SYSTICK_RELOAD = COUNTER;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5; /* enabled, from the processor's clock, without interrupts */
    slip_init(&state);
    overhead = time_step(empty, &state, none, &on);
    while ((count = read_file(input, samples, sizeof samples) / sizeof samples[0]) > 0) {
        for (i = 0; i < count; i++) {
            copy = state;
            depth = measure_stack(&copy, samples[i]);
            deepest = depth > deepest ? depth : deepest;
            records[i].ticks = time_step(step, &state, samples[i], &on) - overhead;
            records[i].on = on;
            records[i].confidence = state.confidence;
        }
        write_file(output, records, count * sizeof records[0]);
    }
    write_file(stack, &deepest, sizeof deepest);
    quit(1);
    return 0;
}

static void reset(void) {
    const uint32_t *from = data_load;
    uint32_t *to;
#if defined(__ARM_FP)
    COPROCESSOR_ACCESS |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
#endif
    for (to = data_start; to < data_end;) {
        *to++ = *from++;
    }
    for (to = bss_start; to < bss_end;) {
        *to++ = 0;
    }
    main();
}

static void fault(void) {
    quit(0);
}

struct vector_table {
    uint32_t *stack;
    void (*handlers[15])(void);
};

extern const struct vector_table vectors;
__attribute__((section(".vectors"), used)) const struct vector_table vectors = {stack_top, {reset, fault, fault}};
