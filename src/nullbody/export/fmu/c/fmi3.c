/* The functions of FMI 3.0, model exchange and co-simulation, around core.h. */

#include <stdlib.h>

#include "fmi3Functions.h"

#include "core.h"

/* What an instance needs beside the model. */
typedef struct {
    Model model;
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
    int ended_early;
} Instance;

#define MODEL(c) (&((Instance *)(c))->model)

static fmi3Status say(const Instance *instance, fmi3Status status, const char *text)
{
    if (instance->logger != NULL) {
        instance->logger(instance->environment, status,
                         status == fmi3Discard ? "logStatusDiscard" : "logStatusError", text);
    }
    return status;
}

static fmi3Status status_of(fmi3Instance c, Found found, fmi3Status bad)
{
    return found == FINE ? fmi3OK : say((Instance *)c, bad, MODEL(c)->text);
}

static fmi3Status unsupported(fmi3Instance c, const char *text)
{
    return c == NULL ? fmi3Error : say((Instance *)c, fmi3Error, text);
}

/* ---- life of an instance ------------------------------------------------------------------------------------ */

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)on, (void)n, (void)categories; /* errors are always logged, and nothing else is */
    return c == NULL ? fmi3Error : fmi3OK;
}

static fmi3Instance instantiated(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        if (logger != NULL) {
            logger(environment, fmi3Error, "logStatusError",
                   "the instantiation token is not that of this unit: modelDescription.xml and the binary do not "
                   "belong together");
        }
        return NULL;
    }
    Instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) return NULL;
    instance->logger = logger;
    instance->environment = environment;
    set_start(&instance->model);
    return instance;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger)
{
    (void)name, (void)resources, (void)visible, (void)logging;
    return instantiated(token, environment, logger);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update)
{
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)n;
    (void)update;
    return instantiated(token, environment, logger);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
    if (logger != NULL) logger(environment, fmi3Error, "logStatusError", "scheduled execution is not provided");
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c)
{
    free(c);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_given, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stop_given, fmi3Float64 stop)
{
    (void)stop_given, (void)stop;
    if (c == NULL) return fmi3Error;
    Now *now = &MODEL(c)->now;
    if (now->mode != INSTANTIATED) return unsupported(c, "initialization mode can be entered once only");
    if (!isfinite(start)) return unsupported(c, "the start time is not finite");
    if (tolerance_given && !now->tolerance_given) now->tolerance = fmin(fmax(tolerance, TIGHTEST), 0.1);
    now->t = start;
    now->closed = 0;
    now->mode = INITIALIZING;
    MODEL(c)->valid = 0;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    if (c == NULL) return fmi3Error;
    if (MODEL(c)->now.mode != INITIALIZING) return unsupported(c, "initialization mode has not been entered");
    const Found found = close_start(MODEL(c));
    if (found == FINE) MODEL(c)->now.mode = RUNNING;
    return status_of(c, found, fmi3Error);
}

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    return c == NULL ? fmi3Error : fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    if (c == NULL) return fmi3Error;
    MODEL(c)->now.mode = ENDED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    if (c == NULL) return fmi3Error;
    set_start(MODEL(c));
    ((Instance *)c)->ended_early = 0;
    return fmi3OK;
}

