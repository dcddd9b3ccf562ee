#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/toml_reader.h"
#include "protocol/stage/axis.h"
#include "protocol/stage/drive_map.h"
#include "protocol/stage/io_map.h"

namespace gonio::stage {

/// Which drive moves an axis. Scales turn the drive's counts into the axis' unit; that of the position may be negative,
/// those of speed and acceleration are not.
struct DriveAxis {
  std::uint8_t unit_id = 1;
  std::string map;                  ///< a name of `DriveStageMap::maps`
  double scale = 1.0;               ///< unit per count of `position` and of targets
  double speed_scale = 1.0;         ///< unit per second, per count
  double acceleration_scale = 1.0;  ///< unit per second squared, per count
  std::optional<double> fixed;      ///< no drive at all: the axis stands there, and all above means nothing
  friend bool operator==(const DriveAxis&, const DriveAxis&) = default;
};

/// A stage of one drive an axis and an optional coupler, on one line or behind one gateway.
struct DriveStageMap {
  PerAxis<DriveAxis> axes{};
  std::map<std::string, DriveMap, std::less<>> maps;
  std::optional<IoMap> io;
  friend bool operator==(const DriveStageMap&, const DriveStageMap&) = default;

  [[nodiscard]] const DriveAxis& axis(Axis a) const { return axes[index_of(a)]; }
  /// Nothing for an axis without a drive.
  [[nodiscard]] const DriveMap* map_of(Axis a) const;
};

/// Reads the table [stage.drives]. Errors stick in `table`: as read_drive_map, a map that is not there, two axes on one
/// unit, a coupler on an axis' unit.
[[nodiscard]] DriveStageMap read_drive_stage_map(TomlReader& table);
/// The same as TOML text, under headings that begin with `prefix` ("stage.drives"); read back it is equal.
[[nodiscard]] std::string to_toml(const DriveStageMap& map, std::string_view prefix);

}  // namespace gonio::stage
