// Detects slip at all fingers of a hand, tightens the grip, and tells over USB what the fingers report.
//
// A timer interrupt takes the samples of all fingers and stores them; loop() runs a detector for each finger, and the
// grip law every 10 ms. Wire T and S of each finger's board to the pins of SLIP_INPUTS (see the library's README.md), and
// all grounds together. Put your hand's motors into the two functions at the top: as they are, nothing moves.
#include <slip_buffer.h>
#include <slip_grip.h>
#include <slip_hand.h>
#include <slip_scan.h>
#include <slip_timer.h>
#include <stdio.h>

// The way that a fingertip has closed, in metres, from the encoder of its motor.
static float read_closing_m(unsigned finger) {
  (void)finger;
  return 0;
}

// Make a motor close by this much more than your hand plans, in metres. Hold its place instead where
// slip_grip_is_alive(&grip, micros()) is false: ask that in the motor's own interrupt.
static void command_further_m(unsigned finger, float further_m) {
  (void)finger;
  (void)further_m;
}

static const uint32_t INPUTS[SLIP_FINGERS][2] = SLIP_INPUTS;  // T and S of each finger
static const char *const NAMES[SLIP_FINGERS] = SLIP_NAMES;
static const bool SHOW_CODES = false;  // true: write T and S of each finger twice a second, to see which one you press
static const int SLIP_PIN = LED_BUILTIN;
static const unsigned long SETTLE_MS = 2000;  // voltages of the boards, after power on
static const uint32_t PERIOD = SLIP_SAMPLE_RATE_MILLIHZ / 100000u;  // samples of a control period

static slip_hand hand;
static slip_grip grip;

static void take_sample() {
  slip_codes codes[SLIP_FINGERS];
  slip_scan(codes);
  slip_store(codes);
}

void setup() {
  pinMode(SLIP_PIN, OUTPUT);
  Serial.begin(2000000);
  slip_hand_init(&hand);
  slip_grip_init(&grip);
  delay(SETTLE_MS);
  slip_begin_scan(INPUTS);  // a scan from before would be the detectors' first sample
  if (!slip_start_timer(take_sample)) {
    for (;;) {  // no timer is free: blink, rather than stay OFF as if there were no slip
      digitalWrite(SLIP_PIN, millis() / 100 % 2 ? HIGH : LOW);
    }
  }
}

// Write a line such as "12.340 s: index slips" for each finger of a set.
static void tell(uint32_t time_ms, unsigned fingers, const char *what) {
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    if (fingers >> i & 1u) {
      char line[128];
      const int length = snprintf(line, sizeof line, "%lu.%03lu s: %s %s\n", (unsigned long)(time_ms / 1000),
                                  (unsigned long)(time_ms % 1000), NAMES[i], what);
      Serial.write(line, length < (int)sizeof line ? length : (int)sizeof line - 1);
    }
  }
}

// Write a line such as "index: T 174, S 2048" for each finger.
static void show(const slip_codes codes[SLIP_FINGERS]) {
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    char line[64];
    const int length = snprintf(line, sizeof line, "%.30s: T %u, S %u\n", NAMES[i], codes[i].tactile, codes[i].filtered);
    Serial.write(line, length);
  }
}

// Tell what the detectors found in a control period, and tighten the grip.
static void control(uint32_t number, unsigned on, const uint32_t sums[SLIP_FINGERS]) {
  static unsigned last_on, last_replaced, last_outside, last_still, last_flat;
  const uint32_t time_ms = (uint64_t)number * 1000000u / SLIP_SAMPLE_RATE_MILLIHZ;
  const unsigned replaced = slip_hand_faults(&hand, SLIP_IS_REPLACED);
  const unsigned outside = slip_hand_faults(&hand, SLIP_IS_OUTSIDE);
  const unsigned still = slip_hand_faults(&hand, SLIP_IS_STILL);
  const unsigned flat = slip_hand_faults(&hand, SLIP_IS_FLAT);
  slip_grip_input inputs[SLIP_FINGERS];
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    inputs[i].tactile_v = SLIP_ADC_LOW_V + SLIP_ADC_STEP_V * ((float)sums[i] / (float)PERIOD);
    inputs[i].closing_m = read_closing_m(i);
  }
  // A finger whose voltage no force gives neither tightens the grip nor is tightened.
  on &= ~outside;
  if (slip_grip_step(&grip, micros(), on, ~outside, inputs)) {
    Serial.write("grip tightened\n", 15);
  }
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    command_further_m(i, grip.added_m[i]);
  }
  digitalWrite(SLIP_PIN, on ? HIGH : LOW);
  tell(time_ms, on & ~last_on, "slips");
  tell(time_ms, replaced & ~last_replaced, "has lost or wrong samples");
  tell(time_ms, outside & ~last_outside, "has a voltage that no force gives: check its wires");
  tell(time_ms, still & ~last_still, "has a silent S: check its wire");
  tell(time_ms, flat & ~last_flat, "has a flat T: at a limit, where slip is not visible");
  last_on = on;
  last_replaced = replaced;
  last_outside = outside;
  last_still = still;
  last_flat = flat;
}

void loop() {
  static uint32_t sums[SLIP_FINGERS], count;
  static unsigned on;
  slip_sample sample;
  if (!slip_fetch(&sample)) {
    return;
  }
  on |= slip_hand_step(&hand, sample.codes, sample.lost);
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    sums[i] += sample.codes[i].tactile;
  }
  if (++count == PERIOD) {
    control(sample.number + 1, on, sums);
    if (SHOW_CODES && (sample.number + 1) / PERIOD % 50 == 0) {
      show(sample.codes);
    }
    for (unsigned i = 0; i < SLIP_FINGERS; i++) {
      sums[i] = 0;
    }
    count = on = 0;
  }
}
