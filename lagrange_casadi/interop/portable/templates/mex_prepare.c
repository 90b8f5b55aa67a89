  ${p}_parameters parameters = ${p}_defaults;
  int k;
$check  for (k = 0; given && members_of_parameters[k].name; ++k) {
    const mxArray* value = mxGetField(given, 0, members_of_parameters[k].name);
    if (!value) continue;
    if (!is_numbers(value) || mxGetNumberOfElements(value) != 1) {
      mexErrMsgIdAndTxt("${p}:type", "parameter '%s' must be one real number.",
                        members_of_parameters[k].name);
    }
    put(&parameters, members_of_parameters + k, number(value, 0));
  }
  status = ${p}_prepare(model, &parameters);