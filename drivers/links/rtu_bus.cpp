#include "drivers/links/rtu_bus.h"

#include <fmt/format.h>

#include <utility>

#include "drivers/links/gave_way.h"

namespace gonio::drivers {
namespace {

constexpr int kTurnsToWaitFor = 3;

Error turn_error(ErrorCode code, std::string seen) {
  return {.code = code, .device = {}, .tried = {}, .seen = std::move(seen), .limit = {}};
}

}  // namespace

RtuBus::RtuBus(RtuLineConfig config) : line_(std::move(config)) {}

std::unique_ptr<ModbusLink> RtuBus::for_unit(Rank rank, const ModbusUnit& unit) {
  return std::make_unique<Face>(*this, rank, unit);
}

bool RtuBus::may_begin(Rank rank) const {
  if (is_taken_) return false;
  for (std::size_t higher = static_cast<std::size_t>(rank) + 1; higher < waiting_.size(); ++higher) {
    if (waiting_[higher] > 0) return false;
  }
  return true;
}

Result<void> RtuBus::take_turn(Face& face) {
  std::unique_lock lock(mutex_);
  ++waiting(face.rank_);
  if (face.rank_ == Rank::Urgent && is_taken_) line_.wake();
  const bool is_in_time = changed_.wait_for(lock, kTurnsToWaitFor * line_.longest_exchange(),
                                            [&] { return face.is_interrupted_ || may_begin(face.rank_); });
  --waiting(face.rank_);
  if (is_in_time && !face.is_interrupted_.exchange(false)) {
    is_taken_ = true;
    return {};
  }
  changed_.notify_all();
  if (is_in_time) return failure(turn_error(ErrorCode::Unreachable, kGaveWay));
  return failure(turn_error(ErrorCode::TimedOut, "the line is never free"));
}

void RtuBus::give_turn() {
  {
    const std::lock_guard lock(mutex_);
    is_taken_ = false;
  }
  changed_.notify_all();
}

Result<void> RtuBus::Face::transact(std::string tried, const ModbusRequest& request, std::span<std::uint16_t> into) {
  last_reply_bytes_ = RtuLine::reply_bytes(request);
  Result<void> done = bus_.take_turn(*this);
  if (done) {
    const bool is_urgent = rank_ == Rank::Urgent;
    const auto gives_way = [&] {
      return is_interrupted_.exchange(false) || (!is_urgent && bus_.waiting(Rank::Urgent) > 0);
    };
    done = bus_.line_.exchange(unit_.unit_id, request, into, is_urgent ? RtuLine::Haste::Urgent : RtuLine::Haste::None,
                               gives_way);
    bus_.give_turn();
  }
  if (done) return done;
  done.error().device = "stage";
  done.error().tried = std::move(tried);
  return done;
}

Result<void> RtuBus::Face::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  return transact(fmt::format("read {} registers from {}", into.size(), first),
                  read_request(first, into.size(), unit_.reads), into);
}

Result<void> RtuBus::Face::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  return transact(fmt::format("write {} registers from {}", words.size(), first),
                  write_request(first, words, unit_.writes), {});
}

Result<void> RtuBus::Face::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                          std::uint16_t read_first, std::span<std::uint16_t> into) {
  return transact(
      fmt::format("write {} registers from {} and read {} from {}", words.size(), write_first, into.size(), read_first),
      write_and_read_request(write_first, words, read_first, into.size()), into);
}

void RtuBus::Face::resync() {
  bus_.line_.owe(last_reply_bytes_);  // what came was another's, so ours is still to come
}

void RtuBus::Face::interrupt() {
  {
    const std::lock_guard lock(bus_.mutex_);
    is_interrupted_ = true;
    if (bus_.is_taken_) bus_.line_.wake();
  }
  bus_.changed_.notify_all();
}

}  // namespace gonio::drivers
