// What bad input gets: an error that names the place and the limit, an exit code that says of what kind it is, and an
// instrument and a store that are as they were.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// The exit codes of gonioctl (DESIGN, section 7).
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kNoDaemon = 3;
constexpr int kLimit = 6;

constexpr const char* kSerial = "SRT-99-020";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the text has no \"" << from << "\":\n" << text;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class BadInput : public testing::Test {
 protected:
  // A daemon on references of the test's own, whose first look at the stage is over: what changes after that was asked
  // for.
  void bring_up() {
    bench_.bring_up_daemon();
    EXPECT_TRUE(eventually([&] { return !bench_.get("status").at("stage").is_null(); }, kStepDeadline)) << bench_.log();
    before_ = bench_.simulator().stage();
    last_event_ = bench_.get("status").at("last_event").get<long>();
    scans_ = bench_.get("scans").at("scans").size();
  }

  void expect_nothing_happened() {
    const SeenStage after = bench_.simulator().stage();
    EXPECT_EQ(after.motion_commands, before_.motion_commands) << "nothing may have moved";
    EXPECT_EQ(after.shutter_commands, before_.shutter_commands);
    EXPECT_EQ(after.halted, before_.halted);
    EXPECT_EQ(bench_.get("status").at("last_event").get<long>(), last_event_) << "nothing may have been written";
    EXPECT_EQ(bench_.get("scans").at("scans").size(), scans_);
  }

  static void expect_refused(const Finished& run, int exit_code, const std::vector<std::string>& said) {
    EXPECT_EQ(run.exit_code, exit_code) << run.output << run.errors;
    for (const std::string& words : said) {
      EXPECT_NE(run.errors.find(words), std::string::npos) << "not said: \"" << words << "\" in:\n" << run.errors;
    }
  }

  // Both as a dry run and as a run: the same code decides.
  void expect_plan_refused(const std::string& plan, int exit_code, const std::vector<std::string>& said) {
    const std::string file = bench_.file("plan.toml", plan);
    expect_refused(bench_.gonioctl({"plan", "check", file}), exit_code, said);
    expect_refused(bench_.gonioctl({"scan", "run", file}), exit_code, said);
    expect_nothing_happened();
  }

  // The daemon is to find the simulator's reference with the line of `key` written otherwise.
  void use_reference_with(const std::string& key, const std::string& line) {
    const std::string name = std::string(kSerial) + ".toml";
    const std::string text = text_of(bench_.simulator().reference_folder() + "/" + name);
    const std::size_t begin = text.find("\n" + key + " = ") + 1;
    ASSERT_NE(begin, 0U) << "the reference has no " << key << ":\n" << text;
    std::filesystem::create_directories(bench_.folder() + "/references");
    const std::string changed = text.substr(0, begin) + line + text.substr(text.find('\n', begin));
    bench_.use_references(bench_.folder() + "/references");
    (void)bench_.file("references/" + name, changed);
  }

  // A daemon that is expected to end at once.
  Finished start(const DaemonFiles& files, int port = 0) {
    const std::string ready = bench_.folder() + "/second.ready";
    const Finished run = run_program(goniod_arguments(files, "127.0.0.1:" + std::to_string(port), ready),
                                     bench_.folder(), kStartDeadline);
    EXPECT_FALSE(std::filesystem::exists(ready));
    return run;
  }

  Bench bench_{SceneOptions{}};
  SeenStage before_;
  long last_event_ = 0;
  std::size_t scans_ = 0;
};

struct BadPlan {
  const char* name;
  const char* from;
  const char* to;
  int exit_code;
  std::vector<std::string> said;
};

