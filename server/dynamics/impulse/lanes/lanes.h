// Lanes: four doubles that one instruction works on (SIMD). They are one number of four bodies, or one vector
// (x, y, z, unused). With AVX2 they are one register, otherwise two of SSE2. Each lane is rounded as a single
// double is, so both builds give the same bits.
//
// Everything here is inline and private to the file that includes it: the linker must not use a function that
// was compiled for AVX2 where every processor has to run it. Files that include this therefore use no Eigen
// and nothing of the standard library.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define VISUM_LANES_INLINE [[gnu::always_inline]] static inline

namespace visum::dynamics::impulse {
namespace {

using Pair = double __attribute__((vector_size(16)));
using PairMask = long long __attribute__((vector_size(16)));

VISUM_LANES_INLINE Pair load_pair(const double* from) {
  Pair result;
  __builtin_memcpy(&result, from, sizeof(result));
  return result;
}
VISUM_LANES_INLINE void store_pair(double* to, Pair from) {
  __builtin_memcpy(to, &from, sizeof(from));
}

#if defined(__AVX2__)

// Four doubles, and four conditions, each all ones or all zeros.
struct Lanes {
  using Raw = double __attribute__((vector_size(32)));
  Raw raw;
};
struct Mask {
  using Raw = long long __attribute__((vector_size(32)));
  Raw raw;
};

VISUM_LANES_INLINE Lanes all(double value) {
  return {Lanes::Raw{value, value, value, value}};
}
VISUM_LANES_INLINE Lanes lanes(double a, double b, double c, double d) {
  return {Lanes::Raw{a, b, c, d}};
}
VISUM_LANES_INLINE Lanes load(const double* from) {
  return {_mm256_loadu_pd(from)};
}
VISUM_LANES_INLINE void store(double* to, Lanes from) {
  _mm256_storeu_pd(to, from.raw);
}
VISUM_LANES_INLINE Lanes load_floats(const float* from) {
  return {_mm256_cvtps_pd(_mm_loadu_ps(from))};
}
VISUM_LANES_INLINE void store_floats(float* to, Lanes from) {
  _mm_storeu_ps(to, _mm256_cvtpd_ps(from.raw));
}
VISUM_LANES_INLINE Lanes operator+(Lanes a, Lanes b) {
  return {a.raw + b.raw};
}
VISUM_LANES_INLINE Lanes operator-(Lanes a, Lanes b) {
  return {a.raw - b.raw};
}
VISUM_LANES_INLINE Lanes operator*(Lanes a, Lanes b) {
  return {a.raw * b.raw};
}
VISUM_LANES_INLINE Lanes operator/(Lanes a, Lanes b) {
  return {a.raw / b.raw};
}
VISUM_LANES_INLINE Lanes operator-(Lanes a) {
  return {-a.raw};
}
VISUM_LANES_INLINE Lanes root(Lanes a) {
  return {_mm256_sqrt_pd(a.raw)};
}
VISUM_LANES_INLINE Lanes magnitude(Lanes a) {
  return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.raw)};
}
// Three numbers; the fourth lane is 0.
VISUM_LANES_INLINE Lanes load3(const double* from) {
  return {_mm256_maskload_pd(from, _mm256_set_epi64x(0, -1, -1, -1))};
}
// Like a > b ? a : b in each lane; where a number is NaN, b.
VISUM_LANES_INLINE Lanes larger(Lanes a, Lanes b) {
  return {_mm256_max_pd(a.raw, b.raw)};
}
VISUM_LANES_INLINE Mask same_bits(Lanes a, Lanes b) {
  return {reinterpret_cast<Mask::Raw>(a.raw) == reinterpret_cast<Mask::Raw>(b.raw)};
}
VISUM_LANES_INLINE Mask operator&(Mask a, Mask b) {
  return {a.raw & b.raw};
}
VISUM_LANES_INLINE Mask operator<=(Lanes a, Lanes b) {
  return {a.raw <= b.raw};
}
VISUM_LANES_INLINE Mask operator<(Lanes a, Lanes b) {
  return {a.raw < b.raw};
}
VISUM_LANES_INLINE Lanes choose(Mask mask, Lanes where, Lanes elsewhere) {
  return {_mm256_blendv_pd(elsewhere.raw, where.raw, reinterpret_cast<Lanes::Raw>(mask.raw))};
}
VISUM_LANES_INLINE bool is_all(Mask mask) {
  return _mm256_movemask_pd(_mm256_castsi256_pd(reinterpret_cast<__m256i>(mask.raw))) == 15;
}
VISUM_LANES_INLINE bool is_zero(Lanes a) {  // every bit is 0
  return _mm256_testz_si256(_mm256_castpd_si256(a.raw), _mm256_castpd_si256(a.raw)) != 0;
}
VISUM_LANES_INLINE Lanes join(Pair low, Pair high) {
  return {_mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1)};
}
VISUM_LANES_INLINE Pair low(Lanes a) {
  return _mm256_castpd256_pd128(a.raw);
}
VISUM_LANES_INLINE Pair high(Lanes a) {
  return _mm256_extractf128_pd(a.raw, 1);
}
// evens: within each half (a0 b0 a2 b2); odds: (a1 b1 a3 b3).
VISUM_LANES_INLINE Lanes evens(Lanes a, Lanes b) {
  return {_mm256_unpacklo_pd(a.raw, b.raw)};
}
VISUM_LANES_INLINE Lanes odds(Lanes a, Lanes b) {
  return {_mm256_unpackhi_pd(a.raw, b.raw)};
}
// next: (y z x w); after_next: (z x y w).
VISUM_LANES_INLINE Lanes next(Lanes a) {
  return {_mm256_permute4x64_pd(a.raw, 0b11'00'10'01)};
}
VISUM_LANES_INLINE Lanes after_next(Lanes a) {
  return {_mm256_permute4x64_pd(a.raw, 0b11'01'00'10)};
}
template <int k>
VISUM_LANES_INLINE Lanes each(Lanes a) {  // lane k in all four lanes
  return {_mm256_permute4x64_pd(a.raw, k * 0b01'01'01'01)};
}
template <int k>
VISUM_LANES_INLINE double lane(Lanes a) {
  return a.raw[k];
}
template <int k>
VISUM_LANES_INLINE Lanes with_lane(Lanes a, double value) {
  a.raw[k] = value;
  return a;
}

#else

// The same operations with two SSE2 registers; each must give the bits of its AVX2 twin above.
struct Lanes {
  Pair lo, hi;
};
struct Mask {
  PairMask lo, hi;
};

VISUM_LANES_INLINE Lanes all(double value) {
  return {Pair{value, value}, Pair{value, value}};
}
VISUM_LANES_INLINE Lanes lanes(double a, double b, double c, double d) {
  return {Pair{a, b}, Pair{c, d}};
}
VISUM_LANES_INLINE Lanes load(const double* from) {
  return {load_pair(from), load_pair(from + 2)};
}
VISUM_LANES_INLINE void store(double* to, Lanes from) {
  store_pair(to, from.lo);
  store_pair(to + 2, from.hi);
}
using FloatPair = float __attribute__((vector_size(8)));
VISUM_LANES_INLINE Pair load_float_pair(const float* from) {
  FloatPair pair;
  __builtin_memcpy(&pair, from, sizeof(pair));
  return __builtin_convertvector(pair, Pair);
}
VISUM_LANES_INLINE void store_float_pair(float* to, Pair from) {
  const FloatPair pair = __builtin_convertvector(from, FloatPair);
  __builtin_memcpy(to, &pair, sizeof(pair));
}
VISUM_LANES_INLINE Lanes load_floats(const float* from) {
  return {load_float_pair(from), load_float_pair(from + 2)};
}
VISUM_LANES_INLINE void store_floats(float* to, Lanes from) {
  store_float_pair(to, from.lo);
  store_float_pair(to + 2, from.hi);
}
VISUM_LANES_INLINE Lanes operator+(Lanes a, Lanes b) {
  return {a.lo + b.lo, a.hi + b.hi};
}
VISUM_LANES_INLINE Lanes operator-(Lanes a, Lanes b) {
  return {a.lo - b.lo, a.hi - b.hi};
}
VISUM_LANES_INLINE Lanes operator*(Lanes a, Lanes b) {
  return {a.lo * b.lo, a.hi * b.hi};
}
VISUM_LANES_INLINE Lanes operator/(Lanes a, Lanes b) {
  return {a.lo / b.lo, a.hi / b.hi};
}
VISUM_LANES_INLINE Lanes operator-(Lanes a) {
  return {-a.lo, -a.hi};
}
VISUM_LANES_INLINE Pair root(Pair a) {
  return Pair{__builtin_sqrt(a[0]), __builtin_sqrt(a[1])};
}
VISUM_LANES_INLINE Lanes root(Lanes a) {
  return {root(a.lo), root(a.hi)};
}
VISUM_LANES_INLINE Lanes load3(const double* from) {
  return {load_pair(from), Pair{from[2], 0.0}};
}
VISUM_LANES_INLINE Pair choose(PairMask mask, Pair where, Pair elsewhere) {
  return reinterpret_cast<Pair>((mask & reinterpret_cast<PairMask>(where)) |
                                (~mask & reinterpret_cast<PairMask>(elsewhere)));
}
VISUM_LANES_INLINE Pair magnitude(Pair a) {
  return reinterpret_cast<Pair>(reinterpret_cast<PairMask>(a) & 0x7fff'ffff'ffff'ffffLL);
}
VISUM_LANES_INLINE Lanes magnitude(Lanes a) {
  return {magnitude(a.lo), magnitude(a.hi)};
}
VISUM_LANES_INLINE Lanes larger(Lanes a, Lanes b) {
  return {choose(a.lo > b.lo, a.lo, b.lo), choose(a.hi > b.hi, a.hi, b.hi)};
}
VISUM_LANES_INLINE Mask same_bits(Lanes a, Lanes b) {
  return {reinterpret_cast<PairMask>(a.lo) == reinterpret_cast<PairMask>(b.lo),
          reinterpret_cast<PairMask>(a.hi) == reinterpret_cast<PairMask>(b.hi)};
}
VISUM_LANES_INLINE Mask operator&(Mask a, Mask b) {
  return {a.lo & b.lo, a.hi & b.hi};
}
VISUM_LANES_INLINE Mask operator<=(Lanes a, Lanes b) {
  return {a.lo <= b.lo, a.hi <= b.hi};
}
VISUM_LANES_INLINE Mask operator<(Lanes a, Lanes b) {
  return {a.lo < b.lo, a.hi < b.hi};
}
VISUM_LANES_INLINE Lanes choose(Mask mask, Lanes where, Lanes elsewhere) {
  return {choose(mask.lo, where.lo, elsewhere.lo), choose(mask.hi, where.hi, elsewhere.hi)};
}
VISUM_LANES_INLINE bool is_all(Mask mask) {
  const PairMask both = mask.lo & mask.hi;
  return (both[0] & both[1]) != 0;
}
VISUM_LANES_INLINE bool is_zero(Lanes a) {
  const PairMask either = reinterpret_cast<PairMask>(a.lo) | reinterpret_cast<PairMask>(a.hi);
  return (either[0] | either[1]) == 0;
}
VISUM_LANES_INLINE Lanes join(Pair low, Pair high) {
  return {low, high};
}
VISUM_LANES_INLINE Pair low(Lanes a) {
  return a.lo;
}
VISUM_LANES_INLINE Pair high(Lanes a) {
  return a.hi;
}
VISUM_LANES_INLINE Lanes evens(Lanes a, Lanes b) {
  return {__builtin_shufflevector(a.lo, b.lo, 0, 2), __builtin_shufflevector(a.hi, b.hi, 0, 2)};
}
VISUM_LANES_INLINE Lanes odds(Lanes a, Lanes b) {
  return {__builtin_shufflevector(a.lo, b.lo, 1, 3), __builtin_shufflevector(a.hi, b.hi, 1, 3)};
}
VISUM_LANES_INLINE Lanes next(Lanes a) {
  return {__builtin_shufflevector(a.lo, a.hi, 1, 2), __builtin_shufflevector(a.lo, a.hi, 0, 3)};
}
VISUM_LANES_INLINE Lanes after_next(Lanes a) {
  return {__builtin_shufflevector(a.hi, a.lo, 0, 2), __builtin_shufflevector(a.lo, a.hi, 1, 3)};
}
template <int k>
VISUM_LANES_INLINE Lanes each(Lanes a) {
  const Pair from = k < 2 ? a.lo : a.hi;
  const Pair pair = __builtin_shufflevector(from, from, k % 2, k % 2);
  return {pair, pair};
}
template <int k>
VISUM_LANES_INLINE double lane(Lanes a) {
  return (k < 2 ? a.lo : a.hi)[k % 2];
}
template <int k>
VISUM_LANES_INLINE Lanes with_lane(Lanes a, double value) {
  (k < 2 ? a.lo : a.hi)[k % 2] = value;
  return a;
}

#endif

VISUM_LANES_INLINE Lanes operator*(double a, Lanes b) {
  return all(a) * b;
}

// From here on: one vector (x y z unused) in Lanes.
VISUM_LANES_INLINE Lanes cross(Lanes a, Lanes b) {  // a x b
  return next(a * next(b) - next(a) * b);
}
// The sum of the first three lanes, (x + y) + z, in every lane.
VISUM_LANES_INLINE Lanes sum3(Lanes a) {
  return (each<0>(a) + each<1>(a)) + each<2>(a);
}
VISUM_LANES_INLINE Lanes dot(Lanes a, Lanes b) {
  return sum3(a * b);
}
VISUM_LANES_INLINE void store3(double* to, Lanes from) {
  store_pair(to, low(from));
  to[2] = high(from)[0];
}
// The matrix is stored by columns.
VISUM_LANES_INLINE Lanes matrix_times(const double* matrix, Lanes u) {
  return (each<0>(u) * load3(matrix) + each<1>(u) * load3(matrix + 3)) + each<2>(u) * load3(matrix + 6);
}
// Stores two vectors of three, one right behind the other.
VISUM_LANES_INLINE void store6(double* to, Lanes a, Lanes b) {
  store(to, a);
  store3(to + 3, b);
}
VISUM_LANES_INLINE double first(Lanes a) {
  return low(a)[0];
}

}  // namespace
}  // namespace visum::dynamics::impulse