/* ---- values ------------------------------------------------------------------------------------------------- */

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t m)
{
    if (c == NULL || n != m) return unsupported(c, "all variables are scalars");
    for (size_t i = 0; i < n; i++) {
        const Found found = value_of(MODEL(c), vr[i], &value[i]);
        if (found != FINE) return status_of(c, found, found == BAD_VALUE ? fmi3Error : fmi3Discard);
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[], size_t m)
{
    if (c == NULL || n != m) return unsupported(c, "all variables are scalars");
    for (size_t i = 0; i < n; i++) {
        const Found found = set_value(MODEL(c), vr[i], value[i]);
        if (found != FINE) return status_of(c, found, fmi3Error);
    }
    return fmi3OK;
}

#define NO_VALUES(kind)                                                                                            \
    fmi3Status fmi3Get##kind(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##kind value[], size_t m) \
    {                                                                                                              \
        (void)vr, (void)value, (void)m;                                                                            \
        return n == 0 ? fmi3OK : unsupported(c, "there is no variable of type " #kind);                            \
    }                                                                                                              \
    fmi3Status fmi3Set##kind(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3##kind value[],    \
                             size_t m)                                                                             \
    {                                                                                                              \
        (void)vr, (void)value, (void)m;                                                                            \
        return n == 0 ? fmi3OK : unsupported(c, "there is no variable of type " #kind);                            \
    }

NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(Int32)
NO_VALUES(UInt32)
NO_VALUES(Int64)
NO_VALUES(UInt64)
NO_VALUES(Boolean)
NO_VALUES(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary value[],
                         size_t m)
{
    (void)vr, (void)sizes, (void)value, (void)m;
    return n == 0 ? fmi3OK : unsupported(c, "there is no variable of type Binary");
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                         const fmi3Binary value[], size_t m)
{
    (void)vr, (void)sizes, (void)value, (void)m;
    return n == 0 ? fmi3OK : unsupported(c, "there is no variable of type Binary");
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock value[])
{
    (void)vr, (void)value;
    return n == 0 ? fmi3OK : unsupported(c, "there is no clock");
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock value[])
{
    (void)vr, (void)value;
    return n == 0 ? fmi3OK : unsupported(c, "there is no clock");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *n)
{
    (void)vr, (void)n;
    return unsupported(c, "dependencies are in modelDescription.xml, and do not change");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t elements[],
                                       fmi3ValueReference on[], size_t of_elements[], fmi3DependencyKind kinds[],
                                       size_t n)
{
    (void)vr, (void)elements, (void)on, (void)of_elements, (void)kinds, (void)n;
    return unsupported(c, "dependencies are in modelDescription.xml, and do not change");
}

/* ---- the state of the unit ---------------------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    if (c == NULL || state == NULL) return fmi3Error;
    if (*state == NULL) *state = calloc(1, sizeof(Now));
    if (*state == NULL) return unsupported(c, "no memory for a state");
    memcpy(*state, &MODEL(c)->now, sizeof(Now));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    if (c == NULL || state == NULL) return fmi3Error;
    memcpy(&MODEL(c)->now, state, sizeof(Now));
    MODEL(c)->valid = 0;
    ((Instance *)c)->ended_early = 0;
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    if (c == NULL || state == NULL) return fmi3Error;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    if (c == NULL || state == NULL || size == NULL) return fmi3Error;
    *size = sizeof(Now);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    if (c == NULL || state == NULL || size < sizeof(Now)) return fmi3Error;
    memcpy(bytes, state, sizeof(Now));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    if (c == NULL || state == NULL || size != sizeof(Now)) return fmi3Error;
    Now stored;
    memcpy(&stored, bytes, sizeof stored);
    if (!is_state(&stored)) return unsupported(c, "these bytes are no stored state of this unit");
    if (*state == NULL) *state = calloc(1, sizeof(Now));
    if (*state == NULL) return unsupported(c, "no memory for a state");
    memcpy(*state, &stored, sizeof stored);
    return fmi3OK;
}

#define NO_DERIVATIVES(name)                                                                                       \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference unknown[], size_t nu, const fmi3ValueReference known[], \
                    size_t nk, const fmi3Float64 seed[], size_t ns, fmi3Float64 change[], size_t nc)               \
    {                                                                                                              \
        (void)unknown, (void)nu, (void)known, (void)nk, (void)seed, (void)ns, (void)change, (void)nc;              \
        return unsupported(c, "partial derivatives are not provided");                                             \
    }

NO_DERIVATIVES(fmi3GetDirectionalDerivative)
NO_DERIVATIVES(fmi3GetAdjointDerivative)

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return unsupported(c, "there are no structural parameters");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return unsupported(c, "there are no structural parameters");
}

/* ---- clocks: there are none ---------------------------------------------------------------------------------- */

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[])
{
    (void)vr, (void)n, (void)intervals, (void)qualifiers;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                   fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)vr, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 shifts[])
{
    (void)vr, (void)n, (void)shifts;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                fmi3UInt64 resolutions[])
{
    (void)vr, (void)n, (void)counters, (void)resolutions;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                  const fmi3Float64 intervals[])
{
    (void)vr, (void)n, (void)intervals;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                   const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)vr, (void)n, (void)counters, (void)resolutions;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 shifts[])
{
    (void)vr, (void)n, (void)shifts;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3UInt64 counters[],
                                const fmi3UInt64 resolutions[])
{
    (void)vr, (void)n, (void)counters, (void)resolutions;
    return unsupported(c, "there is no clock");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return unsupported(c, "there is no clock");
}

