// What a lab takes home, through the programs a user has; and that the worker program can die without a scan noticing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using testing::HasSubstr;

// In place of gonio-analyse: while there is a file `stall`, it says its number and stays; else it is gonio-analyse.
constexpr const char* kStallingWorker = R"(#!/bin/sh
here=$(dirname "$0")
if [ -e "$here/stall" ]; then
  echo '{"state": "running", "progress": 0.4, "doing": "writing merl"}'
  echo $$ > "$here/pid.part"; mv "$here/pid.part" "$here/pid"
  exec tail -f /dev/null
fi
exec )";

// The part of a page below a heading.
std::string section_of(const std::string& page, const std::string& heading) {
  const std::size_t begin = page.find("<h2>" + heading);
  return begin == std::string::npos ? "" : page.substr(begin, page.find("<h2>", begin + 4) - begin);
}

// Each once; those with a place to fill in are for people.
std::set<std::string> commands_in(const std::string& section) {
  std::set<std::string> commands;
  const std::string before = "<code>gonioctl ";
  for (std::size_t at = section.find(before); at != std::string::npos; at = section.find(before, at + 1)) {
    const std::size_t begin = at + before.size();
    const std::string command = section.substr(begin, section.find("</code>", begin) - begin);
    if (command.find("POINT") == std::string::npos) commands.insert(command);
  }
  return commands;
}

// What a reader sees, without commands and marks.
std::string visible_text(std::string html) {
  for (const auto& [open, close] : {std::pair{"<code", "</code>"}, std::pair{"<pre", "</pre>"}, std::pair{"<", ">"}}) {
    for (std::size_t at = html.find(open); at != std::string::npos; at = html.find(open, at)) {
      const std::size_t end = html.find(close, at);
      if (end == std::string::npos) break;
      html.replace(at, end + std::string(close).size() - at, " ");
    }
  }
  return html;
}

// Words that are numbers, and nothing but; times of day are none.
std::vector<std::string> numbers_in(std::string text) {
  text = std::regex_replace(text, std::regex("[0-9-]+T[0-9:.]+Z"), " ");
  for (const char* parting : {"\u00b1", "\u00b0", ",", ";", ":", "(", ")", "{", "}", "[", "]", "\""}) {
    for (std::size_t at = text.find(parting); at != std::string::npos; at = text.find(parting, at)) {
      text.replace(at, std::string(parting).size(), " ");
    }
  }
  std::istringstream words(text);
  std::vector<std::string> numbers;
  for (std::string word; words >> word;) {
    if (word.back() == '.') word.pop_back();
    char* end = nullptr;
    (void)std::strtod(word.c_str(), &end);
    if (!word.empty() && *end == '\0' && word.find_first_of("0123456789") != std::string::npos) numbers.push_back(word);
  }
  return numbers;
}

// Half a unit of the last digit that is shown.
double rounding_of(const std::string& number) {
  const std::size_t e = number.find('e');
  const std::size_t point = number.find('.');
  const int decimals =
      point == std::string::npos || point > e ? 0 : static_cast<int>(std::min(e, number.size()) - point) - 1;
  const int exponent = e == std::string::npos ? 0 : std::stoi(number.substr(e + 1));
  return 0.5 * std::pow(10.0, exponent - decimals);
}

// As it stands there, or as a part of one beside percent.
bool is_among(const std::string& shown, const std::vector<double>& said) {
  const double x = std::stod(shown);
  const double within = 1.001 * rounding_of(shown);
  return std::ranges::any_of(said,
                             [&](double v) { return std::abs(v - x) <= within || std::abs(100.0 * v - x) <= within; });
}

