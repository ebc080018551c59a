// Lights a lamp while something slips over the finger, and shows its force.
//
// Wire the sensor between $supply V (Pico: ADC_VREF, pin 35) and A0 (Pico: GP26; ESP32-S3: GPIO1; ESP32: 36; C3: 0), and
// $resistor between A0 and GND. Open this file in the Arduino IDE, choose board and port, and upload. A Pico needs the package
// of github.com/earlephilhower/arduino-pico; plug a new one in with its button held, and choose "UF2 Board". The lamp lights
// for half a second. Leave the finger alone for a second, then open the Serial Plotter (115200 baud). Press: force_n and
// volts rise. Slide something over the skin: slip is 1, and the lamp is lit. "late" counts lost samples.
//
// $forces
#include <Arduino.h>
#include <stdio.h>
#include <string.h>

#include "slip_buffer.h"
#include "slip_grip.h"
#include "slip_hand.h"
#include "slip_line.h"

static const uint32_t INPUTS[SLIP_FINGERS][1] = SLIP_INPUTS;  // pin of each finger
static const char *const NAMES[SLIP_FINGERS] = SLIP_NAMES;
#ifndef LED_BUILTIN
#define LED_BUILTIN 2  // of most boards with an ESP32
#endif
static const int LAMP_PIN = LED_BUILTIN, LAMP_ON = HIGH;
static const bool STREAM = false;  // true: each sample of the first finger, for `fingertip record` or `detect -`
// Pin of a contact to GND that opens with the motion, such as an endstop: the stream has the column moving.
static const int MOTION_PIN = -1;
static volatile uint8_t moving[MOTION_PIN < 0 ? 1 : SLIP_BUFFER_SAMPLES];  // level of the pin at each waiting sample
static const uint32_t RATE_HZ = SLIP_SAMPLE_RATE_MILLIHZ / 1000u, LINE_SAMPLES = RATE_HZ / 50u;

#if defined(ARDUINO_ARCH_ESP32)
#include <esp_timer.h>
#define CONVERT analogReadMilliVolts  // it corrects the converter's curve
static const int BITS = 12, CONVERSIONS = $task_conversions;  // of which a sample is the mean
static const float COUNT_V = 1e-3f;

// An interrupt must not read the converter: a task of the system, beside loop(), calls the function.
static bool slip_start_timer(void (*callback)()) {
  static void (*called)();
  static esp_timer_handle_t timer;
  esp_timer_create_args_t arguments = {};
  called = callback;
  arguments.callback = [](void *) { called(); };
  return esp_timer_create(&arguments, &timer) == ESP_OK
         && esp_timer_start_periodic(timer, 1000000u / RATE_HZ) == ESP_OK;
}
#else
#include "slip_timer.h"
#define CONVERT analogRead
#if defined(ARDUINO_ARCH_RENESAS)
static const int BITS = 14, CONVERSIONS = $conversions;
static const float COUNT_V = 5.0f / 16384;
#else
static const int BITS = $bits, CONVERSIONS = $conversions;
static const float COUNT_V = (float)$range_v / (1u << BITS);
#endif
#endif

static slip_hand hand;
static volatile uint32_t late;

// Convert all inputs, and store them as codes of the library's converter, whatever the range of this one is.
static void take_sample() {
  static uint32_t last_us = micros(), number;
  static uint64_t elapsed_us;
  const uint32_t now_us = micros();
  elapsed_us += now_us - last_us;
  last_us = now_us;
  number++;
  const uint32_t due = (uint32_t)(elapsed_us * RATE_HZ / 1000000u);  // samples that a timer without delay had taken
  late = due > number ? due - number : 0;
  slip_codes codes[SLIP_FINGERS] = {};
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    uint32_t sum = 0;
    for (int j = 0; j < CONVERSIONS; j++) {
      sum += CONVERT(INPUTS[i][0]);
    }
    codes[i].tactile = (uint16_t)((float)sum * (COUNT_V / CONVERSIONS / (float)SLIP_ADC_STEP_V) + 0.5f);
  }
  if (MOTION_PIN >= 0) {
    moving[slip_stored % SLIP_BUFFER_SAMPLES] = digitalRead(MOTION_PIN) == HIGH;
  }
  slip_store(codes);
}

