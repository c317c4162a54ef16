/* The model behind the functions of FMI: values by reference, the start, closed loops, and steps in time.

   x = (q, v):   q' = N v + beta,   v' = independent rows of q'',   Phi(q, t) = 0

   All memory is in one Model; there are no globals and nothing is allocated here. model.h is made for each mechanism:
   sizes, names, limits, and functions eval_<routine> around the kernels. */

#ifndef NULLBODY_CORE_H
#define NULLBODY_CORE_H

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model.h"

#define NX (NQ + NV)

#define SETTLED 1e-8           /* [m, rad] a Newton step this short leaves an error of its square */
#define LONGEST_CORRECTION 0.5 /* of a Newton step [m, rad]; longer ones are cut to stay on the branch */
#define LARGEST_CHANGE 0.15    /* [m, rad] from one point of a branch to the next */
#define SMALLEST_STEP 1e-4     /* of the way along a branch */
#define TIGHTEST 1e-13         /* relative tolerance below which rounding decides */
#define MOST_STEPS 100000      /* within one communication step */

/* Why something was refused. */
typedef enum {
    FINE,
    SINGULAR_INDEPENDENT_SET,
    SINGULAR_MASS_MATRIX,
    NOT_FINITE,
    LOOPS_OPEN,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
    BAD_PARAMETER,
    BAD_VALUE,
    BRANCH_ENDS,
    CLOSED_WRONG_WAY,
    NEVER_CLOSED
} Found;

typedef enum { INSTANTIATED, INITIALIZING, RUNNING, ENDED } Mode;

/* All that the future depends on: what FMI calls the state of the unit is a copy of this. */
typedef struct {
    double t, q[SIZE(NQ)], v[SIZE(NV)], u[SIZE(NU)], p[SIZE(NP)], low[SIZE(NU)], high[SIZE(NU)];
    double tolerance, drift, step, side;
    double watched; /* |N|^2 from which another chart is looked for */
    int chart;      /* the independent coordinates in use; v are their rates */
    int tolerance_given, guess_given, closed;
    Mode mode;
} Now;

typedef struct {
    Now now;
    int valid; /* which of the values below belong to `now` */
    double applied[SIZE(NU)];
    struct closure_values closure;
    struct redundant_values redundant;
    struct facing_values facing;
    struct closing_values closing;
    struct forward_dynamics_values forward;
    struct energy_values energy;
    struct reactions_values reactions;
    struct parameters_values parameters;
#if NCHARTS > 1
    struct kinematics_values kinematics;
#endif
    double k[7][NX], x[NX], trial[NX];
    char text[1024]; /* the last refusal in words */
} Model;

enum { FORWARD = 1, ENERGY = 2, REACTIONS = 4, GAP = 8 };

/* ---- small things ------------------------------------------------------------------------------------------- */

static inline int all_finite(const double *x, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(x[i])) return 0;
    }
    return 1;
}

static inline double largest(const double *x, int n)
{
    double found = 0.0;
    for (int i = 0; i < n; i++) {
        if (!(fabs(x[i]) <= found)) found = fabs(x[i]);
    }
    return found;
}

static inline double sign_of(double x)
{
    return (x > 0.0) - (x < 0.0);
}

static inline int is_independent(int chart, int j)
{
    for (int i = 0; i < NV; i++) {
        if (INDEPENDENT[chart][i] == j) return 1;
    }
    return 0;
}

