/* RADAU of E. Hairer and G. Wanner (J. Comput. Appl. Math. 111, 1999, doi:10.1016/S0377-0427(99)00134-X): Radau IIA
   methods of 3, 5 or 7 stages. With run->option 3, it keeps to 3 stages: RADAU5. The library is their Fortran. */

#define STAGES 7

typedef struct {
    Problem *problem;
    const Run *run;
    double *states;
    int sample, end; /* the last sample written, and that of the next corner */
} Call;

typedef void Rates(const int *n, const double *t, const double *s, double *out, Call *call, int *unused);
typedef void Jacobian(const int *n, const double *t, const double *s, double *J, const int *rows, Call *call,
                      int *unused);
typedef void Output(const int *step, const double *before, const double *t, const double *s, const double *dense,
                    const int *length, const int *n, Call *call, int *unused, int *stop);

extern void radau_(const int *n, Rates *, double *t, double *s, const double *end, double *h, const double *relative,
                   const double *absolute, const int *vectors, Jacobian *, const int *given, const int *rows_below,
                   const int *rows_above, void *mass, const int *has_mass, const int *mass_below, const int *mass_above,
                   Output *, const int *has_output, double *work, const int *work_length, int *integers,
                   const int *integers_length, Call *, int *unused, int *answer, char *message, size_t message_length);
extern double contra_(const int *state, const double *t, const double *dense, const int *length);

static void call_rates(const int *n, const double *t, const double *s, double *out, Call *call, int *unused)
{
    rates(call->problem, *t, s, out);
}

static void call_jacobian(const int *n, const double *t, const double *s, double *J, const int *rows, Call *call,
                          int *unused)
{
    memset(J, 0, STATES * STATES * sizeof(double));
    jacobian(call->problem, *t, s, J);
}

static void write_samples(const int *step, const double *before, const double *t, const double *s, const double *dense,
                          const int *length, const int *n, Call *call, int *unused, int *stop)
{
    while (call->sample + 1 < call->end) {
        double next = (call->sample + 1) / call->run->rate_hz;
        if (next > *t) return;
        call->sample++;
        for (int i = 1; i <= STATES; i++)
            call->states[call->sample * STATES + i - 1] = contra_(&i, &next, dense, length);
    }
}

static int integrate(Problem *problem, const Run *run, double *states)
{
    enum { WORK = (STAGES + 1) * STATES * STATES + (3 * STAGES + 3) * STATES + 20, INTEGERS = 5 * STATES + 20 };
    const int n = STATES, yes = 1, no = 0, work_length = WORK, integers_length = INTEGERS;
    double work[WORK], relative[STATES], s[STATES], t = 0, h = 0;
    int integers[INTEGERS], unused = 0, answer = 1;
    char message[1024];
    Call call = {problem, run, states, 0, 0};
    memcpy(s, run->start, sizeof s);
    for (int i = 0; i < STATES; i++) relative[i] = run->relative;
    for (int i = 0; i < run->corners && answer > 0; i++) {
        begin_segment(problem, i);
        memset(work, 0, sizeof work);
        memset(integers, 0, sizeof integers);
        integers[1] = MAX_STEPS;
        integers[10] = integers[11] = run->option; /* least and most stages; 0: 3 to 7 */
        work[6] = run->longest_s;
        call.end = run->last[i];
        double end = run->last[i] / run->rate_hz;
        radau_(&n, call_rates, &t, s, &end, &h, relative, run->absolute, &yes, call_jacobian, &yes, &n, &n, NULL, &no,
               &n, &n, write_samples, &yes, work, &work_length, integers, &integers_length, &call, &unused, &answer,
               message, sizeof message);
        memcpy(states + call.end * STATES, s, sizeof s);
        call.sample = call.end;
    }
    return answer < 0 ? answer : 0;
}
