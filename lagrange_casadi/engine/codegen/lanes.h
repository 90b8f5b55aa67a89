/* A pack of doubles, or with LANES_SINGLE of floats, as many as the machine's vectors hold, that stands where an emitted file says
   casadi_real.

   Compiled as C++ by gcc or clang: operators are the compiler's own on vectors, functions are libmvec's where it is there, and a
   loop over the pack where not. */
#include <math.h>
#include <string.h>

#ifdef LANES_SINGLE
typedef float lanes_real;
typedef int lanes_whole;
#define LANES_A_DOUBLE 2
#define LANES_OF(name) name##f
#else
typedef double lanes_real;
typedef long long lanes_whole;
#define LANES_A_DOUBLE 1
#define LANES_OF(name) name
#endif

#define LANES_JOIN(vector, count, arguments, name) _ZGV##vector##N##count##arguments##_##name
#define LANES_JOINED(vector, count, arguments, name) LANES_JOIN(vector, count, arguments, name)
#if defined(__AVX512F__)
#define LANES_BYTES 64
#define LANES_VECTOR e
#elif defined(__AVX2__)
#define LANES_BYTES 32
#define LANES_VECTOR d
#elif defined(__aarch64__)
#define LANES_BYTES 16
#define LANES_VECTOR n
#else
#define LANES_BYTES 16
#define LANES_VECTOR b
#endif
#if LANES_BYTES * LANES_A_DOUBLE == 128
#define LANES 16
#elif LANES_BYTES * LANES_A_DOUBLE == 64
#define LANES 8
#elif LANES_BYTES * LANES_A_DOUBLE == 32
#define LANES 4
#else
#define LANES 2
#endif
#define LANES_MVEC(arguments, name) LANES_JOINED(LANES_VECTOR, LANES, arguments, name)

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

typedef lanes_real lanes_vector __attribute__((vector_size(LANES_BYTES)));
typedef lanes_whole lanes_mask __attribute__((vector_size(LANES_BYTES)));
typedef double lanes_doubles __attribute__((vector_size(LANES_BYTES)));

struct lanes_pack {
  lanes_vector v;
  lanes_pack() = default;
  __attribute__((always_inline)) lanes_pack(lanes_vector x) : v(x) {}
  /* Less zero, for -0.0 + 0.0 would lose its sign. */
  __attribute__((always_inline)) lanes_pack(lanes_real x) : v(x - lanes_vector{}) {}
};

LANES_INLINE lanes_pack operator+(lanes_pack a, lanes_pack b) { return a.v + b.v; }
LANES_INLINE lanes_pack operator-(lanes_pack a, lanes_pack b) { return a.v - b.v; }
LANES_INLINE lanes_pack operator*(lanes_pack a, lanes_pack b) { return a.v * b.v; }
LANES_INLINE lanes_pack operator/(lanes_pack a, lanes_pack b) { return a.v / b.v; }
LANES_INLINE lanes_pack operator-(lanes_pack a) { return -a.v; }

/* The bits of a if chosen, else those of b. */
LANES_INLINE lanes_pack lanes_bits(lanes_mask where, lanes_pack a, lanes_pack b) {
  return (lanes_vector)((where & (lanes_mask)a.v) | (~where & (lanes_mask)b.v));
}

/* The lanes of a if chosen, else those of b; of a comparison gcc makes one instruction so, of the above three. */
#ifdef __clang__
LANES_INLINE lanes_pack lanes_pick(lanes_mask where, lanes_pack a, lanes_pack b) { return lanes_bits(where, a, b); }
#else
LANES_INLINE lanes_pack lanes_pick(lanes_mask where, lanes_pack a, lanes_pack b) { return (lanes_vector)(where ? a.v : b.v); }
#endif

/* As in C, a comparison is one or zero. */
LANES_INLINE lanes_pack lanes_truth(lanes_mask where) { return lanes_pick(where, lanes_real(1), lanes_real(0)); }
LANES_INLINE lanes_pack operator<(lanes_pack a, lanes_pack b) { return lanes_truth(a.v < b.v); }
LANES_INLINE lanes_pack operator<=(lanes_pack a, lanes_pack b) { return lanes_truth(a.v <= b.v); }
LANES_INLINE lanes_pack operator==(lanes_pack a, lanes_pack b) { return lanes_truth(a.v == b.v); }
LANES_INLINE lanes_pack operator!=(lanes_pack a, lanes_pack b) { return lanes_truth(a.v != b.v); }
LANES_INLINE lanes_pack operator!(lanes_pack a) { return a == lanes_pack(lanes_real(0)); }
LANES_INLINE lanes_pack operator&&(lanes_pack a, lanes_pack b) { return !!a * !!b; }
LANES_INLINE lanes_pack operator||(lanes_pack a, lanes_pack b) { return !(!a && !b); }

/* What CasADi writes as (a ? b : 0), and its sign of x: a pack has no one truth to branch on. */
LANES_INLINE lanes_pack lanes_choose(lanes_pack a, lanes_pack b) { return lanes_pick(a.v != lanes_vector{}, b, lanes_real(0)); }
LANES_INLINE lanes_pack lanes_sign(lanes_pack x) {
  return lanes_pick(x.v < lanes_vector{}, lanes_real(-1), lanes_pick(x.v > lanes_vector{}, lanes_real(1), x));
}

