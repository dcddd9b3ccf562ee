#include "tests/daemon/sequencer/scan_rig.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/planner/estimate.h"

namespace gonio::daemon::test {

namespace {

using stage::Axis;
using std::chrono::milliseconds;

constexpr Duration kWire = std::chrono::microseconds(200);

}  // namespace

ScanRig::ScanRig(Instrument instrument, std::optional<std::string> store_path)
    : instrument_(std::move(instrument)), path_(store_path.value_or(folder_.file("store.sqlite"))) {
  world.stage.homed = true;
  world.stage.boot_counter = 3;
  start();
}

void ScanRig::start() {
  const auto started = try_start();
  ASSERT_TRUE(started) << describe(started.error());
}

Result<void> ScanRig::try_start() {
  auto writer = StoreWriter::open({.path = path_, .boot_id = "boot", .version = "test"}, wall_clock_);
  if (!writer) return failure(writer.error());
  writer_ = std::move(*writer);
  store_.emplace(*writer_);
  sequencer_.emplace(SequencerConfig{.instrument = instrument_}, clock_.now());
  collect();
  return {};
}

void ScanRig::kill() {
  agenda_.clear();
  watched_.reset();
  open_move_.reset();
  sequencer_.reset();
  store_.reset();
  writer_.reset();
}

void ScanRig::after(Duration delay, Action action) {
  agenda_.emplace(clock_.now() + delay, std::move(action));
}

void ScanRig::tell(Duration delay, SequencerMessage message) {
  after(delay, [this, message = std::move(message)] { sequencer_->on(message, clock_.now()); });
}

void ScanRig::collect() {
  for (CommandReply& reply : sequencer_->take_replies()) replies.push_back(std::move(reply));
  for (Request& request : sequencer_->take_requests()) {
    after(Duration::zero(), [this, request = std::move(request)] { execute(request); });
  }
}

bool ScanRig::step() {
  const std::optional<Instant> wake = sequencer_->step(clock_.now());
  collect();
  if (agenda_.empty()) {
    if (!wake) return false;
    clock_.advance_to(*wake);
    return true;
  }
  if (wake && *wake < agenda_.begin()->first) {
    clock_.advance_to(*wake);
    return true;
  }
  auto next = agenda_.extract(agenda_.begin());
  clock_.advance_to(next.key());
  next.mapped()();
  collect();
  return true;
}

bool ScanRig::run_until(const std::function<bool()>& reached) {
  constexpr int kMostSteps = 100'000;
  for (int steps = 0; steps < kMostSteps; ++steps) {
    if (reached()) return true;
    if (!step()) return reached();
  }
  ADD_FAILURE() << "no end after " << kMostSteps << " steps; doing: " << status().doing;
  return false;
}

CommandId ScanRig::command(Verb verb, const std::string& who) {
  sequencer_->on(Command{.id = ++last_command_, .who = who, .verb = std::move(verb)}, clock_.now());
  collect();
  return last_command_;
}

const CommandReply* ScanRig::reply_to(CommandId id) const {
  const auto found = std::find_if(replies.begin(), replies.end(), [id](const auto& r) { return r.id == id; });
  return found == replies.end() ? nullptr : &*found;
}

ScanId ScanRig::submit(const api::Plan& plan) {
  const CommandId id = command(SubmitScan{new_scan(plan)});
  EXPECT_TRUE(run_until([&] { return reply_to(id) != nullptr; }));
  const auto& result = reply_to(id)->result;
  EXPECT_TRUE(result) << describe(result.error());
  return result ? result->scan : 0;
}

void ScanRig::stop() {
  world.stage.halted = true;
  ++world.stage.epoch;
  world.moving_until = std::min(world.moving_until, clock_.now());
  if (open_move_) {
    // The answer of the move that was under way is replaced: the stage did not arrive.
    tell(kWire, StageAnswer{.ticket = *std::exchange(open_move_, std::nullopt),
                            .state = failure(Error{.code = ErrorCode::Stopped, .device = "stage", .tried = "move"})});
  }
  sequencer_->on(StopHappened{.epoch = world.stage.epoch, .who = "uid:7"}, clock_.now());
  collect();
}

void ScanRig::watch_for(Duration time) {
  const Instant end = clock_.now() + time;
  while (clock_.now() < end) {
    const Instant next = clock_.now() + std::chrono::seconds(1);
    after(std::chrono::seconds(1),
          [this] { sequencer_->on(StageAnswer{.ticket = kWatchTicket, .state = look()}, clock_.now()); });
    run_until([&] { return clock_.now() >= next; });
  }
}

void ScanRig::tell_disk(std::int64_t free_bytes) {
  sequencer_->on(DiskSeen{.free_bytes = free_bytes}, clock_.now());
  collect();
}

ScanInfo ScanRig::info(ScanId id) {
  auto reader = StoreReader::open(path_);
  if (!reader) return {};
  return (*reader)->scan(id).value_or(ScanInfo{});
}

ScanState ScanRig::state_of(ScanId id) {
  return info(id).state;
}

std::int64_t ScanRig::count(const std::string& query) {
  SQLite::Database database(path_, SQLite::OPEN_READONLY);
  return database.execAndGet(query).getInt64();
}

// ---- the other side ----

namespace {

// In the order of the variants.
std::string name_of(const Request& request) {
  constexpr std::array<const char*, 5> kStage{"move", "home", "reset", "look", "gate"};
  constexpr std::array<const char*, 3> kDetector{"frame", "prepare", "zero"};
  constexpr std::array<const char*, 2> kMonitor{"monitor", "prepare monitor"};
  constexpr std::array<const char*, 2> kStore{"commit", "load"};
  if (const auto* to_stage = std::get_if<StageRequest>(&request)) return kStage[to_stage->index()];
  if (const auto* to_detector = std::get_if<DetectorRequest>(&request)) return kDetector[to_detector->index()];
  if (const auto* to_monitor = std::get_if<MonitorRequest>(&request)) return kMonitor[to_monitor->index()];
  return kStore[std::get<StoreRequest>(request).index()];
}

}  // namespace

void ScanRig::execute(const Request& request) {
  asked = name_of(request);
  if (const auto* to_stage = std::get_if<StageRequest>(&request)) return execute_stage(*to_stage);
  if (const auto* to_detector = std::get_if<DetectorRequest>(&request)) return execute_detector(*to_detector);
  if (const auto* to_monitor = std::get_if<MonitorRequest>(&request)) return execute_monitor(*to_monitor);
  execute_store(std::get<StoreRequest>(request));
}

void ScanRig::execute_store(const StoreRequest& request) {
  const auto* commit = std::get_if<Commit>(&request);
  if (commit != nullptr && refuse_commits) {
    const Error full{.code = ErrorCode::DiskFull, .device = "store", .tried = "commit", .seen = "no space"};
    return tell(kWire, CommitAnswer{.ticket = commit->ticket, .receipt = failure(full)});
  }
  const StoreActor::Answer answer = store_->on(request, clock_.now());
  if (const auto* committed = std::get_if<CommitAnswer>(&answer)) {
    if (committed->receipt && on_event) {
      std::ranges::for_each(committed->receipt->events, on_event);
    } else if (committed->receipt) {
      events.insert(events.end(), committed->receipt->events.begin(), committed->receipt->events.end());
    }
    return tell(milliseconds(1), *committed);
  }
  tell(milliseconds(1), std::get<UnfinishedAnswer>(answer));
}

drivers::StageState ScanRig::look() {
  world.stage.at = clock_.now();
  for (auto& axis : world.stage.axes) axis.counts = static_cast<std::int32_t>(std::lround(axis.position * 10'000.0));
  world.stage.monitor = world.monitor;
  world.stage.moving = clock_.now() < world.moving_until;
  world.stage.gate.open = clock_.now() < world.gate_open_until;
  return world.stage;
}

void ScanRig::execute_stage(const StageRequest& request) {
  if (const auto* to = std::get_if<MoveTo>(&request)) return move(*to);
  if (const auto* watch = std::get_if<WatchGate>(&request)) {
    EXPECT_FALSE(watched_) << "one stage request at a time";
    watched_ = *watch;
    return;
  }
  if (const auto* homing = std::get_if<Home>(&request)) {
    world.stage.homed = true;
    return after(std::chrono::seconds(3), [this, ticket = homing->ticket] {
      sequencer_->on(StageAnswer{.ticket = ticket, .state = look()}, clock_.now());
    });
  }
  if (const auto* reset = std::get_if<ResetStage>(&request)) {
    if (reset->epoch >= world.stage.epoch) {
      world.stage.halted = false;
      world.stage.heartbeat_tripped = false;
    }
    return tell(kWire, StageAnswer{.ticket = reset->ticket, .state = look()});
  }
  tell(kWire, StageAnswer{.ticket = std::get<LookAtStage>(request).ticket, .state = look()});
}

void ScanRig::move(const MoveTo& to) {
  const auto refuse = [&](ErrorCode code, std::string seen) {
    tell(kWire, StageAnswer{.ticket = to.ticket,
                            .state = failure(Error{.code = code, .device = "stage", .tried = "move", .seen = seen})});
  };
  if (const auto error = world.move_error(to)) return refuse(error->code, error->seen);
  const bool has_axes = std::any_of(to.target.begin(), to.target.end(), [](const auto& t) { return t.has_value(); });
  if (has_axes && world.stage.halted) return refuse(ErrorCode::Stopped, "halted");
  if (has_axes && to.epoch < world.stage.epoch) return refuse(ErrorCode::StaleEpoch, "epoch");
  if (has_axes && look().moving) return refuse(ErrorCode::DeviceRefused, "already moving");
  if (has_axes && !world.stage.homed) return refuse(ErrorCode::NotHomed, "not homed");
  if (has_axes) {
    EXPECT_GE(clock_.now(), world.gate_open_until) << "a move while light is taken";
    world.moves_beside_a_frame += clock_.now() < world.frame_due ? 1 : 0;
  }
  if (to.source_shutter_open) {
    world.stage.source_shutter = *to.source_shutter_open ? stage::ShutterState::Open : stage::ShutterState::Closed;
  }
  if (to.detector_shutter_open) {
    world.stage.detector_shutter = *to.detector_shutter_open ? stage::ShutterState::Open : stage::ShutterState::Closed;
  }
  stage::PerAxis<double> from{};
  for (std::size_t a = 0; a < from.size(); ++a) from[a] = world.stage.axes[a].position;
  const StepTime time = step_time(instrument_, from, to.target).value_or(StepTime{});
  for (std::size_t a = 0; a < from.size(); ++a) world.stage.axes[a].position = to.target[a].value_or(from[a]);
  world.moving_until = clock_.now() + time.move;
  open_move_ = to.ticket;
  after(time.move + time.settle + kWire, [this, ticket = to.ticket] {
    if (open_move_ != ticket) return;  // stopped meanwhile
    open_move_.reset();
    sequencer_->on(StageAnswer{.ticket = ticket, .state = look()}, clock_.now());
  });
}

void ScanRig::execute_detector(const DetectorRequest& request) {
  if (const auto* take = std::get_if<TakeFrame>(&request)) return take->power ? take_power(*take) : take_frame(*take);
  if (const auto* at_zero = std::get_if<ZeroDetector>(&request)) return zero(*at_zero);
  const Ticket ticket = std::get<PrepareDetector>(request).ticket;
  if (const auto error = world.camera_open_error()) return tell(kWire, DetectorAnswer{ticket, failure(*error)});
  tell(kWire, DetectorAnswer{ticket, drivers::DetectorIdentity{.vendor = "test"}});
}

void ScanRig::zero(const ZeroDetector& request) {
  ++world.zeros;
  world.zeroed_in_the_dark = world.stage.detector_shutter == stage::ShutterState::Closed;
  tell(milliseconds(500), DetectorAnswer{request.ticket, drivers::DetectorIdentity{.vendor = "test"}});
}

// One pixel in parts of the range; 1.1 of it is an overload.
void ScanRig::take_power(const TakeFrame& take) {
  EXPECT_FALSE(watched_) << "no camera gates the stage";
  const double theta_r = world.stage.axes[stage::index_of(Axis::ThetaR)].position;
  const bool is_reference = world.stage.axes[stage::index_of(Axis::Carriage)].position > 60.0;
  const bool is_lit = world.stage.detector_shutter == stage::ShutterState::Open;
  const double watts = world.zero_w + (is_lit ? world.power_w(theta_r, is_reference) * world.gain(clock_.now()) : 0.0);
  ++world.exposures;
  const double share = watts / take.power->range_w;
  FrameSummary frame;
  frame.settings = take.settings;
  frame.region = {.n = 1, .mean = share, .saturated = share > 1.1 ? 1U : 0U};
  const Instant start = clock_.now();
  if (share <= 1.1) {
    frame.power = PowerRecord{.reading = {.mean_w = watts,
                                          .standard_error_w = 1e-9,
                                          .samples = 10,
                                          .averages = 1,
                                          .range_w = take.power->range_w,
                                          .wavelength = take.power->wavelength},
                              .started = start,
                              .ended = start + take.settings.exposure};
  }
  world.during_reading();
  if (const auto error = world.frame_error()) return tell(milliseconds(5), FrameAnswer{take.ticket, failure(*error)});
  tell(take.settings.exposure + milliseconds(2), FrameAnswer{take.ticket, frame});
}

void ScanRig::execute_monitor(const MonitorRequest& request) {
  if (const auto* prepare = std::get_if<PrepareMonitor>(&request)) {
    return tell(kWire, MonitorReady{prepare->ticket, drivers::DetectorIdentity{.vendor = "test"}});
  }
  const auto& take = std::get<TakeMonitor>(request);
  ++world.monitor_readings;
  if (const auto error = world.monitor_error()) return tell(kWire, MonitorAnswer{take.ticket, failure(*error)});
  const PowerRecord reading{.reading = {.mean_w = world.monitor_w,
                                        .standard_error_w = 1e-7,
                                        .samples = 8,
                                        .averages = 1,
                                        .range_w = 1e-2,
                                        .wavelength = nanometres(568.0)},
                            .started = clock_.now(),
                            .ended = clock_.now() + take.window};
  tell(take.window + milliseconds(3), MonitorAnswer{take.ticket, reading});
}

FrameSummary ScanRig::frame_of(const drivers::ExposureSettings& settings) {
  const double theta_r = world.stage.axes[stage::index_of(Axis::ThetaR)].position;
  const double carriage = world.stage.axes[stage::index_of(Axis::Carriage)].position;
  const bool is_reference = carriage > 60.0;
  const bool is_lit = world.stage.detector_shutter == stage::ShutterState::Open;
  const double t = in_seconds(settings.exposure);
  const double level =
      world.dark_dn + (is_lit ? world.rate_dn_per_s(theta_r, is_reference) * world.gain(clock_.now()) * t : 0.0);
  if (is_lit) {
    const auto key = static_cast<std::int32_t>(std::lround(theta_r));
    ++world.exposed_at[{key, is_reference ? calibration::Target::Reference : calibration::Target::Sample}];
  }
  FrameSummary frame;
  frame.region = {.n = 450, .mean = std::min(level, 4095.0), .m2 = 4.0, .saturated = level > 4095.0 ? 450U : 0U};
  frame.settings = settings;
  frame.frame_id = static_cast<std::uint64_t>(world.exposures);
  return frame;
}

void ScanRig::take_frame(const TakeFrame& take) {
  if (const auto error = world.frame_error()) {
    tell(world.frame_error_after, FrameAnswer{take.ticket, failure(*error)});
    if (!watched_) return;
    const Error late{.code = ErrorCode::TimedOut, .device = "stage", .tried = "watch the gate"};
    return tell(milliseconds(500), StageAnswer{std::exchange(watched_, std::nullopt)->ticket, failure(late)});
  }
  const bool is_by_hand = sequencer_->status(clock_.now()).doing == "read by hand";
  EXPECT_NE(watched_.has_value(), is_by_hand) << "a scan's frame has its gate";
  EXPECT_GE(clock_.now(), world.gate_open_until) << "an exposure within an exposure";
  ++world.exposures;
  ++world.stage.gate.count;
  world.stage.gate.monitor_mean = world.monitor;
  world.stage.gate.monitor_samples = 10;
  for (std::size_t a = 0; a < stage::kAxisCount; ++a) {
    const auto counts = static_cast<std::int32_t>(std::lround(world.stage.axes[a].position * 10'000.0));
    world.stage.gate.open_counts[a] = counts;
    world.stage.gate.close_counts[a] = counts;
  }
  world.gate_open_until = clock_.now() + take.settings.exposure;
  world.frame_due = world.gate_open_until + world.frame_takes;
  const FrameSummary frame = frame_of(take.settings);
  if (take.sums) {
    const std::vector<std::uint16_t> pixels(64, static_cast<std::uint16_t>(frame.region.mean));
    const auto added = calibration::add_frame(*take.sums,
                                              {.pixels = pixels,
                                               .width = 8,
                                               .height = 8,
                                               .exposure = take.settings.exposure,
                                               .gain_db = take.settings.gain_db},
                                              {.centre_x_px = 4.0, .centre_y_px = 4.0, .radius_px = 2.0});
    EXPECT_TRUE(added) << describe(added.error());
  }
  tell(take.settings.exposure + world.frame_takes, FrameAnswer{take.ticket, frame});
  if (!watched_) return;
  after(take.settings.exposure + milliseconds(1), [this, watch = *std::exchange(watched_, std::nullopt)] {
    sequencer_->on(StageAnswer{.ticket = watch.ticket, .state = look()}, clock_.now());
  });
}

api::Plan map_plan() {
  api::Plan plan = bench_plan({30}, {10, 20}, {90});
  plan.target_snr = 200;
  plan.max_time = milliseconds(2);
  plan.exposures = {milliseconds(1)};
  plan.calibration = api::PlanCalibration{.job = api::CalibrationJob::FlatField, .frames = 3};
  return plan;
}

void expect_sums_of_whole_readings(ScanRig& rig, ScanId id) {
  const std::string readings =
      "(SELECT r.attempt_id, r.visit_id, exposure_ns, sum(used) AS frames FROM reading r LEFT JOIN attempt a ON "
      "a.attempt_id = r.attempt_id WHERE r.visit_id IS NOT NULL OR (outcome = 'accepted' AND target = 'reference') "
      "GROUP BY r.attempt_id, r.visit_id, exposure_ns)";
  EXPECT_GE(rig.count("SELECT count(*) FROM pixel_sum WHERE attempt_id IS NOT NULL"), 2);
  EXPECT_GE(rig.count("SELECT count(*) FROM pixel_sum WHERE visit_id IS NOT NULL"), 2);
  EXPECT_EQ(rig.count("SELECT count(*) FROM pixel_sum"), rig.count("SELECT count(*) FROM " + readings));
  EXPECT_EQ(rig.count("SELECT count(*) FROM pixel_sum p JOIN " + readings +
                      " r ON p.attempt_id IS r.attempt_id AND p.visit_id IS r.visit_id AND p.exposure_ns = "
                      "r.exposure_ns AND p.frames = r.frames"),
            rig.count("SELECT count(*) FROM pixel_sum"));
  const auto stacks = StoreReader::open(rig.store_path()).value()->pixel_stacks(id);
  ASSERT_TRUE(stacks) << describe(stacks.error());
  for (const calibration::PixelStack& dark : stacks->dark) EXPECT_EQ(dark.mean(0), 100.0);
  ASSERT_EQ(stacks->lit.size(), 1U);
  EXPECT_EQ(stacks->lit[0].mean(0), 400.0) << "100 DN and 300 000 DN/s for 1 ms";
}

}  // namespace gonio::daemon::test
