/* The columns of a cycle table over instants: splines of the drive's angle, times powers of its rate and its acceleration. Nothing
   here needs a sine, memory to be had, or the operating system; with REAL = float no double either. */
#include <string.h>
#include <tgmath.h>

#ifndef REAL
#define REAL double
#endif
typedef REAL real;

/* Instants of a block, which a column gets side by side, and of a pack, which may lie between the same two nodes: where instants come
   one by one, define both as 1. Columns of a tile. */
#ifndef BLOCK
#define BLOCK 64
#define PACK 16
#endif
#define TILE 32
#define WEIGHTS 6
#define FACTORS 4

/* For a pack, the node before each angle, and the weights, times 120, of the six coefficients around it. cell holds the inverse of the distance
   of nodes, the distance in two parts of which the first has few digits, so that whole multiples of it are exact, and 1/nodes. */
static void weigh(int from, const real* restrict angle, real nodes, const real* restrict cell, real* restrict node,
                  real (*restrict w)[BLOCK]) {
  const real inverse = cell[0], first = cell[1], rest = cell[2], round = cell[3];
  int b;
  for (b = from; b < from + PACK; ++b) {
    const real whole = floor(angle[b]*inverse);
    const real u = ((angle[b] - whole*first) - whole*rest)*inverse, v = 1 - u;
    const real u2 = u*u, v2 = v*v;
    real at = whole - nodes*floor(whole*round);
    w[0][b] = v2*(v2*v);
    w[1][b] = (26 - 50*u) + u2*(20 + u*(20 + u*(5*u - 20)));
    w[2][b] = 66 + u2*(u2*(30 - 10*u) - 60);
    w[3][b] = 66 + v2*(v2*(30 - 10*v) - 60);
    w[4][b] = (26 - 50*v) + v2*(20 + v*(20 + v*(5*v - 20)));
    w[5][b] = u2*(u2*u);
    /* The product with 1/nodes may have been rounded over a whole number; and what is no number still reads from the table. */
    at += at < 0 ? nodes : 0;
    at -= at >= nodes ? nodes : 0;
    node[b] = at >= 0 && at < nodes ? at : 0;
  }
}

/* A pack of instants between the same two nodes: each coefficient is read once for all of them. */
static void together(const int* run, const int* end, int first, int terms, const real* c, int from, real (*restrict w)[BLOCK],
                     real (*restrict factor)[BLOCK], real (*restrict y)[BLOCK]) {
  int k, b;
  for (; run < end; run += 3) {
    const real* g = factor[run[0]];
    for (k = 0; k < run[2]; ++k, ++c) {
      const real c0 = c[0], c1 = c[terms], c2 = c[2*terms], c3 = c[3*terms], c4 = c[4*terms], c5 = c[5*terms];
      real* row = y[run[1] - first + k];
      for (b = from; b < from + PACK; ++b) {
        row[b] += g[b]*(((((w[0][b]*c0 + w[1][b]*c1) + w[2][b]*c2) + w[3][b]*c3) + w[4][b]*c4) + w[5][b]*c5);
      }
    }
  }
}

/* One instant of a block: the terms of a node lie side by side. */
static void apart(const int* run, const int* end, int first, int size, int terms, int many, const real* c, int b,
                  real (*restrict w)[BLOCK], real (*restrict factor)[BLOCK], real (*restrict y)[BLOCK]) {
  const real w0 = w[0][b], w1 = w[1][b], w2 = w[2][b], w3 = w[3][b], w4 = w[4][b], w5 = w[5][b];
  const real *c1 = c + terms, *c2 = c1 + terms, *c3 = c2 + terms, *c4 = c3 + terms, *c5 = c4 + terms;
  real term[FACTORS*TILE], sum[TILE];
  const real* next = term;
  int m, k;
  for (m = 0; m < many; ++m) {
    term[m] = ((((w0*c[m] + w1*c1[m]) + w2*c2[m]) + w3*c3[m]) + w4*c4[m]) + w5*c5[m];
  }
  for (k = 0; k < size; ++k) sum[k] = 0;
  for (; run < end; next += run[2], run += 3) {
    const real g = factor[run[0]][b];
    real* part = sum + (run[1] - first);
    for (k = 0; k < run[2]; ++k) part[k] += g*next[k];
  }
  for (k = 0; k < size; ++k) y[k][b] = sum[k];
}

/* out[order[k]*stride + i] becomes the column in place k at instant i of n. coefficients has a row of terms for each node and five
   more. runs holds triples: a factor (0: one, 1: rate, 2: its square, 3: acceleration) multiplies the next so many terms of a row,
   for columns from this place on; no run goes over a multiple of TILE, and they are in the order of these. */
static void interpolate(long long n, long long stride, const real* angle, const real* rate, const real* acceleration,
                        int nodes, const real* cell, int terms, const real* coefficients, int columns, const int* order,
                        const real* drift, int count, const int* runs, real* out) {
  real at[BLOCK], node[BLOCK], w[WEIGHTS][BLOCK], factor[FACTORS][BLOCK], y[TILE][BLOCK];
  long long i;
  for (i = 0; i < n; i += BLOCK) {
    const int many = n - i < BLOCK ? (int) (n - i) : BLOCK;
    const int *run = runs, *end;
    int b, k, first, offset = 0;
    for (b = 0; b < BLOCK; ++b) {
      /* The last block is filled up with the last instant. */
      const long long instant = i + (b < many ? b : many - 1);
      at[b] = angle[instant];
      factor[0][b] = 1;
      factor[1][b] = rate[instant];
      factor[2][b] = rate[instant]*rate[instant];
      factor[3][b] = acceleration[instant];
    }
    for (b = 0; b < many; b += PACK) weigh(b, at, (real) nodes, cell, node, w);
    for (first = 0; first < columns; first += TILE) {
      const int size = columns - first < TILE ? columns - first : TILE;
      int here = 0;
      for (end = run; end < runs + 3*count && end[1] < first + size; end += 3) here += end[2];
      for (b = 0; b < many; b += PACK) {
        const real* c = coefficients + offset;
        int same = 1;
        for (k = b + 1; k < b + PACK; ++k) same &= node[k] == node[b];
        if (same) {
          for (k = 0; k < size; ++k) memset(y[k] + b, 0, PACK*sizeof(real));
          together(run, end, first, terms, c + (long long) node[b]*terms, b, w, factor, y);
        } else {
          for (k = b; k < b + PACK; ++k) apart(run, end, first, size, terms, here, c + (long long) node[k]*terms, k, w, factor, y);
        }
      }
      run = end;
      offset += here;
      for (k = 0; k < size; ++k) {
        const real slope = drift[first + k];
        if (slope != 0) for (b = 0; b < BLOCK; ++b) y[k][b] += slope*at[b];
        memcpy(out + order[first + k]*stride + i, y[k], (size_t) many*sizeof(real));
      }
    }
  }
}
