#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/planner/anchor.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/exposure_choice.h"
#include "daemon/sequencer/measurement.h"
#include "daemon/sequencer/messages.h"
#include "daemon/sequencer/scan_items.h"
#include "daemon/sequencer/time_estimate.h"
#include "daemon/sequencer/time_ledger.h"
#include "daemon/sequencer/visit_level.h"
#include "daemon/sequencer/visit_tracks.h"
#include "daemon/sequencer/way_ahead.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// One thing that the instrument is doing for a scan: a move, and the exposures after it.
struct Job {
  enum class Kind : std::uint8_t { Item, Dark, Park, Reference, Check };
  enum class Phase : std::uint8_t { ToMove, Homing, Moving, InPlace, Exposing };

  Kind kind = Kind::Item;
  ItemKey item;  ///< of an Item; of a Reference or Check visit, what is in view
  std::optional<Measurement> measurement;
  std::optional<ExposureChooser> chooser;  ///< of a Reference or Check visit: its own
  drivers::MotionTarget target{};          ///< what must hold during the exposures
  Phase phase = Phase::ToMove;
  Instant started{};
  Instant asked{};                ///< when the call now open was made
  StepTime model;                 ///< of the move in hand, by the axes' own speeds
  bool awaits_commit = false;     ///< in place, and the item before is not committed yet
  bool is_going_back = false;     ///< the arms had left for the next item too soon
  std::optional<Error> error;     ///< of a move that is ahead of its turn
  std::uint32_t gate_before = 0;  ///< the stage's count before the exposure in hand
  TimeParts time;
  std::optional<drivers::StageState> gate;    ///< after the exposure in hand, once the stage has answered
  std::optional<FrameSummary> frame;          ///< likewise the camera
  std::optional<drivers::StageState> before;  ///< where no gate latches: the look before the exposure in hand
  std::optional<PowerRecord> monitor;         ///< a radiometer's in the lamp's light, over the exposure in hand
  std::optional<Error> gate_error;            ///< the gate was not seen in time; the camera's answer may say why
  std::map<std::size_t, std::shared_ptr<calibration::PixelSums>> pixel_sums;  ///< of a map job, by rung
  /// Those whose every frame counts: a rung that saturates counts whole or not at all.
  [[nodiscard]] std::vector<PixelSumRecord> complete_sums() const {
    std::vector<PixelSumRecord> complete;
    for (const auto& [rung, sums] : pixel_sums) {
      const std::int64_t frames = measurement->used_frames_of(rung);
      if (frames > 0 && frames == sums->frames) complete.push_back(sums);
    }
    return complete;
  }
  [[nodiscard]] bool is_visit() const { return kind == Kind::Dark || kind == Kind::Reference || kind == Kind::Check; }
  [[nodiscard]] bool is_lit() const { return kind != Kind::Dark && kind != Kind::Park; }
};

/// A scan that is not over, with all that the sequencer knows of it. The durable part is the store's; the rest is made
/// anew at each start.
struct ActiveScan {
  ActiveScan(UnfinishedScan stored, const Instrument& instrument)
      : id(stored.id),
        name(stored.name),
        state(stored.state),
        finish_asked(stored.finish_asked),
        policy(stored.policy),
        instrument_hash(stored.instrument_hash),
        merged(stored.merged),
        points(std::move(stored.points)),
        holds(std::move(stored.holds)),
        spent(stored.spent),
        turn(stored.turn),
        predicted(stored.predicted),
        items(points.size(), std::move(stored.order), policy.block, stored.accepted, stored.skipped,
              policy.reference_mode),
        chooser(instrument, {policy.target_snr, policy.max_time, policy.exposures}),
        dark_owed(stored.dark_owed),
        reference_visits(reference_points(stored), stored.last_reference, points),
        check_visits{.at = reference_visits.due().at,
                     .level = stored.last_check.level,
                     .since = std::move(stored.last_check.since),
                     .last = {},
                     .rung = {}},
        reopened(stored.reopened.begin(), stored.reopened.end()),
        largest_drift(stored.largest_drift) {
    for (const auto& [item, count] : stored.attempts) failures[item] = count;
    if (predicted && predicted->scans > 0) end_estimate.expect_motion(predicted->motion.value);
    for (const Duration exposure : stored.exposures_used) note_rung_of(exposure);
    if (!points.empty()) {
      const Filter* filter = filter_for(instrument, points.front().wavelength);
      meter_wavelength = filter == nullptr ? points.front().wavelength : filter->centroid;
    }
  }

