/* The benchmark's contact for CVODE; equations in fingertip/sim/contact/coupled.py, for a pad that keeps contact. */

#include "integrate.h"

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

typedef struct {
    const Parameters *parameters;
    const Drive *drive;
} Problem;

static int rates(sunrealtype t, N_Vector state, N_Vector result, void *data)
{
    const Parameters *p = ((Problem *)data)->parameters;
    const Drive *drive = ((Problem *)data)->drive;
    const double *u = N_VGetArrayPointer(state);
    double *out = N_VGetArrayPointer(result);
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
    return 0;
}

static int jacobian(sunrealtype t, N_Vector state, N_Vector unused, SUNMatrix J, void *data, N_Vector a, N_Vector b,
                    N_Vector c)
{
    const Parameters *p = ((Problem *)data)->parameters;
    const double *u = N_VGetArrayPointer(state);
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
    SM_ELEMENT_D(J, 0, 1) = 1;
    SM_ELEMENT_D(J, 1, 0) = -p->k / p->m;
    SM_ELEMENT_D(J, 1, 1) = -(p->c + y * (p->s1 * scale * rate_v + p->s2)) / p->m;
    SM_ELEMENT_D(J, 1, 2) = -flow * (p->s0 + p->s1 * rate_s) / p->m;
    SM_ELEMENT_D(J, 1, 3) = -(mu + y * mu_y) / p->m;
    SM_ELEMENT_D(J, 2, 1) = rate_v;
    SM_ELEMENT_D(J, 2, 2) = rate_s;
    SM_ELEMENT_D(J, 2, 3) = rate_y;
    SM_ELEMENT_D(J, 3, 4) = 1;
    SM_ELEMENT_D(J, 4, 3) = -p->w2;
    SM_ELEMENT_D(J, 4, 4) = -p->damp;
    return 0;
}

/* Integrate from corner to corner, and write position and compression at the samples.

   The number of drives is that of the corners; drive i ends at sample last[i]. Returns 0, or CVODE's error. */
int solve_contact(const double *parameters, const double *drives, const int *last, int corners, double rate_hz,
                  const double *start, double relative, const double *absolute, double *position_m,
                  double *compression_n, double *cpu_s)
{
    Problem problem = {(const Parameters *)parameters, (const Drive *)drives};
    Solver solver;
    if (open_solver(&solver, 5, start, relative, absolute, rates, jacobian, &problem)) return 1;
    int sample = 0, failed = 0;
    double t;
    double begin_s = process_s();
    const double *u = N_VGetArrayPointer(solver.state);
    position_m[0] = u[0];
    compression_n[0] = u[3];
    for (int i = 0; i < corners && failed >= 0; i++) {
        problem.drive = (const Drive *)drives + i;
        failed = CVodeReInit(solver.cvode, sample / rate_hz, solver.state);
        if (!failed) failed = CVodeSetStopTime(solver.cvode, last[i] / rate_hz);
        while (failed >= 0 && sample < last[i]) {
            sample++;
            failed = CVode(solver.cvode, sample / rate_hz, solver.state, &t, CV_NORMAL);
            position_m[sample] = u[0];
            compression_n[sample] = u[3];
        }
    }
    *cpu_s = process_s() - begin_s;
    close_solver(&solver);
    return failed < 0 ? failed : 0;
}
