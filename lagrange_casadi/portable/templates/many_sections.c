${p}_status ${p}_sections(const ${p}_model* model, const ${p}_outputs* outputs, ${p}_link link, long many, const ${p}_real* xi,
$indent ${p}_forces* forces) {
  ${p}_status first = ${P}_OK, status;
  long i;
  for (i = 0; i < many; ++i) {
    status = ${p}_section(model, outputs, link, xi[i], forces + i);
    if (first == ${P}_OK) first = status;
  }
  return first;
}
