#include "reflectance/integral/prepared_reflectance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/surface/smooth_part.h"

namespace gonio::reflectance {
namespace {

constexpr double kFinest = 1e-12;
constexpr double kCoarsest = 1e-2;
constexpr std::size_t kMostTrials = 400;  // of pieces: some 5000 direct integrals

// A sum is integrated term by term, each by its own method.
Integral smooth_rho_dh(const Surface& surface, const Direction& i, double tolerance) {
  if (surface.terms().empty()) return rho_dh(SmoothPart{surface}, i, tolerance);
  Integral total;
  for (const SurfaceTerm& term : surface.terms()) total.add(smooth_rho_dh(term.surface, i, tolerance), term.weight);
  return total;
}

Direction at_root_of_mu(double v) {
  const double mu = v * v;
  return Direction::from_cosine(mu, std::sqrt((1.0 - mu) * (1.0 + mu)), Angle{});
}

// Values at the N roots of T_N -> coefficients of T_0 ... T_(N-1).
template <std::size_t N>
std::array<double, N> chebyshev_coefficients(const std::array<double, N>& values) {
  std::array<double, N> c{};
  for (std::size_t j = 0; j < N; ++j) {
    for (std::size_t k = 0; k < N; ++k) {
      c[j] += values[k] * std::cos(std::numbers::pi * static_cast<double>(j) * (static_cast<double>(k) + 0.5) / N);
    }
    c[j] *= (j == 0 ? 1.0 : 2.0) / N;
  }
  return c;
}

// ... -> coefficients of 1, t, t^2 ...: the high ones are small here, so that no digits are lost.
template <std::size_t N>
std::array<double, N> powers_of(const std::array<double, N>& c) {
  std::array<double, N> sum{};
  std::array<double, N> before{};
  std::array<double, N> now{};
  before[0] = 1.0;  // T_0
  now[1] = 1.0;     // T_1
  sum[0] = c[0];
  for (std::size_t j = 1; j < N; ++j) {
    for (std::size_t k = 0; k < N; ++k) sum[k] += c[j] * now[k];
    std::array<double, N> next{};
    for (std::size_t k = 0; k < N; ++k) next[k] = (k == 0 ? 0.0 : 2.0 * now[k - 1]) - before[k];
    before = std::exchange(now, next);
  }
  return sum;
}

Error refusal(const Surface& surface, std::string field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("prepare rho_dh of \"{}\"", surface.model()),
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{.field = std::move(field)}};
}

}  // namespace

Result<PreparedReflectance> PreparedReflectance::make(const Surface& surface, double relative_tolerance) {
  if (!surface.is_isotropic()) {
    return failure(refusal(surface, "surface", "a surface that knows azimuths", "an isotropic one"));
  }
  if (!(relative_tolerance >= kFinest && relative_tolerance <= kCoarsest)) {
    return failure(refusal(surface, "relative_tolerance", fmt::format("{}", relative_tolerance),
                           fmt::format("{} to {}", kFinest, kCoarsest)));
  }
  return PreparedReflectance(surface, relative_tolerance);
}

PreparedReflectance::PreparedReflectance(const Surface& surface, double relative_tolerance)
    : surface_(surface), relative_tolerance_(relative_tolerance), piece_of_cell_(kCells, kDirect) {
  // Octaves of v from the normal down: what the horizon does is left to the small ones.
  for (std::size_t count = kCells / 2; count >= kFirstCell; count /= 2) prepare({.first = count, .count = count});
}

void PreparedReflectance::prepare(Cells cells) {
  Piece piece;
  if (fits(cells, piece)) {
    for (std::size_t k = 0; k < cells.count; ++k) {
      piece_of_cell_[cells.first + k] = static_cast<std::uint16_t>(pieces_.size());
    }
    pieces_.push_back(piece);
    return;
  }
  if (cells.count == 1 || trials_ >= kMostTrials || evaluations_ >= kMostRefinedEvaluations) return;
  const std::size_t half = cells.count / 2;
  prepare({.first = cells.first + half, .count = half});
  prepare({.first = cells.first, .count = half});
}

bool PreparedReflectance::fits(Cells cells, Piece& piece) {
  ++trials_;
  const double half_width = 0.5 * static_cast<double>(cells.count) / kCells;
  piece.middle = static_cast<double>(cells.first) / kCells + half_width;
  piece.per_half_width = 1.0 / half_width;
  std::array<double, kNodes> values{};
  double node_error = 0.0;
  double least = 0.0;
  for (std::size_t k = 0; k < kNodes; ++k) {
    const double t = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / kNodes);
    const Integral node = smooth_part(piece.middle + half_width * t);
    values[k] = node.value;
    node_error = std::max(node_error, node.error);
    least = k == 0 ? std::abs(node.value) : std::min(least, std::abs(node.value));
  }
  piece.powers = powers_of(chebyshev_coefficients(values));
  // The first neglected term, T_10, is largest at the ends and in the middle.
  double seen = 0.0;
  for (const double t : {-1.0, 0.0, 1.0}) {
    const double v = piece.middle + half_width * t;
    const Integral check = smooth_part(v);
    seen = std::max(seen, std::abs(piece.at(v) - check.value));
    node_error = std::max(node_error, check.error);
  }
  constexpr double kLebesgue = 2.5;  // how much an error of the ten values can grow between them
  piece.error = 2.0 * seen + kLebesgue * node_error;
  return piece.error <= relative_tolerance_ * least;
}

Integral PreparedReflectance::smooth_part(double v) {
  const Integral value = smooth_rho_dh(surface_, at_root_of_mu(v), std::max(0.1 * relative_tolerance_, 1e-14));
  evaluations_ += value.evaluations;
  return value;
}

Integral PreparedReflectance::rho_dh(const Direction& i) const {
  const double v = std::sqrt(i.mu());
  const auto cell = std::min(kCells - 1, static_cast<std::size_t>(v * kCells));
  const std::uint16_t index = piece_of_cell_[cell];
  if (index == kDirect) return reflectance::rho_dh(surface_, i, relative_tolerance_);
  const Piece& piece = pieces_[index];
  return {.value = piece.at(v) + surface_.specular(i), .error = piece.error};
}

}  // namespace gonio::reflectance
