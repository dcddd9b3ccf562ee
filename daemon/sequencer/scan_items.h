#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// Which items of a scan are decided, and which is next. Same-geometry mode: sample items for half of `block`, then the
/// reference at the same geometries, last first, from where the arms stand: so partners lie within `block` of each
/// other. The other modes have sample items only: the standard is visited, or not needed.
class ScanItems {
 public:
  /// `order`: the points to be measured, in order. Decisions of earlier runs close their block first.
  ScanItems(std::size_t points, std::vector<std::int32_t> order, Duration block, const std::vector<ItemKey>& accepted,
            const std::vector<ItemKey>& skipped, api::ReferenceMode mode = api::ReferenceMode::SameGeometry);

  /// The next item that is not decided; none when all are. The same until it is decided, unless the block's time
  /// passes.
  [[nodiscard]] std::optional<ItemKey> next(Instant now);
  /// What `next` will be once `item` is accepted, if that is plain; nothing decides it yet.
  [[nodiscard]] std::optional<ItemKey> next_after(const ItemKey& item, Instant now) const;
  void accept(const ItemKey& item, Instant now);
  /// Skipping a sample item skips its partner too: what is skipped, to be recorded.
  std::vector<ItemKey> give_up(const ItemKey& item);

  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  /// In the order: all before it are decided as samples.
  [[nodiscard]] std::size_t cursor() const { return cursor_; }
  /// How many references are owed to the block in hand.
  [[nodiscard]] std::size_t owed() const { return block_.size(); }
  [[nodiscard]] bool is_on_reference() const { return on_reference_; }
  [[nodiscard]] std::int64_t total() const { return items_of(static_cast<std::int64_t>(order_.size()), mode_); }
  [[nodiscard]] std::int64_t accepted() const { return accepted_; }
  [[nodiscard]] std::int64_t skipped() const { return skipped_; }
  /// A point is to be measured again, sample and reference, so that they are partners within one block: its accepted
  /// items, now open. None where one of the two is skipped.
  std::vector<ItemKey> reopen(std::int32_t point);
  /// The open items of this pass as they would follow each other, `next` first; `at_most` of them.
  [[nodiscard]] std::vector<ItemKey> ahead(std::size_t at_most) const;
  /// When the carriage will change sides, if each item takes `each`.
  [[nodiscard]] Instant turns_at(Instant now, Duration each) const;
  /// Points that are measured on the sample and not on the reference.
  [[nodiscard]] bool owes_reference() const;
  /// What is owed comes next, whatever the block's time.
  void close_block() { on_reference_ = !block_.empty(); }
  /// The points of which nothing is decided yet, in order.
  [[nodiscard]] std::vector<std::int32_t> untouched() const;
  /// Those in another order: the same points.
  void reorder(const std::vector<std::int32_t>& untouched);
  /// Not decided yet.
  [[nodiscard]] std::int64_t open(calibration::Target target) const;

 private:
  enum class Fate : std::uint8_t { Open, Accepted, Skipped, NotOwed };
  Fate& fate(const ItemKey& item);
  [[nodiscard]] std::optional<ItemKey> sample_after(std::int32_t point) const;
  [[nodiscard]] bool is_untouched(std::int32_t point) const;
  void decide(const ItemKey& item, Fate fate);
  void pass_decided();

  std::vector<std::int32_t> order_;
  Duration pass_;
  api::ReferenceMode mode_;
  std::vector<Fate> sample_;
  std::vector<Fate> reference_;
  std::size_t cursor_ = 0;           ///< in order_: all before it are decided as samples
  std::vector<std::int32_t> block_;  ///< points whose reference is owed
  Instant block_began_{};
  bool on_reference_ = false;
  std::int64_t accepted_ = 0;
  std::int64_t skipped_ = 0;
  std::int64_t open_samples_ = 0;
  std::int64_t open_references_ = 0;
};

}  // namespace gonio::daemon
