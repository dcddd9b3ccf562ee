// A reading by hand: shutters, detector, one frame, shutters back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/planner/exposure_ladder.h"
#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {
namespace {

constexpr Duration kUsualExposure = std::chrono::seconds(1);

Error refused_reading(ErrorCode code, std::string seen, std::string limit) {
  return {.code = code,
          .device = "detector",
          .tried = "read it by hand",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

std::string ranges_text(const PowerDetectorConfig& power) {
  return fmt::format("one of {} W", fmt::join(power.ranges_w, ", "));
}

bool has_range(const PowerDetectorConfig& power, double range_w) {
  return std::ranges::find(power.ranges_w, range_w) != power.ranges_w.end();
}

// Of the filter that stands in the light; between two slots, of the first.
Wavelength wavelength_in(const Instrument& instrument, const drivers::StageState& state) {
  const auto slot =
      static_cast<int>(std::lround(drivers::positions_of(state)[stage::index_of(stage::Axis::FilterWheel)]));
  const auto found = std::ranges::find(instrument.filters, slot, &Filter::slot);
  return found != instrument.filters.end() ? found->centroid : instrument.filters.front().centroid;
}

bool is_open(stage::ShutterState shutter) {
  return shutter == stage::ShutterState::Open;
}

}  // namespace

Result<void> Sequencer::Impl::check_reading(const ReadDetector& read) const {
  const DetectorConfig& detector = config.instrument.detector;
  if (detector.power) {
    if (read.exposure) {
      return failure(refused_reading(ErrorCode::InvalidInput, "an exposure", "a radiometer has ranges instead"));
    }
    if (!read.range_w || has_range(*detector.power, *read.range_w)) return {};
    return failure(refused_reading(ErrorCode::OutOfLimits, fmt::format("range {} W", *read.range_w),
                                   ranges_text(*detector.power)));
  }
  if (read.range_w)
    return failure(refused_reading(ErrorCode::InvalidInput, "a range", "a camera has exposures instead"));
  if (!read.exposure) return {};
  if (*read.exposure >= detector.shortest_exposure && *read.exposure <= detector.longest_exposure) return {};
  return failure(refused_reading(
      ErrorCode::OutOfLimits, fmt::format("exposure {} s", in_seconds(*read.exposure)),
      fmt::format("{} to {} s", in_seconds(detector.shortest_exposure), in_seconds(detector.longest_exposure))));
}

void Sequencer::Impl::run_verb(const Command& c, const ReadDetector& read, Instant now) {
  if (const auto checked = check_reading(read); !checked) return reply(c.id, failure(checked.error()));
  take_by_hand(c, now);
}

void Sequencer::Impl::begin_hand_reading(const drivers::StageState& state) {
  const auto& read = std::get<ReadDetector>(by_hand->verb);
  const DetectorConfig& detector = config.instrument.detector;
  ReadingByHand reading{.source_was_open = is_open(state.source_shutter),
                        .detector_was_open = is_open(state.detector_shutter)};
  reading.source_open = read.lit.value_or(false) || reading.source_was_open;
  reading.detector_open = read.lit.value_or(reading.detector_was_open);
  const std::vector<Duration> ladder = exposure_ladder(detector, kUsualExposure);
  reading.exposure = read.exposure.value_or(ladder[ladder.size() / 2]);
  if (detector.power) {
    reading.power = PowerSettings{.range_w = read.range_w.value_or(detector.power->ranges_w.front()),
                                  .wavelength = wavelength_in(config.instrument, state)};
  }
  hand_reading = reading;
  if (!reading.moves_shutters()) return ask_detector(DetectorUse::HandPrepare, PrepareDetector{});
  ask_stage(StageUse::HandShutters, MoveTo{.epoch = epoch,
                                           .target = {},
                                           .source_shutter_open = reading.source_open,
                                           .detector_shutter_open = reading.detector_open});
}

void Sequencer::Impl::on_hand_shutters(const Result<drivers::StageState>& state) {
  if (!state) return end_hand_reading(failure(state.error()));
  ask_detector(DetectorUse::HandPrepare, PrepareDetector{});
}

void Sequencer::Impl::on_hand_prepared(const Result<drivers::DetectorIdentity>& detector) {
  if (!detector) return end_hand_reading(failure(detector.error()));
  hand_reading->detector = *detector;
  ask_detector(DetectorUse::HandFrame, TakeFrame{.settings = {.exposure = hand_reading->exposure,
                                                              .gain_db = config.instrument.detector.gain_db},
                                                 .power = hand_reading->power});
}

void Sequencer::Impl::on_hand_frame(const Result<FrameSummary>& frame) {
  if (!frame) return end_hand_reading(failure(frame.error()));
  end_hand_reading(CommandDone{.reading = hand_reading_of(*frame)});
}

HandReading Sequencer::Impl::hand_reading_of(const FrameSummary& frame) const {
  HandReading seen{.detector = hand_reading->detector,
                   .is_power = hand_reading->power.has_value(),
                   .saturated = frame.region.saturated,
                   .exposure = frame.settings.exposure,
                   .gain_db = frame.settings.gain_db,
                   .temperature_c = frame.temperature_c,
                   .source_shutter_open = hand_reading->source_open,
                   .detector_shutter_open = hand_reading->detector_open};
  if (!seen.is_power) {
    seen.value = frame.region.mean;
    seen.noise = std::sqrt(frame.region.m2);
    seen.values = frame.region.n;
    seen.full_scale = config.instrument.model.detector.full_scale_dn;
    return seen;
  }
  seen.full_scale = hand_reading->power->range_w;
  seen.wavelength = hand_reading->power->wavelength;
  if (!frame.power) return seen;  // an overload
  const calibration::PowerReading& power = frame.power->reading;
  seen.value = power.mean_w;
  seen.noise = power.standard_error_w * std::sqrt(static_cast<double>(power.samples));
  seen.values = power.samples;
  seen.exposure = frame.power->ended - frame.power->started;
  return seen;
}

// The reading's outcome waits until the shutters stand as they stood.
void Sequencer::Impl::end_hand_reading(Result<CommandDone> result) {
  if (!hand_reading->moves_shutters()) {
    hand_reading.reset();
    return end_by_hand(std::move(result));
  }
  hand_reading->result = std::move(result);
  ask_stage(StageUse::HandShuttersBack, MoveTo{.epoch = epoch,
                                               .target = {},
                                               .source_shutter_open = hand_reading->source_was_open,
                                               .detector_shutter_open = hand_reading->detector_was_open});
}

void Sequencer::Impl::on_hand_shutters_back(const Result<drivers::StageState>& state) {
  Result<CommandDone> result = *std::move(std::exchange(hand_reading, std::nullopt)->result);
  if (!state && result) result = failure(state.error());
  end_by_hand(std::move(result));
}

}  // namespace gonio::daemon