/* The refusal in words, for the log; `about` names what it was. */
static inline Found refuse(Model *m, Found why, const char *about, double value)
{
    const double t = m->now.t;
    char *text = m->text;
    const size_t size = sizeof m->text;
    switch (why) {
    case SINGULAR_INDEPENDENT_SET:
        snprintf(text, size,
                 "SINGULAR_INDEPENDENT_SET at t = %.9g s: the independent coordinates %s become singular (|N| = %.3g, "
                 "|B| = %.3g), or the mechanism itself does. Export the unit again with other independent "
                 "coordinates, or more of them (charts), or stay away from this configuration",
                 t, INDEPENDENT_NAMES[m->now.chart], sqrt(m->forward.spread), m->forward.delta);
        break;
    case SINGULAR_MASS_MATRIX:
        snprintf(text, size,
                 "SINGULAR_MASS_MATRIX at t = %.9g s: the reduced mass matrix is singular, some motion moves no mass "
                 "or next to none. Check the masses and inertias",
                 t);
        break;
    case NOT_FINITE:
        snprintf(text, size, "NOT_FINITE at t = %.9g s: %s is not finite", t, about);
        break;
    case LOOPS_OPEN:
        snprintf(text, size,
                 "LOOPS_OPEN at t = %.9g s: the loops could not be closed, %s is open by %.3g. The start is not near "
                 "an assembly, or the motion reached a singularity",
                 t, about, value);
        break;
    case STEP_TOO_SMALL:
        snprintf(text, size,
                 "STEP_TOO_SMALL at t = %.9g s: the step became smaller than the spacing of numbers: the motion is "
                 "too stiff or not smooth. Loosen solver.tolerance",
                 t);
        break;
    case TOO_MANY_STEPS:
        snprintf(text, size,
                 "TOO_MANY_STEPS at t = %.9g s: more than %d steps within one communication step: the motion is "
                 "stiff. Loosen solver.tolerance, or use shorter communication steps",
                 t, MOST_STEPS);
        break;
    case BAD_PARAMETER:
        snprintf(text, size, "BAD_PARAMETER: parameter %s = %.9g is not finite, or not of the sign it must have",
                 about, value);
        break;
    case BAD_VALUE:
        snprintf(text, size, "BAD_VALUE: %s", about);
        break;
    case BRANCH_ENDS:
        snprintf(text, size,
                 "BRANCH_ENDS: for these parameters and coordinates the loops cannot be closed on the branch of the "
                 "exported start, which ends after %.1f hundredths of the way. Give start values of all coordinates, "
                 "or export the unit with these parameters",
                 100.0 * value);
        break;
    case CLOSED_WRONG_WAY:
        snprintf(text, size,
                 "CLOSED_WRONG_WAY: loop %s is closed with an axis against the other (cosine %.3g). Start nearer to "
                 "the wanted assembly",
                 about, value);
        break;
    case NEVER_CLOSED:
        snprintf(text, size,
                 "NEVER_CLOSED: for these parameters the loops can never close: an equation that no coordinate can "
                 "change is open by %.3g",
                 value);
        break;
    case FINE:
        text[0] = '\0';
        break;
    }
    return why;
}

/* ---- the equations ------------------------------------------------------------------------------------------ */

/* x' at constant inputs, or why it cannot be had; leaves the values in m->forward. */
static inline Found rates(Model *m, double t, const double *x, double *x_dot)
{
    const Now *now = &m->now;
    struct forward_dynamics_values *f = &m->forward;
    if (!all_finite(x, NX) || !all_finite(now->u, NU)) return NOT_FINITE;
    for (int i = 0; i < NU; i++) {
        const double u = now->u[i];
        m->applied[i] = u < now->low[i] ? now->low[i] : u > now->high[i] ? now->high[i] : u;
    }
    const struct At at = {.q = x, .v = x + NQ, .u = m->applied, .t = &t, .p = now->p};
    eval_forward_dynamics(now->chart, &at, f);
    if ((now->side != 0.0 && sign_of(f->delta) != now->side) || !(f->doubt < REGULAR_DOUBT) ||
        !(f->spread < SIMULATED_SPREAD)) {
        return SINGULAR_INDEPENDENT_SET;
    }
    if (!(fabs(f->loss) < REGULAR_LOSS) || !all_finite(f->q_ddot, NQ)) {
        return f->spread < LARGE_SPREAD ? SINGULAR_MASS_MATRIX : SINGULAR_INDEPENDENT_SET;
    }
    if (x_dot != NULL) {
        for (int i = 0; i < NQ; i++) x_dot[i] = f->q_dot[i];
        for (int i = 0; i < NV; i++) x_dot[NQ + i] = f->q_ddot[INDEPENDENT[now->chart][i]];
    }
    return FINE;
}

/* The largest |Phi|. */
static inline double gap(Model *m, double t, const double *q, const double *p)
{
    const struct At at = {.q = q, .t = &t, .p = p};
    if (NPHI == 0) return 0.0;
    eval_closure(&at, &m->closure);
    return largest(m->closure.Phi, NPHI);
}

