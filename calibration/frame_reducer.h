#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "calibration/aperture_mask.h"
#include "calibration/detector_maps.h"
#include "calibration/instrument_model.h"
#include "calibration/map_sums.h"
#include "calibration/power_sums.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// A frame, condensed.
struct ReducedFrame {
  RegionMoments raw;      ///< before dark and flat; of the pixels that count
  std::uint32_t bad = 0;  ///< pixels of the aperture that never count
  /// With maps only, and only when no counted pixel is saturated: such a mean would be wrong and look right.
  std::optional<ReducedMean> reduced;
};

/// Condenses frames of one size to the statistics of the aperture, prepared once. One pass over a frame: with
/// maps some rows of the aperture are summed raw, exactly, and then through the maps while they are near. Same bits
/// whenever the same frame comes, on every machine: integer sums, and floating ones in a fixed order without fused
/// operations. Immutable; threads: any.
class FrameReducer {
 public:
  /// Without maps: raw moments only. Pixels at `full_scale` or above count as saturated.
  /// Errors: OutOfLimits (the aperture is empty, reaches out of the frame, or no pixel of it is good), InvalidInput (a
  /// map is not width x height, or holds a value inside the aperture that it cannot be reduced with: not finite, a flat
  /// that is not positive).
  [[nodiscard]] static Result<FrameReducer> prepare(int width, int height, std::uint16_t full_scale,
                                                    const ApertureMask& mask,
                                                    const std::optional<DetectorMaps>& maps = std::nullopt,
                                                    const DetectorModel& noise = {});

  /// `pixels` row by row, top left first: [height][width], in DN. Exposure in s and gain in dB as the camera says it
  /// used. Errors: IncompleteData (not width x height pixels).
  [[nodiscard]] Result<ReducedFrame> reduce(std::span<const std::uint16_t> pixels, double exposure_s,
                                            double gain_db) const;

  /// Of the maps; empty without.
  [[nodiscard]] const std::string& version() const { return version_; }
  /// What one frame's reduction reads: pixels and maps of the aperture.
  [[nodiscard]] std::size_t bytes_read() const;

 private:
  /// The pixels of one row inside the aperture, and where their maps begin.
  struct Chord {
    std::size_t first = 0;  ///< in the frame
    std::size_t length = 0;
    std::size_t at = 0;  ///< in the maps below
  };

  FrameReducer(int width, int height, std::uint16_t full_scale) : width_(width), height_(height), summer_(full_scale) {}
  [[nodiscard]] Result<void> take_maps(const DetectorMaps& maps, std::uint16_t full_scale, const DetectorModel& noise);
  [[nodiscard]] MappedRow row_of(std::span<const std::uint16_t> pixels, const Chord& chord) const;
  [[nodiscard]] ReducedMean mean_of(const MapSums& sums, std::uint32_t pixels, double exposure_s, double gain_db) const;

  int width_;
  int height_;
  PowerSummer summer_;
  std::vector<Chord> chords_;
  std::vector<std::size_t> bad_;  ///< in the frame
  std::size_t pixels_inside_ = 0;
  std::size_t rows_ahead_ = 1;
  bool has_maps_ = false;
  bool is_curved_ = false;
  std::vector<float> offset_, rate_, weight_, curve_1_, curve_2_;  ///< chord after chord; weight: 1 / flat, 0 if bad
  double sum_weight2_ = 0.0;
  double u_offset_ = 0.0, u_rate_ = 0.0, u_flat_ = 0.0;
  double electrons_per_dn_ = 1.0, read_noise_dn_ = 0.0;
  std::string version_;
};

}  // namespace gonio::calibration
