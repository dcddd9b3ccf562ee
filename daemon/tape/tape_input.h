#pragma once

#include <optional>

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/sequencer/messages.h"
#include "drivers/links/tape/tape_record.h"

namespace gonio::daemon {

/// What reaches the sequencer from outside, as a tape has it: a client's command in JSON, a plan as text with its
/// reference's certificate; or a STOP. Nothing: the message is an answer, which a replay makes anew.
[[nodiscard]] std::optional<drivers::TapeInput> tape_input_of(const SequencerMessage& message);

/// The same again. A plan is parsed and expanded by today's planner on this instrument, so that another planner shows.
/// Errors: InvalidInput (not an input of this version), and those of the planner.
[[nodiscard]] Result<SequencerMessage> message_of(const drivers::TapeInput& input, const Instrument& instrument);

}  // namespace gonio::daemon
