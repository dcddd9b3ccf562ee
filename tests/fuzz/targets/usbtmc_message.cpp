// Transfers of USBTMC (USBTMC 1.0, tables 1 to 4) in both directions, and the answers to its control requests.
#include <algorithm>

#include "protocol/usbtmc/control_request.h"
#include "protocol/usbtmc/message.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

std::size_t size_field(Bytes bytes) {
  return bytes[4] + 256U * (bytes[5] + 256U * (bytes[6] + std::size_t{256} * bytes[7]));
}

void check_bulk_in(Bytes bytes, std::uint8_t tag, std::uint32_t most) {
  const auto taken = usbtmc::parse_dev_dep_msg_in(bytes, tag, most);
  if (!taken) {
    hold_error(taken.error());
    return;
  }
  hold(bytes.size() >= usbtmc::kHeaderBytes && bytes[0] == 2 && bytes[1] == tag, "a reply bears the request's tag");
  hold(static_cast<unsigned>(bytes[1] ^ bytes[2]) == 0xFFU, "a tag is followed by its inverse");
  hold(taken->payload.size() == size_field(bytes) && taken->payload.size() <= most,
       "a reply has the size that it says, and no more than was asked for");
  hold(std::ranges::equal(taken->payload, bytes.subspan(usbtmc::kHeaderBytes, taken->payload.size())),
       "a payload is what was sent");
  const auto again = usbtmc::dev_dep_msg_in(tag, taken->payload, taken->is_end);
  const auto same = usbtmc::parse_dev_dep_msg_in(again, tag, most);
  hold(same && same->payload == taken->payload && same->is_end == taken->is_end, "written again it is the same");
}

void check_bulk_out(Bytes bytes) {
  const auto taken = usbtmc::parse_bulk_out(bytes);
  if (!taken) {
    hold_error(taken.error());
    return;
  }
  hold(taken->tag != 0 && bytes[2] == usbtmc::inverse(taken->tag), "a tag is not 0 and followed by its inverse");
  if (taken->id != usbtmc::MessageId::DevDepMsgOut) return;
  hold(bytes.size() % usbtmc::kAlignment == 0, "a message is filled up to a multiple of 4 bytes");
  const auto again = usbtmc::dev_dep_msg_out(taken->tag, taken->payload, taken->is_end);
  const auto same = usbtmc::parse_bulk_out(again);
  hold(same && same->payload == taken->payload && same->is_end == taken->is_end, "written again it is the same");
}

void check_answers(Bytes bytes) {
  if (const auto progress = usbtmc::parse_progress(bytes); !progress) hold_error(progress.error());
  if (const auto status = usbtmc::parse_status(bytes); !status) hold_error(status.error());
  const auto capabilities = usbtmc::parse_capabilities(bytes);
  if (!capabilities) {
    hold_error(capabilities.error());
    return;
  }
  const auto same = usbtmc::parse_capabilities(usbtmc::capability_bytes(*capabilities));
  hold(same && *same == *capabilities, "capabilities written again are the same");
}

}  // namespace

void usbtmc_message(Bytes input) {
  ByteSource source(input);
  const std::uint8_t tag = std::max<std::uint8_t>(1, source.byte());
  const std::uint32_t most = 1U + source.word();
  const Bytes bytes = source.rest();
  check_bulk_in(bytes, tag, most);
  check_bulk_out(bytes);
  check_answers(bytes);
  if (bytes.size() < 8) return;
  const auto setup = usbtmc::parse_setup(bytes.first<8>());
  hold(std::ranges::equal(usbtmc::setup_bytes(setup), bytes.first<8>()), "a setup packet written again is the same");
}

}  // namespace gonio::fuzz
