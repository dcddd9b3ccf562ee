#pragma once

#include "drivers/links/camera_link.h"
#include "drivers/links/modbus_link.h"
#include "drivers/links/tape/tape_player.h"
#include "drivers/links/usbtmc_link.h"

// Links without a wire: what they are asked, the tape answers, at once. One party's link of that number each; the
// player must outlive them. Errors: those on the tape, and ReplayDiffers. Threads: the player's.
namespace gonio::drivers {

class ReplayModbusLink final : public ModbusLink {
 public:
  ReplayModbusLink(TapePlayer& player, TapeParty party, std::uint8_t link = 0)
      : player_(player), party_(party), link_(link) {}

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override;
  void resync() override;
  void interrupt() override {}

 private:
  [[nodiscard]] Result<void> transact(TapeCall call, std::span<const std::uint8_t> request,
                                      std::span<std::uint16_t> into);
  TapePlayer& player_;
  TapeParty party_;
  std::uint8_t link_;
};

class ReplayCameraLink final : public CameraLink {
 public:
  ReplayCameraLink(TapePlayer& player, TapeParty party, std::uint8_t link = 0)
      : player_(player), party_(party), link_(link) {}

  Result<DetectorIdentity> open() override;
  void close() override;
  bool is_open() const override;
  bool has_lost_control() const override;
  Result<void> set_format(const CameraFormat& format) override;
  Result<CameraFormat> format() override;
  Result<void> set_exposure(const ExposureSettings& settings) override;
  Result<ExposureSettings> exposure() override;
  Result<std::optional<double>> temperature_c() override;
  Result<void> start() override;
  void stop() override;
  bool is_streaming() const override;
  Result<void> trigger() override;
  Result<std::optional<CameraFrame>> pop(Duration wait) override;

 private:
  [[nodiscard]] Result<TapeExchange> ask(TapeCall call, std::span<const std::uint8_t> request = {});
  [[nodiscard]] Result<void> tell(TapeCall call, std::span<const std::uint8_t> request = {});
  TapePlayer& player_;
  TapeParty party_;
  std::uint8_t link_;
};

class ReplayUsbtmcLink final : public UsbtmcLink {
 public:
  ReplayUsbtmcLink(TapePlayer& player, TapeParty party, std::uint8_t link = 0)
      : player_(player), party_(party), link_(link) {}

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
  [[nodiscard]] Result<std::vector<std::uint8_t>> ask(TapeCall call, std::span<const std::uint8_t> request = {});
  TapePlayer& player_;
  TapeParty party_;
  std::uint8_t link_;
};

}  // namespace gonio::drivers
