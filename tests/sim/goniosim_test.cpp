// The program as its users start it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/wires/file_descriptor.h"
#include "sim/wires/sockets.h"
#include "tests/support/process.h"

namespace gonio::sim::test {
namespace {

using gonio::test::eventually;
using gonio::test::Process;
using gonio::test::run_program;
using gonio::test::TemporaryFolder;
using gonio::test::text_of;
using gonio::test::write_text;
using nlohmann::json;

constexpr std::chrono::seconds kPatience{60};  // a bound against hanging
const std::string kProgram = GONIOSIM;

bool exists(const std::string& file) {
  return ::access(file.c_str(), F_OK) == 0;
}

/// goniosim in a state folder, up or known to have ended.
class Running {
 public:
  explicit Running(const TemporaryFolder& folder, const std::string& scene = "wheat")
      : folder_(folder), process_({kProgram, scene, "--state", folder / "state"}, folder / "log") {
    EXPECT_TRUE(eventually([&] { return is_ready() || !process_.is_running(); }, kPatience));
    EXPECT_TRUE(process_.is_running()) << text_of(folder / "log");
  }
  json ready() const { return json::parse(text_of(folder_ / "state/ready")); }

  json ask(const json& line) const {
    const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::strncpy(to.sun_path, ready().at("control").get<std::string>().c_str(), sizeof to.sun_path - 1);
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
    const std::string text = line.dump() + "\n";
    EXPECT_EQ(::send(socket.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
    std::string answer;
    char c = 0;
    while (::recv(socket.get(), &c, 1, 0) == 1 && c != '\n') answer.push_back(c);
    return json::parse(answer);
  }
  int end(int signal) {
    process_.signal(signal);
    return process_.wait(kPatience).value_or(-1);
  }
  void kill() { process_.kill(); }

 private:
  // One that was killed leaves its ready file behind: only our own counts.
  bool is_ready() const {
    return exists(folder_ / "state/ready") &&
           json::parse(text_of(folder_ / "state/ready"), nullptr, false).value("pid", -1) == process_.pid();
  }

  const TemporaryFolder& folder_;
  Process process_;
};

TEST(Goniosim, LaysOutItsFilesAndEndsWhenAsked) {
  const TemporaryFolder folder;
  Running simulator(folder);

  EXPECT_TRUE(exists(folder / "state/instrument.toml"));
  EXPECT_TRUE(exists(folder / "state/reference/SRT-99-020.toml"));
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  EXPECT_FALSE(exists(folder / "state/ready"));
}

TEST(Goniosim, KeepsItsPortsAndGrowsItsBootCounterEvenWhenKilled) {
  const TemporaryFolder folder;
  json first;
  {
    Running simulator(folder);
    first = simulator.ready();
    EXPECT_EQ(simulator.ask({{"query", "stage"}}).at("boot_counter"), 1);
    simulator.kill();
  }

  Running again(folder);

  EXPECT_EQ(again.ready().at("stage_port"), first.at("stage_port"));
  EXPECT_EQ(again.ready().at("camera_address"), first.at("camera_address"));
  EXPECT_EQ(again.ask({{"query", "stage"}}).at("boot_counter"), 2);
}

TEST(Goniosim, AnswersOnItsControlSocket) {
  const TemporaryFolder folder;
  Running simulator(folder);

  EXPECT_EQ(simulator.ask({{"query", "exposures"}}).at("exposures"), 0);
  EXPECT_EQ(simulator.ask({{"query", "stage"}}).at("axes").at("theta_r").at("homed"), false);
  EXPECT_EQ(simulator.ask({{"fault", "axis-blocked"}, {"axis", "theta_r"}, {"on", true}}).at("ok"), true);
  EXPECT_EQ(simulator.ask({{"fault", "stage-power-cycle"}}).at("ok"), true);
  EXPECT_EQ(simulator.ask({{"query", "stage"}}).at("boot_counter"), 2);
  EXPECT_EQ(simulator.ask({{"fault", "axis-blocked"}, {"axis", "theta_q"}}).at("ok"), false);
  EXPECT_EQ(simulator.ask({{"fault", "bad luck"}}).at("ok"), false);
  EXPECT_EQ(simulator.ask(json::array()).at("ok"), false);
}

TEST(Goniosim, RefusesAFolderInWhichAnotherLives) {
  const TemporaryFolder folder;
  Running simulator(folder);

  const auto second = run_program({kProgram, "wheat", "--state", folder / "state"}, folder.path(), kPatience);

  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.errors, testing::HasSubstr("another goniosim"));
}

TEST(Goniosim, SaysWhichPortIsBusy) {
  const TemporaryFolder folder;
  const auto taken = listen_tcp("127.0.0.1", 0);
  ASSERT_TRUE(taken.has_value());
  const std::string port = std::to_string(port_of(*taken));

  const auto run =
      run_program({kProgram, "wheat", "--state", folder / "state", "--modbus-port", port}, folder.path(), kPatience);

  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.errors, testing::HasSubstr("127.0.0.1:" + port));
  EXPECT_THAT(run.errors, testing::HasSubstr("port-busy"));
  EXPECT_FALSE(exists(folder / "state/ready"));
}

TEST(Goniosim, EndsWithAUsageErrorOnWhatItDoesNotUnderstand) {
  const TemporaryFolder folder;
  write_text(folder / "bad.toml", "[scene]\nnaem = 1\n");
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), kProgram);
    return run_program(arguments, folder.path(), kPatience);
  };

  EXPECT_EQ(run({}).exit_code, 2);
  EXPECT_EQ(run({"--no-such-option"}).exit_code, 2);
  EXPECT_EQ(run({"wheat", "--"}).exit_code, 2);
  const auto unknown = run({"weath"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, testing::HasSubstr("wheat"));
  const auto bad = run({folder / "bad.toml"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.errors, testing::HasSubstr("bad.toml"));
}

TEST(Goniosim, EndsWithTheProgramThatItStartsAndWithItsExitCode) {
  const TemporaryFolder folder;

  const auto run = run_program({kProgram, "wheat", "--", "/bin/sh", "-c", "cat {state}/instrument.toml; exit 7"},
                               folder.path(), kPatience);

  EXPECT_EQ(run.exit_code, 7);
  EXPECT_THAT(run.output, testing::HasSubstr("kind = \"genicam\""));
}

TEST(Goniosim, PassesSignalsOnToTheProgramThatItStarted) {
  const TemporaryFolder folder;
  const std::string script = "trap 'exit 9' TERM; : > " + (folder / "up") + "; while :; do sleep 0.05; done";
  Process simulator({kProgram, "wheat", "--", "/bin/sh", "-c", script}, folder / "log");
  ASSERT_TRUE(eventually([&] { return exists(folder / "up"); }, kPatience));

  simulator.signal(SIGTERM);

  EXPECT_EQ(simulator.wait(kPatience).value_or(-1), 9);
}

TEST(Goniosim, SaysThatTheProgramCannotBeStarted) {
  const TemporaryFolder folder;

  const auto run = run_program({kProgram, "wheat", "--", "no-such-program-here"}, folder.path(), kPatience);

  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.errors, testing::HasSubstr("no-such-program-here"));
}

