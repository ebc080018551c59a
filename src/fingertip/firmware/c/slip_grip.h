/* Grip law of fingertip, in C99: hold, tighten on slip, discard what comes while the forces grow.
 *
 * Call slip_grip_step once in each control period of the hand, every 5 to 20 ms, with what the fingers showed since the
 * last call. `added_m` then holds what each finger is to close beyond what the hand plans. The operations and their order
 * are those of fingertip's Python (fingertip.sim.runs.grip), in single precision.
 */
#ifndef SLIP_GRIP_H
#define SLIP_GRIP_H

#include "slip_detector.h"

/* Stiffness of the hand behind the pad [N/m]: how much force a way of the fingertip adds. THIS IS AN ASSUMPTION of the
 * simulation, for a soft hand. Measure yours, and define it for the whole program: in a stiffer hand the same way adds as
 * many times more force. */
#ifndef SLIP_BACKING_N_PER_M
#include "slip_grip_backing.h"
#endif

/* Speed at which a command grows [m/s]. A finger stops when its measured force comes to SLIP_GRIP_MAX_FORCE_N, but a
 * command that is ahead of its motor goes on until the motor is there: define the speed of your motors. */
#ifndef SLIP_GRIP_MAX_COMMAND_M_S
#include "slip_grip_command.h"
#endif

#include "slip_grip_constants.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a finger showed in a control period. */
typedef struct slip_grip_input {
    float tactile_v; /* mean tactile voltage [V] */
    float closing_m; /* present way of the fingertip, as the encoder of its motor shows it [m] */
} slip_grip_input;

/* Forces and closings at a time. */
typedef struct slip_grip_moment {
    uint32_t time_us;
    float force_n[SLIP_FINGERS], closing_m[SLIP_FINGERS];
} slip_grip_moment;

/* State of the law. `added_m`, `is_suppressed` and `has_tightened` are read after a step. */
typedef struct slip_grip {
    float added_m[SLIP_FINGERS];  /* closing that detections have added to what the hand plans [m] */
    float target_m[SLIP_FINGERS]; /* where it goes, as fast as the limit allows [m] */
    slip_grip_moment moments[SLIP_GRIP_HISTORY];
    uint32_t last_us, since_growth_us, since_tightening_us; /* UINT32_MAX: long ago */
    uint8_t first, count;
    bool is_started, is_suppressed, has_tightened;
    volatile bool is_late; /* the watchdog found no step */
} slip_grip;

/* Prepare the law. */
void slip_grip_init(slip_grip *grip);

/* Advance to a time [us], which may overflow, with an input for each finger, and return whether the fingers tighten.
 * `on` holds bit i where the detector of finger i was ON since the last step, `usable` where its inputs can be trusted: a
 * finger without that bit neither counts nor tightens. */
bool slip_grip_step(slip_grip *grip, uint32_t now_us, unsigned on, unsigned usable, const slip_grip_input *inputs);

/* Take back what was added, no faster than commands grow, in the steps that follow. */
void slip_grip_release(slip_grip *grip);

/* Return whether the law was called within the time of the watchdog. Call it often, as in the interrupt of the motors; it
 * stays false until the next step. A motor whose law is not alive holds its place. */
bool slip_grip_is_alive(slip_grip *grip, uint32_t now_us);

/* Return the force that a tactile voltage of a finger means [N], by the curve of its sensor. */
float slip_force_n(unsigned finger, float tactile_v);

/* Return that force with the ends of its interval: of the calibrated sensor, or of a typical one, from which real ones
 * differ. The lower end counts the hysteresis; beyond the forces that are known, an end is 0 or infinite. */
float slip_force_interval_n(unsigned finger, float tactile_v, float *low_n, float *high_n);

#ifdef __cplusplus
}
#endif

#endif
