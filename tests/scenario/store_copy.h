#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gonio::test {

/// A BRDF value as stored. In sr^-1.
struct StoredValue {
  double value = 0.0;
  double u_random = 0.0;
  std::map<std::string, double> shared;  ///< what one standard deviation of each shared component does, by its name
};

/// A point of a scan as it was accepted.
struct StoredPoint {
  double theta_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
};

/// The store's file as it lay on the disk when this was made, its journal included: a copy, so that reading it leaves
/// the recovery of a journal to the next daemon. Make it while no daemon runs. Throws what the database throws.
class StoreCopy {
 public:
  /// `folder` takes the copy; it is overwritten by the next one.
  StoreCopy(const std::string& store, const std::string& folder);
  ~StoreCopy();

  /// "ok", or what is wrong with the file.
  [[nodiscard]] std::string integrity() const;
  /// The numbers of all events, ascending.
  [[nodiscard]] std::vector<long> event_numbers() const;
  /// Rows of a table, or how many of a query's.
  [[nodiscard]] long count(const std::string& from) const;
  /// Everything that is stored of each accepted item, "POINT TARGET" -> its attempt's and its readings' columns with
  /// every bit of them.
  [[nodiscard]] std::map<std::string, std::string> accepted_items() const;
  /// Exposures by what they were of: "POINT TARGET" as above, "dark" for visits. Accepted, failed and dropped attempts.
  [[nodiscard]] std::map<std::string, long> exposures() const;
  /// The points of a scan, by index.
  [[nodiscard]] std::map<long, StoredPoint> points(long scan) const;
  /// The newest BRDF of a scan, by point.
  [[nodiscard]] std::map<long, StoredValue> brdf(long scan) const;

 private:
  struct Database;
  std::unique_ptr<Database> database_;
};

}  // namespace gonio::test
