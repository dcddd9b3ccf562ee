#include "drivers/drive_stage/unit_line.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "drivers/links/gave_way.h"

namespace gonio::drivers {
namespace {

bool says_nothing(ErrorCode code) {
  return code == ErrorCode::TimedOut || code == ErrorCode::Unreachable;
}

// What of a value fits the register, as it will be read back.
std::int64_t cut(const stage::Register& reg, std::int64_t value) {
  const unsigned bits = 16U * reg.words;
  const auto low = static_cast<std::uint64_t>(value) & ((std::uint64_t{1} << bits) - 1);
  const bool is_negative = reg.is_signed && (low >> (bits - 1U)) != 0;
  return static_cast<std::int64_t>(low) - (is_negative ? std::int64_t{1} << bits : 0);
}

}  // namespace

UnitLine::UnitLine(ModbusLink& link, const Clock& clock, std::string name, Duration patience, int tries)
    : link_(link), clock_(clock), name_(std::move(name)), patience_(patience), tries_(tries) {}

Error UnitLine::error(ErrorCode code, std::string tried, std::string seen, std::string limit) const {
  return {.code = code,
          .device = "stage",
          .tried = fmt::format("{}: {}", name_, tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

bool UnitLine::is_given_up() const {
  return silent_since_ && clock_.now() - *silent_since_ >= patience_;
}

template <class Exchange>
Result<void> UnitLine::talk(const std::string& what, Exchange exchange) {
  Result<void> done;
  int given_way = 0;
  for (int tries = 0; tries < tries_; ++tries) {
    const Instant began = clock_.now();
    done = exchange();
    if (done || done.error().code == ErrorCode::DeviceRefused) {
      silent_since_.reset();
      break;
    }
    // A halt takes one exchange a drive, and more than one call may have to give way to it.
    if (tries_ > 1 && gave_way(done.error()) && ++given_way <= kMostGivenWay) {
      --tries;  // no failing of the unit
      continue;
    }
    link_.resync();
    if (says_nothing(done.error().code) && !silent_since_) silent_since_ = began;
    if (is_given_up()) break;
  }
  if (done) return done;
  Error error = std::move(done).error();
  if (error.code == ErrorCode::TimedOut && is_given_up()) {
    error.code = ErrorCode::Unreachable;
    error.seen += fmt::format("; no answer for {:.1f} s", in_seconds(clock_.now() - *silent_since_));
  }
  error.device = "stage";
  error.tried =
      error.tried.empty() ? fmt::format("{}: {}", name_, what) : fmt::format("{}: {} ({})", name_, what, error.tried);
  return failure(std::move(error));
}

Result<void> UnitLine::read_run(std::uint16_t first, std::span<std::uint16_t> into, const std::string& what) {
  return talk(what, [&] { return link_.read_registers(first, into); });
}

Result<std::int64_t> UnitLine::read(const stage::Register& reg, const std::string& what) {
  std::array<std::uint16_t, 2> words{};
  const auto into = std::span(words).first(reg.words);
  if (auto done = read_run(reg.address, into, what); !done) return failure(std::move(done).error());
  return stage::decode(into, reg.address, reg);
}

Result<void> UnitLine::write(const stage::Register& reg, std::int64_t value, const std::string& what) {
  std::array<std::uint16_t, 2> words{};
  const auto from = std::span(words).first(reg.words);
  stage::encode(from, reg.address, reg, cut(reg, value));
  return talk(what, [&] { return link_.write_registers(reg.address, from); });
}

Result<void> UnitLine::write_bits(const stage::Register& reg, std::int64_t mask, std::int64_t value,
                                  const std::string& what) {
  const Result<std::int64_t> before = read(reg, what);
  if (!before) return failure(before.error());
  return write(reg, (*before & ~mask) | (value & mask), what);
}

}  // namespace gonio::drivers
