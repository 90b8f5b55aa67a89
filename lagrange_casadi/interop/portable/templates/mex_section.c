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
