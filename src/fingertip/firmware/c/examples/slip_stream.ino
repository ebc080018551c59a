// Streams samples over USB as lines of CSV, for `fingertip detect -` on the computer. `design.toml` is the
// design that the board was made from:
//
//   stty -F /dev/ttyACM0 2000000 raw -echo
//   fingertip detect - --detector fast --design design.toml < /dev/ttyACM0
//
// The header is repeated each second, so reading may begin at any time. Of several fingers one is streamed: the first, or
// the one whose number the computer sends, as `echo 2 > /dev/ttyACM0` does.
// A timer interrupt takes the samples and stores them; loop() writes them, and runs the detector, whose longest step a
// slow controller does not finish between two samples. The pin is ON while slip is detected here.
#include <slip_buffer.h>
#include <slip_hand.h>
#include <slip_timer.h>

#include "slip_line.h"

#if defined(SLIP_INPUTS)
static const uint32_t INPUTS[SLIP_FINGERS][2] = SLIP_INPUTS;  // T and S of each finger
#else
static const uint32_t INPUTS[SLIP_FINGERS][2] = {{A0, A1}};
#endif
static const int SLIP_PIN = LED_BUILTIN;
// Pin of a contact to GND that opens with the motion, such as an endstop: the stream has the column moving.
static const int MOTION_PIN = -1;
static volatile uint8_t moving[MOTION_PIN < 0 ? 1 : SLIP_BUFFER_SAMPLES];  // level of the pin at each waiting sample
static const unsigned long SETTLE_MS = 2000;  // voltages of the board, after power on
static const uint32_t HEADER_EVERY = SLIP_SAMPLE_RATE_MILLIHZ / 1000u;  // samples

static slip_hand hand;
static volatile unsigned finger;

static void take_sample() {
  slip_codes codes[SLIP_FINGERS];
  codes[0].tactile = analogRead(INPUTS[finger][0]);
  codes[0].filtered = analogRead(INPUTS[finger][1]);
  for (unsigned i = 1; i < SLIP_FINGERS; i++) {
    codes[i] = codes[0];  // the detectors of the others see the same finger
  }
  if (MOTION_PIN >= 0) {
    moving[slip_stored % SLIP_BUFFER_SAMPLES] = digitalRead(MOTION_PIN) == HIGH;
  }
  slip_store(codes);
}

void setup() {
  pinMode(SLIP_PIN, OUTPUT);
  if (MOTION_PIN >= 0) {
    pinMode(MOTION_PIN, INPUT_PULLUP);
  }
  analogReadResolution(SLIP_ADC_BITS);
  slip_hand_init(&hand);
  Serial.begin(2000000);  // a native USB port ignores the rate, a serial bridge does not
  while (!Serial) {
  }
  delay(SETTLE_MS);
  if (!slip_start_timer(take_sample)) {
    Serial.write("no timer is free\n", 17);
  }
}

void loop() {
  slip_sample sample;
  char line[SLIP_LINE_BYTES];
  const int wanted = Serial.available() ? Serial.read() - '1' : -1;
  if (wanted >= 0 && wanted < (int)SLIP_FINGERS) {
    finger = (unsigned)wanted;
  }
  if (!slip_fetch(&sample)) {
    return;
  }
  const float tactile_v = slip_volts(sample.codes[0].tactile), filtered_v = slip_volts(sample.codes[0].filtered);
  char *end = line + slip_format_line(line, sample.number, tactile_v, filtered_v) - 1;
  if (MOTION_PIN >= 0) {
    *end++ = ',';
    *end++ = (char)('0' + moving[sample.number % SLIP_BUFFER_SAMPLES]);
  }
  *end++ = '\n';
  if (sample.number % HEADER_EVERY == 0) {
    Serial.write(SLIP_LINE_HEADER, sizeof SLIP_LINE_HEADER - 1);
    Serial.write(",filtered_v\n", MOTION_PIN < 0 ? 12 : 11);
    Serial.write(",moving\n", MOTION_PIN < 0 ? 0 : 8);
  }
  // Samples are lost if the computer does not read in time. A gap in the times ends `fingertip detect -` with a message.
  digitalWrite(SLIP_PIN, slip_hand_step(&hand, sample.codes, sample.lost) ? HIGH : LOW);
  Serial.write(line, end - line);
}
