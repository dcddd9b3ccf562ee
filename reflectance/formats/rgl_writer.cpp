#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/tensor_file.h"
#include "reflectance/formats/text_lines.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;
using reflectance::TabulatedSurface;
using reflectance::Vector;

constexpr double kPi = std::numbers::pi;

// What a mirror with this normal makes of i; z may be below 0.
Vector mirrored_about(const Vector& i, const Vector& normal) {
  const double twice = 2.0 * (i.x * normal.x + i.y * normal.y + i.z * normal.z);
  return {.x = twice * normal.x - i.x, .y = twice * normal.y - i.y, .z = twice * normal.z - i.z};
}

// f mu at each node, rows by phi_m, columns by theta_m.
std::vector<double> slice_of(GridReader& values, const Direction& i, std::size_t nodes) {
  constexpr double kMostFloat = 1e30;
  std::vector<double> slice;
  slice.reserve(nodes * nodes);
  const auto last = static_cast<double>(nodes - 1);
  for (std::size_t y = 0; y < nodes; ++y) {
    for (std::size_t x = 0; x < nodes; ++x) {
      const double u = static_cast<double>(x) / last;
      const double phi_m = (2.0 * static_cast<double>(y) / last - 1.0) * kPi;
      const Vector normal = Direction::from_angles(radians(0.5 * kPi * u * u), radians(phi_m)).vector();
      const Vector r = mirrored_about(i.vector(), normal);
      const double f_mu = r.z > 0.0 ? values.at_least_zero(i, Direction::from_vector(r)) * r.z : 0.0;
      slice.push_back(std::min(f_mu, kMostFloat));
    }
  }
  return slice;
}

Tensor vector_tensor(std::vector<double> values) {
  const std::size_t count = values.size();
  return {.shape = {count}, .values = std::move(values)};
}

Tensor even_tensor(std::vector<std::size_t> shape, double value) {
  std::size_t count = 1;
  for (const std::size_t length : shape) count *= length;
  return {.shape = std::move(shape), .values = std::vector<double>(count, value)};
}

std::vector<const ChannelSurface*> channels_to_write(const SurfaceFile& file, Losses& losses) {
  std::vector<const ChannelSurface*> chosen;
  for (const ChannelSurface& one : file.channels)
    if (one.channel.wavelength_nm > 0.0 || file.channels.size() == 1) chosen.push_back(&one);
  std::ranges::sort(chosen, {}, [](const ChannelSurface* one) { return one->channel.wavelength_nm; });
  add_loss(losses, LossKind::Channels, file.channels.size() - chosen.size(), "the format knows channels by wavelength");
  if (chosen.size() == 1 && chosen[0]->channel.wavelength_nm <= 0.0)
    add_loss(losses, LossKind::Wavelength, 1, "the channel has none: 550 nm stands there");
  return chosen;
}

// Steps, and the incidences of measured tables in place of those beside them.
std::vector<double> incidences_of(const std::vector<const ChannelSurface*>& channels, double step_deg) {
  constexpr double kLowestDeg = 88.0;
  std::vector<double> measured;
  for (const ChannelSurface* one : channels) {
    const auto* table = one->surface.as<TabulatedSurface>();
    if (table == nullptr) continue;
    for (const reflectance::TableRow& row : table->rows()) {
      if (row.theta_i() <= degrees(kLowestDeg)) measured.push_back(row.theta_i().si());
    }
  }
  std::vector<double> incidences = measured;
  for (double step = 0.0; step <= kLowestDeg; step += step_deg) {
    const double theta = degrees(step).si();
    const double half_step = 0.5 * degrees(step_deg).si();
    const bool is_beside = std::ranges::any_of(measured, [&](double m) { return std::abs(m - theta) < half_step; });
    if (!is_beside || step == 0.0) incidences.push_back(theta);
  }
  std::ranges::sort(incidences);
  constexpr double kOneIncidence = 1e-5;  // rad; an encoder's scatter, another channel's
  const auto again =
      std::unique(incidences.begin(), incidences.end(), [](double a, double b) { return b - a < kOneIncidence; });
  incidences.erase(again, incidences.end());
  return incidences;
}

