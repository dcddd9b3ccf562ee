// gonioctl whole, against the real server with a service that remembers what it was asked.
#include "cli/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <thread>

#include "daemon/http/server.h"
#include "tests/daemon/http/fake_service.h"
#include "tests/support/process.h"

namespace gonio::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Gonioctl : public testing::Test {
 protected:
  void SetUp() override {
    Result<daemon::Listeners> bound = daemon::Listeners::bind("127.0.0.1", 0, folder_ / "s");
    ASSERT_TRUE(bound.has_value()) << describe(bound.error());
    Result<std::unique_ptr<daemon::Server>> started = daemon::Server::start(std::move(*bound), {}, service_, clock_);
    ASSERT_TRUE(started.has_value()) << describe(started.error());
    server_ = std::move(*started);
    connect_ = "http://127.0.0.1:" + std::to_string(server_->port());
  }
  int run(const std::vector<std::string>& arguments) {
    out_.str("");
    err_.str("");
    World world{.out = out_, .err = err_, .interrupted = interrupted_, .default_connect = connect_};
    return cli::run(arguments, world);
  }
  std::string plan_file(const std::string& text) {
    const std::string path = folder_ / "plan.toml";
    test::write_text(path, text);
    return path;
  }

  const test::TemporaryFolder folder_;
  SystemClock clock_;
  test::FakeService service_;
  std::unique_ptr<daemon::Server> server_;
  std::string connect_;
  std::atomic<bool> interrupted_{false};
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(Gonioctl, ShowsTheStatus) {
  EXPECT_EQ(run({"status"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("bench A"));
  EXPECT_THAT(out_.str(), HasSubstr("homed"));
  EXPECT_THAT(err_.str(), IsEmpty());
}

TEST_F(Gonioctl, StopsInOneRequest) {
  EXPECT_EQ(run({"stop"}), 0);

  EXPECT_THAT(service_.asked(), ElementsAre("stop local"));
  EXPECT_THAT(out_.str(), HasSubstr("gonioctl stage reset"));
}

TEST_F(Gonioctl, SpeaksOverTheUnixSocket) {
  connect_ = "unix:" + (folder_ / "s");

  EXPECT_EQ(run({"status"}), 0);
}

TEST_F(Gonioctl, WithoutADaemonEndsWithThree) {
  EXPECT_EQ(run({"status", "--connect", "http://127.0.0.1:" + std::to_string(test::free_port())}), 3);

  EXPECT_THAT(err_.str(), HasSubstr("no-daemon"));
  EXPECT_THAT(err_.str(), HasSubstr("Start goniod"));
}

TEST_F(Gonioctl, AnAddressThatIsNoneIsAUsageError) {
  EXPECT_EQ(run({"status", "--connect", "somewhere"}), 2);
}

TEST_F(Gonioctl, ErrorsOfTheDaemonKeepTheirCodeAndSayWhatToDo) {
  EXPECT_EQ(run({"scan", "show", "9"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("no scan 9"));
  EXPECT_THAT(err_.str(), HasSubstr("What to do:"));
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(Gonioctl, AWrongPlanShowsFileLineAndField) {
  const std::string path = plan_file("theta_i_degg = 3");

  EXPECT_EQ(run({"plan", "check", path}), 2);

  EXPECT_THAT(err_.str(), HasSubstr(path + ":5: geometry.theta_i_degg"));
  EXPECT_THAT(err_.str(), HasSubstr("did you mean"));
}

TEST_F(Gonioctl, APlanThatCannotBeReadIsNamedAndNothingIsSent) {
  EXPECT_EQ(run({"scan", "run", folder_ / "none.toml"}), 2);

  EXPECT_THAT(err_.str(), HasSubstr("none.toml"));
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(Gonioctl, ShowsAStandardWithItsCertificateModesAndWhatIsToBeSaidOfItsTable) {
  EXPECT_EQ(run({"reference", "show", "SRT-1"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("0.9898 +- 0"));
  EXPECT_THAT(out_.str(), HasSubstr("limb, u 1 %"));
  EXPECT_THAT(out_.str(), HasSubstr("sound"));
  EXPECT_THAT(out_.str(), HasSubstr("as written it gives 1.0280"));
  EXPECT_EQ(run({"reference", "show", "SRT 9"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("SRT 9"));
  EXPECT_EQ(run({"reference", "list"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("450 to 650"));
}

TEST_F(Gonioctl, ImportsACertificateWithItsShapeFromTwoFiles) {
  test::write_text(folder_ / "c.csv", "C");
  test::write_text(folder_ / "s.csv", "S");

  EXPECT_EQ(run({"reference", "import", folder_ / "c.csv", "--shape", folder_ / "s.csv", "--replace"}), 0);

  ASSERT_EQ(service_.asked().size(), 1U);
  EXPECT_THAT(service_.asked()[0], HasSubstr("\"text\":\"C\""));
  EXPECT_THAT(service_.asked()[0], HasSubstr("\"shape\":\"S\""));
  EXPECT_THAT(service_.asked()[0], HasSubstr("\"replace\":true"));
}

TEST_F(Gonioctl, ATableThatContradictsItselfEndsACheckWithOne) {
  test::write_text(folder_ / "good.toml", "fine");
  test::write_text(folder_ / "bad.toml", "doubt");

  EXPECT_EQ(run({"reference", "check", folder_ / "good.toml"}), 0);
  EXPECT_EQ(run({"reference", "check", folder_ / "bad.toml"}), 1);
  EXPECT_EQ(run({"reference", "check", folder_ / "none.toml"}), 2);
}

TEST_F(Gonioctl, AFailedSelfCheckIsSaidAndEndsWithOne) {
  EXPECT_EQ(run({"data", "check", "3"}), 1);

  EXPECT_THAT(out_.str(), HasSubstr("worst +7.5 u"));
  EXPECT_THAT(out_.str(), HasSubstr("failed: reciprocity"));
}

TEST_F(Gonioctl, PrintsABudgetInWordsAndAsCsv) {
  EXPECT_EQ(run({"data", "budget", "3"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("4 (the point of median U / |f|)"));
  EXPECT_THAT(out_.str(), HasSubstr("k = 2.00, 95.45 %"));
  EXPECT_THAT(out_.str(), HasSubstr("certificate"));

  EXPECT_EQ(run({"data", "budget", "3", "7", "-o", "csv"}), 0);
  EXPECT_THAT(out_.str(), testing::StartsWith("component,kind,distribution,u,unit,"));
  EXPECT_THAT(out_.str(), HasSubstr("noise of the sample reading,random,normal,,sr^-1,,0.0007,54.40,9"));

  EXPECT_EQ(run({"data", "budget", "3", "99"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("no value of such a point"));
}

TEST_F(Gonioctl, SendsThePlanVerbatimWithItsNameAndKey) {
  const std::string path = plan_file("[scan]\n");

  EXPECT_EQ(run({"scan", "run", path, "--key", "k7"}), 0);

  EXPECT_THAT(service_.asked(), ElementsAre("submit " + path + " [[scan]\n] key=k7 local"));
  EXPECT_THAT(out_.str(), HasSubstr("scan  3"));
}

TEST_F(Gonioctl, SendsTheFilesThatAPlanNamesFromBesideIt) {
  test::write_text(folder_ / "a.csv", "A");
  test::write_text(folder_ / "b.csv", "B");
  const std::string text = "[geometry]\npoints = 'a.csv'\n[[geometry.parts]]\npoints = 'b.csv'\n";
  const std::string path = plan_file(text);

  EXPECT_EQ(run({"scan", "run", path, "--key", "k7"}), 0);

  EXPECT_THAT(service_.asked(), ElementsAre("submit " + path + " [" + text + "] key=k7 local a.csv=[A] b.csv=[B]"));
}

TEST_F(Gonioctl, AFileThatAPlanNamesAndThatIsNotThereIsNamedAndNothingIsSent) {
  EXPECT_EQ(run({"scan", "run", plan_file("[geometry]\npoints = 'none.csv'\n")}), 2);

  EXPECT_THAT(err_.str(), HasSubstr("none.csv"));
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(Gonioctl, JsonIsTheDaemonsOwn) {
  EXPECT_EQ(run({"plan", "check", plan_file("x"), "-o", "json"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("\"blocked\":3"));
}

TEST_F(Gonioctl, ListsComeAsTableCsvAndLines) {
  EXPECT_EQ(run({"scan", "list"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("wheat-07"));
  EXPECT_EQ(run({"scan", "list", "-o", "csv"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("3,running,50.0,621,1242,wheat-07"));
  EXPECT_EQ(run({"scan", "list", "-o", "jsonl"}), 0);
  EXPECT_THAT(out_.str(), testing::StartsWith("{"));
}

TEST_F(Gonioctl, ScanVerbsReachTheirScan) {
  EXPECT_EQ(run({"scan", "pause", "3", "--now", "--reason", "lunch"}), 0);
  EXPECT_EQ(run({"scan", "resume", "3"}), 0);
  EXPECT_EQ(run({"scan", "abort", "3"}), 0);

  EXPECT_THAT(service_.asked(),
              ElementsAre("change 3 verb 1 lunch local", "resume 3 [] local", "change 3 verb 3  local"));
}

TEST_F(Gonioctl, ResumeOfOneHoldNamesItAndShowsWhatIsLeft) {
  EXPECT_EQ(run({"scan", "resume", "3", "--hold", "operator"}), 0);

  EXPECT_THAT(service_.asked(), ElementsAre("resume 3 [operator] local"));
  EXPECT_THAT(out_.str(), HasSubstr("still held: lamp (stage: it is out)"));
  EXPECT_EQ(run({"scan", "resume", "3", "--hold", "mood"}), 2);
}

TEST_F(Gonioctl, TheRestOfAScanIsChangedByWhatIsNamedOnly) {
  EXPECT_EQ(run({"scan", "change", "3", "--snr", "50", "--order", "reversed", "--reason", "hurry"}), 0);
  EXPECT_EQ(run({"scan", "complete-missing", "3"}), 0);

  const auto asked = service_.asked();
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_THAT(asked[0], HasSubstr("\"target_snr\":50.0"));
  EXPECT_THAT(asked[0], HasSubstr("\"order\":\"reversed\""));
  EXPECT_THAT(asked[0], HasSubstr("\"max_time_s\":null"));
  EXPECT_EQ(asked[1], "complete missing 3 local");
  EXPECT_THAT(out_.str(), HasSubstr("4"));
}

TEST_F(Gonioctl, AnExportIsThereWholeAndNothingBesideIt) {
  EXPECT_EQ(run({"data", "export", "3", "-o", folder_ / "out.csv"}), 0);

  EXPECT_EQ(test::text_of(folder_ / "out.csv"), "# scan: 3\npoint,theta_i_deg\n0,30\n");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("part")));
  }
  EXPECT_EQ(run({"data", "export", "3", "-o", folder_ / "no/such/folder.csv"}), 2);
}

TEST_F(Gonioctl, WatchingShowsProgressAndEndsWithTheScan) {
  service_.scan_state = "done";

  EXPECT_EQ(run({"scan", "run", plan_file("x"), "--watch"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("scan 3 wheat: 621 of 1242 items, 50.0 %, done"));
}

TEST_F(Gonioctl, AScanThatFailedEndsTheWatchWithOne) {
  service_.scan_state = "failed";

  EXPECT_EQ(run({"scan", "watch", "3"}), 1);
}

TEST_F(Gonioctl, InterruptingAWatchSaysThatTheScanGoesOn) {
  int code = 0;
  std::thread watching([&] { code = run({"scan", "watch", "3"}); });

  interrupted_ = true;
  watching.join();

  EXPECT_EQ(code, kInterruptedExit);
  EXPECT_THAT(err_.str(), HasSubstr("interrupted"));
}

TEST_F(Gonioctl, ListsTheEventsThereAreAndEnds) {
  for (const std::string kind : {"scan-submitted", "item-accepted", "item-accepted"}) {
    server_->publish(service_.commit(kind));
  }

  EXPECT_EQ(run({"events", "--after", "1"}), 0);

  EXPECT_EQ(out_.str(), "2    item-accepted  3  local  {}\n3    item-accepted  3  local  {}\n");
  EXPECT_EQ(run({"events", "-o", "jsonl"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("\"kind\":\"scan-submitted\""));
  EXPECT_EQ(run({"events", "--after", "3"}), 0);
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(Gonioctl, DoctorLooksWithoutMovingAndNamesWhatToDo) {
  service_.has_standard = false;

  EXPECT_EQ(run({"doctor"}), 1);

  EXPECT_THAT(out_.str(), HasSubstr("ok       disk of the store: 931.3 GiB free"));
  EXPECT_THAT(out_.str(), HasSubstr("FAILED   reference standards: none (at least one)"));
  EXPECT_THAT(out_.str(), HasSubstr("-> put the certificate into"));
  EXPECT_THAT(out_.str(), HasSubstr("skipped  motion"));
  EXPECT_THAT(service_.asked(), IsEmpty()) << "nothing was commanded";
}

TEST_F(Gonioctl, DoctorsFindingsAreAlsoForPrograms) {
  EXPECT_EQ(run({"doctor", "-o", "json"}), 1);
  EXPECT_THAT(out_.str(), HasSubstr("{\"check\":\"disk of the store\""));

  EXPECT_EQ(run({"doctor", "-o", "csv"}), 1);
  EXPECT_THAT(out_.str(), HasSubstr("check,verdict,seen,limit,remedy\n"));
}

TEST_F(Gonioctl, ShowsTheInstrumentAsTheDaemonWasToldOfIt) {
  EXPECT_EQ(run({"instrument"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("0 to 85 deg, 20 deg/s, 40 deg/s^2, settles in 0.1 s within +- 0.01 deg"));
}

TEST_F(Gonioctl, ListsWhatCalibrationJobsHaveFoundToTheSecondDigitOfU) {
  EXPECT_EQ(run({"calibration", "list"}), 0);

  EXPECT_THAT(out_.str(), HasSubstr("arm-zeros"));
  EXPECT_THAT(out_.str(), HasSubstr("zero_theta_i_deg 0.0123 +- 0.0021 deg"));
}

TEST_F(Gonioctl, ShowsOneCalibrationAndSaysThatThereIsNoOther) {
  EXPECT_EQ(run({"calibration", "show", "2"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("mirror M1"));

  EXPECT_EQ(run({"calibration", "show", "9"}), 1);
  EXPECT_THAT(err_.str(), HasSubstr("no such version"));
}

TEST_F(Gonioctl, UsesACalibrationAndEndsItsUseWithAReason) {
  EXPECT_EQ(run({"calibration", "use", "2"}), 0);
  EXPECT_THAT(err_.str(), HasSubstr("calibration 2 counts from now on"));
  EXPECT_EQ(run({"calibration", "use", "2", "--end", "--reason", "arm taken apart"}), 0);
  EXPECT_THAT(err_.str(), HasSubstr("counts no more"));

  EXPECT_THAT(service_.asked(), ElementsAre("use 2 yes [] local", "use 2 no [arm taken apart] local"));
}

TEST_F(Gonioctl, WritesTheMapsOfAJobAndTheLinesThatNameThem) {
  EXPECT_EQ(run({"calibration", "maps", "2", "--to", folder_.path()}), 0);

  EXPECT_EQ(out_.str(), "[detector.maps]\ndark = \"dark-2.map\"\nbad_pixels = \"bad_pixels-2.map\"\n");
  EXPECT_EQ(test::text_of(folder_ / "dark-2.map"), "map of dark");
  EXPECT_THAT(err_.str(), HasSubstr("next start"));
}

TEST_F(Gonioctl, ChartsACheckStandardWhateverItsName) {
  EXPECT_EQ(run({"calibration", "chart", "tile & blue 7"}), 0);

  EXPECT_THAT(err_.str(), HasSubstr("tile & blue 7, mean REFF: in control"));
}

}  // namespace
}  // namespace gonio::cli
