static const struct {
  const char* name;
  double low, high;
} limits[PARAMETERS] = {
$rows
};

static int refused(const Unit* unit, unsigned k, double value) {
  char which[128];
  if (value - value == 0 && value >= limits[k].low && value <= limits[k].high) return 0;
  snprintf(which, sizeof which, "%.64s = %.9g: ", limits[k].name, value);
  report(unit, fmi2Error, which, ${p}_message(${P}_BAD_PARAMETER));
  return 1;
}

