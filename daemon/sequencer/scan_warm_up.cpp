// The lamp's warm-up: checked before a scan takes light, and after each restart.
#include <fmt/core.h>

#include <algorithm>

#include "daemon/sequencer/sequencer_impl.h"

namespace gonio::daemon {

// What was warm stays so as long as it is seen to burn: a scan that follows another does not wait again.
bool Sequencer::Impl::lamp_is_warm(Instant now) const {
  if (!lamp.wanted() || lamp.is_warm(now)) return true;
  return lamp_was_warm && lamp_seen && now - *lamp_seen <= lamp.wanted()->over;
}

void Sequencer::Impl::advance_warm_up(Instant now) {
  if (!scan->warm_up_since) scan->warm_up_since = now;
  if (now < scan->look_again_at) return;
  if (config.instrument.monitor) return ask_monitor(MonitorUse::Lamp, TakeMonitor{.window = lamp.sampling() / 2});
  ask_stage(StageUse::LampLook, LookAtStage{});
}

void Sequencer::Impl::on_lamp_seen(Instant now) {
  if (!scan || scan->preparation != ActiveScan::Preparation::WarmUp) return;
  const Duration waited = now - scan->warm_up_since.value_or(now);
  if (lamp_is_warm(now)) {
    lamp_was_warm = true;
    scan->warm_up_since.reset();
    scan->preparation = ActiveScan::Preparation::Verified;
    return;
  }
  scan->look_again_at = now + lamp.sampling();
  if (waited < lamp.wanted()->at_most) return;
  constexpr double kPercentPerMinute = 6000.0;
  const auto slope = lamp.slope_per_s(now);
  const std::string seen =
      slope ? fmt::format("its monitor still changes by {:.3g} %/min", kPercentPerMinute * *slope)
            : watch.lamp_is_out().value_or("its monitor was not seen for long enough without a break");
  add_hold(HoldName::Lamp, "stage",
           fmt::format("the lamp is not warm after {:.0f} s: {}, limit {:.3g} %/min over {:.0f} s", in_seconds(waited),
                       seen, kPercentPerMinute * lamp.wanted()->slope_per_s, in_seconds(lamp.wanted()->over)),
           now);
}

std::optional<WarmUpProgress> Sequencer::Impl::warm_up_progress(Instant now) const {
  if (!scan || !scan->warm_up_since) return std::nullopt;
  const Duration waited = now - *scan->warm_up_since;
  return WarmUpProgress{.slope_per_s = lamp.slope_per_s(now),
                        .limit_per_s = lamp.wanted()->slope_per_s,
                        .waited = waited,
                        .at_least = lamp.still_to_see(now),
                        .at_most = std::max(Duration::zero(), lamp.wanted()->at_most - waited)};
}

}  // namespace gonio::daemon
