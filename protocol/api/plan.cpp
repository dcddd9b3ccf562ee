#include "protocol/api/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/toml_reader.h"
#include "protocol/api/plan_geometry.h"
#include "protocol/api/toml_values.h"

namespace gonio::api {
namespace {

constexpr NumberRange kWait{.least = 1.0, .most = 1e6, .unit = "s"};

// A number or a list of them: what each reading is exposed for. All of them must fit into the time of a reading.
std::vector<Duration> read_exposures(TomlReader& reading, Duration max_time) {
  constexpr std::string_view kKey = "exposure_s";
  const TomlKind kind = reading.kind(kKey);
  if (kind == TomlKind::Absent) return {};
  const NumberRange range{.least = 1e-6, .most = 3600.0, .unit = "s"};
  std::vector<double> values =
      kind == TomlKind::Array ? reading.numbers(kKey, range) : std::vector<double>{reading.number(kKey, range)};
  if (reading.has_failed()) return {};
  refuse_repetition(reading, kKey, values, range.unit);
  std::ranges::sort(values);
  std::vector<Duration> exposures;
  double sum = 0.0;
  for (const double value : values) {
    exposures.push_back(seconds(value));
    sum += value;
  }
  if (sum > in_seconds(max_time)) {
    reading.fail(kKey, ErrorCode::InvalidInput, fmt::format("{} s in all", without_creep(sum)),
                 fmt::format("at most max_time_s = {} s", in_seconds(max_time)));
  }
  return exposures;
}

void read_reading(TomlReader& root, Plan& plan) {
  constexpr double kMaxTime = 4.0;
  plan.max_time = seconds(kMaxTime);
  std::optional<TomlReader> table = root.optional_table("reading");
  if (!table) return;
  plan.target_snr = table->number_or("target_snr", plan.target_snr, {.least = 1.0, .most = 1e6});
  plan.max_time = seconds(table->number_or("max_time_s", kMaxTime, {.least = 1e-4, .most = 3600.0, .unit = "s"}));
  plan.exposures = read_exposures(*table, plan.max_time);
}

void read_anchor(TomlReader& reference, Plan& plan) {
  constexpr NumberRange kTheta{.least = 0.0, .most = 89.0, .unit = "deg"};
  constexpr NumberRange kPhi{.least = -360.0, .most = 360.0, .unit = "deg"};
  std::optional<TomlReader> anchor = reference.optional_table("anchor");
  if (!anchor) return;
  if (plan.reference_mode != ReferenceMode::Anchor) {
    return reference.fail("anchor", ErrorCode::InvalidInput, "it stands beside another mode", "mode = \"anchor\"");
  }
  plan.anchor.theta_i = degrees(anchor->number("theta_i_deg", kTheta));
  plan.anchor.theta_r = degrees(anchor->number("theta_r_deg", kTheta));
  plan.anchor.phi_r = degrees(anchor->number_or("phi_r_deg", 0.0, kPhi));
}

void read_reference(TomlReader table, Plan& plan) {
  constexpr std::array<std::string_view, 3> kModes{"same-geometry", "anchor", "absolute"};  // as ReferenceMode
  constexpr double kBlock = 900.0;
  plan.reference_standard = table.text("standard");
  const auto usual = static_cast<std::size_t>(plan.reference_mode);
  plan.reference_mode = static_cast<ReferenceMode>(table.choice_or("mode", usual, kModes));
  plan.block = seconds(table.number_or("block_s", kBlock, kWait));
  read_anchor(table, plan);
}

void read_visits(TomlReader& root, Plan& plan) {
  constexpr double kDark = 300.0;
  plan.dark_every = seconds(kDark);
  // The standard is read before, about every block and after: without such visits there is no BRDF.
  if (plan.reference_mode == ReferenceMode::Anchor) plan.reference_every = plan.block;
  std::optional<TomlReader> table = root.optional_table("visits");
  if (!table) return;
  plan.dark_every = seconds(table->number_or("dark_s", kDark, kWait));
  const auto wanted = [&table](std::string_view key) {
    return table->kind(key) == TomlKind::Absent ? Duration{} : seconds(table->number(key, kWait));
  };
  if (table->kind("reference_s") != TomlKind::Absent) plan.reference_every = wanted("reference_s");
  plan.check_every = wanted("check_s");
  plan.drift_limit = table->number_or("drift_limit", plan.drift_limit, {.least = 1e-5, .most = 1.0});
  plan.drift_rounds = static_cast<int>(table->integer_or("drift_rounds", plan.drift_rounds, 0, 10));
}

void read_order(TomlReader& root, Plan& plan) {
  constexpr std::array<std::string_view, 3> kStrategies{"fastest", "as-written", "random"};
  std::optional<TomlReader> table = root.optional_table("order");
  if (!table) return;
  plan.order = static_cast<OrderStrategy>(table->choice_or("strategy", 0, kStrategies));
  plan.order_seed = static_cast<std::uint64_t>(table->integer_or("seed", 1, 0, INT64_MAX));
}

std::optional<OnItemError> last_resort(std::string_view word) {
  if (word == "skip") return OnItemError::Skip;
  if (word == "hold") return OnItemError::Hold;
  if (word == "fail") return OnItemError::Fail;
  return std::nullopt;
}

struct ItemPolicy {
  int retries = 0;
  OnItemError then = OnItemError::Skip;
};

// "skip", or "retry 2, then skip".
std::optional<ItemPolicy> item_policy(std::string_view text) {
  constexpr std::string_view kRetry = "retry ";
  constexpr std::string_view kThen = ", then ";
  constexpr int kMostRetries = 10;
  ItemPolicy policy;
  if (text.starts_with(kRetry)) {
    text.remove_prefix(kRetry.size());
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), policy.retries);
    if (error != std::errc() || policy.retries < 0 || policy.retries > kMostRetries) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.starts_with(kThen)) return std::nullopt;
    text.remove_prefix(kThen.size());
  }
  const std::optional<OnItemError> then = last_resort(text);
  if (!then) return std::nullopt;
  policy.then = *then;
  return policy;
}

