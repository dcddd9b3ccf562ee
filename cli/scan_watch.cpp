#include "cli/scan_watch.h"

#include <algorithm>
#include <array>
#include <ostream>

#include "cli/views.h"

namespace gonio::cli {
namespace {

using Steady = std::chrono::steady_clock;
constexpr std::array<std::string_view, 4> kEnds{"done", "finished-early", "aborted", "failed"};

// Shows a scan again and again without filling a log: rewritten on a terminal, else a line for each change of state or
// tenth.
class ProgressLine {
 public:
  explicit ProgressLine(World& world) : world_(world) {}

  void show(const api::ScanReport& scan) {
    const std::string text = progress_text(scan);
    if (world_.out_is_terminal) {
      const std::size_t blanks = text.size() < shown_.size() ? shown_.size() - text.size() : 0;
      world_.out << '\r' << text << std::string(blanks, ' ') << std::flush;
      shown_ = text;
      return;
    }
    const std::int64_t tenth = scan.items == 0 ? 0 : 10 * (scan.accepted + scan.skipped) / scan.items;
    const std::string mark = scan.state + std::to_string(tenth) + holds_text(scan);
    if (mark == shown_) return;
    shown_ = mark;
    world_.out << text << std::endl;
  }

  void end() {
    if (world_.out_is_terminal && !shown_.empty()) world_.out << '\n';
  }

 private:
  World& world_;
  std::string shown_;
};

bool changes_state(const api::Event& event) {
  return event.kind.starts_with("scan-") || event.kind.starts_with("hold");
}

}  // namespace

bool is_over(const api::ScanReport& scan) {
  return std::ranges::find(kEnds, scan.state) != kEnds.end();
}

Result<api::ScanReport> watch_scan(DaemonClient& client, std::int64_t scan, World& world) {
  constexpr auto kBetweenLooks = std::chrono::milliseconds(300);
  Result<HttpClient> second = HttpClient::open(client.connect(), world.interrupted);
  if (!second) return failure(second.error());
  DaemonClient looker(std::move(*second), client.connect());
  // The number first, then the look: what happens between them comes as an event.
  const auto status = client.get<api::StatusReport>(api::RouteId::Status);
  if (!status) return failure(status.error());
  auto seen = client.get<api::ScanReport>(api::RouteId::ScanOne, scan);
  if (!seen) return failure(seen.error());
  ProgressLine line(world);
  line.show(seen->value);
  Steady::time_point next_look = Steady::now();
  if (!is_over(seen->value)) {
    const Result<void> watched = client.events(status->value.last_event, [&](const api::Event& event) {
      if (event.scan != scan || (!changes_state(event) && Steady::now() < next_look)) return true;
      next_look = Steady::now() + kBetweenLooks;
      seen = looker.get<api::ScanReport>(api::RouteId::ScanOne, scan);
      if (!seen) return false;
      line.show(seen->value);
      return !is_over(seen->value);
    });
    line.end();
    if (!watched) return failure(watched.error());
  }
  if (!seen) return failure(seen.error());
  return seen->value;
}

}  // namespace gonio::cli
