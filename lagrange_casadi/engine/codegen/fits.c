/* Curves through a few values at equal steps of time, and where they are largest. */
#define SEARCH_FIT 7
/* What a polynomial may miss, of its curve, in its middle and near its ends: where it misses more, its slope may be off by other things
   as well. */
#define SEARCH_TRUST ((search_real) 1e-5)
#define SEARCH_TRUST_ASIDE ((search_real) 1e-6)
/* Of its curve: how large the sixth difference of a polynomial may be that is believed. */
#define SEARCH_ROUGH ((search_real) 0.1)
/* How far from a kink, in steps, both its sides are looked at. */
#define SEARCH_ASIDE ((search_real) 1e-2)

typedef union {
  lanes_pack pack;
  search_real lane[LANES];
} search_lanes;

/* Seven values at equal steps, where to begin, and bounds, in steps from the middle one; then what a polynomial through them says. */
typedef struct {
  search_lanes y[SEARCH_FIT], x, low, high, size, slope, curve, steep, rough;
} search_fit;

/* A value of a panel beside which a curve may rise: where to look, and what is expected there: its size, and the size's slope and
   curve by steps of time. What a polynomial misses there bends its slope by steep times that; its sixth difference shows how rough it
   is, unless it is broken by a kink or a jump. kink_t and kink_size are the times at which to look for a kink, if any, and the sizes
   expected there. */
typedef struct {
  int curve, closed, again, kinked, broken;
  long long at;
  double t, kink_t[3];
  search_real sign, size, slope, curve_there, steep, rough, trust, kink_size[3];
} search_summit;

static void search_solve(search_fit* fit) {
  const search_lanes* middle = fit->y + 3;
  const lanes_pack low = fit->low.pack, high = fit->high.pack;
  lanes_pack a[SEARCH_FIT], d[4], o[4], x = fit->x.pack, slope, curve, square;
  int k, trial;
  for (k = 1; k < 4; ++k) {
    d[k] = SEARCH_HALF*(middle[k].pack + middle[-k].pack) - middle->pack;
    o[k] = SEARCH_HALF*(middle[k].pack - middle[-k].pack);
  }
  a[0] = middle->pack;
  a[1] = (45*o[1] - 9*o[2] + o[3])*((search_real) 1/30);
  a[2] = (270*d[1] - 27*d[2] + 2*d[3])*((search_real) 1/180);
  a[3] = (8*o[2] - 13*o[1] - o[3])*((search_real) 1/24);
  a[4] = (12*d[2] - 39*d[1] - d[3])*((search_real) 1/72);
  a[5] = (5*o[1] - 4*o[2] + o[3])*((search_real) 1/120);
  a[6] = (15*d[1] - 6*d[2] + d[3])*((search_real) 1/360);
  for (trial = 0;; ++trial) {
    slope = a[1] + x*(2*a[2] + x*(3*a[3] + x*(4*a[4] + x*(5*a[5] + x*(6*a[6])))));
    curve = 2*a[2] + x*(6*a[3] + x*(12*a[4] + x*(20*a[5] + x*(30*a[6]))));
    if (trial == 4) break;
    x = lanes_less(curve, 0, x - slope/curve, x);
    x = lanes_less(low, x, lanes_less(x, high, x, high), low);
  }
  square = x*x;
  fit->x.pack = x;
  fit->size.pack = a[0] + x*(a[1] + x*(a[2] + x*(a[3] + x*(a[4] + x*(a[5] + x*a[6])))));
  fit->slope.pack = slope;
  fit->curve.pack = curve;
  /* The product of x - j over the seven places j, and its slope. */
  fit->steep.pack = (((7*square - 70)*square + 147)*square - 36)/(x*(((square - 14)*square + 49)*square - 36));
  fit->rough.pack = lanes_size(720*a[6]);
}

/* The first of seven values around value j of count, as far in the middle as there are. */
static long long search_window(long long j, long long count) {
  return j < 3 ? 0 : j > count - 4 ? count - SEARCH_FIT : j - 3;
}

