/* Stand-in for the timer of the UNO R4. */
#ifndef FSP_TIMER_STAND_IN_H
#define FSP_TIMER_STAND_IN_H

#include <stdint.h>

enum { GPT_TIMER = 0 };
enum timer_mode_t { TIMER_MODE_PERIODIC };
struct timer_callback_args_t {};

class FspTimer {
 public:
  static int8_t get_available_timer(uint8_t &type);
  bool begin(timer_mode_t mode, uint8_t type, uint8_t channel, float rate_hz, float duty,
             void (*callback)(timer_callback_args_t *), void *context = nullptr);
  bool setup_overflow_irq();
  bool open();
  bool start();
};

#endif