class Analysis : public testing::Test {
 protected:
  Analysis() : bench_(SceneOptions{}) {
    const std::string worker = bench_.file("worker", kStallingWorker + std::string(kGonioAnalyse) + " \"$@\"\n");
    std::filesystem::permissions(worker, std::filesystem::perms::owner_all);
    setenv("GONIO_ANALYSE", worker.c_str(), 1);
    bench_.bring_up_daemon();
    unsetenv("GONIO_ANALYSE");
  }
  long measure() {
    const long id = bench_.submit(plan_text({.theta_i_deg = "[0, 30]", .phi_r_deg = "[0, 60, 120, 180]"}));
    bench_.wait_for_state(id, {"done"});
    return id;
  }
  // All numbers that a command of a page says, on its output and in the tables that it writes.
  std::vector<double> said_by(const std::string& command) {
    const std::string folder = bench_.folder() + "/traced";
    std::filesystem::create_directories(folder);
    std::istringstream words(command);
    std::vector<std::string> arguments{std::istream_iterator<std::string>(words), {}};
    const bool writes =
        arguments[0] == "data" &&
        std::ranges::count(std::vector<std::string>{"fit", "symmetry", "readings", "plot"}, arguments[1]) > 0;
    if (writes) arguments.insert(arguments.end(), {"-o", folder + "/made.csv"});
    const Finished done = bench_.gonioctl(arguments);
    EXPECT_EQ(done.exit_code, 0) << command << '\n' << done.errors;
    std::vector<double> numbers;
    for (const std::string& number : numbers_in(done.output + " " + done.errors)) numbers.push_back(std::stod(number));
    std::filesystem::remove_all(folder);
    return numbers;
  }
  void expect_traced(const std::string& section) {
    std::vector<double> said;
    for (const std::string& command : commands_in(section)) {
      const std::vector<double> more = said_by(command);
      said.insert(said.end(), more.begin(), more.end());
    }
    const std::vector<std::string> shown = numbers_in(visible_text(section));
    EXPECT_FALSE(shown.empty());
    for (const std::string& number : shown) EXPECT_TRUE(is_among(number, said)) << number;
  }
  nlohmann::json start(const nlohmann::json& request) {
    const HttpAnswer answer = bench_.daemon().post("analysis", request.dump());
    EXPECT_EQ(answer.status, 200) << answer.body;
    return nlohmann::json::parse(answer.body);
  }
  nlohmann::json wait_for_job(long job) {
    nlohmann::json seen;
    EXPECT_TRUE(eventually(
        [&] {
          seen = bench_.get("analysis/" + std::to_string(job));
          return !seen.at("ended_utc").get<std::string>().empty();
        },
        kStepDeadline));
    return seen;
  }

  Bench bench_;
};

TEST_F(Analysis, AKilledWorkerIsNamedAndItsScanGoesOn) {
  const std::string stall = bench_.file("stall", "");
  const long scan = bench_.submit(plan_text({.theta_i_deg = "[0, 20, 40]", .phi_r_deg = "[0, 45, 90, 135, 180]"}));
  bench_.wait_for_state(scan, {"running"});
  const long job = start({{"kind", "export"}, {"scan", scan}, {"format", "merl"}}).at("id").get<long>();
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(bench_.folder() + "/pid"); }, kStepDeadline));

  ::kill(std::stoi(text_of(bench_.folder() + "/pid")), SIGKILL);
  const nlohmann::json failed = wait_for_job(job);

  EXPECT_EQ(failed.at("state"), "failed");
  EXPECT_THAT(failed.at("error").at("seen").get<std::string>(), HasSubstr("signal 9"));
  EXPECT_EQ(failed.at("error").at("tried"), "writing merl");
  bench_.wait_for_state(scan, {"done"});
  EXPECT_EQ(bench_.scan(scan).at("accepted"), bench_.scan(scan).at("items"));
  std::filesystem::remove(stall);
  const Finished again = bench_.gonioctl(
      {"data", "export", std::to_string(scan), "--format", "bird", "-o", bench_.folder() + "/scan.brdf"});
  EXPECT_EQ(again.exit_code, 0) << again.errors;
}

TEST_F(Analysis, EveryFormatIsTakenHomeWithWhatItLoses) {
  const std::string scan = std::to_string(measure());
  for (const char* format : {"csv+json", "bird", "astm", "zemax", "merl", "ssdd", "pab", "klems", "rgl", "nexus"}) {
    SCOPED_TRACE(format);
    const std::string folder = bench_.folder() + "/" + format;
    std::filesystem::create_directory(folder);

    const Finished made = bench_.gonioctl({"data", "export", scan, "--format", format, "-o", folder + "/wheat.out"});

    EXPECT_EQ(made.exit_code, 0) << made.errors;
    EXPECT_THAT(made.errors, HasSubstr("written: " + folder));
    long files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      files += entry.file_size() > 0 ? 1 : 0;
      EXPECT_EQ(entry.path().string().find(".part"), std::string::npos);
    }
    EXPECT_GE(files, 1);
    const bool is_lossless = std::string(format) == "csv+json" || std::string(format) == "nexus";
    EXPECT_EQ(made.errors.find("not in the file: ") == std::string::npos, is_lossless || std::string(format) == "bird")
        << made.errors;
  }
}