TEST(GoniosimTruth, PrintsTheTrueBrdfAtEachRowOfAnExport) {
  const TemporaryFolder folder;
  write_text(folder / "scan.csv",
             "# scan: x\npoint,status,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm,brdf_per_sr\n"
             "4,accepted,30,0,60,180,568,0.17\n7,blocked,0,0,0,0,568,\n");

  const auto run = run_program({kProgram, "truth", "wheat", "--seed", "5", "--points", folder / "scan.csv"},
                               folder.path(), kPatience);

  EXPECT_EQ(run.exit_code, 0) << run.errors;
  // Mobley (2005) eq 8 with the wheat parameters.
  EXPECT_EQ(run.output,
            "point,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm,brdf_per_sr\n"
            "4,30,0,60,180,568,0.175707298205\n7,0,0,0,0,568,0.317804642149\n");
}

TEST(GoniosimTruth, NamesTheLineAndColumnThatItCannotRead) {
  const TemporaryFolder folder;
  write_text(folder / "a.csv", "theta_i_deg,theta_r_deg,phi_r_deg\n1,2,3\n1,x,3\n");
  write_text(folder / "b.csv", "theta_i_deg,phi_r_deg\n1,2\n");
  write_text(folder / "c.csv", "theta_i_deg,theta_r_deg,phi_r_deg\n95,2,3\n");
  const auto run = [&](const std::string& file) {
    return run_program({kProgram, "truth", "wheat", "--points", folder / file}, folder.path(), kPatience);
  };

  const auto word = run("a.csv");
  EXPECT_NE(word.exit_code, 0);
  EXPECT_THAT(word.errors, testing::AllOf(testing::HasSubstr("a.csv:3"), testing::HasSubstr("theta_r_deg")));
  EXPECT_TRUE(word.output.empty());
  EXPECT_THAT(run("b.csv").errors, testing::HasSubstr("theta_r_deg"));
  EXPECT_THAT(run("c.csv").errors, testing::HasSubstr("at most 90 deg"));
  EXPECT_THAT(run("none.csv").errors, testing::HasSubstr("none.csv"));
}

}  // namespace
}  // namespace gonio::sim::test
