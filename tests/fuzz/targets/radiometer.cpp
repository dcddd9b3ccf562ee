// The radiometer's driver on a meter that answers as it should, but where the input says otherwise.
#include <cmath>
#include <string>

#include "drivers/radiometer/scpi_radiometer.h"
#include "tests/drivers/radiometer/scripted_meter.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using Transfer = std::vector<std::uint8_t>;

constexpr int kMostTransfers = 100000;  // of one call: a device that never gets done is given up long before

// Passes everything on to a meter that is right, and spoils what comes back as the input says.
class SpoiltMeter final : public drivers::UsbtmcLink {
 public:
  SpoiltMeter(ByteSource& source, ManualClock& clock) : source_(source), clock_(clock), meter_(clock) {
    meter_.answers["*IDN?"] = "maker,model,RAD-1,1.0";
    meter_.answers["CONF?"] = "POW";
    meter_.answers["*OPC?"] = "1";
    meter_.kept["SENS:POW:RANG"] = "1e-3";
    meter_.samples = {"1.25e-4"};
    meter_.sample_time = std::chrono::milliseconds(3);
    meter_.has_interrupt_in = (source.byte() & 1U) != 0;
    meter_.bytes_in_a_transfer = 1U + source.byte();
  }

  Result<drivers::DetectorIdentity> open() override { return meter_.open(); }
  void close() override { meter_.close(); }
  bool is_open() const override { return meter_.is_open(); }
  drivers::UsbtmcInterface interface() const override { return meter_.interface(); }
  Result<void> bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) override {
    count();
    return meter_.bulk_out(bytes, timeout);
  }
  Result<Transfer> bulk_in(std::size_t most, Duration timeout) override {
    return spoilt(meter_.bulk_in(most, timeout), most);
  }
  Result<Transfer> interrupt_in(Duration timeout) override { return spoilt(meter_.interrupt_in(timeout), 2); }
  Result<Transfer> control_in(const usbtmc::ControlRequest& request, Duration timeout) override {
    return spoilt(meter_.control_in(request, timeout), request.length);
  }
  Result<void> clear_halt(std::uint8_t endpoint) override {
    count();
    return meter_.clear_halt(endpoint);
  }

  void begin_call() { transfers_ = 0; }

 private:
  void count() { hold(++transfers_ <= kMostTransfers, "the transfers of a call are bounded"); }

  // Mostly it is left as it is; else it fails, bytes of it change, its text is another's, or it is cut.
  Result<Transfer> spoilt(Result<Transfer> given, std::size_t most) {
    count();
    switch (source_.byte() % 16) {
      case 1:
        return failed();
      case 2:
        if (given && !given->empty()) (*given)[source_.byte() % given->size()] = source_.byte();
        return given;
      case 3:
        return with_text(std::move(given), most);
      case 4:
        if (given) given->resize(source_.byte() % (given->size() + 1));
        return given;
      case 5: {
        const Bytes bytes = source_.counted();
        return Transfer(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), most)));
      }
      default:
        return given;
    }
  }
  Result<Transfer> failed() {
    constexpr std::array kErrors{ErrorCode::TimedOut, ErrorCode::IncompleteData, ErrorCode::DeviceRefused,
                                 ErrorCode::BadReply, ErrorCode::Unreachable,    ErrorCode::ControlLost};
    clock_.advance(std::chrono::milliseconds(source_.byte()));
    return failure({.code = kErrors[source_.byte() % kErrors.size()],
                    .device = "radiometer",
                    .tried = "transfer",
                    .seen = "trouble",
                    .limit = {}});
  }
  // The header stays in step; what it brings is the input's.
  Result<Transfer> with_text(Result<Transfer> given, std::size_t most) {
    if (!given || given->size() < usbtmc::kHeaderBytes || most < 300) return given;
    const Bytes text = source_.counted();
    given->resize(usbtmc::kHeaderBytes);
    (*given)[4] = static_cast<std::uint8_t>(text.size());
    (*given)[8] = 1;
    given->insert(given->end(), text.begin(), text.end());
    return given;
  }

  ByteSource& source_;
  ManualClock& clock_;
  drivers::test::ScriptedMeter meter_;
  int transfers_ = 0;
};

void hold_reading(const drivers::RadiometerReading& reading, int samples) {
  hold(std::isfinite(reading.mean_w), "a mean is finite");
  hold(std::isfinite(reading.standard_error_w) && reading.standard_error_w >= 0.0,
       "a standard error is finite and not negative");
  hold(std::isfinite(reading.range_w), "a range is finite");
  hold(reading.samples == samples, "a reading is of as many samples as were asked for");
  hold(reading.ended >= reading.started, "a reading ends after it began");
}

class Session {
 public:
  explicit Session(Bytes input) : source_(input), meter_(source_, clock_), driver_(meter_, config(), clock_) {}

  void run() {
    for (int step = 0; step < 12 && !source_.is_empty(); ++step) {
      meter_.begin_call();
      one_call();
    }
  }

 private:
  static drivers::ScpiRadiometerConfig config() {
    return {.serial = "RAD-1", .settings = {.wavelength = nanometres(568.0), .range_w = 1e-3, .samples = kSamples}};
  }
  template <class T>
  void held(const Result<T>& result) {
    if (!result) hold_device_error(result.error());
  }
  void one_call() {
    switch (source_.byte() % 5) {
      case 0:
        return held(driver_.ensure_open());
      case 1:
        return held(driver_.apply({.wavelength = nanometres(400.0 + source_.byte()),
                                   .averages = 1 + source_.byte() % 4,
                                   .samples = kSamples}));
      case 2:
        held(driver_.start_zero());
        return held(driver_.is_zeroed(std::chrono::seconds(40)));
      case 3:
        return held(driver_.collect(Duration::zero()));
      default:
        return read();
    }
  }
  void read() {
    const auto begun = driver_.trigger();
    held(begun);
    if (!begun) return;
    const auto reading = driver_.collect(std::chrono::seconds(2));
    held(reading);
    if (reading && *reading) hold_reading(**reading, kSamples);
  }

  static constexpr int kSamples = 3;
  ManualClock clock_;
  ByteSource source_;
  SpoiltMeter meter_;
  drivers::ScpiRadiometer driver_;
};

}  // namespace

void radiometer(Bytes input) {
  Session(input).run();
}

}  // namespace gonio::fuzz
