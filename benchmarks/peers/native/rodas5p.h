/* Rodas5P of G. Steinebach (BIT Numer. Math. 63, 27, 2023, doi:10.1007/s10543-023-00967-x): a linearly implicit method
   of order 5 with 8 stages, an embedded one of order 4, and dense output of order 4. Its coefficients, in the form of
   E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.7, eq. (7.25). */

#define STAGES 8
#define GAMMA 0.21193756319429014

/* Row i: what stage i adds of the stages before it. The last two stages begin where the one before ends. */
static const double A[6][5] = {
    {0},
    {3.0},
    {2.849394379747939, 0.45842242204463923},
    {-6.954028509809101, 2.489845061869568, -10.358996098473584},
    {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946},
};
static const double C[STAGES][7] = {
    {0},
    {-14.155112264123755},
    {-17.97296035885952, -2.859693295451294},
    {147.12150275711716, -1.41221402718213, 71.68940251302358},
    {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
    {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471},
    {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
     -28.087943162872662},
    {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
     -54.66780262877968, -9.48861652309627},
};
static const double AT[STAGES] = {0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664,
                                  1, 1, 1};
static const double D[STAGES] = {0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734,
                                 2.325825639765069};
/* Dense output. */
static const double H[3][STAGES] = {
    {25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
     1.1241088310450404, 0.4272876194431874, -0.17202221070155493},
    {-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
     15.98066361424651, -6.789040303419874, -6.710236069923372},
    {11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
     -59.78993625266729, -0.15582684282751913, 4.883087185713722},
};

/* Decompose 1 / (h gamma) - J with row exchanges; returns 1 where it is singular. */
static int decompose(double h, const double *J, double M[STATES][STATES], int rows[STATES])
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++) M[i][j] = (i == j) / (h * GAMMA) - J[j * STATES + i];
    for (int k = 0; k < STATES; k++) {
        int best = k;
        for (int i = k + 1; i < STATES; i++)
            if (fabs(M[i][k]) > fabs(M[best][k])) best = i;
        rows[k] = best;
        if (M[best][k] == 0) return 1;
        for (int j = 0; j < STATES; j++) {
            double kept = M[k][j];
            M[k][j] = M[best][j];
            M[best][j] = kept;
        }
        for (int i = k + 1; i < STATES; i++) {
            M[i][k] /= M[k][k];
            for (int j = k + 1; j < STATES; j++) M[i][j] -= M[i][k] * M[k][j];
        }
    }
    return 0;
}

static void solve_linear(double M[STATES][STATES], const int rows[STATES], double *b)
{
    for (int k = 0; k < STATES; k++) {
        double kept = b[k];
        b[k] = b[rows[k]];
        b[rows[k]] = kept;
    }
    for (int i = 1; i < STATES; i++)
        for (int j = 0; j < i; j++) b[i] -= M[i][j] * b[j];
    for (int i = STATES - 1; i >= 0; i--) {
        for (int j = i + 1; j < STATES; j++) b[i] -= M[i][j] * b[j];
        b[i] /= M[i][i];
    }
}

/* One step from t and s: the stages u and the new state; returns 1 where the matrix is singular. */
static int step(const Problem *problem, double t, double h, const double *s, const double *J, const double *over_time,
                double u[STAGES][STATES], double *after)
{
    double M[STATES][STATES];
    int rows[STATES];
    if (decompose(h, J, M, rows)) return 1;
    for (int k = 0; k < STAGES; k++) {
        double point[STATES], out[STATES];
        for (int i = 0; i < STATES; i++) {
            point[i] = k > 5 ? after[i] + u[k - 1][i] : s[i];
            for (int j = 0; k < 6 && j < k; j++) point[i] += A[k][j] * u[j][i];
        }
        memcpy(after, point, sizeof point);
        rates(problem, t + AT[k] * h, point, out);
        for (int i = 0; i < STATES; i++) {
            u[k][i] = out[i] + h * D[k] * over_time[i];
            for (int j = 0; j < k; j++) u[k][i] += C[k][j] / h * u[j][i];
        }
        solve_linear(M, rows, u[k]);
    }
    for (int i = 0; i < STATES; i++) after[i] += u[STAGES - 1][i];
    return 0;
}

/* Error of a step as a share of the tolerance: the root mean square over the states. */
static double step_error(const Run *run, const double *s, const double *after, const double *estimate)
{
    double sum = 0;
    for (int i = 0; i < STATES; i++) {
        double share = estimate[i] / (run->absolute[i] + run->relative * fmax(fabs(s[i]), fabs(after[i])));
        sum += share * share;
    }
    return sqrt(sum / STATES);
}

static void interpolate(double share, const double *s, const double *after, double u[STAGES][STATES], double *out)
{
    for (int i = 0; i < STATES; i++) {
        double k[3] = {0, 0, 0};
        for (int j = 0; j < STAGES; j++)
            for (int row = 0; row < 3; row++) k[row] += H[row][j] * u[j][i];
        double bend = k[0] + share * (k[1] + share * k[2]);
        out[i] = (1 - share) * s[i] + share * (after[i] + (1 - share) * bend);
    }
}

/* With run->option above 0, steps are equal, so many from corner to corner, and no error is looked at. */
static int integrate(Problem *problem, const Run *run, double *states)
{
    double s[STATES], after[STATES], J[STATES * STATES], over_time[STATES], u[STAGES][STATES], t = 0, h = 1e-6;
    int sample = 0;
    long count = 0;
    memcpy(s, run->start, sizeof s);
    for (int i = 0; i < run->corners; i++) {
        begin_segment(problem, i);
        double end = run->last[i] / run->rate_hz;
        if (run->option) h = (end - t) / run->option;
        int is_new = 1, grown = 1;
        while (sample < run->last[i]) {
            if (count++ > MAX_STEPS) return -2;
            if (run->longest_s > 0) h = fmin(h, run->longest_s);
            int is_last = t + h >= end * (1 - 1e-14);
            double taken = is_last ? end - t : h;
            if (taken <= 1e-16) return -3;
            if (is_new) {
                memset(J, 0, sizeof J);
                jacobian(problem, t, s, J);
                rates_over_time(problem, t, s, over_time);
            }
            if (step(problem, t, taken, s, J, over_time, u, after)) return -4;
            double error = run->option ? 0 : step_error(run, s, after, u[STAGES - 1]);
            if (!isfinite(error)) error = 1e10;
            if (!run->option) {
                double factor = fmin(grown ? 6 : 1, fmax(0.2, 0.9 * pow(error + 1e-30, -0.2)));
                if (!is_last || factor < 1) h = taken * factor;
            }
            is_new = grown = error <= 1;
            if (!is_new) continue;
            double after_s = is_last ? end : t + taken;
            while (sample + 1 < run->last[i] && (sample + 1) / run->rate_hz <= after_s) {
                sample++;
                interpolate((sample / run->rate_hz - t) / taken, s, after, u, states + sample * STATES);
            }
            if (is_last) memcpy(states + ++sample * STATES, after, sizeof after);
            memcpy(s, after, sizeof s);
            t = after_s;
        }
    }
    return 0;
}
