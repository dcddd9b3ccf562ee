#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "drivers/links/tape/tape_sink.h"

namespace gonio::drivers {

/// Where one link's exchanges go, and by which clock they are timed. Both outlive it.
class TapeChannel {
 public:
  TapeChannel(TapeSink& sink, const Clock& clock, TapeParty party, std::uint8_t link = 0)
      : sink_(&sink), clock_(&clock), party_(party), link_(link) {}

  /// An exchange that is asked now: to be filled in and put.
  [[nodiscard]] TapeExchange ask(TapeCall call, std::vector<std::uint8_t> request = {}) const {
    TapeExchange exchange{.party = party_, .link = link_, .call = call, .asked = clock_->now()};
    exchange.request = std::move(request);
    return exchange;
  }
  /// Answered now.
  void put(TapeExchange exchange) const {
    exchange.answered = clock_->now();
    sink_->put(std::move(exchange));
  }

 private:
  TapeSink* sink_;
  const Clock* clock_;
  TapeParty party_;
  std::uint8_t link_;
};

}  // namespace gonio::drivers
