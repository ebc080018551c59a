/* Stand-in for the timer of an ESP32, whose callback a task of the system calls. */
#ifndef ESP_TIMER_STAND_IN_H
#define ESP_TIMER_STAND_IN_H

#include <stdint.h>

typedef int esp_err_t;
typedef struct esp_timer *esp_timer_handle_t;
enum { ESP_OK = 0 };
struct esp_timer_create_args_t {
  void (*callback)(void *);
  void *arg;
};
esp_err_t esp_timer_create(const esp_timer_create_args_t *arguments, esp_timer_handle_t *timer);
esp_err_t esp_timer_start_periodic(esp_timer_handle_t timer, uint64_t period_us);

#endif
