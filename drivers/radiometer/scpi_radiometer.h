#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "drivers/links/usbtmc_link.h"
#include "drivers/links/usbtmc_session.h"
#include "drivers/radiometer.h"

namespace gonio::drivers {

struct ScpiRadiometerConfig {
  std::string role = "radiometer";  ///< named in errors: "detector" or "monitor" where it serves as one
  std::string serial;               ///< as *IDN? gives it
  RadiometerSettings settings;
  Duration sample_time = std::chrono::milliseconds(3);         ///< of the meter, for each of its averages
  Duration range_settle = std::chrono::milliseconds(200);      ///< after a change of range or wavelength, or a zero
  Duration zero_time = std::chrono::seconds(30);               ///< at most
  Duration reply_margin = std::chrono::milliseconds(500);      ///< beyond what a command takes by itself
  Duration transfer_timeout = std::chrono::milliseconds(500);  ///< of what a device does at once
};

/// A bench power meter with the usual SCPI commands over USBTMC (README.md lists them).
///
/// After each exchange the status byte is read and the error queue emptied: an entry makes the call fail. A reply that
/// nobody asked for makes it fail too, since then nobody knows which was whose.
class ScpiRadiometer final : public Radiometer {
 public:
  /// `link` and `clock` must outlive it.
  ScpiRadiometer(UsbtmcLink& link, ScpiRadiometerConfig config, const Clock& clock);

  Result<DetectorIdentity> ensure_open() override;
  Result<void> apply(const RadiometerSettings& settings) override;
  Result<void> start_zero() override;
  Result<bool> is_zeroed(Duration wait) override;
  Result<void> trigger() override;
  Result<std::optional<RadiometerReading>> collect(Duration wait) override;

 private:
  enum class Task { None, Zeroing, Reading };
  struct Running {
    double range_w = 0.0;
    std::vector<double> samples;
    Instant started{};
    int discarded = 0;
    int restarts = 0;
  };
  [[nodiscard]] Result<void> open();
  [[nodiscard]] Result<void> identify();
  [[nodiscard]] Result<void> write_settings(const RadiometerSettings& settings);
  [[nodiscard]] Result<void> write_range(const std::optional<double>& range_w);
  [[nodiscard]] Result<void> set_number(std::string_view header, double value, double tolerance, std::string_view unit);
  [[nodiscard]] Result<void> set_word(std::string_view header, std::string_view word, std::string_view query);
  [[nodiscard]] Result<void> command(std::string_view text);
  [[nodiscard]] Result<std::string> query(std::string_view text);
  [[nodiscard]] Result<double> query_number(std::string_view text);
  [[nodiscard]] Result<void> check_status(std::string_view after);
  [[nodiscard]] Result<void> fail_by_error_queue(std::string_view after);
  [[nodiscard]] Result<void> ask_sample();
  [[nodiscard]] Result<void> take_sample(std::string_view reply);
  [[nodiscard]] Result<std::optional<RadiometerReading>> finish();
  [[nodiscard]] Error error(ErrorCode code, std::string tried, std::string seen, std::string limit = {}) const;

  ScpiRadiometerConfig config_;
  const Clock& clock_;
  UsbtmcSession session_;
  DetectorIdentity identity_;
  bool is_ready_ = false;  ///< open, ours, configured
  RadiometerSettings settings_;
  Instant settled_at_{};
  Task task_ = Task::None;
  Running running_;
};

}  // namespace gonio::drivers