TEST_F(Analysis, AReportStandsAloneAndItsCommandsLeadToRawReadings) {
  const long id = measure();
  const std::string scan = std::to_string(id);
  const std::string page_file = bench_.folder() + "/report.html";

  const Finished made = bench_.gonioctl({"data", "report", scan, "-o", page_file});

  ASSERT_EQ(made.exit_code, 0) << made.errors;
  const std::string page = text_of(page_file);
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_EQ(page.find("src="), std::string::npos) << "nothing is fetched from elsewhere";
  for (const char* section : {"Result", "Sample and geometry", "Calibration chain", "Budget", "Self-checks", "Fit",
                              "Environment", "Gaps", "Who and when", "Software and configuration", "Pictures"}) {
    EXPECT_THAT(page, HasSubstr("<h2>" + std::string(section)));
  }
  // What happened is told in words, and a scan's many visits are in a picture.
  const std::string people =
      page.substr(page.find("<h2>Who and when"), page.find("<h2>Software and") - page.find("<h2>Who and when"));
  EXPECT_THAT(people, HasSubstr("<td>scan-done</td>"));
  EXPECT_EQ(people.find_first_of("{["), std::string::npos) << people;
  EXPECT_EQ(people.find("-visit"), std::string::npos) << people;
  // The first command of the page, as its reader would give it.
  const std::string lead = "gonioctl data trace " + scan + " ";
  std::size_t at = page.find(lead);
  while (at != std::string::npos && std::isdigit(static_cast<unsigned char>(page[at + lead.size()])) == 0) {
    at = page.find(lead, at + 1);
  }
  ASSERT_NE(at, std::string::npos);
  const std::string point = std::to_string(std::stoi(page.substr(at + lead.size())));
  const Finished trace = bench_.gonioctl({"data", "trace", scan, point});
  EXPECT_EQ(trace.exit_code, 0) << trace.errors;
  EXPECT_THAT(trace.output, HasSubstr("the same bits, U too"));
  for (const char* part :
       {"sample attempt", "reference attempt", "in force", "reading ", "dark visit", "m2 ", "monitor "}) {
    EXPECT_THAT(trace.output, HasSubstr(part));
  }
}

TEST_F(Analysis, EveryNumberOfAReportIsSaidByTheCommandsOfItsSection) {
  const std::string scan = std::to_string(measure());
  const std::string page_file = bench_.folder() + "/report.html";
  ASSERT_EQ(bench_.gonioctl({"data", "report", scan, "-o", page_file}).exit_code, 0);
  const std::string page = text_of(page_file);

  for (const char* heading :
       {"Result", "Sample and geometry", "Calibration chain", "Budget", "Self-checks", "Fit", "Environment"}) {
    SCOPED_TRACE(heading);
    expect_traced(section_of(page, heading));
  }
  // A row has its own way down: the first four of them, value, U and k.
  std::string values = section_of(page, "Values to look at");
  values = values.substr(values.find("<tbody>"));
  for (int row = 0; row < 4; ++row) {
    SCOPED_TRACE(::testing::Message() << "row " << row);
    const std::size_t end = values.find("</tr>");
    ASSERT_NE(end, std::string::npos);
    expect_traced(values.substr(0, end));
    values.erase(0, end + 5);
  }
}

TEST_F(Analysis, EveryHashOfAReportIsSaidByTheCommandsOfItsSection) {
  const std::string scan = std::to_string(measure());
  const std::string page_file = bench_.folder() + "/report.html";
  ASSERT_EQ(bench_.gonioctl({"data", "report", scan, "-o", page_file}).exit_code, 0);
  const std::string section = section_of(text_of(page_file), "Software and configuration");

  std::string said;
  for (const std::string& command : commands_in(section)) {
    std::istringstream words(command);
    said += bench_.gonioctl({std::istream_iterator<std::string>(words), {}}).output;
  }
  const std::regex hash("[0-9a-f]{64}");
  int hashes = 0;
  for (std::sregex_iterator shown(section.begin(), section.end(), hash), end; shown != end; ++shown, ++hashes) {
    EXPECT_THAT(said, HasSubstr(shown->str()));
  }
  EXPECT_EQ(hashes, 4) << "plan, instrument with and without addresses, standard";
}

TEST_F(Analysis, WhatIsNotThereIsSaid) {
  const Finished no_scan = bench_.gonioctl({"data", "report", "77"});
  EXPECT_EQ(no_scan.exit_code, 1);
  EXPECT_THAT(no_scan.errors, HasSubstr("no scan of this number"));

  const long scan = measure();
  const Finished no_point = bench_.gonioctl({"data", "trace", std::to_string(scan), "7777"});
  EXPECT_EQ(no_point.exit_code, 1);
  EXPECT_THAT(no_point.errors, HasSubstr("no such point"));
  EXPECT_EQ(bench_.gonioctl({"data", "export", std::to_string(scan), "--format", "exr"}).exit_code, 2);
}

}  // namespace
}  // namespace gonio::test
