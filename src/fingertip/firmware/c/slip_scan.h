/* Scan of the analog inputs of all fingers, for Arduino sketches. Include it in one file of a sketch.
 *
 * On an STM32F4 the converter runs through all inputs by itself, and DMA stores the codes: a scan starts the next one and
 * returns that of one sample before, so the interrupt waits for nothing. Elsewhere it calls analogRead for each input. */
#ifndef SLIP_SCAN_H
#define SLIP_SCAN_H

#include <Arduino.h>

#include "slip_detector.h"

#if defined(STM32F4xx)

static_assert(SLIP_ADC_BITS == 12, "the converter of the STM32F4 gives 12 bits");
static_assert(2 * SLIP_FINGERS <= 16, "a scan has 16 places at most");

static volatile slip_codes slip_scanned[SLIP_FINGERS];

/* Begin to store codes at the first place: half words from the converter to ascending places, again and again, on
 * channel 0 of stream 0. */
static inline void slip_begin_storing(void) {
    DMA2_Stream0->CR = 0;
    while (DMA2_Stream0->CR & DMA_SxCR_EN) {
    }
    DMA2_Stream0->PAR = (uint32_t)(uintptr_t)&ADC1->DR;
    DMA2_Stream0->M0AR = (uint32_t)(uintptr_t)slip_scanned;
    DMA2_Stream0->NDTR = 2 * SLIP_FINGERS;
    DMA2->LIFCR = DMA_LIFCR_CTCIF0 | DMA_LIFCR_CHTIF0 | DMA_LIFCR_CTEIF0 | DMA_LIFCR_CDMEIF0 | DMA_LIFCR_CFEIF0;
    DMA2_Stream0->CR = DMA_SxCR_MSIZE_0 | DMA_SxCR_PSIZE_0 | DMA_SxCR_MINC | DMA_SxCR_CIRC | DMA_SxCR_EN;
}

/* Prepare the converter ADC1 for the inputs, and the DMA2 that belongs to it. Do not call analogRead then. */
static inline void slip_begin_scan(const uint32_t inputs[SLIP_FINGERS][2]) {
    const uint32_t count = 2 * SLIP_FINGERS;
    uint32_t sequence[3] = {0, 0, 0}, i;
    for (i = 0; i < count; i++) {
        const uint32_t pin = inputs[i / 2][i % 2];
        const PinName name = analogInputToPinName(pin);
        pinMode(pin, INPUT_ANALOG);
        sequence[i / 6] |= (uint32_t)STM_PIN_CHANNEL(pinmap_function(name, PinMap_ADC)) << (5 * (i % 6));
    }
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA2EN;
    RCC->APB2ENR |= RCC_APB2ENR_ADC1EN;
    (void)RCC->APB2ENR; /* the clocks need two cycles */
    slip_begin_storing();
    ADC->CCR = ADC_CCR_ADCPRE_0; /* a quarter of the bus's clock: 36 MHz is its most */
    /* 84 cycles of sampling for each input: the outputs of the board have some resistance. */
    ADC1->SMPR1 = 0x04924924u;
    ADC1->SMPR2 = 0x24924924u;
    ADC1->SQR1 = (count - 1) << ADC_SQR1_L_Pos | sequence[2];
    ADC1->SQR2 = sequence[1];
    ADC1->SQR3 = sequence[0];
    ADC1->CR1 = ADC_CR1_SCAN;
    ADC1->CR2 = ADC_CR2_ADON | ADC_CR2_DMA | ADC_CR2_DDS;
    delay(1);
    ADC1->CR2 |= ADC_CR2_SWSTART;
    delay(1);
}

/* Take the codes of all inputs, and start the next scan. Call it in the interrupt. A scan that is not complete, as after
 * an interrupt that came late, is marked as lost. */
static inline void slip_scan(slip_codes *codes) {
    const bool is_complete = DMA2->LISR & DMA_LISR_TCIF0;
    uint32_t i;
    for (i = 0; i < SLIP_FINGERS; i++) {
        codes[i].tactile = slip_scanned[i].tactile;
        codes[i].filtered = is_complete ? slip_scanned[i].filtered : SLIP_LOST_CODE;
    }
    if (ADC1->SR & ADC_SR_OVR) {
        /* The DMA missed a code. It gets no other one until both begin anew. */
        slip_begin_storing();
        ADC1->SR = ~(uint32_t)ADC_SR_OVR;
    } else if (!is_complete) {
        return; /* it goes on */
    }
    DMA2->LIFCR = DMA_LIFCR_CTCIF0;
    ADC1->CR2 |= ADC_CR2_SWSTART;
}

#else

static const uint32_t (*slip_inputs)[2];

static inline void slip_begin_scan(const uint32_t inputs[SLIP_FINGERS][2]) {
    slip_inputs = inputs;
    analogReadResolution(SLIP_ADC_BITS);
}

static inline void slip_scan(slip_codes *codes) {
    uint32_t i;
    for (i = 0; i < SLIP_FINGERS; i++) {
        codes[i].tactile = analogRead(slip_inputs[i][0]);
        codes[i].filtered = analogRead(slip_inputs[i][1]);
    }
}

#endif

#endif
