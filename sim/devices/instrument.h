#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "sim/devices/detector_charge.h"
#include "sim/devices/detector_noise.h"
#include "sim/devices/stage_model.h"
#include "sim/faults/fault_desk.h"
#include "sim/faults/lamp_faults.h"
#include "sim/optics/lamp.h"
#include "sim/optics/light_path.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// A place where the stage was when an exposure began: the station, and the three angles in hundredths of a degree.
struct ExposedPlace {
  Station station = Station::Between;
  std::array<std::int32_t, 3> centidegrees{};  ///< theta_i, theta_r, phi_r
  bool is_lit = false;                         ///< both shutters were open
  friend auto operator<=>(const ExposedPlace&, const ExposedPlace&) = default;
};

/// What fell on a radiometer over a stretch of time, relative to a surface with REFF cos(theta_i) = 1, no filter and
/// lamp power 1.
struct LightCollection {
  Instant open{};
  Instant close{};
  double light = 0.0;  ///< mean over the stretch, on the detector's side: sample, filter, shutters, lamp
  double lamp = 0.0;   ///< mean of the lamp alone, as a monitor beside it sees it
  std::optional<Wavelength> wavelength;  ///< of the filter that stands in the light at the end
};

/// An exposure that begins, for whoever keeps count.
struct ExposureNote {
  std::uint64_t number = 0;  ///< from 1, over all runs
  ExposedPlace place;
  StageMemory stage;
  double scene_time_s = 0.0;
};

/// What the instrument keeps from one run of the simulator to the next.
struct InstrumentMemory {
  StageMemory stage;
  std::uint64_t exposures = 0;
  std::uint64_t lit_exposures = 0;
  double scene_time_s = 0.0;
  std::map<ExposedPlace, std::uint64_t> places;  ///< exposures by place
};

/// Stage, lamp, sample and detector on one bench, without wires. The camera's exposure-active line goes to the stage,
/// and the light of an exposure is integrated over the arms' motion in closed form. Wall time as argument; a call with
/// an earlier time than the one before is taken as at that one. Copies nothing, allocates little. Threads: one at a
/// time.
class Instrument {
 public:
  Instrument(Scene scene, InstrumentMemory memory, Instant power_up);
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  /// Lets everything happen that is due, in its order.
  void advance_to(Instant now);
  /// When something happens by itself next.
  [[nodiscard]] std::optional<Instant> next_event() const;

  /// For commands: `advance_to` their instant first.
  [[nodiscard]] StageModel& stage() { return stage_; }
  [[nodiscard]] const StageModel& stage() const { return stage_; }

  // ---- faults (instrument_faults.cpp) ----

  /// False: too many are armed. What waits for nothing comes at once.
  [[nodiscard]] bool arm(const PlannedFault& fault, Instant now);
  /// What of this kind is armed or stands is over.
  void end_fault(FaultKind kind, Instant now);
  /// A moment on a wire: what strikes there. `is_meant` as FaultDesk::strike has it.
  template <class Predicate>
  [[nodiscard]] std::optional<PlannedFault> strike(FaultMoment moment, Instant now, Predicate is_meant) {
    return faults_.strike(moment, scene_time_s(now), now, is_meant);
  }
  [[nodiscard]] const FaultDesk& faults() const { return faults_; }
  /// The stage, or one drive of it, has been given a motion: what is meant for its middle is set.
  void note_motion(Instant now, std::optional<stage::Axis> of_drive = std::nullopt);

  /// The stage loses its power and gets it back: home, epoch, latches and counters are gone, the boot counter grows.
  void power_cycle_stage(Instant now);

  /// Begins an exposure of `duration` > 0 of wall time; false: one is under way.
  bool start_exposure(Duration duration, double gain_db, Instant now);
  /// `witness` is told of each exposure before it begins. Called with whatever lock the instrument is under.
  void tell_exposures_to(std::function<void(const ExposureNote&)> witness) { witness_ = std::move(witness); }
  [[nodiscard]] std::optional<Instant> exposure_end() const;
  /// The last finished exposure, once.
  [[nodiscard]] std::optional<Exposure> take_exposure(Instant now);

  /// A place for one more radiometer; its number from 0.
  [[nodiscard]] std::size_t add_collector();
  /// Begins to collect a radiometer's light for `duration` > 0 of wall time, beside any exposure and other collectors;
  /// one of its own that is under way is dropped.
  void start_collection(std::size_t collector, Duration duration, Instant now);
  void drop_collection(std::size_t collector);
  /// When the collection ends that is under way, or ended that nobody has taken.
  [[nodiscard]] std::optional<Instant> collection_end(std::size_t collector) const;
  /// The last finished collection, once.
  [[nodiscard]] std::optional<LightCollection> take_collection(std::size_t collector, Instant now);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Truth& truth() const { return truth_; }
  [[nodiscard]] Temperature detector_temperature(Instant now) const {
    return charge_.drift().detector_temperature(scene_time_s(now));
  }
  [[nodiscard]] double monitor_now(Instant now) const {
    return lamp_faults_.shown_now(lamp_.monitor_now(scene_time_s(now)), scene_time_s(now));
  }
  [[nodiscard]] StagePose pose(Instant t) const;
  [[nodiscard]] InstrumentMemory memory(Instant now) const;

 private:
  struct Running {
    Instant open{};
    Instant close{};
    Instant integrated_to{};
    double gain_db = 0.0;
    std::uint64_t place = 0;
    LightRate light;  ///< integrated so far
  };
  [[nodiscard]] double scene_time_s(Instant t) const;
  /// Something that a fault does at its own instant.
  struct Act {
    Instant at{};
    PlannedFault fault;
    bool is_end = false;
  };
  void put_on_agenda(const Act& act);
  void begin_fault(const PlannedFault& fault, Instant now);
  void undo_fault(FaultKind kind, Instant now);
  void act_on_faults(Instant now);
  [[nodiscard]] std::optional<Instant> next_act() const;
  void note_exposure(Instant open, Instant close);
  void reboot_stage(Instant now);
  void integrate_to(Instant t);
  void integrate(Running& run, Instant t) const;
  [[nodiscard]] LightRate light_integral(Instant from, Instant to) const;
  void finish_exposure();
  struct Collector {
    std::optional<Running> running;
    std::optional<LightCollection> finished;
  };
  void finish_collection(Collector& collector);

  Scene scene_;
  Truth truth_;
  Lamp lamp_;
  LightPath light_path_;
  DetectorCharge charge_;
  StageModel stage_;
  FaultDesk faults_;
  LampFaults lamp_faults_;
  std::vector<Act> agenda_;  ///< of faults; in the order of time
  Instant power_up_;
  Instant now_;
  InstrumentMemory memory_;
  std::optional<Running> running_;
  std::optional<Exposure> finished_;
  std::vector<Collector> collectors_;
  std::function<void(const ExposureNote&)> witness_;
};

}  // namespace gonio::sim
