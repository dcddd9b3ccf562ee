// coverage_campaign DIR [REPETITIONS [DRAWS [SCENE...]]]: the long form of the coverage test. Writes DIR/scenes.md,
// no-certificate.md, left-out.md and budget.md, tables for docs/uncertainty.md, and coverage.tsv for its plot. Ends
// with 1 when a claim that should hold does not. All chance comes from fixed seeds: the same numbers on any machine.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/coverage/budget_monte_carlo.h"
#include "tests/coverage/campaign.h"

namespace gonio::coverage {
namespace {

constexpr std::uint64_t kBudgetSeed = 88'000'000;

struct Arguments {
  std::string folder;
  int repetitions = 2000;
  int draws = 20000;
  std::vector<std::string> scenes;
};

/// A table of markdown, a line at a time: on paper and on the screen.
class Table {
 public:
  Table(const std::string& path, const std::string& head, std::size_t columns) : out_(path) {
    write("| " + head + " |");
    std::string rule = "|";
    for (std::size_t k = 0; k < columns; ++k) rule += " --- |";
    write(rule);
  }
  void write(const std::string& line) {
    out_ << line << '\n' << std::flush;
    std::cout << line << std::endl;
  }

 private:
  std::ofstream out_;
};

class LongForm {
 public:
  explicit LongForm(Arguments arguments)
      : arguments_(std::move(arguments)),
        threads_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        plot_(arguments_.folder + "/coverage.tsv") {
    for (CoverageScene& scene : coverage_scenes()) {
      if (is_wanted(scene.name)) scenes_.push_back(std::move(scene));
    }
    plot_ << "# scene held se rho_held rho_se width rms_z held_without_certificate\n";
  }

  bool run() {
    compare_with_truth();
    leave_out_each();
    compare_budgets();
    return is_sound_;
  }

 private:
  [[nodiscard]] bool is_wanted(const std::string& name) const {
    return arguments_.scenes.empty() || std::ranges::find(arguments_.scenes, name) != arguments_.scenes.end();
  }

  CoverageFigures measure(const CoverageScene& scene, bool without_certificate, std::optional<Correction> left_out) {
    const auto prepared = prepare(scene, without_certificate);
    if (!prepared) return refuse(prepared.error());
    points_ = prepared->points.size();
    const auto outcomes =
        run_campaign(*prepared, {.repetitions = arguments_.repetitions, .threads = threads_, .left_out = left_out});
    if (!outcomes) return refuse(outcomes.error());
    return figures_of(*outcomes);
  }

  CoverageFigures refuse(const Error& error) {
    std::cerr << describe(error) << '\n';
    is_sound_ = false;
    return {};
  }

  std::string verdict(const CoverageScene& scene, const CoverageFigures& figures, bool without_certificate) {
    const std::vector<std::string> found = failures(figures, Claim{});
    for (const std::string& line : found) {
      std::cout << "  " << scene.name << (without_certificate ? " without certificate" : "") << ": " << line << '\n';
    }
    is_sound_ = is_sound_ && found.empty();
    return found.empty() ? "holds" : "**fails**";
  }

  static std::string strata(const CoverageFigures& f) {
    std::string text;
    for (const StratumFigures& s : f.strata) {
      text += s.values_per_repetition < 0.5 ? " - |" : fmt::format(" {:.2f} |", s.rms_z);
    }
    return text;
  }

