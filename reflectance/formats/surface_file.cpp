#include "reflectance/formats/surface_file.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "reflectance/formats/writer_losses.h"
#include "reflectance/table/table_of_readings.h"

namespace gonio::formats {

using reflectance::Direction;
using reflectance::Surface;
using reflectance::TableReading;
using reflectance::TableSymmetry;
using reflectance::TabulatedSurface;

namespace {

std::vector<TableReading> readings_of(const MeasuredBrdf& brdf, std::size_t channel) {
  std::vector<TableReading> readings;
  for (const BrdfPoint& point : brdf.points) {
    if (point.channel != channel) continue;
    readings.push_back({.geometry = geometry_of(in_plain_ranges(point)),
                        .f = {per_steradian(point.f_per_sr), per_steradian(standard_u_per_sr(point))}});
  }
  return readings;
}

}  // namespace

Result<SurfaceFile> surfaces_of(const MeasuredBrdf& brdf, reflectance::TableOptions options) {
  GONIO_TRY(check(brdf, brdf.metadata.sample));
  SurfaceFile file{.metadata = brdf.metadata, .channels = {}, .losses = losses_of_bare_values(brdf)};
  options.symmetry = symmetry_of(brdf);
  for (std::size_t n = 0; n < brdf.channels.size(); ++n) {
    const std::vector<TableReading> readings = readings_of(brdf, n);
    if (readings.empty()) continue;
    Result<TabulatedSurface> table = reflectance::table_of_readings(readings, options);
    if (!table) {
      Error error = std::move(table).error();
      error.tried = fmt::format("make a surface of channel {}: {}", brdf.channels[n].name, error.tried);
      return failure(std::move(error));
    }
    file.channels.push_back({.channel = brdf.channels[n], .surface = Surface(*std::move(table))});
  }
  return file;
}

GridReader::GridReader(const ChannelSurface& channel)
    : surface_(channel.surface), is_table_(surface_.as<TabulatedSurface>() != nullptr) {}

double GridReader::at(const Direction& i, const Direction& r) {
  ++read_;
  if (is_table_ && !surface_.as<TabulatedSurface>()->covers(i, r)) ++uncovered_;
  return in_per_steradian(surface_.eval(i, r));
}

double GridReader::at_least_zero(const Direction& i, const Direction& r) {
  const double f = at(i, r);
  if (f >= 0.0) return f;
  ++negative_;
  return 0.0;
}

void GridReader::add_losses(Losses& losses) const {
  if (is_table_) add_loss(losses, LossKind::Resampled, read_, "values are read at the format's directions");
  add_loss(losses, LossKind::Extrapolated, uncovered_, "of these, not measured: continued from within reach");
  add_loss(losses, LossKind::Sign, negative_, "the format allows no negative value: 0 stands there");
}

void add_anisotropy_loss(Losses& losses, const Surface& surface) {
  const auto* table = surface.as<TabulatedSurface>();
  const bool turns =
      table != nullptr ? table->options().symmetry != TableSymmetry::Anisotropic : surface.is_isotropic();
  if (!turns) add_loss(losses, LossKind::Anisotropy, 1, "the format knows one azimuth of incidence: phi_i = 0");
}

Result<void> check(const SurfaceFile& file, std::string_view format) {
  if (!file.channels.empty()) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("write {}", format),
                  .seen = "no channel",
                  .limit = "at least one"});
}

std::string channel_suffix(const SurfaceFile& file, std::size_t channel) {
  MeasuredBrdf named;
  for (const ChannelSurface& one : file.channels) named.channels.push_back(one.channel);
  return channel_suffix(named, channel);
}

}  // namespace gonio::formats
