
static void check_sections(const ${p}_model* model, const ${p}_outputs* outputs, int k) {
  static const ${p}_link links[LINKS] = {
$links
  };
  int i, j;
  for (i = 0; i < LINKS; ++i) {
    for (j = 0; j < RATIOS; ++j) {
      const double* row = forces_at[k] + $many*(RATIOS*i + j);
      ${p}_forces forces;
      expect(${p}_section(model, outputs, links[i], (${p}_real) ratios[j], &forces), ${P}_OK);
$comparisons
    }
  }
}
