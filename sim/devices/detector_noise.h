#pragma once

#include <cstdint>
#include <vector>

#include "base/clock.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// One finished exposure: what fell on the detector, before any of its noise.
struct Exposure {
  std::uint64_t number = 0;  ///< over the life of the instrument: the key of its noise
  Instant open{};
  Instant close{};
  double light_electrons = 0.0;  ///< mean of a lit pixel, nonlinearity included
  double dark_electrons = 0.0;   ///< mean of any pixel: dark charge, and light that falls everywhere
  double gain_db = 0.0;
  double offset_shift_dn = 0.0;  ///< beside the scene's offset
  std::uint64_t place = 0;       ///< the key of its speckle, which other exposures may share
};

/// A circle of pixels; pixel (0, 0) has its centre at (0, 0). Inside: the centre's distance is at most the radius.
struct Aperture {
  double centre_x_px = 0.0;
  double centre_y_px = 0.0;
  double radius_px = 0.0;
};
/// The circle that the daemon is told of, in the middle of the frame.
[[nodiscard]] Aperture aperture_of(const DetectorSpec& spec);

/// Pixel statistics inside the aperture, in DN; central moments divided by n.
struct RegionStatistics {
  std::uint32_t n = 0;
  double mean = 0.0;
  double m2 = 0.0;
  double m3 = 0.0;
  double m4 = 0.0;
  std::uint32_t saturated = 0;
};

/// The frame of an exposure, row by row: Poisson electrons, read noise, offset, rounded and clipped to its bits. The
/// lit spot is a disc in the middle with an edge two pixels wide, as grainy as the speckle of its place. The same
/// exposure of the same seed gives the same frame.
[[nodiscard]] std::vector<std::uint16_t> render_frame(const DetectorSpec& spec, const Exposure& exposure,
                                                      std::uint64_t seed);

/// The statistics that such a frame would have, drawn from their own distribution instead of pixel by pixel: some
/// hundred times faster. Where clipping, coarse rounding or speckle shapes the distribution, the aperture's pixels are
/// drawn after all.
[[nodiscard]] RegionStatistics draw_region(const DetectorSpec& spec, const Exposure& exposure, std::uint64_t seed);

/// The light's electrons as the detector turns them into signal: net (1 + eps net / full scale).
[[nodiscard]] double after_nonlinearity(const DetectorSpec& spec, double light_electrons, double nonlinearity);

}  // namespace gonio::sim
