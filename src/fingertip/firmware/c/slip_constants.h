/* Board's high-pass filter for a gain of 1: its section of first order, */
#define SLIP_BOARD_1_B $BOARD_1_B0
#define SLIP_BOARD_1_A1 $BOARD_1_A1

/* and that of second order. */
#define SLIP_BOARD_B0 $BOARD_B0
#define SLIP_BOARD_B1 $BOARD_B1
#define SLIP_BOARD_B2 $BOARD_B2
#define SLIP_BOARD_A1 $BOARD_A1
#define SLIP_BOARD_A2 $BOARD_A2

/* Filter that moves its cutoff down: section of first order, */
#define SLIP_RESTORE_1_B0 $RESTORE_1_B0
#define SLIP_RESTORE_1_B1 $RESTORE_1_B1
#define SLIP_RESTORE_1_A1 $RESTORE_1_A1

/* and of second order. */
#define SLIP_RESTORE_B0 $RESTORE_B0
#define SLIP_RESTORE_B1 $RESTORE_B1
#define SLIP_RESTORE_B2 $RESTORE_B2
#define SLIP_RESTORE_A1 $RESTORE_A1
#define SLIP_RESTORE_A2 $RESTORE_A2

/* Low-pass filter at the upper edge of both bands, behind it. */
#define SLIP_EDGE_B0 $EDGE_B0
#define SLIP_EDGE_B1 $EDGE_B1
#define SLIP_EDGE_B2 $EDGE_B2
#define SLIP_EDGE_A1 $EDGE_A1
#define SLIP_EDGE_A2 $EDGE_A2

/* High-pass filter at the lower edge of the upper band, behind that. */
#define SLIP_UPPER_B0 $UPPER_B0
#define SLIP_UPPER_B1 $UPPER_B1
#define SLIP_UPPER_B2 $UPPER_B2
#define SLIP_UPPER_A1 $UPPER_A1
#define SLIP_UPPER_A2 $UPPER_A2

/* High-pass filter at the lower edge of the wide band, behind that. */
#define SLIP_WIDE_B0 $WIDE_B0
#define SLIP_WIDE_B1 $WIDE_B1
#define SLIP_WIDE_B2 $WIDE_B2
#define SLIP_WIDE_A1 $WIDE_A1
#define SLIP_WIDE_A2 $WIDE_A2

/* Low-pass filter of the slow voltage, from the tactile voltage. */
#define SLIP_SLOW_B0 $SLOW_B0
#define SLIP_SLOW_B1 $SLOW_B1
#define SLIP_SLOW_B2 $SLOW_B2
#define SLIP_SLOW_A1 $SLOW_A1
#define SLIP_SLOW_A2 $SLOW_A2

/* Filtered signal: factor to a voltage at the filter's input, limit [V]; samples of recovery, and of no change. */
#define SLIP_FILTERED_GAIN $FILTERED_GAIN
#define SLIP_FILTERED_LIMIT $FILTERED_LIMIT
#define SLIP_LIMITED_SAMPLES $LIMITED_SAMPLES
#define SLIP_STILL_SAMPLES $STILL_SAMPLES

/* Its code at rest, codes by which its mean may be off, and share of the mean. */
#define SLIP_REST_CODE $REST_CODE
#define SLIP_REST_CODES $REST_CODES
#define SLIP_LEVEL_SHARE $LEVEL_SHARE

/* Checks of samples: size of what is no voltage, jumps that the next one must confirm [V] and in mean moves; samples of trust, of a gap, and of a report; ticks of OFF after a gap. */
#define SLIP_NUMBER_LIMIT $NUMBER_LIMIT
#define SLIP_JUMP_LIMIT $JUMP_LIMIT
#define SLIP_FILTERED_JUMP_LIMIT $FILTERED_JUMP_LIMIT
#define SLIP_JUMP_MOVES $JUMP_MOVES
#define SLIP_TRUSTED_SAMPLES $TRUSTED_SAMPLES
#define SLIP_GAP_SAMPLES $GAP_SAMPLES
#define SLIP_FAULT_SAMPLES $FAULT_SAMPLES
#define SLIP_RESTART_TICKS $RESTART_TICKS

/* Tactile voltages that forces give, as their middle and half their range [V], and their codes. */
#define SLIP_MIDDLE_INPUT $MIDDLE_INPUT
#define SLIP_HALF_RANGE $HALF_RANGE
#define SLIP_LOWEST_CODE $LOWEST_CODE
#define SLIP_HIGHEST_CODE $HIGHEST_CODE

/* Smoothing factors of 6 and 20 ms, per sample. */
#define SLIP_SHORT $SHORT_SMOOTHING
#define SLIP_LONG $LONG_SMOOTHING

/* Samples of a tick; ticks of a slot of the peaks, and of the smallest; entries of the ring of slow voltages. */
#define SLIP_TICK_SAMPLES $TICK_SAMPLES
#define SLIP_SLOT_TICKS $SLOT_TICKS
#define SLIP_LOW_TICKS $LOW_TICKS
#define SLIP_RING $RING

/* Ticks: OFF at the start; settling of the filters; averaging of the floors, at most, after a change, and where they fall; ON. */
#define SLIP_SETTLING_TICKS $SETTLING_TICKS
#define SLIP_SETTLE_TICKS $SETTLE_TICKS
#define SLIP_MAX_FLOOR_TICKS $MAX_FLOOR_TICKS
#define SLIP_HELD_TICKS $HELD_TICKS
#define SLIP_FALL_TICKS $FALL_TICKS
#define SLIP_TONE_TICKS $TONE_TICKS