/* |Phi| at which loops count as closed: 1e-14 m, or 32 roundings of the lengths where that is more. */
static inline double closed_to(const Model *m, const double *q)
{
    double longest = 0.0;
    for (int i = 0; i < NPHI; i++) {
        double length = 0.0;
        for (int j = 0; j < NQ; j++) length += fabs(m->closure.A[i * NQ + j]) * fmax(fabs(q[j]), 1.0);
        if (length > longest) longest = length;
    }
    return fmax(CLOSED, fmin(32.0 * DBL_EPSILON * longest, GIVEN_CLOSED));
}

/* Newton: close the loops with the independent coordinates held. Returns whether they are, at *q. */
static inline int close_loops(Model *m, double t, double *q, const double *p)
{
    const struct At at = {.q = q, .t = &t, .p = p};
    double open = gap(m, t, q, p);
    for (int step = 0; step < NEWTON_STEPS; step++) {
        if (open <= DBL_EPSILON) return 1;
        if (!isfinite(open)) return 0;
        eval_closing(m->now.chart, &at, &m->closing);
        const double length = largest(m->closing.correction, NQ);
        if (!isfinite(length)) return 0;
        const double part = length > LONGEST_CORRECTION ? LONGEST_CORRECTION / length : 1.0;
        for (int j = 0; j < NQ; j++) {
            if (!is_independent(m->now.chart, j)) q[j] += part * m->closing.correction[j];
        }
        open = gap(m, t, q, p);
        if (length <= SETTLED) break;
    }
    return open <= closed_to(m, q);
}

/* ---- the start ---------------------------------------------------------------------------------------------- */

/* Parameters that follow others by their formulas, and the limits of inputs. */
static inline Found settle_parameters(Model *m)
{
    Now *now = &m->now;
    const struct At at = {.p = now->p};
    eval_parameters(&at, &m->parameters);
    for (int i = 0; i < NP; i++) now->p[i] = m->parameters.p[i];
    for (int i = 0; i < NU; i++) {
        now->low[i] = m->parameters.low[i];
        now->high[i] = m->parameters.high[i];
    }
    for (int i = 0; i < NP; i++) {
        const double value = now->p[i];
        const int good = SIGN[i] == 0 || (SIGN[i] == 1 ? value > 0.0 : value >= 0.0);
        if (!isfinite(value) || !good) return refuse(m, BAD_PARAMETER, PARAMETER_NAMES[i], value);
    }
    return FINE;
}

/* Follow the branch of the exported start to other parameters, independent coordinates and times. */
static inline Found follow_branch(Model *m)
{
    Now *now = &m->now;
    double done = 0.0, step = 1.0, p[SIZE(NP)], q[SIZE(NQ)], here[SIZE(NQ)], side = 0.0;
    memcpy(here, START_Q, sizeof here);
    while (done < 1.0) {
        const double to = done + step < 1.0 ? done + step : 1.0;
        for (int i = 0; i < NP; i++) p[i] = START_P[i] + to * (now->p[i] - START_P[i]);
        for (int j = 0; j < NQ; j++) q[j] = is_independent(0, j) ? START_Q[j] + to * (now->q[j] - START_Q[j]) : here[j];
        const double t = START_T + to * (now->t - START_T);
        const int closed = close_loops(m, t, q, p);
        double moved = 0.0;
        for (int j = 0; j < NQ; j++) {
            if (!is_independent(0, j)) moved = fmax(moved, fabs(q[j] - here[j]));
        }
        const struct At at = {.q = q, .t = &t, .p = p};
        eval_closing(0, &at, &m->closing);
        if (!closed || moved > LARGEST_CHANGE || side * m->closing.delta < 0.0) {
            step *= 0.5;
            if (step < SMALLEST_STEP) return refuse(m, BRANCH_ENDS, "", done);
            continue;
        }
        side = sign_of(m->closing.delta);
        memcpy(here, q, sizeof here);
        done = to;
        step *= 2.0;
    }
    for (int j = 0; j < NQ; j++) {
        if (!is_independent(0, j)) now->q[j] = here[j];
    }
    return FINE;
}

