#include "cli/run.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <ostream>

#include "base/clock.h"
#include "base/write_file.h"
#include "cli/analysis_job.h"
#include "cli/analysis_program.h"
#include "cli/calibration_views.h"
#include "cli/daemon_client.h"
#include "cli/doctor/doctor.h"
#include "cli/doctor/findings_view.h"
#include "cli/invocation.h"
#include "cli/plan_files.h"
#include "cli/reference_files.h"
#include "cli/review_views.h"
#include "cli/scan_comparison.h"
#include "cli/scan_watch.h"
#include "cli/transfer_certificate.h"
#include "cli/views.h"
#include "protocol/api/plan_calibration.h"

namespace gonio::cli {
namespace {

using api::RouteId;

// Names one submission, so that it can be sent again without being made twice.
std::string new_key() {
  std::array<unsigned char, 16> bytes{};
  (void)getrandom(bytes.data(), bytes.size(), 0);
  std::string key;
  constexpr std::string_view kHex = "0123456789abcdef";
  for (const unsigned char byte : bytes) key += {kHex[byte >> 4U], kHex[byte & 15U]};
  return key;
}

// RFC 3986: all but the unreserved as %XX.
std::string url(const std::string& text) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
                          c == '.' || c == '_' || c == '~';
    if (is_plain) {
      escaped += c;
    } else {
      escaped += {'%', kHex[byte >> 4U], kHex[byte & 15U]};
    }
  }
  return escaped;
}

// One invocation at work.
class Runner {
 public:
  Runner(const Invocation& wanted, DaemonClient client, World& world)
      : wanted_(wanted), client_(std::move(client)), world_(world) {}

  Result<int> run() {
    switch (wanted_.verb) {
      case Verb::Status:
        return show(client_.get<api::StatusReport>(RouteId::Status));
      case Verb::Stop:
        return show(client_.post<api::StopReport>(RouteId::Stop, 0, "{}"));
      case Verb::StageShow:
        return show(client_.get<api::StageReport>(RouteId::Stage));
      case Verb::StageMove:
        return command(RouteId::StageMove, api::to_json(wanted_.target));
      case Verb::StageHome:
        return command(RouteId::StageHome, "{}");
      case Verb::StageReset:
        return command(RouteId::StageReset, "{}");
      case Verb::DetectorRead:
        return show(client_.post<api::DetectorReading>(RouteId::DetectorRead, 0, api::to_json(wanted_.reading)));
      case Verb::PlanCheck:
        return check_plan();
      case Verb::ScanRun:
        return run_scan();
      case Verb::ScanList:
        return list_scans();
      case Verb::ScanShow:
        return show(client_.get<api::ScanReport>(RouteId::ScanOne, wanted_.scan));
      case Verb::ScanWatch:
        return watch(wanted_.scan);
      case Verb::ScanPause:
        return command(RouteId::ScanPause, api::to_json(api::PauseRequest{wanted_.now, wanted_.reason}));
      case Verb::ScanResume:
        return command(RouteId::ScanResume, api::to_json(api::ResumeRequest{wanted_.hold}));
      case Verb::ScanFinish:
        return command(RouteId::ScanFinish, "{}");
      case Verb::ScanAbort:
        return command(RouteId::ScanAbort, api::to_json(api::AbortRequest{wanted_.reason}));
      case Verb::ScanSkip:
        return command(RouteId::ScanSkip, "{}");
      case Verb::ScanChange:
        return command(RouteId::ScanChange, api::to_json(wanted_.change));
      case Verb::ScanCompleteMissing:
        return command(RouteId::ScanCompleteMissing, "{}");
      case Verb::ScanCompare:
        return compare_scans(wanted_.scan, wanted_.other_scan);
      case Verb::ScanRepeat:
        return repeat_scan();
      case Verb::Replay:
        return failure(become_replay(wanted_.replay));
      case Verb::DataExport:
        return export_data();
      case Verb::DataTrace:
        return take_job({.kind = "trace", .scan = wanted_.scan, .point = wanted_.point}, "-");
      case Verb::DataPlot:
        return take_job_of_either("plot");
      case Verb::DataQuantities:
        return take_job_of_either("quantities");
      case Verb::DataFit:
        return take_job_of_either("fit");
      case Verb::DataCompare:
        return compare_data();
      case Verb::DataSymmetry:
        return take_job_of_either("symmetry");
      case Verb::DataRepeatability:
        return take_job({.kind = "repeatability", .scan = wanted_.scan, .others = wanted_.others}, wanted_.result);
      case Verb::DataReadings:
        return take_job({.kind = "readings", .scan = wanted_.scan}, wanted_.result);
      case Verb::DataReport:
        return take_job({.kind = "report", .scan = wanted_.scan}, wanted_.result);
      case Verb::DataDescribe:
        return take_job({.kind = "describe", .scan = wanted_.scan}, "");
      case Verb::DataConvert:
        return failure(become_analysis(file_job("export")));
      case Verb::DataImport:
        return failure(become_analysis(file_job("describe")));
      case Verb::DataJobs:
        return list_jobs();
      case Verb::DataCancel:
        return show(client_.post<api::AnalysisReport>(RouteId::AnalysisCancel, wanted_.job, "{}"));
      case Verb::ReferenceList:
        return list_references();
      case Verb::DataCheck:
        return check_data();
      case Verb::DataBudget:
        return show_budget();
      case Verb::ReferenceShow:
        return show_reference(
            client_.get<api::ReferenceReport>(RouteId::ReferenceOne, 0, "serial=" + query_text(wanted_.serial)));
      case Verb::ReferenceCheck:
        return send_reference(RouteId::ReferenceCheck);
      case Verb::ReferenceImport:
        return send_reference(RouteId::ReferenceImport);
      case Verb::Instrument:
        return show(client_.get<api::InstrumentReport>(RouteId::Instrument));
      case Verb::Doctor:
        return run_doctor();
      case Verb::Events:
        return list_events();
      case Verb::CalibrationList:
        return show_list(
            client_.get<api::CalibrationList>(RouteId::Calibrations),
            [](const api::CalibrationList& list) -> const auto& { return list.calibrations; });
      case Verb::CalibrationShow:
        return show(client_.get<api::CalibrationReport>(RouteId::CalibrationOne, wanted_.scan));
      case Verb::CalibrationUse:
        return use_calibration();
      case Verb::CalibrationCertificate:
        return print_certificate();
      case Verb::CalibrationMaps:
        return write_maps();
      case Verb::CalibrationChart:
        return show_chart();
      case Verb::ScanRecompute:
        return recompute_scan();
    }
    return 0;
  }

