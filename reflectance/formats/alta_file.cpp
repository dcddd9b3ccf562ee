#include "reflectance/formats/alta_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "reflectance/convention/rusinkiewicz_angles.h"
#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::DirectionPair;

// pi/2 as others round it is not below the horizon.
Result<Direction> direction_at(double theta, double phi) {
  constexpr double kRounding = 1e-9;
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  if (theta > kQuarter && theta < kQuarter + kRounding) theta = kQuarter;
  // A theta below 0 is the other side of the normal.
  if (theta < 0.0) return Direction::make(radians(-theta), radians(phi + std::numbers::pi));
  return Direction::make(radians(theta), radians(phi));
}

Result<DirectionPair> pair_of(const Result<Direction>& i, const Result<Direction>& r) {
  if (!i) return failure(i.error());
  if (!r) return failure(r.error());
  return DirectionPair{.i = *i, .r = *r};
}

using Row = std::span<const double>;

Result<DirectionPair> from_spherical(Row x) {
  return pair_of(direction_at(x[0], x[1]), direction_at(x[2], x[3]));
}
Result<DirectionPair> from_view_light_turn(Row x) {
  return pair_of(direction_at(x[1], 0.0), direction_at(x[0], x[2]));
}
Result<DirectionPair> from_projected_view(Row x) {
  return pair_of(direction_at(x[0], 0.0), direction_at(std::hypot(x[1], x[2]), std::atan2(x[2], x[1])));
}
Result<DirectionPair> from_half_isotropic(Row x) {
  return reflectance::from_rusinkiewicz(
      {.theta_h = radians(x[0]), .phi_h = {}, .theta_d = radians(x[1]), .phi_d = radians(x[2])});
}
Result<DirectionPair> from_half(Row x) {
  return reflectance::from_rusinkiewicz(
      {.theta_h = radians(x[0]), .phi_h = radians(x[1]), .theta_d = radians(x[2]), .phi_d = radians(x[3])});
}
// The view comes first.
Result<DirectionPair> from_cartesian(Row x) {
  return pair_of(Direction::make_from_vector({.x = x[3], .y = x[4], .z = x[5]}),
                 Direction::make_from_vector({.x = x[0], .y = x[1], .z = x[2]}));
}

struct AltaInput {
  std::string_view name;
  std::size_t columns;
  bool is_isotropic;  ///< left and right of the plane of incidence stay apart all the same
  Result<DirectionPair> (*pair)(Row);
};
constexpr std::array kAltaInputs{AltaInput{"SPHERICAL_TL_PL_TV_PV", 4, false, from_spherical},
                                 AltaInput{"ISOTROPIC_TV_TL_DPHI", 3, true, from_view_light_turn},
                                 AltaInput{"ISOTROPIC_TL_TV_PROJ_DPHI", 3, true, from_projected_view},
                                 AltaInput{"RUSIN_TH_TD_PD", 3, true, from_half_isotropic},
                                 AltaInput{"RUSIN_TH_PH_TD_PD", 4, false, from_half},
                                 AltaInput{"CARTESIAN", 6, false, from_cartesian}};
constexpr std::array<std::string_view, 3> kAltaOutputs{"INV_STERADIAN", "INV_STERADIAN_COSINE_FACTOR", "RGB_COLOR"};

// What says how rows are read.
constexpr std::array<std::string_view, 5> kRowKeys{"PARAM_IN", "PARAM_OUT", "DIM", "VS", "FORMAT"};

class AltaReader {
 public:
  AltaReader(std::string_view text, const std::string& file) : lines_(text, "ALTA text", file) {}

  Result<MeasuredBrdf> read() {
    while (const std::optional<std::string_view> line = lines_.next_filled("")) {
      if (line->starts_with('#')) {
        GONIO_TRY(read_header_line(line->substr(1)));
      } else {
        GONIO_TRY(read_row(*line));
      }
    }
    GONIO_TRY(lines_.check_end());
    if (input_ == nullptr) return failure(lines_.error("PARAM_IN", "the line is absent", "required"));
    if (dropped_ > 0)
      brdf_.metadata.remarks.emplace_back(
          "left out", fmt::format("{} rows within 1 deg of the horizon, where cos(theta_r) has no digits", dropped_));
    if (input_->is_isotropic) brdf_.metadata.symmetry = reflectance::TableSymmetry::Turn;
    GONIO_TRY(check(brdf_, lines_.file()));
    return std::move(brdf_);
  }

 private:
  Result<void> read_header_line(std::string_view line) {
    const auto [key, rest] = key_and_rest(line);
    if (!brdf_.channels.empty() && std::ranges::count(kRowKeys, key) > 0)
      return failure(lines_.error(std::string(key), "the line stands after a row", "it stands before the first"));
    if (key == "PARAM_IN") return read_input(rest);
    if (key == "PARAM_OUT") return read_output(rest);
    if (key == "DIM") return read_dimensions(rest);
    if (key == "VS") return read_segments(rest);
    if (key == "FORMAT") return read_kind(rest);
    if (key == "SAMPLE") {
      brdf_.metadata.sample = rest.size() >= 2 && rest.starts_with('"') ? rest.substr(1, rest.size() - 2) : rest;
    } else if (!key.empty() && !rest.empty() && key != "ALTA") {
      brdf_.metadata.remarks.emplace_back(key, rest);
    }
    return {};
  }

