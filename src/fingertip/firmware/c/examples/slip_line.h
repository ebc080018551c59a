/* Lines of the stream: time and voltage as CSV, with a point and six decimals, which `fingertip detect -` reads. */
#ifndef SLIP_LINE_H
#define SLIP_LINE_H

#include "slip_detector.h"

#define SLIP_LINE_HEADER "time_s,voltage_v\n"
enum { SLIP_LINE_BYTES = 40 };

/* Write a number of millionths, and return the position behind it. */
static inline char *slip_format_millionths(char *at, uint64_t millionths) {
    char digits[20];
    int count = 0;
    do {
        digits[count++] = (char)('0' + millionths % 10);
        millionths /= 10;
    } while (millionths > 0 || count < 7);
    while (count > 0) {
        *at++ = digits[--count];
        if (count == 6) {
            *at++ = '.';
        }
    }
    return at;
}

/* Write the line of a sample [V] without a final zero, and return its length. */
static inline size_t slip_format_line(char *line, uint32_t sample, slip_real voltage_v) {
    char *at = line;
    slip_real microvolts = voltage_v * (slip_real)1e6;
    at = slip_format_millionths(at, (uint64_t)sample * 1000000000u / SLIP_SAMPLE_RATE_MILLIHZ);
    *at++ = ',';
    if (microvolts < (slip_real)0.0) {
        *at++ = '-';
        microvolts = -microvolts;
    }
    at = slip_format_millionths(at, (uint64_t)(microvolts + (slip_real)0.5));
    *at++ = '\n';
    return (size_t)(at - line);
}

#endif
