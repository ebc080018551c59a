/* Sampling rate for which all this was computed [Hz, mHz]. */
#define SLIP_SAMPLE_RATE_HZ $SAMPLE_RATE_HZ
#define SLIP_SAMPLE_RATE_MILLIHZ $SAMPLE_RATE_MILLIHZ

/* Converter of the design: bits, lower end of its range [V], step [V]. */
#define SLIP_ADC_BITS $ADC_BITS
#define SLIP_ADC_LOW_V $ADC_LOW_V
#define SLIP_ADC_STEP_V $ADC_STEP_V

/* Check of an input: largest number that is a voltage [V]; factor and share of the mean movement; jumps that the next
 * sample must confirm, as a ratio to that mean and at least [V], and the share within which it comes back. */
#define SLIP_NUMBER_LIMIT_V $NUMBER_LIMIT_V
#define SLIP_MOVE_KEEP $MOVE_KEEP
#define SLIP_MOVE_SHARE $MOVE_SHARE
#define SLIP_JUMP_MOVES $JUMP_MOVES
#define SLIP_JUMP_LIMIT_V $JUMP_LIMIT_V
#define SLIP_FILTERED_JUMP_LIMIT_V $FILTERED_JUMP_LIMIT_V
#define SLIP_GLITCH_SHARE $GLITCH_SHARE

/* Samples: of a gap, of a report of a fault, and of OFF after a gap. */
#define SLIP_GAP_SAMPLES $GAP_SAMPLES
#define SLIP_FAULT_SAMPLES $FAULT_SAMPLES
#define SLIP_BLOCKED_SAMPLES $BLOCKED_SAMPLES

/* Tactile voltages that forces give [V], and their codes. */
#define SLIP_LOWEST_V $LOWEST_V
#define SLIP_HIGHEST_V $HIGHEST_V
#define SLIP_LOWEST_CODE $LOWEST_CODE
#define SLIP_HIGHEST_CODE $HIGHEST_CODE

/* Filtered signal: whether the board gives it; factor to a voltage at the filter's input, and limit of that [V]; samples of
 * recovery from a limit, and of no change. */
#define SLIP_HAS_FILTERED $HAS_FILTERED
#define SLIP_FILTERED_SHARE $FILTERED_SHARE
#define SLIP_FILTERED_LIMIT_V $FILTERED_LIMIT_V
#define SLIP_LIMITED_SAMPLES $LIMITED_SAMPLES
#define SLIP_STILL_SAMPLES $STILL_SAMPLES

/* Its code at rest, codes by which its mean may be off, and factor and share of that mean. */
#define SLIP_REST_CODE $REST_CODE
#define SLIP_REST_CODES $REST_CODES
#define SLIP_LEVEL_KEEP $LEVEL_KEEP
#define SLIP_LEVEL_SHARE $LEVEL_SHARE

/* Third-order high-pass filter of the vibration: section of first order, which takes differences, and of second order. */
#define SLIP_STAGE_KEEP $STAGE_KEEP
#define SLIP_STAGE_SHARE $STAGE_SHARE
#define SLIP_HIGH_B $HIGH_B
#define SLIP_HIGH_A1 $HIGH_A1
#define SLIP_HIGH_A2 $HIGH_A2

/* Filters of the slow force: sum of differences that forgets drift, and low-pass filter of second order. */
#define SLIP_LEAK_KEEP $LEAK_KEEP
#define SLIP_SLOW_B $SLOW_B
#define SLIP_SLOW_A1 $SLOW_A1
#define SLIP_SLOW_A2 $SLOW_A2

/* Band-pass filters of the vibration: b, a1 and a2 of each. */
#define SLIP_BANDS $BANDS
#define SLIP_BAND_FILTERS $BAND_FILTERS

/* Samples between those that are compared to tell a tone; samples of a tick, and share of one in their mean. */
#define SLIP_LAG_SAMPLES $LAG_SAMPLES
#define SLIP_TICK_SAMPLES $TICK_SAMPLES
#define SLIP_TICK_SHARE $TICK_SHARE