/* Loops closed the right way round, and equations that no motion can mend. */
static inline Found check_assembly(Model *m)
{
    const struct At at = {.q = m->now.q, .t = &m->now.t, .p = m->now.p};
    if (NREDUNDANT > 0) {
        eval_redundant(&at, &m->redundant);
        const double open = largest(m->redundant.Phi, NREDUNDANT);
        if (!(open <= GIVEN_CLOSED)) return refuse(m, NEVER_CLOSED, "", open);
    }
    if (NFACING > 0) {
        eval_facing(&at, &m->facing);
        for (int i = 0; i < NFACING; i++) {
            const double cosine = m->facing.cosines[i];
            if (!(cosine > 0.0)) return refuse(m, CLOSED_WRONG_WAY, FACING_NAMES[i], cosine);
        }
    }
    return FINE;
}

static inline Found open_at(Model *m)
{
    int worst = 0;
    for (int i = 1; i < NPHI; i++) {
        if (!(fabs(m->closure.Phi[i]) <= fabs(m->closure.Phi[worst]))) worst = i;
    }
    return refuse(m, LOOPS_OPEN, NPHI > 0 ? CLOSURE_NAMES[worst] : "", NPHI > 0 ? m->closure.Phi[worst] : 0.0);
}

/* The start: parameters settled, loops closed, equations regular. Once it is there, nothing is done. */
static inline Found close_start(Model *m)
{
    Now *now = &m->now;
    if (now->closed) return FINE;
    Found found = settle_parameters(m);
    if (found != FINE) return found;
    if (!all_finite(now->q, NQ) || !all_finite(now->v, NV)) return refuse(m, NOT_FINITE, "a start value", 0.0);
    if (!now->guess_given) found = follow_branch(m);
    if (found != FINE) return found;
    if (!close_loops(m, now->t, now->q, now->p)) return open_at(m);
    found = check_assembly(m);
    if (found != FINE) return found;
    double x[NX];
    for (int i = 0; i < NQ; i++) x[i] = now->q[i];
    for (int i = 0; i < NV; i++) x[NQ + i] = now->v[i];
    now->side = 0.0;
    found = rates(m, now->t, x, NULL);
    if (found != FINE) return refuse(m, found, "an input or an acceleration", 0.0);
    now->side = sign_of(m->forward.delta);
    now->closed = 1;
    m->valid = FORWARD;
    return FINE;
}

static inline void set_start(Model *m)
{
    Now *now = &m->now;
    memset(now, 0, sizeof *now);
    memcpy(now->q, START_Q, sizeof now->q);
    memcpy(now->v, START_V, sizeof now->v);
    memcpy(now->p, START_P, sizeof now->p);
    now->t = START_T;
    now->tolerance = TOLERANCE;
    now->drift = DRIFT;
    now->watched = SWITCH_SPREAD;
    m->valid = 0;
    m->text[0] = '\0';
}

/* ---- states ------------------------------------------------------------------------------------------------- */

static inline void states(const Model *m, double *x)
{
    for (int i = 0; i < NQ; i++) x[i] = m->now.q[i];
    for (int i = 0; i < NV; i++) x[NQ + i] = m->now.v[i];
}

static inline void set_states(Model *m, const double *x)
{
    for (int i = 0; i < NQ; i++) m->now.q[i] = x[i];
    for (int i = 0; i < NV; i++) m->now.v[i] = x[NQ + i];
    m->valid = 0;
}

/* Before the simulation the start is closed first, so that no value is that of open loops or unsettled parameters. */
static inline Found ensure_start(Model *m)
{
    return m->now.mode == RUNNING || m->now.mode == ENDED ? FINE : close_start(m);
}

/* Whether bytes that claim to be a stored state can be one: what is used as an index is in its range. */
static inline int is_state(const Now *now)
{
    return now->chart >= 0 && now->chart < NCHARTS && now->mode >= INSTANTIATED && now->mode <= ENDED;
}

static inline Found ensure_forward(Model *m)
{
    if (m->valid & FORWARD) return FINE;
    states(m, m->x);
    const Found found = rates(m, m->now.t, m->x, NULL);
    if (found != FINE) return refuse(m, found, "a state, an input or an acceleration", 0.0);
    m->valid |= FORWARD;
    return FINE;
}

