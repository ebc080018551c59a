/* Stand-in for Arduino's header: enough to compile the examples, and to run them on this machine. */
#ifndef ARDUINO_STAND_IN_H
#define ARDUINO_STAND_IN_H

#include <stddef.h>
#include <stdint.h>

enum { LOW = 0, HIGH = 1, INPUT = 0, OUTPUT = 1, INPUT_ANALOG = 2, INPUT_PULLUP = 3, LED_BUILTIN = 13 };
enum { A0 = 14, A1, A2, A3, A4, A5, A6, A7, A8, A9 };
enum { PA0 = 100, PA1, PA2, PA3, PA4, PA5, PA6, PA7, PB0 = 108, PB1 };

void pinMode(int pin, int mode);
void digitalWrite(int pin, int level);
int digitalRead(int pin);
int analogRead(int pin);
uint32_t analogReadMilliVolts(uint8_t pin);
void analogReadResolution(int bits);
unsigned long millis();
unsigned long micros();
void delay(unsigned long ms);

struct SerialPort {
  void begin(unsigned long baud);
  operator bool() const { return true; }
  int available();
  int read();
  size_t write(const char *bytes, size_t count);
};
extern SerialPort Serial;

/* Timer of the Teensy. */
class IntervalTimer {
 public:
  bool begin(void (*callback)(), float period_us);
};

#if defined(STM32F4xx)
#include "stm32f4.h"
#endif

/* Timer of the STM32. */
enum TimerFormat { HERTZ_FORMAT };
extern int stand_in_timer;
#define TIM2 (&stand_in_timer)
class HardwareTimer {
 public:
  explicit HardwareTimer(int *instance);
  void setOverflow(uint32_t rate, TimerFormat format);
  void attachInterrupt(void (*callback)());
  void resume();
};

#endif
