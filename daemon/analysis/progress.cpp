#include "daemon/analysis/progress.h"

#include <algorithm>
#include <ostream>

#include <fmt/format.h>

#include "protocol/api/json.h"

namespace gonio::analysis {

void Progress::step(double share, std::string_view doing) {
  if (form_ == Form::Lines) {
    out_ << api::to_json(api::AnalysisReport{.state = "running", .progress = share, .doing = std::string(doing)})
         << std::endl;
    return;
  }
  if (!is_terminal_) return;
  const std::string text = fmt::format("{:3.0f} % {}", 100.0 * share, doing);
  err_ << '\r' << text << std::string(text.size() < shown_ ? shown_ - text.size() : 0, ' ') << std::flush;
  shown_ = text.size();
}

void Progress::end(const api::AnalysisReport& outcome) {
  if (form_ == Form::Lines) {
    out_ << api::to_json(outcome) << std::endl;
    return;
  }
  if (shown_ > 0) err_ << '\r' << std::string(shown_, ' ') << '\r';
  tell_people(outcome);
}

void Progress::tell_people(const api::AnalysisReport& outcome) {
  for (const api::AnalysisFact& fact : outcome.facts) {
    out_ << fact.name << "  " << fmt::format("{:.6g}", fact.value);
    if (fact.expanded_u) out_ << fmt::format(" +- {:.2g}", *fact.expanded_u);
    out_ << (fact.unit == "1" ? "" : " " + fact.unit) << (fact.note.empty() ? "" : "  " + fact.note) << '\n';
  }
  for (const api::AnalysisLoss& loss : outcome.losses) err_ << "not in the file: " << loss_text(loss) << '\n';
  for (const std::string& note : outcome.notes) err_ << "note: " << note << '\n';
  for (const api::AnalysisFile& file : outcome.files) err_ << fmt::format("{} ({} bytes)\n", file.name, file.bytes);
  if (outcome.error) err_ << "gonio-analyse: " << explain(*outcome.error) << '\n';
  out_ << std::flush;
}

std::string loss_text(const api::AnalysisLoss& loss) {
  const std::string values = loss.values > 0 ? fmt::format(" ({} values)", loss.values) : "";
  return loss.kind + values + ": " + loss.what;
}

}  // namespace gonio::analysis
