#include "daemon/planner/tour_search.h"

#include <algorithm>
#include <array>
#include <utility>

#include "daemon/planner/chance.h"

namespace gonio::daemon {

namespace {

constexpr double kGain_s = 1e-7;            // less is rounding, and would let the search turn in a circle
constexpr std::size_t kLongestCarried = 3;  // places that an Or-opt move carries
constexpr std::size_t kKickReach = 50;      // longest part that a double bridge swaps
constexpr std::uint64_t kSeed = 1;

// The walk as a ring: home, the places, and a last stop that costs nothing to come to from anywhere and leads home. The
// link from there is so cheap that no move cuts it.
class Ring {
 public:
  Ring(std::span<const Place> places, const StepPrice& price, const Neighbours& neighbours,
       std::span<const std::int32_t> walk)
      : places_(places),
        price_(price),
        neighbours_(neighbours),
        is_waiting_(places.size() + 1),
        at_(places.size() + 1) {
    ring_.push_back(0);
    ring_.insert(ring_.end(), walk.begin(), walk.end());
    ring_.push_back(static_cast<std::int32_t>(places.size()));
    for (std::size_t k = 0; k < ring_.size(); ++k) at_[index(ring_[k])] = k;
  }

  void settle_all() {
    for (const std::int32_t node : ring_) wait(node);
    settle();
  }

  void kick(Chance& chance) {
    const std::size_t n = ring_.size();
    const std::size_t reach = std::min(kKickReach, (n - 2) / 3);
    const std::size_t first = 1 + chance.below(reach);
    const std::size_t second = 1 + chance.below(reach);
    const std::size_t begin = chance.below(n);
    const std::int32_t before = ring_[begin];
    const std::int32_t a = ring_[(begin + 1) % n];
    const std::int32_t b = ring_[(begin + first) % n];
    const std::int32_t c = ring_[(begin + first + 1) % n];
    const std::int32_t d = ring_[(begin + first + second) % n];
    const std::int32_t after = ring_[(begin + first + second + 1) % n];
    if (is_way_home(before, a) || is_way_home(b, c) || is_way_home(d, after)) return;
    journal_.clear();
    is_journal_kept_ = true;
    change_s_ = cost(before, c) + cost(d, a) + cost(b, after) - cost(before, a) - cost(b, c) - cost(d, after);
    swap_parts(begin + 1, first, second);
    for (const std::int32_t node : {before, a, b, c, d, after}) wait(node);
    settle();
    is_journal_kept_ = false;
    if (change_s_ > 0.0) take_back();
  }

  [[nodiscard]] std::vector<std::int32_t> walk() const {
    const std::size_t n = ring_.size();
    const std::size_t home = at_[0];
    const bool is_forth = is_end(ring_[(home + n - 1) % n]);
    std::vector<std::int32_t> order;
    for (std::size_t k = 1; k + 1 < n; ++k) order.push_back(ring_[(is_forth ? home + k : home + n - k) % n]);
    return order;
  }

 private:
  static std::size_t index(std::int32_t node) { return static_cast<std::size_t>(node); }
  [[nodiscard]] bool is_end(std::int32_t node) const { return index(node) == places_.size(); }
  [[nodiscard]] bool is_way_home(std::int32_t a, std::int32_t b) const {
    return (a == 0 && is_end(b)) || (b == 0 && is_end(a));
  }
  [[nodiscard]] double cost(std::int32_t a, std::int32_t b) const {
    constexpr double kNeverCut_s = -1e5;
    if (is_end(a) || is_end(b)) return a == 0 || b == 0 ? kNeverCut_s : 0.0;
    return weight(a, b) * price_.mean_s(places_[index(a)], places_[index(b)]);
  }
  // The way from home is walked once, all others forth and back.
  static double weight(std::int32_t a, std::int32_t b) { return a == 0 || b == 0 ? 0.5 : 1.0; }
  [[nodiscard]] std::int32_t beside(std::int32_t node, bool forth) const {
    const std::size_t n = ring_.size();
    const std::size_t at = at_[index(node)];
    if (forth) return ring_[at + 1 == n ? 0 : at + 1];
    return ring_[at == 0 ? n - 1 : at - 1];
  }

