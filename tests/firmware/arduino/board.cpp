// Board without hardware: standard input holds the converter's codes of all inputs, T and S of each finger, and a line
// for each sample. Every sample calls the timer's callback and then loop(), but loop() rests from the sample FIRST to
// before LAST, if they are given as arguments, and is then called as often as it missed. From the sample OVERRUN on, the
// third argument, the DMA misses each tenth scan. What the sketch writes goes to standard output, and each change of the
// pin to standard error, with the number of the sample.
#include "Arduino.h"
#include "slip_detector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void setup();
void loop();

static void (*timer_callback)();
static int codes[2 * SLIP_FINGERS], pin_level = -1;
static unsigned long sample, overrun = ~0ul;
static float timer_period_us;
SerialPort Serial;
int stand_in_timer;

void pinMode(int, int) {}
void analogReadResolution(int) {}
unsigned long millis() { return sample / 2; }
unsigned long micros() { return sample * 500; }
void delay(unsigned long) {}

void digitalWrite(int, int level) {
  if (level != pin_level) {
    fprintf(stderr, "%lu %d\n", sample, level);
    pin_level = level;
  }
}

int digitalRead(int) { return sample >= 500 && sample < 900; }  // contact of a slide

int analogRead(int pin) { return codes[pin < PA0 ? pin - A0 : pin - PA0]; }

uint32_t analogReadMilliVolts(uint8_t pin) { return static_cast<uint32_t>(analogRead(pin)); }

#if defined(ARDUINO_ARCH_ESP32)
#include <esp_timer.h>
static void (*esp_callback)(void *);

esp_err_t esp_timer_create(const esp_timer_create_args_t *arguments, esp_timer_handle_t *) {
  esp_callback = arguments->callback;
  return ESP_OK;
}

esp_err_t esp_timer_start_periodic(esp_timer_handle_t, uint64_t period_us) {
  timer_callback = [] { esp_callback(nullptr); };
  timer_period_us = static_cast<float>(period_us);
  return ESP_OK;
}
#elif defined(ARDUINO_ARCH_RENESAS)
#include <FspTimer.h>
static void (*fsp_callback)(timer_callback_args_t *);

int8_t FspTimer::get_available_timer(uint8_t &) { return 0; }
bool FspTimer::begin(timer_mode_t, uint8_t, uint8_t, float rate_hz, float, void (*callback)(timer_callback_args_t *), void *) {
  fsp_callback = callback;
  timer_callback = [] { fsp_callback(nullptr); };
  timer_period_us = 1e6f / rate_hz;
  return true;
}
bool FspTimer::setup_overflow_irq() { return true; }
bool FspTimer::open() { return true; }
bool FspTimer::start() { return true; }
#endif

#if defined(STM32F4xx)
const PinMap PinMap_ADC[1] = {};
stand_in_rcc stand_in_rcc_registers;
stand_in_dma stand_in_dma_registers;
stand_in_dma2 stand_in_dma2_registers;
stand_in_adc stand_in_adc_registers;
stand_in_adc_common stand_in_common_registers;

HardwareTimer::HardwareTimer(int *) {}
void HardwareTimer::setOverflow(uint32_t rate, TimerFormat) { timer_period_us = 1e6f / static_cast<float>(rate); }
void HardwareTimer::attachInterrupt(void (*callback)()) { timer_callback = callback; }
void HardwareTimer::resume() {}

// Convert the inputs of the sequence, if a scan was started, and let the DMA store them as its registers tell. After an
// overrun the DMA stands at the wrong place until it begins anew.
static void convert() {
  const uint32_t wanted = DMA_SxCR_EN | DMA_SxCR_CIRC | DMA_SxCR_MINC | DMA_SxCR_PSIZE_0 | DMA_SxCR_MSIZE_0;
  const uint32_t count = (ADC1->SQR1 >> ADC_SQR1_L_Pos & 15) + 1, sequence[] = {ADC1->SQR3, ADC1->SQR2, ADC1->SQR1};
  const uint32_t settings = ADC_CR2_ADON | ADC_CR2_DMA | ADC_CR2_DDS | ADC_CR2_SWSTART;
  uint16_t *const memory = reinterpret_cast<uint16_t *>(static_cast<uintptr_t>(DMA2_Stream0->M0AR));
  if (!(RCC->AHB1ENR & RCC_AHB1ENR_DMA2EN) || !(RCC->APB2ENR & RCC_APB2ENR_ADC1EN) || DMA2_Stream0->CR != wanted
      || DMA2_Stream0->NDTR != count || count != 2 * SLIP_FINGERS || ADC1->CR1 != ADC_CR1_SCAN || ADC1->CR2 != settings) {
    fprintf(stderr, "the registers do not tell what to convert\n");
    exit(EXIT_FAILURE);
  }
  ADC1->CR2 &= ~static_cast<uint32_t>(ADC_CR2_SWSTART);
  DMA2->LISR &= ~DMA2->LIFCR;
  DMA2->LIFCR = 0;
  if (sample >= overrun && sample % 10 == 0) {
    ADC1->SR |= ADC_SR_OVR;
    DMA2_Stream0->NDTR = 3;
  }
  if (ADC1->SR & ADC_SR_OVR) {
    return;
  }
  DMA2->LISR |= DMA_LISR_TCIF0;
  for (uint32_t i = 0; i < count; i++) {
    memory[i] = static_cast<uint16_t>(codes[sequence[i / 6] >> 5 * (i % 6) & 31]);
  }
}
#else
static void convert() {}
#endif

static bool read_codes() {
  for (int &code : codes) {
    if (scanf("%d", &code) != 1) {
      return false;
    }
  }
  return true;
}

void SerialPort::begin(unsigned long) {}

// The variable KEYS holds what the computer sends: one character with each hundredth sample.
int SerialPort::available() {
  const char *const keys = getenv("KEYS");
  return keys && sample % 100 == 99 && sample / 100 < strlen(keys);
}

int SerialPort::read() { return getenv("KEYS")[sample / 100]; }

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
  overrun = count > 3 ? strtoul(arguments[3], nullptr, 10) : overrun;
  setup();
  fprintf(stderr, "period %g\n", static_cast<double>(timer_period_us));
  while (read_codes()) {
    timer_callback();
    convert();
    missed++;
    while (!(first <= sample && sample < last) && missed > 0) {
      loop();
      missed--;
    }
    sample++;
  }
  return EXIT_SUCCESS;
}