  Result<void> read_input(std::string_view name) {
    const auto found = std::ranges::find(kAltaInputs, name, &AltaInput::name);
    if (found != kAltaInputs.end()) {
      input_ = &*found;
      return {};
    }
    std::string known;
    for (const AltaInput& input : kAltaInputs) known.append(known.empty() ? "" : ", ").append(input.name);
    return failure(lines_.error("PARAM_IN", fmt::format("'{}'", name.substr(0, 40)), known));
  }

  // The library writes numbers in binary, too.
  Result<void> read_kind(std::string_view kind) {
    if (kind == "text" || kind == "TEXT") return {};
    return failure(lines_.error("FORMAT", fmt::format("'{}'", one_line(kind.substr(0, 40))), "text"));
  }

  Result<void> read_output(std::string_view name) {
    if (std::ranges::count(kAltaOutputs, name) == 0)
      return failure(lines_.error("PARAM_OUT", fmt::format("'{}'", name.substr(0, 40)),
                                  fmt::format("{}", fmt::join(kAltaOutputs, ", "))));
    has_cosine_ = name == "INV_STERADIAN_COSINE_FACTOR";
    is_colour_ = name == "RGB_COLOR";
    return {};
  }

  Result<void> read_dimensions(std::string_view rest) {
    constexpr std::size_t kMostColumns = 64;
    const std::vector<std::string_view> parts = words(rest);
    if (parts.size() != 2) return failure(lines_.error("DIM", fmt::format("{} numbers", parts.size()), "2"));
    const Result<std::size_t> inputs = lines_.whole(parts[0], "DIM", 1, kMostColumns);
    if (!inputs) return failure(inputs.error());
    const Result<std::size_t> outputs = lines_.whole(parts[1], "DIM", 1, kMostColumns);
    if (!outputs) return failure(outputs.error());
    inputs_ = *inputs;
    outputs_ = *outputs;
    return {};
  }

  // One number for each output; those that are not there are 0.
  Result<void> read_segments(std::string_view rest) {
    segments_.clear();
    for (const std::string_view part : words(rest)) {
      const Result<std::size_t> kind = lines_.whole(part, "VS", 0, 2);
      if (!kind) return failure(kind.error());
      segments_.push_back(*kind);
    }
    return {};
  }

  // Before the first row: what the header said must make sense together.
  Result<void> begin_rows() {
    if (input_ == nullptr) return failure(lines_.error("PARAM_IN", "the line is absent", "required"));
    if (inputs_ != input_->columns)
      return failure(lines_.error("DIM", fmt::format("{} inputs", inputs_),
                                  fmt::format("{} of {}", input_->columns, input_->name)));
    if (segments_.size() > outputs_)
      return failure(lines_.error("VS", fmt::format("{} numbers", segments_.size()), fmt::format("{}", outputs_)));
    segments_.resize(outputs_);
    columns_ = inputs_ + outputs_;
    for (const std::size_t kind : segments_) columns_ += kind;
    constexpr std::array<const char*, 3> kColours{"R", "G", "B"};
    for (std::size_t n = 0; n < outputs_; ++n)
      brdf_.channels.push_back({.name = is_colour_ && outputs_ == kColours.size() ? kColours[n] : ""});
    return {};
  }

  Result<void> read_row(std::string_view line) {
    if (brdf_.channels.empty()) GONIO_TRY(begin_rows());
    const Result<std::vector<double>> row = lines_.numbers(line, "row", columns_);
    if (!row) return failure(row.error());
    const Result<DirectionPair> d = input_->pair(*row);
    if (!d) return failure(lines_.error(std::string(input_->name), describe(d.error())));
    double scale = 1.0;
    if (has_cosine_) {
      constexpr double kLeastCosine = 0.0174524064372835;  // of 89 deg
      if (d->r.mu() < kLeastCosine) {
        ++dropped_;
        return {};
      }
      scale = 1.0 / d->r.mu();
    }
    add_points(*d, *row, scale);
    return {};
  }

  void add_points(const DirectionPair& d, const std::vector<double>& row, double scale) {
    BrdfPoint point{.theta_i_deg = in_degrees(d.i.theta()),
                    .phi_i_deg = plain_azimuth_deg(in_degrees(d.i.phi())),
                    .theta_r_deg = in_degrees(d.r.theta()),
                    .phi_r_deg = plain_azimuth_deg(in_degrees(d.r.phi()))};
    if (input_->is_isotropic) {
      point.phi_r_deg = plain_azimuth_deg(in_degrees(reflectance::azimuth_difference(d.i, d.r)));
      point.phi_i_deg = 0.0;
    }
    std::size_t segment = inputs_ + outputs_;
    for (std::size_t n = 0; n < outputs_; ++n) {
      point.channel = static_cast<std::uint32_t>(n);
      point.f_per_sr = row[inputs_ + n] * scale;
      point.U_per_sr = 0.0;
      if (segments_[n] == 1) point.U_per_sr = std::abs(row[segment]) * scale;
      if (segments_[n] == 2) point.U_per_sr = 0.5 * std::abs(row[segment + 1] - row[segment]) * scale;
      segment += segments_[n];
      brdf_.points.push_back(point);
    }
  }

  TextLines lines_;
  const AltaInput* input_ = nullptr;
  bool has_cosine_ = false;
  bool is_colour_ = false;
  std::size_t inputs_ = 0;
  std::size_t outputs_ = 1;
  std::vector<std::size_t> segments_;
  std::size_t columns_ = 0;
  std::size_t dropped_ = 0;
  MeasuredBrdf brdf_;
};

}  // namespace

Result<MeasuredBrdf> read_alta(std::string_view text, const std::string& file) {
  return AltaReader(text, file).read();
}

}  // namespace gonio::formats
