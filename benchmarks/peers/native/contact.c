/* The benchmark's contact; equations in fingertip/sim/contact/dragged_pad.py, for a pad that keeps contact. */

#define STATES 5
#include "solver.h"

/* Surface, mount and normal resonance, in the order in which Python passes them. */
typedef struct {
    double mu_c, drop, stribeck_m_s, s0, s1, s2, load_scale_n; /* drop = mu_s - mu_c */
    double m, k, c;
    double w2, damp; /* of the normal direction: omega^2, and 2 zeta omega */
} Parameters;

/* Drive from one corner to the next: velocity and load are linear in time. */
typedef struct {
    double begin_s, carriage_m, carriage_m_s, carriage_m_s2, load_n, load_n_s;
} Drive;

struct Problem {
    const Parameters *parameters;
    const Drive *drives, *drive;
};

static void begin_segment(Problem *problem, int i) { problem->drive = problem->drives + i; }

static void rates(const Problem *problem, double t, const double *u, double *out)
{
    evaluations++;
    const Parameters *p = problem->parameters;
    const Drive *drive = problem->drive;
    double T = t - drive->begin_s, x = u[0], v = u[1], s = u[2], y = u[3], w = u[4];
    double X = drive->carriage_m + T * (drive->carriage_m_s + T * drive->carriage_m_s2 / 2);
    double V = drive->carriage_m_s + T * drive->carriage_m_s2;
    double ratio = v / p->stribeck_m_s, g = p->mu_c + p->drop / (1 + ratio * ratio);
    double scale = 1 / sqrt(y + p->load_scale_n), z = scale * s;
    double rate = y * scale * (v - p->s0 * fabs(v) * z / g);
    out[0] = v;
    out[1] = (p->k * (X - x) + p->c * (V - v) - y * (p->s0 * z + p->s1 * scale * rate + p->s2 * v)) / p->m;
    out[2] = rate;
    out[3] = w;
    out[4] = p->w2 * (drive->load_n + T * drive->load_n_s - y) - p->damp * w;
}

static void jacobian(const Problem *problem, double t, const double *u, double *J)
{
    const Parameters *p = problem->parameters;
    double v = u[1], s = u[2], y = u[3];
    double scale = 1 / sqrt(y + p->load_scale_n), z = scale * s, flow = y * scale, scale_y = -scale * scale * scale / 2;
    double ratio = v / p->stribeck_m_s, bottom = 1 + ratio * ratio, g = p->mu_c + p->drop / bottom;
    double dg = -2 * p->drop * ratio / (p->stribeck_m_s * bottom * bottom);
    double yields = -p->s0 * fabs(v) / g, bends = v + yields * z;
    double bends_v = 1 - p->s0 * z * ((v >= 0 ? 1.0 : -1.0) - fabs(v) * dg / g) / g;
    double rate = flow * bends, rate_v = flow * bends_v, rate_s = flow * scale * yields;
    double rate_y = (scale + y * scale_y) * bends + flow * yields * scale_y * s;
    double mu = p->s0 * z + p->s1 * scale * rate + p->s2 * v;
    double mu_y = p->s0 * scale_y * s + p->s1 * (scale_y * rate + scale * rate_y);
    J[1 * STATES + 0] = 1;
    J[0 * STATES + 1] = -p->k / p->m;
    J[1 * STATES + 1] = -(p->c + y * (p->s1 * scale * rate_v + p->s2)) / p->m;
    J[2 * STATES + 1] = -flow * (p->s0 + p->s1 * rate_s) / p->m;
    J[3 * STATES + 1] = -(mu + y * mu_y) / p->m;
    J[1 * STATES + 2] = rate_v;
    J[2 * STATES + 2] = rate_s;
    J[3 * STATES + 2] = rate_y;
    J[4 * STATES + 3] = 1;
    J[3 * STATES + 4] = -p->w2;
    J[4 * STATES + 4] = -p->damp;
}

static void rates_over_time(const Problem *problem, double t, const double *u, double *out)
{
    const Parameters *p = problem->parameters;
    const Drive *drive = problem->drive;
    double V = drive->carriage_m_s + (t - drive->begin_s) * drive->carriage_m_s2;
    memset(out, 0, STATES * sizeof *out);
    out[1] = (p->k * V + p->c * drive->carriage_m_s2) / p->m;
    out[4] = p->w2 * drive->load_n_s;
}

#include SOLVER

/* Write the states at the samples. The number of drives is that of the corners; drive i ends at sample last[i]. */
int solve(const double *parameters, const double *drives, int unused, const Run *run, double *states, double *cost)
{
    Problem problem = {(const Parameters *)parameters, (const Drive *)drives, NULL};
    return measure(&problem, run, states, cost);
}
