#include "reflectance/formats/writer_losses.h"

#include <algorithm>

namespace gonio::formats {
namespace {

template <class Has>
std::size_t points_with(const MeasuredBrdf& brdf, Has has) {
  return static_cast<std::size_t>(std::ranges::count_if(brdf.points, has));
}

bool is_of_a_file_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_';
}

}  // namespace

Losses losses_of_bare_values(const MeasuredBrdf& brdf) {
  Losses losses;
  add_loss(losses, LossKind::Uncertainty, points_with(brdf, [](const BrdfPoint& p) { return p.U_per_sr > 0.0; }),
           "the format has no uncertainties");
  add_loss(losses, LossKind::SharedPart, points_with(brdf, [](const BrdfPoint& p) { return p.u_shared_per_sr > 0.0; }),
           "nor what of them all points share");
  add_loss(losses, LossKind::Flags, points_with(brdf, [](const BrdfPoint& p) { return p.flags != 0; }),
           "the format has no flags");
  add_loss(losses, LossKind::Polarisation,
           points_with(brdf,
                       [&](const BrdfPoint& p) {
                         const Channel& channel = brdf.channels[p.channel];
                         return channel.incident != Polarisation::Unknown || channel.reflected != Polarisation::Unknown;
                       }),
           "the format does not say how the light was polarised");
  return losses;
}

std::string channel_suffix(const MeasuredBrdf& brdf, std::size_t channel) {
  if (brdf.channels.size() == 1) return {};
  const std::string& name = brdf.channels[channel].name;
  const bool is_told_apart = std::ranges::count(brdf.channels, name, &Channel::name) == 1 && !name.empty();
  std::string suffix = "-" + (is_told_apart ? name : std::to_string(channel));
  std::ranges::replace_if(
      suffix, [](char c) { return !is_of_a_file_name(c); }, '-');
  return suffix;
}

}  // namespace gonio::formats
