#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "daemon/analysis/analysis_desk.h"
#include "daemon/app/engine.h"
#include "daemon/desks/plan_desk.h"
#include "daemon/desks/reference_shelf.h"
#include "daemon/http/service.h"
#include "daemon/sequencer/scan_machine.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// The routes' side of the daemon: commands to the engine, questions to the store and to what the engine last saw.
class DaemonService final : public Service {
 public:
  struct Parts {
    Engine& engine;
    const Instrument& instrument;
    const ReferenceShelf& shelf;
    const Clock& clock;
    AnalysisDesk& analyses;
    std::string store_file;
    std::string version;
  };
  explicit DaemonService(Parts parts);

  void stop(const std::string& who, Reply<api::StopReport> reply) override;
  void move_stage(const api::MoveRequest& request, const std::string& who, Reply<api::CommandReport> reply) override;
  void home_stage(const std::string& who, Reply<api::CommandReport> reply) override;
  void reset_stage(const std::string& who, Reply<api::CommandReport> reply) override;
  void read_detector(const api::DetectorReadRequest& request, const std::string& who,
                     Reply<api::DetectorReading> reply) override;
  void submit_scan(const api::PlanSubmission& submission, const std::string& idempotency_key, const std::string& who,
                   Reply<api::CommandReport> reply) override;
  void change_scan(std::int64_t scan, ScanVerb verb, const std::string& reason, const std::string& who,
                   Reply<api::CommandReport> reply) override;

  void resume_scan(std::int64_t scan, const api::ResumeRequest& request, const std::string& who,
                   Reply<api::CommandReport> reply) override;
  void change_rest(std::int64_t scan, const api::ChangeRequest& request, const std::string& who,
                   Reply<api::CommandReport> reply) override;
  void complete_missing(std::int64_t scan, const std::string& who, Reply<api::CommandReport> reply) override;

  void use_calibration(std::int64_t version, const api::UseCalibrationRequest& request, const std::string& who,
                       Reply<api::CommandReport> reply) override;
  void recompute_scan(std::int64_t scan, const api::RecomputeRequest& request, const std::string& who,
                      Reply<api::CommandReport> reply) override;
  Result<api::CalibrationList> calibrations() override;
  Result<api::CalibrationReport> calibration(std::int64_t version) override;
  Result<std::string> calibration_map(std::int64_t version, const std::string& name) override;
  Result<api::ChartReport> calibration_chart(const std::string& standard) override;

  Result<api::StatusReport> status() override;
  api::HealthReport health() override;
  std::string metrics() override;
  Result<api::StageReport> stage() override;
  Result<api::PlanReport> check_plan(const api::PlanSubmission& submission) override;
  Result<api::ScanList> scans() override;
  Result<api::ScanReport> scan(std::int64_t scan) override;
  Result<api::PointPage> points(std::int64_t scan, std::int64_t after, int at_most) override;
  Result<api::BrdfPage> brdf(std::int64_t scan, std::int64_t after, int at_most) override;
  Result<std::string> export_csv(std::int64_t scan) override;
  Result<api::ReferenceList> references() override;
  Result<api::ScanChecksReport> checks(std::int64_t scan) override;
  Result<api::PointBudgetReport> budget(std::int64_t scan, std::optional<std::int64_t> point) override;
  Result<api::ReferenceReport> reference(const std::string& serial) override;
  Result<api::ReferenceReport> check_reference(const api::ReferenceImport& request) override;
  Result<api::ReferenceReport> import_reference(const api::ReferenceImport& request, const std::string& who) override;
  api::InstrumentReport instrument() override;
  Result<api::AnalysisReport> start_analysis(const api::AnalysisRequest& request, const std::string& who) override;
  api::AnalysisList analyses() override { return parts_.analyses.all(); }
  Result<api::AnalysisReport> analysis(std::int64_t job) override { return parts_.analyses.one(job); }
  Result<std::string> analysis_file(std::int64_t job, const std::string& name) override {
    return parts_.analyses.file(job, name);
  }
  Result<api::AnalysisReport> cancel_analysis(std::int64_t job) override { return parts_.analyses.cancel(job); }
  Result<std::vector<api::Event>> events(std::int64_t after, int at_most) override;

 private:
  /// A reader of its own for one request; kept for the next when it is done with.
  template <class Ask>
  auto ask_store(Ask ask) -> decltype(ask(std::declval<StoreReader&>()));
  void command(const std::string& who, Verb verb, Reply<api::CommandReport> reply);
  /// By what past scans have taught. Errors: those of daemon::check_plan.
  [[nodiscard]] Result<CheckedPlan> checked_plan(const api::PlanSubmission& submission);
  /// Why a scan takes nothing of the kind any more, by the store; a store that cannot be read does not stand in the
  /// way.
  [[nodiscard]] std::optional<Error> is_over_for(std::int64_t scan, ScanAsk ask);
  /// Errors: InvalidInput.
  [[nodiscard]] Result<std::optional<ScanTurn::Start>> start_from(const std::string& text) const;

  /// Of a scan that is over; looked at once for each of its calibrations.
  [[nodiscard]] std::optional<std::string> checks_in_short(ScanId scan, std::int64_t calibration);

  Parts parts_;
  const Instant started_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<StoreReader>> readers_;
  std::map<std::pair<ScanId, std::int64_t>, std::string> checks_;  ///< guarded by mutex_
};

}  // namespace gonio::daemon