/* ---- events: loops that have drifted open are closed ---------------------------------------------------------- */

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return c == NULL ? fmi3Error : fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals,
                                    fmi3Boolean *changed, fmi3Boolean *next_given, fmi3Float64 *next)
{
    if (c == NULL) return fmi3Error;
    int moved = 0;
    const Found found = close_drift(MODEL(c), &moved);
    *again = fmi3False;
    *end = found != FINE;
    *nominals = fmi3False;
    *changed = moved != 0;
    *next_given = fmi3False;
    *next = 0.0;
    return status_of(c, found, fmi3Error);
}

/* ---- model exchange ----------------------------------------------------------------------------------------- */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    return c == NULL ? fmi3Error : fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *end)
{
    (void)no_return;
    if (c == NULL || event == NULL || end == NULL) return fmi3Error;
    int drifted = 0;
    const Found found = step_done(MODEL(c), &drifted);
    *event = drifted != 0;
    *end = found != FINE;
    return found == FINE ? fmi3OK : say(c, fmi3Warning, MODEL(c)->text);
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    if (c == NULL) return fmi3Error;
    MODEL(c)->now.t = time;
    MODEL(c)->now.closed = 0;
    MODEL(c)->valid = 0;
    return fmi3OK;
}

static const char *const STATES =
    "there are as many states as coordinates and independent rates, in model exchange";

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    if (MODEL(c)->now.mode != RUNNING) return unsupported(c, "before the simulation, states are set as start values");
    set_states(MODEL(c), x);
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 x_dot[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    return status_of(c, state_rates(MODEL(c), x_dot), fmi3Discard);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t n)
{
    (void)indicators;
    return c != NULL && n == 0 ? fmi3OK : unsupported(c, "there are no event indicators");
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    const Found found = ensure_start(MODEL(c));
    if (found == FINE) states(MODEL(c), x);
    return status_of(c, found, fmi3Discard);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    for (size_t i = 0; i < n; i++) nominals[i] = 1.0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
    if (c == NULL || n == NULL) return fmi3Error;
    *n = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
    if (c == NULL || n == NULL) return fmi3Error;
    *n = NX;
    return fmi3OK;
}

/* ---- co-simulation ------------------------------------------------------------------------------------------ */

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    return c == NULL ? fmi3Error : fmi3OK;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 value[], size_t m)
{
    (void)vr, (void)n, (void)orders, (void)value, (void)m;
    return unsupported(c, "rates and accelerations are outputs of their own");
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 length, fmi3Boolean no_return, fmi3Boolean *event,
                      fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *last)
{
    (void)no_return;
    if (c == NULL) return fmi3Error;
    Instance *instance = c;
    Now *now = &instance->model.now;
    *event = fmi3False;
    *end = fmi3False;
    *early = fmi3False;
    *last = now->t;
    if (now->mode != RUNNING) return unsupported(c, "fmi3DoStep is for the time after initialization");
    if (instance->ended_early) return unsupported(c, "the simulation has ended already, by the reason logged then");
    if (!(length >= 0.0) || !isfinite(length) || !(fabs(time - now->t) <= 1e-9 * fmax(1.0, fabs(time)))) {
        return unsupported(c, "a communication step begins where the last one ended, and is not negative");
    }
    const Found found = advance(&instance->model, time + length);
    instance->ended_early = found != FINE;
    *end = found != FINE;
    *last = now->t;
    return status_of(c, found, fmi3Discard);
}
