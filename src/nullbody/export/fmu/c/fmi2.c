/* The functions of FMI 2.0, model exchange and co-simulation, around core.h. */

#include <stdlib.h>

#include "fmi2Functions.h"

#include "core.h"

/* What an instance needs beside the model. */
typedef struct {
    Model model;
    fmi2CallbackAllocateMemory allocate;
    fmi2CallbackFreeMemory release;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[256];
    fmi2Boolean ended_early;
} Instance;

#define MODEL(c) (&((Instance *)(c))->model)

static fmi2Status say(const Instance *instance, fmi2Status status, const char *text)
{
    if (instance->logger != NULL) {
        instance->logger(instance->environment, instance->name, status,
                         status == fmi2Discard ? "logStatusDiscard" : "logStatusError", text);
    }
    return status;
}

static fmi2Status status_of(fmi2Component c, Found found, fmi2Status bad)
{
    return found == FINE ? fmi2OK : say((Instance *)c, bad, MODEL(c)->text);
}

static fmi2Status unsupported(fmi2Component c, const char *text)
{
    return c == NULL ? fmi2Error : say((Instance *)c, fmi2Error, text);
}

/* ---- life of an instance ------------------------------------------------------------------------------------ */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)on, (void)n, (void)categories; /* errors are always logged, and nothing else is */
    return c == NULL ? fmi2Error : fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)type, (void)resources, (void)visible, (void)logging;
    const int own = functions == NULL || functions->allocateMemory == NULL || functions->freeMemory == NULL;
    const char *called = name == NULL || name[0] == '\0' ? MODEL_IDENTIFIER : name;
    if (guid == NULL || strcmp(guid, TOKEN) != 0) {
        if (functions != NULL && functions->logger != NULL) {
            functions->logger(functions->componentEnvironment, called, fmi2Error, "logStatusError",
                              "the GUID is not that of this unit: modelDescription.xml and the binary do not belong "
                              "together");
        }
        return NULL;
    }
    Instance *instance = own ? calloc(1, sizeof *instance) : functions->allocateMemory(1, sizeof *instance);
    if (instance == NULL) return NULL;
    memset(instance, 0, sizeof *instance);
    instance->allocate = own ? calloc : functions->allocateMemory;
    instance->release = own ? free : functions->freeMemory;
    instance->logger = functions == NULL ? NULL : functions->logger;
    instance->environment = functions == NULL ? NULL : functions->componentEnvironment;
    snprintf(instance->name, sizeof instance->name, "%s", called);
    set_start(&instance->model);
    return instance;
}

