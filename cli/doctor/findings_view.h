#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "cli/doctor/finding.h"
#include "cli/output.h"

namespace gonio::cli {

[[nodiscard]] Table view(const std::vector<Finding>& findings);
/// A JSON array of objects with the members of Finding.
[[nodiscard]] std::string findings_json(const std::vector<Finding>& findings);
/// One finding as people read it: a line, and below it what to do.
void print_finding(std::ostream& out, const Finding& finding);

}  // namespace gonio::cli
