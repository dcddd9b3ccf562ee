#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <sstream>

#include "cli/invocation.h"
#include "protocol/api/analysis.h"

namespace gonio::cli {
namespace {

const std::map<std::string, Format> kFormats{
    {"table", Format::Table}, {"json", Format::Json}, {"jsonl", Format::Jsonl}, {"csv", Format::Csv}};

// The grammar of gonioctl, filling one Invocation.
class CommandLine {
 public:
  explicit CommandLine(Invocation& wanted) : wanted_(wanted) {
    app_.require_subcommand(1);
    app_.fallthrough();
    app_.set_version_flag("--version", "gonioctl " GONIO_VERSION);
    app_.add_option("--connect", wanted.connect, "the daemon: http://ADDRESS:PORT or unix:PATH ($GONIOD_CONNECT)")
        ->capture_default_str();
    app_.add_option("-o,--output", wanted.format, "how answers are printed (table)")
        ->transform(CLI::CheckedTransformer(kFormats, CLI::ignore_case))
        ->option_text("table|json|jsonl|csv");
    leaf(app_, "status", "what the instrument does", Verb::Status);
    leaf(app_, "stop", "STOP: halt all motion now, in every state", Verb::Stop);
    add_stage();
    add_detector();
    add_plan();
    add_scan();
    add_data();
    leaf(app_, "instrument", "the instrument as the daemon was told of it", Verb::Instrument);
    CLI::App& doctor =
        *leaf(app_, "doctor", "commissioning checks: what works, what does not, what to do", Verb::Doctor);
    doctor.add_flag(
        "--move", wanted.move,
        "also home, move each axis a little and back, take a dark and a lit reading, and STOP once: look first");
    CLI::App& events = *leaf(app_, "events", "what was committed, one event a line", Verb::Events);
    events.add_flag("-f,--follow", wanted.follow, "wait for more");
    events.add_option("--after", wanted.after, "begin after this event's number")->check(CLI::NonNegativeNumber);
    add_replay();
    add_calibration();
    add_reference();
  }

  [[nodiscard]] CLI::App& app() { return app_; }

 private:
  CLI::App& group(const std::string& name, const std::string& help) {
    CLI::App& made = *app_.add_subcommand(name, help);
    made.require_subcommand(1);
    made.fallthrough();
    return made;
  }

  CLI::App* leaf(CLI::App& parent, const std::string& name, const std::string& help, Verb verb) {
    CLI::App* made = parent.add_subcommand(name, help);
    made->fallthrough();
    made->callback([this, verb] { wanted_.verb = verb; });
    return made;
  }

  CLI::App& scan_leaf(CLI::App& parent, const std::string& name, const std::string& help, Verb verb) {
    CLI::App& made = *leaf(parent, name, help, verb);
    made.add_option("scan", wanted_.scan, "the scan's number")->required()->check(CLI::PositiveNumber);
    return made;
  }

  void add_stage() {
    CLI::App& stage = *app_.add_subcommand("stage", "the stage: where it is, moves by hand");
    stage.fallthrough();
    stage.require_subcommand(0, 1);
    stage.preparse_callback([this](std::size_t) { wanted_.verb = Verb::StageShow; });
    leaf(stage, "show", "where it is", Verb::StageShow);
    CLI::App& move = *leaf(stage, "move", "move the named axes, and wait until they stand", Verb::StageMove);
    api::MoveRequest& to = wanted_.target;
    move.add_option("--theta-i", to.theta_i_deg, "source arm, deg");
    move.add_option("--theta-r", to.theta_r_deg, "detector arm, deg");
    move.add_option("--phi-r", to.phi_r_deg, "detector azimuth, deg");
    move.add_option("--phi-i", to.phi_i_deg, "sample azimuth, deg");
    move.add_option("--carriage", to.carriage_mm, "sample carriage, mm");
    move.add_option("--filter", to.filter_wheel_slot, "filter wheel, slot");
    move.add_option("--source-shutter-open", to.source_shutter_open, "true or false");
    move.add_option("--detector-shutter-open", to.detector_shutter_open, "true or false");
    leaf(stage, "home", "find the home position of all axes", Verb::StageHome);
    leaf(stage, "reset", "clear STOP, heartbeat trip and faults; moves nothing", Verb::StageReset);
  }