 private:
  template <class T>
  Result<int> show(const Result<Told<T>>& told) {
    if (!told) return failure(told.error());
    if (wanted_.format == Format::Json || wanted_.format == Format::Jsonl) {
      world_.out << told->text << '\n';
    } else if (wanted_.format == Format::Csv) {
      print_csv(world_.out, view(told->value));
    } else {
      print_facts(world_.out, view(told->value));
    }
    return 0;
  }

  template <class List, class Items>
  Result<int> show_list(const Result<Told<List>>& told, Items items) {
    if (!told) return failure(told.error());
    if (wanted_.format == Format::Json) {
      world_.out << told->text << '\n';
    } else if (wanted_.format == Format::Jsonl) {
      for (const auto& item : items(told->value)) world_.out << api::to_json(item) << '\n';
    } else if (wanted_.format == Format::Csv) {
      print_csv(world_.out, view(told->value));
    } else {
      print_table(world_.out, view(told->value));
    }
    return 0;
  }

  Result<int> list_scans() {
    return show_list(
        client_.get<api::ScanList>(RouteId::ScanList),
        [](const api::ScanList& list) -> const auto& { return list.scans; });
  }

  Result<int> list_references() {
    return show_list(
        client_.get<api::ReferenceList>(RouteId::References),
        [](const api::ReferenceList& list) -> const auto& { return list.references; });
  }

  // Exit code 1: one of them failed.
  Result<int> check_data() {
    const auto told = client_.get<api::ScanChecksReport>(RouteId::ScanChecks, wanted_.scan);
    const Result<int> shown = show_list(
        told, [](const api::ScanChecksReport& report) -> const auto& { return report.checks; });
    if (!shown) return shown;
    if (wanted_.format == Format::Table) {
      world_.out << '\n';
      for (const auto& check : told->value.checks) world_.out << check.name << ": " << check.finding << '\n';
      world_.out << told->value.summary << '\n';
    }
    return has_failed(told->value) ? 1 : 0;
  }

  Result<int> show_budget() {
    const std::string query = wanted_.budget_point < 0 ? "" : "point=" + std::to_string(wanted_.budget_point);
    const auto told = client_.get<api::PointBudgetReport>(RouteId::ScanBudget, wanted_.scan, query);
    if (told && wanted_.format == Format::Table) {
      print_facts(world_.out, budget_head(told->value));
      world_.out << '\n';
    }
    return show_list(
        told, [](const api::PointBudgetReport& report) -> const auto& { return report.terms; });
  }

