
static void check_sections(const ${p}_model* model, const ${p}_outputs* outputs, int k) {
  static const ${p}_link links[LINKS] = {
$links
  };
  int i, j;
  for (i = 0; i < LINKS; ++i) {
    for (j = 0; j < RATIOS; ++j) {
      const double* row = forces_at[k] + 3*(RATIOS*i + j);
      ${p}_forces forces;
      expect(${p}_section(model, outputs, links[i], (${p}_real) ratios[j], &forces), ${P}_OK);
      compare("axial force", row[0], (double) forces.axial, forces_off[3*i], 0);
      compare("shear force", row[1], (double) forces.shear, forces_off[3*i + 1], 0);
      compare("bending moment", row[2], (double) forces.bending, forces_off[3*i + 2], 0);
    }
  }
}
