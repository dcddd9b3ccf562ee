#include "sim/wires/usbtmc_function.h"

#include <algorithm>
#include <utility>

namespace gonio::sim {
namespace {

using usbtmc::ControlRequest;
using usbtmc::Status;

constexpr std::uint8_t kDeviceToHost = 0x80;
constexpr std::uint8_t kGetDescriptor = 6;
constexpr unsigned kDeviceDescriptor = 1;
constexpr unsigned kStringDescriptor = 3;
constexpr std::size_t kDeviceDescriptorBytes = 18;
constexpr std::uint8_t kMostNotifications = 8;

UsbAnswer stalled() {
  return {.outcome = UsbOutcome::Stalled, .bytes = {}};
}
UsbAnswer not_ready() {
  return {.outcome = UsbOutcome::NotReady, .bytes = {}};
}
UsbAnswer done(std::vector<std::uint8_t> bytes) {
  return {.outcome = UsbOutcome::Done, .bytes = std::move(bytes)};
}
constexpr std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value);
}

}  // namespace

UsbtmcFunction::UsbtmcFunction(RadiometerFace& face, std::string serial, bool has_interrupt_in)
    : face_(face), serial_(std::move(serial)), has_interrupt_in_(has_interrupt_in) {}

// USB 2.0, tables 9-8, 9-10, 9-12, 9-13; class codes of USBTMC 1.0, table 43. 512 bytes a bulk packet: high speed.
std::vector<std::uint8_t> UsbtmcFunction::descriptors() const {
  std::vector<std::uint8_t> bytes{
      18,   1,    0x00, 0x02, 0, 0, 0, 64, low(kVendor), low(kVendor >> 8U), low(kProduct), low(kProduct >> 8U),
      0x00, 0x01, 1,    2,    3, 1};
  const auto total = low(9 + 9 + 7 * (has_interrupt_in_ ? 3U : 2U));
  const auto endpoints = low(has_interrupt_in_ ? 3U : 2U);
  const std::vector<std::uint8_t> rest{9, 2, total,    0, 1,         1,    0, 0xC0, 0,  // configuration: self-powered
                                       9, 4, 0,        0, endpoints, 0xFE, 3, 1,    0,  // interface: USBTMC, USB488
                                       7, 5, kBulkOut, 2, 0x00,      0x02, 0, 7,    5, kBulkIn, 2, 0x00, 0x02, 0};
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  if (has_interrupt_in_) {
    const std::array<std::uint8_t, 7> interrupt{7, 5, kInterruptIn, 3, 2, 0, 7};
    bytes.insert(bytes.end(), interrupt.begin(), interrupt.end());
  }
  return bytes;
}

std::vector<std::uint8_t> UsbtmcFunction::string_descriptor(std::uint8_t index) const {
  if (index == 0) return {4, kStringDescriptor, 0x09, 0x04};  // US English
  const std::array<std::string, 3> texts{"Goniod", "Simulated power meter", serial_};
  if (index > texts.size()) return {};
  const std::string& text = texts[index - 1U];
  std::vector<std::uint8_t> bytes{low(static_cast<unsigned>(2 + 2 * text.size())), kStringDescriptor};
  for (const char c : text) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  return bytes;
}

UsbAnswer UsbtmcFunction::control(std::span<const std::uint8_t, 8> setup, Instant now) {
  face_.advance_to(now);
  const ControlRequest request = usbtmc::parse_setup(setup);
  UsbAnswer answer = request.request_type == kDeviceToHost ? standard_request(request) : class_request(request);
  if (answer.bytes.size() > request.length) answer.bytes.resize(request.length);
  return answer;
}

UsbAnswer UsbtmcFunction::standard_request(const ControlRequest& request) const {
  if (static_cast<std::uint8_t>(request.request) != kGetDescriptor) return stalled();
  const unsigned kind = request.value >> 8U;
  std::vector<std::uint8_t> bytes;
  if (kind == kStringDescriptor) bytes = string_descriptor(low(request.value));
  if (kind == kDeviceDescriptor) {
    bytes = descriptors();
    bytes.resize(kDeviceDescriptorBytes);
  }
  return bytes.empty() ? stalled() : done(std::move(bytes));
}

UsbAnswer UsbtmcFunction::class_request(const ControlRequest& request) {
  constexpr auto kSuccess = static_cast<std::uint8_t>(Status::Success);
  const auto expected = request.request_type == usbtmc::kOfInterface || request.request_type == usbtmc::kOfEndpoint;
  if (!expected) return stalled();
  const std::uint8_t tag = low(request.value);
  switch (request.request) {
    case usbtmc::Request::InitiateAbortBulkOut:
      return done({static_cast<std::uint8_t>(Status::TransferNotInProgress), tag});  // each is taken whole
    case usbtmc::Request::InitiateAbortBulkIn:
      return done(abort_bulk_in(tag));
    case usbtmc::Request::CheckAbortBulkOutStatus:
    case usbtmc::Request::CheckAbortBulkInStatus:
      return done({kSuccess, 0, 0, 0, 0, 0, 0, 0});
    case usbtmc::Request::InitiateClear:
      clear();
      return done({kSuccess});
    case usbtmc::Request::CheckClearStatus:
      return done({kSuccess, 0});
    case usbtmc::Request::GetCapabilities: {
      const auto bytes = usbtmc::capability_bytes(
          {.usbtmc_version = 0x0100, .usb488_version = 0x0100, .understands_488_2 = true, .understands_scpi = true});
      return done({bytes.begin(), bytes.end()});
    }
    case usbtmc::Request::ReadStatusByte:
      return done(status_answer(tag));
  }
  return stalled();
}

