/* $name for MATLAB and Octave. Build it by build_mex.m; mex_example.m uses it; ${p}.h says what each member is.

     outputs = ${p}_mex(inputs)
     outputs = ${p}_mex(inputs, parameters)
     inputs = ${p}_mex('motion', t)                          the scene's motion, at times t [s]
     inputs = ${p}_mex('motion', t, parameters)
     forces = ${p}_mex('section', outputs, link, xi)         of a link, at ratios xi from 0 (base) to 1 (tip)
     forces = ${p}_mex('section', outputs, link, xi, parameters)
     text = ${p}_mex('message', status)

   inputs and outputs are structs of vectors, all with a number for each instant; outputs.status is 0 where all is well, and where
   it is not the other members are NaN. forces has matrices $matrices: a row for each instant, a column for each
   ratio; it wants the parameters that the outputs were evaluated with. parameters is a struct of numbers: what it does not name has
$if rests
   its default.
   Numbers are doubles here: what single precision would round off a coordinate or a time is kept,
   without a member of its own. */
$end rests
$if not rests
   its default. */
$end rests
#include "${p}.h"

#include "mex.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define LISTED 1000

/* A member of a struct: its name, its place, and the place of what rounding leaves of it, or 0. */
typedef struct {
  const char* name;
  size_t place, rest;
} member;

static const member members_of_inputs[] = {
$inputs
  {0, 0, 0}
};
static const member members_of_outputs[] = {
$outputs
  {0, 0, 0}
};
static const member members_of_parameters[] = {
$parameters
  {0, 0, 0}
};

static void put(void* to, const member* m, double value) {
  const ${p}_real rounded = (${p}_real) value;
  *(${p}_real*) ((char*) to + m->place) = rounded;
  if (m->rest) *(${p}_real*) ((char*) to + m->rest) = (${p}_real) (value - (double) rounded);
}

static double get(const void* from, const member* m) {
  const double value = (double) *(const ${p}_real*) ((const char*) from + m->place);
  return m->rest ? value + (double) *(const ${p}_real*) ((const char*) from + m->rest) : value;
}

static void add_name(char* list, const char* name) {
  const char* before = *list ? ", " : "";
  if (strlen(list) + strlen(before) + strlen(name) + 1 > LISTED) return;
  strcat(list, before);
  strcat(list, name);
}

static int is_numbers(const mxArray* given) {
  return given && (mxIsDouble(given) || mxIsSingle(given)) && !mxIsComplex(given) && !mxIsSparse(given);
}

static int is_vector(const mxArray* given) {
  return is_numbers(given) && mxGetNumberOfDimensions(given) == 2 && (mxGetM(given) == 1 || mxGetN(given) == 1 || mxIsEmpty(given));
}

static double number(const mxArray* given, size_t k) {
  return mxIsSingle(given) ? (double) ((const float*) mxGetData(given))[k] : ((const double*) mxGetData(given))[k];
}

static void check_struct(const mxArray* given, const char* what, const member* members, const char* besides) {
  int k;
  if (!mxIsStruct(given) || mxGetNumberOfElements(given) != 1) {
    mexErrMsgIdAndTxt("${p}:type", "%s must be one struct, by member names.", what);
  }
  for (k = 0; k < mxGetNumberOfFields(given); ++k) {
    const char* name = mxGetFieldNameByNumber(given, k);
    const member* m = members;
    while (m->name && strcmp(m->name, name) != 0) ++m;
    if (!m->name && strcmp(name, besides) != 0) {
      char list[LISTED] = "";
      for (m = members; m->name; ++m) add_name(list, m->name);
      mexErrMsgIdAndTxt("${p}:name", "%s have no member '%s'; valid: %s.", what, name, *list ? list : "none");
    }
  }
}

/* The vectors of a struct, one a member and all equally long. */
static void vectors_of(const mxArray* given, const char* what, const member* members, const mxArray** found) {
  int k;
  for (k = 0; members[k].name; ++k) {
    found[k] = mxGetField(given, 0, members[k].name);
    if (!found[k]) mexErrMsgIdAndTxt("${p}:name", "%s lack the member '%s'.", what, members[k].name);
    if (!is_vector(found[k])) {
      mexErrMsgIdAndTxt("${p}:type", "member '%s' of %s must be a vector of real numbers.", members[k].name, what);
    }
    if (mxGetNumberOfElements(found[k]) != mxGetNumberOfElements(found[0])) {
      mexErrMsgIdAndTxt("${p}:size", "member '%s' of %s has %lu numbers, and '%s' has %lu; all must have the same count.",
                        members[k].name, what, (unsigned long) mxGetNumberOfElements(found[k]), members[0].name,
                        (unsigned long) mxGetNumberOfElements(found[0]));
    }
  }
}

