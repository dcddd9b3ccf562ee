#include "drivers/drive_stage/drive_unit.h"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace gonio::drivers {

using stage::DriveFlag;
using stage::DriveStep;
using stage::DriveValue;
using stage::DriveVerb;

namespace {

std::int64_t number_of(const DriveStep& step, const DriveNumbers& numbers) {
  switch (step.source) {
    case DriveValue::Fixed:
      return step.value;
    case DriveValue::Target:
      return numbers.target;
    case DriveValue::Speed:
      return numbers.speed;
    case DriveValue::Acceleration:
      return numbers.acceleration;
    case DriveValue::LowLimit:
      return numbers.low_limit;
    case DriveValue::HighLimit:
      return numbers.high_limit;
  }
  return 0;
}

bool is_whole_write(const DriveStep& step) {
  return step.kind == DriveStep::Kind::Write && step.mask == 0;
}

}  // namespace

const stage::Register& DriveUnit::reg(const std::string& name) const {
  const stage::Register* found = map_.find(name);
  assert(found != nullptr);  // read_drive_map has refused any other name
  return *found;
}

Result<void> DriveUnit::run(DriveVerb verb, const DriveNumbers& numbers) {
  for (const DriveStep& step : map_.command(verb)) {
    if (step.kind == DriveStep::Kind::Write) GONIO_TRY(write(step, numbers));
    if (step.kind == DriveStep::Kind::Await) GONIO_TRY(await(step));
  }
  return {};
}

Result<void> DriveUnit::write(const DriveStep& step, const DriveNumbers& numbers) {
  const std::int64_t value = number_of(step, numbers);
  const auto before = written_.find(step.reg);
  if (step.unless_set && before != written_.end() && before->second == value) return {};
  const std::string what = fmt::format("set {} to {}", step.reg, value);
  if (step.mask != 0) return line_.write_bits(reg(step.reg), step.mask, value, what);
  written_.erase(step.reg);
  GONIO_TRY(line_.write(reg(step.reg), value, what));
  written_[step.reg] = value;
  return {};
}

Result<void> DriveUnit::await(const DriveStep& step) {
  const std::string what = fmt::format("wait for {} to show {:#x}", step.reg, step.value);
  std::int64_t seen = 0;
  for (int looks = 0; looks < map_.looks; ++looks) {
    const Result<std::int64_t> value = line_.read(reg(step.reg), what);
    if (!value) return failure(value.error());
    seen = *value;
    if ((seen & step.mask) == step.value) return {};
  }
  if (step.or_go_on) return {};
  return failure(line_.error(ErrorCode::DeviceRefused, what, fmt::format("{:#x}, masked {:#x}", seen, seen & step.mask),
                             fmt::format("{} looks", map_.looks)));
}

Result<void> DriveUnit::set_up(const DriveNumbers& numbers) {
  forget();
  GONIO_TRY(run(DriveVerb::Setup, numbers));
  for (const auto& [name, value] : Values(written_)) {
    const std::string what = fmt::format("read {} back", name);
    const Result<std::int64_t> back = line_.read(reg(name), what);
    if (!back) return failure(back.error());
    if (*back == value) continue;
    forget();
    return failure(line_.error(ErrorCode::DeviceRefused, what, fmt::format("{}", *back), fmt::format("{}", value)));
  }
  return {};
}

Result<bool> DriveUnit::remembers(const DriveNumbers& numbers) {
  if (map_.boot_check.empty()) return true;
  std::int64_t expected = 0;
  for (const DriveStep& step : map_.command(DriveVerb::Setup)) {
    if (is_whole_write(step) && step.reg == map_.boot_check) expected = number_of(step, numbers);
  }
  const Result<std::int64_t> now = line_.read(reg(map_.boot_check), fmt::format("read {}", map_.boot_check));
  if (!now) return failure(now.error());
  return *now == expected;
}

Result<std::int64_t> DriveUnit::value_of(const std::string& name, Values& known) {
  if (const auto found = known.find(name); found != known.end()) return found->second;
  const Result<std::int64_t> value = line_.read(reg(name), fmt::format("read {}", name));
  if (value) known.emplace(name, *value);
  return value;
}

Result<bool> DriveUnit::is(DriveFlag flag, Values& known) {
  const auto& condition = map_.flag(flag);
  if (!condition) return false;
  const Result<std::int64_t> value = value_of(condition->reg, known);
  if (!value) return failure(value.error());
  return (*value & condition->mask) == condition->value;
}

Result<std::int64_t> DriveUnit::read_position() {
  return line_.read(reg("position"), "read its position");
}

Result<DriveLook> DriveUnit::look() {
  DriveLook look;
  Values known;
  for (const auto& [flag, shown] : {std::pair{DriveFlag::Moving, &DriveLook::moving},
                                    {DriveFlag::Homed, &DriveLook::homed},
                                    {DriveFlag::Enabled, &DriveLook::enabled},
                                    {DriveFlag::Stopped, &DriveLook::stopped},
                                    {DriveFlag::Fault, &DriveLook::fault}}) {
    const Result<bool> is_so = is(flag, known);
    if (!is_so) return failure(is_so.error());
    look.*shown = *is_so;
  }
  if (look.fault) GONIO_TRY(look_at_fault(look, known));
  const Result<std::int64_t> counts = read_position();
  if (!counts) return failure(counts.error());
  look.counts = *counts;
  return look;
}

Result<void> DriveUnit::look_at_fault(DriveLook& look, Values& known) {
  for (const auto& [flag, shown] : {std::pair{DriveFlag::Tripped, &DriveLook::tripped},
                                    {DriveFlag::FollowingError, &DriveLook::following_error},
                                    {DriveFlag::AtLimit, &DriveLook::at_limit}}) {
    const Result<bool> is_so = is(flag, known);
    if (!is_so) return failure(is_so.error());
    look.*shown = *is_so;
  }
  if (map_.find("alarm") == nullptr) return {};
  const Result<std::int64_t> alarm = value_of("alarm", known);
  if (!alarm) return failure(alarm.error());
  look.alarm = static_cast<std::uint16_t>(*alarm);
  return {};
}

}  // namespace gonio::drivers
