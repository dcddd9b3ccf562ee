#include "reflectance/check/group_chi_square.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

constexpr std::size_t kMostComponents = 2048;  // 32 MB and some seconds

// A member less the weighted mean of its group.
struct Row {
  double residual;
  double weight;
  SharedEffects shared;
};

void add_centred(const std::vector<GroupMember>& group, std::vector<Row>& rows) {
  double weights = 0.0;
  for (const GroupMember& m : group) weights += 1.0 / (m.u_random * m.u_random);
  double mean = 0.0;
  double largest = 0.0;
  SharedEffects mean_shared;
  for (const GroupMember& m : group) {
    assert(m.u_random > 0.0);
    const double share = 1.0 / (m.u_random * m.u_random) / weights;
    mean += share * m.value;
    mean_shared.add(m.shared, share);
    for (const SharedEffects::Entry& e : m.shared.entries()) largest = std::max(largest, std::abs(e.per_sd));
  }
  for (const GroupMember& m : group) {
    Row row{.residual = m.value - mean, .weight = 1.0 / (m.u_random * m.u_random), .shared = m.shared};
    row.shared.add(mean_shared, -1.0);
    row.shared.drop_up_to(1e-14 * largest);
    rows.push_back(std::move(row));
  }
}

// A symmetric, positive definite system by Cholesky's factors: here 1 + what adds to it, so never singular.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t size) : size_(size), matrix_(size * size, 0.0), right_(size, 0.0) {
    for (std::size_t k = 0; k < size; ++k) at(k, k) = 1.0;
  }

  double& at(std::size_t row, std::size_t column) { return matrix_[row * size_ + column]; }
  double& right(std::size_t row) { return right_[row]; }

  // Reads the lower triangle.
  std::vector<double> solve() {
    for (std::size_t j = 0; j < size_; ++j) {
      for (std::size_t i = j; i < size_; ++i) {
        double sum = at(i, j);
        for (std::size_t k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
        at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
      }
    }
    std::vector<double> x = right_;
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= at(i, k) * x[k];
      x[i] /= at(i, i);
    }
    for (std::size_t i = size_; i-- > 0;) {
      for (std::size_t k = i + 1; k < size_; ++k) x[i] -= at(k, i) * x[k];
      x[i] /= at(i, i);
    }
    return x;
  }

 private:
  std::size_t size_;
  std::vector<double> matrix_;
  std::vector<double> right_;
};

using Places = std::map<std::uint32_t, std::size_t>;

Places places_of_components(const std::vector<Row>& rows) {
  Places places;
  for (const Row& row : rows) {
    for (const SharedEffects::Entry& e : row.shared.entries()) places.emplace(e.component, 0);
  }
  std::size_t next = 0;
  for (auto& place : places) place.second = next++;
  return places;
}

std::vector<double> most_likely_errors(const std::vector<Row>& rows, const Places& places) {
  NormalEquations equations(places.size());
  for (const Row& row : rows) {
    for (const SharedEffects::Entry& a : row.shared.entries()) {
      const std::size_t place_a = places.at(a.component);
      equations.right(place_a) += row.weight * a.per_sd * row.residual;
      for (const SharedEffects::Entry& b : row.shared.entries()) {
        if (b.component > a.component) break;
        equations.at(place_a, places.at(b.component)) += row.weight * a.per_sd * b.per_sd;
      }
    }
  }
  return equations.solve();
}

double chi_square_at(const std::vector<Row>& rows, const Places& places, const std::vector<double>& errors) {
  double chi2 = 0.0;
  for (const Row& row : rows) {
    double residual = row.residual;
    for (const SharedEffects::Entry& e : row.shared.entries()) residual -= e.per_sd * errors[places.at(e.component)];
    chi2 += row.weight * residual * residual;
  }
  for (const double e : errors) chi2 += e * e;
  return chi2;
}

}  // namespace

Result<GroupChiSquare> group_chi_square(std::span<const std::vector<GroupMember>> groups) {
  std::vector<Row> rows;
  for (const std::vector<GroupMember>& group : groups) add_centred(group, rows);
  const Places places = places_of_components(rows);
  if (places.size() > kMostComponents) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "find the chi-square of groups",
                    .seen = fmt::format("{} shared components that do not cancel", places.size()),
                    .limit = fmt::format("at most {}", kMostComponents)});
  }
  const std::vector<double> errors = most_likely_errors(rows, places);
  return GroupChiSquare{.chi2 = chi_square_at(rows, places, errors), .degrees_of_freedom = rows.size() - groups.size()};
}

}  // namespace gonio::reflectance
