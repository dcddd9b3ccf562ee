#include "reflectance/table/table_of_readings.h"

namespace gonio::reflectance {

Result<TabulatedSurface> table_of_readings(std::span<const TableReading> readings, TableOptions options) {
  options.layout = TableLayout::Scattered;
  Result<TabulatedSurface> table = TabulatedSurface::make(readings, options);
  if (table) return table;
  options.layout = TableLayout::Rings;
  return TabulatedSurface::make(readings, options);  // what is wrong with both, rings say more plainly
}

}  // namespace gonio::reflectance
