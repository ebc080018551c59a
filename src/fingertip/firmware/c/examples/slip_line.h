/* Lines of the stream: time and both voltages as CSV, with a point and six decimals, which `fingertip detect -` reads. */
#ifndef SLIP_LINE_H
#define SLIP_LINE_H

#include "slip_detector.h"

/* Version, which the readers pass over, and the columns that each stream begins with. */
#define SLIP_LINE_HEADER "# fingertip " SLIP_VERSION "\ntime_s,voltage_v"
enum { SLIP_LINE_BYTES = 56 };

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

/* Write a comma and a voltage [V], and return the position behind it. */
static inline char *slip_format_volts(char *at, float volts) {
    float microvolts = volts * 1e6f;
    *at++ = ',';
    if (microvolts < 0.0f) {
        *at++ = '-';
        microvolts = -microvolts;
    }
    return slip_format_millionths(at, (uint64_t)(microvolts + 0.5f));
}

/* Write the line of a sample [V] without a final zero, and return its length. */
static inline size_t slip_format_line(char *line, uint32_t sample, float tactile_v, float filtered_v) {
    char *at = slip_format_millionths(line, (uint64_t)sample * 1000000000u / SLIP_SAMPLE_RATE_MILLIHZ);
    at = slip_format_volts(at, tactile_v);
    at = slip_format_volts(at, filtered_v);
    *at++ = '\n';
    return (size_t)(at - line);
}

#endif