static inline Found state_rates(Model *m, double *x_dot)
{
    Found found = ensure_start(m);
    if (found == FINE) found = ensure_forward(m);
    if (found != FINE) return found;
    for (int i = 0; i < NQ; i++) x_dot[i] = m->forward.q_dot[i];
    for (int i = 0; i < NV; i++) x_dot[NQ + i] = m->forward.q_ddot[INDEPENDENT[m->now.chart][i]];
    return FINE;
}

/* ---- model exchange ----------------------------------------------------------------------------------------- */

/* Whether a host may read and write so many states: v are rates of the first independent coordinates then. */
static inline int has_states(const Model *m, size_t n)
{
    return n == NX && m->now.chart == 0;
}

/* A step of the host's integrator is done: *event tells whether the loops have drifted open so far that they must be
   closed; refused where the equations have no meaning there, whatever the integrator made of that. */
static inline Found step_done(Model *m, int *event)
{
    *event = !(gap(m, m->now.t, m->now.q, m->now.p) <= m->now.drift);
    return ensure_forward(m);
}

/* Close the loops; *moved tells whether that changed the states. */
static inline Found close_drift(Model *m, int *moved)
{
    *moved = !(gap(m, m->now.t, m->now.q, m->now.p) <= CLOSED_STEP);
    if (!*moved) return FINE;
    m->valid = 0;
    return close_loops(m, m->now.t, m->now.q, m->now.p) ? FINE : open_at(m);
}

/* ---- co-simulation: Dormand and Prince's pair of orders 5 and 4, loops closed after each step ----------------- */


