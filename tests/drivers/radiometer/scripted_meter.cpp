#include "tests/drivers/radiometer/scripted_meter.h"

#include <algorithm>

namespace gonio::drivers::test {
namespace {

Error broken(ErrorCode code) {
  return {.code = code, .device = "radiometer", .tried = "transfer", .seen = "trouble", .limit = {}};
}

}  // namespace

Result<void> ScriptedMeter::there() const {
  if (is_gone) return failure(broken(ErrorCode::Unreachable));
  if (!is_open_) return failure(broken(ErrorCode::WrongState));
  return {};
}

Result<DetectorIdentity> ScriptedMeter::open() {
  if (is_gone) return failure(broken(ErrorCode::Unreachable));
  ++opens;
  is_open_ = true;
  return DetectorIdentity{"maker", "model", "RAD-1"};
}

void ScriptedMeter::empty() {
  output_.clear();
  tag_ = 0;
}

Result<void> ScriptedMeter::bulk_out(std::span<const std::uint8_t> bytes, Duration) {
  GONIO_TRY(there());
  if (fault == Fault::StallsCommand) {
    fault = Fault::None;
    return failure(broken(ErrorCode::DeviceRefused));
  }
  if (bytes[0] == 2) {
    tag_ = bytes[1];
    return {};
  }
  const std::size_t size = bytes[4];
  std::string line(bytes.begin() + 12, bytes.begin() + 12 + static_cast<std::ptrdiff_t>(size));
  if (!line.empty() && line.back() == '\n') line.pop_back();
  hear(line);
  return {};
}

void ScriptedMeter::hear(const std::string& line) {
  heard.push_back(line);
  output_at_ = clock_.now();
  if (const auto entry = refused.find(line); entry != refused.end()) errors.push_back(entry->second);
  if (const auto answer = answers.find(line); answer != answers.end()) {
    output_ = answer->second + "\n";
  } else if (line == "READ?") {
    output_ = samples.front() + "\n";
    output_at_ += sample_time;
    if (samples.size() > 1) samples.pop_front();
  } else if (line == "SYST:ERR?") {
    output_ = (errors.empty() ? "+0,\"No error\"" : errors.front()) + "\n";
    if (!errors.empty()) errors.pop_front();
  } else if (line.ends_with('?')) {
    output_ = kept[line.substr(0, line.size() - 1)] + "\n";
  } else if (const std::size_t blank = line.find(' '); blank != std::string::npos && !refused.contains(line)) {
    kept[line.substr(0, blank)] = line.substr(blank + 1);
  }
  if (fault == Fault::Twice && line.ends_with('?')) {
    output_ += "\n";  // the end of another reply stays behind
  }
}

std::vector<std::uint8_t> ScriptedMeter::transfer() {
  const bool is_twice = fault == Fault::Twice;
  const std::size_t all = is_twice ? output_.size() - 1 : output_.size();
  const std::size_t n = std::min(all, bytes_in_a_transfer);
  const std::uint8_t tag = fault == Fault::StaleTag ? static_cast<std::uint8_t>(tag_ - 1) : tag_;
  std::vector<std::uint8_t> bytes{2,
                                  tag,
                                  static_cast<std::uint8_t>(~tag),
                                  0,
                                  static_cast<std::uint8_t>(n),
                                  0,
                                  0,
                                  0,
                                  static_cast<std::uint8_t>(n == all ? 1 : 0),
                                  0,
                                  0,
                                  0};
  if (fault == Fault::WrongInverse) bytes[2] = tag;
  bytes.insert(bytes.end(), output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(n));
  if (fault == Fault::Torn) bytes.resize(13);
  output_.erase(0, n);
  fault = Fault::None;
  tag_ = 0;
  return bytes;
}

Result<std::vector<std::uint8_t>> ScriptedMeter::bulk_in(std::size_t, Duration timeout) {
  GONIO_TRY(there());
  if (fault == Fault::Stall) {
    fault = Fault::None;
    return failure(broken(ErrorCode::DeviceRefused));
  }
  const bool will_come = tag_ != 0 && !output_.empty() && fault != Fault::Silence;
  if (!will_come || output_at_ > clock_.now() + timeout) {
    clock_.advance(timeout);
    return failure(broken(ErrorCode::TimedOut));
  }
  clock_.advance_to(output_at_);
  return transfer();
}

Result<std::vector<std::uint8_t>> ScriptedMeter::interrupt_in(Duration timeout) {
  GONIO_TRY(there());
  if (notifications_.empty()) {
    clock_.advance(timeout);
    return failure(broken(ErrorCode::TimedOut));
  }
  auto bytes = notifications_.front();
  notifications_.pop_front();
  return bytes;
}

std::uint8_t ScriptedMeter::status() const {
  return static_cast<std::uint8_t>((errors.empty() ? 0 : 4) | (output_.empty() ? 0 : 16));
}

Result<std::vector<std::uint8_t>> ScriptedMeter::control_in(const usbtmc::ControlRequest& request, Duration) {
  GONIO_TRY(there());
  const auto tag = static_cast<std::uint8_t>(request.value);
  switch (static_cast<int>(request.request)) {
    case 3:  // INITIATE_ABORT_BULK_IN
      ++aborts;
      return std::vector<std::uint8_t>{0x81, 0};
    case 5:  // INITIATE_CLEAR
      if (refuses_to_clear) return std::vector<std::uint8_t>{0x80};
      ++clears;
      checks_ = 0;
      fault = Fault::None;
      empty();
      return std::vector<std::uint8_t>{1};
    case 6:  // CHECK_CLEAR_STATUS
      if (clears_slowly && ++checks_ < 3) return std::vector<std::uint8_t>{2, 1};
      return std::vector<std::uint8_t>{1, 0};
    case 128:  // READ_STATUS_BYTE
      if (!has_interrupt_in) return std::vector<std::uint8_t>{1, tag, status()};
      notifications_.push_back({0x81, status()});  // a service request comes first
      notifications_.push_back({static_cast<std::uint8_t>(0x80 | tag), status()});
      return std::vector<std::uint8_t>{1, tag, 0};
    default:
      return failure(broken(ErrorCode::DeviceRefused));
  }
}

Result<void> ScriptedMeter::clear_halt(std::uint8_t endpoint) {
  GONIO_TRY(there());
  halts_cleared.push_back(endpoint);
  return {};
}

}  // namespace gonio::drivers::test
