/* Stand-in for the timers of the RP2040. */
#ifndef PICO_TIME_STAND_IN_H
#define PICO_TIME_STAND_IN_H

#include <stdint.h>

struct repeating_timer_t {};
bool add_repeating_timer_us(int64_t delay_us, bool (*callback)(repeating_timer_t *), void *data,
                            repeating_timer_t *timer);

#endif
