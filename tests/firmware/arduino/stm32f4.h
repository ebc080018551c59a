/* Stand-in for the converter and the DMA of an STM32F4: registers that the test's board reads and fills. */
#ifndef STM32F4_STAND_IN_H
#define STM32F4_STAND_IN_H

#include <stdint.h>

typedef int PinName;
struct PinMap {};
extern const PinMap PinMap_ADC[1];
static inline PinName analogInputToPinName(uint32_t pin) { return (PinName)pin; }
static inline int pinmap_function(PinName pin, const PinMap *) { return pin - 100; }
#define STM_PIN_CHANNEL(function) (function)

struct stand_in_rcc { uint32_t AHB1ENR, APB2ENR; };
struct stand_in_dma { uint32_t CR, NDTR, PAR, M0AR; uintptr_t memory; };
struct stand_in_dma2 { uint32_t LISR, LIFCR; };
struct stand_in_adc { uint32_t SR, CR1, CR2, SMPR1, SMPR2, SQR1, SQR2, SQR3, DR; };
struct stand_in_adc_common { uint32_t CCR; };
extern stand_in_rcc stand_in_rcc_registers;
extern stand_in_dma stand_in_dma_registers;
extern stand_in_dma2 stand_in_dma2_registers;
extern stand_in_adc stand_in_adc_registers;
extern stand_in_adc_common stand_in_common_registers;
#define RCC (&stand_in_rcc_registers)
#define DMA2 (&stand_in_dma2_registers)
#define DMA2_Stream0 (&stand_in_dma_registers)
#define ADC1 (&stand_in_adc_registers)
#define ADC (&stand_in_common_registers)
enum : uint32_t {
  RCC_AHB1ENR_DMA2EN = 1u << 22, RCC_APB2ENR_ADC1EN = 1u << 8, ADC_CR1_SCAN = 1u << 8, ADC_CR2_ADON = 1u,
  ADC_CR2_DMA = 1u << 8, ADC_CR2_DDS = 1u << 9, ADC_CR2_SWSTART = 1u << 30, ADC_CCR_ADCPRE_0 = 1u << 16,
  DMA_SxCR_EN = 1u, DMA_SxCR_CIRC = 1u << 8, DMA_SxCR_MINC = 1u << 10, DMA_SxCR_PSIZE_0 = 1u << 11,
  DMA_SxCR_MSIZE_0 = 1u << 13, DMA_LISR_TCIF0 = 1u << 5, DMA_LIFCR_CTCIF0 = 1u << 5, DMA_LIFCR_CHTIF0 = 1u << 4,
  DMA_LIFCR_CTEIF0 = 1u << 3, DMA_LIFCR_CDMEIF0 = 1u << 2, DMA_LIFCR_CFEIF0 = 1u, ADC_SR_OVR = 1u << 5
};
enum { ADC_SQR1_L_Pos = 20 };

#endif