  void add_detector() {
    CLI::App& detector = group("detector", "the detector: readings by hand");
    CLI::App& read = *leaf(detector, "read", "one reading, nothing subtracted, kept nowhere", Verb::DetectorRead);
    api::DetectorReadRequest& wanted = wanted_.reading;
    read.add_option("--exposure", wanted.exposure_s, "of a camera, s")->check(CLI::PositiveNumber);
    read.add_option("--range", wanted.range_w, "of a radiometer, its full scale in W")->check(CLI::PositiveNumber);
    CLI::Option* lit = read.add_flag_callback(
        "--lit", [&wanted] { wanted.lit = true; }, "open both shutters for it, and put them back");
    read.add_flag_callback(
            "--dark", [&wanted] { wanted.lit = false; }, "close the detector's shutter for it, and put it back")
        ->excludes(lit);
  }

  void add_plan() {
    CLI::App& plan = group("plan", "measurement plans");
    CLI::App& check = *leaf(plan, "check", "dry run: points, time, refusals; nothing moves", Verb::PlanCheck);
    check.add_option("file", wanted_.file, "plan.toml")->required();
  }

  void add_scan() {
    CLI::App& scan = group("scan", "scans: plans being run");
    CLI::App& run = *leaf(scan, "run", "queue a plan", Verb::ScanRun);
    run.add_option("file", wanted_.file, "plan.toml")->required();
    run.add_flag("--watch", wanted_.watch, "show progress until it ends");
    run.add_option("--key", wanted_.key, "the same key again gives the same scan");
    run.add_option("--priority", wanted_.priority, "higher ones run first (0)")->check(CLI::Range(-100, 100));
    run.add_option("--at", wanted_.start_utc, "not before this time, in UTC: 2026-11-22T18:05Z");
    run.add_flag("--preempt", wanted_.preempt, "run inside a scan of lower priority, which goes on by itself after");
    leaf(scan, "list", "scans: those under way, the queue in its order, then the rest, newest first", Verb::ScanList);
    scan_leaf(scan, "show", "one scan", Verb::ScanShow);
    scan_leaf(scan, "watch", "progress until it ends", Verb::ScanWatch);
    CLI::App& pause = scan_leaf(scan, "pause", "wait after the item in hand", Verb::ScanPause);
    pause.add_flag("--now", wanted_.now, "drop the item in hand");
    pause.add_option("--reason", wanted_.reason, "for the record");
    CLI::App& resume = scan_leaf(scan, "resume", "end the holds whose cause is gone, and go on", Verb::ScanResume);
    resume.add_option("--hold", wanted_.hold, "just this one")
        ->check(CLI::IsMember({"operator", "lamp", "door", "device", "disk", "restart"}));
    scan_leaf(scan, "finish", "end early, keep the data", Verb::ScanFinish);
    scan_leaf(scan, "abort", "end at once", Verb::ScanAbort).add_option("--reason", wanted_.reason, "for the record");
    scan_leaf(scan, "skip", "give up the item in hand", Verb::ScanSkip);
    add_scan_change(scan);
    scan_leaf(scan, "complete-missing", "queue a new scan of the points that an ended one lacks",
              Verb::ScanCompleteMissing);
    CLI::App& compare =
        scan_leaf(scan, "compare", "two scans of one plan, point by point in units of U", Verb::ScanCompare);
    compare.add_option("other", wanted_.other_scan, "the other scan's number")->required()->check(CLI::PositiveNumber);
    scan_leaf(scan, "repeat", "run a scan's plan again, and compare", Verb::ScanRepeat);
    scan_leaf(scan, "recompute", "its BRDF anew from the stored readings, without the instrument", Verb::ScanRecompute)
        .add_option("--calibration", wanted_.recompute.calibration,
                    "versions as \"3 5\", or none for instrument.toml alone (those that count now)");
  }

  void add_scan_change(CLI::App& scan) {
    CLI::App& change = scan_leaf(scan, "change", "change what is not measured yet", Verb::ScanChange);
    api::ChangeRequest& to = wanted_.change;
    change.add_option("--snr", to.target_snr, "signal-to-noise of a reading")->check(CLI::Range(1.0, 1e6));
    change.add_option("--max-time", to.max_time_s, "of one reading, s")->check(CLI::Range(1e-4, 3600.0));
    change.add_option("--order", to.order, "of the points not begun")
        ->check(CLI::IsMember({"as-written", "reversed", "random", "fastest"}));
    change.add_option("--seed", to.seed, "of a random order")->check(CLI::NonNegativeNumber);
    change.add_option("--priority", to.priority, "higher ones run first")->check(CLI::Range(-100, 100));
    change.add_option("--at", to.start_utc, "of a queued scan: not before this time, in UTC: 2026-11-22T18:05Z");
    change.add_option("--reason", to.reason, "for the record");
  }