  // Where the visits of earlier runs were made, else where the mode has them.
  [[nodiscard]] std::vector<std::int32_t> reference_points(const UnfinishedScan& stored) const {
    if (policy.reference_mode == api::ReferenceMode::Anchor) {
      const std::vector<std::int32_t> anchors = anchor_points(points, policy.anchor);
      if (!anchors.empty()) return anchors;
    }
    const auto& level = stored.last_reference.level ? stored.last_reference.level : stored.last_check.level;
    return {level ? level->point : visit_point(points)};
  }

  // The readings of a radiometer all last as long: any of its ranges may have been in use.
  void note_rung_of(Duration exposure) {
    const auto& rungs = chooser.rungs();
    // Cameras round an exposure to their own clock: one per cent is far less than the factor of two between rungs.
    for (std::size_t rung = 0; rung < rungs.size(); ++rung) {
      if (std::abs(in_seconds(exposure) / in_seconds(rungs[rung]) - 1.0) < 0.01) note_rung(rung);
    }
  }
  [[nodiscard]] std::optional<PowerSettings> power_settings(std::size_t rung) const {
    const std::optional<double> range = chooser.range_w(rung);
    if (!range) return std::nullopt;
    return PowerSettings{.range_w = *range, .wavelength = meter_wavelength};
  }
  void note_rung(std::size_t rung) {
    lowest_rung = std::min(lowest_rung.value_or(rung), rung);
    highest_rung = std::max(highest_rung.value_or(rung), rung);
  }
  [[nodiscard]] bool has_hold(HoldName hold) const {
    return std::any_of(holds.begin(), holds.end(), [hold](const Hold& h) { return h.name == hold; });
  }

  [[nodiscard]] bool is_only_preempted() const { return holds.size() == 1 && has_hold(HoldName::Preempted); }

  ScanId id;
  std::string name;
  ScanState state;
  bool finish_asked;
  ScanPolicy policy;
  std::string instrument_hash;
  std::int64_t merged;
  std::vector<ScanPoint> points;
  std::vector<Hold> holds;
  TimeParts spent;
  ScanTurn turn;
  std::optional<PredictedTime> predicted;
  ScanItems items;
  ExposureChooser chooser;
  Wavelength meter_wavelength;  ///< a radiometer's setting: of the first point's filter, for the whole scan

  std::optional<Command> finish_command;  ///< a finish that waits for the item in hand
  bool is_found = false;            ///< was not over at start-up: what the store says must first become `interrupted`
  std::map<ItemKey, int> failures;  ///< attempts that failed, of items that are not decided
  std::int64_t failed_attempts = 0;
  bool dark_owed;                          ///< items were accepted after the last dark
  std::optional<Instant> last_dark;        ///< of this run: before the first, no level is known and nothing is measured
  std::optional<std::size_t> lowest_rung;  ///< used by accepted readings
  std::optional<std::size_t> highest_rung;
  int most_frames = 1;
  int visit_failures = 0;
  ReferenceTracks reference_visits;
  VisitTrack check_visits;
  std::map<std::int32_t, int> reopened;  ///< points, and how often a drift made them be measured again
  double largest_drift;                  ///< between two visits
  bool is_position_in_doubt = false;     ///< an axis was not where it was left or sent: home before the next move
  std::int64_t uncommitted = 0;          ///< items accepted here whose commit has not returned
  std::optional<Job> job;
  std::optional<Job> ahead;  ///< the next item, while the frame of the one in hand is still read: only its move
  TimeLedger ledger;         ///< while it is active
  IdleTime between;          ///< since the last job: goes into the next one's time
  EndEstimate end_estimate;
  WayAhead way;
  WayAhead::Turns turns;                           ///< to come, as of the last one
  std::optional<calibration::Target> last_target;  ///< of this run
  DurationStatistics item_time;                    ///< all of it
  DurationStatistics visit_time;                   ///< of the standard and the sample

  /// While preparing: what is verified so far.
  enum class Preparation : std::uint8_t {
    Detector,
    Monitor,
    Look,
    LookAgain,
    Reset,
    Home,
    Verified,
    Shut,
    Zero,
    Lamp,   ///< the source's shutter opens: the monitor may stand behind it
    WarmUp  ///< the lamp is looked at until it is warm
  };
  Preparation preparation = Preparation::Detector;
  bool reset_tried = false;
  bool is_zeroed = false;  ///< a radiometer, in this run
  Instant look_again_at{};
  Instant prepared_since{};
  std::optional<Instant> warm_up_since;  ///< while preparing waits for the lamp
  int ends_by_themselves = 0;            ///< holds that ended so without an item accepted in between
  std::int64_t accepted_at_end = 0;      ///< items, when the last of them ended
};

}  // namespace gonio::daemon
