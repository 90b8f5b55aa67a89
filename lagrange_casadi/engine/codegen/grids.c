/* Section forces over instants and ratios, row by row: a combination of a few functions along the link. */
#include <math.h>
#include <stdint.h>
#if defined(__AVX512F__)
#include <immintrin.h>
#define WIDE 8
#define PAST(out, from) _mm512_stream_pd(out, _mm512_loadu_pd(from))
#elif defined(__AVX__)
#include <immintrin.h>
#define WIDE 4
#define PAST(out, from) _mm256_stream_pd(out, _mm256_loadu_pd(from))
#elif defined(__SSE2__)
#include <emmintrin.h>
#define WIDE 2
#define PAST(out, from) _mm_stream_pd(out, _mm_loadu_pd(from))
#endif

/* So many values stay in the nearest cache beside the functions that they are combined of. */
#define TILE 512

/* Put a tile into memory without reading first what it replaces, nor turning other data out of the cache. */
static void stream(double* out, const double* tile, long long n) {
  long long i = 0;
#ifdef PAST
  for (; i < n && ((uintptr_t) (out + i) & (WIDE*sizeof(double) - 1)) != 0; ++i) out[i] = tile[i];
  for (; i + WIDE <= n; i += WIDE) PAST(out + i, tile + i);
#endif
  for (; i < n; ++i) out[i] = tile[i];
}

/* Of rows of n values each: the sum of columns[m][i]*basis[m][j] over terms, in this order, or the size of two planes' sums; the first
   function is one, and is not read. Compiled for numbers of planes and terms that are known, so that a row is written once: roots, or
   memory, are then all that takes time. A row that another one follows goes on to a whole number of LINEs, as functions do: what is too
   much there that row replaces. */
static inline __attribute__((always_inline)) void combine(long long many, long long n, const int planes, const int terms,
                                                          const double* const* columns, long long i, const double* const* basis,
                                                          double* restrict row) {
  const long long end = i + many;
  long long j;
  int m;
  for (; i < end; ++i, row += n) {
    const long long size = n >= LINE && i + 1 < end ? (n + LINE - 1)/LINE*LINE : n;
    double c[8];
    for (m = 0; m < planes*terms; ++m) c[m] = columns[m][i];
    for (j = 0; j < size; ++j) {
      double x = c[0], y;
      for (m = 1; m < terms; ++m) x = x + c[m]*basis[m][j];
      if (planes == 2) {
        y = c[terms];
        for (m = 1; m < terms; ++m) y = y + c[terms + m]*basis[m][j];
        x = sqrt(x*x + y*y);
      }
      row[j] = x;
    }
  }
}

/* Rows of one plane. What acts at a load point is carried by the sections whose edge it is beyond: see edge in
   engine/section_function.py. */
static void add_up(long long many, long long n, int terms, const double* const* columns, const double* const* basis,
                   const double* const* acting, int loads, long long i, const double* u, const double* beyond,
                   double* restrict row) {
  const long long end = i + many;
  long long j;
  int m, s;
  if (terms == 1) combine(many, n, 1, 1, columns, i, basis, row);
  else if (terms == 2) combine(many, n, 1, 2, columns, i, basis, row);
  else if (terms == 3) combine(many, n, 1, 3, columns, i, basis, row);
  else combine(many, n, 1, 4, columns, i, basis, row);
  for (; i < end; ++i, row += n) {
    for (m = 4; m < terms; ++m) {
      const double c = columns[m][i], *b = basis[m];
      for (j = 0; j < n; ++j) row[j] = row[j] + c*b[j];
    }
    for (s = 0; s < loads; ++s) {
      const double station = acting[3*s][i], constant = acting[3*s + 1][i], slope = acting[3*s + 2][i];
      for (j = 0; j < n; ++j) row[j] += beyond[j] < station ? constant + slope*(station - u[j]) : 0.0;
    }
  }
}