  CLI::App& version_leaf(CLI::App& parent, const std::string& name, const std::string& help, Verb verb) {
    CLI::App& made = *leaf(parent, name, help, verb);
    made.add_option("version", wanted_.scan, "the calibration's version")->required()->check(CLI::PositiveNumber);
    return made;
  }

  void add_calibration() {
    CLI::App& calibration = group("calibration", "what calibration jobs have found");
    leaf(calibration, "list", "all of it, newest first, and what counts", Verb::CalibrationList);
    version_leaf(calibration, "show", "one version: values, u, correlations, history", Verb::CalibrationShow);
    CLI::App& use =
        version_leaf(calibration, "use", "from now on this version of its job counts", Verb::CalibrationUse);
    use.add_flag_callback(
        "--end", [this] { wanted_.use.in_use = false; }, "it counts no more: instrument.toml alone, for its job");
    use.add_option("--reason", wanted_.use.reason, "for the record");
    CLI::App& certificate =
        version_leaf(calibration, "certificate", "of a transfer: the working standard's, as CSV for `reference import`",
                     Verb::CalibrationCertificate);
    certificate.add_option("--expires", wanted_.expires, "the last day on which it holds, as 2027-11-22")->required();
    certificate.add_option("--longest-gap-nm", wanted_.longest_gap_nm,
                           "between wavelengths so far apart it may be drawn straight (1)");
    version_leaf(calibration, "maps", "of a dark-map or flat-field: its files for [detector.maps] of instrument.toml",
                 Verb::CalibrationMaps)
        .add_option("--to", wanted_.result, "the folder they go to (here)");
    leaf(calibration, "chart", "the control chart of a check standard", Verb::CalibrationChart)
        ->add_option("standard", wanted_.standard, "its name: the sample of its plans")
        ->required();
  }

  void add_replay() {
    CLI::App& replay =
        *leaf(app_, "replay", "run a recorded tape without devices, on the goniod beside this", Verb::Replay);
    replay.add_option("tape", wanted_.replay.tape, "made by goniod --record")->required();
    replay.add_option("--store", wanted_.replay.store, "the database that it makes (TAPE.sqlite)");
    replay.add_option("--against", wanted_.replay.against, "compare with this database, times aside");
    replay.add_option("--instrument", wanted_.replay.instrument, "another instrument.toml than the tape's");
  }

  void add_reference() {
    CLI::App& reference = group("reference", "reference standards");
    leaf(reference, "list", "the standards this daemon knows", Verb::ReferenceList);
    leaf(reference, "show", "one standard: certificate, modes, what is to be said of its table", Verb::ReferenceShow)
        ->add_option("serial", wanted_.serial, "its serial number")
        ->required();
    CLI::App& check =
        *leaf(reference, "check", "look at a file before it is imported; nothing is written", Verb::ReferenceCheck);
    CLI::App& import = *leaf(reference, "import", "put a standard on the daemon's shelf", Verb::ReferenceImport);
    for (CLI::App* made : {&check, &import}) {
      made->add_option("file", wanted_.file, "reference.toml, or a certificate as CSV")->required();
      CLI::Option* shape = made->add_option("--shape", wanted_.shape_file, "a shape table as CSV");
      made->add_option("--shape-of", wanted_.shape_of, "take the shape of this standard of the shelf")->excludes(shape);
    }
    import.add_flag("--replace", wanted_.replace, "a standard of this serial number with another text");
  }

