#include "daemon/analysis/plots.h"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/analysis/budget_summary.h"
#include "daemon/analysis/drawn_surfaces.h"
#include "daemon/analysis/plot_directions.h"
#include "daemon/analysis/plot_scan.h"
#include "reflectance/formats/surface_file.h"
#include "reflectance/formats/writer_losses.h"

namespace gonio::analysis {
namespace {

constexpr std::size_t kMostChannels = 4;

std::vector<std::uint32_t> shown_channels(const formats::MeasuredBrdf& brdf, std::vector<std::string>& notes) {
  const std::size_t count = brdf.channels.size();
  std::vector<std::uint32_t> shown;
  const std::size_t n = std::min(count, kMostChannels);
  for (std::size_t k = 0; k < n; ++k) {
    shown.push_back(static_cast<std::uint32_t>(n == 1 ? 0 : k * (count - 1) / (n - 1)));
  }
  if (count > n) notes.push_back(fmt::format("{} of {} channels are drawn", n, count));
  return shown;
}

std::string title_of(const formats::MeasuredBrdf& brdf, const formats::Channel& channel) {
  const std::string sample = brdf.metadata.sample.empty() ? "sample" : brdf.metadata.sample;
  if (channel.wavelength_nm > 0.0) return fmt::format("{}, {:.6g} nm", sample, channel.wavelength_nm);
  return channel.name.empty() ? sample : sample + ", " + channel.name;
}

const reflectance::Surface* surface_of(const Result<formats::SurfaceFile>& surfaces, const formats::Channel& channel) {
  if (!surfaces) return nullptr;
  const auto at = std::ranges::find(surfaces->channels, channel, &formats::ChannelSurface::channel);
  return at == surfaces->channels.end() ? nullptr : &at->surface;
}

}  // namespace

std::vector<Picture> pictures_of(const formats::MeasuredBrdf& brdf, const std::string& stem,
                                 std::vector<std::string>& notes) {
  const Result<formats::SurfaceFile> surfaces = drawn_surfaces(brdf);
  if (!surfaces) notes.push_back("no surface between the readings: " + describe(surfaces.error()));
  std::vector<Picture> pictures;
  for (const std::uint32_t channel : shown_channels(brdf, notes)) {
    ChannelView view{.stem = stem,
                     .tail = formats::channel_suffix(brdf, channel),
                     .title = title_of(brdf, brdf.channels[channel]),
                     .points = {},
                     .surface = surface_of(surfaces, brdf.channels[channel])};
    for (const formats::BrdfPoint& point : brdf.points) {
      if (point.channel == channel) view.points.push_back(formats::in_plain_ranges(point));
    }
    if (view.points.empty()) continue;
    if (view.surface != nullptr) {
      pictures.push_back(lobe_picture(view));
      pictures.push_back(polar_picture(view));
    }
    pictures.push_back(cut_picture(view));
  }
  return pictures;
}

std::vector<Picture> pictures_of_scan(const StoredScan& scan, const daemon::ScanHistory& history,
                                      const std::string& stem) {
  std::vector<Picture> pictures;
  const std::vector<BudgetLine> budget = budget_summary(scan.brdf);
  if (!budget.empty()) pictures.push_back(budget_picture(stem, budget));
  if (!history.readings.empty()) pictures.push_back(drift_picture(stem, history));
  return pictures;
}

}  // namespace gonio::analysis