/* Ticks of a tone in vibration: averaging, at most; ON ends; incipient slip is ON; ON outlasts; floors stand after ON; the force does. */
#define SLIP_STEADY_TICKS $STEADY_TICKS
#define SLIP_STEADY_COUNT $STEADY_COUNT
#define SLIP_STEADY_ON_TICKS $STEADY_ON_TICKS
#define SLIP_SURE_TICKS $SURE_TICKS
#define SLIP_UNHEARD_TICKS $UNHEARD_TICKS
#define SLIP_AFTER_TICKS $AFTER_TICKS
#define SLIP_STANDING_TICKS $STANDING_TICKS

/* Energies of the stated noise in both bands, those of unit noise, the lowest floors, and those of more noise [V^2]. */
#define SLIP_STATED_WIDE $STATED_WIDE
#define SLIP_STATED_UPPER $STATED_UPPER
#define SLIP_STATED_INPUT $STATED_INPUT
#define SLIP_WIDE_SHARE $WIDE_SHARE
#define SLIP_UPPER_SHARE $UPPER_SHARE
#define SLIP_MIN_FLOOR $MIN_FLOOR
#define SLIP_MIN_UPPER_FLOOR $MIN_UPPER_FLOOR
#define SLIP_MIN_INPUT_FLOOR $MIN_INPUT_FLOOR
#define SLIP_NOISY_FLOOR $NOISY_FLOOR
#define SLIP_NOISY_SLOW_FLOOR $NOISY_SLOW_FLOOR

/* The same where the filtered signal is read. */
#define SLIP_FILTERED_STATED_WIDE $FILTERED_STATED_WIDE
#define SLIP_FILTERED_STATED_UPPER $FILTERED_STATED_UPPER
#define SLIP_FILTERED_MIN_FLOOR $FILTERED_MIN_FLOOR
#define SLIP_FILTERED_MIN_UPPER_FLOOR $FILTERED_MIN_UPPER_FLOOR
#define SLIP_FILTERED_NOISY_FLOOR $FILTERED_NOISY_FLOOR

/* Factor of slopes, which makes them compare with voltages, and the least denominator. */
#define SLIP_SLOPE_GAIN $SLOPE_GAIN
#define SLIP_TINY $TINY

/* Ratios that decide: trees are evaluated, vibration lasts, weak vibration lasts, floors adapt, a tone, an end. */
#define SLIP_LOUD $UPPER_LOUD
#define SLIP_LOUD_20 $UPPER_LOUD_20
#define SLIP_LASTING_RATIO $LASTING_RATIO
#define SLIP_WEAK_RATIO $WEAK_RATIO
#define SLIP_MOVING_RATIO $MOVING_RATIO
#define SLIP_CLIP_RATIO $CLIP_RATIO
#define SLIP_SILENT_RATIO $SILENT_RATIO
#define SLIP_UNLEARNED_RATIO $UNLEARNED_RATIO
#define SLIP_UNLEARNING $UNLEARNING
#define SLIP_STAY_RATIO $STAY_RATIO
#define SLIP_DECAY_RATIO $DECAY_RATIO
#define SLIP_FADE_RATIO $FADE_RATIO
#define SLIP_STEADY_RATIO $STEADY_RATIO

/* Scores: before the first tree; of confidence 0; for ON; by how much more for incipient slip; rise in noise; for staying; smoothing of the mean, of energies of 80 ms, and while a flag is set; of a hold. */
#define SLIP_OFFSET $OFFSET
#define SLIP_LOWEST_SCORE $LOWEST_SCORE
#define SLIP_ON_SCORE $THRESHOLD
#define SLIP_INCIPIENT_RISE $INCIPIENT_RISE
#define SLIP_NOISE_RISE $NOISE_RISE
#define SLIP_STAY_SCORE $STAY_THRESHOLD
#define SLIP_MEAN_SMOOTHING $MEAN_SMOOTHING
#define SLIP_WEAK_SMOOTHING $WEAK_SMOOTHING
#define SLIP_HOLD_SMOOTHING $HOLD_SMOOTHING
#define SLIP_HOLD_SCORE $HOLD_SCORE

/* 1 if the tactile voltage falls with the force, -1 if it rises. */
#define SLIP_DIRECTION $DIRECTION

/* Features, trees, and comparisons of a tree from its root to a leaf. */
#define SLIP_COUNT $COUNT
#define SLIP_TREES $TREES
#define SLIP_DEPTH $DEPTH

/* Sampling rate for which all this was computed [Hz, mHz]. */
#define SLIP_SAMPLE_RATE_HZ $SAMPLE_RATE_HZ
#define SLIP_SAMPLE_RATE_MILLIHZ $SAMPLE_RATE_MILLIHZ

/* Converter of the design: bits, lower end of its range [V], step [V]. */
#define SLIP_ADC_BITS $ADC_BITS
#define SLIP_ADC_LOW_V $ADC_LOW_V
#define SLIP_ADC_STEP_V $ADC_STEP_V

/* Program that wrote this library. */
#define SLIP_VERSION "$VERSION"