  // Exit code 1: its table contradicts itself.
  Result<int> show_reference(const Result<Told<api::ReferenceReport>>& told) {
    const Result<int> shown = show(told);
    if (!shown) return shown;
    if (wanted_.format == Format::Table) {
      for (const std::string& finding : told->value.findings) world_.out << "its table: " << finding << '\n';
    }
    return told->value.table == kContradiction ? 1 : 0;
  }

  Result<int> send_reference(RouteId route) {
    const auto request = read_reference(wanted_.file, wanted_.shape_file, wanted_.shape_of, wanted_.replace);
    if (!request) return failure(request.error());
    return show_reference(client_.post<api::ReferenceReport>(route, 0, api::to_json(*request)));
  }

  Result<int> command(RouteId route, const std::string& body) {
    return show(client_.post<api::CommandReport>(route, wanted_.scan, body));
  }

  Result<int> print_certificate() {
    const auto transfer = client_.get<api::CalibrationReport>(RouteId::CalibrationOne, wanted_.scan);
    if (!transfer) return failure(transfer.error());
    const auto text = certificate_csv(transfer->value, wanted_.expires, wanted_.longest_gap_nm);
    if (!text) return failure(text.error());
    world_.out << *text;
    return 0;
  }

  Result<int> use_calibration() {
    const Result<int> done = command(RouteId::CalibrationUse, api::to_json(wanted_.use));
    if (!done) return done;
    world_.err << (wanted_.use.in_use ? "calibration " + std::to_string(wanted_.scan) + " counts from now on"
                                      : "calibration " + std::to_string(wanted_.scan) + " counts no more")
               << "; a scan that was computed before: gonioctl scan recompute SCAN\n";
    return done;
  }

  // Which maps there are, the job says.
  Result<int> write_maps() {
    const auto found = client_.get<api::CalibrationReport>(RouteId::CalibrationOne, wanted_.scan);
    if (!found) return failure(found.error());
    std::vector<std::string> names{"dark", "bad_pixels"};
    if (found->value.job == api::calibration_job_name(api::CalibrationJob::FlatField)) names.emplace_back("flat");
    std::string lines = "[detector.maps]\n";
    for (const std::string& name : names) {
      const Result<std::string> bytes = client_.text(RouteId::CalibrationMap, wanted_.scan, "name=" + name);
      if (!bytes) return failure(bytes.error());
      const std::string file = fmt::format("{}-{}.map", name, wanted_.scan);
      GONIO_TRY(write_file((std::filesystem::path(wanted_.result) / file).string(), *bytes));
      lines += fmt::format("{} = \"{}\"\n", name, file);
    }
    world_.out << lines;
    world_.err << found->value.note
               << "\nthey count for frames taken after goniod's next start with these lines in "
                  "instrument.toml, the files beside it; what is stored stays as it was reduced\n";
    return 0;
  }

  // Exit code 1: the last run breaks a rule.
  Result<int> show_chart() {
    const auto chart = client_.get<api::ChartReport>(RouteId::CalibrationChart, 0, "standard=" + url(wanted_.standard));
    if (!chart) return failure(chart.error());
    if (wanted_.format == Format::Json || wanted_.format == Format::Jsonl) {
      world_.out << chart->text << '\n';
    } else if (wanted_.format == Format::Csv) {
      print_csv(world_.out, view(chart->value));
    } else {
      print_table(world_.out, view(chart->value));
    }
    world_.err << chart_sentence(chart->value) << '\n';
    return chart->value.points.empty() || chart->value.points.back().broken.empty() ? 0 : 1;
  }

  // The daemon answers when it is sure to be computed, and says by an event when it is there.
  Result<int> recompute_scan() {
    const auto before = client_.get<api::StatusReport>(RouteId::Status);
    if (!before) return failure(before.error());
    const auto asked =
        client_.post<api::CommandReport>(RouteId::ScanRecompute, wanted_.scan, api::to_json(wanted_.recompute));
    if (!asked) return failure(asked.error());
    const Result<void> listened = client_.events(before->value.last_event, [&](const api::Event& event) {
      return event.kind != "brdf-computed" || event.scan != wanted_.scan;
    });
    if (!listened) return failure(listened.error());
    return show(client_.get<api::ScanReport>(RouteId::ScanOne, wanted_.scan));
  }

  Result<std::string> submission() {
    Result<api::PlanSubmission> plan = read_plan(wanted_.file);
    if (!plan) return failure(plan.error());
    plan->priority = wanted_.priority;
    plan->preempt = wanted_.preempt;
    plan->start_utc = wanted_.start_utc;
    return api::to_json(*plan);
  }

