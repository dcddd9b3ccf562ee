#include "daemon/sequencer/visit_tracks.h"

#include <algorithm>
#include <cassert>

namespace gonio::daemon {

ReferenceTracks::ReferenceTracks(const std::vector<std::int32_t>& at, LastVisit stored,
                                 const std::vector<ScanPoint>& points) {
  assert(!at.empty());
  for (const std::int32_t point : at)
    tracks_.push_back({.at = point, .level = {}, .since = {}, .last = {}, .rung = {}});
  for (VisitTrack& track : tracks_) {
    if (stored.level && stored.level->point == track.at) track.level = stored.level;
  }
  for (const ItemKey& item : stored.since) note(item, points);
}

const VisitTrack& ReferenceTracks::due() const {
  // Nothing is before every moment.
  return *std::min_element(tracks_.begin(), tracks_.end(),
                           [](const VisitTrack& a, const VisitTrack& b) { return a.last < b.last; });
}

VisitTrack& ReferenceTracks::at(std::int32_t point) {
  const auto found =
      std::find_if(tracks_.begin(), tracks_.end(), [point](const VisitTrack& track) { return track.at == point; });
  assert(found != tracks_.end());
  return *found;
}

bool ReferenceTracks::is_owed() const {
  return std::any_of(tracks_.begin(), tracks_.end(), [](const VisitTrack& track) { return !track.since.empty(); });
}

VisitTrack& ReferenceTracks::track_of(const ItemKey& item, const std::vector<ScanPoint>& points) {
  const auto wavelength_at = [&points](std::int32_t point) {
    return points[static_cast<std::size_t>(point)].wavelength;
  };
  const auto found = std::find_if(tracks_.begin(), tracks_.end(), [&](const VisitTrack& track) {
    return wavelength_at(track.at) == wavelength_at(item.point);
  });
  return found == tracks_.end() ? tracks_.front() : *found;
}

void ReferenceTracks::note(const ItemKey& item, const std::vector<ScanPoint>& points) {
  track_of(item, points).since.push_back(item);
}

void ReferenceTracks::forget(const ItemKey& item) {
  for (VisitTrack& track : tracks_) std::erase(track.since, item);
}

}  // namespace gonio::daemon
