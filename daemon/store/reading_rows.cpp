#include "daemon/store/reading_rows.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "drivers/kinematics/kinematics.h"

namespace gonio::daemon {
namespace {

using calibration::PlannedPoint;
using calibration::PowerReading;
using calibration::RawFrame;
using calibration::RawReading;
using calibration::ReducedMean;
using calibration::Target;
using stage::Axis;

/// What was read of a table, by the number of its rows, which come ascending.
template <class Row>
class RowsById {
 public:
  void add(std::int64_t id, const Row& row) { rows_.push_back({id, row}); }
  void reserve(std::size_t rows) { rows_.reserve(rows); }

  /// Null: there is none. Whoever asks in ascending order finds each in its place.
  [[nodiscard]] const Row* find(std::int64_t id) {
    for (const std::size_t likely : {last_, last_ + 1}) {
      if (likely < rows_.size() && rows_[likely].id == id) return &rows_[last_ = likely].row;
    }
    const auto found = std::ranges::lower_bound(rows_, id, {}, &Numbered::id);
    if (found == rows_.end() || found->id != id) return nullptr;
    last_ = static_cast<std::size_t>(found - rows_.begin());
    return &found->row;
  }

 private:
  struct Numbered {
    std::int64_t id = 0;
    Row row;
  };
  std::vector<Numbered> rows_;
  std::size_t last_ = 0;
};

/// What readings have in common: an accepted attempt, or a visit.
struct Occasion {
  Target target = Target::Dark;
  const PlannedPoint* point = nullptr;
  std::int64_t scale_ns = 0;  ///< from its boot's time to the scan's
};

const PlannedPoint* point_of(std::int64_t index, const RowContext& context) {
  return static_cast<std::size_t>(index) < context.points.size() ? &context.points[static_cast<std::size_t>(index)]
                                                                 : nullptr;
}

// Columns: number, target (NULL: a dark), point, run.
RowsById<Occasion> read_occasions(Statement& query, std::size_t expected, const RowContext& context) {
  RowsById<Occasion> occasions;
  occasions.reserve(expected);
  while (query.next()) {
    Occasion occasion;
    if (!query.is_null(1)) {
      occasion.target = target_from_name(query.text(1)).value_or(Target::Sample);
      occasion.point = point_of(query.integer(2), context);
    }
    const auto scale = context.scale_of_run.find(query.integer(3));
    if (scale != context.scale_of_run.end()) occasion.scale_ns = scale->second;
    occasions.add(query.integer(0), occasion);
  }
  return occasions;
}

// By row number, not by the index over points: + keeps the column out of the planner's sight.
RowsById<Occasion> read_attempts(Database& database, IdRange range, const RowContext& context) {
  Statement& query = database.statement(
      "SELECT attempt_id, target, point_index, run_id FROM attempt WHERE attempt_id >= ? AND attempt_id < ? AND "
      "+scan_id = ? AND outcome = 'accepted' ORDER BY attempt_id");
  query.bind(range.from).bind(range.to).bind(context.scan);
  return read_occasions(query, static_cast<std::size_t>(range.to - range.from), context);
}

RowsById<Occasion> read_visits(Database& database, const RowContext& context) {
  Statement& query = database.statement(
      "SELECT v.visit_id, l.target, l.point_index, v.run_id FROM visit v LEFT JOIN visit_level l ON l.visit_id = "
      "v.visit_id WHERE v.scan_id = ? ORDER BY v.visit_id");
  query.bind(context.scan);
  return read_occasions(query, 0, context);
}

RowsById<ReducedMean> read_reductions(Database& database, IdRange range) {
  RowsById<ReducedMean> reductions;
  Statement& query = database.statement(
      "SELECT reading_id, counted_n, reduced_dn, u_noise_dn, u_maps_dn FROM frame_reduction WHERE reading_id >= ? AND "
      "reading_id < ? ORDER BY reading_id");
  query.bind(range.from).bind(range.to);
  while (query.next()) {
    reductions.add(query.integer(0), {.n = static_cast<std::uint32_t>(query.integer(1)),
                                      .mean_dn = query.real(2),
                                      .u_noise_dn = query.real(3),
                                      .u_maps_dn = query.real(4)});
  }
  return reductions;
}

RowsById<PowerReading> read_powers(Database& database, IdRange range) {
  RowsById<PowerReading> powers;
  Statement& query = database.statement(
      "SELECT reading_id, mean_w, standard_error_w, samples, averages, range_w, wavelength_nm FROM power_reading WHERE "
      "reading_id >= ? AND reading_id < ? AND role = 'detector' ORDER BY reading_id");
  query.bind(range.from).bind(range.to);
  while (query.next()) {
    powers.add(query.integer(0), {.mean_w = query.real(1),
                                  .standard_error_w = query.real(2),
                                  .samples = static_cast<int>(query.integer(3)),
                                  .averages = static_cast<int>(query.integer(4)),
                                  .range_w = query.real(5),
                                  .wavelength = nanometres(query.real(6))});
  }
  return powers;
}

// In the order of the table's own columns: SQLite finds each behind the one before it.
constexpr int kFrameColumn = 3;
constexpr int kOpenColumn = kFrameColumn + 8;
constexpr int kCloseColumn = kOpenColumn + 6;
constexpr int kMonitorColumn = kCloseColumn + 6;
constexpr const char* kReadingRows =
    "SELECT reading_id, attempt_id, visit_id, region_n, mean_dn, m2_dn2, m3_dn3, m4_dn4, saturated, exposure_ns, "
    "gain_db, open_theta_i_counts, open_theta_r_counts, open_phi_r_counts, open_phi_i_counts, open_carriage_counts, "
    "open_filter_wheel_counts, close_theta_i_counts, close_theta_r_counts, close_phi_r_counts, close_phi_i_counts, "
    "close_carriage_counts, close_filter_wheel_counts, monitor_mean, monitor_se, detector_temperature_c, boottime_ns "
    "FROM reading WHERE reading_id >= ? AND reading_id < ? AND used = 1 ORDER BY reading_id";

// Where the point is known, the azimuths are given near its own; a dark's directions mean nothing.
Geometry geometry_from_counts(const Statement& row, int first, const drivers::StageConfig& stage,
                              const PlannedPoint* point) {
  stage::PerAxis<double> positions{};
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    positions[a] = drivers::position_of(stage, axis, row.integer(first + static_cast<int>(a)));
  }
  if (point == nullptr) return drivers::directions(stage.kinematics, positions);
  return drivers::directions_near(stage.kinematics, positions, point->geometry);
}

RawFrame frame_from_row(const Statement& row, const PlannedPoint* point, const drivers::StageConfig& stage) {
  RawFrame frame;
  frame.region = {.n = static_cast<std::uint32_t>(row.integer(kFrameColumn)),
                  .mean = row.real(kFrameColumn + 1),
                  .m2 = row.real(kFrameColumn + 2),
                  .m3 = row.real(kFrameColumn + 3),
                  .m4 = row.real(kFrameColumn + 4),
                  .saturated = static_cast<std::uint32_t>(row.integer(kFrameColumn + 5))};
  frame.exposure_s = in_seconds(Duration(row.integer(kFrameColumn + 6)));
  frame.gain_db = row.real(kFrameColumn + 7);
  frame.at_open = geometry_from_counts(row, kOpenColumn, stage, point);
  frame.at_close = geometry_from_counts(row, kCloseColumn, stage, point);
  frame.monitor_mean = row.real(kMonitorColumn);
  frame.monitor_se = row.real(kMonitorColumn + 1);
  frame.detector_temperature_c = row.real(kMonitorColumn + 2);
  return frame;
}

double range_of(const RawFrame& frame) {
  return frame.power ? frame.power->range_w : 0.0;
}

/// The readings of one part, row by row.
class RowReader {
 public:
  RowReader(Database& database, const ReadingPart& part, const RowContext& context)
      : context_(context),
        attempts_(read_attempts(database, part.attempts, context)),
        visits_(read_visits(database, context)),
        reductions_(read_reductions(database, part.readings)),
        powers_(read_powers(database, part.readings)) {
    readings_.reserve(static_cast<std::size_t>(part.readings.to - part.readings.from));
  }

