// Streams samples over USB as lines of CSV, for `fingertip detect -` on the computer:
//
//   stty -F /dev/ttyACM0 2000000 raw -echo
//   fingertip detect - --detector fast --design DESIGN < /dev/ttyACM0
//
// The header is repeated each second, so reading may begin at any time.
// A timer interrupt takes the samples and stores them; loop() writes them, and runs the detector, whose longest step a
// slow controller does not finish between two samples. The pin is ON while slip is detected here.
#include <slip_detector.h>
#include <slip_timer.h>

#include "slip_line.h"

static const int TACTILE_PIN = A0;
static const int FILTERED_PIN = A1;
static const int SLIP_PIN = LED_BUILTIN;
static const uint32_t HEADER_EVERY = SLIP_SAMPLE_RATE_MILLIHZ / 1000u;  // samples
static const unsigned STORED = 1024;  // samples that wait for the computer, a power of two

static slip_state slip;
static volatile uint16_t stored_tactile[STORED], stored_filtered[STORED];
static volatile uint32_t taken;  // samples so far; the interrupt alone writes it

static void take_sample() {
  const uint16_t tactile = analogRead(TACTILE_PIN);
  const uint16_t filtered = analogRead(FILTERED_PIN);
  stored_tactile[taken % STORED] = tactile;
  stored_filtered[taken % STORED] = filtered;
  taken = taken + 1;
}

void setup() {
  pinMode(SLIP_PIN, OUTPUT);
  analogReadResolution(SLIP_ADC_BITS);
  slip_init(&slip);
  Serial.begin(2000000);  // a native USB port ignores the rate, a serial bridge does not
  while (!Serial) {
  }
  if (!slip_start_timer(take_sample)) {
    Serial.write("no timer is free\n", 17);
  }
}

void loop() {
  static uint32_t written = 0;
  char line[SLIP_LINE_BYTES];
  if (taken - written >= STORED) {
    // The computer did not read in time. A gap in the times ends `fingertip detect -` with a message.
    written = taken;
  }
  if (written != taken) {
    const uint16_t tactile = stored_tactile[written % STORED];
    const uint16_t filtered = stored_filtered[written % STORED];
    const size_t length = slip_format_line(line, written, slip_volts(tactile), slip_volts(filtered));
    if (written % HEADER_EVERY == 0) {
      Serial.write(SLIP_LINE_HEADER, sizeof SLIP_LINE_HEADER - 1);
    }
    digitalWrite(SLIP_PIN, slip_step_codes(&slip, tactile, filtered) ? HIGH : LOW);
    Serial.write(line, length);
    written++;
  }
}
