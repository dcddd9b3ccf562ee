#include "tests/support/in_process_usbtmc_link.h"

#include <utility>

namespace gonio::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using sim::UsbtmcFunction;

Error trouble(ErrorCode code, std::string seen) {
  return {.code = code, .device = "radiometer", .tried = "transfer", .seen = std::move(seen), .limit = {}};
}

}  // namespace

Result<void> InProcessUsbtmcLink::there() const {
  if (is_unplugged_) return failure(trouble(ErrorCode::Unreachable, "the device is gone"));
  if (!is_open_) return failure(trouble(ErrorCode::WrongState, "it is not open"));
  return {};
}

Result<Bytes> InProcessUsbtmcLink::result_of(sim::UsbAnswer answer) {
  switch (answer.outcome) {
    case sim::UsbOutcome::Done:
      return std::move(answer.bytes);
    case sim::UsbOutcome::Stalled:
      return failure(trouble(ErrorCode::DeviceRefused, "the endpoint stalled"));
    case sim::UsbOutcome::NotReady:
      break;
  }
  return failure(trouble(ErrorCode::TimedOut, "nothing"));
}

Result<drivers::DetectorIdentity> InProcessUsbtmcLink::open() {
  is_open_ = !is_unplugged_;
  GONIO_TRY(there());
  return drivers::DetectorIdentity{"Goniod", "Simulated power meter", "in process"};
}

drivers::UsbtmcInterface InProcessUsbtmcLink::interface() const {
  return {.number = 0,
          .bulk_out = UsbtmcFunction::kBulkOut,
          .bulk_in = UsbtmcFunction::kBulkIn,
          .interrupt_in = UsbtmcFunction::kInterruptIn};
}

Result<void> InProcessUsbtmcLink::bulk_out(std::span<const std::uint8_t> bytes, Duration) {
  GONIO_TRY(there());
  const auto outcome =
      radiometer_.with([&](UsbtmcFunction& function, Instant now) { return function.bulk_out(bytes, now); });
  if (auto result = result_of({.outcome = outcome, .bytes = {}}); !result) return failure(std::move(result).error());
  return {};
}

Result<Bytes> InProcessUsbtmcLink::bulk_in(std::size_t most, Duration) {
  GONIO_TRY(there());
  return result_of(
      radiometer_.with([&](UsbtmcFunction& function, Instant now) { return function.bulk_in(most, now); }));
}

Result<Bytes> InProcessUsbtmcLink::interrupt_in(Duration) {
  GONIO_TRY(there());
  return result_of(radiometer_.with([](UsbtmcFunction& function, Instant) { return function.interrupt_in(); }));
}

Result<Bytes> InProcessUsbtmcLink::control_in(const usbtmc::ControlRequest& request, Duration) {
  GONIO_TRY(there());
  const auto setup = usbtmc::setup_bytes(request);
  return result_of(
      radiometer_.with([&](UsbtmcFunction& function, Instant now) { return function.control(setup, now); }));
}

Result<void> InProcessUsbtmcLink::clear_halt(std::uint8_t endpoint) {
  GONIO_TRY(there());
  radiometer_.with([&](UsbtmcFunction& function, Instant) { function.clear_halt(endpoint); });
  return {};
}

void InProcessUsbtmcLink::set_unplugged(bool on) {
  is_unplugged_ = on;
  is_open_ = false;
  if (!on) radiometer_.with([](UsbtmcFunction& function, Instant) { function.power_up(); });
}

}  // namespace gonio::test