void setup() {
  pinMode(LAMP_PIN, OUTPUT);
  if (MOTION_PIN >= 0) {
    pinMode(MOTION_PIN, INPUT_PULLUP);
  }
  digitalWrite(LAMP_PIN, LAMP_ON);
  delay(500);
  digitalWrite(LAMP_PIN, !LAMP_ON);
  Serial.begin(STREAM ? 2000000 : 115200);
  analogReadResolution(BITS);
  for (const auto &input : INPUTS) {
    CONVERT(input[0]);  // an ESP32 prepares the pin in its first conversion, which takes long
  }
  slip_hand_init(&hand);
  while (!slip_start_timer(take_sample)) {
    digitalWrite(LAMP_PIN, millis() / 100 % 2);  // no timer is free: blink
  }
}

// Write a line such as "force_n:1.23 volts:0.81 slip:0", of several fingers with their names.
static void plot(const uint32_t *sums, unsigned on, uint32_t missed) {
  char line[96];
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    const float volts = SLIP_ADC_LOW_V + SLIP_ADC_STEP_V * ((float)sums[i] / (float)LINE_SAMPLES);
    const unsigned long n = 100 * slip_force_n(i, volts) + 0.5f, v = 100 * volts + 0.5f;
    Serial.write(line, snprintf(line, sizeof line, "%sforce_n:%lu.%02lu %svolts:%lu.%02lu %sslip:%u ", NAMES[i],
                                n / 100, n % 100, NAMES[i], v / 100, v % 100, NAMES[i], on >> i & 1u));
  }
  Serial.write(line, missed > 0 ? snprintf(line, sizeof line, "late:%lu", (unsigned long)missed) : 0);
  Serial.write("\n", 1);
}

static void stream(const slip_sample &sample) {
  char line[SLIP_LINE_BYTES];
  char *end = slip_format_millionths(line, (uint64_t)sample.number * 1000000000u / SLIP_SAMPLE_RATE_MILLIHZ);
  end = slip_format_volts(end, slip_volts(sample.codes[0].tactile));
  if (MOTION_PIN >= 0) {
    *end++ = ',';
    *end++ = (char)('0' + moving[sample.number % SLIP_BUFFER_SAMPLES]);
  }
  *end++ = '\n';
  if (sample.number % RATE_HZ == 0) {
    Serial.write(SLIP_LINE_HEADER, sizeof SLIP_LINE_HEADER - 1);
    Serial.write(",moving\n" + (MOTION_PIN < 0 ? 7 : 0), MOTION_PIN < 0 ? 1 : 8);
  }
  Serial.write(line, end - line);
}

void loop() {
  static uint32_t sums[SLIP_FINGERS], count, lost;
  static unsigned lamp, slipped;
  slip_sample sample;
  if (!slip_fetch(&sample)) {
    return;
  }
  const unsigned on = slip_hand_step(&hand, sample.codes, sample.lost);
  if (on != lamp) {
    lamp = on;
    digitalWrite(LAMP_PIN, on ? LAMP_ON : !LAMP_ON);
  }
  slipped |= on;
  lost += sample.lost;
  for (unsigned i = 0; i < SLIP_FINGERS; i++) {
    sums[i] += sample.codes[i].tactile;
  }
  if (STREAM && Serial) {
    stream(sample);
  } else if (++count == LINE_SAMPLES) {
    if (Serial) {  // the lamp waits for no computer
      plot(sums, slipped, late + lost);
    }
    memset(sums, 0, sizeof sums);
    count = slipped = 0;
  }
}
