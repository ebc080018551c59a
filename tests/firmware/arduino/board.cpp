// Board without hardware: standard input holds the converter's codes of both pins, a pair per line; every sample
// calls the timer's callback and then loop(), but loop() rests from the sample FIRST to before LAST, if they are given as
// arguments, and is then called as often as it missed. What the sketch writes goes to standard output, and each change of the pin to standard error, with the number of the sample.
#include "Arduino.h"

#include <stdio.h>
#include <stdlib.h>

void setup();
void loop();

static void (*timer_callback)();
static int tactile_code, filtered_code, pin_level = -1;
static unsigned long sample;
static float timer_period_us;
SerialPort Serial;
int stand_in_timer;

void pinMode(int, int) {}
void analogReadResolution(int) {}
unsigned long millis() { return sample / 2; }
void delay(unsigned long) {}

void digitalWrite(int, int level) {
  if (level != pin_level) {
    fprintf(stderr, "%lu %d\n", sample, level);
    pin_level = level;
  }
}

int analogRead(int pin) { return pin == A0 ? tactile_code : filtered_code; }

void SerialPort::begin(unsigned long) {}

size_t SerialPort::write(const char *bytes, size_t count) {
  const size_t written = fwrite(bytes, 1, count, stdout);
  fflush(stdout);
  return written;
}

bool IntervalTimer::begin(void (*callback)(), float period_us) {
  timer_callback = callback;
  timer_period_us = period_us;
  return true;
}

int main(int count, char **arguments) {
  const unsigned long first = count > 1 ? strtoul(arguments[1], nullptr, 10) : 0;
  const unsigned long last = count > 2 ? strtoul(arguments[2], nullptr, 10) : 0;
  unsigned long missed = 0;
  setup();
  fprintf(stderr, "period %g\n", static_cast<double>(timer_period_us));
  while (scanf("%d %d", &tactile_code, &filtered_code) == 2) {
    timer_callback();
    missed++;
    while (!(first <= sample && sample < last) && missed > 0) {
      loop();
      missed--;
    }
    sample++;
  }
  return EXIT_SUCCESS;
}