static const double NODE[7] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double STAGE[7][6] = {
    {0.0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double ERROR[7] = {
    71.0 / 57600, 0.0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40,
};

/* The size of a change against the tolerance; 1 is just within it. */
static inline double measured(const Model *m, const double *change, const double *a, const double *b)
{
    const double relative = m->now.tolerance, absolute = 0.01 * relative;
    double sum = 0.0;
    for (int i = 0; i < NX; i++) {
        const double part = change[i] / (absolute + relative * fmax(fabs(a[i]), fabs(b[i])));
        sum += part * part;
    }
    return sqrt(sum / NX);
}

/* One step from m->x with the rates m->k[0]: m->trial, its rates m->k[6], and the error. */
static inline Found attempt(Model *m, double h, double *error)
{
    double change[NX];
    for (int stage = 1; stage < 7; stage++) {
        for (int i = 0; i < NX; i++) {
            double sum = 0.0;
            for (int j = 0; j < stage; j++) sum += STAGE[stage][j] * m->k[j][i];
            m->trial[i] = m->x[i] + h * sum;
        }
        const Found found = rates(m, m->now.t + NODE[stage] * h, m->trial, m->k[stage]);
        if (found != FINE) return found;
    }
    for (int i = 0; i < NX; i++) {
        change[i] = 0.0;
        for (int j = 0; j < 7; j++) change[i] += h * ERROR[j] * m->k[j][i];
    }
    *error = measured(m, change, m->x, m->trial);
    return isfinite(*error) ? FINE : NOT_FINITE;
}

/* Close the loops of m->trial at the end of a step; its rates are in m->k[6]. */
static inline Found land(Model *m, double t)
{
    if (gap(m, t, m->trial, m->now.p) <= CLOSED_STEP) return FINE;
    if (!close_loops(m, t, m->trial, m->now.p)) return LOOPS_OPEN;
    return rates(m, t, m->trial, m->k[6]);
}

#if NCHARTS > 1

/* |N|^2 in a chart, with lengths in the mechanism's longest lever; HUGE_VAL where a determinant is next to nothing. */
static inline double chart_spread(Model *m, int chart)
{
    const Now *now = &m->now;
    const struct At at = {.q = now->q, .v = now->v, .t = &now->t, .p = now->p};
    double sum = 0.0;
    eval_kinematics(chart, &at, &m->kinematics);
    for (int i = 0; i < NQ; i++) {
        for (int j = 0; j < NV; j++) {
            const double part = m->kinematics.N[i * NV + j] * SCALE[INDEPENDENT[chart][j]] / SCALE[i];
            sum += part * part;
        }
    }
    return isfinite(sum) && m->kinematics.doubt < SWITCH_DOUBT ? sum : HUGE_VAL;
}

/* Go over to the chart with the least |N| where that is worth it; m->x and its rates m->k[0] go along. */
static inline int changed_chart(Model *m)
{
    Now *now = &m->now;
    const double spread = chart_spread(m, now->chart), side = now->side;
    const int before = now->chart;
    double least = spread;
    int best = before;
    for (int chart = 0; chart < NCHARTS; chart++) {
        const double other = chart_spread(m, chart);
        if (other < least) {
            least = other;
            best = chart;
        }
    }
    now->watched = fmax(4.0 * least, SWITCH_SPREAD);
    if (best == before || least > 0.25 * spread) return 0;
    states(m, m->x);
    if (rates(m, now->t, m->x, NULL) != FINE) return 0;
    for (int i = 0; i < NV; i++) m->x[NQ + i] = m->forward.q_dot[INDEPENDENT[best][i]];
    now->chart = best;
    now->side = 0.0;
    if (rates(m, now->t, m->x, m->k[0]) == FINE) {
        now->side = sign_of(m->forward.delta);
        set_states(m, m->x);
        return 1;
    }
    now->chart = before;
    now->side = side;
    states(m, m->x);
    rates(m, now->t, m->x, m->k[0]);
    return 0;
}

#else

static inline double chart_spread(Model *m, int chart)
{
    (void)m, (void)chart;
    return 0.0;
}

static inline int changed_chart(Model *m)
{
    (void)m;
    return 0;
}

#endif

static inline double first_step(const Model *m)
{
    const double size = measured(m, m->x, m->x, m->x), rate = measured(m, m->k[0], m->x, m->x);
    return size < 1e-5 || rate < 1e-5 ? 1e-6 : 0.01 * size / rate;
}

/* Steps until a time, or until right before what cannot be passed; `now` is where it stands in the end. */
static inline Found advance(Model *m, double until)
{
    Now *now = &m->now;
    states(m, m->x);
    m->valid = 0;
    Found refused = rates(m, now->t, m->x, m->k[0]);
    if (refused != FINE) return refuse(m, refused, "an input or an acceleration", 0.0);
    double h = now->step > 0.0 ? now->step : first_step(m);
    for (int steps = 0; now->t < until; steps++) {
        const double left = until - now->t;
        const int last = h >= left * (1.0 - 1e-12);
        const double taken = last ? left : h, t = last ? until : now->t + taken;
        double error = 0.0;
        if (steps >= MOST_STEPS || (!last && taken < 8.0 * DBL_EPSILON * fmax(fabs(now->t), fabs(until)))) {
            const Found why = steps >= MOST_STEPS ? TOO_MANY_STEPS : STEP_TOO_SMALL;
            if (refused == LOOPS_OPEN) return open_at(m);
            return refuse(m, refused != FINE ? refused : why, "an input or an acceleration", 0.0);
        }
        Found found = attempt(m, taken, &error);
        if (found == FINE && error <= 1.0) found = land(m, t);
        if (found != FINE) {
            if (refused == FINE && found == SINGULAR_INDEPENDENT_SET && changed_chart(m)) continue;
            refused = found;
            h = 0.25 * taken;
            continue;
        }
        const double factor = error > 0.0 ? fmin(5.0, 0.9 * pow(error, -0.2)) : 5.0;
        if (error > 1.0) {
            h = taken * fmax(0.2, factor);
            continue;
        }
        refused = FINE;
        now->t = t;
        memcpy(m->x, m->trial, sizeof m->x);
        memcpy(m->k[0], m->k[6], sizeof m->k[0]);
        set_states(m, m->x);
        h = last ? fmax(h, factor * taken) : factor * taken;
        now->step = h;
        if (chart_spread(m, now->chart) > now->watched) changed_chart(m);
    }
    return FINE;
}

/* ---- values by reference ------------------------------------------------------------------------------------ */

/* The place of a value reference within a group, or -1. */
static inline int within(unsigned vr, unsigned first, int count)
{
    return vr >= first && vr < first + (unsigned)count ? (int)(vr - first) : -1;
}

/* What is there without any evaluation; whether it is. */
static inline int plain_value(const Model *m, unsigned vr, double *value)
{
    const Now *now = &m->now;
    int i;
    if (vr == VR_TIME) *value = now->t;
    else if ((i = within(vr, VR_Q, NQ)) >= 0) *value = now->q[i];
    else if (now->chart == 0 && (i = within(vr, VR_V, NV)) >= 0) *value = now->v[i];
    else if ((i = within(vr, VR_U, NU)) >= 0) *value = now->u[i];
    else if ((i = within(vr, VR_P, NP)) >= 0) *value = now->p[i];
    else if (vr == VR_TOLERANCE) *value = now->tolerance;
    else if (vr == VR_DRIFT) *value = now->drift;
    else return 0;
    return 1;
}

static inline Found value_of(Model *m, unsigned vr, double *value)
{
    Found found = ensure_start(m);
    if (found != FINE) return found;
    if (plain_value(m, vr, value)) return FINE;
    int i;
    if (vr == VR_GAP) {
        *value = gap(m, m->now.t, m->now.q, m->now.p);
        return FINE;
    }
    found = ensure_forward(m);
    if (found != FINE) return found;
    const struct forward_dynamics_values *f = &m->forward;
    const struct At at = {
        .q = m->now.q, .q_dot = f->q_dot, .u = m->applied, .q_ddot = f->q_ddot, .t = &m->now.t, .p = m->now.p};
    if ((i = within(vr, VR_Q_DOT, NQ)) >= 0) *value = f->q_dot[i];
    else if ((i = within(vr, VR_V, NV)) >= 0) *value = f->q_dot[INDEPENDENT[0][i]];
    else if ((i = within(vr, VR_Q_DDOT, NQ)) >= 0) *value = f->q_ddot[i];
    else if ((i = within(vr, VR_INPUT_POWER, NU)) >= 0) *value = m->applied[i] * f->q_dot[ACTUATED[i]];
    else if (vr == VR_POWER) *value = f->power;
    else if (vr == VR_KINETIC || vr == VR_POTENTIAL) {
        if (!(m->valid & ENERGY)) eval_energy(&at, &m->energy);
        m->valid |= ENERGY;
        *value = vr == VR_KINETIC ? m->energy.T : m->energy.U;
    } else if ((i = within(vr, VR_REACTION, NREACTIONS)) >= 0) {
        if (!(m->valid & REACTIONS)) eval_reactions(m->now.chart, &at, &m->reactions);
        m->valid |= REACTIONS;
        *value = m->reactions.lam[i];
    } else return refuse(m, BAD_VALUE, "there is no variable of this value reference", vr);
    return FINE;
}

static inline Found set_value(Model *m, unsigned vr, double value)
{
    Now *now = &m->now;
    int i;
    if ((i = within(vr, VR_U, NU)) >= 0) {
        now->u[i] = value;
        m->valid = 0;
        return FINE;
    }
    if (now->mode != INSTANTIATED && now->mode != INITIALIZING) {
        return refuse(m, BAD_VALUE, "parameters and start values can be set before the simulation only", 0.0);
    }
    if ((i = within(vr, VR_Q, NQ)) >= 0) {
        if (!is_independent(0, i) && value != START_Q[i]) now->guess_given = 1;
        now->q[i] = value;
    } else if ((i = within(vr, VR_V, NV)) >= 0) now->v[i] = value;
    else if ((i = within(vr, VR_P, NP)) >= 0) {
        if (FOLLOWS[i]) return refuse(m, BAD_VALUE, "a parameter that follows from others cannot be set", 0.0);
        now->p[i] = value;
    } else if (vr == VR_TOLERANCE) {
        if (!(value >= TIGHTEST && value <= 0.1)) return refuse(m, BAD_PARAMETER, "solver.tolerance", value);
        now->tolerance = value;
        now->tolerance_given = 1;
    } else if (vr == VR_DRIFT) {
        if (!(value > 0.0)) return refuse(m, BAD_PARAMETER, "solver.drift", value);
        now->drift = value;
    } else return refuse(m, BAD_VALUE, "a variable that is neither input, parameter nor start value cannot be set", 0.0);
    now->closed = 0;
    m->valid = 0;
    return FINE;
}

#endif