void read_on_error(TomlReader& root, Plan& plan) {
  std::optional<TomlReader> table = root.optional_table("on_error");
  if (!table) return;
  const std::string text = table->text_or("item", "retry 2, then skip");
  const std::optional<ItemPolicy> policy = item_policy(text);
  if (!policy) {
    table->fail("item", ErrorCode::InvalidInput, fmt::format("found \"{}\"", text),
                "\"skip\", \"hold\", \"fail\", or \"retry N, then skip\" with N up to 10");
    return;
  }
  plan.item_retries = policy->retries;
  plan.on_item_error = policy->then;
}

void read_on_restart(TomlReader& root, Plan& plan) {
  constexpr std::array<std::string_view, 2> kPolicies{"resume", "hold"};
  std::optional<TomlReader> table = root.optional_table("on_restart");
  if (table) plan.on_restart = static_cast<OnRestart>(table->choice_or("policy", 0, kPolicies));
}

void read_budget(TomlReader& root, Plan& plan) {
  constexpr double kMinute = 60.0;
  std::optional<TomlReader> table = root.optional_table("budget");
  if (!table) return;
  plan.budget =
      PlanBudget{.time = seconds(kMinute * table->number("time_min", {.least = 0.1, .most = 1e5, .unit = "min"})),
                 .least_snr = table->optional_number("least_snr", {.least = 1.0, .most = 1e6})};
  if (!plan.budget->least_snr || *plan.budget->least_snr <= plan.target_snr) return;
  table->fail("least_snr", ErrorCode::InvalidInput, fmt::format("{}", *plan.budget->least_snr),
              fmt::format("at most target_snr = {}", plan.target_snr));
}

std::string needed_text(TomlReader& table, std::string_view key) {
  std::string text = table.text(key);
  if (text.empty()) table.fail(key, ErrorCode::InvalidInput, "the text is empty", "some text");
  return text;
}

}  // namespace

Result<Plan> parse_plan(std::string_view toml, const std::string& file,
                        const std::map<std::string, std::string>& files) {
  Result<TomlReader> root = TomlReader::parse(toml, file);
  if (!root) return failure(std::move(root).error());
  Plan plan;
  TomlReader scan = root->table("scan");
  plan.name = needed_text(scan, "name");
  plan.sample = needed_text(scan, "sample");
  plan.isotropic = scan.flag_or("isotropic", true);
  plan.expected_reflectance = scan.optional_number("expected_reflectance", {.least = 1e-4, .most = 1e3});
  Result<void> listed;
  if (!read_calibration(*root, plan)) read_geometry(root->table("geometry"), files, plan, listed);
  read_reading(*root, plan);
  make_ladder(*root, plan);
  read_reference(root->table("reference"), plan);
  read_visits(*root, plan);
  refuse_targets_beside_a_beam(*root, plan);
  check_flat_field(*root, plan);
  read_order(*root, plan);
  read_on_error(*root, plan);
  read_on_restart(*root, plan);
  read_budget(*root, plan);
  GONIO_TRY(root->finish());
  GONIO_TRY(listed);
  return plan;
}

}  // namespace gonio::api
