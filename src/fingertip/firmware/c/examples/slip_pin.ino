// Switches a pin on while slip is detected. A timer interrupt takes the samples and stores them; loop() runs the
// detector, whose longest step a slow controller does not finish between two samples. What you add to loop() may take
// as long as SLIP_BUFFER_SAMPLES last; the pin is late by that time.
//
// Wire T and S of the board's connector (see the library's README.md) to TACTILE_PIN and FILTERED_PIN, and its ground
// to ground. A board without S needs no FILTERED_PIN: the library then ignores it.
#include <slip_buffer.h>
#include <slip_hand.h>
#include <slip_timer.h>

static const int TACTILE_PIN = A0;
static const int FILTERED_PIN = A1;
static const int SLIP_PIN = LED_BUILTIN;
static const unsigned long SETTLE_MS = 2000;  // voltages of the board, after power on

static slip_hand hand;

static void take_sample() {
  slip_codes codes;
  codes.tactile = analogRead(TACTILE_PIN);
  codes.filtered = analogRead(FILTERED_PIN);
  slip_store(&codes);
}

void setup() {
  pinMode(SLIP_PIN, OUTPUT);
  analogReadResolution(SLIP_ADC_BITS);
  slip_hand_init(&hand);
  delay(SETTLE_MS);
  if (!slip_start_timer(take_sample)) {
    for (;;) {  // no timer is free: blink, rather than stay OFF as if there were no slip
      digitalWrite(SLIP_PIN, millis() / 100 % 2 ? HIGH : LOW);
    }
  }
}

void loop() {
  slip_sample sample;
  if (!slip_fetch(&sample)) {
    return;
  }
  digitalWrite(SLIP_PIN, slip_hand_step(&hand, sample.codes, sample.lost) ? HIGH : LOW);
}