  void put(std::size_t at, std::int32_t node) {
    if (is_journal_kept_) journal_.emplace_back(at, ring_[at]);
    ring_[at] = node;
    at_[index(node)] = at;
  }
  void take_back() {
    for (std::size_t k = journal_.size(); k-- > 0;) {
      ring_[journal_[k].first] = journal_[k].second;
      at_[index(journal_[k].second)] = journal_[k].first;
    }
  }

  // What lies from `first` to `last`, forth, the other way round; or all the rest, if that is shorter: the same ring.
  void reverse(std::int32_t first, std::int32_t last) {
    const std::size_t n = ring_.size();
    std::size_t i = at_[index(first)];
    std::size_t j = at_[index(last)];
    std::size_t length = (j + n - i) % n + 1;
    if (2 * length > n) {
      std::swap(i, j);
      i = i + 1 == n ? 0 : i + 1;
      j = j == 0 ? n - 1 : j - 1;
      length = n - length;
    }
    for (std::size_t swaps = length / 2; swaps > 0; --swaps) {
      const std::int32_t x = ring_[i];
      put(i, ring_[j]);
      put(j, x);
      i = i + 1 == n ? 0 : i + 1;
      j = j == 0 ? n - 1 : j - 1;
    }
  }

  // Two parts that follow each other change places.
  void swap_parts(std::size_t begin, std::size_t first, std::size_t second) {
    const std::size_t n = ring_.size();
    std::array<std::int32_t, kKickReach> kept{};
    for (std::size_t k = 0; k < first; ++k) kept[k] = ring_[(begin + k) % n];
    for (std::size_t k = 0; k < second; ++k) put((begin + k) % n, ring_[(begin + first + k) % n]);
    for (std::size_t k = 0; k < first; ++k) put((begin + second + k) % n, kept[k]);
  }

  // `carried`, which lies `forth` or back from its first, goes between `c` and the one beside it (`c_forth`): its first
  // comes to lie beside `c`.
  void carry(std::span<const std::int32_t> carried, bool forth, std::int32_t c, bool c_forth) {
    const std::size_t n = ring_.size();
    const std::size_t length = carried.size();
    const std::size_t begin = at_[index(forth ? carried.front() : carried.back())];
    const std::size_t end = begin + length;  // one beyond, not yet wrapped
    const std::int32_t left = c_forth ? c : beside(c, false);
    const std::size_t ahead = (at_[index(left)] + 2 * n - end + 1) % n;  // places to be passed, going forth
    const std::size_t behind = n - length - ahead;
    std::size_t to = begin;
    if (ahead <= behind) {
      for (std::size_t k = 0; k < ahead; ++k) put((begin + k) % n, ring_[(end + k) % n]);
      to = begin + ahead;
    } else {
      for (std::size_t k = 1; k <= behind; ++k) put((end + n - k) % n, ring_[(begin + n - k) % n]);
      to = begin + n - behind;
    }
    for (std::size_t k = 0; k < length; ++k) put((to + k) % n, carried[c_forth ? k : length - 1 - k]);
  }

  void wait(std::int32_t node) {
    if (is_waiting_[index(node)]) return;
    is_waiting_[index(node)] = true;
    waiting_.push_back(node);
  }

  void settle() {
    while (!waiting_.empty()) {
      const std::int32_t node = waiting_.back();
      waiting_.pop_back();
      is_waiting_[index(node)] = false;
      if (is_end(node)) continue;
      while (improve(node)) {
      }
    }
  }

  bool improve(std::int32_t a) {
    for (const bool forth : {true, false}) {
      if (cross(a, forth) || carry_from(a, forth)) return true;
    }
    return false;
  }

  // 2-opt: the links from a and from c, on the same side, become a-c and the other two.
  bool cross(std::int32_t a, bool forth) {
    const std::int32_t b = beside(a, forth);
    const double cut_s = cost(a, b);
    for (const auto& [price_s, c] : neighbours_.of(a)) {
      const double gain_s = cut_s - weight(a, c) * price_s;
      if (gain_s <= kGain_s) return false;
      const std::int32_t d = beside(c, forth);
      const double all_s = gain_s + cost(c, d) - cost(b, d);
      if (all_s <= kGain_s) continue;
      forth ? reverse(b, c) : reverse(c, b);
      return note(all_s, {a, b, c, d});
    }
    return false;
  }

