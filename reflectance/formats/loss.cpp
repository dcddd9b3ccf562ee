#include "reflectance/formats/loss.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gonio::formats {
namespace {

// In the order of LossKind.
constexpr std::array<std::string_view, 13> kLossNames{
    "uncertainty", "shared-part", "sign",         "flags",     "polarisation",   "wavelength", "channels",
    "anisotropy",  "resampled",   "extrapolated", "precision", "points-dropped", "metadata"};

}  // namespace

std::string_view loss_name(LossKind kind) {
  return kLossNames.at(static_cast<std::size_t>(kind));
}

bool has_loss(const Losses& losses, LossKind kind) {
  return std::ranges::any_of(losses, [kind](const Loss& loss) { return loss.kind == kind; });
}

void add_loss(Losses& losses, LossKind kind, std::size_t values, std::string what) {
  if (values > 0) losses.push_back({.kind = kind, .values = values, .what = std::move(what)});
}

}  // namespace gonio::formats
