#include "reflectance/table/table_of_readings.h"

namespace gonio::reflectance {

Result<TabulatedSurface> table_of_readings(std::span<const TableReading> readings, TableOptions options) {
  options.layout = TableLayout::Scattered;
  Result<TabulatedSurface> table = TabulatedSurface::make(readings, options);
  if (table) return table;
  options.layout = TableLayout::Rings;
  Result<TabulatedSurface> rings = TabulatedSurface::make(readings, options);
  return rings ? std::move(rings) : std::move(table);
}

}  // namespace gonio::reflectance