  // Or-opt: the one to three places from a on go beside a neighbour of a, either way round.
  bool carry_from(std::int32_t a, bool forth) {
    const std::int32_t before = beside(a, !forth);
    std::array<std::int32_t, kLongestCarried> part{};
    std::int32_t last = a;
    for (std::size_t length = 1; length <= kLongestCarried && length + 2 < ring_.size(); ++length) {
      part[length - 1] = last;
      const std::int32_t after = beside(last, forth);
      if (is_way_home(before, a) || is_way_home(last, after) || after == before) return false;
      const std::span<const std::int32_t> carried(part.data(), length);
      if (put_beside(carried, forth, before, after)) return true;
      last = after;
      if (is_end(last) || last == 0) return false;
    }
    return false;
  }

  bool put_beside(std::span<const std::int32_t> carried, bool forth, std::int32_t before, std::int32_t after) {
    const std::int32_t a = carried.front();
    const std::int32_t last = carried.back();
    const double cut_s = cost(before, a) + cost(last, after) - cost(before, after);
    for (const auto& [price_s, c] : neighbours_.of(a)) {
      const double gain_s = cut_s - weight(a, c) * price_s;
      if (gain_s <= kGain_s) return false;
      if (std::ranges::find(carried, c) != carried.end()) continue;
      for (const bool c_forth : {true, false}) {
        const std::int32_t d = beside(c, c_forth);
        if (d == a || d == last) continue;
        const double all_s = gain_s + cost(c, d) - cost(last, d);
        if (all_s <= kGain_s) continue;
        carry(carried, forth, c, c_forth);
        return note(all_s, {before, a, last, after, c, d});
      }
    }
    return false;
  }

  bool note(double gain_s, std::initializer_list<std::int32_t> touched) {
    change_s_ -= gain_s;
    for (const std::int32_t node : touched) wait(node);
    return true;
  }

  std::span<const Place> places_;
  const StepPrice& price_;
  const Neighbours& neighbours_;
  std::vector<std::int32_t> ring_;
  std::vector<bool> is_waiting_;
  std::vector<std::size_t> at_;  // of each node in the ring
  std::vector<std::int32_t> waiting_;
  std::vector<std::pair<std::size_t, std::int32_t>> journal_;
  bool is_journal_kept_ = false;
  double change_s_ = 0.0;
};

}  // namespace

std::vector<std::int32_t> shorten(std::span<const Place> places, const StepPrice& price, const Neighbours& neighbours,
                                  std::span<const std::int32_t> walk, std::int64_t kicks) {
  constexpr std::size_t kFewest = 3;
  if (walk.size() < kFewest) return {walk.begin(), walk.end()};
  Ring ring(places, price, neighbours, walk);
  ring.settle_all();
  Chance chance(kSeed);
  for (std::int64_t kick = 0; kick < kicks; ++kick) ring.kick(chance);
  return ring.walk();
}

std::vector<std::int32_t> greedy_walk(std::span<const Place> places, const Neighbours& neighbours) {
  std::vector<bool> is_visited(places.size());
  std::vector<std::int32_t> order;
  std::size_t back_to = 0;     // in `order`: behind it no place has a neighbour left
  std::size_t first_left = 1;  // before it all places are visited
  std::int32_t at = 0;
  const auto next_to = [&](std::int32_t place) {
    const auto near = neighbours.of(place);
    const auto next =
        std::ranges::find_if(near, [&](const auto& n) { return !is_visited[static_cast<std::size_t>(n.place)]; });
    return next == near.end() ? -1 : next->place;
  };
  is_visited[0] = true;
  while (order.size() + 1 < places.size()) {
    std::int32_t next = next_to(at);
    for (back_to = order.size(); next < 0 && back_to > 0; --back_to) {
      constexpr std::size_t kLookBack = 1000;
      if (order.size() - back_to > kLookBack) break;
      next = next_to(order[back_to - 1]);
    }
    if (next < 0) {
      while (is_visited[first_left]) ++first_left;
      next = static_cast<std::int32_t>(first_left);
    }
    is_visited[static_cast<std::size_t>(next)] = true;
    order.push_back(next);
    at = next;
  }
  return order;
}

}  // namespace gonio::daemon
