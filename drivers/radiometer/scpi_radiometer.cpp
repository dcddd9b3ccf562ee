#include "drivers/radiometer/scpi_radiometer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "protocol/usbtmc/scpi.h"

namespace gonio::drivers {
namespace {

constexpr int kFewestSamples = 2;
constexpr int kMostSamples = 10000;
constexpr int kMostAverages = 10000;
constexpr int kMostDiscarded = 100000;  // while a range settles
constexpr int kMostRestarts = 3;        // of a reading in which the meter changed its range
constexpr int kMostErrorEntries = 64;
constexpr double kWavelengthTolerance_nm = 0.05;
constexpr double kRangeTolerance = 0.01;  // relative: meters state 1.1 mW or 1 mW for the same range
constexpr std::string_view kSample = "READ?";

// What a meter said, which may be nothing.
std::string said(std::string_view reply) {
  return fmt::format("\"{}\"", reply);
}

RadiometerReading reading_of(const std::vector<double>& samples) {
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  double squares = 0.0;
  for (const double sample : samples) squares += (sample - mean) * (sample - mean);
  return {.mean_w = mean,
          .standard_error_w = std::sqrt(squares / (n - 1.0) / n),
          .samples = static_cast<int>(samples.size())};
}

}  // namespace

ScpiRadiometer::ScpiRadiometer(UsbtmcLink& link, ScpiRadiometerConfig config, const Clock& clock)
    : config_(std::move(config)),
      clock_(clock),
      session_(link, UsbtmcSessionConfig{.role = config_.role, .transfer_timeout = config_.transfer_timeout}, clock),
      settings_(config_.settings) {}

Error ScpiRadiometer::error(ErrorCode code, std::string tried, std::string seen, std::string limit) const {
  return {.code = code,
          .device = config_.role,
          .tried = std::move(tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<DetectorIdentity> ScpiRadiometer::ensure_open() {
  if (is_ready_ && session_.is_open()) return identity_;
  is_ready_ = false;
  task_ = Task::None;
  if (Result<void> opened = open(); !opened) {
    session_.close();
    return failure(std::move(opened).error());
  }
  is_ready_ = true;
  return identity_;
}

Result<void> ScpiRadiometer::open() {
  if (auto who = session_.open(); !who) return failure(std::move(who).error());
  GONIO_TRY(identify());
  GONIO_TRY(command("*CLS"));
  GONIO_TRY(set_word("CONF:POW", {}, "CONF?"));
  GONIO_TRY(set_word("SENS:POW:UNIT", "W", "SENS:POW:UNIT?"));
  return write_settings(settings_);
}

Result<void> ScpiRadiometer::identify() {
  // Not `query`: what a program before us left in the error queue is none of our errors.
  const auto text = session_.query("*IDN?", config_.reply_margin);
  if (!text) return failure(text.error());
  const auto fields = scpi::split(*text, ',');
  if (!fields || fields->size() < 3) {
    return failure(error(ErrorCode::BadReply, "ask \"*IDN?\"", said(*text), "maker, model, serial number, version"));
  }
  identity_ = {.vendor = (*fields)[0], .model = (*fields)[1], .serial = (*fields)[2]};
  if (identity_.serial == config_.serial) return {};
  return failure(
      error(ErrorCode::WrongDevice, "ask \"*IDN?\"", "serial " + identity_.serial, "serial " + config_.serial));
}

Result<void> ScpiRadiometer::write_settings(const RadiometerSettings& settings) {
  GONIO_TRY(set_number("SENS:CORR:WAV", in_nanometres(settings.wavelength), kWavelengthTolerance_nm, "nm"));
  GONIO_TRY(set_number("SENS:AVER:COUN", settings.averages, 0.0, ""));
  GONIO_TRY(write_range(settings.range_w));
  settled_at_ = clock_.now() + config_.range_settle;
  return {};
}

Result<void> ScpiRadiometer::write_range(const std::optional<double>& range_w) {
  GONIO_TRY(set_number("SENS:POW:RANG:AUTO", range_w ? 0.0 : 1.0, 0.0, ""));
  if (!range_w) return {};
  return set_number("SENS:POW:RANG", *range_w, kRangeTolerance * *range_w, "W");
}

Result<void> ScpiRadiometer::set_number(std::string_view header, double value, double tolerance,
                                        std::string_view unit) {
  GONIO_TRY(command(fmt::format("{} {:.9g}", header, value)));
  const auto taken = query_number(fmt::format("{}?", header));
  if (!taken) return failure(taken.error());
  if (std::abs(*taken - value) <= tolerance) return {};
  return failure(error(ErrorCode::SettingNotTaken, fmt::format("set {} to {} {}", header, value, unit),
                       fmt::format("{} {} read back", *taken, unit)));
}

Result<void> ScpiRadiometer::set_word(std::string_view header, std::string_view word, std::string_view query_text) {
  GONIO_TRY(command(word.empty() ? std::string(header) : fmt::format("{} {}", header, word)));
  const auto taken = query(query_text);
  if (!taken) return failure(taken.error());
  // "CONF:POW" is read back as POW, quoted by some meters.
  const std::string plain = scpi::parse_quoted(*taken).value_or(*taken);
  const std::string_view wanted = word.empty() ? header.substr(header.rfind(':') + 1) : word;
  if (plain == wanted) return {};
  return failure(error(ErrorCode::SettingNotTaken, fmt::format("set {} {}", header, word),
                       fmt::format("\"{}\" read back", plain), fmt::format("\"{}\"", wanted)));
}

Result<void> ScpiRadiometer::command(std::string_view text) {
  GONIO_TRY(session_.send(text));
  return check_status(text);
}

Result<std::string> ScpiRadiometer::query(std::string_view text) {
  auto reply = session_.query(text, config_.reply_margin);
  if (!reply) return reply;
  GONIO_TRY(check_status(text));
  return reply;
}

Result<double> ScpiRadiometer::query_number(std::string_view text) {
  const auto reply = query(text);
  if (!reply) return failure(reply.error());
  const auto number = scpi::parse_number(*reply);
  if (number && number->kind == scpi::NumberKind::Finite) return number->value;
  return failure(error(ErrorCode::BadReply, fmt::format("ask \"{}\"", text), said(*reply), "a number"));
}

Result<void> ScpiRadiometer::check_status(std::string_view after) {
  const auto status = session_.status_byte();
  if (!status) return failure(status.error());
  if ((*status & usbtmc::kErrorAvailable) != 0) return fail_by_error_queue(after);
  if ((*status & usbtmc::kMessageAvailable) == 0) return {};
  session_.recover();
  return failure(
      error(ErrorCode::StaleData, fmt::format("read the status after \"{}\"", after), "a reply that nobody asked for"));
}

// Empties the queue, so that the next call's errors are its own, and tells the first entry.
Result<void> ScpiRadiometer::fail_by_error_queue(std::string_view after) {
  std::string first;
  int more = -1;
  for (int k = 0; k < kMostErrorEntries; ++k) {
    const auto reply = session_.query("SYST:ERR?", config_.reply_margin);
    if (!reply) return failure(reply.error());
    const auto entry = scpi::parse_error_entry(*reply);
    if (!entry)
      return failure(error(ErrorCode::BadReply, "ask \"SYST:ERR?\"", said(*reply), "a number and a quoted text"));
    if (entry->code == 0) break;
    if (first.empty()) first = fmt::format("{} {}", entry->code, entry->text);
    ++more;
  }
  if (first.empty()) return {};
  if (more > 0) first += fmt::format(" and {} more", more);
  return failure(error(ErrorCode::DeviceRefused, fmt::format("send \"{}\"", after), first));
}

Result<void> ScpiRadiometer::apply(const RadiometerSettings& settings) {
  const bool is_sound = settings.samples >= kFewestSamples && settings.samples <= kMostSamples &&
                        settings.averages >= 1 && settings.averages <= kMostAverages &&
                        in_nanometres(settings.wavelength) > 0.0 && (!settings.range_w || *settings.range_w > 0.0);
  if (!is_sound) {
    return failure(error(ErrorCode::InvalidInput, "apply settings",
                         fmt::format("{} samples of {} averages at {} nm", settings.samples, settings.averages,
                                     in_nanometres(settings.wavelength)),
                         fmt::format("{} to {} samples, 1 to {} averages, wavelength and range above 0", kFewestSamples,
                                     kMostSamples, kMostAverages)));
  }
  if (const auto opened = ensure_open(); !opened) return failure(opened.error());
  task_ = Task::None;
  const bool only_count_differs = settings.wavelength == settings_.wavelength &&
                                  settings.range_w == settings_.range_w && settings.averages == settings_.averages;
  if (!only_count_differs) {
    is_ready_ = false;  // until all of it has been read back
    GONIO_TRY(write_settings(settings));
    is_ready_ = true;
  }
  settings_ = settings;
  return {};
}

Result<void> ScpiRadiometer::start_zero() {
  if (const auto opened = ensure_open(); !opened) return failure(opened.error());
  task_ = Task::None;
  GONIO_TRY(command("SENS:CORR:COLL:ZERO"));
  GONIO_TRY(session_.ask("*OPC?", config_.zero_time));
  task_ = Task::Zeroing;
  return {};
}

Result<bool> ScpiRadiometer::is_zeroed(Duration wait) {
  if (task_ != Task::Zeroing) return failure(error(ErrorCode::WrongState, "look at a zero", "none was started"));
  const auto reply = session_.poll(wait);
  if (reply && !*reply) return false;
  task_ = Task::None;
  if (!reply) return failure(reply.error());
  GONIO_TRY(check_status("SENS:CORR:COLL:ZERO"));
  if (**reply != "1") return failure(error(ErrorCode::BadReply, "ask \"*OPC?\"", said(**reply), "1"));
  settled_at_ = clock_.now() + config_.range_settle;
  return true;
}

Result<void> ScpiRadiometer::trigger() {
  if (task_ == Task::Zeroing && session_.is_asking()) {
    return failure(error(ErrorCode::WrongState, "start a reading", "a zero is under way"));
  }
  if (const auto opened = ensure_open(); !opened) return failure(opened.error());
  if (session_.is_asking()) session_.recover();
  task_ = Task::None;
  const auto range = query_number("SENS:POW:RANG?");
  if (!range) return failure(range.error());
  running_ = Running{.range_w = *range, .samples = {}};
  GONIO_TRY(ask_sample());
  task_ = Task::Reading;
  return {};
}

Result<void> ScpiRadiometer::ask_sample() {
  if (running_.samples.empty()) running_.started = clock_.now();
  return session_.ask(kSample, config_.sample_time * settings_.averages + config_.reply_margin);
}

Result<std::optional<RadiometerReading>> ScpiRadiometer::collect(Duration wait) {
  if (task_ != Task::Reading) return failure(error(ErrorCode::WrongState, "fetch a reading", "none was triggered"));
  const Instant until = clock_.now() + wait;
  while (true) {
    const auto reply = session_.poll(until - clock_.now());
    if (reply && !*reply) return std::optional<RadiometerReading>();
    task_ = Task::None;  // until it is known to go on
    if (!reply) return failure(reply.error());
    GONIO_TRY(take_sample(**reply));
    if (static_cast<int>(running_.samples.size()) >= settings_.samples) {
      auto reading = finish();
      if (!reading || *reading) return reading;
    }
    GONIO_TRY(ask_sample());
    task_ = Task::Reading;
    if (clock_.now() >= until) return std::optional<RadiometerReading>();
  }
}

Result<void> ScpiRadiometer::take_sample(std::string_view reply) {
  GONIO_TRY(check_status(kSample));
  const auto sample = scpi::parse_reading(reply);
  if (!sample) {
    return failure(error(sample.error().code, fmt::format("take a sample in the range of {} W", running_.range_w),
                         sample.error().seen, "a finite number"));
  }
  // A sample counts when all of it lies behind the settling.
  if (running_.started >= settled_at_) {
    running_.samples.push_back(*sample);
    return {};
  }
  if (++running_.discarded <= kMostDiscarded) return {};
  return failure(error(ErrorCode::TimedOut, "wait until the range has settled",
                       fmt::format("{} samples thrown away", kMostDiscarded),
                       fmt::format("{:.3f} s", in_seconds(config_.range_settle))));
}

// Nothing: the meter has changed its range meanwhile, and the reading begins anew.
Result<std::optional<RadiometerReading>> ScpiRadiometer::finish() {
  const auto range = query_number("SENS:POW:RANG?");
  if (!range) return failure(range.error());
  if (*range != running_.range_w) {
    if (++running_.restarts > kMostRestarts) {
      return failure(error(ErrorCode::OutOfTolerance, "take a reading in one range",
                           fmt::format("{} changes of range, now {} W", running_.restarts, *range),
                           fmt::format("{} changes", kMostRestarts)));
    }
    running_.range_w = *range;
    running_.samples.clear();
    settled_at_ = clock_.now() + config_.range_settle;
    return std::optional<RadiometerReading>();
  }
  RadiometerReading reading = reading_of(running_.samples);
  reading.range_w = *range;
  reading.started = running_.started;
  reading.ended = clock_.now();
  return std::optional<RadiometerReading>(reading);
}

}  // namespace gonio::drivers
