#pragma once

#include "reflectance/batch/direction_block.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/henyey_greenstein.h"

namespace gonio::reflectance {

using Row = DirectionBlock::Row;

/// separation_terms(i, r) of a block, each term a row.
struct SeparationRows {
  Row tilt2;
  Row turn2;
  Row sines;
};
void fill(SeparationRows& rows, const Direction& i, const DirectionBlock& r, VectorUnit unit);

/// sum_terms(i, r) of a block, each term a row, and the tilt2 of separation_terms.
struct SumRows {
  Row rise2;
  Row facing2;
  Row sines;
  Row tilt2;
};
void fill(SumRows& rows, const Direction& i, const DirectionBlock& r, VectorUnit unit);

/// The phase function of a block.
void fill_phase(Row& row, const HenyeyGreenstein& phase, const SeparationRows& t, const Direction& i,
                const DirectionBlock& r, VectorUnit unit);

}  // namespace gonio::reflectance
