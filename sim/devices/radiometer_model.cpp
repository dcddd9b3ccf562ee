#include "sim/devices/radiometer_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/scene/chance.h"

namespace gonio::sim {
namespace {

constexpr double kOverRange = 1.1;      // of full scale, up to which a range shows values
constexpr double kStepDown = 0.08;      // of full scale, below which the next smaller range is better
constexpr double kMostZeroLight = 0.1;  // of the range's full scale
constexpr int kMostAverages = 10000;
constexpr Wavelength kAtPowerUp = nanometres(633.0);

}  // namespace

RadiometerModel::RadiometerModel(Instrument& instrument, RadiometerSpec spec)
    : instrument_(instrument), collector_(instrument.add_collector()), spec_(std::move(spec)) {
  assert(spec_.responsivity.size() >= 2 && !spec_.ranges.empty());
  power_up();
}

void RadiometerModel::power_up() {
  abort();
  wavelength_ = std::clamp(kAtPowerUp, spec_.responsivity.front().wavelength, spec_.responsivity.back().wavelength);
  range_ = spec_.ranges.size() - 1;
  is_auto_ = true;
  averages_ = 1;
  zero_w_.assign(spec_.ranges.size(), 0.0);
  range_changed_.reset();
}

bool RadiometerModel::set_wavelength(Wavelength wavelength) {
  const bool is_known =
      wavelength >= spec_.responsivity.front().wavelength && wavelength <= spec_.responsivity.back().wavelength;
  if (is_known) wavelength_ = wavelength;
  return is_known;
}

bool RadiometerModel::set_range(double power_w, Instant now) {
  if (!(power_w <= spec_.ranges.back().full_scale_w)) return false;
  is_auto_ = false;
  change_range(range_for(power_w), now);
  return true;
}

bool RadiometerModel::set_averages(int averages) {
  const bool is_sound = averages >= 1 && averages <= kMostAverages;
  if (is_sound) averages_ = averages;
  return is_sound;
}

std::size_t RadiometerModel::range_for(double power_w) const {
  const auto fits = [&](const RadiometerRange& range) { return range.full_scale_w >= power_w; };
  const auto found = std::ranges::find_if(spec_.ranges, fits);
  return found == spec_.ranges.end() ? spec_.ranges.size() - 1 : static_cast<std::size_t>(found - spec_.ranges.begin());
}

void RadiometerModel::change_range(std::size_t range, Instant now) {
  if (range == range_) return;
  range_ = range;
  range_changed_ = now;
}

double RadiometerModel::responsivity(Wavelength wavelength) const {
  const auto& table = spec_.responsivity;
  const auto above = std::ranges::find_if(table, [&](const Responsivity& r) { return r.wavelength >= wavelength; });
  if (above == table.begin()) return table.front().a_per_w;
  if (above == table.end()) return table.back().a_per_w;
  const Responsivity& below = *std::prev(above);
  const double part = (wavelength - below.wavelength) / (above->wavelength - below.wavelength);
  return below.a_per_w + part * (above->a_per_w - below.a_per_w);
}

// The diode's current for the light that there is, as power at the wavelength that was set.
double RadiometerModel::shown_w(const LightCollection& collection) const {
  const bool is_monitor = spec_.place == RadiometerPlace::Monitor;
  const double power_w = spec_.watts * (is_monitor ? collection.lamp : collection.light);
  const Wavelength colour = is_monitor ? spec_.lamp_wavelength : collection.wavelength.value_or(wavelength_);
  return power_w * responsivity(colour) / responsivity(wavelength_);
}

double RadiometerModel::gain_of(std::size_t range) const {
  if (spec_.u_range == 0.0 || !instrument_.scene().draws_errors) return 1.0;
  constexpr std::size_t kMostRanges = 64;
  Chance chance(instrument_.scene().seed, Purpose::RadiometerRange, collector_ * kMostRanges + range);
  return 1.0 + spec_.u_range * chance.normal();
}

double RadiometerModel::noise_w(std::size_t range, double averages) {
  const RadiometerRange& r = spec_.ranges[range];
  ++samples_;
  if (r.noise == 0.0) return 0.0;
  constexpr unsigned kSampleBits = 48;  // what is left tells the meters of one instrument apart
  Chance chance(instrument_.scene().seed, Purpose::Radiometer, (collector_ << kSampleBits) + samples_);
  return r.noise * r.full_scale_w / std::sqrt(averages) * chance.normal();
}

double RadiometerModel::unsettled_w(Instant at) const {
  if (spec_.settle_s == 0.0 || !range_changed_) return 0.0;
  const double since_s = instrument_.scene().scene_seconds(at - *range_changed_);
  return spec_.settle_error * full_scale_w() * std::exp(-since_s / spec_.settle_s);
}

void RadiometerModel::start_sample(Instant now) {
  task_ = Task::Sample;
  instrument_.start_collection(collector_, instrument_.scene().wall(averages_ * spec_.average_s), now);
}

void RadiometerModel::start_zero(Instant now) {
  task_ = Task::Zero;
  instrument_.start_collection(collector_, instrument_.scene().wall(spec_.zero_s), now);
}

void RadiometerModel::abort() {
  task_ = Task::None;
  instrument_.drop_collection(collector_);
}

std::optional<RadiometerSample> RadiometerModel::take_sample(Instant now) {
  if (task_ != Task::Sample) return std::nullopt;
  const auto collection = instrument_.take_collection(collector_, now);
  if (!collection) return std::nullopt;
  const double light_w = shown_w(*collection);
  const bool is_over = light_w > kOverRange * full_scale_w();
  if (is_over && is_auto_ && range_ + 1 < spec_.ranges.size()) {
    change_range(range_for(light_w), collection->close);
    start_sample(now);
    return std::nullopt;
  }
  task_ = Task::None;
  if (is_over) return RadiometerSample{.is_overload = true};
  const RadiometerRange& range = spec_.ranges[range_];
  const double power_w = light_w * gain_of(range_) + range.offset * range.full_scale_w - zero_w_[range_] +
                         noise_w(range_, averages_) + unsettled_w(collection->open);
  if (is_auto_ && light_w < kStepDown * range.full_scale_w) change_range(range_for(light_w), collection->close);
  return RadiometerSample{.power_w = power_w};
}

std::optional<bool> RadiometerModel::take_zero(Instant now) {
  if (task_ != Task::Zero) return std::nullopt;
  const auto collection = instrument_.take_collection(collector_, now);
  if (!collection) return std::nullopt;
  task_ = Task::None;
  const double light_w = shown_w(*collection);
  if (light_w > kMostZeroLight * full_scale_w()) return false;
  const double averages = std::max(1.0, spec_.zero_s / spec_.average_s);
  for (std::size_t r = 0; r < spec_.ranges.size(); ++r) {
    zero_w_[r] = light_w + spec_.ranges[r].offset * spec_.ranges[r].full_scale_w + noise_w(r, averages);
  }
  return true;
}

std::optional<FaultKind> RadiometerModel::strike(FaultMoment moment, Instant now) {
  const auto fault = instrument_.strike(moment, now, [this](const PlannedFault& f) { return is_meant(f); });
  return fault ? std::optional(fault->kind) : std::nullopt;
}

bool RadiometerModel::is_unplugged(Instant now) const {
  const PlannedFault* fault = instrument_.faults().active(FaultKind::RadiometerUnplugged, now);
  return fault != nullptr && is_meant(*fault);
}

bool RadiometerModel::is_meant(const PlannedFault& fault) const {
  const FaultRole role = spec_.place == RadiometerPlace::Detector ? FaultRole::Detector : FaultRole::Monitor;
  return traits(fault.kind).device == FaultDevice::Radiometer && fault.role() == role;
}

}  // namespace gonio::sim
