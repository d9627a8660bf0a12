// Sine and cosine of a vector of angles, with the bits of glibc's sinf and cosf where the processor
// has fused multiply-adds (glibc 2.28 to 2.40; `has_our_sines` in lockstep.cpp asks it). These are
// ARM's optimized routines: an angle is reduced to the nearest multiple of a right angle, then two
// polynomials are evaluated, in double precision.
//
// Part of lanes.cpp, inside its namespace.

#if defined(__AVX512F__)
typedef double Doubles __attribute__((vector_size(64)));
NEOL_INLINE Doubles fused(Doubles a, Doubles b, Doubles c) { return _mm512_fmadd_pd(a, b, c); }
#else
typedef double Doubles __attribute__((vector_size(32)));
NEOL_INLINE Doubles fused(Doubles a, Doubles b, Doubles c) { return _mm256_fmadd_pd(a, b, c); }
#endif
typedef float HalfReal __attribute__((vector_size(2 * NEOL_WIDTH)));
typedef int HalfWords __attribute__((vector_size(2 * NEOL_WIDTH)));

constexpr float sines_begin = 0x1p-12f;  // below, an angle is its own sine

// Sines and cosines of angles below sines_end.
NEOL_INLINE void half_sines(HalfReal angle, HalfReal& sine, HalfReal& cosine) {
  const Doubles zero{};
  Doubles x = __builtin_convertvector(angle, Doubles);
  const HalfWords scaled = __builtin_convertvector(x * 0x1.45F306DC9C883p+23, HalfWords);
  const HalfWords quadrant = (scaled + 0x800000) >> 24;
  x = fused(-__builtin_convertvector(quadrant, Doubles), zero + 0x1.921FB54442D18p0, x);

  const Doubles x2 = x * x, x3 = x2 * x, x4 = x2 * x2;
  const Doubles s1 = fused(x2, zero - 0x1.994eb3774cf24p-13, zero + 0x1.1107605230bc4p-7);
  const Doubles c2 = fused(x2, zero + 0x1.99343027bf8c3p-16, zero - 0x1.6c087e89a359dp-10);
  const Doubles c1 = fused(x2, zero - 0x1.ffffffd0c621cp-2, zero + 1.0);
  const Doubles s = fused(x3, zero - 0x1.555545995a603p-3, x);
  const Doubles c = fused(x4, zero + 0x1.55553e1068f19p-5, c1);
  const HalfReal sine_here = __builtin_convertvector(fused(x3 * x2, s1, s), HalfReal);
  const HalfReal cosine_here = __builtin_convertvector(fused(x4 * x2, c2, c), HalfReal);

  const HalfWords swapped = (quadrant & 1) != 0;
  const HalfReal first = swapped ? cosine_here : sine_here;
  const HalfReal second = swapped ? sine_here : cosine_here;
  sine = (quadrant & 2) != 0 ? -first : first;
  cosine = ((quadrant + 1) & 2) != 0 ? -second : second;
  const HalfWords tiny = (angle < sines_begin) & (angle > -sines_begin);
  sine = tiny ? angle : sine;
  cosine = tiny ? HalfReal{} + 1.0f : cosine;
}
