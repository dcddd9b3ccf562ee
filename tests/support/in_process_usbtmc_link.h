#pragma once

#include "drivers/links/usbtmc_link.h"
#include "sim/wires/live_radiometer.h"

namespace gonio::test {

/// The simulated radiometer without a bus. Nothing ever waits: on a ManualClock nothing would come, so what is not
/// ready has timed out at once.
class InProcessUsbtmcLink final : public drivers::UsbtmcLink {
 public:
  explicit InProcessUsbtmcLink(sim::LiveRadiometer& radiometer) : radiometer_(radiometer) {}

  Result<drivers::DetectorIdentity> open() override;
  void close() override { is_open_ = false; }
  bool is_open() const override { return is_open_; }
  drivers::UsbtmcInterface interface() const override;
  Result<void> bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) override;
  Result<std::vector<std::uint8_t>> bulk_in(std::size_t most, Duration timeout) override;
  Result<std::vector<std::uint8_t>> interrupt_in(Duration timeout) override;
  Result<std::vector<std::uint8_t>> control_in(const usbtmc::ControlRequest& request, Duration timeout) override;
  Result<void> clear_halt(std::uint8_t endpoint) override;

  /// The cable is out; in again, the device has been without power.
  void set_unplugged(bool on);

 private:
  [[nodiscard]] Result<void> there() const;
  [[nodiscard]] static Result<std::vector<std::uint8_t>> result_of(sim::UsbAnswer answer);

  sim::LiveRadiometer& radiometer_;
  bool is_open_ = false;
  bool is_unplugged_ = false;
};

}  // namespace gonio::test
