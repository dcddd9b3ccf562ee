#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "protocol/api/analysis.h"
#include "protocol/api/calibration_reports.h"
#include "protocol/api/instrument_report.h"
#include "protocol/api/reports.h"
#include "protocol/api/requests.h"
#include "protocol/api/scan_review.h"

namespace gonio::daemon {

/// Takes one outcome, once, from any thread, and returns at once. It may be called long after the client has gone.
template <class T>
using Reply = std::function<void(Result<T>)>;

/// What a client may ask of a scan that is there.
enum class ScanVerb : std::uint8_t { Pause, PauseNow, Finish, Abort, Skip };

/// What stands behind the routes: the daemon as HTTP sees it.
///
/// Threads: `stop` is called on the HTTP event thread and must return within a millisecond. All else is called on
/// worker threads, several at a time: it may read the store, and must not wait for an instrument. Where the answer must
/// come from the sequencer it goes to the `Reply`; one that never comes becomes TimedOut to the client. `who`: "local"
/// or "uid:1000".
class Service {
 public:
  virtual ~Service() = default;

  /// Halts all motion now. The reply comes when the halt has been acknowledged, or why it was not.
  virtual void stop(const std::string& who, Reply<api::StopReport> reply) = 0;

  /// Errors of all commands: WrongState, NotFound, Busy, and what their verb says.
  virtual void move_stage(const api::MoveRequest& request, const std::string& who, Reply<api::CommandReport> reply) = 0;
  virtual void home_stage(const std::string& who, Reply<api::CommandReport> reply) = 0;
  virtual void reset_stage(const std::string& who, Reply<api::CommandReport> reply) = 0;
  /// Errors: OutOfLimits, and those of the detector.
  virtual void read_detector(const api::DetectorReadRequest& request, const std::string& who,
                             Reply<api::DetectorReading> reply) = 0;
  /// The reply comes when the scan is durable. The same key (not empty) again gives the scan it made then.
  /// Errors: those of the plan, AllPointsBlocked, OutOfLimits, ReferenceExpired, ReferenceOutOfReach.
  virtual void submit_scan(const api::PlanSubmission& submission, const std::string& idempotency_key,
                           const std::string& who, Reply<api::CommandReport> reply) = 0;
  virtual void change_scan(std::int64_t scan, ScanVerb verb, const std::string& reason, const std::string& who,
                           Reply<api::CommandReport> reply) = 0;

  virtual void resume_scan(std::int64_t scan, const api::ResumeRequest& request, const std::string& who,
                           Reply<api::CommandReport> reply) = 0;
  virtual void change_rest(std::int64_t scan, const api::ChangeRequest& request, const std::string& who,
                           Reply<api::CommandReport> reply) = 0;
  /// Queues a new scan of what an ended one lacks; the reply names the new one.
  virtual void complete_missing(std::int64_t scan, const std::string& who, Reply<api::CommandReport> reply) = 0;

  /// Errors: NotFound (no such version), InvalidInput (its job changes no scan).
  virtual void use_calibration(std::int64_t version, const api::UseCalibrationRequest& request, const std::string& who,
                               Reply<api::CommandReport> reply) = 0;
  /// Errors: NotFound, those of the computation, and NotRecomputable (a step that needs frames, which are not kept).
  virtual void recompute_scan(std::int64_t scan, const api::RecomputeRequest& request, const std::string& who,
                              Reply<api::CommandReport> reply) = 0;

  [[nodiscard]] virtual Result<api::StatusReport> status() = 0;
  [[nodiscard]] virtual api::HealthReport health() = 0;
  /// In the Prometheus text format.
  [[nodiscard]] virtual std::string metrics() = 0;
  /// Errors: the stage's last one, when it was never seen.
  [[nodiscard]] virtual Result<api::StageReport> stage() = 0;
  [[nodiscard]] virtual Result<api::PlanReport> check_plan(const api::PlanSubmission& submission) = 0;
  [[nodiscard]] virtual Result<api::ScanList> scans() = 0;
  [[nodiscard]] virtual Result<api::ScanReport> scan(std::int64_t scan) = 0;
  /// Points with index > `after`.
  [[nodiscard]] virtual Result<api::PointPage> points(std::int64_t scan, std::int64_t after, int at_most) = 0;
  [[nodiscard]] virtual Result<api::BrdfPage> brdf(std::int64_t scan, std::int64_t after, int at_most) = 0;
  [[nodiscard]] virtual Result<std::string> export_csv(std::int64_t scan) = 0;
  [[nodiscard]] virtual Result<api::ReferenceList> references() = 0;
  [[nodiscard]] virtual Result<api::ScanChecksReport> checks(std::int64_t scan) = 0;
  /// Without a point: of the one of median U / |f|. Errors: NotFound, IncompleteData.
  [[nodiscard]] virtual Result<api::PointBudgetReport> budget(std::int64_t scan, std::optional<std::int64_t> point) = 0;
  /// Errors: NotFound, and what is wrong with its file.
  [[nodiscard]] virtual Result<api::ReferenceReport> reference(const std::string& serial) = 0;
  /// Looks at what an import would bring. Errors: those of the texts.
  [[nodiscard]] virtual Result<api::ReferenceReport> check_reference(const api::ReferenceImport& request) = 0;
  /// Writes it to the shelf. Errors: those of the texts; WrongState (there is another text of this serial number);
  /// InvalidInput (its table contradicts itself), DiskFull.
  [[nodiscard]] virtual Result<api::ReferenceReport> import_reference(const api::ReferenceImport& request,
                                                                      const std::string& who) = 0;
  [[nodiscard]] virtual api::InstrumentReport instrument() = 0;
  [[nodiscard]] virtual Result<api::CalibrationList> calibrations() = 0;
  /// Errors: NotFound.
  [[nodiscard]] virtual Result<api::CalibrationReport> calibration(std::int64_t version) = 0;
  /// A file for [detector.maps] that the job made: "dark", "bad_pixels", "flat". Errors: NotFound, those of the fit.
  [[nodiscard]] virtual Result<std::string> calibration_map(std::int64_t version, const std::string& name) = 0;
  /// Errors: NotFound (no run of such a check standard).
  [[nodiscard]] virtual Result<api::ChartReport> calibration_chart(const std::string& standard) = 0;
  /// Queues a job for the worker program. Errors: InvalidInput, NotFound, Busy.
  [[nodiscard]] virtual Result<api::AnalysisReport> start_analysis(const api::AnalysisRequest& request,
                                                                   const std::string& who) = 0;
  [[nodiscard]] virtual api::AnalysisList analyses() = 0;
  /// Errors of these: NotFound.
  [[nodiscard]] virtual Result<api::AnalysisReport> analysis(std::int64_t job) = 0;
  /// What a job wrote, by the name that its report has. Errors: NotFound, WrongState (it is not done).
  [[nodiscard]] virtual Result<std::string> analysis_file(std::int64_t job, const std::string& name) = 0;
  /// Ends a job; one that is over stays as it is.
  [[nodiscard]] virtual Result<api::AnalysisReport> cancel_analysis(std::int64_t job) = 0;
  /// Committed events with number > `after`, in order.
  [[nodiscard]] virtual Result<std::vector<api::Event>> events(std::int64_t after, int at_most) = 0;
};

}  // namespace gonio::daemon
