
/* A step between two instants, so many seconds apart. */
typedef struct {
  ${p}_model* model;
  const ${p}_inputs* before;
  const ${p}_inputs* after;
  casadi_real width;
} centre_step;

typedef casadi_real centre_real;

static const casadi_real zero[$many] = {$limits};

/* How far a coordinate that changes by so much has come at a fraction x of a step of h seconds, with its rates and accelerations
   at both ends; where h is 0, on the straight way. Its rate and acceleration there, for a unit of x, are what is
   returned by way of rate and acceleration. */
static casadi_real come(casadi_real x, casadi_real h, casadi_real change, casadi_real from_v, casadi_real to_v, casadi_real from_a,
                        casadi_real to_a, casadi_real* rate, casadi_real* acceleration) {
  const casadi_real v0 = h != 0 ? h*from_v : change, v1 = h != 0 ? h*to_v : change, a0 = h*h*from_a, a1 = h*h*to_a;
  const casadi_real left = change - v0 - a0/2, gain = v1 - v0 - a0, bend = a1 - a0;
  const casadi_real c3 = 10*left - 4*gain + bend/2, c4 = 7*gain - 15*left - bend, c5 = 6*left - 3*gain + bend/2;
  *rate = v0 + x*(a0 + x*(3*c3 + x*(4*c4 + x*5*c5)));
  *acceleration = a0 + x*(6*c3 + x*(12*c4 + x*20*c5));
  return x*(v0 + x*(a0/2 + x*(c3 + x*(c4 + x*c5))));
}

/* Squares of sines of all loops at a fraction x of a step, their rates for a unit of x, and their slopes; NaN where loops do not
   converge. */
static void centre_at(const centre_step* step, casadi_real x, casadi_real* squares, casadi_real* rates, casadi_real* slopes) {
  const ${p}_inputs *before = step->before, *after = step->after;
  const casadi_real h = step->width;
  casadi_real moment[$moment], counted[$counted], rate[$drives], acceleration[$drives], gone;
$kept  const casadi_real* arg[5];
  casadi_real* res[3];
  int k;
$given
  for (k = 0; k < $many; ++k) rates[k] = rates[k] + (h - 1)*slopes[$slopes*k];
}

static void centre_path(const centre_step* step, int which, const centre_real* x, centre_real* square, centre_real* rate,
                        centre_real* slope) {
  casadi_real squares[$many], rates[$many], slopes[$all];
  int j, k;
  for (j = 0; j < $points; ++j) {
    centre_at(step, x[j], squares, rates, slopes);
    square[j] = squares[which];
    rate[j] = rates[which];
    for (k = 0; k < $slopes; ++k) slope[$slopes*j + k] = slopes[$slopes*which + k];
  }
}

$rule
${p}_status ${p}_between(${p}_model* model, const ${p}_inputs* before, const ${p}_inputs* after, ${p}_real step) {
  casadi_real squares[2][$many], rates[2][$many], slopes[$all];
  centre_step whole;
  int k;
  if (model->seal != SEAL) return ${P}_NOT_PREPARED;
  if (!is_finite($sum + step)) return ${P}_BAD_INPUT;
  whole.model = model;
  whole.before = before;
  whole.after = after;
  whole.width = step;
  centre_at(&whole, 0, squares[0], rates[0], slopes);
  centre_at(&whole, 1, squares[1], rates[1], slopes);
  for (k = 0; k < $many; ++k) {
    if (rates[0][k] > 0 && !(rates[1][k] > 0 && squares[1][k] <= squares[0][k])) continue;
    if (rates[1][k] < 0 && !(rates[0][k] < 0 && squares[0][k] <= squares[1][k])) continue;
    if (centre_passes(&whole, k, zero[k])) return ${P}_PASSES_DEAD_CENTRE;
  }
  return ${P}_OK;
}
