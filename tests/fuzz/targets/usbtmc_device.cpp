// The simulated radiometer's side of USB: any transfer and any SCPI text, from anybody.
#include <string>

#include "sim/devices/instrument.h"
#include "sim/devices/radiometer_face.h"
#include "sim/devices/radiometer_model.h"
#include "sim/wires/usbtmc_function.h"
#include "tests/fuzz/bench_scene.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using sim::UsbAnswer;
using sim::UsbOutcome;

class Device {
 public:
  Device()
      : instrument_(scene(), {}, now_),
        model_(instrument_, sim::quiet_radiometer()),
        face_(model_),
        function_(face_, "SIM-PM-01") {}

  void one_transfer(ByteSource& source) {
    now_ += std::chrono::milliseconds(source.byte());
    instrument_.advance_to(now_);
    function_.advance_to(now_);
    switch (source.byte() % 6) {
      case 0:
        return control(source);
      case 1:
        static_cast<void>(function_.bulk_out(source.counted(), now_));
        return;
      case 2:
        return fetch(source.word());
      case 3:
        hold(function_.interrupt_in().bytes.size() <= 2, "a notification has 2 bytes");
        return;
      case 4:
        function_.clear_halt(source.byte());
        return;
      default:
        return message(text_of(source.counted()));
    }
  }

 private:
  static const sim::Scene& scene() {
    static const sim::Scene bench = bench_scene();
    return bench;
  }
  void control(ByteSource& source) {
    std::array<std::uint8_t, 8> setup{};
    for (auto& byte : setup) byte = source.byte();
    const std::size_t length = setup[6] + 256U * setup[7];
    const UsbAnswer answer = function_.control(setup, now_);
    hold(answer.bytes.size() <= length, "a control answer is no longer than was asked for");
  }
  void fetch(std::size_t most) {
    const UsbAnswer answer = function_.bulk_in(most, now_);
    hold(answer.bytes.size() <= most, "a transfer is no longer than there is room for");
    if (answer.outcome != UsbOutcome::Done) hold(answer.bytes.empty(), "what is not done gives nothing");
  }
  // Past USBTMC's framing, which a fuzzer seldom gets right.
  void message(std::string_view text) {
    face_.execute(text, now_);
    const std::string& output = face_.output();
    hold(output.empty() || output.back() == '\n', "a reply is a line");
    static_cast<void>(face_.take_output(output.size()));
    const std::uint8_t status = face_.status_byte();
    hold((status & usbtmc::kMessageAvailable) == 0 || !face_.output().empty(),
         "a message is available when there is one");
  }

  Instant now_{std::chrono::seconds(1000)};
  sim::Instrument instrument_;
  sim::RadiometerModel model_;
  sim::RadiometerFace face_;
  sim::UsbtmcFunction function_;
};

}  // namespace

void usbtmc_device(Bytes input) {
  ByteSource source(input);
  Device device;
  for (int transfer = 0; transfer < 60 && !source.is_empty(); ++transfer) device.one_transfer(source);
}

}  // namespace gonio::fuzz
