#pragma once

#include <cstddef>
#include <cstdint>

// Elementary functions without branch, table or call, for the loops of this folder: inlined, a compiler turns them into
// vector code. They consist of + - * / and integer operations alone, whose results IEEE 754 fixes to the bit, and are
// compiled without contraction: every lane of every vector unit gives the same bits. Not for use outside of kernels.
// Each says its range and its largest error in units of 2^-53, relative; coefficients by polynomials.py.

#define GONIO_LANE [[gnu::always_inline]] inline

namespace gonio::reflectance::lane {

constexpr double kHalfPi = 1.5707963267948966;
constexpr double kHalfPiRest = 6.123233995736766e-17;
constexpr double kLog2E = 1.4426950408889634;
constexpr double kLn2 = 0.6931471805599453;
constexpr double kLn2High = 0x1.62e42fefa38p-1;         // 42 bits: its product with an exponent is exact
constexpr double kLn2Low = 5.497923018708371e-14;       // ln 2 - kLn2High
constexpr double kRoundingShift = 0x1.8p52;             // x + this - this is x rounded; the integer is in the low bits
constexpr std::uint64_t kOneBits = 0x3ff0000000000000;  // of 1.0
constexpr int kMantissaBits = 52;

constexpr double kSine[] = {-0.16666666666666666,   0.008333333333333333,    -0.00019841269841269806,
                            2.7557319223971264e-06, -2.5052108382391406e-08, 1.605904347941901e-10,
                            -7.647139121983424e-13, 2.8104687777073216e-15,  -8.006069886350886e-18};
constexpr double kExp[] = {0.5,
                           0.1666666666666667,
                           0.04166666666666667,
                           0.008333333333326141,
                           0.0013888888888883752,
                           0.00019841269874800493,
                           2.4801587325533363e-05,
                           2.7557255425746435e-06,
                           2.7557273661348637e-07,
                           2.510520637395701e-08,
                           2.0914679376583935e-09};
constexpr double kLog[] = {0.3333333333333333,  0.2000000000000044,  0.14285714285401807, 0.11111111195856958,
                           0.09090897820066453, 0.07693119851407329, 0.06634386569328443, 0.06543313073920051};
constexpr double kArcTangent[] = {-0.3333333333333333,  0.1999999999999552,  -0.14285714284666542, 0.11111111015256361,
                                  -0.09090904578123903, 0.07692183190826087, -0.06664511447381948, 0.0585814891280221,
                                  -0.0508544973794026,  0.03923165829558719, -0.01917688711906226};
constexpr double kScaledErfc[] = {
    0.25539567631050575,    -0.4271858474139585,     0.24165819424246587,     -0.0789785810157211,
    0.0037328924043926242,  0.006997461738753906,    -0.0008471432539036068,  -0.0009819770198475587,
    4.355567576527131e-05,  0.00017436114047101727,  2.7524408585449467e-05,  -2.758015958980688e-05,
    -1.395856762347573e-05, 1.3950323991355821e-06,  3.739721489628327e-06,   1.1794457186217488e-06,
    -4.002242210900382e-07, -4.6257648747787144e-07, -1.2287438221894613e-07, 3.0486402229452366e-08,
    2.690410478364366e-08,  5.089038472617791e-09};

GONIO_LANE std::uint64_t bits_of(double x) {
  return __builtin_bit_cast(std::uint64_t, x);
}
GONIO_LANE double from_bits(std::uint64_t x) {
  return __builtin_bit_cast(double, x);
}
GONIO_LANE double least(double a, double b) {
  return b < a ? b : a;
}
GONIO_LANE double most(double a, double b) {
  return a < b ? b : a;
}
GONIO_LANE double magnitude(double x) {
  return __builtin_fabs(x);
}
GONIO_LANE double root(double x) {
  return __builtin_sqrt(x);
}

// c[k] + c[k + 2] x2 + c[k + 4] x2^2 + ...
template <std::size_t k, std::size_t size>
GONIO_LANE double every_other(const double (&c)[size], double x2) {
  if constexpr (k + 2 < size)
    return every_other<k + 2>(c, x2) * x2 + c[k];
  else
    return c[k];
}

/// c[0] + c[1] x + ..., in two chains that a processor follows at once.
template <std::size_t size>
GONIO_LANE double polynomial(const double (&c)[size], double x) {
  const double x2 = x * x;
  return every_other<0>(c, x2) + x * every_other<1>(c, x2);
}

/// sin x, |x| <= pi/2. 2 units.
GONIO_LANE double sine(double x) {
  const double x2 = x * x;
  return x + x * (x2 * polynomial(kSine, x2));
}

/// pi/2 - x with what the nearest double to pi/2 lacks.
GONIO_LANE double complement(double x) {
  return (kHalfPi - x) + kHalfPiRest;
}

/// |sin x|, |x| <= pi: all digits at both zeros.
GONIO_LANE double sine_of_half_turn(double x) {
  const double a = magnitude(x);
  const double folded = (2.0 * kHalfPi - a) + 2.0 * kHalfPiRest;
  return sine(a > kHalfPi ? folded : a);
}

/// |cos x|, |x| <= pi.
GONIO_LANE double cosine_of_half_turn(double x) {
  return magnitude(sine(complement(magnitude(x))));
}

/// e^x - 1, |x| <= 708: all digits at 0. 3 units.
GONIO_LANE double exponential_less_one(double x) {
  const double shifted = x * kLog2E + kRoundingShift;
  const double n = shifted - kRoundingShift;
  const double r = (x - n * kLn2High) - n * kLn2Low;
  const double q = r + r * r * polynomial(kExp, r);
  const double scale = from_bits(kOneBits + (bits_of(shifted) << kMantissaBits));
  return (scale - 1.0) + scale * q;
}

// e^r 2^n for |r| <= ln 2 / 2; `shifted` = n + kRoundingShift. The result must be a normal number.
GONIO_LANE double scaled_exponential(double r, double shifted) {
  const double p = 1.0 + (r + r * r * polynomial(kExp, r));
  return from_bits(bits_of(p) + (bits_of(shifted) << kMantissaBits));
}

/// e^x, |x| <= 708. 2 units.
GONIO_LANE double exponential(double x) {
  const double shifted = x * kLog2E + kRoundingShift;
  const double n = shifted - kRoundingShift;
  return scaled_exponential((x - n * kLn2High) - n * kLn2Low, shifted);
}

/// An exponent as `power` takes it: in two parts of which the first times a binary exponent is exact, and by ln 2.
struct Exponent {
  explicit Exponent(double k)
      : high(from_bits(bits_of(k) & ~std::uint64_t{0xfff})), low(k - high), for_logarithm(2.0 * kLog2E * k) {}
  double high;
  double low;
  double for_logarithm;
};

/// x^k for x > 0 where x and x^k are normal numbers. With x = 2^e m it is 2^(k e) m^k, and k e keeps all its digits: 3
/// + 2 |k| units, however small x.
GONIO_LANE double power(double x, const Exponent& k) {
  constexpr std::uint64_t kRootHalfBits = 0x3fe6a09e667f3bcd;
  constexpr std::uint64_t kTwoTo52Bits = 0x4330000000000000;
  constexpr double kTwoTo52AndBias = 0x1p52 + 1023.0;
  const std::uint64_t biased = (bits_of(x) - kRootHalfBits + kOneBits) >> kMantissaBits;
  const double m = from_bits(bits_of(x) - (biased << kMantissaBits) + kOneBits);  // in [sqrt 1/2, sqrt 2)
  const double e = from_bits(biased | kTwoTo52Bits) - kTwoTo52AndBias;
  const double z = (m - 1.0) / (m + 1.0);
  const double z2 = z * z;
  const double part = k.for_logarithm * (z + z * (z2 * polynomial(kLog, z2)));  // k log2 m
  const double whole = k.high * e;
  const double shifted = (whole + part) + kRoundingShift;
  const double n = shifted - kRoundingShift;
  return scaled_exponential(((whole - n) + (part + k.low * e)) * kLn2, shifted);
}

/// e^(v^2) erfc(v), 0 <= v <= 6, to 4 units of e^(v^2).
GONIO_LANE double scaled_erfc(double v) {
  return polynomial(kScaledErfc, (v - 2.0) / (v + 2.0));
}

/// The angle in [0, pi/4] whose tangent is low/high, 0 <= low <= high, high > 0. 3 units.
GONIO_LANE double small_angle(double low, double high) {
  constexpr double kTanEighthOfPi = 0.41421356237309503;
  const bool is_upper = low > kTanEighthOfPi * high;
  const double z = (is_upper ? low - high : low) / (is_upper ? low + high : high);
  const double z2 = z * z;
  const double angle = z + z * (z2 * polynomial(kArcTangent, z2));
  return is_upper ? 0.5 * kHalfPi + (angle + 0.5 * kHalfPiRest) : angle;
}

}  // namespace gonio::reflectance::lane
