#include "drivers/links/tape/tape_player.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/links/tape/exchange_bytes.h"

namespace gonio::drivers {
namespace {

// A clock may be passed over, so it is not worth reading far ahead for one.
constexpr std::size_t kMostAheadForAClock = 4096;

std::optional<TapeParty> party_of(const TapeRecord& record) {
  if (const auto* turn = std::get_if<TapeTurn>(&record)) return turn->party;
  if (const auto* exchange = std::get_if<TapeExchange>(&record)) return exchange->party;
  if (const auto* reading = std::get_if<TapeReading>(&record)) return reading->party;
  return std::nullopt;
}

}  // namespace

TapePlayer::TapePlayer(TapeReader& reader) : reader_(reader), latest_(reader.start().boottime) {
  for (Track& one : tracks_) one.now = reader.start().boottime;
}

Result<bool> TapePlayer::read_one() {
  if (is_at_end_) return false;
  Result<std::optional<TapeRecord>> record = reader_.next();
  if (!record) {
    is_at_end_ = true;
    difference_ = record.error();
    return failure(record.error());
  }
  if (!*record) {
    is_at_end_ = true;
    return false;
  }
  const std::int64_t number = reader_.number();
  if (const auto* input = std::get_if<TapeInput>(&**record)) steps_.push_back({number, *input});
  if (const auto* turn = std::get_if<TapeTurn>(&**record)) steps_.push_back({number, *turn});
  if (const auto party = party_of(**record)) {
    track(*party).entries.push_back({number, std::move(**record)});
    ++ahead_;
  }
  return true;
}

TapePlayer::Entry* TapePlayer::front(TapeParty party, std::size_t most_ahead) {
  Track& of = track(party);
  while (of.entries.empty() && ahead_ < most_ahead) {
    const Result<bool> read = read_one();
    if (!read || !*read) return nullptr;
  }
  return of.entries.empty() ? nullptr : &of.entries.front();
}

void TapePlayer::drop_front(Track& track) {
  track.entries.pop_front();
  --ahead_;
}

void TapePlayer::reach(Track& track, Instant t) {
  track.now = std::max(track.now, t);
  latest_ = std::max(latest_, t);
}

void TapePlayer::remember(Track& track, const TapeExchange& exchange) {
  const auto index = static_cast<std::size_t>(exchange.call);
  if (is_a_query(exchange.call) && index < track.answers.size()) track.answers[index] = exchange.reply;
}

Error TapePlayer::differs(TapeParty party, std::int64_t number, Instant at, const std::string& now_asked,
                          const std::string& then_asked) {
  difference_ = Error{.code = ErrorCode::ReplayDiffers,
                      .device = std::string(tape_party_name(party)),
                      .tried = fmt::format("replay record {}, {:.6f} s after the start: asked now: {}", number,
                                           in_seconds(at - reader_.start().boottime), now_asked),
                      .seen = "then: " + then_asked,
                      .limit = {}};
  return *difference_;
}

Result<std::optional<TapePlayer::Step>> TapePlayer::next() {
  if (difference_) return failure(*difference_);
  if (has_run_out_) return std::optional<Step>();
  while (steps_.empty()) {
    const Result<bool> read = read_one();
    if (!read) return failure(read.error());
    if (*read) continue;
    for (int party = 1; party <= kTapePartyCount; ++party) tracks_[static_cast<std::size_t>(party)].entries.clear();
    return std::optional<Step>();
  }
  Step step = std::move(steps_.front());
  steps_.pop_front();
  if (const auto* turn = std::get_if<TapeTurn>(&step.what)) {
    GONIO_TRY(finish_turn(turn->party, step.number));
    reach(track(turn->party), turn->now);
  }
  return std::optional<Step>(std::move(step));
}

// Everything of the party before this turn belongs to the one before.
Result<void> TapePlayer::finish_turn(TapeParty party, std::int64_t number) {
  Track& of = track(party);
  while (!of.entries.empty() && of.entries.front().number <= number) {
    const Entry& entry = of.entries.front();
    if (const auto* exchange = std::get_if<TapeExchange>(&entry.record)) {
      if (!is_a_query(exchange->call)) {
        return failure(
            differs(party, entry.number, exchange->asked, "nothing", in_words(exchange->call, exchange->request)));
      }
      remember(of, *exchange);
    }
    drop_front(of);
  }
  return {};
}

Result<TapeExchange> TapePlayer::answer(TapeParty party, std::uint8_t link, TapeCall call,
                                        std::span<const std::uint8_t> request) {
  if (difference_) return failure(*difference_);
  Track& of = track(party);
  const std::string asked = in_words(call, request);
  while (Entry* entry = front(party, kMostAhead)) {
    if (auto* exchange = std::get_if<TapeExchange>(&entry->record)) {
      const bool is_it =
          exchange->call == call && exchange->link == link && std::ranges::equal(exchange->request, request);
      if (is_it) {
        TapeExchange found = std::move(*exchange);
        drop_front(of);
        reach(of, found.answered);
        ++exchanges_;
        return found;
      }
      if (!is_a_query(exchange->call)) {
        return failure(
            differs(party, entry->number, exchange->asked, asked, in_words(exchange->call, exchange->request)));
      }
      remember(of, *exchange);
    } else if (const auto* turn = std::get_if<TapeTurn>(&entry->record)) {
      return failure(differs(party, entry->number, turn->now, asked, "nothing more in this turn"));
    }
    drop_front(of);
  }
  if (difference_) return failure(*difference_);
  Error ended = differs(party, reader_.number() + 1, of.now, asked, "the tape has ended: " + reader_.tail());
  if (reader_.is_cut_off()) {  // the program was killed in the midst of this: there is nothing to differ from
    difference_.reset();
    has_run_out_ = true;
  }
  return failure(std::move(ended));
}

std::vector<std::uint8_t> TapePlayer::query(TapeParty party, std::uint8_t link, TapeCall call) {
  Track& of = track(party);
  while (Entry* entry = front(party, kMostAhead)) {
    const auto* exchange = std::get_if<TapeExchange>(&entry->record);
    const bool may_pass =
        std::holds_alternative<TapeReading>(entry->record) || (exchange != nullptr && is_a_query(exchange->call));
    if (!may_pass) break;
    const bool is_it = exchange != nullptr && exchange->call == call && exchange->link == link;
    if (exchange != nullptr) remember(of, *exchange);
    drop_front(of);
    if (is_it) break;
  }
  return of.answers[static_cast<std::size_t>(call)];
}

Instant TapePlayer::now(TapeParty party) {
  Track& of = track(party);
  if (const Entry* entry = front(party, kMostAheadForAClock)) {
    if (const auto* reading = std::get_if<TapeReading>(&entry->record); reading != nullptr && !reading->is_utc) {
      reach(of, Instant(Duration(reading->ns)));
      drop_front(of);
    }
  }
  return of.now;
}

UtcTime TapePlayer::utc_now(TapeParty party) {
  Track& of = track(party);
  if (const Entry* entry = front(party, kMostAheadForAClock)) {
    if (const auto* reading = std::get_if<TapeReading>(&entry->record); reading != nullptr && reading->is_utc) {
      const UtcTime utc{Duration(reading->ns)};
      drop_front(of);
      return utc;
    }
  }
  return reader_.start().utc + (of.now - reader_.start().boottime);
}

}  // namespace gonio::drivers
