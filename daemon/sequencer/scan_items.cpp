#include "daemon/sequencer/scan_items.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace gonio::daemon {

using calibration::Target;

ScanItems::ScanItems(std::size_t points, std::vector<std::int32_t> order, Duration block,
                     const std::vector<ItemKey>& accepted, const std::vector<ItemKey>& skipped, api::ReferenceMode mode)
    : order_(std::move(order)),
      pass_(block / 2),
      mode_(mode),
      sample_(points, Fate::Open),
      reference_(points, mode == api::ReferenceMode::SameGeometry ? Fate::Open : Fate::NotOwed),
      open_samples_(static_cast<std::int64_t>(order_.size())),
      open_references_(total() - open_samples_) {
  for (const ItemKey& item : accepted) decide(item, Fate::Accepted);
  for (const ItemKey& item : skipped) decide(item, Fate::Skipped);
  for (const std::int32_t point : order_) {
    const auto p = static_cast<std::size_t>(point);
    if (sample_[p] == Fate::Accepted && reference_[p] == Fate::Open) block_.push_back(point);
  }
  on_reference_ = !block_.empty();
}

ScanItems::Fate& ScanItems::fate(const ItemKey& item) {
  auto& fates = item.target == Target::Sample ? sample_ : reference_;
  return fates[static_cast<std::size_t>(item.point)];
}

void ScanItems::decide(const ItemKey& item, Fate decided) {
  if (fate(item) != Fate::Open) return;
  fate(item) = decided;
  --(item.target == Target::Sample ? open_samples_ : open_references_);
  ++(decided == Fate::Accepted ? accepted_ : skipped_);
}

void ScanItems::pass_decided() {
  while (cursor_ < order_.size() && sample_[static_cast<std::size_t>(order_[cursor_])] != Fate::Open) ++cursor_;
  while (!block_.empty() && reference_[static_cast<std::size_t>(block_.back())] != Fate::Open) block_.pop_back();
}

std::optional<ItemKey> ScanItems::next(Instant now) {
  pass_decided();
  if (!on_reference_) {
    const bool block_is_over = !block_.empty() && now - block_began_ >= pass_;
    if (cursor_ < order_.size() && !block_is_over) return ItemKey{order_[cursor_], Target::Sample};
    on_reference_ = true;
  }
  if (!block_.empty()) return ItemKey{block_.back(), Target::Reference};
  on_reference_ = false;
  if (cursor_ < order_.size()) return ItemKey{order_[cursor_], Target::Sample};
  return std::nullopt;
}

std::optional<ItemKey> ScanItems::sample_after(std::int32_t point) const {
  for (std::size_t place = cursor_; place < order_.size(); ++place) {
    const std::int32_t candidate = order_[place];
    if (candidate == point || sample_[static_cast<std::size_t>(candidate)] != Fate::Open) continue;
    return ItemKey{candidate, Target::Sample};
  }
  return std::nullopt;
}

std::optional<ItemKey> ScanItems::next_after(const ItemKey& item, Instant now) const {
  if (item.target == Target::Sample) {
    const bool block_is_over = now - (block_.empty() ? now : block_began_) >= pass_;
    const auto sample = block_is_over ? std::nullopt : sample_after(item.point);
    if (sample) return sample;
    const bool owes_reference = reference_[static_cast<std::size_t>(item.point)] == Fate::Open;
    return owes_reference ? std::optional(ItemKey{item.point, Target::Reference}) : std::nullopt;
  }
  for (std::size_t k = block_.size(); k-- > 0;) {
    if (block_[k] == item.point || reference_[static_cast<std::size_t>(block_[k])] != Fate::Open) continue;
    return ItemKey{block_[k], Target::Reference};
  }
  return sample_after(-1);
}

void ScanItems::accept(const ItemKey& item, Instant now) {
  decide(item, Fate::Accepted);
  pass_decided();
  if (item.target == Target::Reference) {  // `next` may not have been asked for it
    on_reference_ = !block_.empty();
    return;
  }
  if (block_.empty()) block_began_ = now;
  block_.push_back(item.point);
}

std::vector<ItemKey> ScanItems::give_up(const ItemKey& item) {
  std::vector<ItemKey> gone{item};
  decide(item, Fate::Skipped);
  const ItemKey partner{item.point, Target::Reference};
  if (item.target == Target::Sample && fate(partner) == Fate::Open) {
    decide(partner, Fate::Skipped);
    gone.push_back(partner);
  }
  return gone;
}

std::vector<ItemKey> ScanItems::reopen(std::int32_t point) {
  const std::array<ItemKey, 2> partners{ItemKey{point, Target::Sample}, ItemKey{point, Target::Reference}};
  if (std::ranges::any_of(partners, [this](const ItemKey& item) { return fate(item) == Fate::Skipped; })) return {};
  std::vector<ItemKey> opened;
  for (const ItemKey& item : partners) {
    if (fate(item) != Fate::Accepted) continue;
    fate(item) = Fate::Open;
    ++(item.target == Target::Sample ? open_samples_ : open_references_);
    --accepted_;
    opened.push_back(item);
  }
  std::erase(block_, point);
  cursor_ = 0;
  pass_decided();
  if (block_.empty()) on_reference_ = false;
  return opened;
}

std::vector<ItemKey> ScanItems::ahead(std::size_t at_most) const {
  std::vector<ItemKey> items;
  const auto is_open = [](const std::vector<Fate>& fates, std::int32_t point) {
    return fates[static_cast<std::size_t>(point)] == Fate::Open;
  };
  if (on_reference_) {
    for (auto point = block_.rbegin(); point != block_.rend() && items.size() < at_most; ++point) {
      if (is_open(reference_, *point)) items.push_back({*point, Target::Reference});
    }
    return items;
  }
  for (std::size_t k = cursor_; k < order_.size() && items.size() < at_most; ++k) {
    if (is_open(sample_, order_[k])) items.push_back({order_[k], Target::Sample});
  }
  return items;
}

Instant ScanItems::turns_at(Instant now, Duration each) const {
  if (on_reference_) return now + static_cast<std::int64_t>(block_.size()) * each;
  const Instant used_up = now + open_samples_ * each;
  return block_.empty() ? used_up : std::min(used_up, block_began_ + pass_);
}

bool ScanItems::owes_reference() const {
  return std::any_of(block_.begin(), block_.end(),
                     [this](std::int32_t point) { return reference_[static_cast<std::size_t>(point)] == Fate::Open; });
}

bool ScanItems::is_untouched(std::int32_t point) const {
  const auto p = static_cast<std::size_t>(point);
  return sample_[p] == Fate::Open && (reference_[p] == Fate::Open || reference_[p] == Fate::NotOwed);
}

std::vector<std::int32_t> ScanItems::untouched() const {
  std::vector<std::int32_t> points;
  std::copy_if(order_.begin(), order_.end(), std::back_inserter(points),
               [this](std::int32_t point) { return is_untouched(point); });
  return points;
}

void ScanItems::reorder(const std::vector<std::int32_t>& untouched) {
  auto next = untouched.begin();
  for (std::int32_t& point : order_) {
    if (next != untouched.end() && is_untouched(point)) point = *next++;
  }
}

std::int64_t ScanItems::open(Target target) const {
  return target == Target::Sample ? open_samples_ : open_references_;
}

}  // namespace gonio::daemon