Result<void> check_rgl(const RglOptions& options) {
  constexpr std::size_t kMostNodes = 512;
  const bool is_good = options.nodes >= 2 && options.nodes <= kMostNodes && options.incidence_step_deg >= 0.5 &&
                       options.incidence_step_deg <= 44.0;
  if (is_good) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "write an RGL file",
                  .seen = fmt::format("{} nodes, {} deg", options.nodes, options.incidence_step_deg),
                  .limit = fmt::format("2 to {} nodes, 0.5 to 44 deg", kMostNodes)});
}

// [incidence][channel][phi_m][theta_m], and their mean over channels.
struct Tables {
  std::vector<double> spectra;
  std::vector<double> luminance;
};

Tables tables_of(const std::vector<const ChannelSurface*>& channels, const std::vector<double>& incidences,
                 std::size_t nodes, Losses& losses) {
  std::vector<GridReader> values;
  for (const ChannelSurface* one : channels) values.emplace_back(*one);
  Tables tables;
  for (const double theta_i : incidences) {
    const Direction i = Direction::from_angles(radians(theta_i), Angle{});
    std::vector<double> mean(nodes * nodes, 0.0);
    for (GridReader& value : values) {
      const std::vector<double> slice = slice_of(value, i, nodes);
      tables.spectra.insert(tables.spectra.end(), slice.begin(), slice.end());
      for (std::size_t n = 0; n < slice.size(); ++n) mean[n] += slice[n] / static_cast<double>(values.size());
    }
    tables.luminance.insert(tables.luminance.end(), mean.begin(), mean.end());
  }
  for (const GridReader& value : values) value.add_losses(losses);
  return tables;
}

}  // namespace

Result<Export> write_rgl(const SurfaceFile& file, const RglOptions& options) {
  constexpr double kNominal = 550.0;
  GONIO_TRY(check(file, "an RGL file"));
  GONIO_TRY(check_rgl(options));
  Export written{.files = {}, .losses = file.losses};
  const std::vector<const ChannelSurface*> channels = channels_to_write(file, written.losses);
  if (channels.empty())
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "write an RGL file",
                    .seen = "no channel with a wavelength",
                    .limit = "at least one"});
  for (const ChannelSurface* one : channels) add_anisotropy_loss(written.losses, one->surface);
  const std::vector<double> incidences = incidences_of(channels, options.incidence_step_deg);
  Tables tables = tables_of(channels, incidences, options.nodes, written.losses);
  add_loss(written.losses, LossKind::Precision, tables.spectra.size(), "values are floats of f_r mu_r, 7 digits");

  const std::size_t n = options.nodes;
  const std::size_t t = incidences.size();
  std::vector<double> wavelengths;
  for (const ChannelSurface* one : channels)
    wavelengths.push_back(one->channel.wavelength_nm > 0.0 ? one->channel.wavelength_nm : kNominal);
  const std::string text = one_line(file.metadata.sample.empty() ? "BRDF" : file.metadata.sample);
  const std::size_t w = wavelengths.size();
  const std::string bytes = write_tensors({{"description", true, vector_tensor({text.begin(), text.end()})},
                                           {"phi_i", false, vector_tensor({0.0})},
                                           {"theta_i", false, vector_tensor(incidences)},
                                           {"ndf", false, even_tensor({2, 2}, 4.0)},
                                           {"sigma", false, even_tensor({2, 2}, 1.0)},
                                           {"vndf", false, even_tensor({1, t, 2, 2}, 1.0)},
                                           {"luminance", false, {{1, t, n, n}, std::move(tables.luminance)}},
                                           {"wavelengths", false, vector_tensor(std::move(wavelengths))},
                                           {"spectra", false, {{1, t, w, n, n}, std::move(tables.spectra)}},
                                           {"jacobian", true, vector_tensor({1.0})}});
  written.files.push_back({.suffix = ".bsdf", .bytes = bytes});
  return written;
}

}  // namespace gonio::formats