  void add_data() {
    CLI::App& data = group("data", "results");
    scan_leaf(data, "check", "self-checks: closure, reciprocity, symmetry, energy, repeats, dark, exposures",
              Verb::DataCheck);
    scan_leaf(data, "budget", "the uncertainty budget of a point, the largest share first", Verb::DataBudget)
        .add_option("point", wanted_.budget_point, "by index (the point of median U)")
        ->check(CLI::NonNegativeNumber);
    CLI::App& exported = scan_leaf(data, "export", "BRDF with uncertainty, as a file", Verb::DataExport);
    std::vector<std::string> formats{"csv"};
    formats.insert(formats.end(), api::kExportFormats.begin(), api::kExportFormats.end());
    exported.add_option("--format", wanted_.export_format, "csv: every point with its status; csv+json loses nothing")
        ->check(CLI::IsMember(formats));
    wanted_.file = "-";
    exported.add_option("-o,--file", wanted_.file, "where to; - is standard output");
    CLI::App& trace = scan_leaf(data, "trace", "a value down to its raw readings", Verb::DataTrace);
    trace.add_option("point", wanted_.point, "the point's number")->required()->check(CLI::NonNegativeNumber);
    CLI::App& plot = *leaf(data, "plot", "lobe, polar map, cuts; of a scan its budget and course too", Verb::DataPlot);
    plot.add_option("input", wanted_.input, "a scan's number, or a BRDF file")->required();
    plot.add_option("-o,--file", wanted_.result, "what the pictures' names begin with");
    CLI::App& report = scan_leaf(data, "report", "one page that a lab signs", Verb::DataReport);
    report.add_option("-o,--file", wanted_.result, "where to (scan-N-report.html)");
    CLI::App& quantities = *leaf(data, "quantities", "rho_dh, A, RADF, R and R_rs, each with U", Verb::DataQuantities);
    quantities.add_option("input", wanted_.input, "a scan's number, or a BRDF file")->required();
    CLI::App& fit = *leaf(data, "fit", "models by their numbers, with U, correlation and what is left", Verb::DataFit);
    fit.add_option("input", wanted_.input, "a scan's number, or a BRDF file")->required();
    fit.add_option("--model", wanted_.model, "rpv, 'lambertian + ggx'; several with commas between");
    fit.add_option("-o,--file", wanted_.result, "what the results' names begin with");
    add_comparisons(data);
    CLI::App& readings = scan_leaf(data, "readings", "every raw reading with its lamp, temperatures, humidity, as CSV",
                                   Verb::DataReadings);
    readings.add_option("-o,--file", wanted_.result, "where to (scan-N-readings.csv)");
    scan_leaf(data, "describe", "reflectances, and how far readings are from their neighbours", Verb::DataDescribe);
    add_data_files(data, formats);
    leaf(data, "jobs", "what the worker program did and does", Verb::DataJobs);
    CLI::App& cancel = *leaf(data, "cancel", "end a job of the worker program", Verb::DataCancel);
    cancel.add_option("job", wanted_.job, "the job's number")->required()->check(CLI::PositiveNumber);
  }

  void add_comparisons(CLI::App& data) {
    CLI::App& compare = *leaf(data, "compare", "in units of U, where what both share cancels", Verb::DataCompare);
    compare.add_option("input", wanted_.input, "a scan's number, or a BRDF file")->required();
    compare
        .add_option("other", wanted_.other,
                    "a scan's number, a BRDF file, or a model: \"rpv rho0=0.133 k=0.851 g=-0.114\"; \"rpv\" is fitted")
        ->required();
    compare.add_option("-o,--file", wanted_.result, "what the results' names begin with");
    CLI::App& symmetry =
        *leaf(data, "symmetry", "reciprocity, left and right, turns: pairs in units of U", Verb::DataSymmetry);
    symmetry.add_option("input", wanted_.input, "a scan's number, or a BRDF file")->required();
    symmetry.add_option("-o,--file", wanted_.result, "what the results' names begin with");
    CLI::App& repeated = scan_leaf(data, "repeatability", "the spread of each point over a campaign, beside its U",
                                   Verb::DataRepeatability);
    repeated.add_option("others", wanted_.others, "the other scans (all of the first one's campaign and sample)")
        ->check(CLI::PositiveNumber);
    repeated.add_option("-o,--file", wanted_.result, "what the results' names begin with");
  }

  // Without a daemon, by the gonio-analyse beside this program.
  void add_data_files(CLI::App& data, std::vector<std::string> formats) {
    formats.erase(formats.begin());
    CLI::App& convert = *leaf(data, "convert", "a BRDF file into another format", Verb::DataConvert);
    convert.add_option("input", wanted_.input, "a file of any format that is known")->required();
    convert.add_option("--format", wanted_.export_format, "the new one")->required()->check(CLI::IsMember(formats));
    convert.add_option("-o,--file", wanted_.result, "where to; the format gives the ending");
    CLI::App& import = *leaf(data, "import", "what is in a BRDF file, and what it integrates to", Verb::DataImport);
    import.add_option("input", wanted_.input, "a file of any format that is known")->required();
  }

  Invocation& wanted_;
  CLI::App app_{"gonioctl asks goniod, the daemon of a gonioreflectometer.", "gonioctl"};
};

}  // namespace

tl::expected<Invocation, Advice> read_command_line(const std::vector<std::string>& arguments,
                                                   const std::string& default_connect) {
  Invocation wanted;
  wanted.connect = default_connect;
  CommandLine line(wanted);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    line.app().parse(reversed);
  } catch (const CLI::ParseError& e) {
    std::ostringstream out;
    std::ostringstream err;
    const bool asked_for = line.app().exit(e, out, err) == 0;
    return tl::unexpected<Advice>({asked_for ? out.str() : err.str(), asked_for ? 0 : 2});
  }
  return wanted;
}

}  // namespace gonio::cli
