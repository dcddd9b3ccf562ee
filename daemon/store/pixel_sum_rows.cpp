// What map jobs keep of their frames, written and read.
#include "daemon/store/pixel_sum_rows.h"

#include <algorithm>

#include "daemon/store/record_writer.h"

namespace gonio::daemon {

using calibration::PixelStack;
using calibration::PixelSums;

void RecordWriter::write_pixel_sums(const PixelSums& sums, std::int64_t attempt, std::int64_t visit) {
  Statement& insert = database_.statement("INSERT INTO pixel_sum VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  attempt == 0 ? insert.bind_null() : insert.bind(attempt);
  visit == 0 ? insert.bind_null() : insert.bind(visit);
  insert.bind(sums.exposure.count()).bind(sums.gain_db).bind(sums.frames);
  insert.bind(sums.box.width).bind(sums.box.height).bind(sums.box.left).bind(sums.box.top);
  insert.bind(sums.box.columns).bind(sums.box.rows).bind_blob(sums.sum).bind_blob(sums.sum2).run();
}

namespace {

PixelSums sums_of(const Statement& row) {
  PixelSums sums{.box = {.width = static_cast<int>(row.integer(4)),
                         .height = static_cast<int>(row.integer(5)),
                         .left = static_cast<int>(row.integer(6)),
                         .top = static_cast<int>(row.integer(7)),
                         .columns = static_cast<int>(row.integer(8)),
                         .rows = static_cast<int>(row.integer(9))},
                 .exposure = Duration(row.integer(1)),
                 .gain_db = row.real(2),
                 .frames = row.integer(3)};
  const auto sum = row.doubles(10);
  sums.sum.assign(sum.begin(), sum.end());
  const auto sum2 = row.doubles(11);
  sums.sum2.assign(sum2.begin(), sum2.end());
  return sums;
}

Result<void> add_to(std::vector<PixelStack>& stacks, const PixelSums& sums) {
  const auto same = std::ranges::find(stacks, sums.exposure, &PixelStack::exposure);
  return same == stacks.end() ? stacks.emplace_back().add(sums) : same->add(sums);
}

}  // namespace

Result<PixelStacks> read_pixel_stacks(Database& database, ScanId scan) {
  PixelStacks stacks;
  Statement& query = database.statement(
      "SELECT p.visit_id IS NOT NULL, exposure_ns, gain_db, frames, width_px, height_px, left_px, top_px, columns_px, "
      "rows_px, sums_dn, squares_dn2 FROM pixel_sum p LEFT JOIN attempt a USING (attempt_id) LEFT JOIN visit v ON "
      "v.visit_id = p.visit_id WHERE coalesce(a.scan_id, v.scan_id) = ? ORDER BY pixel_sum_id");
  query.bind(scan);
  Result<void> added;
  while (query.next()) {
    if (added) added = add_to(query.integer(0) != 0 ? stacks.dark : stacks.lit, sums_of(query));
  }
  if (!added) return failure(added.error());
  return stacks;
}

}  // namespace gonio::daemon
