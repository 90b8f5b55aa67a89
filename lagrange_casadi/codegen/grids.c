/* Section forces over instants and ratios, row by row: a combination of a few functions along the link. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define TILE 2048

/* Put a tile into memory without reading first what it replaces, nor turning other data out of the cache. */
static void stream(double* out, const double* tile, long long n) {
  long long i = 0;
#ifdef __SSE2__
  if (((uintptr_t) out & 15) != 0 && n > 0) {
    out[0] = tile[0];
    i = 1;
  }
  if (((uintptr_t) (out + i) & 15) == 0) {
    for (; i + 2 <= n; i += 2) _mm_stream_pd(out + i, _mm_loadu_pd(tile + i));
  }
#endif
  memcpy(out + i, tile + i, (size_t) (n - i)*sizeof(double));
}

/* One row: sum of c[m]*basis[m][j] over one or more terms, in this order. */
static void combine(long long n, int terms, const double* c, const double* const* basis, double* restrict row) {
  const double c0 = c[0], *b0 = basis[0];
  long long j;
  int m;
  if (terms == 1) {
    for (j = 0; j < n; ++j) row[j] = c0*b0[j];
  } else if (terms == 2) {
    const double c1 = c[1], *b1 = basis[1];
    for (j = 0; j < n; ++j) row[j] = c0*b0[j] + c1*b1[j];
  } else if (terms == 3) {
    const double c1 = c[1], c2 = c[2], *b1 = basis[1], *b2 = basis[2];
    for (j = 0; j < n; ++j) row[j] = (c0*b0[j] + c1*b1[j]) + c2*b2[j];
  } else {
    const double c1 = c[1], c2 = c[2], c3 = c[3], *b1 = basis[1], *b2 = basis[2], *b3 = basis[3];
    for (j = 0; j < n; ++j) row[j] = ((c0*b0[j] + c1*b1[j]) + c2*b2[j]) + c3*b3[j];
  }
  for (m = 4; m < terms; ++m) {
    const double cm = c[m], *bm = basis[m];
    for (j = 0; j < n; ++j) row[j] = row[j] + cm*bm[j];
  }
}

/* The size of two planes' sums of three or four terms each, in one pass: a row is then written once, as fast as memory takes it. */
static void combine_sizes(long long n, int terms, const double* c, const double* const* basis, double* restrict row) {
  const double *const d = c + terms, *const *beside = basis + terms;
  const double c0 = c[0], c1 = c[1], c2 = c[2], *b0 = basis[0], *b1 = basis[1], *b2 = basis[2];
  const double d0 = d[0], d1 = d[1], d2 = d[2], *e0 = beside[0], *e1 = beside[1], *e2 = beside[2];
  long long j;
  if (terms == 3) {
    for (j = 0; j < n; ++j) {
      const double x = (c0*b0[j] + c1*b1[j]) + c2*b2[j], y = (d0*e0[j] + d1*e1[j]) + d2*e2[j];
      row[j] = sqrt(x*x + y*y);
    }
  } else {
    const double c3 = c[3], d3 = d[3], *b3 = basis[3], *e3 = beside[3];
    for (j = 0; j < n; ++j) {
      const double x = ((c0*b0[j] + c1*b1[j]) + c2*b2[j]) + c3*b3[j], y = ((d0*e0[j] + d1*e1[j]) + d2*e2[j]) + d3*e3[j];
      row[j] = sqrt(x*x + y*y);
    }
  }
}

/* What acts at a station is seen by the sections on its base side, and at the very tip always. */
static void act(long long n, double station, double constant, double slope, const double* u, double* restrict row) {
  const int at_tip = station >= 1.0;
  long long j;
  for (j = 0; j < n; ++j) {
    const int seen = (u[j] < station) | ((u[j] >= 1.0) & at_tip);
    row[j] += seen ? constant + slope*(station - u[j]) : 0.0;
  }
}

