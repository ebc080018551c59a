// Tone generator for the bring-up of board article (bringup.md, Tone): a pin switches between 0 and 3.3 V.
// It plays one tone after the other, each long enough to read the meter.
#include <Arduino.h>

static const int TONE_PIN = 4;
static const uint32_t RATE_HZ = 6000;

static void play(const char *text, uint32_t period) {
  Serial.println(text);
  const uint32_t start = micros();
  for (uint32_t i = 0; i < 20 * RATE_HZ; i++) {
    while (micros() - start < i * 500 / (RATE_HZ / 2000)) {
    }
    digitalWrite(TONE_PIN, i % period < period / 2 ? HIGH : LOW);
  }
}

void setup() {
  pinMode(TONE_PIN, OUTPUT);
  Serial.begin(115200);
}

void loop() {
  play("40.0 Hz: TP3 0.604 to 0.691 V", 150);
  play("66.7 Hz: TP3 0.974 to 1.156 V", 90);
  play("136.4 Hz: TP3 1.304 to 1.456 V", 44);
}
