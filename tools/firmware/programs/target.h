/* Start of a program on a bare controller, and its counter of time. Include it in the file of main. */
#ifndef TARGET_H
#define TARGET_H

#include "semihosting.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)
#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88u)

static const uint32_t COUNTER = 0xFFFFFFu;

extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];
int main(void);

static inline void start_counter(void) {
    SYSTICK_RELOAD = COUNTER;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5; /* enabled, from the processor's clock, without interrupts */
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

#endif
