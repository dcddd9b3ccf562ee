#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gonio::reflectance {

/// Where a batch of draws is written, one array a component: unit vectors in the frame of the sample (z = mu_r), the
/// weight of each, and whether it came from the mirror part. All of one length.
struct SampleBatch {
  std::span<double> x;
  std::span<double> y;
  std::span<double> z;
  std::span<double> weight;
  std::span<std::uint8_t> is_specular;

  [[nodiscard]] std::size_t size() const { return weight.size(); }
  [[nodiscard]] SampleBatch part(std::size_t first, std::size_t count) const {
    return {x.subspan(first, count), y.subspan(first, count), z.subspan(first, count), weight.subspan(first, count),
            is_specular.subspan(first, count)};
  }
};

/// The memory of a batch.
class SampleArrays {
 public:
  explicit SampleArrays(std::size_t size) : x_(size), y_(size), z_(size), weight_(size), is_specular_(size) {}

  /// Valid as long as this lives.
  [[nodiscard]] SampleBatch batch() { return {x_, y_, z_, weight_, is_specular_}; }

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> z_;
  std::vector<double> weight_;
  std::vector<std::uint8_t> is_specular_;
};

}  // namespace gonio::reflectance