void fmi2FreeInstance(fmi2Component c)
{
    if (c != NULL) ((Instance *)c)->release(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_given, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_given, fmi2Real stop)
{
    (void)stop_given, (void)stop;
    if (c == NULL) return fmi2Error;
    Now *now = &MODEL(c)->now;
    if (now->mode != INSTANTIATED) return unsupported(c, "fmi2SetupExperiment is for the time before initialization");
    if (tolerance_given && !now->tolerance_given) now->tolerance = fmin(fmax(tolerance, TIGHTEST), 0.1);
    now->t = start;
    now->closed = 0;
    MODEL(c)->valid = 0;
    return isfinite(start) ? fmi2OK : unsupported(c, "the start time is not finite");
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    if (c == NULL) return fmi2Error;
    if (MODEL(c)->now.mode != INSTANTIATED) return unsupported(c, "initialization mode can be entered once only");
    MODEL(c)->now.mode = INITIALIZING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    if (c == NULL) return fmi2Error;
    if (MODEL(c)->now.mode != INITIALIZING) return unsupported(c, "initialization mode has not been entered");
    const Found found = close_start(MODEL(c));
    if (found == FINE) MODEL(c)->now.mode = RUNNING;
    return status_of(c, found, fmi2Error);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    if (c == NULL) return fmi2Error;
    MODEL(c)->now.mode = ENDED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    if (c == NULL) return fmi2Error;
    set_start(MODEL(c));
    ((Instance *)c)->ended_early = fmi2False;
    return fmi2OK;
}

/* ---- values ------------------------------------------------------------------------------------------------- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    if (c == NULL) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        const Found found = value_of(MODEL(c), vr[i], &value[i]);
        if (found != FINE) return status_of(c, found, found == BAD_VALUE ? fmi2Error : fmi2Discard);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    if (c == NULL) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        const Found found = set_value(MODEL(c), vr[i], value[i]);
        if (found != FINE) return status_of(c, found, fmi2Error);
    }
    return fmi2OK;
}

#define NO_VALUES(kind, type)                                                                                      \
    fmi2Status fmi2Get##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[])               \
    {                                                                                                              \
        (void)vr, (void)value;                                                                                     \
        return n == 0 ? fmi2OK : unsupported(c, "there is no variable of type " #kind);                            \
    }                                                                                                              \
    fmi2Status fmi2Set##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, const type value[])         \
    {                                                                                                              \
        (void)vr, (void)value;                                                                                     \
        return n == 0 ? fmi2OK : unsupported(c, "there is no variable of type " #kind);                            \
    }

NO_VALUES(Integer, fmi2Integer)
NO_VALUES(Boolean, fmi2Boolean)
NO_VALUES(String, fmi2String)

/* ---- the state of the unit ---------------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (c == NULL || state == NULL) return fmi2Error;
    if (*state == NULL) *state = ((Instance *)c)->allocate(1, sizeof(Now));
    if (*state == NULL) return unsupported(c, "no memory for a state");
    memcpy(*state, &MODEL(c)->now, sizeof(Now));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (c == NULL || state == NULL) return fmi2Error;
    memcpy(&MODEL(c)->now, state, sizeof(Now));
    MODEL(c)->valid = 0;
    ((Instance *)c)->ended_early = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (c == NULL || state == NULL) return fmi2Error;
    if (*state != NULL) ((Instance *)c)->release(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    if (c == NULL || state == NULL || size == NULL) return fmi2Error;
    *size = sizeof(Now);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (c == NULL || state == NULL || size < sizeof(Now)) return fmi2Error;
    memcpy(bytes, state, sizeof(Now));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    if (c == NULL || state == NULL || size != sizeof(Now)) return fmi2Error;
    Now stored;
    memcpy(&stored, bytes, sizeof stored);
    if (!is_state(&stored)) return unsupported(c, "these bytes are no stored state of this unit");
    if (*state == NULL) *state = ((Instance *)c)->allocate(1, sizeof(Now));
    if (*state == NULL) return unsupported(c, "no memory for a state");
    memcpy(*state, &stored, sizeof stored);
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                        const fmi2ValueReference known[], size_t m, const fmi2Real known_change[],
                                        fmi2Real unknown_change[])
{
    (void)unknown, (void)n, (void)known, (void)m, (void)known_change, (void)unknown_change;
    return unsupported(c, "directional derivatives are not provided");
}

/* ---- model exchange ----------------------------------------------------------------------------------------- */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    return c == NULL ? fmi2Error : fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    if (c == NULL || info == NULL) return fmi2Error;
    int moved = 0;
    const Found found = close_drift(MODEL(c), &moved);
    info->newDiscreteStatesNeeded = fmi2False;
    info->terminateSimulation = found != FINE;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = moved;
    info->nextEventTimeDefined = fmi2False;
    info->nextEventTime = 0.0;
    return status_of(c, found, fmi2Error);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    return c == NULL ? fmi2Error : fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *event, fmi2Boolean *end)
{
    (void)no_return;
    if (c == NULL || event == NULL || end == NULL) return fmi2Error;
    const Found found = step_done(MODEL(c), event);
    *end = found != FINE;
    return found == FINE ? fmi2OK : say(c, fmi2Warning, MODEL(c)->text);
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    if (c == NULL) return fmi2Error;
    MODEL(c)->now.t = time;
    MODEL(c)->now.closed = 0;
    MODEL(c)->valid = 0;
    return fmi2OK;
}

static const char *const STATES =
    "there are as many states as coordinates and independent rates, in model exchange";

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    if (MODEL(c)->now.mode != RUNNING) return unsupported(c, "before the simulation, states are set as start values");
    set_states(MODEL(c), x);
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real x_dot[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    return status_of(c, state_rates(MODEL(c), x_dot), fmi2Discard);
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t n)
{
    (void)indicators;
    return c != NULL && n == 0 ? fmi2OK : unsupported(c, "there are no event indicators");
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    const Found found = ensure_start(MODEL(c));
    if (found == FINE) states(MODEL(c), x);
    return status_of(c, found, fmi2Discard);
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t n)
{
    if (c == NULL || !has_states(MODEL(c), n)) return unsupported(c, STATES);
    for (size_t i = 0; i < n; i++) nominals[i] = 1.0;
    return fmi2OK;
}

/* ---- co-simulation ------------------------------------------------------------------------------------------ */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean no_return)
{
    (void)no_return;
    if (c == NULL) return fmi2Error;
    Instance *instance = c;
    Now *now = &instance->model.now;
    if (now->mode != RUNNING) return unsupported(c, "fmi2DoStep is for the time after initialization");
    if (instance->ended_early) return unsupported(c, "the simulation has ended already, by the reason logged then");
    if (!(length >= 0.0) || !isfinite(length) || !(fabs(time - now->t) <= 1e-9 * fmax(1.0, fabs(time)))) {
        return unsupported(c, "a communication step begins where the last one ended, and is not negative");
    }
    const Found found = advance(&instance->model, time + length);
    instance->ended_early = found != FINE;
    return status_of(c, found, fmi2Discard);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return unsupported(c, "steps are not asynchronous");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return unsupported(c, "inputs are held over a communication step");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return unsupported(c, "rates and accelerations are outputs of their own");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return unsupported(c, "steps are not asynchronous");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (c == NULL || kind != fmi2LastSuccessfulTime) return unsupported(c, "only fmi2LastSuccessfulTime is known");
    *value = MODEL(c)->now.t;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return unsupported(c, "there is no status of type integer");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (c == NULL || kind != fmi2Terminated) return unsupported(c, "only fmi2Terminated is known");
    *value = ((Instance *)c)->ended_early;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return unsupported(c, "steps are not asynchronous");
}
