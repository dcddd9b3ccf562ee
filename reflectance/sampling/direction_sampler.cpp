#include "reflectance/sampling/direction_sampler.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace gonio::reflectance {

void DirectionSampler::draw(const RandomStream& stream, std::span<const std::uint64_t> indices,
                            const SampleBatch& out) const {
  assert(indices.size() == out.size() && indices.size() <= kRun);
  draw_run(stream, indices, out);
}

void DirectionSampler::sample(const RandomStream& stream, std::uint64_t first, const SampleBatch& out) const {
  std::array<std::uint64_t, kRun> indices;
  for (std::size_t done = 0; done < out.size(); done += kRun) {
    const std::size_t count = std::min(kRun, out.size() - done);
    std::iota(indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(count), first + done);
    draw_run(stream, std::span(indices).first(count), out.part(done, count));
  }
}

DirectionSample DirectionSampler::sample(const RandomStream& stream, std::uint64_t index) const {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double weight = 0.0;
  std::uint8_t is_specular = 0;
  draw_run(stream, std::span(&index, 1), {{&x, 1}, {&y, 1}, {&z, 1}, {&weight, 1}, {&is_specular, 1}});
  const bool is_mirrored = is_specular != 0;
  return {.r = is_mirrored ? mirrored(i_) : Direction::from_vector({.x = x, .y = y, .z = z}),
          .weight = weight,
          .is_specular = is_mirrored};
}

}  // namespace gonio::reflectance
