/* Arguments are the interface's, of use here or not. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

/* A function of what there is none of: to be asked for none of that is fine. */
#define LACKS(Function, many, arguments)                                                                                     \
  fmi2Status Function arguments { return (many) == 0 ? fmi2OK : unsupported(c, #Function); }

/* A function that goes from some modes to one. */
static fmi2Status enter(fmi2Component c, unsigned from, unsigned to, const char* function) {
  Unit* unit = (Unit*) c;
  if (out_of_order(unit, from, function)) return fmi2Error;
  unit->state.mode = to;
  return fmi2OK;
}

/* ---- For Model Exchange and Co-Simulation ---- */

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char* fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t many, const fmi2String categories[]) {
  Unit* unit = (Unit*) c;
  size_t i;
  if (many == 0) unit->discards = on;
  for (i = 0; i < many; ++i) {
    if (!strcmp(categories[i], "logStatusDiscard")) {
      unit->discards = on;
    } else if (strcmp(categories[i], "logStatusError") != 0) {
      return report(unit, fmi2Error, "no such category to log: ", categories[i]);
    }
  }
  return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean visible, fmi2Boolean logging) {
  Unit* unit;
  /* Failures are logged, whatever logging says. */
  if (!functions || !functions->allocateMemory || !functions->freeMemory || !name) return NULL;
  unit = (Unit*) functions->allocateMemory(1, sizeof *unit + strlen(name) + 1);
  if (!unit) return NULL;
  reset(&unit->state);
  unit->logger = functions->logger;
  unit->allocate = functions->allocateMemory;
  unit->release = functions->freeMemory;
  unit->environment = functions->componentEnvironment;
  unit->discards = 1;
  strcpy(unit->name, name);
  if (guid && strcmp(guid, GUID) == 0) return unit;
  report(unit, fmi2Error, "the GUID differs from that of this unit: ", guid ? guid : "none");
  unit->release(unit);
  return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
  if (c) ((Unit*) c)->release(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_defined, fmi2Real stop) {
  Unit* unit = (Unit*) c;
  if (out_of_order(unit, INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
  set_time(&unit->state, start_time);
  unit->state.reached = start_time;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return enter(c, INSTANTIATED, INITIALIZING, "fmi2EnterInitializationMode"); }

/* From here on loops and angles go on; the first instant begins anew. */
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  Unit* unit = (Unit*) c;
  if (enter(c, INITIALIZING, RUNNING, "fmi2ExitInitializationMode") != fmi2OK) return fmi2Error;
  unit->state.begun = unit->state.current = 0;
  return prepare(unit);
}

fmi2Status fmi2Terminate(fmi2Component c) { return enter(c, INITIALIZING | RUNNING, TERMINATED, "fmi2Terminate"); }

fmi2Status fmi2Reset(fmi2Component c) {
  reset(&((Unit*) c)->state);
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]) {
  Unit* unit = (Unit*) c;
  fmi2Status status = fmi2OK;
  size_t i;
  for (i = 0; i < nvr; ++i) {
    if (vr[i] < VALUES) {
      value[i] = unit->state.values[vr[i]];
    } else if (vr[i] < VALUES + OUTPUTS) {
      const fmi2Status found = update(unit);
      value[i] = found == fmi2OK ? unit->state.outputs[vr[i] - VALUES] : (double) NAN;
      if (found != fmi2OK) status = found;
    } else if (TIMED && vr[i] == VALUES + OUTPUTS) {
      value[i] = unit->state.time;
    } else {
      return report(unit, fmi2Error, "fmi2GetReal: no such variable", "");
    }
  }
  return status;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]) {
  Unit* unit = (Unit*) c;
  State* state = &unit->state;
  size_t i;
  if (out_of_order(unit, INSTANTIATED | INITIALIZING | RUNNING, "fmi2SetReal")) return fmi2Error;
  for (i = 0; i < nvr; ++i) {
    if (vr[i] >= VALUES) return report(unit, fmi2Error, "fmi2SetReal: no such input or parameter", "");
    if (state->values[vr[i]] == value[i]) continue;
$if setting
    if (vr[i] < PARAMETERS) {
      if (refused(unit, vr[i], value[i])) return fmi2Error;
      state->prepared = 0;
    }
$end setting
    state->values[vr[i]] = value[i];
    state->current = 0;
  }
  return fmi2OK;
}

#define NONE_OF(Type)                                                                                                        \
  LACKS(fmi2Get##Type, nvr, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##Type value[]))                \
  LACKS(fmi2Set##Type, nvr, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##Type value[]))

NONE_OF(Integer)
NONE_OF(Boolean)
NONE_OF(String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* kept) {
  Unit* unit = (Unit*) c;
  if (!*kept) *kept = unit->allocate(1, sizeof(State));
  if (!*kept) return report(unit, fmi2Error, "fmi2GetFMUstate: no memory", "");
  memcpy(*kept, &unit->state, sizeof(State));
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
  Unit* unit = (Unit*) c;
  if (!kept) return report(unit, fmi2Error, "fmi2SetFMUstate: there is no state", "");
  memcpy(&unit->state, kept, sizeof(State));
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* kept) {
  if (*kept) ((Unit*) c)->release(*kept);
  *kept = NULL;
  return fmi2OK;
}

LACKS(fmi2SerializedFMUstateSize, 1, (fmi2Component c, fmi2FMUstate kept, size_t* size))
LACKS(fmi2SerializeFMUstate, 1, (fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size))
LACKS(fmi2DeSerializeFMUstate, 1, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* kept))
LACKS(fmi2GetDirectionalDerivative, 1, (fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                        const fmi2ValueReference known[], size_t knowns, const fmi2Real change[], fmi2Real derivative[]))

/* ---- For Model Exchange: there are no states and no events ---- */

fmi2Status fmi2EnterEventMode(fmi2Component c) { return enter(c, RUNNING, RUNNING, "fmi2EnterEventMode"); }

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) {
  memset(info, 0, sizeof *info);
  return enter(c, RUNNING, RUNNING, "fmi2NewDiscreteStates");
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { return enter(c, RUNNING, RUNNING, "fmi2EnterContinuousTimeMode"); }

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean last, fmi2Boolean* event, fmi2Boolean* terminate) {
  *event = *terminate = fmi2False;
  return enter(c, RUNNING, RUNNING, "fmi2CompletedIntegratorStep");
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  Unit* unit = (Unit*) c;
  if (out_of_order(unit, INSTANTIATED | INITIALIZING | RUNNING, "fmi2SetTime")) return fmi2Error;
  set_time(&unit->state, time);
  return fmi2OK;
}

LACKS(fmi2SetContinuousStates, nx, (fmi2Component c, const fmi2Real x[], size_t nx))

#define NO_NUMBERS(Function)                                                                                                 \
  fmi2Status Function(fmi2Component c, fmi2Real x[], size_t many) {                                                          \
    return many == 0 ? fmi2OK : unsupported(c, "a state or event");                                                          \
  }

NO_NUMBERS(fmi2GetDerivatives)
NO_NUMBERS(fmi2GetEventIndicators)
NO_NUMBERS(fmi2GetContinuousStates)
NO_NUMBERS(fmi2GetNominalsOfContinuousStates)

/* ---- For Co-Simulation: inputs are held during a step ---- */

LACKS(fmi2SetRealInputDerivatives, nvr, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                         const fmi2Real value[]))
LACKS(fmi2GetRealOutputDerivatives, nvr, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                          fmi2Real value[]))

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_return) {
  Unit* unit = (Unit*) c;
  fmi2Status status;
  if (out_of_order(unit, RUNNING, "fmi2DoStep")) return fmi2Error;
  set_time(&unit->state, now + step);
  status = update(unit);
  if (status == fmi2OK) {
    unit->state.reached = unit->state.time;
  } else {
    set_time(&unit->state, now);
  }
  return status;
}

LACKS(fmi2CancelStep, 1, (fmi2Component c))

/* Nothing is ever pending. */
#define NEVER(Kind, Type)                                                                                                    \
  fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2StatusKind kind, Type* value) { return fmi2Discard; }

NEVER(Status, fmi2Status)
NEVER(IntegerStatus, fmi2Integer)
NEVER(StringStatus, fmi2String)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = ((Unit*) c)->state.reached;
  return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = fmi2False;
  return fmi2OK;
}
