#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "base/units.h"

namespace gonio::calibration {

/// What one standard deviation of a component does to a value. Absolute, in sr^-1, for the value may be 0 or negative.
struct BudgetTerm {
  std::uint32_t component = 0;  ///< index into the scan's table of components
  Brdf per_sd;                  ///< signed for shared components, >= 0 for random ones
  friend bool operator==(const BudgetTerm&, const BudgetTerm&) = default;
};

/// Terms in two columns, which others keep: points that have the same components share the one that names them.
class BudgetTerms {
 public:
  class Iterator {
   public:
    using value_type = BudgetTerm;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(const std::uint32_t* component, const Brdf* per_sd) : component_(component), per_sd_(per_sd) {}
    BudgetTerm operator*() const { return {*component_, *per_sd_}; }
    Iterator& operator++() {
      ++component_;
      ++per_sd_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    const std::uint32_t* component_ = nullptr;
    const Brdf* per_sd_ = nullptr;
  };

  BudgetTerms() = default;
  /// `size` numbers in each column, which must outlive it.
  BudgetTerms(const std::uint32_t* components, const Brdf* per_sds, std::size_t size)
      : components_(components), per_sds_(per_sds), size_(size) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] BudgetTerm operator[](std::size_t n) const { return {components_[n], per_sds_[n]}; }
  [[nodiscard]] Iterator begin() const { return {components_, per_sds_}; }
  [[nodiscard]] Iterator end() const { return {components_ + size_, per_sds_ + size_}; }
  [[nodiscard]] const std::uint32_t* components() const { return components_; }
  [[nodiscard]] const Brdf* per_sds() const { return per_sds_; }

 private:
  const std::uint32_t* components_ = nullptr;
  const Brdf* per_sds_ = nullptr;
  std::size_t size_ = 0;
};

/// Both columns of a budget's terms, the random ones first. Used again for the next one.
class TermColumns {
 public:
  /// Empty, with room for so many terms.
  void begin(std::size_t room) {
    size_ = 0;
    if (components_.size() >= room) return;
    components_.resize(room);
    per_sds_.resize(room);
  }
  void add(const BudgetTerm& term) {
    components_[size_] = term.component;
    per_sds_[size_++] = term.per_sd;
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Until the next `begin`.
  [[nodiscard]] BudgetTerms terms(std::size_t first, std::size_t last) const {
    return {components_.data() + first, per_sds_.data() + first, last - first};
  }

 private:
  std::vector<std::uint32_t> components_;
  std::vector<Brdf> per_sds_;
  std::size_t size_ = 0;
};

}  // namespace gonio::calibration
