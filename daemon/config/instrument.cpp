#include "daemon/config/instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/read_file.h"
#include "base/toml_reader.h"
#include "daemon/config/absolute_section.h"
#include "daemon/config/beams_section.h"
#include "daemon/config/configuration_hash.h"
#include "daemon/config/drives_section.h"
#include "daemon/config/holds_section.h"
#include "daemon/config/keep_out_section.h"
#include "daemon/config/kinematics_section.h"
#include "daemon/config/power_meter_section.h"

namespace gonio::daemon {
namespace {

constexpr double kAnHour = 3600.0;
constexpr NumberRange kSomeTime{.least = 1e-6, .most = kAnHour, .unit = "s"};
constexpr NumberRange kTime{.least = 0.0, .most = kAnHour, .unit = "s"};
constexpr NumberRange kLength{.least = 1e-3, .most = 1e5, .unit = "mm"};
constexpr NumberRange kNotNegative{.least = 0.0};
constexpr NumberRange kFraction{.least = 0.0, .most = 1.0};
/// Of any axis, in its unit: beyond it a position would have lost digits that its encoder counts.
constexpr double kFarthestPosition = 1e6;
constexpr NumberRange kAngleUncertainty{.least = 0.0, .most = 5.0, .unit = "deg"};

Duration time(TomlReader& table, std::string_view key, NumberRange range = kSomeTime) {
  return seconds(table.number(key, range));
}

Angle angle(TomlReader& table, std::string_view key, NumberRange range) {
  return degrees(table.number(key, range));
}

Length length(TomlReader& table, std::string_view key, NumberRange range = kLength) {
  return millimetres(table.number(key, range));
}

drivers::AxisConfig read_axis(TomlReader& table, std::string_view unit) {
  const auto key = [&](std::string_view name, std::string_view per = {}) {
    return fmt::format("{}_{}{}", name, unit, per);
  };
  const NumberRange position{.least = -kFarthestPosition, .most = kFarthestPosition, .unit = unit};
  const NumberRange positive{.least = 1e-9, .unit = unit};
  drivers::AxisConfig axis;
  axis.offset = table.number(key("offset"), position);
  axis.low = table.number(key("low"), position);
  axis.high = table.number(key("high"), position);
  axis.speed = table.number(key("speed", "_per_s"), positive);
  axis.acceleration = table.number(key("acceleration", "_per_s2"), positive);
  axis.settle = time(table, "settle_s", kTime);
  axis.window = table.number(key("window"), positive);
  static constexpr std::array<std::string_view, 3> kApproaches{"any", "from below", "from above"};  // drivers::Approach
  axis.approach = static_cast<drivers::Approach>(table.choice_or("approach", 0, kApproaches));
  const NumberRange more_than_window{.least = axis.window, .unit = unit};
  if (axis.approach != drivers::Approach::Any) axis.overrun = table.number(key("backlash"), more_than_window);
  if (axis.low >= axis.high) {
    table.fail(key("low"), ErrorCode::InvalidInput, fmt::format("value {} {}", axis.low, unit),
               fmt::format("below {} = {} {}", key("high"), axis.high, unit));
  }
  return axis;
}

// Drives are started one after the other: what they walk together is not a line.
void read_coordination(TomlReader& table, drivers::StageConfig& stage) {
  stage.coordinated = table.flag_or("coordinated", false);
  if (!stage.coordinated || !stage.drives) return;
  table.fail("coordinated", ErrorCode::InvalidInput, "value true",
             "false for a stage of drives: each is started alone");
}

drivers::StageConfig read_stage_config(TomlReader& table) {
  drivers::StageConfig stage;
  stage.reply_timeout = time(table, "reply_timeout_s");
  stage.homing_time = time(table, "homing_time_s");
  stage.shutter_time = time(table, "shutter_time_s");
  stage.heartbeat_timeout = time(table, "heartbeat_timeout_s", {.least = 0.1, .most = 60.0, .unit = "s"});
  stage.deadline_factor = table.number_or("deadline_factor", 1.5, {.least = 1.0, .most = 100.0});
  stage.deadline_margin = seconds(table.number_or("deadline_margin_s", 1.0, kTime));
  TomlReader axes = table.table("axes");
  for (const stage::Axis axis : stage::kAllAxes) {
    TomlReader one = axes.table(stage::axis_name(axis));
    stage.axes[stage::index_of(axis)] = read_axis(one, stage::axis_unit(axis));
  }
  read_kinematics(table, stage);
  read_stage_kind(table, stage);
  read_coordination(table, stage);
  read_keep_out(table, stage);
  return stage;
}

drivers::SerialLine read_serial_line(TomlReader& table) {
  constexpr std::array<std::string_view, 3> kParities{"none", "even", "odd"};  // in the order of drivers::Parity
  drivers::SerialLine line;
  line.device = table.text("address");
  line.baud = static_cast<int>(table.integer("baud", 1, 1'000'000));
  if (std::find(std::begin(drivers::kBaudRates), std::end(drivers::kBaudRates), line.baud) ==
      std::end(drivers::kBaudRates)) {
    table.fail("baud", ErrorCode::InvalidInput, fmt::format("value {}", line.baud),
               fmt::format("one of {}", fmt::join(drivers::kBaudRates, ", ")));
  }
  line.parity = static_cast<drivers::Parity>(table.choice("parity", kParities));
  line.stop_bits = static_cast<int>(table.integer("stop_bits", 1, 2));
  return line;
}

StageAddress read_stage_address(TomlReader& table) {
  constexpr std::array<std::string_view, 2> kLinks{"tcp", "rtu"};
  StageAddress address;
  if (kLinks[table.choice("link", kLinks)] == "rtu") {
    address.serial = read_serial_line(table);
    return address;
  }
  address.host = table.text("address");
  address.port = static_cast<std::uint16_t>(table.integer("port", 1, 65535));
  return address;
}

Length carriage_position(TomlReader& table, std::string_view key, const drivers::StageConfig& stage) {
  const drivers::AxisConfig& axis = stage.axis(stage::Axis::Carriage);
  return length(table, key, {.least = axis.low, .most = axis.high, .unit = "mm"});
}

CarriagePositions read_carriage(TomlReader table, const drivers::StageConfig& stage) {
  CarriagePositions carriage{.sample = carriage_position(table, "sample_mm", stage),
                             .reference = carriage_position(table, "reference_mm", stage),
                             .trap = carriage_position(table, "trap_mm", stage)};
  if (table.kind("open_mm") != TomlKind::Absent) carriage.open = carriage_position(table, "open_mm", stage);
  return carriage;
}

Filter read_filter(TomlReader& table, const drivers::AxisConfig& wheel) {
  constexpr std::array<std::string_view, 2> kSides{"detector", "source"};
  const auto least = static_cast<std::int64_t>(std::ceil(wheel.low));
  const auto most = static_cast<std::int64_t>(std::floor(wheel.high));
  Filter filter;
  filter.slot = static_cast<int>(table.integer("slot", least, most));
  filter.centroid = nanometres(table.number("centroid_nm", {.least = 100.0, .most = 20000.0, .unit = "nm"}));
  filter.fwhm = nanometres(table.number("fwhm_nm", {.least = 0.01, .most = 1000.0, .unit = "nm"}));
  filter.out_of_band_fraction = table.number("out_of_band_fraction", kFraction);
  filter.side = static_cast<FilterSide>(table.choice("side", kSides));
  filter.attenuation = read_attenuation(table);
  return filter;
}

std::vector<Filter> read_filters(TomlReader& stage_table, const drivers::StageConfig& stage) {
  std::vector<Filter> filters;
  std::set<int> slots;
  for (TomlReader& table : stage_table.tables("filters")) {
    filters.push_back(read_filter(table, stage.axis(stage::Axis::FilterWheel)));
    if (slots.insert(filters.back().slot).second) continue;
    table.fail("slot", ErrorCode::InvalidInput, fmt::format("slot {} stands here twice", filters.back().slot),
               "one filter a slot");
  }
  if (filters.empty()) {
    stage_table.fail("filters", ErrorCode::MissingKey, "there is no filter", "at least one [[stage.filters]]");
  }
  return filters;
}

Shadow read_shadow(TomlReader table) {
  return {.detector_head_radius = length(table, "detector_head_radius_mm"),
          .source_head_radius = length(table, "source_head_radius_mm"),
          .detector_arm = length(table, "detector_arm_mm"),
          .source_arm = length(table, "source_arm_mm")};
}

calibration::DetectorModel read_detector_model(TomlReader table) {
  calibration::DetectorModel model;
  model.electrons_per_dn = table.number("electrons_per_dn", {.least = 1e-6, .most = 1e9});
  model.read_noise_dn = table.number("read_noise_dn", kNotNegative);
  model.full_scale_dn = table.number("full_scale_dn", {.least = 1.0, .most = 65535.0, .unit = "DN"});
  model.exposure_offset_s = {.value = table.number("exposure_offset_s", {.least = -1.0, .most = 1.0, .unit = "s"}),
                             .u = table.number("u_exposure_offset_s", {.least = 0.0, .most = 1.0, .unit = "s"})};
  model.u_linearity = table.number("u_linearity", kFraction);
  model.u_dark_drift_dn_per_s = table.number("u_dark_drift_dn_per_s", kNotNegative);
  constexpr std::array<std::string_view, 2> kNoise{"photon-transfer", "repeated-frames"};  // as NoiseSource
  model.noise = static_cast<calibration::NoiseSource>(table.choice_or("noise", 0, kNoise));
  return model;
}

void read_detector_section(TomlReader table, Instrument& instrument) {
  constexpr std::array<std::string_view, 2> kKinds{"genicam", "usbtmc"};
  if (kKinds[table.choice("kind", kKinds)] == "usbtmc") return read_power_detector(table, instrument);
  instrument.detector = read_detector(table);
  instrument.model.detector = read_detector_model(table.table("model"));
}

calibration::AngleModel read_angles(TomlReader& table) {
  return {.u_zero_theta_i = angle(table, "u_zero_theta_i_deg", kAngleUncertainty),
          .u_zero_theta_r = angle(table, "u_zero_theta_r_deg", kAngleUncertainty),
          .u_zero_phi_r = angle(table, "u_zero_phi_r_deg", kAngleUncertainty),
          .u_repeat = angle(table, "u_repeat_deg", kAngleUncertainty)};
}

ConeAngles read_cones(TomlReader& table) {
  constexpr NumberRange kHalfCone{.least = 0.0, .most = 30.0, .unit = "deg"};
  return {.detector_half = angle(table, "detector_half_cone_deg", kHalfCone),
          .source_half = angle(table, "source_half_cone_deg", kHalfCone)};
}

calibration::LampModel read_lamp_model(TomlReader& table) {
  calibration::LampModel model;
  model.u_after_monitor = table.number("u_after_monitor", kFraction);
  model.correlation_s = table.number("correlation_s", {.least = 1e-3, .most = 1e7, .unit = "s"});
  model.u_reproducibility = table.number("u_reproducibility", kFraction);
  return model;
}

LampBand read_lamp_band(TomlReader& table) {
  LampBand band;
  band.low = table.number("monitor_low", kNotNegative);
  band.high = table.number("monitor_high", {.least = band.low});
  band.least_scatter = table.number_or("monitor_least_scatter", 0.0, kFraction);
  band.before_shutter = table.flag_or("monitor_before_shutter", false);
  band.warm_up = read_warm_up(table);
  return band;
}

void read_stage(TomlReader table, Instrument& instrument) {
  instrument.stage_address = read_stage_address(table);
  instrument.stage = read_stage_config(table);
  instrument.carriage = read_carriage(table.table("carriage"), instrument.stage);
  instrument.filters = read_filters(table, instrument.stage);
  instrument.shadow = read_shadow(table.table("shadow"));
}

const Filter* nearest_filter(const Instrument& instrument, Wavelength wavelength, bool is_attenuated) {
  const Filter* nearest = nullptr;
  double least = 0.0;
  for (const Filter& filter : instrument.filters) {
    const double off = std::abs((filter.centroid - wavelength).si());
    if (filter.attenuation.has_value() != is_attenuated || off > 0.5 * filter.fwhm.si()) continue;
    if (nearest != nullptr && off >= least) continue;
    nearest = &filter;
    least = off;
  }
  return nearest;
}

}  // namespace

Result<Instrument> parse_instrument(std::string_view text, const std::string& file) {
  Result<TomlReader> root = TomlReader::parse(text, file);
  if (!root) return failure(std::move(root).error());
  Instrument instrument;
  instrument.text = text;
  TomlReader about = root->table("instrument");
  instrument.name = about.text("name");
  const std::filesystem::path directory = about.text_or("reference_directory", "reference");
  instrument.reference_directory = (std::filesystem::path(file).parent_path() / directory).string();
  read_stage(root->table("stage"), instrument);
  read_detector_section(root->table("detector"), instrument);
  read_monitor(*root, instrument);
  TomlReader angles = root->table("angles");
  instrument.model.angles = read_angles(angles);
  instrument.cones = read_cones(angles);
  TomlReader lamp = root->table("lamp");
  instrument.model.lamp = read_lamp_model(lamp);
  instrument.lamp = read_lamp_band(lamp);
  read_beams(*root, instrument.model);
  read_absolute(*root, instrument.model);
  instrument.holds = read_holds(*root);
  GONIO_TRY(root->finish());
  instrument.sha256 = configuration_hash(*root, text);  // last: it asks for keys that this wire may not have
  return instrument;
}

Result<Instrument> read_instrument(const std::string& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return failure(text.error());
  Result<Instrument> instrument = parse_instrument(*text, path);
  if (!instrument || !instrument->detector.map_files.any()) return instrument;
  auto maps = load_detector_maps(instrument->detector, std::filesystem::path(path).parent_path().string());
  if (!maps) return failure(std::move(maps).error());
  instrument->maps = std::move(*maps);
  instrument->sha256 = sha256_hex(instrument->sha256 + instrument->maps->version);
  return instrument;
}

const Filter* filter_for(const Instrument& instrument, Wavelength wavelength) {
  return nearest_filter(instrument, wavelength, false);
}

const Filter* attenuated_filter_for(const Instrument& instrument, Wavelength wavelength) {
  return nearest_filter(instrument, wavelength, true);
}

}  // namespace gonio::daemon
