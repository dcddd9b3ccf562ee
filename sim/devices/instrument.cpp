#include "sim/devices/instrument.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gonio::sim {

using stage::Axis;

namespace {

// Gauss-Legendre with 4 nodes on [-1, 1] (Abramowitz and Stegun 1964, table 25.4).
constexpr std::array<double, 4> kNodes{-0.861136311594053, -0.339981043584856, 0.339981043584856, 0.861136311594053};
constexpr std::array<double, 4> kWeights{0.347854845137454, 0.652145154862546, 0.652145154862546, 0.347854845137454};

bool is_open(const ShutterModel& shutter, Instant t) {
  return shutter.state(t) == stage::ShutterState::Open;
}

ExposedPlace place_of(const LightPath& path, const StagePose& pose) {
  const auto rounded = [&](Axis axis) {
    return static_cast<std::int32_t>(std::lround(pose.positions[stage::index_of(axis)] * 100.0));
  };
  return {.station = path.station(pose.positions[stage::index_of(Axis::Carriage)]),
          .centidegrees = {rounded(Axis::ThetaI), rounded(Axis::ThetaR), rounded(Axis::PhiR)},
          .is_lit = pose.source_open && pose.detector_open};
}

}  // namespace

Instrument::Instrument(Scene scene, InstrumentMemory memory, Instant power_up)
    : scene_(std::move(scene)),
      truth_(scene_),
      lamp_(scene_),
      light_path_(scene_, truth_),
      charge_(scene_, truth_),
      stage_(scene_.stage, scene_.time_scale, memory.stage, power_up),
      faults_(scene_.faults),
      power_up_(power_up),
      now_(power_up),
      memory_(std::move(memory)) {}

double Instrument::scene_time_s(Instant t) const {
  return memory_.scene_time_s + scene_.scene_seconds(t - power_up_);
}

std::optional<Instant> Instrument::next_event() const {
  std::optional<Instant> next = stage_.next_event();
  const auto consider = [&next](const std::optional<Running>& run) {
    if (run) next = std::min(next.value_or(run->close), run->close);
  };
  consider(running_);
  for (const Collector& collector : collectors_) consider(collector.running);
  if (const auto act = next_act()) next = std::min(next.value_or(*act), *act);
  return next;
}

void Instrument::advance_to(Instant now) {
  now_ = std::max(now_, now);
  // What happens at an instant changes the motion after it: the light up to there belongs to the motion before.
  for (auto due = next_event(); due && *due <= now_; due = next_event()) {
    integrate_to(*due);
    stage_.advance_to(*due);
    act_on_faults(*due);
    if (running_ && running_->close <= *due) finish_exposure();
    for (Collector& collector : collectors_) {
      if (collector.running && collector.running->close <= *due) finish_collection(collector);
    }
  }
  integrate_to(now_);
}

void Instrument::power_cycle_stage(Instant now) {
  advance_to(now);
  reboot_stage(now_);
}

void Instrument::reboot_stage(Instant now) {
  stage_ = StageModel(scene_.stage, scene_.time_scale, stage_.memory(now), now);
}

bool Instrument::start_exposure(Duration duration, double gain_db, Instant now) {
  assert(duration > Duration::zero());
  advance_to(now);
  if (running_) return false;
  stage_.open_gate(now_);
  const StagePose here = pose(now_);
  const ExposedPlace place = place_of(light_path_, here);
  ++memory_.exposures;
  if (place.is_lit) ++memory_.lit_exposures;
  ++memory_.places[place];
  if (witness_) witness_({memory_.exposures, place, stage_.memory(now_), scene_time_s(now_)});
  running_ = Running{.open = now_,
                     .close = now_ + duration,
                     .integrated_to = now_,
                     .gain_db = gain_db,
                     .place = light_path_.place(here)};
  note_exposure(now_, now_ + duration);
  return true;
}

std::optional<Instant> Instrument::exposure_end() const {
  return running_ ? std::optional<Instant>(running_->close) : std::nullopt;
}

std::optional<Exposure> Instrument::take_exposure(Instant now) {
  advance_to(now);
  return std::exchange(finished_, std::nullopt);
}

std::size_t Instrument::add_collector() {
  collectors_.emplace_back();
  return collectors_.size() - 1;
}

void Instrument::start_collection(std::size_t collector, Duration duration, Instant now) {
  assert(duration > Duration::zero());
  advance_to(now);
  collectors_[collector] = {.running = Running{.open = now_, .close = now_ + duration, .integrated_to = now_},
                            .finished = std::nullopt};
}

