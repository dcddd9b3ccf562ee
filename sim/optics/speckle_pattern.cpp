#include "sim/optics/speckle_pattern.h"

#include "sim/scene/chance.h"

namespace gonio::sim {

SpecklePattern::SpecklePattern(const SpeckleSpec& spec, int width_px, int height_px, std::uint64_t seed,
                               std::uint64_t place)
    : grain_px_(spec.grain_px) {
  if (spec.contrast == 0.0) return;
  Chance chance(seed, Purpose::Speckle, place);
  const auto shift = [&] { return static_cast<int>(chance.uniform() * grain_px_); };
  shift_x_ = shift();
  shift_y_ = shift();
  columns_ = (width_px - 1 + shift_x_) / grain_px_ + 1;
  const int rows = (height_px - 1 + shift_y_) / grain_px_ + 1;
  // Gamma with shape 1 / contrast^2 and mean 1, as chi-squared over its degrees of freedom.
  const double freedom = 2.0 / (spec.contrast * spec.contrast);
  grains_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows));
  for (double& grain : grains_) grain = chance.chi_squared(freedom) / freedom;
}

double SpecklePattern::operator()(int x, int y) const {
  if (grains_.empty()) return 1.0;
  const int column = (x + shift_x_) / grain_px_;
  const int row = (y + shift_y_) / grain_px_;
  return grains_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)];
}

}  // namespace gonio::sim
