#pragma once

#include <vector>

#include "base/result.h"
#include "reflectance/formats/brdf_metadata.h"
#include "reflectance/formats/channel.h"
#include "reflectance/formats/loss.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/surface/surface.h"
#include "reflectance/table/table_options.h"

namespace gonio::formats {

struct ChannelSurface {
  Channel channel;
  reflectance::Surface surface;
};

/// What formats with directions of their own are written from: a surface for each channel, which may be a measured
/// table, a fit or a formula. `losses` is what was lost on the way here.
struct SurfaceFile {
  BrdfMetadata metadata;
  std::vector<ChannelSurface> channels;
  Losses losses;
};

/// A table of each channel's points, by `symmetry_of`, which overrules that of `options`, as is the layout; no flag,
/// uncertainty or polarisation goes with it. Errors: as `check`, as table_of_readings (fewer than two directions, an
/// incidence for each point as in tables of half and difference angles), naming the channel.
[[nodiscard]] Result<SurfaceFile> surfaces_of(const MeasuredBrdf& brdf, reflectance::TableOptions options = {});

/// Values read off a surface at a format's own directions, and how many of them were negative or not measured.
class GridReader {
 public:
  explicit GridReader(const ChannelSurface& channel);

  /// f_r [sr^-1], its sign as it is.
  [[nodiscard]] double at(const reflectance::Direction& i, const reflectance::Direction& r);
  /// The same with 0 for a negative value, which is counted.
  [[nodiscard]] double at_least_zero(const reflectance::Direction& i, const reflectance::Direction& r);

  /// Adds Resampled (of a measured table), Extrapolated and Sign, where any value is concerned.
  void add_losses(Losses& losses) const;

 private:
  reflectance::Surface surface_;
  bool is_table_;
  std::size_t read_ = 0;
  std::size_t uncovered_ = 0;
  std::size_t negative_ = 0;
};

/// Adds Anisotropy when the surface changes with phi_i, which `format` does not know; it is read at phi_i = 0.
void add_anisotropy_loss(Losses& losses, const reflectance::Surface& surface);

/// InvalidInput unless there is a channel.
[[nodiscard]] Result<void> check(const SurfaceFile& file, std::string_view format);

/// The suffix of a file of one channel, as `channel_suffix` of a MeasuredBrdf.
[[nodiscard]] std::string channel_suffix(const SurfaceFile& file, std::size_t channel);

}  // namespace gonio::formats
