#pragma once

#include "drivers/links/tape/tape_channel.h"
#include "drivers/links/usbtmc_link.h"

namespace gonio::drivers {

/// A USBTMC link whose transfers are recorded. It changes nothing of what passes.
class TapedUsbtmcLink final : public UsbtmcLink {
 public:
  /// `link` must outlive it.
  TapedUsbtmcLink(UsbtmcLink& link, TapeChannel channel) : link_(link), channel_(channel) {}

  Result<DetectorIdentity> open() override;
  void close() override;
  bool is_open() const override;
  UsbtmcInterface interface() const override;
  Result<void> bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) override;
  Result<std::vector<std::uint8_t>> bulk_in(std::size_t most, Duration timeout) override;
  Result<std::vector<std::uint8_t>> interrupt_in(Duration timeout) override;
  Result<std::vector<std::uint8_t>> control_in(const usbtmc::ControlRequest& request, Duration timeout) override;
  Result<void> clear_halt(std::uint8_t endpoint) override;

 private:
  UsbtmcLink& link_;
  TapeChannel channel_;
};

}  // namespace gonio::drivers
