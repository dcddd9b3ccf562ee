#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/http/service.h"
#include "protocol/api/json.h"

namespace gonio::test {

/// A service that remembers what it was asked, and keeps events. What it answers is fixed. Threads: any.
class FakeService final : public daemon::Service {
 public:
  void stop(const std::string& who, daemon::Reply<api::StopReport> reply) override {
    note("stop " + who);
    reply(api::StopReport{.epoch = 7});
  }
  void move_stage(const api::MoveRequest& request, const std::string& who,
                  daemon::Reply<api::CommandReport> reply) override {
    note("move " + (request.theta_i_deg ? std::to_string(*request.theta_i_deg) : "-") + " " + who);
    if (hold_replies) {
      const std::lock_guard lock(mutex_);
      held_.push_back(std::move(reply));
      return;
    }
    reply(api::CommandReport{});
  }
  void home_stage(const std::string& who, daemon::Reply<api::CommandReport> reply) override {
    note("home " + who);
    reply(failure({.code = ErrorCode::WrongState,
                   .device = "stage",
                   .tried = "home",
                   .seen = "scan 3 is running",
                   .limit = "no scan, or one that holds"}));
  }
  void reset_stage(const std::string& who, daemon::Reply<api::CommandReport> reply) override {
    note("reset " + who);
    reply(api::CommandReport{});
  }
  void read_detector(const api::DetectorReadRequest& request, const std::string& who,
                     daemon::Reply<api::DetectorReading> reply) override {
    note("read " + std::to_string(request.exposure_s.value_or(0.0)) + " " + who);
    reply(api::DetectorReading{.detector = "Maker Model 7", .unit = "DN", .value = 71.5});
  }
  void submit_scan(const api::PlanSubmission& submission, const std::string& key, const std::string& who,
                   daemon::Reply<api::CommandReport> reply) override {
    std::string parts;
    for (const auto& [name, text] : submission.parts) parts += " " + name + "=[" + text + "]";
    note("submit " + submission.plan_file + " [" + submission.plan + "] key=" + key + " " + who + parts);
    reply(api::CommandReport{.scan = 3, .existed = false});
  }
  void change_scan(std::int64_t scan, daemon::ScanVerb verb, const std::string& reason, const std::string& who,
                   daemon::Reply<api::CommandReport> reply) override {
    note("change " + std::to_string(scan) + " verb " + std::to_string(static_cast<int>(verb)) + " " + reason + " " +
         who);
    reply(api::CommandReport{.scan = scan});
  }

  void resume_scan(std::int64_t scan, const api::ResumeRequest& request, const std::string& who,
                   daemon::Reply<api::CommandReport> reply) override {
    note("resume " + std::to_string(scan) + " [" + request.hold + "] " + who);
    reply(api::CommandReport{.scan = scan, .note = "still held: lamp (stage: it is out)"});
  }
  void change_rest(std::int64_t scan, const api::ChangeRequest& request, const std::string& who,
                   daemon::Reply<api::CommandReport> reply) override {
    note("change rest " + std::to_string(scan) + " " + api::to_json(request) + " " + who);
    reply(api::CommandReport{.scan = scan});
  }
  void complete_missing(std::int64_t scan, const std::string& who, daemon::Reply<api::CommandReport> reply) override {
    note("complete missing " + std::to_string(scan) + " " + who);
    reply(api::CommandReport{.scan = scan + 1});
  }

  void use_calibration(std::int64_t version, const api::UseCalibrationRequest& request, const std::string& who,
                       daemon::Reply<api::CommandReport> reply) override {
    note("use " + std::to_string(version) + (request.in_use ? " yes [" : " no [") + request.reason + "] " + who);
    reply(api::CommandReport{});
  }
  void recompute_scan(std::int64_t scan, const api::RecomputeRequest& request, const std::string& who,
                      daemon::Reply<api::CommandReport> reply) override {
    note("recompute " + std::to_string(scan) + " [" + request.calibration + "] " + who);
    reply(api::CommandReport{.scan = scan});
  }
  Result<api::CalibrationList> calibrations() override { return api::CalibrationList{.calibrations = {zeros()}}; }
  Result<api::CalibrationReport> calibration(std::int64_t version) override {
    if (version == zeros().version) return zeros();
    return failure({.code = ErrorCode::NotFound,
                    .tried = "read calibration " + std::to_string(version),
                    .seen = "there is no such version"});
  }
  Result<api::ChartReport> calibration_chart(const std::string& standard) override {
    return api::ChartReport{.standard = standard, .quantity = "mean REFF", .verdict = "in control"};
  }
  Result<std::string> calibration_map(std::int64_t, const std::string& name) override { return "map of " + name; }
  static api::CalibrationReport zeros() {
    return {.version = 2,
            .job = "arm-zeros",
            .scan = 3,
            .sample = "mirror M1",
            .counts = true,
            .values = {{.name = "zero_theta_i_deg", .unit = "deg", .value = 0.0123, .u = 0.0021}},
            .covariance = {4.41e-6}};
  }

