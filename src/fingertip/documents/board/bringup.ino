// Tone generator for the bring-up of board {{ name }} (bringup.md, Tone): a pin switches between 0 and 3.3 V.
{% if plan.pins_v %}
// It reads T and S of {{ "one finger" if fingers | length > 1 else "the board" }} as well, and tells what is within its limits.
{% else %}
// It plays one tone after the other, each long enough to read the meter.
{% endif %}
#include <Arduino.h>

static const int TONE_PIN = {{ stimulus.TONE_PIN }};
static const uint32_t RATE_HZ = {{ stimulus.SAMPLE_HZ }};

{% if plan.pins_v %}
static const int T_PIN = A0, S_PIN = A1;{{ "  // change them for each further finger" if fingers | length > 1 }}
static_assert(TONE_PIN != T_PIN && TONE_PIN != S_PIN, "TONE_PIN is an input here: take another pin");
static const float STEP_V = {{ stimulus.PIN_V }}f / 4096.0f;  // a converter of 12 bits with the supply as its range
static const float TAP_V = {{ tap_v | fixed(4) }}f;
static float mean_v, rms_v, peak_v, tone_v;

// Samples a pin for some periods of the tone, or without one (period 0); prints a text once the mean has settled.
static void measure(int pin, uint32_t period, uint32_t seconds, const char *text = nullptr) {
  const uint32_t whole = period ? period : RATE_HZ, settle = (2 * RATE_HZ / whole + 2) * whole;
  const uint32_t count = (seconds * RATE_HZ / whole + 1) * whole, start = micros();
  const float turn_c = cos(TWO_PI / whole), turn_s = sin(TWO_PI / whole);
  float c = 1.0f, s = 0.0f, sum = 0.0f, squares = 0.0f, re = 0.0f, im = 0.0f, first = 0.0f;
  uint32_t late = 0;
  peak_v = 0.0f;
  for (uint32_t i = 0; i < settle + count; i++) {
    if (i == settle && text) {
      Serial.println(text);
    }
    while (micros() - start < i * 500 / (RATE_HZ / 2000)) {
    }
    if (period) {
      digitalWrite(TONE_PIN, i % period < period / 2 ? HIGH : LOW);
    }
    const float v = analogRead(pin) * STEP_V;
    late += micros() - start > (i + 1) * 500 / (RATE_HZ / 2000);
    if (i % whole == 0) {
      c = 1.0f;
      s = 0.0f;
    }
    if (i < settle) {
      first += (v - first) * 0.001f;
    } else {
      const float d = v - first;
      sum += d;
      squares += d * d;
      re += d * c;
      im += d * s;
      peak_v = fabs(d) > peak_v ? fabs(d) : peak_v;
    }
    const float next = c * turn_c - s * turn_s;
    s = s * turn_c + c * turn_s;
    c = next;
  }
  digitalWrite(TONE_PIN, LOW);
  mean_v = first + sum / count;
  rms_v = sqrt(fabs(squares / count - (sum / count) * (sum / count)));
  tone_v = sqrt(2.0f * (re * re + im * im)) / count;
  if (late > count / 100) {
    Serial.println("This controller is too slow for {{ stimulus.SAMPLE_HZ }} samples per second: take a faster one.");
  }
}

static void report(const char *name, float volts, float low, float high) {
  Serial.print(name);
  Serial.print(volts, 4);
  Serial.print(" V, ");
  Serial.print(low, 4);
  Serial.print(" to ");
  Serial.print(high, 4);
  Serial.println(low <= volts && volts <= high ? " ok" : " FAILS");
}

void setup() {
  pinMode(TONE_PIN, OUTPUT);
  analogReadResolution(12);
  Serial.begin(115200);
}

void loop() {
{% for net, limits in plan.pins_v.items() %}
  measure({{ letters[net] }}_PIN, 0, 1);
  report("{{ letters[net] }} at rest: ", mean_v, {{ limits.low | fixed(4) }}f, {{ limits.high | fixed(4) }}f);
{% endfor %}
  report("S quiet, RMS: ", rms_v, 0.0f, {{ plan.quiet_v.high | fixed(4) }}f);
  const float quiet_v = peak_v;
{% for tone in plan.tones %}
{% set is_long = plan.envelope_v and tone.samples == setup.periods[2] %}
{% if is_long %}
  Serial.println("Measure TP4 and SLIP now, for 20 seconds.");
{% endif %}
  measure({{ letters[tone.net] }}_PIN, {{ tone.samples }}, {{ 20 if is_long else 1 }});
  report("{{ letters[tone.net] }} with {{ tone.hz | fixed(1) }} Hz, RMS: ", tone_v, {{ tone.limits.low | fixed(4) }}f, {{ tone.limits.high | fixed(4) }}f);
{% endfor %}
  measure(S_PIN, 0, 10, "Tap the board now, for 10 seconds.");
  report("S tapped, peak: ", peak_v, 2.0f * quiet_v + STEP_V, TAP_V);
}
{% else %}
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
{% for tone in plan.tones %}
  play("{{ tone.hz | fixed(1) }} Hz: TP3 {{ tone.limits.low | fixed(3) }} to {{ tone.limits.high | fixed(3) }} V", {{ tone.samples }});
{% endfor %}
}
{% endif %}
