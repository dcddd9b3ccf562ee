#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/links/usbtmc_link.h"

namespace gonio::drivers {

struct LibusbConfig {
  std::string role = "radiometer";  ///< named in errors
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string serial;
};

/// A USBTMC interface by libusb, found by vendor, product and serial number at each `open`, so that a device that was
/// unplugged is found again wherever it returns. Transfers are synchronous; libusb keeps one thread for its list of
/// devices.
class LibusbUsbtmcLink final : public UsbtmcLink {
 public:
  explicit LibusbUsbtmcLink(LibusbConfig config);
  ~LibusbUsbtmcLink() override;

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
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::drivers