  Result<api::StatusReport> status() override {
    api::StatusReport report{.version = "0.1.0", .instrument = "bench A", .doing = "idle"};
    report.stage = stage_report();
    const std::lock_guard lock(mutex_);
    report.last_event = std::ssize(events_);
    return report;
  }
  api::HealthReport health() override { return {.ok = true, .version = "0.1.0"}; }
  std::string metrics() override { return "goniod_fake 1\n"; }
  Result<api::StageReport> stage() override { return stage_report(); }
  Result<api::PlanReport> check_plan(const api::PlanSubmission& submission) override {
    if (submission.plan.find("theta_i_degg") != std::string::npos) {
      return failure({.code = ErrorCode::UnknownKey,
                      .seen = "there is no key \"theta_i_degg\" here",
                      .limit = "did you mean \"theta_i_deg\"?",
                      .where = InputLocation{submission.plan_file, 5, "geometry.theta_i_degg"}});
    }
    return api::PlanReport{
        .name = "wheat", .sample = "wheat-07", .points = 624, .merged = 36, .blocked = 3, .items = 1242};
  }
  Result<api::ScanList> scans() override { return api::ScanList{{scan_report()}}; }
  Result<api::ScanReport> scan(std::int64_t scan) override {
    if (scan != 3)
      return failure({.code = ErrorCode::NotFound, .device = "store", .seen = "no scan " + std::to_string(scan)});
    return scan_report();
  }
  Result<api::PointPage> points(std::int64_t, std::int64_t after, int at_most) override {
    return api::PointPage{.points = {{.index = after + 1}}, .next_after = at_most};
  }
  Result<api::BrdfPage> brdf(std::int64_t, std::int64_t, int) override { return api::BrdfPage{}; }
  Result<std::string> export_csv(std::int64_t) override { return std::string("# scan: 3\npoint,theta_i_deg\n0,30\n"); }
  Result<api::ReferenceList> references() override {
    return api::ReferenceList{has_standard ? std::vector{white()} : std::vector<api::ReferenceReport>{}};
  }
  Result<api::ScanChecksReport> checks(std::int64_t scan) override {
    return api::ScanChecksReport{.scan = scan,
                                 .summary = "failed: reciprocity",
                                 .false_alarm = 1e-3,
                                 .checks = {{.name = "reciprocity",
                                             .verdict = "failed",
                                             .compared = 12,
                                             .unit = "exchanged pairs",
                                             .worst_z = 7.5,
                                             .p_value = 1e-9,
                                             .finding = "12 exchanged pairs: worst +7.5 u"}}};
  }
  Result<api::PointBudgetReport> budget(std::int64_t scan, std::optional<std::int64_t> point) override {
    if (point == 99) return failure({.code = ErrorCode::NotFound, .seen = "no value of such a point"});
    return api::PointBudgetReport{.scan = scan,
                                  .point = point.value_or(4),
                                  .chosen = point ? "asked for" : "the point of median U / |f|",
                                  .brdf_per_sr = 0.25,
                                  .u_per_sr = 0.001,
                                  .k = 2.0,
                                  .expanded_u_per_sr = 0.002,
                                  .method = "law of propagation",
                                  .terms = {{.component = "certificate",
                                             .kind = "shared",
                                             .distribution = "normal",
                                             .u = 0.0027,
                                             .unit = "1",
                                             .sensitivity = 0.25,
                                             .contribution_per_sr = 0.000675,
                                             .share_percent = 45.6},
                                            {.component = "noise of the sample reading",
                                             .kind = "random",
                                             .distribution = "normal",
                                             .u = std::nullopt,
                                             .unit = "sr^-1",
                                             .contribution_per_sr = 0.0007,
                                             .share_percent = 54.4,
                                             .degrees_of_freedom = 9.0}}};
  }
  Result<api::ReferenceReport> reference(const std::string& serial) override {
    if (serial != "SRT-1")
      return failure({.code = ErrorCode::NotFound, .seen = "there is no standard \"" + serial + "\""});
    return white();
  }
  Result<api::ReferenceReport> check_reference(const api::ReferenceImport& request) override {
    note("check " + api::to_json(request));
    api::ReferenceReport report = white();
    if (request.text.find("doubt") != std::string::npos) report.table = "contradicts itself";
    return report;
  }
  Result<api::ReferenceReport> import_reference(const api::ReferenceImport& request, const std::string& who) override {
    note("import " + api::to_json(request) + " " + who);
    return white();
  }
  api::InstrumentReport instrument() override {
    return {.name = "bench A",
            .axes = {{.name = "theta_i",
                      .unit = "deg",
                      .low = 0.0,
                      .high = 85.0,
                      .speed_per_s = 20.0,
                      .acceleration_per_s2 = 40.0,
                      .settle_s = 0.1,
                      .window = 0.01}},
            .monitor_low = 0.2,
            .monitor_high = 5.0,
            .store_free_bytes = free_bytes};
  }
  Result<api::AnalysisReport> start_analysis(const api::AnalysisRequest& request, const std::string& who) override {
    note("analysis " + api::to_json(request) + " " + who);
    return analysis_report("queued");
  }
  api::AnalysisList analyses() override { return {{analysis_report("done")}}; }
  Result<api::AnalysisReport> analysis(std::int64_t job) override {
    if (job != 5)
      return failure({.code = ErrorCode::NotFound, .device = "analysis", .seen = "no job " + std::to_string(job)});
    return analysis_report(analysis_state);
  }
  Result<std::string> analysis_file(std::int64_t, const std::string& name) override { return "bytes of " + name; }
  Result<api::AnalysisReport> cancel_analysis(std::int64_t job) override {
    note("cancel analysis " + std::to_string(job));
    return analysis_report("cancelled");
  }
  Result<std::vector<api::Event>> events(std::int64_t after, int at_most) override {
    const std::lock_guard lock(mutex_);
    std::vector<api::Event> found;
    for (const api::Event& event : events_) {
      if (event.number > after && std::ssize(found) < at_most) found.push_back(event);
    }
    return found;
  }

