// Vectors of four doubles, for any x86-64 and once more for AVX2 (vector_clones.h): the same steps in the same order,
// none of them fused, so that both give the same bits.
#include "calibration/line_derivatives.h"

#include <cstring>
#include <limits>

#include "calibration/vector_clones.h"

namespace gonio::calibration {
namespace {

using Vector = double __attribute__((vector_size(kLineLanes * sizeof(double))));
using Mask = long long __attribute__((vector_size(kLineLanes * sizeof(long long))));
constexpr std::size_t kNodes = LineNodes::kAtMost;

GONIO_INLINE void load(const LineLanes& from, Vector& to) {
  std::memcpy(&to, from.data(), sizeof(to));
}

GONIO_INLINE void keep(const Vector& from, LineLanes& to) {
  std::memcpy(to.data(), &from, sizeof(from));
}

GONIO_INLINE void set_larger(Vector& a, const Vector& b) {
  a = b > a ? b : a;
}

// |a - b|, of lines that have as many nodes; else 0.
GONIO_INLINE void set_apart(Vector& to, const Vector& a, const Vector& b, const Mask& has) {
  const Vector none = {};
  const Vector d = a - b;
  to = has ? (d < none ? -d : d) : none;
}

/// Derivatives of the polynomials of each order p through p + 1 nodes, and their variances.
struct Orders {
  Vector first[kNodes] = {};
  Vector first_noise2[kNodes] = {};
  Vector second[kNodes] = {};
  Vector second_noise2[kNodes] = {};
  Vector own[kNodes] = {};  // of as high an order as the polynomial's: p = 3 and 4
  Vector own_noise2[kNodes] = {};
};

/// The weights of the nodes' y in the derivatives, order after order.
struct Weights {
  Vector divided[kNodes] = {};  // in y[x_0 .. x_p]
  Vector first[kNodes] = {};
  Vector second[kNodes] = {};
  Vector product = {};     // of -x_m, 1 <= m < p
  Vector derivative = {};  // sum over m of the products without m
};

GONIO_INLINE void add_order(std::size_t p, const Vector (&x)[kNodes], const Vector (&y)[kNodes],
                            const Vector (&u2)[kNodes], Weights& w, Orders& orders) {
  const Vector twice = 2.0 * w.derivative;
  w.divided[p] = Vector{} + 1.0;
  for (std::size_t j = 0; j < p; ++j) {
    const Vector per_step = 1.0 / (x[j] - x[p]);
    w.divided[j] *= per_step;
    w.divided[p] *= -per_step;
  }
  for (std::size_t j = 0; j <= p; ++j) {
    w.first[j] += w.product * w.divided[j];
    w.second[j] += twice * w.divided[j];
    orders.first[p] += w.first[j] * y[j];
    orders.second[p] += w.second[j] * y[j];
    orders.first_noise2[p] += w.first[j] * w.first[j] * u2[j];
    orders.second_noise2[p] += w.second[j] * w.second[j] * u2[j];
  }
  w.derivative = w.product - x[p] * w.derivative;
  w.product *= -x[p];
}

// The derivative as high as the polynomial: p! y[x_0 .. x_p].
GONIO_INLINE void add_own(std::size_t p, double factorial, const Vector (&y)[kNodes], const Vector (&u2)[kNodes],
                          const Weights& w, Orders& orders) {
  for (std::size_t j = 0; j <= p; ++j) {
    const Vector weight = factorial * w.divided[j];
    orders.own[p] += weight * y[j];
    orders.own_noise2[p] += weight * weight * u2[j];
  }
}

/// The order so far that has least noise and misses least.
struct Choice {
  Vector least = Vector{} + std::numeric_limits<double>::infinity();
  Vector value = {};
  Vector missed = {};
  Vector noise2 = {};
};

GONIO_INLINE void weigh(const Vector& value, const Vector& missed, const Vector& noise2, const Mask& has,
                        Choice& choice) {
  const Vector all = noise2 + missed * missed;
  const Mask is_better = has & (all < choice.least);
  choice.least = is_better ? all : choice.least;
  choice.value = is_better ? value : choice.value;
  choice.missed = is_better ? missed : choice.missed;
  choice.noise2 = is_better ? noise2 : choice.noise2;
}

// Of each order from 1 on; a constant's slope is 0.
GONIO_INLINE void choose_first(const Orders& orders, const Mask (&has)[kNodes], Choice& choice) {
  Vector steps[kNodes + 1] = {};
  for (std::size_t p = 1; p < kNodes; ++p) set_apart(steps[p], orders.first[p], orders.first[p - 1], has[p]);
  for (std::size_t p = 1; p < kNodes; ++p) {
    set_larger(steps[p], steps[p + 1]);
    weigh(orders.first[p], steps[p], orders.first_noise2[p], has[p], choice);
  }
}

// From order 2 on. That has no lower one to be held against, but higher ones: two may agree by accident, three hardly;
// where it is the only one, half of it stands for what it misses.
GONIO_INLINE void choose_second(const Orders& orders, const Vector& logarithm, const Mask (&has)[kNodes],
                                Choice& choice) {
  Vector value[kNodes] = {};
  for (std::size_t p = 2; p < kNodes; ++p)
    value[p] = orders.second[p] + logarithm * (orders.first[p] * orders.first[p]);
  const Vector none = {};
  Vector to_third, to_fourth, over_two;
  set_apart(to_third, value[3], value[2], has[3]);
  set_apart(to_fourth, value[4], value[3], has[4]);
  set_apart(over_two, value[4], value[2], has[4]);
  const Vector half = 0.5 * (value[2] < none ? -value[2] : value[2]);
  Vector missed = has[3] ? to_third : half;
  set_larger(missed, over_two);
  weigh(value[2], missed, orders.second_noise2[2], has[2], choice);
  missed = to_third;
  set_larger(missed, to_fourth);
  weigh(value[3], missed, orders.second_noise2[3], has[3], choice);
  weigh(value[4], to_fourth, orders.second_noise2[4], has[4], choice);
}

GONIO_INLINE void keep_square(const Orders& orders, std::size_t p, const Mask& has, LineLanes& to) {
  const Vector none = {};
  const Vector square = orders.own[p] * orders.own[p] - orders.own_noise2[p];
  keep((has & (square > none)) ? square : none, to);
}

GONIO_INLINE void differentiate_lanes(const LineNodes& nodes, LineDerivatives& found) {
  Vector x[kNodes], y[kNodes], u2[kNodes], size, logarithm;
  Mask has[kNodes];  // [p]: the line has a polynomial of order p
  load(nodes.size, size);
  load(nodes.is_logarithm, logarithm);
  for (std::size_t p = 0; p < kNodes; ++p) {
    load(nodes.x[p], x[p]);
    load(nodes.y[p], y[p]);
    load(nodes.u2[p], u2[p]);
    has[p] = size > static_cast<double>(p);
  }
  Orders orders;
  Weights w;
  w.divided[0] += 1.0;
  w.product += 1.0;
  add_order(1, x, y, u2, w, orders);
  add_order(2, x, y, u2, w, orders);
  add_order(3, x, y, u2, w, orders);
  add_own(3, 6.0, y, u2, w, orders);
  add_order(4, x, y, u2, w, orders);
  add_own(4, 24.0, y, u2, w, orders);
  Choice first, second;
  choose_first(orders, has, first);
  choose_second(orders, logarithm, has, second);
  keep(first.value, found.first);
  keep(first.missed, found.first_missed);
  keep(second.value, found.second);
  keep(second.missed, found.second_missed);
  keep(second.noise2, found.second_noise2);
  keep_square(orders, 3, has[4], found.third2);
  keep_square(orders, 4, has[4], found.fourth2);
}

GONIO_CLONE(differentiate_clones, differentiate_lanes, (const LineNodes& nodes, LineDerivatives& found), (nodes, found))

}  // namespace

void differentiate(const LineNodes& nodes, LineDerivatives& found) {
  differentiate_clones(nodes, found);
}

}  // namespace gonio::calibration