std::optional<Instant> Instrument::collection_end(std::size_t collector) const {
  const Collector& c = collectors_[collector];
  if (c.running) return c.running->close;
  return c.finished ? std::optional<Instant>(c.finished->close) : std::nullopt;
}

void Instrument::drop_collection(std::size_t collector) {
  collectors_[collector] = {};
}

std::optional<LightCollection> Instrument::take_collection(std::size_t collector, Instant now) {
  advance_to(now);
  return std::exchange(collectors_[collector].finished, std::nullopt);
}

void Instrument::integrate_to(Instant t) {
  if (running_) integrate(*running_, t);
  for (Collector& collector : collectors_) {
    if (collector.running) integrate(*collector.running, t);
  }
}

void Instrument::integrate(Running& run, Instant t) const {
  const Instant to = std::min(t, run.close);
  // Within a stretch the shutters do not change: cut it where one arrives.
  std::array<Instant, 3> cuts{stage_.source_shutter().done, stage_.detector_shutter().done, to};
  std::ranges::sort(cuts);
  for (const Instant cut : cuts) {
    if (cut <= run.integrated_to || cut > to) continue;
    run.light += light_integral(run.integrated_to, cut);
    run.integrated_to = cut;
  }
}

LightRate Instrument::light_integral(Instant from, Instant to) const {
  const double length_s = scene_.scene_seconds(to - from);
  StagePose at = pose(from);
  if (!at.detector_open) return {};
  if (!at.source_open || !stage_.is_moving(from)) return light_path_.rate(at) * length_s;
  constexpr int kPanels = 32;
  const auto step = (to - from) / (2.0 * kPanels);  // half a panel
  LightRate sum;
  for (int panel = 0; panel < kPanels; ++panel) {
    for (std::size_t k = 0; k < kNodes.size(); ++k) {
      const auto after = std::chrono::duration_cast<Duration>(step * (2 * panel + 1 + kNodes[k]));
      const StagePose then = pose(from + after);
      at.positions = then.positions;
      at.lags = then.lags;
      sum += light_path_.rate(at) * kWeights[k];
    }
  }
  return sum * (length_s / (2.0 * kPanels));
}

void Instrument::finish_exposure() {
  const Running run = *running_;
  running_.reset();
  const double from_s = scene_time_s(run.open);
  const double to_s = scene_time_s(run.close);
  stage_.close_gate(run.close, lamp_faults_.shown(lamp_.monitor(from_s, to_s, memory_.exposures), from_s, to_s));
  Exposure exposure =
      charge_.collect(run.light, lamp_.mean(from_s, to_s) * lamp_faults_.mean(from_s, to_s), from_s, to_s - from_s);
  exposure.number = memory_.exposures;
  exposure.open = run.open;
  exposure.close = run.close;
  exposure.gain_db = run.gain_db;
  exposure.place = run.place;
  finished_ = exposure;
}

void Instrument::finish_collection(Collector& collector) {
  const Running run = *std::exchange(collector.running, std::nullopt);
  const double from_s = scene_time_s(run.open);
  const double to_s = scene_time_s(run.close);
  const double lamp = lamp_.mean(from_s, to_s) * lamp_faults_.mean(from_s, to_s);
  const FilterSpec* filter = light_path_.filter_at(pose(run.close).positions[stage::index_of(Axis::FilterWheel)]);
  collector.finished =
      LightCollection{.open = run.open,
                      .close = run.close,
                      .light = (run.light.target * lamp + run.light.veil * lamp + run.light.ambient) /
                               (scene_.detector.electrons_per_s * (to_s - from_s)),
                      .lamp = lamp_.monitored(from_s, to_s),
                      .wavelength = filter == nullptr ? std::nullopt : std::optional<Wavelength>(filter->centroid)};
}

StagePose Instrument::pose(Instant t) const {
  StagePose pose{.last_move = stage_.moves(),
                 .source_open = is_open(stage_.source_shutter(), t),
                 .detector_open = is_open(stage_.detector_shutter(), t)};
  for (const Axis a : stage::kAllAxes) {
    pose.positions[stage::index_of(a)] = stage_.axis(a).position(t);
    pose.lags[stage::index_of(a)] = stage_.axis(a).lag(t);
    pose.last_moves[stage::index_of(a)] = stage_.axis(a).last_move();
  }
  return pose;
}

InstrumentMemory Instrument::memory(Instant now) const {
  InstrumentMemory memory = memory_;
  memory.stage = stage_.memory(now);
  memory.scene_time_s = scene_time_s(now);
  return memory;
}

}  // namespace gonio::sim