TEST_F(BadInput, InAPlanIsNamedWithItsPlaceAndItsLimit) {
  const std::vector<BadPlan> plans{
      {"an unknown key", "theta_i_deg", "theta_j_deg", kUsage, {"plan.toml", "line 5", "theta_j_deg", "theta_i_deg"}},
      {"a key too many",
       "[568]",
       "[568]\nwavelenth_nm = [480]",
       kUsage,
       {"plan.toml:9", "wavelenth_nm", "wavelength_nm"}},
      {"a wrong unit in the name",
       "theta_r_deg",
       "theta_r_rad",
       kUsage,
       {"plan.toml", "line 6", "theta_r_rad", "theta_r_deg"}},
      {"a wavelength in micrometres",
       "[568]",
       "[0.568]",
       kUsage,
       {"plan.toml:8", "wavelength_nm", "0.568", "100", "nm"}},
      {"no wavelength", "wavelength_nm = [568]\n", "", kUsage, {"plan.toml", "wavelength_nm"}},
      {"a wavelength without a filter", "[568]", "[700]", kUsage, {"wavelength", "700", "nm"}},
      {"an angle that no geometry has",
       "[0, 30, 60]",
       "[0, 30, 95]",
       kUsage,
       {"plan.toml:6", "theta_r_deg", "95", "90"}},
      {"an angle beyond the axis", "[0, 30, 60]", "[0, 30, 88]", kLimit, {"theta_r", "88", "85", "deg"}},
      {"all points in the shadow",
       "[0, 30]\ntheta_r_deg = [0, 30, 60]\nphi_r_deg = [0, 90, 180]",
       "[30]\ntheta_r_deg = [30]\nphi_r_deg = [0]",
       kLimit,
       {"blocked"}},
      {"an unknown reference", kSerial, "SRT-00-000", kUsage, {"SRT-00-000"}},
      {"text that is no TOML", "[geometry]", "[geometry", kUsage, {"plan.toml:4"}},
  };
  bring_up();
  for (const BadPlan& bad : plans) {
    SCOPED_TRACE(bad.name);
    expect_plan_refused(replaced(plan_text({}), bad.from, bad.to), bad.exit_code, bad.said);
  }
}

TEST_F(BadInput, OfACertificateThatHasExpiredNamesTheDay) {
  use_reference_with("expires", "expires = 2025-12-31");
  bring_up();
  expect_plan_refused(plan_text({}), kUsage, {kSerial, "2025-12-31"});
}

TEST_F(BadInput, OfACertificateWithoutItsCoverageFactorNamesTheField) {
  use_reference_with("coverage_factor", "");
  bring_up();
  expect_plan_refused(plan_text({}), kUsage, {std::string(kSerial) + ".toml", "coverage_factor"});
}

TEST_F(BadInput, OfACertificateThatDoesNotReachTheWavelengthNamesTheGap) {
  use_reference_with("longest_gap_nm", "longest_gap_nm = 10.0");
  bring_up();
  expect_plan_refused(plan_text({}), kUsage, {"568", "550", "650", "nm"});
}

TEST_F(BadInput, OfAMoveByHandIsRefusedBeforeAnythingMoves) {
  bring_up();
  expect_refused(bench_.gonioctl({"stage", "move", "--theta-r", "97"}), kLimit, {"theta_r", "97", "85", "deg"});
  expect_nothing_happened();
  expect_refused(bench_.gonioctl({"stage", "move", "--theta-i", "30", "--theta-r", "30", "--phi-r", "0"}), kLimit,
                 {"shadow"});
  expect_nothing_happened();
}

TEST_F(BadInput, OfAFileThatIsNotThereIsNamed) {
  bring_up();
  const std::string absent = bench_.folder() + "/no-such-plan.toml";
  expect_refused(bench_.gonioctl({"plan", "check", absent}), kUsage, {absent});
  expect_refused(bench_.gonioctl({"scan", "run", absent}), kUsage, {absent});
  expect_refused(bench_.gonioctl({"scan", "run"}), kUsage, {});
  expect_refused(bench_.gonioctl({"no-such-command"}), kUsage, {});
  expect_refused(bench_.gonioctl({"scan", "show", "4711"}), kFailed, {"4711"});
  expect_nothing_happened();
}

