/* Curves through a few values at equal steps of time, and where they are largest. */
#define SEARCH_FIT 7
/* What a polynomial may miss, of its curve: where it misses more, its slope may be off by other things as well. */
#define SEARCH_TRUST ((search_real) 1e-5)
/* Of its curve: how large the sixth difference of a polynomial may be that is believed. */
#define SEARCH_ROUGH ((search_real) 0.1)

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
   is, unless it is broken by a kink or a jump. Where a polynomial goes straight on from an end through the step there, the middle of
   that is looked at, and what it may miss is counted in its slope. */
typedef struct {
  int curve, straight, closed, again, broken;
  long long at;
  double t;
  search_real sign, size, slope, curve_there, steep, rough, trust;
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

/* Whether a polynomial through seven values, of which the first is that at an end, goes straight on through the step there: what is
   expected of its middle. */
static int search_straight(const search_real* end, int inward, search_real rounding, search_summit* summit) {
  /* Of the values, over the last number: the value in the middle, the slopes, by steps, at both ends and there, the sixth difference. */
  static const search_real weights[5][SEARCH_FIT + 1] = {
    {231, 1386, -1155, 924, -495, 154, -21, 1024},
    {-147, 360, -450, 400, -225, 72, -10, 60},
    {-10, -77, 150, -100, 50, -15, 2, 60},
    {-1627, 633, 2360, -2350, 1365, -443, 62, 1920},
    {1, -6, 15, -20, 15, -6, 1, 1}};
  search_real sum[5], y, least;
  int k, j;
  for (k = 0; k < 5; ++k) {
    y = 0;
    for (j = 0; j < SEARCH_FIT; ++j) y += weights[k][j]*end[j*inward];
    sum[k] = y/weights[k][SEARCH_FIT];
  }
  least = sum[1] < 0 ? -search_upper(sum[1], search_upper(sum[2], sum[3])) : search_lower(sum[1], search_lower(sum[2], sum[3]));
  summit->rough = search_magnitude(sum[4]);
  summit->sign = sum[0] < 0 ? -1 : 1;
  summit->size = summit->sign*sum[0];
  summit->slope = summit->steep = 0;
  summit->curve_there = -least;
  summit->trust = SEARCH_STRETCH;
  return least > 0 && summit->rough <= rounding + SEARCH_ROUGH*least;
}