  static api::ReferenceReport white() {
    return {.serial = "SRT-1",
            .material = "Spectralon 99 %",
            .file = "reference/SRT-1.toml",
            .certificate_date = "2025-11-03",
            .expires = "2027-11-03",
            .error = std::nullopt,
            .geometry = "8/h",
            .from_nm = 450.0,
            .to_nm = 650.0,
            .last_theta_i_deg = 75.0,
            .last_theta_r_deg = 75.0,
            .table = "sound",
            .largest_gap = 0.0004,
            .findings = {"as written it gives 1.0280"},
            .entries = {{550.0, 0.9898, 0.00265}},
            .modes = {{"limb", "limb", 0.01, std::nullopt}},
            .text = "[standard]\n"};
  }

  /// Makes the next event durable and gives it back for publishing.
  api::Event commit(const std::string& kind, const std::string& data = "{}") {
    const std::lock_guard lock(mutex_);
    events_.push_back({.number = std::ssize(events_) + 1, .kind = kind, .scan = 3, .who = "local", .data = data});
    return events_.back();
  }

  std::vector<std::string> asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  void answer_held() {
    const std::lock_guard lock(mutex_);
    for (auto& reply : held_) reply(api::CommandReport{});
    held_.clear();
  }
  std::size_t held() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
  }

  std::atomic<bool> hold_replies{false};  ///< moves wait for answer_held
  std::string scan_state = "running";     ///< set before the server starts
  std::int64_t free_bytes = 1'000'000'000'000;
  bool has_standard = true;             ///< on its shelf
  std::string analysis_state = "done";  ///< set before it is asked for

 private:
  static api::AnalysisReport analysis_report(const std::string& state) {
    api::AnalysisReport report{.id = 5, .kind = "export", .scan = 3, .state = state, .progress = 0.5, .doing = "write"};
    if (state == "failed") report.error = Error{.code = ErrorCode::Internal, .device = "gonio-analyse", .seen = "gone"};
    if (state != "done") return report;
    report.files = {{.name = "scan-3.csv", .bytes = 22}, {.name = "scan-3.json", .bytes = 23}};
    report.losses = {{.kind = "sign", .values = 2, .what = "negative values became 0"}};
    return report;
  }
  static api::StageReport stage_report() {
    return {.homed = true,
            .source_shutter = "open",
            .detector_shutter = "closed",
            .axes = {{.name = "theta_i", .unit = "deg", .position = 30.0, .homed = true}}};
  }
  api::ScanReport scan_report() const {
    return {.id = 3,
            .name = "wheat",
            .sample = "wheat-07",
            .state = scan_state,
            .points = 624,
            .items = 1242,
            .accepted = 621};
  }
  void note(std::string what) {
    const std::lock_guard lock(mutex_);
    asked_.push_back(std::move(what));
  }

  mutable std::mutex mutex_;
  std::vector<std::string> asked_;
  std::vector<api::Event> events_;
  std::vector<daemon::Reply<api::CommandReport>> held_;
};

}  // namespace gonio::test