std::vector<std::uint8_t> UsbtmcFunction::status_answer(std::uint8_t tag) {
  const std::uint8_t status = face_.status_byte();
  if (!has_interrupt_in_) return {static_cast<std::uint8_t>(Status::Success), tag, status};
  if (notifications_.size() >= kMostNotifications) {
    return {static_cast<std::uint8_t>(Status::InterruptInBusy), tag, 0};
  }
  notifications_.push_back({low(0x80U | tag), status});
  return {static_cast<std::uint8_t>(Status::Success), tag, 0};
}

std::vector<std::uint8_t> UsbtmcFunction::abort_bulk_in(std::uint8_t tag) {
  const bool is_under_way = request_ && request_->tag == tag;
  if (!is_under_way) return {static_cast<std::uint8_t>(Status::TransferNotInProgress), tag};
  request_.reset();
  is_silent_ = false;
  ends_transfer_ = true;
  return {static_cast<std::uint8_t>(Status::Success), tag};
}

void UsbtmcFunction::clear() {
  face_.clear();
  received_.clear();
  request_.reset();
  notifications_.clear();
  is_silent_ = false;
  ends_transfer_ = false;
}

void UsbtmcFunction::clear_halt(std::uint8_t endpoint) {
  if (endpoint == kBulkOut) is_out_halted_ = false;
  if (endpoint == kBulkIn) is_in_halted_ = false;
}

void UsbtmcFunction::power_up() {
  clear();
  is_out_halted_ = is_in_halted_ = false;
  fault_.reset();
  face_.power_up();
}

// USBTMC 1.0, 3.2: what is not a message halts the endpoint.
UsbOutcome UsbtmcFunction::bulk_out(std::span<const std::uint8_t> bytes, Instant now) {
  if (is_out_halted_) return UsbOutcome::Stalled;
  const auto message = usbtmc::parse_bulk_out(bytes);
  const bool is_second = message && message->id == usbtmc::MessageId::DevDepMsgIn && request_;
  if (!message || is_second || message->id == usbtmc::MessageId::Trigger) {
    is_out_halted_ = true;
    return UsbOutcome::Stalled;
  }
  if (message->id == usbtmc::MessageId::DevDepMsgIn) {
    request_ = Request{.tag = message->tag, .most = message->most};
    return UsbOutcome::Done;
  }
  received_.append(message->payload.begin(), message->payload.end());
  if (message->is_end) face_.execute(std::exchange(received_, {}), now);
  return UsbOutcome::Done;
}

void UsbtmcFunction::inject(RadiometerFault fault, unsigned replies_before) {
  if (fault == RadiometerFault::NotANumber || fault == RadiometerFault::Overload) return face_.spoil_next_sample(fault);
  fault_ = fault;
  replies_before_fault_ = replies_before;
}

std::optional<RadiometerFault> UsbtmcFunction::fault_of_this_reply(Instant now) {
  if (const auto kind = face_.strike_reply(now)) return radiometer_fault_of(*kind);
  if (!fault_) return std::nullopt;
  if (replies_before_fault_ > 0) {
    --replies_before_fault_;
    return std::nullopt;
  }
  return std::exchange(fault_, std::nullopt);
}

UsbAnswer UsbtmcFunction::bulk_in(std::size_t most, Instant now) {
  face_.advance_to(now);
  if (is_in_halted_) return stalled();
  if (std::exchange(ends_transfer_, false)) return done({});
  if (is_silent_ || !request_ || face_.output().empty()) return not_ready();
  const auto fault = fault_of_this_reply(now);
  if (face_.is_unplugged(now)) return not_ready();  // the port pulls it
  if (fault == RadiometerFault::Stall) {
    is_in_halted_ = true;
    return stalled();
  }
  if (fault == RadiometerFault::Silence) {
    is_silent_ = true;
    return not_ready();
  }
  return reply(most, fault);
}

UsbAnswer UsbtmcFunction::reply(std::size_t most, std::optional<RadiometerFault> fault) {
  const Request request = *std::exchange(request_, std::nullopt);
  const std::string whole = face_.output();
  const std::size_t room = most > usbtmc::kHeaderBytes ? most - usbtmc::kHeaderBytes : 0;
  const std::string text = face_.take_output(std::min<std::size_t>(request.most, room));
  if (text.empty()) return not_ready();
  const bool is_stale = fault == RadiometerFault::StaleTag;
  const auto tag = is_stale ? low(request.tag == 1 ? 255U : request.tag - 1U) : request.tag;
  std::vector<std::uint8_t> bytes =
      usbtmc::dev_dep_msg_in(tag, std::vector<std::uint8_t>(text.begin(), text.end()), face_.output().empty());
  if (fault == RadiometerFault::TornReply) bytes.resize(usbtmc::kHeaderBytes + text.size() / 2);
  if (fault == RadiometerFault::DuplicatedReply) face_.say_again(whole);
  return done(std::move(bytes));
}

UsbAnswer UsbtmcFunction::interrupt_in() {
  if (notifications_.empty()) return not_ready();
  std::vector<std::uint8_t> bytes = std::move(notifications_.front());
  notifications_.pop_front();
  return done(std::move(bytes));
}

}  // namespace gonio::sim
