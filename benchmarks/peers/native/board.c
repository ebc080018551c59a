/* The benchmark's board: filter, diode with a series resistance, and envelope (variant article). */

#define STATES 4
#include "solver.h"

#define PI 3.14159265358979323846

/* Values of the circuit, in the order in which Python passes them. */
typedef struct {
    double gain, t1, t3, r2, r3, c2, nvt, saturation, series, r, c;
} Parameters;

/* Input: samples that straight lines join, or, if samples is 0, a burst of a sine on a constant between the first corner
   and the second: constant [V], amplitude [V] and frequency [Hz]. */
struct Problem {
    const Parameters *parameters;
    const double *input;
    int samples, is_stepwise; /* a corner at each sample */
    double rate_hz;
    int segment;
};

static void begin_segment(Problem *problem, int i) { problem->segment = i; }

/* Wright's omega function; same method as in fingertip/sim/signal/envelope_loop.py. */
static double wright_omega(double y)
{
    double w;
    if (y < -40) return exp(y);
    if (y < -3) {
        w = exp(y);
        w = w * (1 - w * (1 - 1.5 * w));
    } else if (y < 1) {
        w = (0.567024 + 0.362221 * y)
            + y * y * ((0.0745859 - 0.00138001 * y) - y * y * (0.00250178 + 0.000251905 * y));
    } else {
        w = log(y);
        w = y - w + w / y;
    }
    for (int i = y < 1; i < 2; i++) {
        double r = y - w - log(w), s = 1 + w, t = 2 * s * (s + 2 * r / 3);
        w = w * (1 + r / s * (t - r) / (t - 2 * r));
    }
    return w;
}

/* Sample at which the line begins that holds at a time. */
static int line_at(const Problem *problem, double t)
{
    if (problem->is_stepwise) return problem->segment;
    int i = (int)(t * problem->rate_hz);
    return i < problem->samples - 2 ? i : problem->samples - 2;
}

static double input_v(const Problem *problem, double t)
{
    const double *u = problem->input;
    if (!problem->samples) return u[0] + (problem->segment == 1 ? u[1] * sin(2 * PI * u[2] * t) : 0);
    int i = line_at(problem, t);
    return u[i] + (u[i + 1] - u[i]) * (t * problem->rate_hz - i);
}

static double input_v_s(const Problem *problem, double t)
{
    const double *u = problem->input;
    if (!problem->samples) return problem->segment == 1 ? u[1] * 2 * PI * u[2] * cos(2 * PI * u[2] * t) : 0;
    int i = line_at(problem, t);
    return (u[i + 1] - u[i]) * problem->rate_hz;
}

/* Slope of the diode's current over the voltage across it and its resistance [A/V]; the current is written [A]. */
static double conduct(const Parameters *p, double voltage, double *current)
{
    double rho = p->series / p->nvt, shift = log(rho * p->saturation) + rho * p->saturation;
    double w = wright_omega(shift + voltage / p->nvt);
    *current = w / rho - p->saturation;
    return w / (1 + w) / p->series;
}

static void rates(const Problem *problem, double t, const double *s, double *out)
{
    evaluations++;
    const Parameters *p = problem->parameters;
    double current, first = input_v(problem, t) - s[0], n = p->gain * first - s[1] - s[2];
    conduct(p, n - s[3], &current);
    out[0] = first / p->t1;
    out[1] = (n / p->r3 + s[2] / p->r2) / p->c2;
    out[2] = n / p->t3;
    out[3] = (current - s[3] / p->r) / p->c;
}

static void jacobian(const Problem *problem, double t, const double *s, double *J)
{
    const Parameters *p = problem->parameters;
    double current, n = p->gain * (input_v(problem, t) - s[0]) - s[1] - s[2];
    double slope = conduct(p, n - s[3], &current);
    J[0 * STATES + 0] = -1 / p->t1;
    J[0 * STATES + 1] = -p->gain / p->r3 / p->c2;
    J[1 * STATES + 1] = -1 / p->r3 / p->c2;
    J[2 * STATES + 1] = (1 / p->r2 - 1 / p->r3) / p->c2;
    J[0 * STATES + 2] = -p->gain / p->t3;
    J[1 * STATES + 2] = J[2 * STATES + 2] = -1 / p->t3;
    J[0 * STATES + 3] = -p->gain * slope / p->c;
    J[1 * STATES + 3] = J[2 * STATES + 3] = -slope / p->c;
    J[3 * STATES + 3] = -(slope + 1 / p->r) / p->c;
}

static void rates_over_time(const Problem *problem, double t, const double *s, double *out)
{
    const Parameters *p = problem->parameters;
    double slope = input_v_s(problem, t), current, n = p->gain * (input_v(problem, t) - s[0]) - s[1] - s[2];
    out[0] = slope / p->t1;
    out[1] = p->gain * slope / p->r3 / p->c2;
    out[2] = p->gain * slope / p->t3;
    out[3] = p->gain * slope * conduct(p, n - s[3], &current) / p->c;
}

#include SOLVER

int solve(const double *parameters, const double *input, int samples, const Run *run, double *states, double *cost)
{
    Problem problem = {(const Parameters *)parameters, input, samples, run->corners == samples - 1, run->rate_hz, 0};
    return measure(&problem, run, states, cost);
}
