#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "protocol/api/analysis.h"

namespace gonio::analysis {

/// What the worker program says while it works, and at the end. Threads: one.
class Progress {
 public:
  enum class Form {
    Lines,   ///< of JSON, each an api::AnalysisReport: for goniod
    People,  ///< facts, files and losses as text; steps on one line that is rewritten where `is_terminal`
  };
  Progress(Form form, std::ostream& out, std::ostream& err, bool is_terminal)
      : form_(form), out_(out), err_(err), is_terminal_(is_terminal) {}

  /// `share` of the whole job is done, 0 to 1; `doing` comes next.
  void step(double share, std::string_view doing);
  /// The last word: done, or failed with its error.
  void end(const api::AnalysisReport& outcome);

 private:
  void tell_people(const api::AnalysisReport& outcome);

  const Form form_;
  std::ostream& out_;
  std::ostream& err_;
  const bool is_terminal_;
  std::size_t shown_ = 0;  ///< characters on the line that is rewritten
};

/// "sign (12 values): negative values became 0".
[[nodiscard]] std::string loss_text(const api::AnalysisLoss& loss);

}  // namespace gonio::analysis