/* Rows from instant i on: of one plane, or the size of two; other is room for the second one's. */
static void whole(long long many, long long n, const double* const* columns, const double* const* basis, int planes, int terms,
                  const double* const* acting, int loads, long long i, const double* u, const double* beyond, double* restrict row,
                  double* restrict other) {
  long long j;
  if (planes == 2 && !loads && terms == 3) {
    combine(many, n, 2, 3, columns, i, basis, row);
  } else if (planes == 2 && !loads && terms == 4) {
    combine(many, n, 2, 4, columns, i, basis, row);
  } else {
    add_up(many, n, terms, columns, basis, acting, loads, i, u, beyond, row);
    if (planes == 2) {
      add_up(many, n, terms, columns + terms, basis, acting + 3*loads, loads, i, u, beyond, other);
      for (j = 0; j < many*n; ++j) row[j] = sqrt(row[j]*row[j] + other[j]*other[j]);
    }
  }
}

/* out[i*k + j], rows of k ratios u for the instants from one to before another. columns[m][i] are the coefficients of
   basis[m*stride + j], and acting[3*s], [3*s + 1] and [3*s + 2] the station, the constant and the slope of load s. With two planes
   there are so many coefficients and loads of each, one plane's after the other's, and out is the size of both. */
static void grid(const lagrange_casadi_grid_call* call, long long from, long long to) {
  const long long k = call->k;
  const int planes = call->planes, terms = call->terms, loads = call->loads;
  const double *const *columns = call->columns, *const *acting = call->acting, *u = call->u, *beyond = call->beyond;
  double* out = call->out;
  double tile[TILE], other[TILE];
  const double* along[MOST];
  /* Rows that need no room of their own are written all at once. */
  const long long width = k < TILE ? k : TILE, rows = k <= TILE && planes == 1 && !call->streams ? to - from : TILE/width;
  long long first, start;
  int m;
  for (start = 0; start < k; start += width) {
    const long long size = k - start < width ? k - start : width;
    for (m = 0; m < terms; ++m) along[m] = call->basis + m*call->stride + start;
    for (first = from; first < to; first += rows) {
      const long long many = to - first < rows ? to - first : rows;
      double* here = call->streams ? tile : out + first*k + start;
      whole(many, size, columns, along, planes, terms, acting, loads, first, u + start, beyond + start, here, other);
      if (call->streams) stream(out + first*k + start, tile, many*size);
    }
  }
#ifdef PAST
  if (call->streams) _mm_sfence();
#endif
}

/* Some grids, as many as there are calls. */
__attribute__((visibility("default")))
void lagrange_casadi_grids(const lagrange_casadi_grid_call* calls, long long many, long long from, long long to) {
  long long i;
  for (i = 0; i < many; ++i) grid(calls + i, from, to);
}

/* out[d*k + j], of so many designs: over n instants, what is largest in size at each of k ratios u, with its sign; of sizes that are
   the same, the positive one. As above, but columns[m][d*n + i] are the coefficients of basis[m*stride + d*k + j], and loads have
   a value for every d*n + i. All of them must be finite. */
__attribute__((visibility("default")))
void lagrange_casadi_largest(const lagrange_casadi_largest_call* call) {
  const long long designs = call->designs, n = call->n, k = call->k;
  const int planes = call->planes, terms = call->terms, loads = call->loads;
  const double *const *columns = call->columns, *const *acting = call->acting, *u = call->u, *beyond = call->beyond;
  double* out = call->out;
  double row[TILE], other[TILE], high[TILE], low[TILE];
  const double* along[MOST];
  long long d, start, i, j;
  int m;
  for (d = 0; d < designs; ++d) {
    for (start = 0; start < k; start += TILE) {
      const long long size = k - start < TILE ? k - start : TILE;
      for (m = 0; m < terms; ++m) along[m] = call->basis + m*call->stride + d*k + start;
      for (j = 0; j < size; ++j) {
        high[j] = -HUGE_VAL;
        low[j] = HUGE_VAL;
      }
      for (i = d*n; i < (d + 1)*n; ++i) {
        whole(1, size, columns, along, planes, terms, acting, loads, i, u + start, beyond + start, row, other);
        for (j = 0; j < size; ++j) {
          high[j] = row[j] > high[j] ? row[j] : high[j];
          low[j] = row[j] < low[j] ? row[j] : low[j];
        }
      }
      for (j = 0; j < size; ++j) out[d*k + start + j] = high[j] >= -low[j] ? high[j] : low[j];
    }
  }
}
