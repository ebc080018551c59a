// Switches a pin on while slip is detected. A timer interrupt takes the samples, so nothing in loop() can delay them.
//
// Wire T of the board's connector (see the library's README.md) to TACTILE_PIN, and its ground to ground.
#include <slip_detector.h>
#include <slip_timer.h>

static const int TACTILE_PIN = A0;
static const int SLIP_PIN = LED_BUILTIN;

static slip_state slip;

static void take_sample() {
  digitalWrite(SLIP_PIN, slip_step_code(&slip, analogRead(TACTILE_PIN)) ? HIGH : LOW);
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
