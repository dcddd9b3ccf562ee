#include "reflectance/check/shared_effects.h"

#include <algorithm>
#include <cmath>

namespace gonio::reflectance {

SharedEffects::SharedEffects(const std::vector<SharedEffect>& effects) {
  std::vector<Entry> sorted;
  sorted.reserve(effects.size());
  for (const SharedEffect& e : effects) sorted.push_back({.component = e.component, .per_sd = e.per_sd.si()});
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Entry& a, const Entry& b) { return a.component < b.component; });
  for (const Entry& e : sorted) {
    if (!entries_.empty() && entries_.back().component == e.component) {
      entries_.back().per_sd += e.per_sd;
    } else {
      entries_.push_back(e);
    }
  }
}

void SharedEffects::add(const SharedEffects& other, double factor) {
  std::vector<Entry> sum;
  sum.reserve(entries_.size() + other.entries_.size());
  auto a = entries_.begin();
  for (const Entry& b : other.entries_) {
    while (a != entries_.end() && a->component < b.component) sum.push_back(*a++);
    const bool is_common = a != entries_.end() && a->component == b.component;
    const double own = is_common ? (a++)->per_sd : 0.0;
    sum.push_back({.component = b.component, .per_sd = own + factor * b.per_sd});
  }
  sum.insert(sum.end(), a, entries_.end());
  entries_ = std::move(sum);
}

void SharedEffects::drop_up_to(double most) {
  entries_.erase(
      std::remove_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return std::abs(e.per_sd) <= most; }),
      entries_.end());
}

double size_of(const SharedEffects& effects) {
  double sum = 0.0;
  for (const SharedEffects::Entry& e : effects.entries()) sum += e.per_sd * e.per_sd;
  return std::sqrt(sum);
}

}  // namespace gonio::reflectance
