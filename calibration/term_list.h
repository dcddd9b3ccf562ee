#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/budget.h"
#include "calibration/component_table.h"

namespace gonio::calibration {

/// What a component has beside its name and size.
struct ComponentTraits {
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  Distribution distribution = Distribution::Normal;
  std::uint8_t unknown_angle = 0;  ///< Component::unknown_angle
  std::string_view owner;          ///< Component::owner
  bool is_pattern_known = true;    ///< Component::is_pattern_known
  bool is_of_the_wander = false;
};

/// The terms of one point on their way to a budget; used again for the next one. Threads: one each.
class TermList {
 public:
  explicit TermList(ComponentTable& table) : table_(table) {}

  void clear() {
    table_.begin_point();
    random_.clear();
    shared_.clear();
    divisor_.clear();
  }

  /// A random term of `per_sd` sr^-1. Known equally well, it is one component: readings of five and of nine frames have
  /// two.
  void random(ComponentSource source, std::string_view name, double u, std::string_view unit, double per_sd,
              double degrees_of_freedom = std::numeric_limits<double>::infinity()) {
    const std::int64_t worth = std::isinf(degrees_of_freedom) ? 0 : std::llround(degrees_of_freedom);
    const std::uint32_t index = table_.index({source, worth, 0, 0}, [&] {
      return Component{.name = std::string(name),
                       .kind = ComponentKind::Random,
                       .u = u,
                       .unit = std::string(unit),
                       .degrees_of_freedom = degrees_of_freedom,
                       .is_of_the_wander = source == ComponentSource::DriftRest && std::isfinite(degrees_of_freedom)};
    });
    random_.push_back({index, per_steradian(std::abs(per_sd))});
  }

  /// A shared term; `name()` is only asked for a new component. Nothing where u is 0.
  template <class Name>
  void shared(const ComponentTable::Key& key, double u, std::string_view unit, double per_sd, const Name& name,
              const ComponentTraits& traits = {}) {
    if (u == 0.0) return;
    shared_.push_back({index_of(key, u, unit, name, traits), per_steradian(per_sd)});
  }

  /// Marks the last term of that kind as the value's share in an error of the divisor q_ref: `relative` of it per
  /// standard deviation, so that per_sd = -value relative (monte_carlo.h).
  void last_random_divides(double relative) { divisor_.push_back({random_.back().component, relative}); }
  void last_shared_divides(double relative) {
    if (!shared_.empty()) divisor_.push_back({shared_.back().component, relative});
  }

  struct DivisorTerm {
    std::uint32_t component = 0;
    double relative = 0.0;
  };
  [[nodiscard]] const std::vector<DivisorTerm>& divisor() const { return divisor_; }
  [[nodiscard]] const std::vector<BudgetTerm>& shared_terms() const { return shared_; }
  [[nodiscard]] const std::vector<BudgetTerm>& random_terms() const { return random_; }
  [[nodiscard]] const std::vector<Component>& components() const { return table_.components(); }

  /// Sorts and merges the terms (make_budget). It refers to them: until the next change of this list.
  [[nodiscard]] Budget budget() { return make_budget(table_.components(), random_, shared_, made_); }

 private:
  template <class Name>
  std::uint32_t index_of(const ComponentTable::Key& key, double u, std::string_view unit, const Name& name,
                         const ComponentTraits& traits) {
    return table_.index(key, [&] {
      return Component{.name = std::string(name()),
                       .kind = ComponentKind::Shared,
                       .u = u,
                       .unit = std::string(unit),
                       .degrees_of_freedom = traits.degrees_of_freedom,
                       .distribution = traits.distribution,
                       .unknown_angle = traits.unknown_angle,
                       .owner = std::string(traits.owner),
                       .is_pattern_known = traits.is_pattern_known,
                       .is_of_the_wander = traits.is_of_the_wander};
    });
  }

  ComponentTable& table_;
  std::vector<BudgetTerm> random_;
  std::vector<BudgetTerm> shared_;
  std::vector<DivisorTerm> divisor_;
  TermColumns made_;
};

}  // namespace gonio::calibration