  Result<int> check_plan() {
    const Result<std::string> body = submission();
    if (!body) return failure(body.error());
    return show(client_.post<api::PlanReport>(RouteId::PlanCheck, 0, *body));
  }

  Result<int> run_scan() {
    const Result<std::string> body = submission();
    if (!body) return failure(body.error());
    const std::string key = wanted_.key.empty() ? new_key() : wanted_.key;
    const auto submitted = client_.post<api::CommandReport>(RouteId::ScanSubmit, 0, *body, {{"Idempotency-Key", key}});
    if (!submitted || !wanted_.watch) return show(submitted);
    return watch(submitted->value.scan);
  }

  Result<int> watch(std::int64_t scan) {
    const Result<api::ScanReport> ended = watch_scan(client_, scan, world_);
    if (!ended && world_.interrupted) {
      world_.err << "gonioctl: interrupted; scan " << scan << " goes on. See it again with: gonioctl scan watch "
                 << scan << '\n';
      return kInterruptedExit;
    }
    if (!ended) return failure(ended.error());
    print_facts(world_.out, view(*ended));
    return ended->state == "done" || ended->state == "finished-early" ? 0 : 1;
  }

  Result<std::vector<api::BrdfReport>> values_of(std::int64_t scan) {
    std::vector<api::BrdfReport> values;
    std::string query;
    for (;;) {
      Result<Told<api::BrdfPage>> page = client_.get<api::BrdfPage>(RouteId::ScanBrdf, scan, query);
      if (!page) return failure(page.error());
      values.insert(values.end(), page->value.values.begin(), page->value.values.end());
      if (!page->value.next_after) return values;
      query = "after=" + std::to_string(*page->value.next_after);
    }
  }

  // Exit code 1: they do not agree, or have no point in common.
  Result<int> compare_scans(std::int64_t a, std::int64_t b) {
    const auto of_a = values_of(a);
    if (!of_a) return failure(of_a.error());
    const auto of_b = values_of(b);
    if (!of_b) return failure(of_b.error());
    const ScanComparison comparison = compare_values(*of_a, *of_b);
    if (wanted_.format == Format::Csv) {
      print_csv(world_.out, view(comparison));
    } else {
      print_table(world_.out, view(comparison));
    }
    world_.err << "scan " << a << " and scan " << b << ": " << summary_of(comparison) << '\n';
    return !comparison.points.empty() && comparison.do_agree() ? 0 : 1;
  }

  // The plan is sent as it was stored, under a key of its own.
  Result<int> repeat_scan() {
    const auto first = client_.get<api::ScanReport>(RouteId::ScanOne, wanted_.scan);
    if (!first) return failure(first.error());
    const api::PlanSubmission again{.plan = first->value.plan.value_or(""),
                                    .plan_file = first->value.plan_file.value_or(""),
                                    .parts = first->value.plan_parts};
    const auto submitted =
        client_.post<api::CommandReport>(RouteId::ScanSubmit, 0, api::to_json(again), {{"Idempotency-Key", new_key()}});
    if (!submitted) return failure(submitted.error());
    const Result<int> watched = watch(submitted->value.scan);
    if (!watched || *watched != 0) return watched;
    return compare_scans(wanted_.scan, submitted->value.scan);
  }

  Result<int> list_jobs() {
    return show_list(
        client_.get<api::AnalysisList>(RouteId::AnalysisList),
        [](const api::AnalysisList& list) -> const auto& { return list.jobs; });
  }

  FileJob file_job(const std::string& kind) const {
    return {.kind = kind,
            .file = wanted_.input,
            .format = kind == "export" ? wanted_.export_format : "",
            .model = wanted_.model,
            .output = wanted_.result,
            .as_json = wanted_.format == Format::Json || wanted_.format == Format::Jsonl};
  }

  // Of a scan's number by the daemon, or of a file beside it.
  Result<int> take_job_of_either(const std::string& kind) {
    const std::optional<std::int64_t> scan = scan_number(wanted_.input);
    if (!scan) return failure(become_analysis(file_job(kind)));
    return take_job({.kind = kind, .scan = *scan, .model = wanted_.model}, wanted_.result);
  }

  Result<int> compare_data() {
    const std::optional<std::int64_t> scan = scan_number(wanted_.input);
    Result<api::AnalysisRequest> request = comparison_request(wanted_.other, scan.has_value());
    if (!request) return failure(request.error());
    if (scan) {
      request->scan = *scan;
      return take_job(*request, wanted_.result);
    }
    FileJob job = file_job("compare");
    job.other_file = request->other_file;
    job.other_model = request->other_model;
    return failure(become_analysis(job));
  }

