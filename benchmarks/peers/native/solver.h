/* What a problem of the benchmark gives to a solver, and what a solver gives back.

   A problem defines STATES and struct Problem, includes this file, defines the functions below, and includes the solver
   (SOLVER, a name on the compiler's command line), which defines `integrate`. */

#ifndef FINGERTIP_SOLVER_H
#define FINGERTIP_SOLVER_H

#include <math.h>
#include <stddef.h>
#include <string.h>
#include <time.h>

/* Maximum number of steps of one integration. */
#define MAX_STEPS 1000000

typedef struct Problem Problem;

/* Number of calls of `rates`, which counts them. */
static long evaluations;

/* Integration from corner to corner of the input. The corners are last[i], numbers of samples. At a corner a solver
   starts afresh if restart is not 0; else it only does not step over it. No step is longer than longest_s, if that is
   above 0. */
typedef struct {
    const int *last;
    int corners, restart, option;
    double rate_hz, longest_s;
    const double *start;
    double relative;
    const double *absolute;
} Run;

/* Begin the part of the input behind corner i - 1. */
static void begin_segment(Problem *problem, int i);
static void rates(const Problem *problem, double t, const double *s, double *out);
/* Derivative of rate i with respect to state j, in J[j * STATES + i]; J holds zeros before. */
static void jacobian(const Problem *problem, double t, const double *s, double *J);
/* Derivative of the rates with respect to time. */
static void rates_over_time(const Problem *problem, double t, const double *s, double *out);

/* Write the states at all samples behind the first; returns 0, or the solver's error. */
static int integrate(Problem *problem, const Run *run, double *states);

/* Integrate, and measure its cost: processor time [s], so that neither Python nor preparations count, and evaluations. */
static int measure(Problem *problem, const Run *run, double *states, double *cost)
{
    struct timespec begin, end;
    memcpy(states, run->start, STATES * sizeof(double));
    evaluations = 0;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    int failed = integrate(problem, run, states);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    cost[0] = end.tv_sec - begin.tv_sec + 1e-9 * (end.tv_nsec - begin.tv_nsec);
    cost[1] = evaluations;
    return failed;
}

#endif
