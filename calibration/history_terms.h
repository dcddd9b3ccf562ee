#pragma once

#include "calibration/instrument_model.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// Terms of what visits found and when: the visits of the standard and what no line between them follows; gains and
/// ranges; each dark visit and the drift between two; each ambient and trap visit. A visit that both readings rest on
/// enters by the difference of its weights. sr^-1.
void add_history_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms);

}  // namespace gonio::calibration