  // A job of the worker program: done, fetched, told of.
  Result<int> take_job(const api::AnalysisRequest& request, const std::string& output) {
    const Result<api::AnalysisReport> job = run_analysis(client_, request, world_);
    if (!job) return failure(job.error());
    const Result<std::vector<std::string>> written = take_files(client_, *job, output, world_);
    if (!written) return failure(written.error());
    if (wanted_.format == Format::Json || wanted_.format == Format::Jsonl) {
      world_.out << api::to_json(*job) << '\n';
    } else {
      tell(*job, *written, world_);
    }
    return 0;
  }

  Result<int> export_data() {
    if (wanted_.export_format != "csv") {
      // Files that come in twos, or in binary, have names of their own rather than a terminal.
      return take_job({.kind = "export", .scan = wanted_.scan, .format = wanted_.export_format},
                      wanted_.file == "-" && world_.out_is_terminal ? "" : wanted_.file);
    }
    const Result<std::string> csv = client_.text(RouteId::ScanExport, wanted_.scan, "format=csv");
    if (!csv) return failure(csv.error());
    if (wanted_.file == "-") {
      world_.out << *csv;
      return 0;
    }
    GONIO_TRY(write_file(wanted_.file, *csv));
    world_.err << "scan " << wanted_.scan << " written to " << wanted_.file << '\n';
    return 0;
  }

  Result<int> list_events() {
    std::int64_t last = 0;
    if (!wanted_.follow) {
      const auto status = client_.get<api::StatusReport>(RouteId::Status);
      if (!status) return failure(status.error());
      last = status->value.last_event;
      if (wanted_.after >= last) return 0;
    }
    const Result<void> listened = client_.events(wanted_.after, [&](const api::Event& event) {
      print_event(event);
      return wanted_.follow || event.number < last;
    });
    if (listened) return 0;
    return failure(listened.error());
  }

  Result<int> run_doctor() {
    const auto open_another = [this]() -> Result<DaemonClient> {
      Result<HttpClient> http = HttpClient::open(client_.connect(), world_.interrupted);
      if (!http) return failure(http.error());
      return DaemonClient(std::move(*http), client_.connect());
    };
    std::vector<Finding> findings;
    const bool tells = wanted_.format == Format::Table;
    Doctor doctor(
        client_, open_another,
        {.move = wanted_.move, .today = iso8601(SystemClock().utc_now()).substr(0, 10), .own_version = GONIO_VERSION},
        [&](const Finding& finding) {
          findings.push_back(finding);
          if (tells) print_finding(world_.out, finding);
        });
    const Result<bool> is_well = doctor.run();
    if (!is_well) return failure(is_well.error());
    if (wanted_.format == Format::Csv) print_csv(world_.out, view(findings));
    if (wanted_.format == Format::Json || wanted_.format == Format::Jsonl)
      world_.out << findings_json(findings) << '\n';
    return *is_well ? 0 : 1;
  }

  void print_event(const api::Event& event) {
    if (wanted_.format == Format::Json || wanted_.format == Format::Jsonl) {
      world_.out << api::to_json(event) << std::endl;
      return;
    }
    Table table = view(event);
    if (wanted_.format == Format::Csv) {
      if (!first_event_) table.header.clear();
      first_event_ = false;
      print_csv(world_.out, table);
    } else {
      const std::vector<std::string>& cells = table.rows[0];
      for (std::size_t i = 0; i < cells.size(); ++i) world_.out << (i == 0 ? "" : "  ") << cells[i];
      world_.out << '\n';
    }
    world_.out << std::flush;
  }

  const Invocation& wanted_;
  DaemonClient client_;
  World& world_;
  bool first_event_ = true;
};

int show_error(const Error& error, World& world) {
  if (world.interrupted) {
    world.err << "gonioctl: interrupted\n";
    return kInterruptedExit;
  }
  world.err << "gonioctl: " << explain(error) << '\n';
  return traits(error.code).exit_code;
}

}  // namespace

int run(const std::vector<std::string>& arguments, World& world) {
  const auto wanted = read_command_line(arguments, world.default_connect);
  if (!wanted) {
    (wanted.error().exit_code == 0 ? world.out : world.err) << wanted.error().text;
    return wanted.error().exit_code;
  }
  Result<HttpClient> http = HttpClient::open(wanted->connect, world.interrupted);
  if (!http) return show_error(http.error(), world);
  const Result<int> done = Runner(*wanted, DaemonClient(std::move(*http), wanted->connect), world).run();
  return done ? *done : show_error(done.error(), world);
}

}  // namespace gonio::cli
