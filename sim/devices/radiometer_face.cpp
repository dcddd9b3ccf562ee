#include "sim/devices/radiometer_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "protocol/usbtmc/control_request.h"
#include "sim/devices/scpi_header.h"

namespace gonio::sim {
namespace {

constexpr std::size_t kMostErrors = 16;
constexpr std::string_view kOverload = "9.9E37";
constexpr std::string_view kNotANumber = "9.91E37";
constexpr double kLeastPower_w = 1e-15;  // of which a logarithm is shown

constexpr std::string_view kWavelength = "SENSe:CORRection:WAVelength";
constexpr std::string_view kAverages = "SENSe:AVERage:[COUNt]";
constexpr std::string_view kRange = "SENSe:POWer:[DC]:RANGe:[UPPer]";
constexpr std::string_view kAutoRange = "SENSe:POWer:[DC]:RANGe:AUTO";
constexpr std::string_view kUnit = "SENSe:POWer:[DC]:UNIT";

std::string as_query(std::string_view pattern) {
  return std::string(pattern) + "?";
}

bool is_same_word(std::string_view a, std::string_view b) {
  return is_header(a, b);  // a word in capitals is a header of one node
}

}  // namespace

void RadiometerFace::execute(std::string_view message, Instant now) {
  advance_to(now);
  if (!output_.empty() || !units_.empty() || waiting_ != Waiting::Nothing) {
    clear();
    add_error(-410, "Query INTERRUPTED");
  }
  const auto units = scpi::split(message, ';');
  if (!units) return add_error(-102, "Syntax error");
  units_.assign(units->begin(), units->end());
  path_.clear();
  run_units(now);
}

void RadiometerFace::run_units(Instant now) {
  while (!units_.empty() && waiting_ == Waiting::Nothing) {
    const std::string unit = std::move(units_.front());
    units_.pop_front();
    const std::size_t blank = unit.find_first_of(" \t");
    std::string header = unit.substr(0, blank);
    const std::string argument(
        scpi::trimmed(blank == std::string::npos ? std::string_view() : std::string_view(unit).substr(blank)));
    if (!header.starts_with('*')) {
      if (!header.starts_with(':')) header = path_ + header;
      path_ = header.substr(0, header.rfind(':') + 1);  // nothing where there is no colon: npos + 1 is 0
    }
    run(header, argument, now);
  }
  if (!units_.empty() || waiting_ != Waiting::Nothing || reply_.empty()) return;
  output_ = std::exchange(reply_, {}) + "\n";
}

void RadiometerFace::advance_to(Instant now) {
  if (is_zeroing_) {
    if (const auto done = model_.take_zero(now)) {
      is_zeroing_ = false;
      if (!*done) add_error(-340, "Calibration failed");
    }
  }
  if (waiting_ == Waiting::Zero && !is_zeroing_) {
    waiting_ = Waiting::Nothing;
    say("1");
    run_units(now);
  }
  if (waiting_ != Waiting::Sample) return;
  if (const auto sample = model_.take_sample(now)) {
    waiting_ = Waiting::Nothing;
    say_sample(*sample, now);
    run_units(now);
  }
}

void RadiometerFace::run(std::string_view header, std::string_view argument, Instant now) {
  const bool is_setting = !header.ends_with('?');
  if (is_setting && set(header, argument, now)) return;
  const bool takes_none = header.ends_with('?') || header.starts_with('*');
  if (!argument.empty() && takes_none) return add_error(-108, "Parameter not allowed");
  if (argument.empty() && (act(header, now) || answer(header))) return;
  add_error(-113, "Undefined header");
}

// What is done, or takes time.
bool RadiometerFace::act(std::string_view header, Instant now) {
  if (header == "*CLS") {
    errors_.clear();
  } else if (header == "*RST") {
    model_.power_up();
    is_in_dbm_ = false;
  } else if (header == "*OPC?") {
    if (is_zeroing_) {
      waiting_ = Waiting::Zero;
    } else {
      say("1");
    }
  } else if (is_header("READ?", header) || is_header("MEASure:[SCALar]:[POWer]?", header)) {
    begin_sample(now);
  } else if (is_header("SENSe:CORRection:COLLect:ZERO:[INITiate]", header)) {
    model_.start_zero(now);
    is_zeroing_ = true;
  } else {
    return is_header("CONFigure:[SCALar]:POWer", header);  // there is nothing else to be measured
  }
  return true;
}

void RadiometerFace::begin_sample(Instant now) {
  if (is_zeroing_) return add_error(-213, "Init ignored");
  model_.start_sample(now);
  waiting_ = Waiting::Sample;
}

bool RadiometerFace::set(std::string_view header, std::string_view argument, Instant now) {
  const std::array numbers{kWavelength, kAverages, kRange, kAutoRange};
  const bool is_number = std::ranges::any_of(numbers, [&](auto pattern) { return is_header(pattern, header); });
  const bool is_unit = is_header(kUnit, header);
  if (!is_number && !is_unit) return false;
  if (argument.empty()) {
    add_error(-109, "Missing parameter");
  } else if (is_unit) {
    set_unit(argument);
  } else if (const auto flag = scpi::parse_flag(argument); flag && is_header(kAutoRange, header)) {
    model_.set_auto_range(*flag);
  } else if (const auto value = scpi::parse_number(argument); !value || is_header(kAutoRange, header)) {
    add_error(-120, "Numeric data error");
  } else if (value->kind != scpi::NumberKind::Finite || !set_number(header, value->value, now)) {
    add_error(-222, "Data out of range");
  }
  return true;
}

bool RadiometerFace::set_number(std::string_view header, double value, Instant now) {
  if (is_header(kWavelength, header)) return model_.set_wavelength(nanometres(value));
  if (is_header(kRange, header)) return value > 0.0 && model_.set_range(value, now);
  constexpr double kBeyondAnyCount = 1e6;
  const bool is_count = value == std::floor(value) && std::abs(value) < kBeyondAnyCount;
  return is_count && model_.set_averages(static_cast<int>(value));
}

void RadiometerFace::set_unit(std::string_view argument) {
  if (is_same_word("W", argument)) {
    is_in_dbm_ = false;
  } else if (is_same_word("DBM", argument)) {
    is_in_dbm_ = true;
  } else {
    add_error(-224, "Illegal parameter value");
  }
}

// What is said at once.
bool RadiometerFace::answer(std::string_view header) {
  const auto is = [&](std::string_view pattern) { return is_header(as_query(pattern), header); };
  if (header == "*IDN?") {
    say(fmt::format("Goniod,Simulated power meter,{},1.0", model_.spec().serial));
  } else if (is("SYSTem:ERRor:[NEXT]")) {
    say(take_error());
  } else if (is("CONFigure")) {
    say("\"POW\"");
  } else if (is(kWavelength)) {
    say(fmt::format("{:.6E}", in_nanometres(model_.wavelength())));
  } else if (is(kAverages)) {
    say(fmt::format("{}", model_.averages()));
  } else if (is(kRange)) {
    say(fmt::format("{:.6E}", model_.full_scale_w()));
  } else if (is(kAutoRange)) {
    say(model_.is_auto_range() ? "1" : "0");
  } else if (is(kUnit)) {
    say(is_in_dbm_ ? "DBM" : "W");
  } else {
    return false;
  }
  return true;
}

void RadiometerFace::say(std::string_view text) {
  if (!reply_.empty()) reply_ += ';';
  reply_ += text;
}

void RadiometerFace::say_sample(const RadiometerSample& sample, Instant now) {
  auto fault = std::exchange(next_sample_, std::nullopt);
  if (const auto kind = model_.strike(FaultMoment::Sample, now)) fault = radiometer_fault_of(*kind);
  if (fault == RadiometerFault::NotANumber) return say(kNotANumber);
  if (fault == RadiometerFault::Overload || sample.is_overload) return say(kOverload);
  const double shown = is_in_dbm_ ? 10.0 * std::log10(std::max(sample.power_w, kLeastPower_w) / 1e-3) : sample.power_w;
  say(fmt::format("{:.9E}", shown));
}

std::string RadiometerFace::take_output(std::size_t bytes) {
  std::string taken = output_.substr(0, bytes);
  output_.erase(0, taken.size());
  return taken;
}

void RadiometerFace::add_error(int code, std::string_view text) {
  if (errors_.size() < kMostErrors) {
    errors_.push_back({.code = code, .text = std::string(text)});
  } else {
    errors_.back() = {.code = -350, .text = "Queue overflow"};
  }
}

std::string RadiometerFace::take_error() {
  if (errors_.empty()) return scpi::format_error_entry({.code = 0, .text = "No error"});
  const scpi::ErrorEntry entry = std::move(errors_.front());
  errors_.pop_front();
  return scpi::format_error_entry(entry);
}

std::uint8_t RadiometerFace::status_byte() const {
  return static_cast<std::uint8_t>((errors_.empty() ? 0 : usbtmc::kErrorAvailable) |
                                   (output_.empty() ? 0 : usbtmc::kMessageAvailable));
}

void RadiometerFace::clear() {
  units_.clear();
  reply_.clear();
  output_.clear();
  waiting_ = Waiting::Nothing;
  if (!is_zeroing_) model_.abort();
}

void RadiometerFace::power_up() {
  is_zeroing_ = false;
  clear();
  errors_.clear();
  next_sample_.reset();
  is_in_dbm_ = false;
  model_.power_up();
}

}  // namespace gonio::sim
