#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/units.h"
#include "sim/devices/instrument.h"
#include "sim/scene/radiometer_spec.h"

namespace gonio::sim {

/// What one sample shows.
struct RadiometerSample {
  bool is_overload = false;
  double power_w = 0.0;  ///< meaningless in an overload
};

/// The radiometer without its wire: settings, one sample at a time, zero. It measures current and shows power for the
/// wavelength that it is set to. Threads: one at a time, as the instrument.
class RadiometerModel {
 public:
  /// `instrument` must outlive it. `spec` has at least two responsivities and a range.
  RadiometerModel(Instrument& instrument, RadiometerSpec spec);

  /// False: outside of the responsivity's wavelengths.
  bool set_wavelength(Wavelength wavelength);
  /// Takes the smallest range that holds `power_w`, and no other by itself from then on. False: there is none.
  bool set_range(double power_w, Instant now);
  void set_auto_range(bool on) { is_auto_ = on; }
  /// False: not 1 to 10000.
  bool set_averages(int averages);
  [[nodiscard]] Wavelength wavelength() const { return wavelength_; }
  [[nodiscard]] double full_scale_w() const { return spec_.ranges[range_].full_scale_w; }
  [[nodiscard]] bool is_auto_range() const { return is_auto_; }
  [[nodiscard]] int averages() const { return averages_; }
  [[nodiscard]] const RadiometerSpec& spec() const { return spec_; }

  /// Begins a sample of `averages` averages; what is under way is dropped.
  void start_sample(Instant now);
  /// Begins to take the light that is there as zero.
  void start_zero(Instant now);
  void abort();
  /// When what is under way ends.
  [[nodiscard]] std::optional<Instant> due() const { return instrument_.collection_end(collector_); }
  /// The finished sample, once. With a range of its own choice the model measures again when the light outgrew it.
  [[nodiscard]] std::optional<RadiometerSample> take_sample(Instant now);
  /// The finished zero, once: false when there was too much light, and the zero is as it was.
  [[nodiscard]] std::optional<bool> take_zero(Instant now);

  /// Whether a fault that is meant for this radiometer strikes at this moment.
  [[nodiscard]] std::optional<FaultKind> strike(FaultMoment moment, Instant now);
  /// Whether its cable is out, by a fault that stands.
  [[nodiscard]] bool is_unplugged(Instant now) const;

  /// As switched on: largest range, one average, no zero.
  void power_up();

 private:
  enum class Task : std::uint8_t { None, Sample, Zero };
  [[nodiscard]] double responsivity(Wavelength wavelength) const;
  [[nodiscard]] double shown_w(const LightCollection& collection) const;
  [[nodiscard]] double noise_w(std::size_t range, double averages);
  [[nodiscard]] double unsettled_w(Instant at) const;
  [[nodiscard]] std::size_t range_for(double power_w) const;
  void change_range(std::size_t range, Instant now);

  [[nodiscard]] double gain_of(std::size_t range) const;
  [[nodiscard]] bool is_meant(const PlannedFault& fault) const;

  Instrument& instrument_;
  std::size_t collector_;  ///< of the instrument
  RadiometerSpec spec_;
  Wavelength wavelength_;
  std::size_t range_ = 0;
  bool is_auto_ = true;
  int averages_ = 1;
  std::vector<double> zero_w_;  ///< [range]
  std::optional<Instant> range_changed_;
  Task task_ = Task::None;
  std::uint64_t samples_ = 0;  ///< over its life: the key of their noise
};

}  // namespace gonio::sim