/* Multiples of the floor: above which the means of 16 and of 24 ticks are incipient slip, and which keeps slip ON. */
#define SLIP_SHORT_RATIO $SHORT_RATIO
#define SLIP_LONG_RATIO $LONG_RATIO
#define SLIP_HOLD_RATIO $HOLD_RATIO

/* Log odds: sum for ON, the most that a tick adds, the least sum; those of a blow in ON, and how many end it. */
#define SLIP_NEED $NEED
#define SLIP_MOST_ODDS $MOST_ODDS
#define SLIP_LEAST_SUM $LEAST_SUM
#define SLIP_STAY_ODDS $STAY_ODDS
#define SLIP_STAY_LOOKS $STAY_LOOKS

/* Ticks: from a crossing to the first look, which a crossing outlasts, without one until ON ends, until filters have settled, until floors are
 * learned, for which they stand after ON, after which they learn what was vetoed, of a tone, and of a calm force. */
#define SLIP_MIN_AGE_TICKS $MIN_AGE_TICKS
#define SLIP_GAP_TICKS $GAP_TICKS
#define SLIP_UNHEARD_TICKS $UNHEARD_TICKS
#define SLIP_SETTLING_TICKS $SETTLING_TICKS
#define SLIP_LEARNING_TICKS $LEARNING_TICKS
#define SLIP_AFTER_TICKS $AFTER_TICKS
#define SLIP_VETOED_TICKS $VETOED_TICKS
#define SLIP_TONE_TICKS $TONE_TICKS
#define SLIP_CALM_TICKS $CALM_TICKS

/* Floor: factors of a tick above it, below it, and far below it; level of four of five means over their mean. Energies at
 * rest: shares of a tick, far below too; multiple that counts; ratio below which a force is calm. Most variation of a tone. */
#define SLIP_RISE $RISE
#define SLIP_FALL $FALL
#define SLIP_DROP $DROP
#define SLIP_QUANTILE_RATIO $QUANTILE_RATIO
#define SLIP_BAND_SHARE $BAND_SHARE
#define SLIP_BAND_DROP_SHARE $BAND_DROP_SHARE
#define SLIP_CLIP_RATIO $CLIP_RATIO
#define SLIP_CALM_RATIO $CALM_RATIO
#define SLIP_TONE_RATIO $TONE_RATIO

/* Least floors of T and of S [V], and least energies of T [V^2]; least floor and energies of a converter's step of 1 V; no
 * step yet [V]. */
#define SLIP_LEAST_V $LEAST_V
#define SLIP_LEAST_ENERGIES $LEAST_ENERGIES
#define SLIP_LEAST_FILTERED_V $LEAST_FILTERED_V
#define SLIP_STEP_LEVEL $STEP_LEVEL
#define SLIP_STEP_ENERGIES $STEP_ENERGIES
#define SLIP_NO_STEP $NO_STEP

/* Floors before the first learning, of T and of S: mean vibration [V], and energies [V^2]. */
#define SLIP_STATED_FLOORS $STATED_FLOORS
#define SLIP_FILTERED_STATED_FLOORS $FILTERED_STATED_FLOORS

/* Features: ticks that they look back on, slices of them for the greatest; ratio above which a tick is loud; longest age;
 * least denominator [V^2], and least share that is no tone. */
#define SLIP_RING $RING
#define SLIP_PEAK_SLICES $PEAK_SLICES
#define SLIP_LOUD_RATIO $LOUD_RATIO
#define SLIP_LONGEST_AGE $LONGEST_AGE
#define SLIP_TINY $TINY
#define SLIP_LEAST_REST $LEAST_REST

/* Table: features, trees, comparisons of a tree from its root to a leaf, and log odds before the first tree. */
#define SLIP_FEATURES $FEATURES
#define SLIP_TREES $TREES
#define SLIP_DEPTH $DEPTH
#define SLIP_OFFSET $OFFSET

/* Program that wrote this library. */
#define SLIP_VERSION "$VERSION"