/* a where x < y, else b. */
LANES_INLINE lanes_pack lanes_less(lanes_pack x, lanes_pack y, lanes_pack a, lanes_pack b) { return lanes_pick(x.v < y.v, a, b); }
/* In which lanes x < y, a bit each; and whether any lane is no number. */
#if defined(__AVX512F__) && !defined(__clang__)
/* gcc writes masks out as vectors; these stay masks. */
#ifdef LANES_SINGLE
#define LANES_COMPARED(x, y, how) __builtin_ia32_cmpps512_mask((x).v, (y).v, how, -1, 4)
#define LANES_LARGER __builtin_ia32_maxps512_mask
#else
#define LANES_COMPARED(x, y, how) __builtin_ia32_cmppd512_mask((x).v, (y).v, how, -1, 4)
#define LANES_LARGER __builtin_ia32_maxpd512_mask
#endif
LANES_INLINE unsigned lanes_where_less(lanes_pack x, lanes_pack y) { return LANES_COMPARED(x, y, 17); }
LANES_INLINE int lanes_any_nan(lanes_pack x) { return LANES_COMPARED(x, x, 3) != 0; }
/* b where a < b, else a: what is no number in a stays, in b it does not count. One instruction, which compilers do not find. */
LANES_INLINE lanes_pack lanes_larger(lanes_pack a, lanes_pack b) { return (lanes_vector)LANES_LARGER(b.v, a.v, a.v, -1, 4); }
#else
LANES_INLINE unsigned lanes_where(lanes_mask where) {
#if defined(__AVX__) && LANES_BYTES == 32
#ifdef LANES_SINGLE
  return (unsigned)__builtin_ia32_movmskps256((lanes_vector)where);
#else
  return (unsigned)__builtin_ia32_movmskpd256((lanes_vector)where);
#endif
#else
  unsigned bits = 0;
  for (unsigned i = 0; i < LANES; ++i) bits |= (where[i] != 0 ? 1u : 0u) << i;
  return bits;
#endif
}
LANES_INLINE unsigned lanes_where_less(lanes_pack x, lanes_pack y) { return lanes_where(x.v < y.v); }
LANES_INLINE int lanes_any_nan(lanes_pack x) { return lanes_where(x.v != x.v) != 0; }
LANES_INLINE lanes_pack lanes_larger(lanes_pack a, lanes_pack b) { return lanes_pick(a.v < b.v, b, a); }
#endif

LANES_INLINE lanes_pack LANES_OF(fmin)(lanes_pack a, lanes_pack b) { return lanes_pick((a.v < b.v) | (b.v != b.v), a, b); }
LANES_INLINE lanes_pack LANES_OF(fmax)(lanes_pack a, lanes_pack b) { return lanes_pick((a.v > b.v) | (b.v != b.v), a, b); }
LANES_INLINE lanes_pack LANES_OF(copysign)(lanes_pack a, lanes_pack b) {
  const lanes_mask sign = (lanes_mask)lanes_pack(-lanes_real(0)).v;
  return lanes_bits(sign, b, a);
}
LANES_INLINE lanes_pack lanes_size(lanes_pack a) { return (lanes_vector)((lanes_mask)a.v & ~(lanes_mask)lanes_pack(-lanes_real(0)).v); }
LANES_INLINE lanes_pack LANES_OF(fabs)(lanes_pack a) { return lanes_size(a); }

/* Store a pack past the caches, at a multiple of its size. A line of the cache that is filled so is not read from memory before. */
LANES_INLINE void lanes_stream(lanes_real* to, lanes_pack x) {
#if defined(__clang__)
  __builtin_nontemporal_store(x.v, (lanes_vector*)to);
#elif defined(__AVX512F__)
  __builtin_ia32_movntpd512((double*)to, (lanes_doubles)x.v);
#elif defined(__AVX2__)
  __builtin_ia32_movntpd256((double*)to, (lanes_doubles)x.v);
#elif defined(__SSE2__)
  __builtin_ia32_movntpd((double*)to, (lanes_doubles)x.v);
#else
  memcpy(to, &x, sizeof x);
#endif
}

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

LANES_EACH(LANES_OF(sqrt))
LANES_EACH(LANES_OF(floor))
LANES_EACH(LANES_OF(ceil))
LANES_EACH_OF_TWO(LANES_OF(fmod))
LANES_EACH_OF_TWO(LANES_OF(remainder))

/* What each version has, or a loop. */
#if LANES_LIBMVEC >= 1
#define LANES_FIRST LANES_CALL
#else
#define LANES_FIRST LANES_EACH
#endif
#if LANES_LIBMVEC >= 2
#define LANES_LATER LANES_CALL
#define LANES_LATER_OF_TWO LANES_CALL_OF_TWO
#else
#define LANES_LATER LANES_EACH
#define LANES_LATER_OF_TWO LANES_EACH_OF_TWO
#endif
LANES_FIRST(LANES_OF(sin))
LANES_FIRST(LANES_OF(cos))
LANES_FIRST(LANES_OF(exp))
LANES_FIRST(LANES_OF(log))
LANES_LATER(LANES_OF(tan))
LANES_LATER(LANES_OF(asin))
LANES_LATER(LANES_OF(acos))
LANES_LATER(LANES_OF(atan))
LANES_LATER(LANES_OF(sinh))
LANES_LATER(LANES_OF(cosh))
LANES_LATER(LANES_OF(tanh))
LANES_LATER(LANES_OF(asinh))
LANES_LATER(LANES_OF(acosh))
LANES_LATER(LANES_OF(atanh))
LANES_LATER(LANES_OF(log1p))
LANES_LATER(LANES_OF(expm1))
LANES_LATER(LANES_OF(erf))
LANES_LATER_OF_TWO(LANES_OF(atan2))
LANES_LATER_OF_TWO(LANES_OF(hypot))
LANES_LATER_OF_TWO(LANES_OF(pow))