/* A new member of a struct. */
static void* added(mxArray* to, const char* name, size_t rows, size_t columns, mxClassID type) {
  mxArray* values = mxCreateNumericMatrix((mwSize) rows, (mwSize) columns, type, mxREAL);
  if (mxAddField(to, name) < 0) mexErrMsgIdAndTxt("${p}:name", "'%s' is not a valid name of a member.", name);
  mxSetField(to, 0, name, values);
  return mxGetData(values);
}

static void prepare(${p}_model* model, const mxArray* given) {
  ${p}_status status;
$if setting
  ${p}_parameters parameters = ${p}_defaults;
  int k;
  if (given) check_struct(given, "parameters", members_of_parameters, "");
  for (k = 0; given && members_of_parameters[k].name; ++k) {
    const mxArray* value = mxGetField(given, 0, members_of_parameters[k].name);
    if (!value) continue;
    if (!is_numbers(value) || mxGetNumberOfElements(value) != 1) {
      mexErrMsgIdAndTxt("${p}:type", "parameter '%s' must be one real number.",
                        members_of_parameters[k].name);
    }
    put(&parameters, members_of_parameters + k, number(value, 0));
  }
  status = ${p}_prepare(model, &parameters);
$end setting
$if not setting
  if (given) check_struct(given, "parameters", members_of_parameters, "");
  status = ${p}_prepare(model);
$end setting
  if (status != ${P}_OK) mexErrMsgIdAndTxt("${p}:parameters", "%s.", ${p}_message(status));
}

static mxArray* evaluate(const mxArray* given, const mxArray* parameters) {
  const mxArray* vectors[sizeof members_of_inputs/sizeof(member)];
  double* columns[sizeof members_of_outputs/sizeof(member)];
  mxArray* found = mxCreateStructMatrix(1, 1, 0, 0);
  ${p}_model model;
  int32_t* statuses;
  size_t i, rows, width;
  int k;
  check_struct(given, "inputs", members_of_inputs, "");
  vectors_of(given, "inputs", members_of_inputs, vectors);
  prepare(&model, parameters);
  rows = mxGetM(vectors[0]);
  width = mxGetN(vectors[0]);
  for (k = 0; members_of_outputs[k].name; ++k) columns[k] = added(found, members_of_outputs[k].name, rows, width, mxDOUBLE_CLASS);
  statuses = added(found, "status", rows, width, mxINT32_CLASS);
  for (i = 0; i < rows*width; ++i) {
    ${p}_inputs inputs;
    ${p}_outputs outputs;
    for (k = 0; members_of_inputs[k].name; ++k) put(&inputs, members_of_inputs + k, number(vectors[k], i));
    statuses[i] = (int32_t) ${p}_evaluate(&model, &inputs, &outputs);
    for (k = 0; members_of_outputs[k].name; ++k) columns[k][i] = get(&outputs, members_of_outputs + k);
  }
  return found;
}

static mxArray* motion(const mxArray* times, const mxArray* parameters) {
  double* columns[sizeof members_of_inputs/sizeof(member)];
  mxArray* found = mxCreateStructMatrix(1, 1, 0, 0);
  ${p}_model model;
  size_t i;
  int k;
  if (!is_vector(times)) mexErrMsgIdAndTxt("${p}:type", "times must be a vector of real numbers.");
  prepare(&model, parameters);
  for (k = 0; members_of_inputs[k].name; ++k) {
    columns[k] = added(found, members_of_inputs[k].name, mxGetM(times), mxGetN(times), mxDOUBLE_CLASS);
  }
  for (i = 0; i < mxGetNumberOfElements(times); ++i) {
    const double t = number(times, i);
    ${p}_inputs inputs;
    const ${p}_status status = ${p}_motion(&model, $time, &inputs);
    if (status != ${P}_OK) mexErrMsgIdAndTxt("${p}:time", "t(%lu) = %g s: %s.", (unsigned long) i + 1, t, ${p}_message(status));
    for (k = 0; members_of_inputs[k].name; ++k) columns[k][i] = get(&inputs, members_of_inputs + k);
  }
  return found;
}