TEST_F(BadInput, OfAnInstrumentFileEndsTheDaemonBeforeItTouchesAnything) {
  const SeenStage before = bench_.simulator().stage();
  const std::string good = text_of(bench_.files().instrument);
  const std::vector<std::pair<std::string, std::string>> bad{
      {"reply_timeout_s", "reply_timeout_ms"}, {"settle_s = ", "settle_s = -"}, {"[lamp]", "[lamp"}};
  for (const auto& [from, to] : bad) {
    SCOPED_TRACE(to);
    DaemonFiles files = bench_.files();
    files.instrument = bench_.file("instrument.toml", replaced(good, from, to));
    expect_refused(start(files), kUsage, {"instrument.toml:"});
    EXPECT_FALSE(std::filesystem::exists(files.store));
  }
  DaemonFiles files = bench_.files();
  files.instrument = bench_.folder() + "/no-such-instrument.toml";
  expect_refused(start(files), kUsage, {files.instrument});
  EXPECT_EQ(bench_.simulator().stage().motion_commands, before.motion_commands);
}

TEST_F(BadInput, OfASecondDaemonOnTheSameStoreEndsThatOne) {
  bring_up();
  expect_refused(start(bench_.files()), kFailed, {bench_.files().store});
  expect_nothing_happened();
}

TEST_F(BadInput, OfABusyPortEndsTheDaemon) {
  bring_up();
  DaemonFiles files = bench_.files();
  files.store = bench_.folder() + "/other.sqlite";
  expect_refused(start(files, bench_.daemon().port()), kFailed, {std::to_string(bench_.daemon().port())});
  expect_nothing_happened();
}

TEST_F(BadInput, OfAnAddressWithoutADaemonSaysSo) {
  const std::string nobody = "http://127.0.0.1:" + std::to_string(free_port());
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"status"}, {"stop"}, {"scan", "list"}}) {
    std::vector<std::string> all{kGonioctl, "--connect", nobody};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_refused(run_program(all, bench_.folder(), kStepDeadline), kNoDaemon, {nobody.substr(7)});
  }
}

TEST_F(BadInput, OfAForeignPageChangesNothing) {
  bring_up();
  const std::string json = "application/json";
  const std::string own = "127.0.0.1:" + std::to_string(bench_.daemon().port());
  struct Foreign {
    std::map<std::string, std::string> headers;
    int status;
  };
  const std::vector<Foreign> requests{
      {{{"Content-Type", json}, {"Origin", "http://evil.example"}}, 403},
      {{{"Content-Type", json}, {"Origin", "null"}}, 403},
      {{{"Content-Type", json}, {"Host", "evil.example"}}, 403},
      {{{"Content-Type", json}, {"Host", "evil.example:" + own.substr(own.find(':') + 1)}}, 403},
      {{{"Content-Type", "text/plain"}}, 415},
      {{{"Content-Type", "application/x-www-form-urlencoded"}}, 415},
      {{{"Content-Type", ""}}, 415},
  };
  for (const char* path : {"stop", "stage/move", "stage/home", "stage/reset", "scans"}) {
    for (const Foreign& request : requests) {
      const HttpAnswer answer = http_request(bench_.daemon().port(), "POST", std::string("/api/v1/") + path, "{}",
                                             request.headers, kStepDeadline);
      EXPECT_EQ(answer.status, request.status) << path << ": " << answer.body;
      EXPECT_EQ(answer.headers.at("content-type").rfind("application/problem+json", 0), 0U);
    }
  }
  const HttpAnswer reading =
      http_request(bench_.daemon().port(), "GET", "/api/v1/status", {}, {{"Host", "evil.example"}});
  EXPECT_EQ(reading.status, 403) << "a page that had its name point here must not read either";
  expect_nothing_happened();
}

}  // namespace
}  // namespace gonio::test
