#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calibration/instrument_model.h"
#include "calibration/reference_definition.h"
#include "sim/scene/chance.h"
#include "sim/scene/scene.h"
#include "tests/coverage/short_scan.h"

namespace gonio::coverage {

/// A sample on an instrument, what of both is drawn anew in each repetition, and what is told of it. What is told holds
/// no draw: it is what an honest operator would state who knows the distributions and not the values.
struct CoverageScene {
  std::string name;  ///< also of its test
  std::string what;  ///< for the table
  std::string file;  ///< of sim/scenes, without its ending
  std::uint64_t first_seed = 0;
  ScanPlan plan{};
  bool has_lobe = false;                                  ///< its points above half of the largest truth are a stratum
  std::function<void(sim::Scene&)> bend{};                ///< once, before any repetition
  std::function<void(sim::Scene&, sim::Chance&)> draw{};  ///< each repetition, beside what `sim::Truth` draws
  std::function<void(calibration::InstrumentModel&)> tell{};  ///< once, on top of `ShortScan::stated_model`
};

/// All of them, in the order of the table.
[[nodiscard]] std::vector<CoverageScene> coverage_scenes();

/// A scene as it is used: read, bent, with its papers.
struct PreparedScene {
  CoverageScene scene;
  sim::Scene base;  ///< without the draws of a repetition
  std::vector<calibration::PlannedPoint> points;
  calibration::InstrumentModel told;
  calibration::ReferenceDefinition reference;
};

/// `without_certificate`: its error and its u are both 0. Errors: those of read_scene and parse_reference.
[[nodiscard]] Result<PreparedScene> prepare(const CoverageScene& scene, bool without_certificate = false);

}  // namespace gonio::coverage