$if link
static const char* const names_of_links[] = {$links, 0};

static mxArray* section(const mxArray* given, const mxArray* link, const mxArray* ratios, const mxArray* parameters) {
  const mxArray* vectors[sizeof members_of_outputs/sizeof(member)];
  mxArray* found = mxCreateStructMatrix(1, 1, 0, 0);
  double $pointers;
  ${p}_model model;
  const char* name;
  size_t i, j, many, width;
  int k, number_of_link = 0;
  check_struct(given, "outputs", members_of_outputs, "status");
  vectors_of(given, "outputs", members_of_outputs, vectors);
  if (!mxIsChar(link)) mexErrMsgIdAndTxt("${p}:type", "a link must be given by its name, a row of characters.");
  name = mxArrayToString(link);
  while (names_of_links[number_of_link] && strcmp(names_of_links[number_of_link], name) != 0) ++number_of_link;
  if (!names_of_links[number_of_link]) {
    char list[LISTED] = "";
    for (k = 0; names_of_links[k]; ++k) add_name(list, names_of_links[k]);
    mexErrMsgIdAndTxt("${p}:name", "there is no link '%s' with sections; valid: %s.", name, list);
  }
  if (!is_vector(ratios)) mexErrMsgIdAndTxt("${p}:type", "ratios xi must be a vector of real numbers.");
  prepare(&model, parameters);
  many = mxGetNumberOfElements(vectors[0]);
  width = mxGetNumberOfElements(ratios);
$added
  for (j = 0; j < width; ++j) {
    const double xi = number(ratios, j);
    if (!(xi >= 0 && xi <= 1)) {
      mexErrMsgIdAndTxt("${p}:ratio", "xi(%lu) = %g: a ratio must be from 0 to 1.", (unsigned long) j + 1, xi);
    }
    for (i = 0; i < many; ++i) {
      ${p}_outputs outputs;
      ${p}_forces forces;
      for (k = 0; members_of_outputs[k].name; ++k) put(&outputs, members_of_outputs + k, number(vectors[k], i));
      ${p}_section(&model, &outputs, (${p}_link) number_of_link, (${p}_real) xi, &forces);
$filled
    }
  }
  return found;
}
$end link

static mxArray* message(const mxArray* status) {
  if (!(mxIsInt32(status) || is_numbers(status)) || mxGetNumberOfElements(status) != 1) {
    mexErrMsgIdAndTxt("${p}:type", "a status must be one number.");
  }
  return mxCreateString(${p}_message((${p}_status) (int) mxGetScalar(status)));
}

void mexFunction(int nlhs, mxArray* plhs[], int nrhs, const mxArray* prhs[]) {
  char word[16] = "";
  const int named = nrhs > 0 && mxIsChar(prhs[0]);
  if (named && mxGetString(prhs[0], word, sizeof word) != 0) word[0] = 0;
  if (nlhs > 1) mexErrMsgIdAndTxt("${p}:arguments", "%d results were requested; there is one.", nlhs);
  if (!named && (nrhs == 1 || nrhs == 2)) {
    plhs[0] = evaluate(prhs[0], nrhs > 1 ? prhs[1] : 0);
  } else if (strcmp(word, "motion") == 0 && (nrhs == 2 || nrhs == 3)) {
    plhs[0] = motion(prhs[1], nrhs > 2 ? prhs[2] : 0);
  } else if (strcmp(word, "section") == 0 && (nrhs == 4 || nrhs == 5)) {
$if link
    plhs[0] = section(prhs[1], prhs[2], prhs[3], nrhs > 4 ? prhs[4] : 0);
$end link
$if not link
    mexErrMsgIdAndTxt("${p}:name", "there is no link with sections.");
$end link
  } else if (strcmp(word, "message") == 0 && nrhs == 2) {
    plhs[0] = message(prhs[1]);
  } else {
    mexErrMsgIdAndTxt("${p}:arguments", "expected (inputs), ('motion', t) or ('section', outputs, link, xi), each with parameters "
                      "or without, or ('message', status).");
  }
}