  void compare_with_truth() {
    Table with(
        arguments_.folder + "/scenes.md",
        "scene | points | held [%] | s.e. | rho_dh held [%] | RMS z: theta_r < 30 | < 60 | from 60 | lobe | near "
        "zero | U/2 over RMS error | median U/f [%] | refused [%] | the claim",
        14);
    for (const CoverageScene& scene : scenes_) {
      const CoverageFigures& f = with_all_[scene.name] = measure(scene, false, std::nullopt);
      const std::string word = verdict(scene, f, false);
      with.write(fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} |{} {:.2f} | {:.2f} | {:.2f} | {} |", scene.name,
                             points_, 100.0 * f.held.value, 100.0 * f.held.standard_error, 100.0 * f.rho_held.value,
                             strata(f), f.width, 100.0 * f.relative_expanded, 100.0 * f.refused, word));
    }
    Table without(
        arguments_.folder + "/no-certificate.md",
        "scene | held [%] | s.e. | rho_dh held [%] | RMS z: theta_r < 30 | < 60 | from 60 | lobe | near zero | "
        "U/2 over RMS error | median U/f [%] | the claim",
        12);
    for (std::size_t n = 0; n < scenes_.size(); ++n) {
      const CoverageFigures f = measure(scenes_[n], true, std::nullopt);
      const std::string word = verdict(scenes_[n], f, true);
      without.write(fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} |{} {:.2f} | {:.2f} | {} |", scenes_[n].name,
                                100.0 * f.held.value, 100.0 * f.held.standard_error, 100.0 * f.rho_held.value,
                                strata(f), f.width, 100.0 * f.relative_expanded, word));
      const CoverageFigures& g = with_all_.at(scenes_[n].name);
      plot_ << fmt::format("{} {} {} {} {} {} {} {}\n", scenes_[n].name, 100.0 * g.held.value,
                           100.0 * g.held.standard_error, 100.0 * g.rho_held.value, 100.0 * g.rho_held.standard_error,
                           g.width, g.rms_z, 100.0 * f.held.value)
            << std::flush;
    }
  }

  void leave_out_each() {
    Table table(arguments_.folder + "/left-out.md",
                "left out | scene | held [%] with it | without | rho_dh held [%] with it | without | RMS z with it | "
                "without | found out",
                9);
    for (const LeftOutCase& c : left_out_cases()) {
      const auto scene = std::ranges::find(scenes_, c.scene, &CoverageScene::name);
      if (scene == scenes_.end()) continue;
      const CoverageFigures& with = with_all_.at(c.scene);
      const CoverageFigures without = measure(*scene, false, c.correction);
      const bool is_found = !failures(without, Claim{}).empty();
      is_sound_ = is_sound_ && is_found;
      table.write(fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} |",
                              correction_name(c.correction), c.scene, 100.0 * with.held.value,
                              100.0 * without.held.value, 100.0 * with.rho_held.value, 100.0 * without.rho_held.value,
                              with.rms_z, without.rms_z, is_found ? "yes" : "**no**"));
    }
  }

  void compare_budgets() {
    constexpr double kAgreement = 0.03;
    Table table(arguments_.folder + "/budget.md",
                "scene | Monte Carlo / formula | single points | drawn as the budget states it | within 3 %", 5);
    for (const CoverageScene& scene : scenes_) {
      const auto prepared = prepare(scene);
      if (!prepared) {
        refuse(prepared.error());
        continue;
      }
      const auto c = compare_budget(*prepared, arguments_.draws, kBudgetSeed, threads_);
      if (!c) {
        refuse(c.error());
        continue;
      }
      const bool agrees = std::abs(c->ratio - 1.0) <= kAgreement;
      is_sound_ = is_sound_ && agrees;
      table.write(fmt::format("| {} | {:.4f} | {:.3f} to {:.3f} | {} | {} |", scene.name, c->ratio, c->least_point,
                              c->largest_point, fmt::join(c->as_stated, ", "), agrees ? "yes" : "**no**"));
    }
  }

  Arguments arguments_;
  int threads_;
  std::ofstream plot_;
  std::vector<CoverageScene> scenes_;
  std::map<std::string, CoverageFigures> with_all_;
  std::size_t points_ = 0;
  bool is_sound_ = true;
};

}  // namespace
}  // namespace gonio::coverage

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: coverage_campaign DIR [REPETITIONS [DRAWS [SCENE...]]]\n";
    return 2;
  }
  gonio::coverage::Arguments arguments{.folder = argv[1], .scenes = {}};
  if (argc > 2) arguments.repetitions = std::atoi(argv[2]);
  if (argc > 3) arguments.draws = std::atoi(argv[3]);
  for (int k = 4; k < argc; ++k) arguments.scenes.emplace_back(argv[k]);
  if (arguments.repetitions < 2 || arguments.draws < 2) {
    std::cerr << "REPETITIONS and DRAWS are whole numbers from 2 on\n";
    return 2;
  }
  return gonio::coverage::LongForm(std::move(arguments)).run() ? 0 : 1;
}
