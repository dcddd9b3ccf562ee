#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "bench/reflectance/ladder.h"
#include "bench/reflectance/quadrature.h"
#include "bench/reflectance/report.h"

namespace gonio::bench {

using Ladders = std::map<std::string, Ladder>;  ///< by method, of one case

/// What people read of the measured ladders: times to an error of 1e-6, times when asked for 1e-6, what it costs to
/// prepare a surface, and whether the claim of 100 times holds.
class RhoDhTables {
 public:
  explicit RhoDhTables(const std::vector<Method>& methods);

  void add(const Case& c, const Ladders& ladders);
  [[nodiscard]] std::string markdown() const;
  [[nodiscard]] bool claim_holds() const { return prepared_.short_of.empty(); }

 private:
  /// In how many cases one way of ours is 100 times faster than every general quadrature.
  struct Claim {
    std::size_t cases = 0;
    std::vector<std::string> short_of;

    void add(const Case& c, double ratio);
    [[nodiscard]] std::string sentence(const char* what) const;
  };

  void add_reached(const Case& c, const Ladders& ladders);
  void add_asked(const Case& c, const Ladders& ladders);
  void add_prepared(const Case& c, const Ladders& ladders);

  const std::vector<Method>& methods_;
  Table reached_;
  Table asked_;
  Table made_;
  std::string last_made_;
  Claim prepared_;
  Claim prepared_asked_;
  Claim direct_;
  Claim direct_asked_;
};

}  // namespace gonio::bench
