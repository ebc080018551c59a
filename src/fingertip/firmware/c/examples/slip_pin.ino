// Switches a pin on while slip is detected. A timer interrupt takes the samples, so nothing in loop() can delay them.
//
// Wire T and S of the board's connector (see the library's README.md) to TACTILE_PIN and FILTERED_PIN, and its ground
// to ground. A board without S needs no FILTERED_PIN: the library then ignores it.
#include <slip_detector.h>
#include <slip_timer.h>

static const int TACTILE_PIN = A0;
static const int FILTERED_PIN = A1;
static const int SLIP_PIN = LED_BUILTIN;

static slip_state slip;

static void take_sample() {
  const int tactile = analogRead(TACTILE_PIN);
  const int filtered = analogRead(FILTERED_PIN);
  digitalWrite(SLIP_PIN, slip_step_codes(&slip, tactile, filtered) ? HIGH : LOW);
}

void setup() {
  pinMode(SLIP_PIN, OUTPUT);
  analogReadResolution(SLIP_ADC_BITS);
  slip_init(&slip);
  if (!slip_start_timer(take_sample)) {
    for (;;) {  // no timer is free: blink, rather than stay OFF as if there were no slip
      digitalWrite(SLIP_PIN, millis() / 100 % 2 ? HIGH : LOW);
    }
  }
}

void loop() {
  // The detector runs in the interrupt. slip.confidence and slip.on may be read here.
}
