/* CVODE: BDF, Newton iterations, a dense matrix, an analytic Jacobian. */

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#if SUNDIALS_VERSION_MAJOR < 6
#error "the benchmark needs SUNDIALS 6 or newer"
#endif
#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL NULL
#endif

static int call_rates(sunrealtype t, N_Vector state, N_Vector result, void *problem)
{
    rates(problem, t, N_VGetArrayPointer(state), N_VGetArrayPointer(result));
    return 0;
}

static int call_jacobian(sunrealtype t, N_Vector state, N_Vector unused, SUNMatrix J, void *problem, N_Vector a,
                         N_Vector b, N_Vector c)
{
    jacobian(problem, t, N_VGetArrayPointer(state), SUNDenseMatrix_Data(J)); /* SUNDIALS fills it with zeros */
    return 0;
}

static int advance(void *cvode, Problem *problem, const Run *run, N_Vector state, double *states)
{
    const double *u = N_VGetArrayPointer(state);
    int sample = 0, failed = run->longest_s > 0 ? CVodeSetMaxStep(cvode, run->longest_s) : 0;
    double t;
    for (int i = 0; i < run->corners && failed >= 0; i++) {
        begin_segment(problem, i);
        if (run->restart) failed = CVodeReInit(cvode, sample / run->rate_hz, state);
        if (failed >= 0) failed = CVodeSetStopTime(cvode, run->last[i] / run->rate_hz);
        while (failed >= 0 && sample < run->last[i]) {
            sample++;
            failed = CVode(cvode, sample / run->rate_hz, state, &t, CV_NORMAL);
            memcpy(states + sample * STATES, u, STATES * sizeof(double));
        }
    }
    return failed < 0 ? failed : 0;
}

static int integrate(Problem *problem, const Run *run, double *states)
{
    SUNContext context;
    if (SUNContext_Create(SUN_COMM_NULL, &context)) return 1;
    N_Vector state = N_VNew_Serial(STATES, context), tolerance = N_VNew_Serial(STATES, context);
    SUNMatrix matrix = SUNDenseMatrix(STATES, STATES, context);
    SUNLinearSolver linear = SUNLinSol_Dense(state, matrix, context);
    void *cvode = CVodeCreate(CV_BDF, context);
    memcpy(N_VGetArrayPointer(state), run->start, STATES * sizeof(double));
    memcpy(N_VGetArrayPointer(tolerance), run->absolute, STATES * sizeof(double));
    int failed = CVodeInit(cvode, call_rates, 0.0, state) || CVodeSVtolerances(cvode, run->relative, tolerance)
        || CVodeSetUserData(cvode, problem) || CVodeSetLinearSolver(cvode, linear, matrix)
        || CVodeSetJacFn(cvode, call_jacobian) || CVodeSetMaxNumSteps(cvode, MAX_STEPS);
    if (!failed) failed = advance(cvode, problem, run, state, states);
    CVodeFree(&cvode);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(tolerance);
    N_VDestroy(state);
    SUNContext_Free(&context);
    return failed;
}

void read_version(char *text, int length) { SUNDIALSGetVersion(text, length); }
