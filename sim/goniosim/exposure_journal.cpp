#include "sim/goniosim/exposure_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <type_traits>

namespace gonio::sim {
namespace {

// The number stands at both ends: half a slot is none.
struct Slot {
  std::uint64_t number = 0;
  std::uint64_t moves = 0;
  double scene_time_s = 0.0;
  stage::PerAxis<double> positions{};
  stage::PerAxis<double> lags{};
  std::array<std::int32_t, 3> centidegrees{};
  std::int32_t station = 0;
  std::uint64_t is_lit = 0;
  std::uint64_t number_again = 0;
};
static_assert(std::is_trivially_copyable_v<Slot>);

off_t place_of(std::uint64_t number) {
  return static_cast<off_t>(number % ExposureJournal::kSlots * sizeof(Slot));
}

void add(const Slot& slot, InstrumentMemory& memory) {
  const ExposedPlace place{
      .station = static_cast<Station>(slot.station), .centidegrees = slot.centidegrees, .is_lit = slot.is_lit != 0};
  memory.exposures = slot.number;
  if (place.is_lit) ++memory.lit_exposures;
  ++memory.places[place];
  memory.scene_time_s = slot.scene_time_s;
  memory.stage.moves = slot.moves;
  memory.stage.positions = slot.positions;
  memory.stage.lags = slot.lags;
}

}  // namespace

Result<ExposureJournal> ExposureJournal::open(const std::string& file) {
  FileDescriptor descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (descriptor.get() >= 0) return ExposureJournal(std::move(descriptor));
  return failure({.code = ErrorCode::DiskFull,
                  .device = "goniosim",
                  .tried = fmt::format("open {}", file),
                  .seen = std::strerror(errno),
                  .limit = {}});
}

void ExposureJournal::note(const ExposureNote& exposure) const {
  Slot slot;
  slot.number = slot.number_again = exposure.number;
  slot.moves = exposure.stage.moves;
  slot.scene_time_s = exposure.scene_time_s;
  if (exposure.stage.positions) slot.positions = *exposure.stage.positions;
  slot.lags = exposure.stage.lags;
  slot.centidegrees = exposure.place.centidegrees;
  slot.station = static_cast<std::int32_t>(exposure.place.station);
  slot.is_lit = exposure.place.is_lit ? 1 : 0;
  [[maybe_unused]] const ssize_t n = ::pwrite(file_.get(), &slot, sizeof slot, place_of(slot.number));
}

void ExposureJournal::catch_up(InstrumentMemory& memory) const {
  for (std::uint64_t number = memory.exposures + 1;; ++number) {
    Slot slot;
    const bool is_whole = ::pread(file_.get(), &slot, sizeof slot, place_of(number)) == sizeof slot;
    if (!is_whole || slot.number != number || slot.number_again != number) return;
    add(slot, memory);
  }
}

}  // namespace gonio::sim