/* A row at an instant i: in one plane what acts there, and with two planes the size of both; other is room for the second one's. */
static void whole(long long n, const double* const* columns, const double* const* along, int planes, int terms,
                  const double* const* acting, int loads, long long i, const double* u, double* restrict row, double* restrict other) {
  double c[MOST];
  long long j;
  int m, s, plane;
  for (m = 0; m < planes*terms; ++m) c[m] = columns[m][i];
  if (planes == 2 && !loads && (terms == 3 || terms == 4)) {
    combine_sizes(n, terms, c, along, row);
    return;
  }
  for (plane = 0; plane < planes; ++plane) {
    double* sum = plane ? other : row;
    combine(n, terms, c + plane*terms, along + plane*terms, sum);
    for (s = plane*loads; s < (plane + 1)*loads; ++s) {
      const double* const* load = acting + 3*s;
      act(n, load[0][i], load[1][i], load[2][i], u, sum);
    }
  }
  if (planes == 2) {
    for (j = 0; j < n; ++j) row[j] = sqrt(row[j]*row[j] + other[j]*other[j]);
  }
}

/* out[i*k + j], n rows of k ratios u. columns[m][i] are the coefficients of basis[m*k + j], and acting[3*s], [3*s + 1], [3*s + 2] the
   station, the constant and the slope of load s. With two planes there are so many terms and loads of each, one plane's after the
   other's, and out is the size of both. */
__attribute__((visibility("default")))
void lagrange_casadi_grid(const lagrange_casadi_grid_call* call) {
  const long long n = call->n, k = call->k;
  const int planes = call->planes, terms = call->terms, loads = call->loads, streams = call->streams;
  const double *const *columns = call->columns, *const *acting = call->acting, *basis = call->basis, *u = call->u;
  double* out = call->out;
  double tile[TILE], other[TILE];
  const double* along[MOST];
  const long long width = k < TILE ? k : TILE, rows = TILE/width;
  long long first, start, i;
  int m;
  for (first = 0; first < n; first += rows) {
    const long long many = n - first < rows ? n - first : rows;
    for (start = 0; start < k; start += width) {
      const long long size = k - start < width ? k - start : width;
      double* rows_here = streams ? tile : out + first*k + start;
      for (m = 0; m < planes*terms; ++m) along[m] = basis + m*k + start;
      for (i = 0; i < many; ++i) {
        whole(size, columns, along, planes, terms, acting, loads, first + i, u + start, rows_here + i*size, other);
      }
      if (streams) stream(out + first*k + start, tile, many*size);
    }
  }
#ifdef __SSE2__
  if (streams) _mm_sfence();
#endif
}

/* out[d*k + j], of so many designs: over n instants, what is largest in size at each of k ratios u, with its sign; of sizes that are
   the same, the positive one. As above, but columns[m][d*n + i] are the coefficients of basis[(m*designs + d)*k + j], and loads have
   a value for every d*n + i. All of them must be finite. */
__attribute__((visibility("default")))
void lagrange_casadi_largest(const lagrange_casadi_largest_call* call) {
  const long long designs = call->designs, n = call->n, k = call->k;
  const int planes = call->planes, terms = call->terms, loads = call->loads;
  const double *const *columns = call->columns, *const *acting = call->acting, *basis = call->basis, *u = call->u;
  double* out = call->out;
  double row[TILE], other[TILE], high[TILE], low[TILE];
  const double* along[MOST];
  long long d, start, i, j;
  int m;
  for (d = 0; d < designs; ++d) {
    for (start = 0; start < k; start += TILE) {
      const long long size = k - start < TILE ? k - start : TILE;
      for (m = 0; m < planes*terms; ++m) along[m] = basis + (m*designs + d)*k + start;
      for (j = 0; j < size; ++j) {
        high[j] = -HUGE_VAL;
        low[j] = HUGE_VAL;
      }
      for (i = d*n; i < (d + 1)*n; ++i) {
        whole(size, columns, along, planes, terms, acting, loads, i, u + start, row, other);
        for (j = 0; j < size; ++j) {
          high[j] = row[j] > high[j] ? row[j] : high[j];
          low[j] = row[j] < low[j] ? row[j] : low[j];
        }
      }
      for (j = 0; j < size; ++j) out[d*k + start + j] = high[j] >= -low[j] ? high[j] : low[j];
    }
  }
}
