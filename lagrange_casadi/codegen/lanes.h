/* A pack of doubles, as many as the machine's vectors hold, that stands where an emitted file says casadi_real.

   Compiled as C++ by gcc or clang: operators are the compiler's own on vectors, functions are libmvec's where it is there, and a
   loop over the pack where not. */
#ifndef LAGRANGE_CASADI_LANES_H
#define LAGRANGE_CASADI_LANES_H

#include <math.h>
#include <string.h>

#if defined(__AVX512F__)
#define LANES 8
#define LANES_MVEC(arguments, name) _ZGVeN8##arguments##_##name
#elif defined(__AVX2__)
#define LANES 4
#define LANES_MVEC(arguments, name) _ZGVdN4##arguments##_##name
#elif defined(__aarch64__)
#define LANES 2
#define LANES_MVEC(arguments, name) _ZGVnN2##arguments##_##name
#else
#define LANES 2
#define LANES_MVEC(arguments, name) _ZGVbN2##arguments##_##name
#endif

/* Which of its functions a libmvec has: glibc 2.22 began with five on x86-64, 2.35 has nearly all; on AArch64 2.38 began with four. */
#ifndef LANES_LIBMVEC
#if defined(__GLIBC__) && defined(__x86_64__)
#define LANES_LIBMVEC (__GLIBC_PREREQ(2, 35) ? 2 : 1)
#elif defined(__GLIBC__) && defined(__aarch64__)
#define LANES_LIBMVEC (__GLIBC_PREREQ(2, 38) ? 1 : 0)
#else
#define LANES_LIBMVEC 0
#endif
#endif

#define LANES_INLINE static inline __attribute__((always_inline))

typedef double lanes_vector __attribute__((vector_size(8 * LANES)));
typedef long long lanes_mask __attribute__((vector_size(8 * LANES)));

struct lanes_pack {
  lanes_vector v;
  lanes_pack() = default;
  __attribute__((always_inline)) lanes_pack(lanes_vector x) : v(x) {}
  /* Less zero, for -0.0 + 0.0 would lose its sign. */
  __attribute__((always_inline)) lanes_pack(double x) : v(x - lanes_vector{}) {}
};

LANES_INLINE lanes_pack operator+(lanes_pack a, lanes_pack b) { return a.v + b.v; }
LANES_INLINE lanes_pack operator-(lanes_pack a, lanes_pack b) { return a.v - b.v; }
LANES_INLINE lanes_pack operator*(lanes_pack a, lanes_pack b) { return a.v * b.v; }
LANES_INLINE lanes_pack operator/(lanes_pack a, lanes_pack b) { return a.v / b.v; }
LANES_INLINE lanes_pack operator-(lanes_pack a) { return -a.v; }

LANES_INLINE lanes_pack lanes_pick(lanes_mask where, lanes_pack a, lanes_pack b) {
  return (lanes_vector)((where & (lanes_mask)a.v) | (~where & (lanes_mask)b.v));
}

/* As in C, a comparison is one or zero. */
LANES_INLINE lanes_pack lanes_truth(lanes_mask where) { return lanes_pick(where, 1.0, 0.0); }
LANES_INLINE lanes_pack operator<(lanes_pack a, lanes_pack b) { return lanes_truth(a.v < b.v); }
LANES_INLINE lanes_pack operator<=(lanes_pack a, lanes_pack b) { return lanes_truth(a.v <= b.v); }
LANES_INLINE lanes_pack operator==(lanes_pack a, lanes_pack b) { return lanes_truth(a.v == b.v); }
LANES_INLINE lanes_pack operator!=(lanes_pack a, lanes_pack b) { return lanes_truth(a.v != b.v); }
LANES_INLINE lanes_pack operator!(lanes_pack a) { return a == 0.0; }
LANES_INLINE lanes_pack operator&&(lanes_pack a, lanes_pack b) { return (a != 0.0) * (b != 0.0); }
LANES_INLINE lanes_pack operator||(lanes_pack a, lanes_pack b) { return !(!a && !b); }

