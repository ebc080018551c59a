/* CVODE set up as both problems of the benchmark use it: BDF, Newton iterations, a dense matrix, an analytic Jacobian.

   The caller's processor time of the calls to CVODE is measured here, so that neither Python nor the setup counts. */

#ifndef FINGERTIP_INTEGRATE_H
#define FINGERTIP_INTEGRATE_H

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

#if SUNDIALS_VERSION_MAJOR < 6
#error "the benchmark needs SUNDIALS 6 or newer"
#endif
#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL NULL
#endif

/* Maximum number of steps between two outputs. */
#define MAX_STEPS 1000000

/* A solver with its vectors and its matrix. */
typedef struct {
    SUNContext context;
    N_Vector state, tolerance;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    void *cvode;
} Solver;

static double process_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

/* Set a solver up at time 0; returns 0, or a number that is not 0 where SUNDIALS refuses. */
static int open_solver(Solver *solver, int states, const double *start, double relative, const double *absolute,
                       CVRhsFn rates, CVLsJacFn jacobian, void *problem)
{
    if (SUNContext_Create(SUN_COMM_NULL, &solver->context)) return 1;
    solver->state = N_VNew_Serial(states, solver->context);
    solver->tolerance = N_VNew_Serial(states, solver->context);
    solver->matrix = SUNDenseMatrix(states, states, solver->context);
    solver->linear = SUNLinSol_Dense(solver->state, solver->matrix, solver->context);
    solver->cvode = CVodeCreate(CV_BDF, solver->context);
    if (!solver->cvode) return 1;
    for (int i = 0; i < states; i++) {
        N_VGetArrayPointer(solver->state)[i] = start[i];
        N_VGetArrayPointer(solver->tolerance)[i] = absolute[i];
    }
    return CVodeInit(solver->cvode, rates, 0.0, solver->state)
        || CVodeSVtolerances(solver->cvode, relative, solver->tolerance)
        || CVodeSetUserData(solver->cvode, problem)
        || CVodeSetLinearSolver(solver->cvode, solver->linear, solver->matrix)
        || CVodeSetJacFn(solver->cvode, jacobian)
        || CVodeSetMaxNumSteps(solver->cvode, MAX_STEPS);
}

static void close_solver(Solver *solver)
{
    CVodeFree(&solver->cvode);
    SUNLinSolFree(solver->linear);
    SUNMatDestroy(solver->matrix);
    N_VDestroy(solver->tolerance);
    N_VDestroy(solver->state);
    SUNContext_Free(&solver->context);
}

#endif
