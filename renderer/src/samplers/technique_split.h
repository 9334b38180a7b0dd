#pragma once
// How a sampler of two techniques divides a pixel's samples.

#include <renderer/samplers/sampler.h>

namespace haarlight::renderer {

/// The fraction of samples that one of the techniques draws. Their numbers are fixed, but for a
/// single sample, whose technique is chosen at random: then, too, its density is the mixture's.
struct TechniqueSplit {
  std::size_t part = 0;
  std::size_t whole = 1; ///< the number of samples if there is more than one

  float fraction() const { return static_cast<float>(part) / static_cast<float>(whole); }

  /// @param count of all samples
  /// @return the number of those of the technique
  std::size_t count(const PointSource& points, std::size_t count) const {
    if (count != 1)
      return part;
    constexpr std::uint32_t dimension = 5; // apart from those of directions
    const std::uint32_t choice = hash_words(hash_words(points.key, dimension), points.first);
    return choice % whole < part ? 1 : 0;
  }
};

} // namespace haarlight::renderer