/* Begin at value j of count, around which the first of the seven is given; an end keeps a little inside. */
static void search_begin(search_fit* fit, int lane, long long j, long long first, long long count) {
  const search_real from = (search_real) (j - first - 3), off = (search_real) 1e-5;
  fit->x.lane[lane] = from;
  fit->low.lane[lane] = j == 0 ? from + off : from - 1;
  fit->high.lane[lane] = j == count - 1 ? from - off : from + 1;
}

/* What a polynomial through seven values, of which the first is that at an end, says of the step there: its value in the middle, and
   the least size of its slope, by steps, at both ends and there: zero where it turns. */
static search_real search_stretch(const search_real* end, int inward, search_real* middle) {
  static const search_real weights[SEARCH_FIT][4] = {
    {(search_real) 231/1024, (search_real) -147/60, (search_real) -1627/1920, (search_real) -1/6},
    {(search_real) 1386/1024, (search_real) 6, (search_real) 633/1920, (search_real) -77/60},
    {(search_real) -1155/1024, (search_real) -7.5, (search_real) 2360/1920, (search_real) 2.5},
    {(search_real) 924/1024, (search_real) 400/60, (search_real) -2350/1920, (search_real) -100/60},
    {(search_real) -495/1024, (search_real) -3.75, (search_real) 1365/1920, (search_real) 50/60},
    {(search_real) 154/1024, (search_real) 1.2, (search_real) -443/1920, (search_real) -0.25},
    {(search_real) -21/1024, (search_real) -1/6, (search_real) 62/1920, (search_real) 2/60}};
  search_real sum[4], y;
  int k, j;
  /* Each sum in a register: together they are a pack, which compilers keep in memory. */
  for (k = 0; k < 4; ++k) {
    y = 0;
    for (j = 0; j < SEARCH_FIT; ++j) y += weights[j][k]*end[j*inward];
    sum[k] = y;
  }
  *middle = sum[0];
  y = sum[1] < 0 ? -1 : 1;
  for (k = 1; k < 4; ++k) sum[k] *= y;
  y = sum[1] < sum[2] ? sum[1] : sum[2];
  y = y < sum[3] ? y : sum[3];
  return y > 0 ? y : 0;
}

/* Where two parabolas through three sizes on either side of value j meet in a tip, if they do, and their sizes there; and a little
   before it and after it, for only there does each show what it is worth. */
static void search_kink(const search_real* row, search_summit* summit, double t, double step) {
  const search_real s = summit->sign;
  const search_real a1 = s*(row[-1] - row[-2]), a2 = s*(row[-1] - 2*row[-2] + row[-3])/2;
  const search_real b1 = s*(row[1] - row[2]), b2 = s*(row[1] - 2*row[2] + row[3])/2;
  const search_real bend = 2*((a2 < 0 ? -a2 : a2) + (b2 < 0 ? -b2 : b2));
  search_real left, right, up, down, x = 0;
  int trial, k;
  summit->kinked = 0;
  if (!(a1 + (a2 < 0 ? a2 : 5*a2) > bend && b1 + (b2 < 0 ? b2 : 5*b2) > bend)) return;
  for (trial = 0;; ++trial) {
    left = s*row[-1] + (x + 1)*(a1 + (x + 2)*a2);
    right = s*row[1] + (1 - x)*(b1 + (2 - x)*b2);
    up = a1 + (2*x + 3)*a2;
    down = b1 + (3 - 2*x)*b2;
    if (!(up > 0 && down > 0)) return;
    if (trial == 4) break;
    x -= (left - right)/(up + down);
    x = x > -1 ? (x < 1 ? x : 1) : -1;
  }
  if (!(up > bend && down > bend && x > -1 && x < 1 && left >= s*row[0])) return;
  summit->kinked = 1;
  for (k = 0; k < 3; ++k) {
    const search_real at = k == 0 ? x : k == 1 ? x - SEARCH_ASIDE : x + SEARCH_ASIDE;
    summit->kink_t[k] = t + step*(double) at;
    summit->kink_size[k] = k < 2 ? s*row[-1] + (at + 1)*(a1 + (at + 2)*a2) : s*row[1] + (1 - at)*(b1 + (2 - at)*b2);
  }
}
