/* The benchmark's board for CVODE: filter, diode with a series resistance, and envelope (variant article). */

#include "integrate.h"

#define PI 3.14159265358979323846

/* Values of the circuit, in the order in which Python passes them. */
typedef struct {
    double gain, t1, t3, r2, r3, c2, nvt, saturation, series, r, c;
} Parameters;

/* Input: samples that straight lines join, or, without samples, a burst of a sine on a constant. */
typedef struct {
    const Parameters *parameters;
    const double *voltage_v;
    int samples;
    double rate_hz;
    double constant_v, amplitude_v, frequency_hz;
    int in_burst;
} Problem;

/* Wright's omega function; same method as in fingertip/sim/signal/envelope_loop.py. */
static double wright_omega(double y)
{
    double w;
    if (y < -40) return exp(y);
    if (y < -2) {
        w = exp(y);
        w = w * (1 - w * (1 - 1.5 * w));
    } else if (y < 1) {
        w = exp(2 * (y - 1) / 3);
    } else {
        w = log(y);
        w = y - w + w / y;
    }
    for (int i = 0; i < 2; i++) {
        double r = y - w - log(w), s = 1 + w, t = 2 * s * (s + 2 * r / 3);
        w = w * (1 + r / s * (t - r) / (t - 2 * r));
    }
    return w;
}

static double input_v(const Problem *problem, double t)
{
    if (!problem->voltage_v)
        return problem->constant_v
            + (problem->in_burst ? problem->amplitude_v * sin(2 * PI * problem->frequency_hz * t) : 0);
    int i = (int)(t * problem->rate_hz);
    if (i > problem->samples - 2) i = problem->samples - 2;
    const double *u = problem->voltage_v + i;
    return u[0] + (u[1] - u[0]) * (t * problem->rate_hz - i);
}

static int rates(sunrealtype t, N_Vector state, N_Vector result, void *data)
{
    const Problem *problem = data;
    const Parameters *p = problem->parameters;
    const double *s = N_VGetArrayPointer(state);
    double *out = N_VGetArrayPointer(result);
    double first = input_v(problem, t) - s[0], n = p->gain * first - s[1] - s[2];
    double rho = p->series / p->nvt;
    double exponent = log(rho * p->saturation) + rho * p->saturation + (n - s[3]) / p->nvt;
    out[0] = first / p->t1;
    out[1] = (n / p->r3 + s[2] / p->r2) / p->c2;
    out[2] = n / p->t3;
    out[3] = (wright_omega(exponent) / rho - p->saturation - s[3] / p->r) / p->c;
    return 0;
}

static int jacobian(sunrealtype t, N_Vector state, N_Vector unused, SUNMatrix J, void *data, N_Vector a, N_Vector b,
                    N_Vector c)
{
    const Problem *problem = data;
    const Parameters *p = problem->parameters;
    const double *s = N_VGetArrayPointer(state);
    double n = p->gain * (input_v(problem, t) - s[0]) - s[1] - s[2];
    double rho = p->series / p->nvt;
    double w = wright_omega(log(rho * p->saturation) + rho * p->saturation + (n - s[3]) / p->nvt);
    double slope = w / (1 + w) / p->series;
    SM_ELEMENT_D(J, 0, 0) = -1 / p->t1;
    SM_ELEMENT_D(J, 1, 0) = -p->gain / p->r3 / p->c2;
    SM_ELEMENT_D(J, 1, 1) = -1 / p->r3 / p->c2;
    SM_ELEMENT_D(J, 1, 2) = (1 / p->r2 - 1 / p->r3) / p->c2;
    SM_ELEMENT_D(J, 2, 0) = -p->gain / p->t3;
    SM_ELEMENT_D(J, 2, 1) = SM_ELEMENT_D(J, 2, 2) = -1 / p->t3;
    SM_ELEMENT_D(J, 3, 0) = -p->gain * slope / p->c;
    SM_ELEMENT_D(J, 3, 1) = SM_ELEMENT_D(J, 3, 2) = -slope / p->c;
    SM_ELEMENT_D(J, 3, 3) = -(slope + 1 / p->r) / p->c;
    return 0;
}

/* Integrate from corner to corner of the input, and write the envelope at the samples.

   The corners are last[i], numbers of samples. Samples are given by voltage_v, or voltage_v is NULL and source holds
   constant [V], amplitude [V] and frequency [Hz] of a burst between the first corner and the second. At a corner CVODE
   starts afresh if restart is not 0; else it only does not step over it. Returns 0, or CVODE's error. */
int solve_board(const double *parameters, const double *voltage_v, const double *source, const int *last, int corners,
                int restart, double longest_s, double rate_hz, const double *start, double relative,
                const double *absolute, double *envelope_v, double *cpu_s)
{
    int samples = last[corners - 1] + 1;
    Problem problem = {(const Parameters *)parameters, voltage_v, samples, rate_hz, source[0], source[1], source[2], 0};
    Solver solver;
    if (open_solver(&solver, 4, start, relative, absolute, rates, jacobian, &problem)) return 1;
    int sample = 0, failed = longest_s > 0 ? CVodeSetMaxStep(solver.cvode, longest_s) : 0;
    double t;
    double begin_s = process_s();
    const double *u = N_VGetArrayPointer(solver.state);
    envelope_v[0] = u[3];
    for (int i = 0; i < corners && failed >= 0; i++) {
        problem.in_burst = i == 1;
        if (restart) failed = CVodeReInit(solver.cvode, sample / rate_hz, solver.state);
        if (failed >= 0) failed = CVodeSetStopTime(solver.cvode, last[i] / rate_hz);
        while (failed >= 0 && sample < last[i]) {
            sample++;
            failed = CVode(solver.cvode, sample / rate_hz, solver.state, &t, CV_NORMAL);
            envelope_v[sample] = u[3];
        }
    }
    *cpu_s = process_s() - begin_s;
    close_solver(&solver);
    return failed < 0 ? failed : 0;
}