  void add(const Statement& row) {
    const bool is_visit = row.is_null(1);
    const std::int64_t number = row.integer(is_visit ? 2 : 1);
    const Occasion* occasion = (is_visit ? visits_ : attempts_).find(number);
    if (occasion == nullptr) return;  // another scan's, or an attempt that failed
    const std::int64_t id = row.integer(0);
    RawFrame frame = frame_from_row(row, occasion->point, context_.stage);
    if (const ReducedMean* reduced = reductions_.find(id)) frame.reduced = *reduced;
    if (const PowerReading* power = powers_.find(id)) frame.power = *power;
    const Instant at{Duration(row.integer(kMonitorColumn + 3) + occasion->scale_ns)};
    const std::int64_t visit_id = 2 * number + (is_visit ? 1 : 0);
    if (RawReading* reading = reading_of(visit_id, frame)) {
      reading->frames.push_back(std::move(frame));
      reading->at += (at - reading->at) / static_cast<std::int64_t>(reading->frames.size());
      return;
    }
    begin_reading(id, visit_id, is_visit, *occasion, at).frames.push_back(std::move(frame));
  }

  [[nodiscard]] LargeArray<RawReading> take() { return std::move(readings_); }

 private:
  // Frames of one attempt or visit at one exposure, or in one range, become one reading; its time is the mean of
  // theirs. Null: this is the first.
  RawReading* reading_of(std::int64_t visit_id, const RawFrame& frame) {
    for (auto reading = readings_.rbegin(); reading != readings_.rend() && reading->visit_id == visit_id; ++reading) {
      const RawFrame& first = reading->frames.front();
      if (first.exposure_s == frame.exposure_s && range_of(first) == range_of(frame)) return &*reading;
    }
    return nullptr;
  }

  RawReading& begin_reading(std::int64_t id, std::int64_t visit_id, bool is_visit, const Occasion& occasion,
                            Instant at) {
    RawReading& reading = readings_.emplace_back(RawReading{});
    reading.id = id;
    reading.visit_id = visit_id;
    reading.target = occasion.target;
    reading.at = at;
    if (const PlannedPoint* point = occasion.point) {
      (is_visit ? reading.visited_point : reading.point_index) = point->index;
      reading.wavelength = point->wavelength;
    }
    return reading;
  }

  const RowContext& context_;
  RowsById<Occasion> attempts_;
  RowsById<Occasion> visits_;
  RowsById<ReducedMean> reductions_;
  RowsById<PowerReading> powers_;
  LargeArray<RawReading> readings_;
};

}  // namespace

LargeArray<RawReading> read_rows(Database& database, const ReadingPart& part, const RowContext& context) {
  RowReader reader(database, part, context);
  Statement& query = database.statement(kReadingRows);
  query.bind(part.readings.from).bind(part.readings.to);
  while (query.next()) reader.add(query);
  return reader.take();
}

}  // namespace gonio::daemon
