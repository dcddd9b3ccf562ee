#include "cli/doctor/trial_move.h"

#include <fmt/format.h>

#include <cmath>

#include "protocol/api/json.h"

namespace gonio::cli {

std::string trial_move_body(const std::string& axis, double to) {
  api::MoveRequest move;
  if (axis == "theta_i") move.theta_i_deg = to;
  if (axis == "theta_r") move.theta_r_deg = to;
  if (axis == "phi_r") move.phi_r_deg = to;
  if (axis == "phi_i") move.phi_i_deg = to;
  if (axis == "carriage") move.carriage_mm = to;
  if (axis == "filter_wheel") move.filter_wheel_slot = to;
  return api::to_json(move);
}

Finding check_stop(const std::string& axis, double end, double stands, double took_s,
                   const std::optional<Error>& ended_by) {
  constexpr double kBound_s = 0.25;  // 50 ms to the stage's wire, and the way of the answer
  Finding finding{.check = "STOP halts a move",
                  .seen = fmt::format("{} stands at {:.3f} on its way to {:.3f}; acknowledged after {:.0f} ms", axis,
                                      stands, end, 1e3 * took_s),
                  .limit = fmt::format("{:.0f} ms", 1e3 * kBound_s)};
  if (!ended_by) {
    finding.verdict = Verdict::Failed;
    finding.remedy = "the move was over before STOP came, or counted as done: try again, and watch the arm";
  } else if (ended_by->code != ErrorCode::Stopped && ended_by->code != ErrorCode::StaleEpoch) {
    finding.verdict = Verdict::Failed;
    finding.seen = "the move ended otherwise: " + describe(*ended_by);
    finding.remedy = "mend that first";
  } else if (took_s > kBound_s) {
    finding.verdict = Verdict::Warning;
    finding.remedy = "the way to the stage is slow: baud rate, a gateway, or a busy machine";
  }
  return finding;
}

}  // namespace gonio::cli
