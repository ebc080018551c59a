/* Timer interrupt at the detector's sampling rate, for Arduino sketches. Include it in one file of a sketch.
 *
 * Arduino has no common interface for timers, so each family of boards has a few lines here. On another board, call
 * the same function SLIP_SAMPLE_RATE_HZ times a second from a timer of your own. */
#ifndef SLIP_TIMER_H
#define SLIP_TIMER_H

#include <Arduino.h>

#include "slip_detector.h"

typedef void (*slip_callback)(void);

static const float SLIP_PERIOD_US = 1e6f / SLIP_SAMPLE_RATE_HZ;

#if defined(TEENSYDUINO)

static IntervalTimer slip_timer;

/* Start the timer and return whether one was free. */
static inline bool slip_start_timer(slip_callback callback) {
    return slip_timer.begin(callback, SLIP_PERIOD_US);
}

#elif defined(ARDUINO_ARCH_STM32)

static inline bool slip_start_timer(slip_callback callback) {
    static HardwareTimer timer(TIM2);
    timer.setOverflow((uint32_t)SLIP_SAMPLE_RATE_HZ, HERTZ_FORMAT);
    timer.attachInterrupt(callback);
    timer.resume();
    return true;
}

#elif defined(ARDUINO_ARCH_RENESAS)

#include <FspTimer.h>

static FspTimer slip_timer;
static slip_callback slip_timer_callback;

static void slip_timer_overflow(timer_callback_args_t *arguments) {
    (void)arguments;
    slip_timer_callback();
}

static inline bool slip_start_timer(slip_callback callback) {
    uint8_t type = GPT_TIMER;
    int8_t channel = FspTimer::get_available_timer(type);
    slip_timer_callback = callback;
    return channel >= 0
        && slip_timer.begin(TIMER_MODE_PERIODIC, type, channel, SLIP_SAMPLE_RATE_HZ, 0.0f, slip_timer_overflow)
        && slip_timer.setup_overflow_irq() && slip_timer.open() && slip_timer.start();
}

#elif defined(ARDUINO_ARCH_RP2040) && defined(ARDUINO_ARCH_MBED)

#error "analogRead of the Mbed core must not run in an interrupt: choose Raspberry Pi Pico/RP2040 of Earle Philhower"

#elif defined(ARDUINO_ARCH_RP2040)

#include <pico/time.h>

static repeating_timer_t slip_timer;
static slip_callback slip_timer_callback;

static bool slip_timer_alarm(repeating_timer_t *timer) {
    (void)timer;
    slip_timer_callback();
    return true;
}

static inline bool slip_start_timer(slip_callback callback) {
    slip_timer_callback = callback;
    /* A negative period counts from one call to the next, whatever the call takes. */
    return add_repeating_timer_us(-(int64_t)(SLIP_PERIOD_US + 0.5f), slip_timer_alarm, nullptr, &slip_timer);
}

#else
#error "slip_timer.h knows no timer of this board: call your function SLIP_SAMPLE_RATE_HZ times a second yourself"
#endif

#endif
