// What changes in a scan that was accepted already: holds, its turn, the rest of its points.
#include <algorithm>
#include <string>
#include <vector>

#include "daemon/store/record_writer.h"

namespace gonio::daemon {

void RecordWriter::operator()(const ClearHolds& clear) {
  const auto write = [&](Statement& update) {
    update.bind(time_.utc_ns).bind(clear.who).bind(clear.scan);
    return &update;
  };
  if (clear.names.empty()) {
    write(database_.statement(
              "UPDATE hold SET cleared_utc_ns = ?, cleared_by = ? WHERE scan_id = ? AND cleared_utc_ns IS NULL"))
        ->run();
  }
  for (const HoldName name : clear.names) {
    write(database_.statement("UPDATE hold SET cleared_utc_ns = ?, cleared_by = ? WHERE scan_id = ? AND cleared_utc_ns "
                              "IS NULL AND name = ?"))
        ->bind(hold_name(name))
        .run();
  }
}

void RecordWriter::write_turn(ScanId scan, const ScanTurn& turn) {
  if (turn.priority == 0 && !turn.preempts && !turn.start && turn.completes == 0) return;
  Statement& insert = database_.statement("INSERT INTO scan_turn VALUES (?,?,?,?,?)");
  insert.bind(scan).bind(turn.priority).bind(turn.preempts);
  turn.start ? insert.bind(turn.start->utc.time_since_epoch().count()) : insert.bind_null();
  turn.completes != 0 ? insert.bind(turn.completes) : insert.bind_null();
  insert.run();
}

void RecordWriter::operator()(const ScanChange& change) {
  if (change.target_snr) {
    database_.statement("UPDATE scan SET target_snr = ? WHERE scan_id = ?")
        .bind(*change.target_snr)
        .bind(change.scan)
        .run();
  }
  if (change.max_time) {
    database_.statement("UPDATE scan SET max_time_ns = ? WHERE scan_id = ?")
        .bind(change.max_time->count())
        .bind(change.scan)
        .run();
  }
  if (change.priority || change.start) {
    database_.statement("INSERT INTO scan_turn VALUES (?,0,0,NULL,NULL) ON CONFLICT DO NOTHING")
        .bind(change.scan)
        .run();
  }
  if (change.priority) {
    database_.statement("UPDATE scan_turn SET priority = ? WHERE scan_id = ?")
        .bind(*change.priority)
        .bind(change.scan)
        .run();
  }
  if (change.start) {
    database_.statement("UPDATE scan_turn SET start_utc_ns = ? WHERE scan_id = ?")
        .bind(change.start->utc.time_since_epoch().count())
        .bind(change.scan)
        .run();
  }
  write_order(change.scan, change.order);
}

// Ranks are unique at every moment, so each goes out of the way below zero before it takes its new place.
void RecordWriter::write_order(ScanId scan, const std::vector<std::int32_t>& order) {
  std::vector<std::int64_t> ranks;
  ranks.reserve(order.size());
  for (const std::int32_t point : order) {
    Statement& aside = database_.statement(
        "UPDATE point SET rank = -1 - rank WHERE scan_id = ? AND point_index = ? RETURNING -1 - rank");
    aside.bind(scan).bind(point);
    while (aside.next()) ranks.push_back(aside.integer(0));
  }
  std::sort(ranks.begin(), ranks.end());
  for (std::size_t place = 0; place < std::min(order.size(), ranks.size()); ++place) {
    database_.statement("UPDATE point SET rank = ? WHERE scan_id = ? AND point_index = ?")
        .bind(ranks[place])
        .bind(scan)
        .bind(order[place])
        .run();
  }
}

}  // namespace gonio::daemon
