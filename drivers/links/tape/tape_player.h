#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/links/tape/tape_reader.h"
#include "drivers/links/tape/tape_record.h"

namespace gonio::drivers {

/// Answers from a tape. The replay asks for one turn after the other (`next`) and lets the party do what it does; the
/// party's links then ask here (`answer`), and its clock too (`now`).
///
/// What is asked must be what was asked then, party by party, in order and to the byte: the first difference is kept
/// (`difference`), and from then on every call fails with it. Queries of a link about itself and clock readings are
/// given where they fit and passed over where they do not: they are nothing that a device saw.
/// Reads ahead as far as a party needs, kMostAhead records at most. Threads: one.
class TapePlayer {
 public:
  static constexpr std::size_t kMostAhead = 200'000;

  /// What happens next, in the order of the recording.
  struct Step {
    std::int64_t number = 0;  ///< of the record
    std::variant<TapeTurn, TapeInput> what;
  };

  /// `reader` must outlive it.
  explicit TapePlayer(TapeReader& reader);

  /// The next turn or input; nothing at the end of the tape. Errors: the difference, if there is one by now: also that
  /// the party's last turn left something unasked that was asked then; IncompleteData (a damaged tape).
  [[nodiscard]] Result<std::optional<Step>> next();

  /// The exchange that was recorded for this request. Errors: ReplayDiffers; where a tape was cut off and the party has
  /// no more records, that is kept as no difference, and `next` says that the tape has ended.
  [[nodiscard]] Result<TapeExchange> answer(TapeParty party, std::uint8_t link, TapeCall call,
                                            std::span<const std::uint8_t> request);
  /// What a query was answered then, or last.
  [[nodiscard]] std::vector<std::uint8_t> query(TapeParty party, std::uint8_t link, TapeCall call);

  /// A clock reading of this party: the recorded one, or else its time as last known. Never goes backwards.
  [[nodiscard]] Instant now(TapeParty party);
  [[nodiscard]] UtcTime utc_now(TapeParty party);

  [[nodiscard]] const std::optional<Error>& difference() const { return difference_; }
  [[nodiscard]] std::int64_t exchanges() const { return exchanges_; }
  /// The latest instant that was reached, of all parties.
  [[nodiscard]] Instant latest() const { return latest_; }
  [[nodiscard]] const TapeReader& reader() const { return reader_; }

 private:
  struct Entry {
    std::int64_t number = 0;
    TapeRecord record;
  };
  /// What is left of one party's records, its time, and what its queries were answered last.
  struct Track {
    std::deque<Entry> entries;
    Instant now{};
    std::array<std::vector<std::uint8_t>, 64> answers;
  };

  [[nodiscard]] Track& track(TapeParty party) { return tracks_[static_cast<std::size_t>(party)]; }
  [[nodiscard]] Result<bool> read_one();
  [[nodiscard]] Entry* front(TapeParty party, std::size_t most_ahead);
  [[nodiscard]] Result<void> finish_turn(TapeParty party, std::int64_t number);
  void drop_front(Track& track);
  void remember(Track& track, const TapeExchange& exchange);
  void reach(Track& track, Instant t);
  [[nodiscard]] Error differs(TapeParty party, std::int64_t number, Instant at, const std::string& now_asked,
                              const std::string& then_asked);

  TapeReader& reader_;
  std::array<Track, kTapePartyCount + 1> tracks_;
  std::deque<Step> steps_;
  std::size_t ahead_ = 0;  ///< entries in all tracks
  bool is_at_end_ = false;
  bool has_run_out_ = false;  ///< of a tape that was cut off: something was asked that came after it
  std::optional<Error> difference_;
  std::int64_t exchanges_ = 0;
  Instant latest_{};
};

/// One party's clock at a replay. `player` must outlive it.
class ReplayClock final : public Clock {
 public:
  ReplayClock(TapePlayer& player, TapeParty party) : player_(player), party_(party) {}
  Instant now() const override { return player_.now(party_); }
  UtcTime utc_now() const override { return player_.utc_now(party_); }

 private:
  TapePlayer& player_;
  TapeParty party_;
};

}  // namespace gonio::drivers