/* What CasADi writes as (a ? b : 0), and its sign of x: a pack has no one truth to branch on. */
LANES_INLINE lanes_pack lanes_choose(lanes_pack a, lanes_pack b) { return lanes_pick(a.v != 0.0, b, 0.0); }
LANES_INLINE lanes_pack lanes_sign(lanes_pack x) { return lanes_pick(x.v < 0.0, -1.0, lanes_pick(x.v > 0.0, 1.0, x)); }
LANES_INLINE double lanes_choose(double a, double b) { return a != 0.0 ? b : 0.0; }
LANES_INLINE double lanes_sign(double x) { return x < 0.0 ? -1.0 : x > 0.0 ? 1.0 : x; }

LANES_INLINE lanes_pack fmin(lanes_pack a, lanes_pack b) { return lanes_pick((a.v < b.v) | (b.v != b.v), a, b); }
LANES_INLINE lanes_pack fmax(lanes_pack a, lanes_pack b) { return lanes_pick((a.v > b.v) | (b.v != b.v), a, b); }
LANES_INLINE lanes_pack copysign(lanes_pack a, lanes_pack b) {
  const lanes_mask sign = (lanes_mask)lanes_pack(-0.0).v;
  return lanes_pick(sign, b, a);
}
LANES_INLINE lanes_pack fabs(lanes_pack a) { return copysign(a, 1.0); }

#define LANES_EACH(name)                               \
  LANES_INLINE lanes_pack name(lanes_pack a) {         \
    lanes_vector r;                                    \
    for (int i = 0; i < LANES; ++i) r[i] = name(a.v[i]); \
    return r;                                          \
  }
#define LANES_EACH_OF_TWO(name)                                  \
  LANES_INLINE lanes_pack name(lanes_pack a, lanes_pack b) {     \
    lanes_vector r;                                              \
    for (int i = 0; i < LANES; ++i) r[i] = name(a.v[i], b.v[i]); \
    return r;                                                    \
  }
#define LANES_CALL(name)                                                \
  extern "C" lanes_vector LANES_MVEC(v, name)(lanes_vector);            \
  LANES_INLINE lanes_pack name(lanes_pack a) { return LANES_MVEC(v, name)(a.v); }
#define LANES_CALL_OF_TWO(name)                                            \
  extern "C" lanes_vector LANES_MVEC(vv, name)(lanes_vector, lanes_vector); \
  LANES_INLINE lanes_pack name(lanes_pack a, lanes_pack b) { return LANES_MVEC(vv, name)(a.v, b.v); }

LANES_EACH(sqrt)
LANES_EACH(floor)
LANES_EACH(ceil)
LANES_EACH_OF_TWO(fmod)
LANES_EACH_OF_TWO(remainder)

#if LANES_LIBMVEC >= 1
LANES_CALL(sin)
LANES_CALL(cos)
LANES_CALL(exp)
LANES_CALL(log)
#else
LANES_EACH(sin)
LANES_EACH(cos)
LANES_EACH(exp)
LANES_EACH(log)
#endif

#if LANES_LIBMVEC >= 2
LANES_CALL(tan)
LANES_CALL(asin)
LANES_CALL(acos)
LANES_CALL(atan)
LANES_CALL(sinh)
LANES_CALL(cosh)
LANES_CALL(tanh)
LANES_CALL(asinh)
LANES_CALL(acosh)
LANES_CALL(atanh)
LANES_CALL(log1p)
LANES_CALL(expm1)
LANES_CALL(erf)
LANES_CALL_OF_TWO(atan2)
LANES_CALL_OF_TWO(hypot)
LANES_CALL_OF_TWO(pow)
#else
LANES_EACH(tan)
LANES_EACH(asin)
LANES_EACH(acos)
LANES_EACH(atan)
LANES_EACH(sinh)
LANES_EACH(cosh)
LANES_EACH(tanh)
LANES_EACH(asinh)
LANES_EACH(acosh)
LANES_EACH(atanh)
LANES_EACH(log1p)
LANES_EACH(expm1)
LANES_EACH(erf)
LANES_EACH_OF_TWO(atan2)
LANES_EACH_OF_TWO(hypot)
LANES_EACH_OF_TWO(pow)
#endif

/* CasADi's helpers take C99's functions where they see C99. */
#ifndef __STDC_VERSION__
#define __STDC_VERSION__ 199901L
#endif

#endif
