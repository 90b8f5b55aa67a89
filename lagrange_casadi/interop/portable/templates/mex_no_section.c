static mxArray* section(const mxArray* given, const mxArray* link, const mxArray* ratios, const mxArray* parameters) {
  (void) given;
  (void) link;
  (void) ratios;
  (void) parameters;
  (void) names_of_links;
  mexErrMsgIdAndTxt("${p}:name", "there is no link with sections.");
  return 0;
}
